"""Records as text and files: JSON without infinities, sealed by a checksum."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.files import read_bytes
from mtcommission.base.messages.message import Message
from mtcommission.record.shape import to_plain

LARGEST_FILE = 50_000_000
"""Bytes; a record of many moves has a few million."""


def dump_json(value: object) -> str:
    """Return JSON text without infinities (they are null), ready to be written."""
    return json.dumps(to_plain(value), allow_nan=False, ensure_ascii=False, indent=1) + "\n"


def find_checksum(record: Mapping[str, object]) -> str:
    """Return the SHA-256 of everything in a record but its checksum, in hexadecimal digits.

    Whoever exports a record or prints it again must know that nobody edited it since the run.

    Examples
    --------
    >>> find_checksum({"a": 1, "b": 2}) == find_checksum({"b": 2, "checksum": "", "a": 1})
    True
    """
    rest = {key: value for key, value in record.items() if key != "checksum"}
    return sha256(json.dumps(rest, sort_keys=True, allow_nan=False).encode()).hexdigest()


def load_json(path: Path, *, most: int) -> Any:
    """Return what a file of JSON holds, of so many bytes at most; JSON's own numbers alone.

    Raises
    ------
    InputError
        If it is too large or no JSON.
    """
    content = read_bytes(path, folder=Message("record-is-directory"), most=most + 1)
    if len(content) > most:
        raise fault(path, Message("record-too-large", most=most))
    try:
        return json.loads(
            content.decode("utf-8-sig"), parse_constant=_refuse, parse_float=_read_float
        )
    except _NoNumberError as error:
        why = Message("json-no-number", constant=str(error))
        raise fault(path, Message("record-not-readable", why=why)) from error
    except (ValueError, RecursionError) as error:
        raise fault(path, Message("record-not-json")) from error


def names_group(path: Path) -> bool:
    """Return whether a file is the record of a group, not of one axis."""
    data = load_json(path, most=LARGEST_FILE)
    return isinstance(data, dict) and {"axes", "path"} <= data.keys()


def fault(path: Path, message: Message, key: str = "") -> InputError:
    """Return the error that something is wrong in a file."""
    return InputError([Fault(where=str(path), key=key, message=message)])


class _NoNumberError(ValueError):
    """What Python writes for a number that JSON does not know."""


def _read_float(text: str) -> float:
    value = float(text)
    return value if isfinite(value) else _refuse(text)


def _refuse(constant: str) -> NoReturn:
    raise _NoNumberError(constant)
