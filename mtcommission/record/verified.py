"""What ``verify`` found about a record, as a sheet takes it in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mtcommission.base.messages.message import Message
from mtcommission.record.files import LARGEST_FILE, fault, load_json
from mtcommission.record.record import Record
from mtcommission.record.shape import WrongFormError, to_entry

VERDICTS = ("holds", "does not hold", "cannot tell")


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """A measured value beside the calculated one; ``verdict`` "" where none is given [SI]."""

    name: str  # in the JSON of ``verify``
    measured: float | None
    uncertainty: float | None
    verdict: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Verified:
    """The verdict over all, and each measured value by its name."""

    verdict: str
    values: Mapping[str, Measured]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Refined:
    new: float
    sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Verdict:
    """What is read of ``verdict.json``."""

    verdict: str
    record: str
    checks: list[Measured]
    refined: dict[str, _Refined]


def load_verdict(path: Path, record: Record) -> Verified:
    """Return a verdict from the ``verdict.json`` of ``verify``.

    Raises
    ------
    InputError
        It is no such file, or it is about another record.
    """
    try:
        found = to_entry(load_json(path, most=LARGEST_FILE), _Verdict)
    except WrongFormError as error:
        raise fault(path, Message("verdict-of-other-form")) from error
    if not {found.verdict, *(check.verdict for check in found.checks)} <= set(VERDICTS):
        raise fault(path, Message("verdict-of-other-form"))
    if found.record != record.checksum:
        raise fault(path, Message("verdict-of-other-record"))
    values = {check.name: check for check in found.checks}
    for name, one in found.refined.items():
        # base.damping_ratio is judged by the check "base: damping ratio".
        mode, _, key = name.rpartition(".")
        check = values.get(f"{mode}: {key.replace('_', ' ')}")
        values[name] = Measured(
            name=name,
            measured=one.new,
            uncertainty=2.0 * one.sigma,
            verdict=check.verdict if check else "",
        )
    return Verified(verdict=found.verdict, values=values)
