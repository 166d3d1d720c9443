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
from mtcommission.base.units.quantities import (
    FREQUENCY,
    GAIN,
    INERTIA,
    LARGEST,
    LENGTH,
    LINEAR,
    RATIO,
    ROTARY,
    ROTARY_DAMPING,
    ROTARY_STIFFNESS,
    TIME,
    AxisUnits,
    Dimension,
    parse_quantity,
)

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
    """Return a quantity with the unit that the user typed; in SI where he typed none."""
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


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalValue:
    """A number of one state or output of the plant: a bound, a gain or a weight."""

    name: str  # of the signal, e.g. ``v_phi``
    value: float  # [SI, by what it is]


@dataclass(frozen=True, slots=True)
class Signals:
    """A table with one number for each of some states or, for bounds, outputs."""

    kind: PerSignal
    words: tuple[str, ...] = ()  # accepted in place of the table, for messages

    def read(self, value: object, place: KeyPath, reading: Reading) -> tuple[SignalValue, ...]:
        """Return each with its number."""
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
                found.append(SignalValue(name=name, value=allowed.number_of(number)))
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
    """Return the path of a dotted key."""
    return tuple(int(part) if part.isdigit() else part for part in key.split(".") if part)


def show_key(path: KeyPath) -> str:
    """Return a key as messages and sheets spell it, ``moves[1].distance``: elements from 1 on."""
    shown = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in path)
    return shown.removeprefix(".")


def one_of(words: Sequence[str]) -> Message | str:
    """Return words in quotes as alternatives: "a", "b" or "c"."""
    *first, last = (f'"{word}"' for word in words)
    return Message("either", first=", ".join(first), last=last) if first else last


def describe(value: object) -> Message | str:
    """Return a TOML value as it was written, or what it is, for a message."""
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


def propose(name: str, known: Iterable[str], *, below: KeyPath = ()) -> Message:
    """Return a hint: what was meant, with the key of its table, or the list of what there is."""
    known = list(known)
    close = find_close(name, known)
    if close:
        return Message("hint-did-you-mean", name=show_key((*below, close)))
    return Message("hint-there-are", names=", ".join(known))


def find_close(name: str, known: Iterable[str]) -> str:
    """Return the known name that resembles a misspelt one; "" if none does."""
    return next(iter(get_close_matches(name, list(known), n=1, cutoff=0.6)), "")


# What a quantity of a machine may be; the ends only catch slips of units: a kilometre, a nanometre


Ends = tuple[float, float]


def _same(of: Dimension, low: float, high: float, above: float = -inf) -> AxisRange:
    both = Range(of, low, high, above)
    return AxisRange(both, both)


def _of_axis(name: str, linear: Ends, rotary: Ends | None = None, above: float = -inf) -> AxisRange:
    """A quantity that is another one on a rotary axis; ``rotary`` None: with the same numbers."""
    turned = Range(getattr(ROTARY, name), *(rotary or linear), above)
    return AxisRange(Range(getattr(LINEAR, name), *linear, above), turned)


MASSES = _of_axis("mass", (1e-3, 1e6), (1e-9, 1e7), above=0.0)
LOADS = _of_axis("mass", (0.0, 1e6), (0.0, 1e7))
# The tower turns on a rotary axis as well, so its own quantities stay rotary.
INERTIAS = _same(INERTIA, 1e-9, 1e7, 0.0)
ROTARY_STIFFNESSES = _same(ROTARY_STIFFNESS, 1e-3, 1e13, 0.0)
ROTARY_DAMPINGS = _same(ROTARY_DAMPING, 0.0, 1e11)
ARMS = AxisRange(Range(LENGTH, -100.0, 100.0), Range(RATIO, -1e4, 1e4))
STIFFNESSES = _of_axis("stiffness", (1.0, 1e12), (1e-3, 1e13), above=0.0)
DAMPINGS = _of_axis("damping", (0.0, 1e10), (0.0, 1e11))
FORCES = _of_axis("force", (1e-3, 1e8), (1e-6, 1e8), above=0.0)
LEADS = _same(LENGTH, 1e-5, 100.0, 0.0)
GEARS = _same(RATIO, 1e-4, 1e4, 0.0)
RESOLUTIONS = _of_axis("length", (1e-13, 1e-3), (1e-13, 0.1), above=0.0)
FRICTIONS = _of_axis("force", (0.0, 1e8))
STATIC_LOADS = _of_axis("force", (-1e8, 1e8))
VELOCITIES = _of_axis("velocity", (1e-6, 100.0), (1e-6, 1e4), above=0.0)
ACCELERATIONS = _of_axis("acceleration", (1e-4, 1e4), (1e-4, 1e7), above=0.0)
JERKS = _of_axis("jerk", (1e-3, 1e8), (1e-3, 1e11), above=0.0)
DISTANCES = _of_axis("length", (1e-7, 1e3), (1e-7, 1e5), above=0.0)
BANDS = _of_axis("length", (1e-10, 0.1), (1e-10, 1.0), above=0.0)
MODE_GAINS = _of_axis("gain", (-1e6, 1e6), (-1e12, 1e12))
VELOCITY_GAINS = _of_axis("damping", (1e-6, 1e12), (1e-9, 1e12), above=0.0)
MODEL_TIMES = _same(TIME, 0.0, 10.0)
DELAYS = AxisRange(MODEL_TIMES.linear, MODEL_TIMES.rotary, word="auto")
LAGS = _same(TIME, 1e-6, 0.1, 0.0)
FILTER_TIMES = _same(TIME, 1e-6, 1.0, 0.0)
# Drives have 31.25 us and more, controls up to 20 ms; every simulation steps through them.
CYCLES = _same(TIME, 1e-5, 0.05, 0.0)
DWELLS = _same(TIME, 0.0, 1e5)
TIMES = _same(TIME, 1e-6, 1e4, 0.0)
FREQUENCIES = _same(FREQUENCY, 1e-2, 1e5, 0.0)
STEP_RATES = _same(FREQUENCY, 1.0, 1e9, 0.0)
POSITION_GAINS = _same(GAIN, 1e-3, 1e5, 0.0)
RATIOS = _same(RATIO, -1e30, 1e30)
SPREADS = _same(RATIO, 0.0, 1e30)
SHARES = _same(RATIO, 0.01, 1.0, 0.0)
FILTER_DAMPINGS = _same(RATIO, 0.0, 10.0)
TAPS = _same(RATIO, -10.0, 10.0)
FEEDFORWARDS = _same(RATIO, 0.0, 10.0)
# A standard error may be as small as it likes; a delay as a clock shows it may be negative.
MEASURED_FREQUENCIES = _same(FREQUENCY, 0.0, 1e6)
MEASURED_TIMES = _same(TIME, -10.0, 10.0)
MEASURED_MASSES = _of_axis("mass", (0.0, 1e8))
