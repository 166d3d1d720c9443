"""Records as text and files: JSON without infinities, sealed by a checksum."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import cast

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message
from mtcommission.record.expected import find_unexpected
from mtcommission.record.schema import SCHEMA, Record

MOST_NAMED = 3
"""Entries of an unexpected form that a message names."""


def dump_json(value: object) -> str:
    """Return JSON text without infinities (they are null), ready to be written."""
    return json.dumps(_finite(value), allow_nan=False, ensure_ascii=False, indent=1) + "\n"


def find_checksum(record: Mapping[str, object]) -> str:
    """Return the SHA-256 of everything in a record but its checksum.

    Whoever exports a record or prints it again must know that nobody edited it since the run.

    Parameters
    ----------
    record
        Fresh, or as read from its file.

    Returns
    -------
    str
        64 hexadecimal digits; order and layout of the keys do not matter.

    Examples
    --------
    >>> find_checksum({"a": 1, "b": 2}) == find_checksum({"b": 2, "checksum": "", "a": 1})
    True
    """
    rest = _finite({key: value for key, value in record.items() if key != "checksum"})
    return sha256(json.dumps(rest, sort_keys=True, allow_nan=False).encode()).hexdigest()


def load_record(path: Path) -> Record:
    """Return a record from its file.

    Parameters
    ----------
    path
        A ``record.json`` of this schema.

    Returns
    -------
    Record

    Raises
    ------
    InputError
        If the file is no such record; says what is wrong.
    """
    try:
        text = path.read_text("utf-8")
        data = json.loads(text)
    except (OSError, ValueError, RecursionError) as error:
        message = f"not a record of mtcommission run: {error}"
        raise InputError(
            [Fault(where=str(path), message=Message("verbatim", text=message))]
        ) from error
    missing = (
        sorted(Record.__required_keys__ - data.keys()) if isinstance(data, dict) else ["all keys"]
    )
    if missing:
        message = f"not a record of mtcommission run: {', '.join(missing)} missing"
        raise InputError([Fault(where=str(path), message=Message("verbatim", text=message))])
    if data["schema"] != SCHEMA:
        message = (
            f"record schema {data['schema']!r}, this version reads {SCHEMA}; "
            "run the profile again, or print it with the version that wrote it"
        )
        raise InputError(
            [Fault(where=str(path), key="schema", message=Message("verbatim", text=message))]
        )
    unexpected = list(islice(find_unexpected(data, Record), MOST_NAMED + 1))
    named = "".join(f"; {one}" for one in unexpected[:MOST_NAMED])
    named += "; and more" if len(unexpected) > MOST_NAMED else ""
    if data["checksum"] != find_checksum(data):
        message = (
            "its contents are not those that mtcommission run wrote: it was edited or damaged"
            f"{named}; change the profile instead, and run it again"
        )
        raise InputError(
            [Fault(where=str(path), key="checksum", message=Message("verbatim", text=message))]
        )
    if unexpected:
        message = (
            f"another version of mtcommission wrote it{named}; run the profile again, or use "
            "that version"
        )
        raise InputError([Fault(where=str(path), message=Message("verbatim", text=message))])
    return cast(Record, data)


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return value
