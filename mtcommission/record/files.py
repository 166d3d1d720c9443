"""Records as text and files: JSON without infinities, sealed by a checksum."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from hashlib import sha256
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

from mtcommission.errors import Fault, InputError
from mtcommission.files import read_bytes
from mtcommission.messages.message import STEERING, Message
from mtcommission.record.schema.record import SCHEMA, Record
from mtcommission.record.shape import WRONG, find_broken_rules, find_faults, to_entry, to_plain

LARGEST_FILE = 50_000_000
"""Bytes; a record of many moves has a few million."""
LAYOUT = {ord(letter): None for letter in "\n\r\t"}
"""Stand in the profile's text."""
MOST_NAMED = 3
"""Wrong places that a message names."""


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


def load_record(path: Path) -> Record:
    """Return a record from the ``record.json`` of a run.

    Raises
    ------
    InputError
        If the file is no record of this schema, or not as it was written; says what is wrong.
    """
    data = load_json(path, most=LARGEST_FILE)
    if any(STEERING.search(text.translate(LAYOUT)) for text in _texts(data)):
        raise fault(path, Message("record-steers"))
    missing = sorted({"schema", "checksum"} - (data.keys() if isinstance(data, dict) else set()))
    if missing:
        raise fault(path, Message("record-lacks-keys", keys=", ".join(missing)))
    if data["schema"] != SCHEMA:
        is_earlier = isinstance(data["schema"], int) and data["schema"] < SCHEMA
        kind = "record-of-earlier-schema" if is_earlier else "record-of-other-schema"
        given = json.dumps(data["schema"])
        raise fault(path, Message(kind, given=given, read=SCHEMA), "schema")
    record, wrong = _read(data)
    if data["checksum"] != find_checksum(data):
        raise fault(path, _named("record-edited", wrong), "checksum")
    if record is None:
        raise fault(path, _named("record-of-other-version", wrong))
    broken = list(islice(find_broken_rules(record), MOST_NAMED + 1))
    if broken:
        raise fault(path, _named("record-disagrees", broken))
    return record


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


def fault(path: Path, message: Message, key: str = "") -> InputError:
    """Return the error that something is wrong in a file."""
    return InputError([Fault(where=str(path), key=key, message=message)])


def _texts(data: object) -> Iterator[str]:
    """Every text and key."""
    if isinstance(data, str):
        yield data
    elif isinstance(data, dict):
        yield from data
        yield from _texts(list(data.values()))
    elif isinstance(data, list):
        for inner in data:
            yield from _texts(inner)


def _read(data: object) -> tuple[Record | None, list[Message]]:
    """The record, or what is of another form in it."""
    try:
        return to_entry(data, Record), []
    except WRONG as error:
        return None, list(islice(find_faults(error), MOST_NAMED + 1))


def _named(kind: str, wrong: list[Message]) -> Message:
    """A message that tells the first wrong places, and whether there are more."""
    if not wrong:
        return Message(kind)
    shown: Iterable[Message] = wrong[:MOST_NAMED]
    if len(wrong) > MOST_NAMED:
        shown = [*shown, Message("record-has-more-wrong")]
    told = reduce(lambda first, then: Message("record-both", first=first, then=then), shown)
    return Message(f"{kind}-where", wrong=told)


class _NoNumberError(ValueError):
    """What Python writes for a number that JSON does not know."""


def _read_float(text: str) -> float:
    value = float(text)
    return value if isfinite(value) else _refuse(text)


def _refuse(constant: str) -> NoReturn:
    raise _NoNumberError(constant)
