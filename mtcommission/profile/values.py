"""The values of a profile, read one by one: quantities, names and the words beside them.

Each reader is metadata of a pydantic field. It knows what is allowed and says so when it is
not; what depends on the machine (linear or rotary, which states there are) comes in as the
validation context.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date, datetime, time
from difflib import get_close_matches
from enum import Enum
from math import inf
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from mtcommission.errors import Refused
from mtcommission.machine.mechanics import Misfit
from mtcommission.machine.ranges import AxisRange, Range
from mtcommission.messages.message import Message
from mtcommission.units.axis_units import AxisUnits
from mtcommission.units.quantities import LARGEST, Dimension, parse_quantity

LONGEST_NAME = 80
LARGEST_NUMBER = 1e30
"""Bound of numbers whose plausible size depends on the plant; squares stay finite."""


class Faults(ValueError):
    """Several things wrong with one value or table.

    Parameters
    ----------
    items
        Dotted key below the value ("" for the value itself) and message.
    """

    def __init__(self, items: Sequence[Misfit]) -> None:
        self.items = tuple(items)
        super().__init__(self.items)


@dataclass(frozen=True, slots=True, kw_only=True)
class Context:
    """What a value's meaning depends on.

    Parameters
    ----------
    axis
        What masses, forces and lengths are.
    states, outputs
        Names of the plant's signals and what they measure; empty if the plant is not known.
    """

    axis: AxisUnits
    states: Mapping[str, Dimension]
    outputs: Mapping[str, Dimension]


@dataclass(frozen=True, slots=True)
class Read:
    """Reader of a number or a text with a unit.

    Parameters
    ----------
    allowed
        What it may be.
    """

    allowed: AxisRange

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the schema that calls this reader."""
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the JSON schema: a number in SI, or a text with a unit."""
        return {
            "anyOf": [{"type": "number"}, {"type": "string"}],
            "x-unit": self.allowed.linear.dimension.si or "no unit",
            "x-unit-rotary": self.allowed.rotary.dimension.si or "no unit",
        }

    def _read(self, value: object, info: ValidationInfo) -> float | None:
        word = self.allowed.word
        if word and value == word:
            return None
        try:
            return _read_within(self.allowed.on(context_of(info).axis), value)
        except Refused as error:
            said = error.message
            raise Faults(
                [("", Message("or-word", what=said, word=word) if word else said)]
            ) from error


@dataclass(frozen=True, slots=True)
class Name:
    """Reader of a text for people.

    Parameters
    ----------
    longest
        Largest number of characters.
    is_identifier
        Whether it becomes part of a state's name.
    """

    longest: int = LONGEST_NAME
    is_identifier: bool = False

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the schema that calls this reader."""
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the JSON schema: a text."""
        return {"type": "string", "maxLength": self.longest}

    def _read(self, value: object) -> str:
        if not isinstance(value, str):
            raise Faults([("", Message("got-no-text", got=describe(value)))])
        if len(value) > self.longest:
            raise Faults([("", Message("text-too-long", length=len(value), most=self.longest))])
        if any(unicodedata.category(letter).startswith("C") for letter in value):
            raise Faults([("", Message("text-with-control-characters"))])
        if self.is_identifier and not value.isidentifier():
            raise Faults([("", Message("name-no-identifier", got=value))])
        if not value.strip():
            raise Faults([("", Message("name-empty"))])
        return value


class PerSignal(Enum):
    """What a number in a table of signals measures."""

    BOUND = "the signal itself"
    GAIN = "force per signal"
    WEIGHT = "squared force per squared signal"


@dataclass(frozen=True, slots=True)
class SignalTable:
    """Reader of a table with one number for each of some states or outputs.

    Parameters
    ----------
    kind
        What the numbers measure. A bound is positive, a weight not negative; only bounds may
        name outputs.
    words
        Texts accepted in place of a table.
    """

    kind: PerSignal
    words: tuple[str, ...] = ()

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the schema that calls this reader."""
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the JSON schema: a table of numbers or texts with units, or one of the words."""
        number = {"anyOf": [{"type": "number"}, {"type": "string"}]}
        table = {"type": "object", "additionalProperties": number}
        return {"anyOf": [table, {"enum": list(self.words)}]} if self.words else table

    def _read(self, value: object, info: ValidationInfo) -> str | dict[str, float]:
        if isinstance(value, str) and value in self.words:
            return value
        if not isinstance(value, dict):
            words = one_of(self.words) if self.words else None
            kind = "got-no-signals-or-word" if words else "got-no-signals"
            raise Faults([("", Message(kind, got=describe(value), words=words))])
        context = context_of(info)
        if not context.states:  # the plant is at fault, and that is said there
            return {}
        is_bound = self.kind is PerSignal.BOUND
        signals = {**context.states, **(context.outputs if is_bound else {})}
        numbers: dict[str, float] = {}
        faults: list[Misfit] = []
        for name, number in value.items():
            if name not in signals:
                faults.append((name, Message("no-such-signal", hint=propose(name, signals))))
                continue
            try:
                numbers[name] = _read_within(self._range(signals[name], context), number)
            except Refused as error:
                faults.append((name, error.message))
        if faults:
            raise Faults(faults)
        return numbers

    def _range(self, signal: Dimension, context: Context) -> Range:
        gain = context.states["F"].per(signal)
        if self.kind is PerSignal.BOUND:
            return Range(signal, 0.0, LARGEST_NUMBER, above=0.0)
        if self.kind is PerSignal.WEIGHT:
            return Range(gain.squared(), 0.0, LARGEST_NUMBER)
        return Range(gain, -LARGEST_NUMBER, LARGEST_NUMBER)


def one_of(words: Sequence[str]) -> Message | str:
    """Return words in quotes as alternatives: "a", "b" or "c"."""
    *first, last = (f'"{word}"' for word in words)
    return Message("one-or-other", first=", ".join(first), last=last) if first else last


def describe(value: object) -> Message | str:
    """Return a short description of a TOML value for a message.

    Parameters
    ----------
    value
        Anything that tomllib returns.

    Returns
    -------
    str or Message
        As it was written, or what it is.

    Examples
    --------
    >>> describe(True), describe([1, 2]), describe("x" * 100)[:8]
    ('true', Message('an-array'), '"xxxxxxx')
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
        return Message("an-array")
    if isinstance(value, date | datetime | time):
        return Message("a-date")
    return Message("a-table")


def propose(name: str, known: Mapping[str, object] | Sequence[str]) -> Message:
    """Return a hint: what was meant, or the list of what there is.

    Parameters
    ----------
    name
        What was written.
    known
        What could have been meant.

    Examples
    --------
    >>> propose("base_mas", ["base_mass", "slider_mass"])
    Message('hint-did-you-mean', name='base_mass')
    """
    close = find_close(name, known)
    if close:
        return Message("hint-did-you-mean", name=close)
    return Message("hint-there-are", names=", ".join(known))


def find_close(name: str, known: Mapping[str, object] | Sequence[str]) -> str:
    """Return the known name that resembles a misspelt one; "" if none does.

    Examples
    --------
    >>> find_close("base_mas", ["base_mass", "slider_mass"]), find_close("x", ["base_mass"])
    ('base_mass', '')
    """
    return next(iter(get_close_matches(name, list(known), n=1, cutoff=0.6)), "")


def context_of(info: ValidationInfo) -> Context:
    """Return what the values of the profile that is being read depend on."""
    context = info.context
    if not isinstance(context, Context):
        raise TypeError("a profile is validated with a Context")
    return context


def _read_within(allowed: Range, value: object) -> float:
    """Return the SI value, or raise what is wrong with it."""
    number = _read_number(value, allowed.dimension)
    unit = f" {allowed.dimension.si}" if allowed.dimension.si else ""
    got = value.strip() if isinstance(value, str) else f"{number:g}{unit}"
    low, high, above = allowed.low, allowed.high, allowed.above
    if number <= above:
        raise Refused(Message("must-be-above", got=got, bound=above, unit=unit))
    if above == -inf and number < low and low == 0.0:
        raise Refused(Message("must-be-at-least", got=got, bound=0.0, unit=unit))
    if not low <= number <= high:
        raise Refused(Message("must-be-between", got=got, low=low, high=high, unit=unit))
    return number


def _read_number(value: object, dimension: Dimension) -> float:
    if isinstance(value, str):
        return parse_quantity(value, dimension)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Refused(Message("got-no-quantity", got=describe(value), expected=dimension.expected))
    if not abs(value) <= LARGEST:
        raise Refused(Message("got-infinite", got=describe(value)))
    return float(value)
