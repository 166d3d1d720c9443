"""Delays from the slope of the phase: where the fit begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mtcommission.identify.fit.lines import Lines
from mtcommission.identify.fit.projection import Poles, project

STEP = 0.04
"""Distance of the two lines whose phases are compared, in the highest frequency."""
LONGEST = 5e-3
"""Longest delay at which a fit begins [s]."""
AROUND = (-3, -2, -1, 1, 2, 3)
"""Delays tried beside the known one, in sixteenths of the highest frequency's period."""


def slope_of_phase(lines: Lines) -> float:
    """Return a delay from the median slope of the phase over the upper four fifths [s].

    A mode turns the phase within its width only, so that half of all pairs of lines see none; what
    is left is the delay.
    """
    f = lines.frequency_hz
    step = STEP * f[-1]
    low = np.flatnonzero((f > 0.2 * f[-1]) & (f < f[-1] - step))
    if low.size < 3:
        return 0.0
    high = np.searchsorted(f, f[low] + step)
    turn = np.angle(lines.values[high] * np.conj(lines.values[low]))
    slope = turn / (2 * np.pi * (f[high] - f[low]))
    return float(np.clip(-np.median(slope), 0.0, LONGEST))


def align(responses: Sequence[Lines], poles: Poles) -> Poles:
    """Return the poles with the best delay of each response among some near-by ones.

    The cost has a minimum at each turn of the phase; least squares alone stays in the nearest.
    """
    delays = poles.delays.copy()
    for place, lines in enumerate(responses):
        unit = 1.0 / (16.0 * lines.frequency_hz[-1])
        tried = delays[place] + unit * np.array([0, *AROUND])
        costs = [project([lines], poles.of(place, delay=d)).cost for d in tried]
        delays[place] = tried[int(np.argmin(costs))]
    return replace(poles, delays=delays)
