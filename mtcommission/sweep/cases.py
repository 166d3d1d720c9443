"""What varies: ranges -> the settings of each case, and its profile."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import lru_cache
from hashlib import sha256
from math import nan, pi, prod
from typing import Any

import numpy as np
import tomlkit

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message, Value
from mtcommission.optimal.solution import Bound
from mtcommission.units.quantities import NUMBER
from mtcommission.units.symbols import read_unit
from mtcommission.version import __version__

FORCE_KEY = "drive.max_force"
PEAKS_KEY = "requirements.peaks."
"""What follows is a signal; where its bound varies, an optimal control keeps it."""
MOST_VALUES = 1_000_000
"""Values of one key; a table of them still opens."""

Settings = tuple[tuple[str, str], ...]
"""Key and text of each varied value of one case."""


class Quantity(Enum):
    """What is computed for each case."""

    OPTIMAL = "optimal"
    LIMITS = "limits"
    RUN = "run"


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """Keys that vary together.

    Parameters
    ----------
    keys
        Dotted paths in the profile; elements of arrays by number, ``moves[1].distance`` (counted
        from 1) or ``moves.0.distance`` (from 0).
    rows
        Texts as the profile's reader gets them, one for each key.
    lines
        Line of each row in the table that it came from; none for a range.
    """

    keys: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A sweep: a profile, what varies, and what is computed.

    Parameters
    ----------
    profile_text
        TOML of the machine as it is.
    where
        Name of the profile for messages.
    axes
        What varies; none gives the profile's own case.
    is_paired
        Whether the axes go together, value by value, instead of each with each.
    quantity
        What is computed.
    move
        Which of the profile's moves ``optimal`` solves, counted from 1.
    bounds
        Bounds on states and outputs for ``optimal``.
    created
        When the sweep was begun; goes into the records of ``run``.
    """

    profile_text: str
    where: str
    axes: tuple[Axis, ...]
    is_paired: bool = False
    quantity: Quantity = Quantity.OPTIMAL
    move: int = 1
    bounds: tuple[Bound, ...] = ()
    created: str = ""

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys that vary."""
        return tuple(key for axis in self.axes for key in axis.keys)

    @property
    def count(self) -> int:
        """Number of cases."""
        sizes = [len(axis.rows) for axis in self.axes]
        return min(sizes, default=1) if self.is_paired else prod(sizes)

    @property
    def digest(self) -> str:
        """SHA-256 of all that the rows depend on, of the version, too."""
        bounds = [[bound.name, bound.value] for bound in self.bounds]
        axes = [[axis.keys, axis.rows] for axis in self.axes]
        parts = [self.base_digest, axes, self.is_paired, bounds]
        return sha256(json.dumps(parts).encode()).hexdigest()

    @property
    def base_digest(self) -> str:
        """SHA-256 of what all cases share."""
        bounds = [[bound.name, bound.value] for bound in self.bounds]
        parts = [__version__, self.profile_text, self.quantity.value, self.move, bounds]
        return sha256(json.dumps(parts).encode()).hexdigest()

    def settings(self, index: int) -> Settings:
        """Return the varied values of one case; of a grid the last axis runs fastest."""
        chosen: list[tuple[str, str]] = []
        for axis in reversed(self.axes):
            place = index if self.is_paired else index % len(axis.rows)
            index = index if self.is_paired else index // len(axis.rows)
            chosen[:0] = zip(axis.keys, axis.rows[place], strict=True)
        return tuple(chosen)


def check_plan(plan: Plan) -> None:
    """Raise InputError where axes share a key, or are paired and of different length.

    Parameters
    ----------
    plan
        Any plan.
    """
    faults = []
    twice = sorted({key for key in plan.keys if plan.keys.count(key) > 1})
    faults += [
        Fault(where="--vary", key=key, message=Message("sweep-varies-twice")) for key in twice
    ]
    sizes = {len(axis.rows) for axis in plan.axes}
    if plan.is_paired and len(sizes) > 1:
        got = tuple(f"{axis.keys[0]} {len(axis.rows)}" for axis in plan.axes)
        faults.append(Fault(where="--paired", message=Message("sweep-unequal-lengths", got=got)))
    if faults:
        raise InputError(faults)
    vary_profile(plan.profile_text, plan.settings(0), where=plan.where)


def read_axis(text: str, *, where: str) -> Axis:
    """Return what ``KEY=RANGE`` asks for.

    Parameters
    ----------
    text
        Key and range.
    where
        Option, for messages.

    Raises
    ------
    InputError
        If it is no range.

    Examples
    --------
    >>> read_axis("plant.slider_mass=600kg:900kg:3", where="--vary").rows
    (('600.0 kg',), ('750.0 kg',), ('900.0 kg',))
    """
    key, separator, values = text.partition("=")
    if not separator or not key.strip():
        raise InputError([Fault(where=where, message=Message("sweep-no-axis", got=repr(text)))])
    return Axis(keys=(key.strip(),), rows=read_range(values, where=f"{where} {key.strip()}"))


def read_range(text: str, *, where: str) -> tuple[tuple[str, ...], ...]:
    """Return the values of a range as one-column rows of texts.

    Parameters
    ----------
    text
        ``START:STOP:COUNT``, ``log:START:STOP:COUNT``, ``random:LOW:HIGH:COUNT:SEED`` or a comma
        list; ends with or without a unit.
    where
        Option, for messages.

    Raises
    ------
    InputError
        If it is none of them.

    Examples
    --------
    >>> read_range("log:1:100:3", where="--f-max")
    (('1.0',), ('10.0',), ('100.0',))
    """
    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 1:
        values = [value.strip() for value in text.split(",")]
        if not all(values):
            message = Message("sweep-empty-value", got=repr(text))
            raise InputError([Fault(where=where, message=message)])
        return tuple((value,) for value in values)
    kind = parts.pop(0) if parts[0] in ("log", "random") else "even"
    try:
        numbers, unit = _spread(kind, parts)
    except _NoRangeError as error:
        message = Message("sweep-no-range", got=repr(text), reason=error.reason)
        raise InputError([Fault(where=where, message=message)]) from error
    return tuple((f"{number!r} {unit}".strip(),) for number in numbers)


class _NoRangeError(ValueError):
    """A text that is no range, and why."""

    def __init__(self, kind: str, /, **values: Value) -> None:
        self.reason = Message(kind, **values)


def _spread(kind: str, parts: list[str]) -> tuple[list[float], str]:
    wanted = {"even": 3, "log": 3, "random": 4}[kind]
    if len(parts) != wanted:
        raise _NoRangeError("sweep-forms-of-ranges")
    (low, low_unit), (high, high_unit) = _split(parts[0]), _split(parts[1])
    # A bare number is SI, so "300:20kN" could be meant in two ways.
    if low_unit != high_unit:
        raise _NoRangeError("sweep-ends-with-two-units")
    whole = [part for part in parts[2:] if not part.isascii() or not part.isdigit()]
    if whole:
        raise _NoRangeError("sweep-no-whole-number", got=repr(whole[0]))
    count = int(parts[2])
    if not 1 <= count <= MOST_VALUES:
        raise _NoRangeError("sweep-count-of-range", most=MOST_VALUES)
    if kind == "log" and not (low > 0.0 and high > 0.0):
        raise _NoRangeError("sweep-logarithm-of-zero")
    if kind == "random":
        found = np.random.default_rng(int(parts[3])).uniform(low, high, count)
    else:
        found = (np.geomspace if kind == "log" else np.linspace)(low, high, count)
    return found.tolist(), low_unit


def _split(text: str) -> tuple[float, str]:
    match = NUMBER.match(text)
    if match is None:
        raise _NoRangeError("sweep-no-number", got=repr(text))
    return float(match[0]), text[match.end() :].strip()


@lru_cache(maxsize=4096)  # each case asks several times, all cases share most of their texts
def si_number(text: str) -> float:
    """Return the SI value of a number with or without a unit; nan for a word.

    Examples
    --------
    >>> si_number("2 kN"), si_number("auto")
    (2000.0, nan)
    """
    match = NUMBER.match(text)
    if match is None:
        return nan
    try:
        unit = read_unit(text[match.end() :].strip())[0]
    except ValueError:
        return nan
    # Exact as the profile's reader is, so that both take the same number.
    return float(Fraction(match[0]) * unit.factor) * pi**unit.pi_power


def unit_of(text: str) -> str:
    """Return what follows the number of a quantity; the whole text where there is no number.

    Examples
    --------
    >>> unit_of("2 kN"), unit_of("auto")
    ('kN', 'auto')
    """
    match = NUMBER.match(text)
    return text[match.end() :].strip() if match else text


def vary_profile(text: str, settings: Settings, *, where: str) -> str:
    """Return a profile with some values replaced, comments and lines kept.

    Parameters
    ----------
    text
        TOML.
    settings
        Keys and texts.
    where
        Name of the profile, for messages.

    Returns
    -------
    str
        Whether keys and values are allowed is for the profile's reader to say.

    Raises
    ------
    InputError
        If a key leads through a value, or the text is no TOML.
    """
    mark = _unused_mark(text)
    template = _mark_places(text, tuple(key for key, _ in settings), mark=mark, where=where)
    written = [_write_value(value) for _, value in settings]
    return re.sub(f'"{mark}([0-9]+)"', lambda match: written[int(match[1])], template)


def _unused_mark(text: str) -> str:
    mark = "@"
    while mark in text:
        mark += "@"
    return mark


@lru_cache(maxsize=16)  # all cases vary the same keys; reading the profile anew takes 6 ms
def _mark_places(text: str, keys: tuple[str, ...], *, mark: str, where: str) -> str:
    """The profile with a mark and a number in place of each value that varies."""
    try:
        document = tomlkit.parse(text)
    except ValueError as error:
        message = Message("sweep-no-toml", reason=str(error))
        raise InputError([Fault(where=where, message=message)]) from error
    for number, key in enumerate(keys):
        try:
            _place(document, plain_key(key).split("."), f"{mark}{number}")
        except LookupError as error:
            message = Message("sweep-no-element", example=EXAMPLE_KEY)
            raise InputError([Fault(where=where, key=key, message=message)]) from error
        except (TypeError, ValueError) as error:
            message = Message("sweep-no-key", example=EXAMPLE_KEY)
            raise InputError([Fault(where=where, key=key, message=message)]) from error
    return document.as_string()


def _write_value(value: str) -> str:
    """A number as TOML writes it, anything else as a string."""
    return tomlkit.item(float(value) if NUMBER.fullmatch(value) else value).as_string()


EXAMPLE_KEY = "moves[1].distance"

NUMBERED = re.compile(r"\[(\d+)\]")


def plain_key(key: str) -> str:
    """Return a key as the profile's reader names it, elements counted from 0.

    Examples
    --------
    >>> plain_key("moves[1].distance"), plain_key("moves.0.distance")
    ('moves.0.distance', 'moves.0.distance')
    """
    return NUMBERED.sub(lambda match: f".{int(match[1]) - 1}" if int(match[1]) else match[0], key)


def _place(node: Any, path: Sequence[str], value: str) -> None:
    *parents, last = path
    for part, following in zip(parents, path[1:], strict=True):
        if isinstance(node, list):
            node = node[int(part)]
        elif isinstance(node, dict):
            # A missing table is made, a missing array is not: its other elements are unknown.
            node = node[part] if following.isdigit() else node.setdefault(part, tomlkit.table())
        else:
            raise TypeError
    if isinstance(node, list) and not isinstance(node[int(last)], dict):
        node[int(last)] = value
    elif isinstance(node, dict):
        node[last] = value
    else:
        raise TypeError
