"""Condensing an optimum must find the jerk-limited profile that is in it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mtcommission.limits.optima import condense
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.optimal.control import Trajectory
from tests.independent_loop import profile_of


def motion(move: Move, a: float, j: float) -> Trajectory:
    profile = profile_of(move, a, j)
    t = np.linspace(0.0, profile.end, 1500)
    v = np.array([profile.at(time)[1] for time in t])
    return Trajectory(t=t, force=np.zeros_like(t), states=v[:, None])


@given(
    velocity=st.floats(0.02, 1.0),
    acceleration=st.floats(0.5, 10.0),
    share=st.floats(0.05, 0.9),
)
@settings(max_examples=25, deadline=None)
def test_a_velocity_step_gives_back_its_own_limits(
    velocity: float, acceleration: float, share: float
) -> None:
    """share < 1 is the ramp time over v/a: the acceleration is reached."""
    jerk = acceleration**2 / (share * velocity)
    move = VelocityStep(velocity_step=velocity)
    found = condense(move, motion(move, acceleration, jerk), velocity=0)
    assert found.acceleration == pytest.approx(acceleration, rel=2e-3)
    assert found.jerk == pytest.approx(jerk, rel=5e-3)
