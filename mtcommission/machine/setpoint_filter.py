"""Filters that a control puts behind its setpoint generator: averages, shapers, taps.

Each is a short kernel, so the filtered setpoint ends with it: a moving average adds its length,
impulses the delay of the last one. They act on every size of move alike, which limits of
acceleration and jerk do not. What rings on without end (second order, band-stop) is none of them:
behind it a setpoint has no end, so neither a settling time nor a proof over every size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import exp, floor, fsum, pi, sqrt
from typing import Any, NamedTuple

from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import (
    FIR,
    MOVING_AVERAGE,
    SHAPERS,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
)
from mtcommission.machine import readers as of
from mtcommission.machine.keys import Misfit, keyed, read_table, table_schema
from mtcommission.machine.readers import Array, KeyPath, Reading, Word, describe, one_of

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
    time: float = keyed(
        of.FILTER_TIMES, "Length of the average.", "20 ms", default=0.0
    )  # 0: none [s]
    second_time: float = keyed(
        of.FILTER_TIMES, "Length of the second average.", "10 ms", default=0.0
    )  # [s]; 0: there is none
    frequency_hz: float = keyed(
        of.FREQUENCIES,
        "Frequency of the mode that a shaper is designed for.",
        "40 Hz",
        key="frequency",
        default=0.0,
    )
    damping_ratio: float = keyed(
        of.FILTER_DAMPINGS, "Damping ratio of that mode.", "0.05", key="damping", default=0.0
    )
    taps: tuple[float, ...] = keyed(
        _Taps(of.TAPS, 2, MOST_TAPS),
        "Weights of a finite impulse response; their sum is 1.",
        "[0.25, 0.5, 0.25]",
        default=(),
    )
    spacing: float = keyed(of.FILTER_TIMES, "Time between the taps.", "2 ms", default=0.0)  # [s]

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
    """Return a moving average, or None for no time at all."""
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


SETTINGS = (
    ("time", "time", "s"),
    ("second_time", "second_time", "s"),
    ("frequency", "frequency_hz", "Hz"),
    ("damping", "damping_ratio", ""),
)
"""Of averages and shapers: key, field and unit."""


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
    ranges = _ranges(choice, position_cycle)
    for key, name, unit in SETTINGS:
        value, (low, high) = getattr(item, name), ranges[key]
        if key in KEYS[item.kind] and not low <= value <= high:
            ends = f"{low:g}", f"{high:g} {unit}".rstrip()
            said = {"low": ends[0], "high": ends[1], "control": kind.key}
            yield key, Message("control-filter-range", got=value, unit=unit, **said)


def _ranges(choice: FilterChoice, position_cycle: float) -> dict[str, tuple[float, float]]:
    """What a control takes, by the profile's keys; plain ranges bound what it leaves open."""
    least_time, most_time = choice.possible_times(position_cycle)
    times = least_time, min(most_time, of.FILTER_TIMES.linear.high)
    most = min(choice.most_frequency_hz, of.FREQUENCIES.linear.high)
    return {
        "time": times,
        "second_time": times,
        "frequency": (choice.least_frequency_hz, most),
        "damping": (choice.least_damping, choice.most_damping),
    }


# Input shapers: a few scaled and delayed copies of a setpoint whose vibrations cancel.
#
# Klipper: klippy/extras/shaper_defs.py at commit 84104bbb (7 August 2026). Its EI, 2HUMP_EI and
# 3HUMP_EI are those of 16 September 2025 (commit 5da026a3), fitted to the damped conditions as
# polynomials of the damping ratio; 3HUMP_EI left a comma out until 31 March 2026 (0d1445a7), so
# older ones leave more vibration than is computed here.
#
# Marlin's Fixed-Time Motion: Marlin/src/module/ft_motion/shaping.cpp at commit 195278e4 (2025) and
# ft_motion.cpp at 000420e3. It computes the position every ``GRID`` and shapes those samples: the
# first copy's delay is rounded to whole samples, the others are multiples of the rounded one, so a
# shaper is as far off as its first copy (48 Hz: 10.4 ms become 10 ms, the shaper of 50 Hz). Every
# copy, MZV's too, is reduced by what the vibration loses in half a period, and the EI family is the
# classical one, as Klipper's was before 2025. Between two samples the steps are evenly spaced
# (stepping.cpp at 14373a66): the straight lines shrink what a mode at f gets by sinc²(f ``GRID``),
# 0.8 % at 50 Hz and 3 % at 100 Hz, all moves alike; that is left out.


TOLERANCE = 0.05
"""Vibration that the EI shapers leave at the design frequency [-] (the usual 5 %)."""

GRID = 1e-3
"""Time between two samples of Marlin's Fixed-Time Motion [s]: FTM_FS is 1000 Hz unless a build
changes it."""


class Impulses(NamedTuple):
    """A sum of delayed copies."""

    delays: tuple[float, ...] = (0.0,)  # the first is 0 [s]
    shares: tuple[float, ...] = (1.0,)  # their sum is 1 [-]


@lru_cache(maxsize=4096)
def shape(kind: str, *, frequency_hz: float, damping_ratio: float) -> Impulses:
    """Return the impulses of a shaper, whose kind is one of ``SHAPERS``.

    Natural frequency [Hz] and damping ratio [-] are those of the mode that shall stay at rest.

    Source: Singer & Seering 1990 (ZV, ZVD and more derivatives); Singhose, Seering & Singer 1994
    (EI) and 1997 (two and three humps); MZV, the correction for damping and the EI family with
    damping as in the sources above.

    Examples
    --------
    >>> shape("zvd", frequency_hz=50.0, damping_ratio=0.0)
    Impulses(delays=(0.0, 0.01, 0.02), shares=(0.25, 0.5, 0.25))
    """
    if kind == "ei":
        periods, weights = _ei(damping_ratio, TOLERANCE)
    elif kind in HUMPS:
        times, sizes = HUMPS[kind]
        periods, weights = _each(times, damping_ratio), _each(sizes, damping_ratio)
    elif kind in MARLIN:
        apart = GRID * max(floor(_samples(kind, frequency_hz, damping_ratio) + 0.5), 1)
        weights = _faded(MARLIN[kind][1], 0.5, damping_ratio)
        periods = [i * apart * frequency_hz for i in range(len(weights))]
    else:
        periods, weights = _even(*EVEN[kind], damping_ratio)
    total = sum(weights)
    return Impulses(
        delays=tuple(period / frequency_hz for period in periods),
        shares=tuple(weight / total for weight in weights),
    )


def frequencies_told_apart(
    kind: str, *, frequency_hz: float, damping_ratio: float
) -> tuple[float, ...]:
    """Return the frequencies around one that a control tells apart with a kind of shaper [Hz].

    The same one; on a grid the middles of the ranges that give the nearest spacing of the copies,
    one sample less and one more. ``frequency_hz`` and ``damping_ratio`` [-] are what the shaper is
    wanted for.

    Examples
    --------
    >>> frequencies_told_apart("zv", frequency_hz=48.0, damping_ratio=0.0)
    (48.0,)
    >>> frequencies_told_apart("marlin_zv", frequency_hz=48.0, damping_ratio=0.0)
    (55.55555555555556, 50.0, 45.45454545454545)
    """
    if kind not in MARLIN:
        return (frequency_hz,)
    samples = _samples(kind, frequency_hz, damping_ratio)
    nearest = floor(samples + 0.5)
    return tuple(frequency_hz * samples / n for n in (nearest - 1, nearest, nearest + 1) if n > 0)


def name_shaper(kind: str) -> str:
    """Return a kind as a sheet names it."""
    return kind.removeprefix(OF_MARLIN).upper()


def _samples(kind: str, frequency_hz: float, damping_ratio: float) -> float:
    """Between two copies on Marlin's grid, not yet rounded."""
    return MARLIN[kind][0] / (frequency_hz * sqrt(1.0 - damping_ratio**2) * GRID)


def _even(
    spacing: float, shares: tuple[float, ...], damping_ratio: float
) -> tuple[list[float], list[float]]:
    """Evenly spaced copies; each is reduced by what the vibration of the one before has lost."""
    root = sqrt(1.0 - damping_ratio**2)
    return [i * spacing / root for i in range(len(shares))], _faded(shares, spacing, damping_ratio)


def _faded(shares: tuple[float, ...], spacing: float, damping_ratio: float) -> list[float]:
    """Each share less what a vibration loses over so many periods for each copy before it."""
    decay = exp(-2.0 * pi * damping_ratio / sqrt(1.0 - damping_ratio**2) * spacing)
    return [share * decay**i for i, share in enumerate(shares)]


def _ei(zeta: float, V: float) -> tuple[list[float], list[float]]:
    """Three copies over one damped period, fitted to V at the frequency and 0 on both sides."""
    first = _series((0.24968 + 0.24961 * V, 0.80008 + 1.23328 * V, 0.49599 + 3.17316 * V), zeta)
    last = _series((0.25149 + 0.21474 * V, -0.83249 + 1.41498 * V, 0.85181 - 4.90094 * V), zeta)
    middle = (
        0.4999,
        0.46159 * V + 8.57843 * V**2,
        4.26169 * V - 108.644 * V**2,
        1.75601 * V + 336.989 * V**2,
    )
    period = 1.0 / sqrt(1.0 - zeta**2)
    return [0.0, _series(middle, zeta) * period, period], [first, 1.0 - first - last, last]


def _series(coefficients: tuple[float, ...], zeta: float) -> float:
    return sum(one * zeta**i for i, one in enumerate(coefficients))


def _each(rows: tuple[tuple[float, ...], ...], zeta: float) -> list[float]:
    return [_series(row, zeta) for row in rows]


def _two_humps() -> tuple[float, ...]:
    V = TOLERANCE
    X = (V**2 * (sqrt(1.0 - V**2) + 1.0)) ** (1.0 / 3.0)
    outer = (3.0 * X**2 + 2.0 * X + 3.0 * V**2) / (16.0 * X)
    return outer, 0.5 - outer, 0.5 - outer, outer


def _three_humps() -> tuple[float, ...]:
    V = TOLERANCE
    outer = (1.0 + 3.0 * V + 2.0 * sqrt(2.0 * V * (1.0 + V))) / 16.0
    inner = 0.25 * (1.0 - V)
    return outer, inner, 1.0 - 2.0 * (outer + inner), inner, outer


_EDGE = 1.0 - 1.0 / sqrt(2.0)
_V = TOLERANCE

EVEN: Mapping[str, tuple[float, tuple[float, ...]]] = {
    "zv": (0.5, (0.5, 0.5)),
    "mzv": (0.375, (_EDGE, 1.0 - 2.0 * _EDGE, _EDGE)),
    "zvd": (0.5, (0.25, 0.5, 0.25)),
}
"""Spacing of the impulses in periods of the damped vibration, and their shares without damping."""

OF_MARLIN = "marlin_"

MARLIN: Mapping[str, tuple[float, tuple[float, ...]]] = {
    **{f"{OF_MARLIN}{kind}": even for kind, even in EVEN.items()},
    f"{OF_MARLIN}zvdd": (0.5, (0.125, 0.375, 0.375, 0.125)),
    f"{OF_MARLIN}zvddd": (0.5, (0.0625, 0.25, 0.375, 0.25, 0.0625)),
    f"{OF_MARLIN}ei": (0.5, (0.25 * (1.0 + _V), 0.5 * (1.0 - _V), 0.25 * (1.0 + _V))),
    f"{OF_MARLIN}2hump_ei": (0.5, _two_humps()),
    f"{OF_MARLIN}3hump_ei": (0.5, _three_humps()),
}
"""The same for what Marlin's Fixed-Time Motion sends, before its grid."""

HUMPS: Mapping[str, tuple[tuple[tuple[float, ...], ...], tuple[tuple[float, ...], ...]]] = {
    "2hump_ei": (
        (
            (0.0,),
            (0.49890, 0.16270, -0.54262, 6.16180),
            (0.99748, 0.18382, -1.58270, 8.17120),
            (1.49920, -0.09297, -0.28338, 1.85710),
        ),
        (
            (0.16054, 0.76699, 2.26560, -1.22750),
            (0.33911, 0.45081, -2.58080, 1.73650),
            (0.34089, -0.61533, -0.68765, 0.42261),
            (0.15997, -0.60246, 1.00280, -0.93145),
        ),
    ),
    "3hump_ei": (
        (
            (0.0,),
            (0.49974, 0.23834, 0.44559, 12.4720),
            (0.99849, 0.29808, -2.36460, 23.3990),
            (1.49870, 0.10306, -2.01390, 17.0320),
            (1.99960, -0.28231, 0.61536, 5.40450),
        ),
        (
            (0.11275, 0.76632, 3.29160, -1.44380),
            (0.23698, 0.61164, -2.57850, 4.85220),
            (0.30008, -0.19062, -2.14560, 0.13744),
            (0.23775, -0.73297, 0.46885, -2.08650),
            (0.11244, -0.45439, 0.96382, -1.46000),
        ),
    ),
}
"""Times in periods of the undamped vibration and shares, by rising power of the damping ratio."""
