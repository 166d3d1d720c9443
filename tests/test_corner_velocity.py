"""The step of velocity at a corner against an integration of the same axis."""

from __future__ import annotations

from itertools import product
from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mtcommission.limits.corner_velocity import find_corner_velocity
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.setpoint_filter import SetpointFilter

PROFILE = """
schema = 1
[machine]
name = "head"
axis = "X"
source = "test"
[plant]
kind = "modal"
[[plant.modes]]
name = "belt"
frequency = "45 Hz"
damping_ratio = 0.04
tcp_gain = 0.8
[[plant.modes]]
name = "frame"
frequency = "97 Hz"
damping_ratio = 0.03
tcp_gain = 0.2
[drive]
kind = "position_source"
max_acceleration = "10 m/s^2"
[[moves]]
distance = "20 mm"
max_velocity = "200 mm/s"
[requirements]
tcp_deviation = "20 um"
frequency_spread = "4 %"
damping_spread = "30 %"
[control]
kind = "klipper"
"""
MODES = ((45.0, 0.04, 0.8), (97.0, 0.03, 0.2))


@pytest.mark.parametrize(
    "item",
    [
        None,
        SetpointFilter(kind="zv", frequency_hz=45.0, damping_ratio=0.04),
        SetpointFilter(kind="2hump_ei", frequency_hz=60.0, damping_ratio=0.1),
        SetpointFilter(kind="moving_average", time=0.02),
    ],
    ids=lambda item: item.kind if item else "none",
)
def test_corner_velocity_leaves_just_the_band(item: SetpointFilter | None) -> None:
    """If it failed, square_corner_velocity would ring beyond the band, or be needlessly small.

    Every mode is integrated by itself through the shaped step of velocity; the phases of several
    modes are not known at a corner of the path, so their amplitudes add.
    """
    found = find_corner_velocity(parse_profile(PROFILE, where="test"), item)
    worst = 0.0
    for u, v in [(1.0, 1.0), *product((0.96, 1.04), (0.7, 1.3))]:
        left = 0.0
        for hertz, zeta, share in MODES:
            omega, ratio = 2 * pi * hertz * u, zeta * v
            # q'' = -x_ref'': each copy of the step takes its part of dv off q' (or spread evenly).
            state, now = np.zeros(2), 0.0
            delays, shares = item.impulses if item else ((0.0,), (1.0,))
            span = item.averages[0] if item and item.averages else 0.0

            def slope(_t: float, q: np.ndarray, push: float, w: float, z: float) -> list[float]:
                return [q[1], -(w**2) * q[0] - 2 * z * w * q[1] - push]

            for delay, part in zip(delays, shares, strict=True):
                if delay > now:
                    state = _run(slope, state, delay - now, 0.0, omega, ratio)
                if span:
                    state = _run(slope, state, span, found / span, omega, ratio)
                else:
                    state[1] -= part * found
                now = delay
            # Envelope: q = Re[w e^(p t)], w from position and velocity.
            damped = omega * (1 - ratio**2) ** 0.5
            envelope = np.hypot(state[0], (state[1] + ratio * omega * state[0]) / damped)
            left += share * float(envelope)
        worst = max(worst, left)
    assert worst == pytest.approx(0.8 * 20e-6, rel=1e-5)


def _run(slope, state, time, push, omega, zeta):  # type: ignore[no-untyped-def]
    run = solve_ivp(
        slope, (0.0, time), state, args=(push, omega, zeta), rtol=1e-10, atol=1e-16, method="DOP853"
    )
    return run.y[:, -1].copy()
