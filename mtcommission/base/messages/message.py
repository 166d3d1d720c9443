"""A message as data: its kind, and the values that its text speaks of."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

Value: TypeAlias = "float | int | str | bool | Message | tuple[Value, ...] | None"
"""SI number, text of the user (names of modes, files), key of another text, or messages inside."""

STEERING = re.compile(
    r"[\x00-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u2069\ufeff\ud800-\udfff]"
)
"""Characters that move a cursor, turn the direction of writing, or are none."""


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Message:
    """What is to be said: no words yet, they are in the catalogue of each language.

    ``kind`` is the key of the text in the catalogue; the catalogue knows the unit of each value.
    """

    kind: str
    values: Mapping[str, Value]

    def __init__(self, kind: str, /, **values: Value) -> None:
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "values", values)

    def __hash__(self) -> int:
        return hash((self.kind, tuple(sorted(self.values.items(), key=lambda item: item[0]))))

    def __repr__(self) -> str:
        values = "".join(f", {name}={value!r}" for name, value in self.values.items())
        return f"Message({self.kind!r}{values})"


def printable(text: str) -> str:
    r"""Return a foreign text that neither steers a terminal nor begins a line of its own."""
    return STEERING.sub("?", text)


def join_by_and(messages: Sequence[Message]) -> Message:
    """Return one message that says all of some: a and b and c."""
    *before, last = messages
    return Message("joined-by-and", first=join_by_and(before), second=last) if before else last


def parts_of(message: Message | str) -> tuple[Message, ...]:
    """Return a message and all messages in it."""
    if isinstance(message, str):
        return ()
    inner = [one for one in message.values.values() if isinstance(one, Message)]
    return (message, *(part for one in inner for part in parts_of(one)))


def to_json(value: Value) -> object:
    """Return a value as the record holds it: ``{"message": kind, "values": {...}}``."""
    if isinstance(value, Message):
        values = {name: to_json(inner) for name, inner in value.values.items()}
        return {"message": value.kind, "values": values}
    return [to_json(inner) for inner in value] if isinstance(value, tuple) else value


def from_json(entry: object) -> Value:
    """Return what ``to_json`` was given.

    Raises ValueError: no such entry.
    """
    if isinstance(entry, dict):
        kind, values = entry.get("message"), entry.get("values")
        if len(entry) != 2 or not isinstance(kind, str) or not isinstance(values, dict):
            raise ValueError("must be {message: kind, values: {name: value}}")
        return Message(kind, **{str(name): from_json(inner) for name, inner in values.items()})
    if isinstance(entry, list):
        return tuple(from_json(inner) for inner in entry)
    if entry is None or isinstance(entry, (str, int, float)):
        return entry
    raise ValueError(f"must be a number, a text or a message, got {type(entry).__name__}")
