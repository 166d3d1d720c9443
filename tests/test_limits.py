"""Limits as they are typed in, and the jerk-limited profile that is in an optimum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mtcommission.controls.kinds import KINDS
from mtcommission.limits.optima import condense
from mtcommission.limits.typed import round_limits
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.optimal.control import Trajectory
from tests.independent_loop import profile_of
from tests.machines import paper_machine


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
def test_a_velocity_step_gives_back_its_own_limits(velocity, acceleration, share):
    """share < 1 is the ramp time over v/a: the acceleration is reached."""
    jerk = acceleration**2 / (share * velocity)
    move = VelocityStep(velocity_step=velocity)
    found = condense(move, motion(move, acceleration, jerk), velocity=0)
    assert found.acceleration == pytest.approx(acceleration, rel=2e-3)
    assert found.jerk == pytest.approx(jerk, rel=5e-3)


@pytest.mark.parametrize("kind", ["generic", "fanuc"])
@given(a=st.floats(1e-3, 1e3), ramp=st.floats(1e-4, 1.0))
def test_what_is_typed_in_has_few_digits_and_is_never_faster(kind, a, ramp):
    """A jerk rounded up shakes more than what was judged; some controls take its time instead."""
    machine = paper_machine()
    machine = replace(machine, control=replace(machine.control, kind=KINDS[kind]))
    found = round_limits(machine, a, ramp)
    slowed = [found.acceleration / a, ramp / found.jerk_time]
    if kind == "generic":
        slowed[1] = found.jerk / (a / ramp)
    assert all(0.989 < share <= 1.0 + 1e-6 for share in slowed)
    typed = found.jerk_time if kind == "fanuc" else found.jerk
    assert typed == pytest.approx(float(f"{typed:.3g}"), rel=1e-12)
