"""Time-optimal controls for many forces at once, held to those for one force."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.optimal.free.bound import prove_bound
from mtcommission.optimal.free.curve import solve_curve
from mtcommission.optimal.free.curve_proof import isolate_owned_zeros, prove_bounds
from mtcommission.optimal.free.dual import evaluate_dual
from mtcommission.optimal.free.mesh import build_mesh
from mtcommission.optimal.free.moments import moment_problem
from mtcommission.optimal.free.search import find_bang_bang
from mtcommission.optimal.free.switching import isolate_zeros
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.plant.plant import build_plant
from tests.machines import paper_machine, random_modal_machine

MOVES: list[Move] = [VelocityStep(velocity_step=0.1), Positioning(distance=0.02)]


@pytest.mark.parametrize("move", MOVES)
def test_points_are_those_of_single_solves(move: Move) -> None:
    """The same t_f and switches as the solver for one force, whose certificate is its own."""
    plant = build_plant(paper_machine())
    problem = moment_problem(plant, move)
    forces = np.geomspace(300.0, 20e3, 40)
    points = solve_curve(problem, problem.target / forces)
    assert all(point.is_proved for point in points)
    for force, point in list(zip(forces.tolist(), points, strict=True))[::7]:
        alone = solve_time_optimal(plant, move, force_limit=force)
        assert point.t_f == pytest.approx(alone.t_f, rel=1e-12)
        np.testing.assert_allclose(
            point.switching_times, alone.switching_times, rtol=0.0, atol=1e-9 * alone.t_f
        )


def test_order_of_forces_does_not_matter() -> None:
    """Rows of a random sample must belong to their own force."""
    machine = paper_machine()
    problem = moment_problem(build_plant(machine), machine.moves[0])
    forces = np.random.default_rng(3).uniform(500.0, 5000.0, 30)
    mixed = [point.t_f for point in solve_curve(problem, problem.target / forces)]
    sorted_times = [point.t_f for point in solve_curve(problem, problem.target / np.sort(forces))]
    assert [mixed[i] for i in np.argsort(forces)] == pytest.approx(sorted_times, rel=1e-12)
    assert np.all(np.diff(sorted_times) < 0.0), "more force must never take more time"
    assert len(solve_curve(problem, np.array([0.05]))) == 1
    twice = solve_curve(problem, np.full(4, 0.05))
    assert len({round(point.t_f, 12) for point in twice}) == 1


@given(seed=st.integers(0, 10_000), n_modes=st.integers(1, 4), degree=st.integers(0, 1))
@settings(max_examples=15, deadline=None, derandomize=True)
def test_bounds_of_any_multipliers_are_safe(seed: int, n_modes: int, degree: int) -> None:
    """A bound above what one-case proof allows, or above the optimum, would be a false proof."""
    machine = random_modal_machine(seed, n_modes=n_modes)
    move: Move = Positioning(distance=0.05) if degree else machine.moves[0]
    problem = moment_problem(build_plant(machine), move)
    span = problem.target / machine.drive.max_force
    best = find_bang_bang(problem, span=span).control
    generator = np.random.default_rng(seed)
    disturbed = best.multipliers * (1.0 + 1e-6 * generator.standard_normal((5, problem.size)))
    many = np.vstack([best.multipliers, disturbed])
    times = np.full(6, best.horizon)
    bounds = prove_bounds(problem, many, np.full(6, span), times)
    mesh = build_mesh(problem, 1.1 * best.horizon)
    assert np.all(bounds <= best.horizon * (1.0 + 1e-12))
    for c, bound in zip(many, bounds.tolist(), strict=True):
        point = evaluate_dual(mesh, c, span=span, near=best.horizon)
        assert bound <= prove_bound(point, span=span) * (1.0 + 1e-9)
    assert bounds[0] == pytest.approx(best.horizon, rel=1e-9)


def test_a_false_time_is_not_proved() -> None:
    """Claiming more time than needed must leave a gap, or every row would be certified."""
    machine = paper_machine()
    problem = moment_problem(build_plant(machine), machine.moves[0])
    span = problem.target / 2e3
    best = find_bang_bang(problem, span=span).control
    claimed = np.array([best.horizon * 1.01])
    bound = prove_bounds(problem, best.multipliers[np.newaxis], np.array([span]), claimed)
    assert bound[0] <= best.horizon * (1.0 + 1e-12)


def test_zeros_of_many_are_those_of_each() -> None:
    """A missed pair of zeros would raise the bound."""
    problem = moment_problem(build_plant(paper_machine()), Positioning(distance=0.02))
    multipliers = np.random.default_rng(5).standard_normal((60, problem.size)) * 0.02
    mesh = build_mesh(problem, 0.2)
    times = np.linspace(0.05, 0.2, 60)
    found = isolate_owned_zeros(mesh, multipliers, times)
    total = 0
    for i, c in enumerate(multipliers):
        alone = isolate_zeros(mesh, c).tau
        alone = alone[alone < times[i]]
        total += alone.size
        np.testing.assert_allclose(found.tau[found.owner == i], alone, rtol=1e-9, atol=1e-12)
    assert total > 100, "the sample must have zeros to miss"


def test_an_arc_that_closes_on_the_way_does_no_harm() -> None:
    # Newton may close an arc to the last digit; dividing by its length would end the sweep.
    machine = random_modal_machine(6, n_modes=5)
    problem = moment_problem(build_plant(machine), Positioning(distance=1e-3))
    forces = machine.drive.max_force * np.geomspace(0.02, 0.5, 25)
    points = solve_curve(problem, problem.target / forces)
    assert all(point.is_proved for point in points)
    assert np.all(np.diff([point.t_f for point in points]) < 0.0)
