from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import cos, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.optimal.bang_bang import find_bang_bang
from mtcommission.optimal.control import Bang, TimeOptimum, propagate, sample_trajectory
from mtcommission.optimal.free import solve_forces, solve_time_optimal
from mtcommission.optimal.modes import MomentProblem
from tests.machines import paper_machine, random_modal_machine
from tests.references_optimal import (
    PAPER_SWITCHING_TIMES,
    PAPER_T_F,
    PAPER_TIME_TOLERANCE,
    lag_only_step,
)

STEP = VelocityStep(velocity_step=0.1)
PAPER = build_plant(paper_machine())


def relative_error(plant: Plant, optimum: TimeOptimum) -> float:
    """What the arcs miss, each followed by its matrix exponential, not as the solver does."""
    missed = propagate(plant, optimum.arcs)
    if isinstance(optimum.move, VelocityStep):
        missed[plant.velocity] -= optimum.move.velocity_step
        missed[plant.position] = 0.0
    else:
        missed[plant.position] -= optimum.move.distance
    return float(np.max(np.abs(missed) / optimum.peaks[: plant.order]))


def test_paper_eq_12_switching_times():
    optimum = solve_time_optimal(PAPER, STEP, force_limit=2e3)
    ours = np.array([*optimum.switching_times, optimum.t_f])
    theirs = np.array([*PAPER_SWITCHING_TIMES, PAPER_T_F])
    assert ours == pytest.approx(theirs, abs=PAPER_TIME_TOLERANCE)
    assert [arc.control for arc in optimum.arcs] == [Bang(1), Bang(-1)] * 3
    assert optimum.certificate.relative_gap < 1e-12
    assert relative_error(PAPER, optimum) < 1e-13


@pytest.mark.parametrize("force", [1252.655, 1294.5447])
def test_arc_of_some_nanoseconds_is_found_and_certified(force):
    optimum = solve_time_optimal(PAPER, STEP, force_limit=force)
    shortest = np.diff([0.0, *optimum.switching_times, optimum.t_f]).min()
    assert 0.0 < shortest < 1e-7
    assert optimum.certificate.relative_gap < 1e-12
    assert relative_error(PAPER, optimum) < 1e-12


@pytest.mark.parametrize("span", [1e-4, 3e-3, 0.05, 2.0])
def test_rigid_axis_with_lag_has_the_closed_form(span):
    T = 2.5e-3
    problem = MomentProblem(rates=np.array([-1.0 / T], dtype=complex), degree=0, target=span)
    control = find_bang_bang(problem, span=span).control
    t_f, switch = lag_only_step(span, T)
    assert control.horizon == pytest.approx(t_f, rel=1e-13)
    assert control.zeros == pytest.approx([switch], rel=1e-12)


def test_very_short_move_switches_at_the_zeros_of_the_chebyshev_polynomial():
    # For t_f -> 0 the moment functions become polynomials, whose L1 extremal sign pattern is that
    # of the Chebyshev polynomial of the second kind (Korkin & Zolotarev 1873).
    deviations = []
    for force in (1e6, 1e8):
        optimum = solve_time_optimal(PAPER, STEP, force_limit=force)
        expected = [0.5 * (1.0 - cos(k * pi / 6)) for k in range(1, 6)]
        found = np.array(optimum.switching_times) / optimum.t_f
        deviations.append(float(np.max(np.abs(found - expected))))
    assert deviations[0] < 0.05
    assert deviations[1] < 0.6 * deviations[0]


@pytest.mark.parametrize("move", [STEP, Positioning(distance=0.02)])
@pytest.mark.parametrize("n_modes", range(1, 9))
@pytest.mark.parametrize("seed", [0, 3])
def test_random_machines_are_certified(seed, n_modes, move):
    machine = random_modal_machine(seed, n_modes=n_modes)
    plant = build_plant(machine)
    force = machine.drive.max_force * 10.0 ** (seed - 1)
    optimum = solve_time_optimal(plant, move, force_limit=force)
    certificate = optimum.certificate
    assert 0.0 <= certificate.relative_gap < 1e-9
    assert certificate.switching_law_holds
    assert relative_error(plant, optimum) < 1e-9
    assert all(one.t_end == two.t_start for one, two in pairwise(optimum.arcs))
    assert certificate.terminal_jacobian_rank in (
        -1,
        2 * n_modes + 2 + isinstance(move, Positioning),
    )


def test_slow_step_of_an_undamped_axis_needs_hundreds_of_switches():
    modes = tuple(
        FlexibleMode(name=f"{hertz:g} Hz", natural_frequency=2 * pi * hertz, damping_ratio=0.0,
                     tcp_gain=0.01)
        for hertz in (40.0, 70.0)
    )  # fmt: skip
    axis = replace(paper_machine(), mechanics=Modal(moving_mass=100.0, modes=modes))
    plant = build_plant(axis)
    optimum = solve_time_optimal(plant, VelocityStep(velocity_step=2.0), force_limit=20.0)
    assert len(optimum.switching_times) > 200
    assert optimum.certificate.relative_gap < 1e-9
    assert optimum.certificate.switching_law_holds
    assert relative_error(plant, optimum) < 1e-9


@settings(max_examples=15, deadline=None, derandomize=True)
@given(
    force=st.floats(min_value=200.0, max_value=2e4),
    more=st.floats(min_value=1e-6, max_value=1.0),
    move=st.sampled_from([STEP, Positioning(distance=0.01)]),
)
def test_more_force_never_needs_more_time(force, more, move):
    slow = solve_time_optimal(PAPER, move, force_limit=force)
    fast = solve_time_optimal(PAPER, move, force_limit=force * (1.0 + more))
    assert fast.t_f < slow.t_f


@pytest.mark.parametrize("move", [STEP, Positioning(distance=0.02)])
def test_peaks_are_those_of_a_dense_sample(move):
    optimum = solve_time_optimal(PAPER, move, force_limit=2e3)
    samples = sample_trajectory(PAPER, optimum.arcs, step=2e-5)
    signals = np.column_stack([samples.states, samples.states @ PAPER.C.T])
    sampled = np.abs(signals).max(axis=0)
    assert np.all(sampled <= optimum.peaks * (1.0 + 1e-11))
    assert np.all(sampled >= optimum.peaks * (1.0 - 2e-5))


@pytest.mark.parametrize("force", [0.0, -5.0, float("nan")])
def test_no_force_is_a_named_outcome(force):
    with pytest.raises(ComputationError) as caught:
        solve_time_optimal(PAPER, STEP, force_limit=force)
    assert caught.value.outcome is Outcome.NO_FORCE_LEFT


@pytest.mark.parametrize(("n_modes", "seed"), [(5, 35), (7, 42)])
def test_no_arc_has_vanished(n_modes, seed):
    # Newton's method closes an arc that a start had seen; the sheet showed it with its 0 ms.
    machine = random_modal_machine(seed, n_modes=n_modes)
    move = machine.moves[0] if seed % 2 else Positioning(distance=(1e-3, 0.02, 0.5)[seed % 3])
    force = machine.drive.max_force * 10.0 ** (seed % 5 - 2)
    optimum = solve_time_optimal(build_plant(machine), move, force_limit=force)
    shortest = min(arc.t_end - arc.t_start for arc in optimum.arcs)
    assert shortest > 1e-8 * optimum.t_f
    assert optimum.certificate.relative_gap < 1e-12


def test_force_that_leaves_modes_indistinct_is_named_so():
    # "No convergence, report the profile" would blame the program for 1e14 N.
    plant = build_plant(paper_machine())
    with pytest.raises(ComputationError, match="rad of the slowest mode") as caught:
        solve_time_optimal(plant, STEP, force_limit=1e14)
    assert caught.value.outcome is Outcome.MODES_NOT_TOLD_APART


@pytest.mark.parametrize("move", [STEP, Positioning(distance=0.02)])
def test_forces_one_after_the_other_are_those_of_single_solves(move):
    # Rows of a sweep must be the optima of their own forces, however each was started.
    forces = np.geomspace(300.0, 20e3, 40)
    found = list(solve_forces(PAPER, move, forces))
    for force, solved in list(zip(forces.tolist(), found, strict=True))[::7]:
        alone = solve_time_optimal(PAPER, move, force_limit=force)
        assert solved is not None
        motion, lower_bound = solved
        assert motion.t_f == pytest.approx(alone.t_f, rel=1e-12)
        assert 0.0 <= motion.t_f - lower_bound < 1e-12 * alone.t_f
        assert motion.peaks == pytest.approx(alone.peaks, rel=1e-8)
        assert motion.switching_times == pytest.approx(
            np.array(alone.switching_times), abs=1e-9 * alone.t_f
        )
