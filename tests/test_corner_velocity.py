"""The step of velocity at a corner against the residues of the same modes."""

from __future__ import annotations

from itertools import product
from math import pi

import numpy as np
import pytest

from mtcommission.limits.corner_velocity import find_corner_velocity
from mtcommission.machine.setpoint_filter import SetpointFilter
from tests.test_at_once import axis

MODES = ((45.0, 0.04, 0.8), (97.0, 0.03, 0.2))


@pytest.mark.parametrize(
    "item",
    [
        None,
        SetpointFilter(kind="2hump_ei", frequency_hz=60.0, damping_ratio=0.1),
        SetpointFilter(kind="moving_average", time=0.02),
    ],
    ids=lambda item: item.kind if item else "none",
)
def test_corner_velocity_leaves_just_the_band(item: SetpointFilter | None) -> None:
    """If it failed, square_corner_velocity would ring beyond the band, or be needlessly small.

    Each copy of the step takes its part of dv off q'; an average spreads it evenly, here over a
    thousand copies. The phases of several modes are not known at a corner of the path, so their
    amplitudes add.
    """
    more = 'frequency_spread = "4 %"\ndamping_spread = "30 %"\n[control]\nkind = "klipper"\n'
    found = find_corner_velocity(axis(list(MODES), 10.0, more), item)
    delays, shares = map(np.array, item.impulses) if item else (np.zeros(1), np.ones(1))
    if item and item.averages:
        delays, shares = item.averages[0] * (np.arange(1000) + 0.5) / 1000, np.full(1000, 1e-3)
    worst = 0.0
    for u, v in product((0.96, 1.0, 1.04), (0.7, 1.0, 1.3)):
        left = 0.0
        for hertz, zeta, gain in MODES:
            omega, ratio = 2 * pi * hertz * u, zeta * v
            pole = omega * complex(-ratio, (1 - ratio**2) ** 0.5)
            swing = shares @ np.exp(pole * (delays.max() - delays)) / pole.imag
            left += gain * found * abs(swing)
        worst = max(worst, left)
    assert worst == pytest.approx(0.8 * 20e-6, rel=2e-3)
