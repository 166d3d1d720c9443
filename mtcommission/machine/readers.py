"""What may stand at a key of a profile, and how it is read; what is wrong with it is noted."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime, time
from difflib import get_close_matches
from enum import Enum
from math import inf
from typing import Any, Protocol

from mtcommission.base.errors import Refused
from mtcommission.base.messages.message import Message
from mtcommission.base.units.axis_units import ROTARY, AxisUnits
from mtcommission.base.units.quantities import LARGEST, Dimension, parse_quantity

KeyPath = tuple[str | int, ...]

LONGEST_NAME = 80
LARGEST_NUMBER = 1e30
"""Bound of numbers whose plausible size depends on the plant; squares stay finite."""


@dataclass(slots=True, kw_only=True)
class Reading:
    """What the values of a profile depend on, and what was found wrong with them so far."""

    axis: AxisUnits  # what masses, forces and lengths are
    states: Mapping[str, Dimension]  # of the plant, by name; empty if the plant is not known
    outputs: Mapping[str, Dimension]
    data: Mapping[str, Any] = field(default_factory=dict)  # the profile as it stands there
    follows: bool = False  # whether the motor follows its setpoint
    faults: list[tuple[KeyPath, Message]] = field(default_factory=list)

    def refuse(self, place: KeyPath, message: Message) -> None:
        """Note a fault; reading goes on, so that all are found at once.

        What a message got in SI is said as it was typed.
        """
        values = message.values
        if isinstance(got := values.get("got"), float):
            typed = as_typed(self._at(place), got, str(values.get("unit") or ""))
            message = Message(message.kind, **{**values, "got": typed})
        self.faults.append((place, message))

    def _at(self, place: KeyPath) -> object:
        found: Any = self.data
        try:
            for part in place:
                found = found[part]
        except (LookupError, TypeError):  # what is left out, or stands there in another form
            return None
        return found


def as_typed(given: object, number: float, unit: str) -> str:
    """Return a quantity with the unit that the user typed; in SI where he typed none, or nothing.

    Examples
    --------
    >>> as_typed("3 kN", 3000.0, "N"), as_typed(3000, 3000.0, "N")
    ('3 kN', '3000 N')
    """
    return given.strip() if isinstance(given, str) else f"{number:g} {unit}".rstrip()


class Reader(Protocol):
    """What may stand at a key."""

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return the value in SI; what is wrong with it is noted, and what is returned is void."""

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return its JSON schema; those of tables go into ``tables`` by name."""


@dataclass(frozen=True, slots=True)
class Range:
    """A dimension with the values that make sense; the ends are generous."""

    dimension: Dimension
    low: float  # [SI]
    high: float  # [SI]
    above: float = -inf  # physical bound that is not itself allowed [SI]; -inf if there is none

    def number_of(self, value: object) -> float:
        """Return the SI value of a number or a text with a unit; raise Refused if it is none."""
        number = _number_of(value, self.dimension)
        unit = f" {self.dimension.si}" if self.dimension.si else ""
        got = as_typed(value, number, self.dimension.si)
        if number <= self.above:
            raise Refused(Message("must-be-above", got=got, bound=self.above, unit=unit))
        if self.above == -inf and number < self.low == 0.0:
            raise Refused(Message("must-be-at-least", got=got, bound=0.0, unit=unit))
        if not self.low <= number <= self.high:
            raise Refused(
                Message("must-be-between", got=got, low=self.low, high=self.high, unit=unit)
            )
        return number


def _number_of(value: object, dimension: Dimension) -> float:
    if isinstance(value, str):
        return parse_quantity(value, dimension)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Refused(Message("got-no-quantity", got=describe(value), expected=dimension.expected))
    if not abs(value) <= LARGEST:
        raise Refused(Message("got-infinite", got=describe(value)))
    return float(value)


@dataclass(frozen=True, slots=True)
class AxisRange:
    """A quantity: what is allowed on a linear and on a rotary axis."""

    linear: Range
    rotary: Range
    word: str = ""  # text accepted in place of a number, e.g. "auto"; "" for none

    def on(self, axis: AxisUnits) -> Range:
        """Return the range on one kind of axis."""
        return self.rotary if axis.length is ROTARY.length else self.linear

    def read(self, value: object, place: KeyPath, reading: Reading) -> float | None:
        """Return the SI value; None for the word."""
        if self.word and value == self.word:
            return None
        try:
            return self.on(reading.axis).number_of(value)
        except Refused as error:
            said = error.message
            reading.refuse(
                place, Message("or-word", what=said, word=self.word) if self.word else said
            )
            return None

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: a number in SI, or a text with a unit."""
        return {
            "type": ["number", "string"],
            "x-unit": self.linear.dimension.si or "no unit",
            "x-unit-rotary": self.rotary.dimension.si or "no unit",
        }


@dataclass(frozen=True, slots=True)
class Text:
    """A text for people."""

    longest: int = LONGEST_NAME
    is_identifier: bool = False  # whether it becomes part of a state's name

    def read(self, value: object, place: KeyPath, reading: Reading) -> str:
        """Return the text."""
        if not isinstance(value, str):
            reading.refuse(place, Message("got-no-text", got=describe(value)))
            return ""
        if len(value) > self.longest:
            reading.refuse(place, Message("text-too-long", length=len(value), most=self.longest))
        elif any(unicodedata.category(letter).startswith("C") for letter in value):
            reading.refuse(place, Message("text-with-control-characters"))
        elif self.is_identifier and not value.isidentifier():
            reading.refuse(place, Message("name-no-identifier", got=value))
        elif not value.strip():
            reading.refuse(place, Message("name-empty"))
        return value

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema."""
        return {"type": "string", "maxLength": self.longest}


IDENTIFIER = Text(is_identifier=True)


@dataclass(frozen=True, slots=True)
class Word:
    """One of some words, or something else in its place."""

    meanings: Mapping[str, Any]
    other: Reader | None = None
    refused: str = ""  # what is said of a word that is none of them; "": the other reads it

    @property
    def choices(self) -> tuple[str, ...]:
        """The words, where nothing else may stand there."""
        return () if self.other else tuple(self.meanings)

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return what the word means, or the other."""
        if isinstance(value, str) and value in self.meanings:
            return self.meanings[value]
        if self.other and not (isinstance(value, str) and self.refused):
            return self.other.read(value, place, reading)
        words, kind = one_of(tuple(self.meanings)), self.refused or "got-other-word"
        reading.refuse(place, Message(kind, got=describe(value), words=words, hint=None))
        return None

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema."""
        words = list(self.meanings)
        if self.other is None:
            return {"type": "string", "enum": words}
        return {"anyOf": [self.other.schema(tables), {"enum": words}]}


def word_of(kinds: type[Enum] | Iterable[str]) -> Word:
    """Return the reader of an enumeration's values, or of plain words."""
    if isinstance(kinds, type):
        return Word({one.value: one for one in kinds})
    return Word({word: word for word in kinds})


@dataclass(frozen=True, slots=True)
class Flag:
    """True or false."""

    def read(self, value: object, place: KeyPath, reading: Reading) -> bool:
        """Return it."""
        if not isinstance(value, bool):
            reading.refuse(place, must_be(value, Message("json-boolean")))
        return value is True

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema."""
        return {"type": "boolean"}


@dataclass(frozen=True, slots=True)
class Array:
    """An array of ``least`` to ``most`` elements."""

    inner: Reader
    least: int
    most: int
    make: Callable[[tuple[Any, ...]], Any] = tuple  # of its elements

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return what is made of the elements."""
        before = len(reading.faults)
        if not isinstance(value, list):
            hint = Message("hint-moves-header") if place == ("moves",) else None
            reading.refuse(place, must_be(value, Message("json-array"), hint))
            return None
        if len(value) > self.most:
            reading.refuse(place, Message("array-too-long", most=self.most))
            return None
        found = tuple(self.inner.read(one, (*place, i), reading) for i, one in enumerate(value))
        if len(reading.faults) == before and len(value) < self.least:
            message = Message("array-too-short", length=len(value), least=self.least)
            reading.refuse(place, message)
        return self.make(found) if len(reading.faults) == before else None

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema."""
        inner = self.inner.schema(tables)
        return {"type": "array", "items": inner, "minItems": self.least, "maxItems": self.most}


class PerSignal(Enum):
    """What a number in a table of signals measures."""

    BOUND = "the signal itself"
    GAIN = "force per signal"
    WEIGHT = "squared force per squared signal"


@dataclass(frozen=True, slots=True)
class Signals:
    """A table with one number for each of some states or, for bounds, outputs."""

    kind: PerSignal
    make: Callable[[str, float], Any]  # of name and number
    words: tuple[str, ...] = ()  # accepted in place of the table, for messages

    def read(self, value: object, place: KeyPath, reading: Reading) -> tuple[Any, ...]:
        """Return what is made of each."""
        if not isinstance(value, dict):
            words = one_of(self.words) if self.words else None
            kind = "got-no-signals-or-word" if words else "got-no-signals"
            reading.refuse(place, Message(kind, got=describe(value), words=words))
            return ()
        if not reading.states:  # the plant is at fault, and that is said there
            return ()
        is_bound = self.kind is PerSignal.BOUND
        signals = {**reading.states, **(reading.outputs if is_bound else {})}
        found = []
        for name, number in value.items():
            if name not in signals:
                message = Message("no-such-signal", hint=propose(name, signals))
                reading.refuse((*place, name), message)
                continue
            try:
                allowed = self._range(signals[name], reading.states["F"])
                found.append(self.make(name, allowed.number_of(number)))
            except Refused as error:
                reading.refuse((*place, name), error.message)
        return tuple(found)

    def _range(self, signal: Dimension, force: Dimension) -> Range:
        if self.kind is PerSignal.BOUND:
            return Range(signal, 0.0, LARGEST_NUMBER, above=0.0)
        gain = force.per(signal)
        if self.kind is PerSignal.WEIGHT:
            return Range(gain.squared(), 0.0, LARGEST_NUMBER)
        return Range(gain, -LARGEST_NUMBER, LARGEST_NUMBER)

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: a table of numbers or texts with units."""
        return {"type": "object", "additionalProperties": {"type": ["number", "string"]}}


# Words of messages


def read_path(key: str) -> KeyPath:
    """Return the path of a dotted key.

    Examples
    --------
    >>> read_path("moves.0.distance")
    ('moves', 0, 'distance')
    """
    return tuple(int(part) if part.isdigit() else part for part in key.split(".") if part)


def one_of(words: Sequence[str]) -> Message | str:
    """Return words in quotes as alternatives: "a", "b" or "c"."""
    *first, last = (f'"{word}"' for word in words)
    return Message("either", first=", ".join(first), last=last) if first else last


def describe(value: object) -> Message | str:
    """Return a TOML value as it was written, or what it is, for a message.

    Examples
    --------
    >>> describe(True), describe([1, 2]), describe("x" * 100)[:8]
    ('true', Message('json-array'), '"xxxxxxx')
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        shown = "".join(letter if letter.isprintable() else "?" for letter in value)
        return f'"{shown[:40]}..."' if len(shown) > 40 else f'"{shown}"'
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, int):
        return f"{value}" if abs(value) < 10**18 else Message("a-huge-integer")
    if isinstance(value, list):
        return Message("json-array")
    return Message("a-date" if isinstance(value, date | datetime | time) else "a-table")


def must_be(value: object, words: Message | str, hint: Message | None = None) -> Message:
    """Return that a value is none of what it must be; ``hint``: what may have been meant."""
    return Message("got-other-word", got=describe(value), words=words, hint=hint)


def propose(name: str, known: Iterable[str]) -> Message:
    """Return a hint: what was meant, or the list of what there is.

    Examples
    --------
    >>> propose("base_mas", ["base_mass", "slider_mass"])
    Message('hint-did-you-mean', name='base_mass')
    """
    known = list(known)
    close = find_close(name, known)
    if close:
        return Message("hint-did-you-mean", name=close)
    return Message("hint-there-are", names=", ".join(known))


def find_close(name: str, known: Iterable[str]) -> str:
    """Return the known name that resembles a misspelt one; "" if none does."""
    return next(iter(get_close_matches(name, list(known), n=1, cutoff=0.6)), "")
