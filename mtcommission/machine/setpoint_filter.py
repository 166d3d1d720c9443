"""Filters that a control puts behind its setpoint generator: averages, shapers, taps.

Each is a short kernel, so the filtered setpoint ends with it: a moving average adds its length,
impulses the delay of the last one. They act on every size of move alike, which limits of
acceleration and jerk do not. What rings on without end (second order, band-stop) is none of them:
behind it a setpoint has no end, so neither a settling time nor a proof over every size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import fsum
from typing import Any

from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import (
    FIR,
    MOVING_AVERAGE,
    SHAPERS,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
)
from mtcommission.machine.keys import Misfit, keyed, read_table, table_schema
from mtcommission.machine.ranges import FILTER_DAMPINGS, FILTER_TIMES, FREQUENCIES, TAPS
from mtcommission.machine.readers import Array, KeyPath, Reading, Word, describe, one_of
from mtcommission.machine.shapers import Impulses, shape

KEYS: Mapping[str, tuple[str, ...]] = {
    "none": (),
    MOVING_AVERAGE: ("time",),
    TWO_AVERAGES: ("time", "second_time"),
    FIR: ("taps", "spacing"),
    **dict.fromkeys(SHAPERS, ("frequency", "damping")),
}
"""What states each kind of setpoint filter."""

ENDLESS = ("second_order", "band_stop")
"""Kinds that controls have, and behind which a setpoint never ends."""

UNITS = {"time": "s", "second_time": "s", "frequency": "Hz"}

MOST_TAPS = 64
WHOLE = 1e-6
"""By how much the sum of taps may miss 1: their last printed digit."""


class _Kind(Word):
    """The kind of filter; what controls have and we do not is told why."""

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        if value in ENDLESS:
            reading.refuse(place, Message("filter-without-end", got=describe(value)))
            return None
        return super().read(value, place, reading)


class _Taps(Array):
    """Weights whose sum is 1."""

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        taps = super().read(value, place, reading)
        if taps is not None and abs(fsum(taps) - 1.0) > WHOLE:
            reading.refuse(place, Message("filter-taps-sum", sum=fsum(taps)))
        return taps


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointFilter:
    """One filter behind the setpoint generator."""

    kind: str = keyed(_Kind(dict(zip(KEYS, KEYS, strict=True))), "Kind of filter.", MOVING_AVERAGE)
    time: float = keyed(FILTER_TIMES, "Length of the average.", "20 ms", default=0.0)  # 0: none [s]
    second_time: float = keyed(
        FILTER_TIMES, "Length of the second average.", "10 ms", default=0.0
    )  # [s]; 0: there is none
    frequency_hz: float = keyed(
        FREQUENCIES,
        "Frequency of the mode that a shaper is designed for.",
        "40 Hz",
        key="frequency",
        default=0.0,
    )
    damping_ratio: float = keyed(
        FILTER_DAMPINGS, "Damping ratio of that mode.", "0.05", key="damping", default=0.0
    )
    taps: tuple[float, ...] = keyed(
        _Taps(TAPS, 2, MOST_TAPS),
        "Weights of a finite impulse response; their sum is 1.",
        "[0.25, 0.5, 0.25]",
        default=(),
    )
    spacing: float = keyed(FILTER_TIMES, "Time between the taps.", "2 ms", default=0.0)  # [s]

    @property
    def averages(self) -> tuple[float, ...]:
        """Lengths of the moving averages that follow each other [s]."""
        return tuple(time for time in (self.time, self.second_time) if time > 0.0)

    @property
    def impulses(self) -> Impulses:
        """The copies that shaper or taps send; a single one for averages."""
        if self.taps:
            delays = tuple(i * self.spacing for i in range(len(self.taps)))
            return Impulses(delays=delays, shares=self.taps)
        if not self.frequency_hz:
            return Impulses()
        return shape(self.kind, frequency_hz=self.frequency_hz, damping_ratio=self.damping_ratio)

    @property
    def duration(self) -> float:
        """By how much it lengthens every setpoint [s]."""
        return sum(self.averages) + self.impulses.delays[-1]


def moving_average(time: float) -> SetpointFilter | None:
    """Return a moving average, or None for no time at all.

    Examples
    --------
    >>> moving_average(0.02).duration
    0.02
    >>> moving_average(0.0) is None
    True
    """
    return SetpointFilter(kind=MOVING_AVERAGE, time=time) if time > 0.0 else None


class _Filter:
    """A setpoint filter as a table: exactly the keys that its kind needs; None for none."""

    def read(self, value: object, place: KeyPath, reading: Reading) -> SetpointFilter | None:
        """Return the filter."""
        kind = value.get("kind") if isinstance(value, dict) else None
        if not isinstance(value, dict) or not isinstance(kind, str) or kind not in KEYS:
            read_table(SetpointFilter, value, place, reading)
            return None
        own, every = KEYS[kind], {key for keys in KEYS.values() for key in keys}
        for key in (*own, *value):
            if key in every and (key in own) != (key in value):
                said = "filter-key-unused" if key in value else "filter-key-missing"
                reading.refuse((*place, key), Message(said, kind=kind))
        known = {key: one for key, one in value.items() if key in own or key not in every}
        found: SetpointFilter | None = read_table(SetpointFilter, known, place, reading)
        return None if kind == "none" else found

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return a reference to the schema of the table."""
        tables["SetpointFilter"] = table_schema(SetpointFilter, tables)
        return {"$ref": "#/$defs/SetpointFilter"}


AUTO = "auto"
CHOSEN_FILTER = Word({AUTO: AUTO, "none": None}, _Filter(), "got-no-filter")
HELD_FILTER = Word({"none": None}, _Filter(), "got-no-filter")


def list_misfits(
    item: SetpointFilter | None, kind: ControlKind, *, position_cycle: float
) -> Iterator[Misfit]:
    """Yield where a kind of control cannot be set to a filter; keys below that of the filter."""
    if item is None:
        return
    choice = kind.find_filter(item.kind)
    if choice is None:
        there = one_of(["none", *(choice.kind for choice in kind.setpoint_filters)])
        got = describe(item.kind)
        yield "", Message("control-without-filter", got=got, control=kind.key, has=there)
        return
    values = {
        "time": item.time,
        "second_time": item.second_time,
        "frequency": item.frequency_hz,
        "damping": item.damping_ratio,
    }
    ranges = _ranges(choice, position_cycle)
    for key in KEYS[item.kind]:
        low, high = ranges.get(key, (0.0, 0.0))
        if key in ranges and not low <= values[key] <= high:
            said, unit = f"control-filter-{key.removeprefix('second_')}", UNITS.get(key, "")
            value = values[key]
            yield key, Message(said, got=value, unit=unit, low=low, high=high, control=kind.key)


def _ranges(choice: FilterChoice, position_cycle: float) -> dict[str, tuple[float, float]]:
    """What a control takes, by the profile's keys; plain ranges bound what it leaves open."""
    least_time, most_time = choice.possible_times(position_cycle)
    times = least_time, min(most_time, FILTER_TIMES.linear.high)
    most = min(choice.most_frequency_hz, FREQUENCIES.linear.high)
    return {
        "time": times,
        "second_time": times,
        "frequency": (choice.least_frequency_hz, most),
        "damping": (choice.least_damping, choice.most_damping),
    }
