"""What varies: ranges and tables -> the settings of each case, and its profile."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import lru_cache
from hashlib import sha256
from math import isfinite, nan, pi, prod
from typing import Any, NoReturn

import numpy as np
import tomlkit

from mtcommission.base import __version__
from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message, Value
from mtcommission.base.units.quantities import NUMBER
from mtcommission.base.units.symbols import read_unit
from mtcommission.machine.moves import Positioning
from mtcommission.machine.profile.read import load_toml, parse_profile, read_key
from mtcommission.machine.readers import SignalValue

FORCE_KEY = "drive.max_force"
PEAKS_KEY = "requirements.peaks."
"""What follows is a signal; where its bound varies, an optimal control keeps it."""
MOST_VALUES = 1_000_000
"""Values of one key; a table of them still opens."""

PIECE = 200
"""Time-optimal controls computed together: milliseconds each, some tens on plants of many modes."""

Settings = tuple[tuple[str, str], ...]
"""Key and text of each varied value of one case."""


class Quantity(Enum):
    """What is computed for each case."""

    OPTIMAL = "optimal"
    LIMITS = "limits"
    RUN = "run"


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """Keys that vary together, as dotted paths in the profile, with a row of texts for each value.

    Elements of arrays by number: ``moves[1].distance``, or ``moves.0.distance`` counted from 0.
    """

    keys: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...] = ()  # of each row in the table that it came from; none for a range
    where: str = ""  # the table or option, for messages


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A sweep: a profile, what varies (each axis with each, or in pairs), and what is computed."""

    profile_text: str
    where: str  # name of the profile for messages
    axes: tuple[Axis, ...]
    is_paired: bool = False
    quantity: Quantity = Quantity.OPTIMAL
    move: int = 1  # which of the profile's moves ``optimal`` solves, counted from 1
    bounds: tuple[SignalValue, ...] = ()  # on states and outputs, for ``optimal``
    created: str = ""  # when the sweep was begun, ISO 8601; goes into the records of ``run``

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
        """SHA-256 of all that the rows and their places depend on."""
        bounds = [[bound.name, bound.value] for bound in self.bounds]
        axes = [[axis.keys, axis.rows] for axis in self.axes]
        what = [self.profile_text, self.quantity.value, self.move, bounds, axes, self.is_paired]
        return sha256(json.dumps([__version__, piece_size(self), *what]).encode()).hexdigest()

    def settings(self, index: int) -> Settings:
        """Return the varied values of one case; of a grid the last axis runs fastest."""
        chosen: list[tuple[str, str]] = []
        for axis in reversed(self.axes):
            place = index if self.is_paired else index % len(axis.rows)
            index = index if self.is_paired else index // len(axis.rows)
            chosen[:0] = zip(axis.keys, axis.rows[place], strict=True)
        return tuple(chosen)


def piece_size(plan: Plan) -> int:
    """Return how many cases are computed together: each piece is on disk within about a second.

    One where a case takes long: limits, whole runs, and optimal controls that keep a bound.
    """
    keys = [read_key(key) for key in plan.keys]
    moves = parse_profile(plan.profile_text, where=plan.where).moves[plan.move - 1 : plan.move]
    takes_long = (
        plan.quantity is not Quantity.OPTIMAL
        or plan.bounds
        or any(key.startswith(PEAKS_KEY) for key in keys)
        or f"moves.{plan.move - 1}.max_velocity" in keys
        or any(isinstance(move, Positioning) and isfinite(move.max_velocity) for move in moves)
    )
    return 1 if takes_long else PIECE


def read_axis(text: str, *, where: str) -> Axis:
    """Return what ``KEY=RANGE`` asks for; raise InputError, naming the option, otherwise."""
    key, separator, values = text.partition("=")
    if not separator or not key.strip():
        raise InputError.at(where, Message("sweep-no-axis", got=repr(text)))
    rows = read_range(values, where=f"{where} {key.strip()}")
    return Axis(keys=(key.strip(),), rows=rows, where=where)


def read_range(text: str, *, where: str) -> tuple[tuple[str, ...], ...]:
    """Return the values of a range as one-column rows of texts, ends with or without a unit.

    ``START:STOP:COUNT``, ``log:START:STOP:COUNT``, ``random:LOW:HIGH:COUNT:SEED`` or a comma list;
    anything else raises InputError.

    Examples
    --------
    >>> read_range("log:1:100:3", where="--f-max")
    (('1.0',), ('10.0',), ('100.0',))
    """

    def refuse(kind: str, **values: Value) -> NoReturn:
        why = Message("sweep-no-range", got=repr(text), reason=Message(kind, **values))
        raise InputError.at(where, why)

    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 1:
        values = [value.strip() for value in text.split(",")]
        if not all(values):
            refuse("sweep-empty-value")
        return tuple((value,) for value in values)
    kind = parts.pop(0) if parts[0] in ("log", "random") else "even"
    if len(parts) != (4 if kind == "random" else 3):
        refuse("sweep-forms-of-ranges")
    ends = [NUMBER.match(part) for part in parts[:2]]
    if ends[0] is None or ends[1] is None:
        refuse("sweep-no-number", got=repr(parts[0] if ends[0] is None else parts[1]))
    low, high, unit = float(ends[0][0]), float(ends[1][0]), unit_of(parts[0])
    # A bare number is SI, so "300:20kN" could be meant in two ways.
    if unit != unit_of(parts[1]):
        refuse("sweep-ends-with-two-units")
    for part in parts[2:]:
        if not (part.isascii() and part.isdigit()):
            refuse("usage-number", option=repr(part))
    count = int(parts[2])
    if not 1 <= count <= MOST_VALUES:
        refuse("sweep-count-of-range", most=MOST_VALUES)
    if kind == "log" and not (low > 0.0 and high > 0.0):
        refuse("sweep-logarithm-of-zero")
    if kind == "random":
        found = np.random.default_rng(int(parts[3])).uniform(low, high, count)
    else:
        found = (np.geomspace if kind == "log" else np.linspace)(low, high, count)
    return tuple((f"{number!r} {unit}".strip(),) for number in found.tolist())


@lru_cache(maxsize=4096)  # each case asks several times, all cases share most of their texts
def si_number(text: str) -> float:
    """Return the SI value of a number with or without a unit; nan for a word."""
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
    """Return what follows the number of a quantity; the whole text where there is no number."""
    match = NUMBER.match(text)
    return text[match.end() :].strip() if match else text


def vary_profile(text: str, settings: Settings, *, where: str) -> str:
    """Return a profile (TOML) with some values replaced, comments and lines kept.

    Whether keys and values are allowed is for the profile's reader to say.

    Raises InputError: a key leads through a value, or the text is no TOML.
    """
    mark = sha256(text.encode()).hexdigest()  # stands nowhere in the text
    template = _mark_places(text, tuple(key for key, _ in settings), mark=mark, where=where)
    written = [_write_value(value) for _, value in settings]
    return re.sub(f'"{mark}-([0-9]+)"', lambda match: written[int(match[1])], template)


@lru_cache(maxsize=16)  # all cases vary the same keys; reading the profile anew takes 6 ms
def _mark_places(text: str, keys: tuple[str, ...], *, mark: str, where: str) -> str:
    """The profile with a mark and a number in place of each value that varies."""
    load_toml(text, where=where)  # says where it is no TOML
    document = tomlkit.parse(text)
    for number, key in enumerate(keys):
        try:
            _place(document, read_key(key).split("."), f"{mark}-{number}")
        except (LookupError, TypeError, ValueError) as error:
            kind = "sweep-no-element" if isinstance(error, LookupError) else "sweep-no-key"
            message = Message(kind, example=EXAMPLE_KEY)
            raise InputError.at(where, message, key=key) from error
    return document.as_string()


def _write_value(value: str) -> str:
    """A number as TOML writes it, anything else as a string."""
    return tomlkit.item(float(value) if NUMBER.fullmatch(value) else value).as_string()


EXAMPLE_KEY = "moves[1].distance"


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
