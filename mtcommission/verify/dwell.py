"""What a deviation does once the setpoint has ended: residual and settling time."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from mtcommission.verify.prediction import Rebuilt
from mtcommission.verify.trace import Array

DECAY_TIMES = 4.0
"""Time constants 1/(ζ ω) of the slowest mode that must be seen of a dwell (facts)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """How a deviation comes to rest."""

    residual: float  # Largest magnitude after t_e + τ [m]
    peak: float  # Largest magnitude of all [m]
    # settling, earliest, latest: Time from the start of the setpoint until it stays within the
    # band, and the same if the band were wider, narrower by the noise [s]; inf: not within the
    # record.
    settling: float
    earliest: float
    latest: float


def needed_dwell(rebuilt: Rebuilt) -> float:
    """Return how long a dwell must be recorded to judge it [s]."""
    rates = [mode.damping_ratio * mode.natural_frequency for mode in rebuilt.plant.modes]
    return DECAY_TIMES / min(rates) if rates else 0.0


def settle(
    t: Array,
    deviation: Array,
    *,
    begin: float,
    rest: float,
    band: float,
    noise: float,
    slack: float,
) -> Settled:
    """Return residual, peak and settling time of a deviation."""
    size = np.abs(deviation)
    after = t >= rest - 1e-9
    moving = t >= begin

    def last(limit: float) -> float:
        if limit <= 0.0:
            return inf
        outside = np.flatnonzero(size[after] > limit)
        if not outside.size:
            return rest - begin
        if outside[-1] == after.sum() - 1:
            return inf
        return float(t[after][outside[-1] + 1]) - begin

    return Settled(
        residual=float(size[after].max()) if after.any() else inf,
        peak=float(size[moving].max()) if moving.any() else inf,
        settling=last(band),
        earliest=last(band + noise),
        latest=last(band - slack),
    )
