"""The loop must do what its description says: checked by a second program and python-control."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from mtcommission.controls.kind import TWO_AVERAGES, PositionLoop
from mtcommission.loop.model.assembly import delay_weights, discretise
from mtcommission.loop.simulate import LoopResponse, simulate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine, moving_mass, vary
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_within
from tests.independent_loop import Run, axis_of, behind, delayed, profile_of, quiet_copy, run
from tests.machines import paper_machine, random_modal_machine

Array = NDArray[np.float64]

STEP = VelocityStep(velocity_step=0.1)
TRAVEL = Positioning(distance=0.005, max_velocity=0.15)
NOTCH = ForceFilter(kind="notch", natural_frequency=2 * pi * 72.0, damping=0.1)
LOW_PASS = ForceFilter(kind="low_pass", natural_frequency=2 * pi * 600.0, damping=0.7)

VARIANTS: dict[str, dict[str, object]] = {
    "state feedback and observer": {},
    "cascade alone": {"state_feedback": StateFeedback.OFF},
    "second encoder": {"has_tcp_sensor": True},
    "second encoder, cascade alone": {
        "has_tcp_sensor": True,
        "state_feedback": StateFeedback.OFF,
    },
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


def both(
    machine: Machine, tuned: TunedLoop, move: Move, share: float, *, corner: int = 0
) -> tuple[LoopResponse, Run]:
    """The same motion through the product and through the second program."""
    a = share * machine.drive.motion_force / moving_mass(machine)
    limits = MotionLimits(acceleration=a, jerk=a / 9e-3)
    response = simulate(
        tuned.loops[corner],
        plan_within(machine, limits)(move),
        drive=machine.drive,
        band=machine.requirements.tcp_deviation,
    )
    again = run(
        vary(machine, tuned.corners[corner]),
        tuned.controller,
        behind(profile_of(move, limits.acceleration, limits.jerk), machine.control.setpoint_filter),
        nominal=machine,
        samples=min(len(response.t), 2500),
        force_limit=machine.drive.motion_force,
    )
    return response, again


def assert_same(response: LoopResponse, again: Run) -> None:
    """Tool deviation, set force and every state to 1e-7 of their own size."""
    n = len(again.t)
    pairs = [
        (response.deviation[:n], again.tool - again.reference),
        (response.force[:n], again.force),
        *zip(response.states[:n].T, again.states.T, strict=True),
    ]
    for ours, theirs in pairs:
        assert np.max(np.abs(ours - theirs)) <= 1e-7 * np.max(np.abs(theirs))


@pytest.mark.parametrize("position_loop", PositionLoop)
@pytest.mark.parametrize("variant", VARIANTS)
def test_papers_machine_agrees_with_a_second_program(
    variant: str, position_loop: PositionLoop
) -> None:
    """A dead time, a gain or a filter would act otherwise than the docstrings say."""
    machine = quiet_copy(paper_machine(), position_loop=position_loop, **VARIANTS[variant])
    tuned = tune_loop(machine)
    for move in (STEP, TRAVEL):
        response, again = both(machine, tuned, move, 0.3)
        assert not response.saturated
        assert_same(response, again)


@pytest.mark.parametrize("seed", range(6))
def test_random_machines_agree_in_a_corner(seed: int) -> None:
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
    assert_same(*both(machine, tuned, STEP, 0.5, corner=4))


@pytest.mark.parametrize("move", [STEP, TRAVEL])
def test_saturated_motion_agrees_with_a_second_program(move: Move) -> None:
    """Anti-windup holds the integrator exactly while the force is at its limit."""
    machine = paper_machine()
    response, again = both(machine, tune_loop(machine), move, 0.97)
    assert response.saturated
    assert np.max(np.abs(again.force)) == machine.drive.max_force
    assert_same(response, again)


def test_plant_between_cycles_is_equation_1_by_runge_kutta() -> None:
    """Both programs would share a misreading of the paper's equations of motion."""
    machine = paper_machine()
    parts, T = machine.mechanics, machine.drive.force_lag
    assert isinstance(parts, Manipulator)
    h, u = 2e-3, 1500.0

    def equation_1(_: float, state: Array) -> list[float]:
        x_b, _x_s, phi, v_b, v_s, v_phi, F = state
        return [
            v_b,
            v_s,
            v_phi,
            -(parts.base_stiffness * x_b + parts.base_damping * v_b + F) / parts.base_mass,
            F / parts.slider_mass,
            (parts.lever_arm * F - parts.rotary_stiffness * phi - parts.rotary_damping * v_phi)
            / parts.rotary_inertia,
            (u - F) / T,
        ]

    start = np.array([1e-5, 0.01, -2e-5, 3e-3, 0.05, -1e-3, 400.0])
    exact = solve_ivp(equation_1, (0, h), start, method="DOP853", rtol=1e-12, atol=1e-15).y[:, -1]
    A, B = discretise(build_plant(machine), h)
    assert np.allclose(A @ start + B * u, exact, rtol=1e-9, atol=1e-14)
    axis = axis_of(machine)
    axis.put(start)
    axis.advance(u, h)
    assert np.allclose(axis.state(), exact, rtol=1e-9, atol=1e-14)


def test_interpolated_setpoint_costs_less_than_stated() -> None:
    """Δj T³/400 is the claim for a jerk step inside a cycle; nothing where the jerk is constant."""
    profile, T, delay = profile_of(STEP, 1.5, 200.0), 2e-3, 5.625e-3
    weights = delay_weights(delay, cycle=T, delays=3)
    worst = 0.0
    for k in range(60):
        samples = np.concatenate([profile.at((k - i) * T) for i in range(4)])
        ours = weights @ samples
        t = k * T - delay
        assert np.allclose(ours, delayed(profile, t, T), rtol=1e-9, atol=1e-15)
        error = abs(ours[0] - profile.at(t)[0])
        steps = [knot for knot in profile.knots if t // T * T <= knot <= t // T * T + T]
        assert steps or error < 1e-14
        worst = max(worst, error)
    assert 0.0 < worst <= 200.0 * T**3 / 400
