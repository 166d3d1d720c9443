"""Which setpoint filters are worth a try on a machine: those of its control, near what rings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import combinations_with_replacement, pairwise, product
from math import pi, sqrt

import numpy as np

from mtcommission.controls.kind import (
    LONGEST_AVERAGE,
    MOVING_AVERAGE,
    SHAPERS,
    TWO_AVERAGES,
    FilterChoice,
    Jerk,
)
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.machine.control import Control
from mtcommission.machine.setpoint_filter import SetpointFilter, frequencies_told_apart

LEAST_CYCLES = 2
"""Position cycles over which an average takes a mean at least."""

JERK_TIMES, ALONE = 13, 60
"""Jerk times tried with each filter at first, logarithmic, beside those of what rings, and where
there is nothing else to choose (empirical)."""

TIMES = 8
"""Lengths of one moving average, or of two alike, that are tried at first, logarithmic, beside
those of what rings."""

PERIODS = (1, 2, 3)
"""Lengths of an average, or of a ramp, in periods of what rings: each of them cancels it [-]."""

SHARES = (0.7, 0.8, 1.0, 1.25)
"""Frequencies of a shaper that are tried at first where no ramp quiets anything besides, by that of
what rings: over a spread a robust one may lie well beside it (empirical) [-]."""

NEIGHBOURS = 3.0
"""Ratio of two frequencies up to which one shaper between them may quiet both: the widest, of three
humps, does so from half to one and a half of its own [-]."""

RINGING = 0.3
"""Damping ratio below which a pole of the closed loop rings [-]."""


def filters_to_try(control: Control, loop: SampledLoop) -> list[SetpointFilter | None]:
    """Return setpoint filters to begin with.

    None stands for none. Only the given one, or none, unless one is sought. ``loop``: the nominal
    one; what rings in it sets times and frequencies.
    """
    if not control.seeks_setpoint_filter:
        return [control.setpoint_filter]
    ringing = ringing_poles(loop)
    found: list[SetpointFilter | None] = [None]
    for choice in control.kind.setpoint_filters:
        found += _of_kind(choice, control, ringing)
    return list(dict.fromkeys(found))


def jerk_times_to_try(loop: SampledLoop, least: float, most: float, filters: int) -> list[float]:
    """Return jerk times to begin with [s]: a ramp over whole periods of what rings cancels it.

    ``filters``: behind how many.
    """
    usual = np.geomspace(least, most, JERK_TIMES if filters > 1 else ALONE).tolist()
    own = [n / frequency for frequency, _ in ringing_poles(loop) for n in PERIODS]
    return sorted({*usual, *(t for t in own if least < t < most)})


def ringing_poles(loop: SampledLoop) -> list[tuple[float, float]]:
    """Return natural frequency [Hz] and damping ratio of what rings in the loop, slowest first."""
    poles = np.log(np.linalg.eigvals(loop.lifted.A).astype(complex) + 1e-300) / loop.lifted.dt
    sizes = np.abs(poles)
    pairs = {
        (round(float(size) / (2.0 * pi), 6), float(-pole.real / size))
        for pole, size in zip(poles, sizes, strict=True)
        if pole.imag > 0.0 and -pole.real < RINGING * size
    }
    return sorted(pairs)


def _of_kind(
    choice: FilterChoice, control: Control, ringing: list[tuple[float, float]]
) -> Iterator[SetpointFilter]:
    kind, periods = choice.kind, [1.0 / frequency for frequency, _ in ringing]
    usual = np.geomspace(LEAST_CYCLES * control.position_cycle, LONGEST_AVERAGE, TIMES).tolist()
    if kind == MOVING_AVERAGE:
        times = [*usual, *(share * period for period in periods for share in PERIODS)]
        for time in _settable(choice, control, times):
            yield SetpointFilter(kind=kind, time=time)
    elif kind == TWO_AVERAGES:
        alike = [(time, time) for time in usual]
        for both in (*combinations_with_replacement(periods, 2), *alike):
            times = _settable(choice, control, both)
            if times:
                yield SetpointFilter(kind=kind, time=times[-1], second_time=times[0])
    elif kind in SHAPERS:
        is_alone = control.kind.jerk is Jerk.NONE
        places = _with_middles(ringing) if is_alone else ringing
        shares = SHARES if is_alone else (1.0,)
        low, high = _reached(choice, control)
        for (natural, own), share in product(places, shares):
            damping = min(max(own, choice.least_damping), choice.most_damping)
            frequency = share * natural
            for hz in frequencies_told_apart(kind, frequency_hz=frequency, damping_ratio=damping):
                if low <= hz <= high:
                    yield SetpointFilter(kind=kind, frequency_hz=hz, damping_ratio=damping)


def _with_middles(ringing: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """What rings, and the middle of any two neighbours: a robust shaper there may quiet both."""
    middles = [
        (sqrt(low * high), min(damping))
        for (low, high), damping in (zip(*both, strict=True) for both in pairwise(ringing))
        if high < NEIGHBOURS * low
    ]
    return [*ringing, *middles]


def _reached(choice: FilterChoice, control: Control) -> tuple[float, float]:
    """Frequencies of a shaper [Hz]: what rings faster than half a sample none of them reaches."""
    highest = min(choice.most_frequency_hz, 0.5 / control.position_cycle)
    return choice.least_frequency_hz, highest


def _settable(choice: FilterChoice, control: Control, times: Iterable[float]) -> list[float]:
    """The nearest lengths that can be typed in, rising; an average of one cycle is none."""
    cycle = control.position_cycle
    least, most = choice.times(cycle)
    least, step = max(least, LEAST_CYCLES * cycle), choice.unit(cycle)
    near = {round(min(max(time, least), most) / step) for time in times if least <= most}
    return [
        n * step
        for n in sorted(near)
        if least <= n * step * (1.0 + 1e-9) and n * step <= most * (1.0 + 1e-9)
    ]


def neighbours(control: Control, item: SetpointFilter | None, reach: float) -> list[SetpointFilter]:
    """Return filters of the same kind that are a little shorter and longer.

    ``control``: what it allows; ``reach``: how far, as a share of the times or of the frequency of
    the filter [-].
    """
    if item is None or not control.seeks_setpoint_filter:
        return []
    choice = control.kind.find_filter(item.kind)
    if choice is None:
        return []
    if item.frequency_hz:
        wanted = [item.frequency_hz * factor for factor in (1.0 - reach, 1.0 + reach)]
        told = frequencies_told_apart(
            item.kind, frequency_hz=item.frequency_hz, damping_ratio=item.damping_ratio
        )
        beside = (told[0], told[-1]) if len(told) > 1 else wanted
        low, high = _reached(choice, control)
        return [replace(item, frequency_hz=f) for f in beside if low <= f <= high]
    step = choice.unit(control.position_cycle)

    def near(time: float) -> list[float]:
        shift = max(round(reach * time / step), 1) * step
        return [t for t in _settable(choice, control, (time - shift, time + shift)) if t != time]

    times = [(time, item.second_time) for time in near(item.time)]
    if item.second_time:
        times += [(item.time, time) for time in near(item.second_time)]
    # Two averages are the same either way round: the longer one comes first.
    return [replace(item, time=max(both), second_time=min(both)) for both in times]
