"""The paper's comparison, the fed-forward optimum and the continuous approximation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mtcommission.loop.simulate.continuous import simulate_continuous
from mtcommission.loop.simulate.response import simulate
from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine, Positioning
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import Bang, TimeOptimum, sample_evenly
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.profile.read import read_profile
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from mtcommission.study.comparison import ComparedControl, compare_controls
from mtcommission.study.feedforward import feed_forward
from tests.machines import paper_machine, random_modal_machine

PROFILES = Path(__file__).parent.parent / "profiles"
LIMITS = MotionLimits(acceleration=1.94, jerk=41.2)


@pytest.fixture(scope="module")
def machine() -> Machine:
    made = paper_machine()
    return replace(made, control=replace(made.control, state_feedback=StateFeedback.OFF))


@pytest.fixture(scope="module")
def plant(machine: Machine) -> Plant:
    return build_plant(machine)


@pytest.fixture(scope="module")
def tuned(machine: Machine) -> TunedLoop:
    return tune_loop(machine)


@pytest.fixture(scope="module")
def optimum(plant: Plant, machine: Machine) -> TimeOptimum:
    return solve_time_optimal(plant, machine.moves[0], force_limit=2e3)


@pytest.fixture(scope="module")
def rows(
    machine: Machine, plant: Plant, tuned: TunedLoop, optimum: TimeOptimum
) -> tuple[ComparedControl, ...]:
    move = machine.moves[0]
    return compare_controls(machine, plant, tuned, move, limits=LIMITS, optima=[optimum])


def test_the_papers_two_claims_hold(rows: tuple[ComparedControl, ...]) -> None:
    """Sec. 3: terminal overshoot, and a transfer time much larger than the least."""
    rectangular, trapezoidal, optimal = rows
    assert rectangular.overshoot > 0.05
    assert rectangular.transfer_time > 2.0 * optimal.transfer_time
    assert trapezoidal.transfer_time > 2.0 * optimal.transfer_time
    assert optimal.overshoot < 1e-9


def test_work_of_an_optimum_is_at_least_the_kinetic_energy(
    rows: tuple[ComparedControl, ...],
) -> None:
    """0.5 m v² = 3.75 J must be spent on 750 kg at 0.1 m/s, however it is done."""
    for row in rows:
        assert row.work >= 3.75 * (1.0 - 1e-6)


def test_samples_of_an_optimum_are_those_of_an_integrator(
    plant: Plant, optimum: TimeOptimum
) -> None:
    """The fed-forward force is derived from these states; a lost impulse would drift."""
    step = 125e-6
    states = sample_evenly(plant, optimum.arcs, step=step, until=0.06)
    state = np.zeros(plant.order)
    for arc in optimum.arcs:
        force = 2e3 if arc.control == Bang(1) else -2e3
        first = int(np.ceil(arc.t_start / step))
        inside = np.arange(first, int(np.ceil(arc.t_end / step))) * step
        solved = solve_ivp(
            lambda _, x, force=force: plant.A @ x + plant.B * force,
            (arc.t_start, arc.t_end),
            state,
            t_eval=np.append(inside, arc.t_end),
            rtol=1e-10,
            atol=1e-14,
            method="DOP853",
        )
        scale = np.max(np.abs(states), axis=0)
        assert np.allclose(
            states[first : first + inside.size], solved.y.T[:-1], atol=1e-7 * scale, rtol=0
        )
        state = solved.y[:, -1]
    assert np.allclose(states[-1], [0, states[-1, 1], 0, 0, 0.1, 0, 0], atol=1e-9)


def test_fed_forward_optimum_rests_on_the_nominal_machine_only(
    machine: Machine, plant: Plant, tuned: TunedLoop, optimum: TimeOptimum
) -> None:
    """On the machine it was computed for it is nearly perfect; off by 5 % it leaves the band."""
    nominal, low, high = feed_forward(machine, plant, tuned, optimum)
    assert nominal.residual_deviation < 0.1e-6
    assert nominal.settling_time == pytest.approx(optimum.t_f + 125e-6)
    for off in (low, high):
        assert off.residual_deviation > machine.requirements.tcp_deviation
        assert off.saturated_share > 0.2


@pytest.mark.parametrize("seed", [1, 8])
def test_continuous_loop_is_near_the_sampled_one(seed: int) -> None:
    """Holding for T_p moves the axis by up to a T_p²/2; a forgotten dead time by several times."""
    made = random_modal_machine(seed, n_modes=1)
    made = replace(made, drive=replace(made.drive, max_force=1e9))
    tuned = tune_loop(made)
    plant = build_plant(made)
    move = Positioning(distance=0.02)
    setpoint = plan_setpoint(move, MotionLimits(acceleration=1.0, jerk=30.0))
    sampled = simulate(tuned.loops[0], setpoint, drive=made.drive, band=5e-6)
    until = sampled.t_end + 0.2
    found = simulate_continuous(
        plant, tuned.controller, setpoint, model=plant, band=5e-6, until=until
    )
    inside = sampled.t <= until
    other = np.interp(sampled.t[inside], found.t, found.deviation)
    gap = np.max(np.abs(other - sampled.deviation[inside]))
    held = 1.0 * tuned.controller.position_cycle**2 / 2.0
    assert 1e-3 * held < gap < held


def test_continuous_loop_with_stiff_delays_does_not_grow() -> None:
    """Without states of one size the sheet said 1e28 m of a loop whose poles are all stable."""
    machine = read_profile(PROFILES / "modal-two-modes.toml")
    plant, tuned = build_plant(machine), tune_loop(machine)
    setpoint = plan_setpoint(machine.moves[0], MotionLimits(acceleration=2.0, jerk=40.0))
    band = machine.requirements.tcp_deviation
    sampled = simulate(tuned.loops[0], setpoint, drive=machine.drive, band=band)
    found = simulate_continuous(
        plant, tuned.controller, setpoint, model=plant, band=band, until=sampled.t_end + 0.5
    )
    assert np.max(np.abs(found.deviation)) < 2.0 * np.max(np.abs(sampled.deviation))


def test_continuous_difference_on_the_paper_machine_is_as_documented(
    machine: Machine, plant: Plant, tuned: TunedLoop
) -> None:
    """docs/feedback-loop.md states 1.5 % for the settling time."""
    setpoint = plan_setpoint(machine.moves[0], LIMITS)
    sampled = simulate(tuned.loops[0], setpoint, drive=machine.drive, band=5e-6)
    found = simulate_continuous(
        plant, tuned.controller, setpoint, model=plant, band=5e-6, until=0.5
    )
    assert found.settling_time == pytest.approx(sampled.settling_time, rel=0.015)
    assert found.residual_deviation == pytest.approx(sampled.residual_deviation, rel=0.2)
