"""The setpoint must be what Ruckig plans, exact between samples, and never touch the network."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mtcommission
from mtcommission.base.errors import ComputationError
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import jerk_steps, plan_setpoint, sample_setpoint

positive = st.floats(min_value=-1.0, max_value=1.0).map(lambda e: 10.0**e)


@given(
    a=positive.map(lambda v: 3.0 * v),
    ramp=positive.map(lambda v: 0.02 * v),
    size=positive,
    velocity=positive,
    kind=st.sampled_from(["step", "move", "limited"]),
)
@settings(max_examples=150, deadline=None)
def test_closed_form_agrees_with_ruckig(a, ramp, size, velocity, kind):
    """The search would rank other motions than the control then executes."""
    move: Move
    if kind == "step":
        move = VelocityStep(velocity_step=0.1 * size)
    elif kind == "move":
        move = Positioning(distance=0.05 * size)
    else:
        move = Positioning(distance=0.05 * size, max_velocity=0.3 * velocity)
    limits = MotionLimits(acceleration=a, jerk=a / ramp)
    setpoint = plan_setpoint(move, limits)
    ours = jerk_steps(move, acceleration=np.array([a]), jerk=np.array([limits.jerk]))
    assert ours.duration[0] == pytest.approx(setpoint.duration, rel=1e-9)
    times = np.linspace(0.0, setpoint.duration, 97)
    age = np.maximum(times[:, None] - ours.times, 0.0)
    x = (age**3 / 6) @ ours.steps[0]
    v = (age**2 / 2) @ ours.steps[0]
    ruckig = sample_setpoint(setpoint, times)
    # The sum over jerk steps cancels terms as large as j T²/2 and j T³/6: in a long cruise
    # their rounding, not the motion, sets what can be compared.
    rounding = 64 * np.finfo(float).eps * limits.jerk * setpoint.duration**2 / 2
    assert np.allclose(v, ruckig[:, 1], atol=rounding + 1e-8 * np.max(ruckig[:, 1]))
    rounding *= setpoint.duration / 3
    assert np.allclose(x, ruckig[:, 0], atol=rounding + 1e-8 * np.max(ruckig[:, 0]))
    assert np.max(np.abs(ruckig[:, 2])) <= a * (1 + 1e-8)


def test_seven_segment_duration_of_textbooks():
    """T = d/v + v/a + a/j: 0.95 s for 0.4 m, 0.5 m/s, 5 m/s², 100 m/s³."""
    move = Positioning(distance=0.4, max_velocity=0.5)
    setpoint = plan_setpoint(move, MotionLimits(acceleration=5.0, jerk=100.0))
    assert setpoint.duration == pytest.approx(0.4 / 0.5 + 0.5 / 5 + 5 / 100, rel=1e-12)
    assert sample_setpoint(setpoint, np.array([setpoint.duration]))[0, 0] == 0.4


def test_border_on_which_ruckig_fails_is_stepped_over():
    """The commissioning rule aims at whole periods, so it hits such borders exactly."""
    move = Positioning(distance=0.05, max_velocity=0.5)
    limits = MotionLimits(acceleration=2.290509129054942, jerk=21.92441611715322)
    found = plan_setpoint(move, limits)
    ours = jerk_steps(
        move, acceleration=np.array([limits.acceleration]), jerk=np.array([limits.jerk])
    )
    assert found.duration == pytest.approx(ours.duration[0], rel=1e-5)
    assert sample_setpoint(found, np.array([found.duration]))[0, 0] == 0.05


def test_ruckigs_refusal_becomes_a_named_outcome():
    with pytest.raises(ComputationError, match="setpoint failed"):
        plan_setpoint(VelocityStep(velocity_step=0.1), MotionLimits(acceleration=-1.0, jerk=1.0))


def test_the_package_never_sets_waypoints():
    """Ruckig's Community build would send them to a server on the network."""
    sources = Path(mtcommission.__file__).parent.rglob("*.py")
    assert not [file for file in sources if "intermediate_positions" in file.read_text("utf-8")]
