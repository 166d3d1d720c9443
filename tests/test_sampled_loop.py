"""The loop must do what its description says: checked by a second program and python-control."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from mtcommission.controls.kind import TWO_AVERAGES, PositionLoop
from mtcommission.loop.simulate import LoopResponse, simulate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine, moving_mass, vary
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_within
from tests.independent_loop import behind, profile_of, quiet_copy, reference, run
from tests.machines import paper_machine, random_modal_machine

STEP = VelocityStep(velocity_step=0.1)
TRAVEL = Positioning(distance=0.005, max_velocity=0.15)
NOTCH = ForceFilter(kind="notch", natural_frequency=2 * pi * 72.0, damping=0.1, width=0.4)
LOW_PASS = ForceFilter(kind="low_pass", natural_frequency=2 * pi * 600.0, damping=0.7)

VARIANTS: dict[str, dict[str, object]] = {
    "state feedback and observer": {},
    "cascade alone": {"state_feedback": StateFeedback.OFF},
    "second encoder": {"has_tcp_sensor": True},
    "force filters": {"force_filters": (NOTCH, LOW_PASS)},
    "jerk feed-forward": {"jerk_feedforward": 1.0, "acceleration_feedforward": 0.9},
    "reference model": {"reference_model_time": 4e-3, "velocity_feedforward": 0.8},
    "moving average": {"setpoint_filter": moving_average(11e-3)},
    "two averages": {
        "setpoint_filter": SetpointFilter(kind=TWO_AVERAGES, time=11e-3, second_time=5e-3)
    },
    "shaper": {"setpoint_filter": SetpointFilter(kind="ei", frequency_hz=31.0, damping_ratio=0.02)},
    "short reference delay": {"reference_delay": 0.7e-3},
    "other clocks": {"position_cycle": 3e-3, "velocity_cycle": 500e-6},
}


def compare(
    machine: Machine, tuned: TunedLoop, move: Move, share: float, *, corner: int = 0
) -> LoopResponse:
    """Tool deviation, set force and every state to 1e-7 of their own size, by both programs."""
    a, item = share * machine.drive.motion_force / moving_mass(machine), machine.control
    limits = MotionLimits(acceleration=a, jerk=a / 9e-3)
    response = simulate(
        tuned.loops[corner],
        plan_within(machine, limits)(move),
        drive=machine.drive,
        band=machine.requirements.tcp_deviation,
    )
    profile = behind(profile_of(move, limits.acceleration, limits.jerk), item.setpoint_filter)
    again = run(
        vary(machine, tuned.corners[corner]),
        tuned.controller,
        profile,
        nominal=machine,
        samples=min(len(response.t), 2500),
        force_limit=machine.drive.motion_force,
    )
    n, late = len(again.t), reference(profile, again.t, tau=tuned.controller.reference_delay)
    pairs = [
        (response.deviation[:n], again.tool - late),
        (response.force[:n], again.force),
        *zip(response.states[:n].T, again.states.T, strict=True),
    ]
    for ours, theirs in pairs:
        assert np.max(np.abs(ours - theirs)) <= 1e-7 * np.max(np.abs(theirs))
    return response


@pytest.mark.parametrize("position_loop", PositionLoop)
@pytest.mark.parametrize("variant", VARIANTS)
def test_papers_machine_agrees_with_a_second_program(variant, position_loop):
    """A dead time, a gain or a filter would act otherwise than the docstrings say."""
    machine = quiet_copy(paper_machine(), position_loop=position_loop, **VARIANTS[variant])
    tuned = tune_loop(machine)
    for move in (STEP, TRAVEL):
        assert not compare(machine, tuned, move, 0.3).saturated


@pytest.mark.parametrize("seed", range(6))
def test_random_machines_agree_in_a_corner(seed):
    """The controller believes in the nominal machine while the plant is another."""
    machine = random_modal_machine(seed, n_modes=1 + seed % 4)
    needs = replace(
        machine.requirements, payload=(0.0, 0.2 * moving_mass(machine)), frequency_spread=0.05
    )
    machine = quiet_copy(
        replace(machine, requirements=needs),
        has_tcp_sensor=seed % 2,
        position_loop=list(PositionLoop)[seed % 3],
    )
    tuned = tune_loop(machine)
    assert len(tuned.corners) == 5
    compare(machine, tuned, STEP, 0.5, corner=4)


@pytest.mark.parametrize("move", [STEP, TRAVEL])
def test_saturated_motion_agrees_with_a_second_program(move):
    """Anti-windup holds the integrator exactly while the force is at its limit."""
    machine = paper_machine()
    response = compare(machine, tune_loop(machine), move, 0.97)
    assert response.saturated
    assert np.max(np.abs(response.force)) == machine.drive.max_force
