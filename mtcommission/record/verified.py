"""What ``verify`` found about a record, as a sheet takes it in."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mtcommission.errors import Fault, InputError
from mtcommission.files import read_bytes
from mtcommission.messages.message import Message
from mtcommission.record.schema.record import Record
from mtcommission.record.shape import WrongFormError, to_entry

LARGEST = 50_000_000
"""Of a verdict's file [bytes]."""

VERDICTS = ("holds", "does not hold", "cannot tell")


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """A measured value beside the calculated one; ``verdict`` "" where none is given [SI]."""

    value: float | None
    uncertainty: float | None
    verdict: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Verified:
    """The verdict over all, and each measured value by its name in the JSON of ``verify``."""

    verdict: str
    values: Mapping[str, Measured]


def load_verdict(path: Path, record: Record) -> Verified:
    """Return a verdict from its file.

    Parameters
    ----------
    path
        ``verdict.json`` of ``verify``.
    record
        Whose promises it must be about.

    Raises
    ------
    InputError
        It is no such file, or it is about another record.
    """
    content = read_bytes(path, folder=Message("record-is-directory"), most=LARGEST)
    try:
        data = json.loads(content.decode())
    except (ValueError, RecursionError) as error:
        raise _fault(path, "record-not-json") from error
    if not isinstance(data, dict) or data.get("verdict") not in VERDICTS:
        raise _fault(path, "verdict-of-other-form")
    if data.get("record") != record.checksum:
        raise _fault(path, "verdict-of-other-record")
    try:
        checks = {str(check["name"]): _check(check) for check in data["checks"]}
        refined = {
            str(name): _refined(one, checks.get(_check_of(str(name))))
            for name, one in data["refined"].items()
        }
    except (AttributeError, KeyError, TypeError, WrongFormError) as error:
        raise _fault(path, "verdict-of-other-form") from error
    return Verified(verdict=data["verdict"], values={**checks, **refined})


def _check(check: Mapping[str, Any]) -> Measured:
    if check["verdict"] not in VERDICTS:
        raise KeyError(check["verdict"])
    return Measured(
        value=to_entry(check["measured"], float) if check["measured"] is not None else None,
        uncertainty=None if check["uncertainty"] is None else to_entry(check["uncertainty"], float),
        verdict=check["verdict"],
    )


def _check_of(parameter: str) -> str:
    """Name of the check of a parameter, e.g. ``base: damping ratio`` of base.damping_ratio."""
    mode, _, key = parameter.rpartition(".")
    return f"{mode}: {key.replace('_', ' ')}"


def _refined(one: Mapping[str, Any], check: Measured | None) -> Measured:
    return Measured(
        value=to_entry(one["new"], float),
        uncertainty=2.0 * to_entry(one["sigma"], float),
        verdict=check.verdict if check else "",
    )


def _fault(path: Path, kind: str) -> InputError:
    return InputError([Fault(where=str(path), message=Message(kind))])
