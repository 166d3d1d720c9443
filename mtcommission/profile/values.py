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

    def __init__(self, items: Sequence[tuple[str, str | Message]]) -> None:
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
        except ValueError as error:
            beside = f', or "{word}"' if word else ""
            raise Faults([("", f"{error}{beside}")]) from error


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
            raise Faults([("", f"got {describe(value)}, must be a text in quotes")])
        if len(value) > self.longest:
            message = f"got {len(value)} characters, at most {self.longest} are allowed"
            raise Faults([("", message)])
        if any(unicodedata.category(letter).startswith("C") for letter in value):
            raise Faults([("", "got control characters, remove them")])
        if self.is_identifier and not value.isidentifier():
            message = f'got "{value}", must be letters, digits and _, not beginning with a digit'
            raise Faults([("", message)])
        if not value.strip():
            raise Faults([("", "got an empty text, give a name")])
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
            words = "".join(f'"{word}" or ' for word in self.words)
            raise Faults([("", f"got {describe(value)}, must be {words}a table of signals")])
        context = context_of(info)
        if not context.states:  # the plant is at fault, and that is said there
            return {}
        is_bound = self.kind is PerSignal.BOUND
        signals = {**context.states, **(context.outputs if is_bound else {})}
        numbers: dict[str, float] = {}
        faults: list[tuple[str, str]] = []
        for name, number in value.items():
            if name not in signals:
                faults.append((name, f"no such signal{propose(name, signals)}"))
                continue
            try:
                numbers[name] = _read_within(self._range(signals[name], context), number)
            except ValueError as error:
                faults.append((name, str(error)))
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


def describe(value: object) -> str:
    """Return a short description of a TOML value for a message.

    Parameters
    ----------
    value
        Anything that tomllib returns.

    Returns
    -------
    str

    Examples
    --------
    >>> describe(True), describe([1, 2]), describe("x" * 100)[:8]
    ('true', 'an array', '"xxxxxxx')
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        shown = "".join(letter if letter.isprintable() else "?" for letter in value)
        return f'"{shown[:40]}..."' if len(shown) > 40 else f'"{shown}"'
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, int):
        return f"{value}" if abs(value) < 10**18 else "an integer beyond all bounds"
    if isinstance(value, list):
        return "an array"
    if isinstance(value, date | datetime | time):
        return "a date or time"
    return "a table"


def propose(name: str, known: Mapping[str, object] | Sequence[str]) -> str:
    """Return "; did you mean ...?" or the list of what there is.

    Parameters
    ----------
    name
        What was written.
    known
        What could have been meant.

    Returns
    -------
    str

    Examples
    --------
    >>> propose("base_mas", ["base_mass", "slider_mass"])
    '; did you mean "base_mass"?'
    """
    close = find_close(name, known)
    return f'; did you mean "{close}"?' if close else f"; there are {', '.join(known)}"


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
    """Return the SI value, or raise ValueError with the message."""
    number = _read_number(value, allowed.dimension)
    unit = f" {allowed.dimension.si}" if allowed.dimension.si else ""
    got = f"got {value.strip()}" if isinstance(value, str) else f"got {number:g}{unit}"
    if number <= allowed.above:
        raise ValueError(f"{got}, must be > {allowed.above:g}{unit}")
    if allowed.above == -inf and number < allowed.low and allowed.low == 0.0:
        raise ValueError(f"{got}, must be >= 0{unit}")
    if not allowed.low <= number <= allowed.high:
        raise ValueError(
            f"{got}, must be from {allowed.low:g} to {allowed.high:g}{unit}; check the unit"
        )
    return number


def _read_number(value: object, dimension: Dimension) -> float:
    if isinstance(value, str):
        return parse_quantity(value, dimension)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"got {describe(value)}, must be {dimension.name}, {dimension.usual}")
    if not abs(value) <= LARGEST:
        raise ValueError(f"got {describe(value)}, must be a finite number")
    return float(value)
