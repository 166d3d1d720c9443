"""Meshes under bounds: splitting their cells, the cost of rounding, what lies between points."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mtcommission.optimal.bounded.mesh.exchange import exchange
from mtcommission.optimal.bounded.mesh.finish import on_mesh
from mtcommission.optimal.bounded.mesh.forms import MeshOptimum, solve_mesh, solve_relaxation
from mtcommission.optimal.bounded.mesh.plan import first_features, plan_mesh
from mtcommission.optimal.bounded.mesh.refinement import refined
from mtcommission.optimal.bounded.mesh.rows import MeshPlan
from mtcommission.optimal.bounded.mesh.violations import violations
from mtcommission.optimal.bounded.problem import BoundedProblem, bounded_problem
from mtcommission.optimal.bounded.program.grid import solve_grid_time
from mtcommission.optimal.bounded.proof.accepted import Found
from mtcommission.optimal.bounded.proof.dual_point import stretches
from mtcommission.optimal.bounded.proof.dual_value import dual_value, lower_bound
from mtcommission.optimal.bounded.proof.sigma import largest_outputs
from mtcommission.optimal.closed_form import impulse_response, step_response, transition
from mtcommission.optimal.solution import Bound
from mtcommission.plant.plant import build_plant
from tests.machines import paper_machine


def paper_problem(name: str, value: float) -> BoundedProblem:
    machine = paper_machine()
    return bounded_problem(
        build_plant(machine),
        machine.moves[0],
        force_limit=2e3,
        bounds=(Bound(name=name, value=value),),
        horizon=0.0435,
    )


@cache
def first_mesh(value: float) -> tuple[BoundedProblem, MeshOptimum, MeshOptimum]:
    """Return both forms of the first program for a bound on the deflection phi."""
    problem = paper_problem("phi", value)
    restriction = exchange(
        problem,
        plan_mesh(problem, first_features(problem, solve_grid_time(problem, t_free=0.0435))),
    )
    assert restriction is not None
    relaxation = solve_relaxation(problem, restriction)
    assert relaxation is not None
    return problem, restriction, relaxation


@cache
def finished(value: float) -> Found:
    """Return a control that keeps everything, and so a time that nobody may exclude."""
    problem, restriction, relaxation = first_mesh(value)
    found = on_mesh(problem, *refined(problem, restriction, relaxation, largest=3e9))
    assert found is not None
    return found


def proved_reach(problem: BoundedProblem, relaxation: MeshOptimum) -> float:
    """Return the reach that the multipliers prove nobody exceeds."""
    measure = relaxation.measure
    value = dual_value(problem, stretches(problem, measure), measure.atoms).value
    return value / float(measure.terminal @ problem.target)


@pytest.mark.parametrize("value", [3e-5, 1e-5])
def test_split_cells_hide_less(value: float) -> None:
    # Otherwise the gap closes only as fast as whole meshes become finer, and hard cases run out.
    problem, restriction, relaxation = first_mesh(value)
    finer_restriction, finer = refined(problem, restriction, relaxation, largest=3e9)
    before = proved_reach(problem, relaxation) - restriction.reach
    after = proved_reach(problem, finer) - finer_restriction.reach
    assert before > 1e-5
    assert after < 0.2 * before
    # What nobody exceeds must not lie below what a control with the same t_f does.
    assert proved_reach(problem, finer) > finer_restriction.reach - 1e-9
    assert finer_restriction.reach > restriction.reach - 1e-7


def test_a_split_program_ends_where_a_cold_start_ends() -> None:
    # A basis of the wrong size ended 5e-4 beside the optimum, and was called optimal.
    problem, restriction, relaxation = first_mesh(3e-5)
    for found in refined(problem, restriction, relaxation, largest=3e9):
        cold = solve_mesh(problem, found.plan, relaxed=found.plan.margin == 0.0)
        assert cold is not None
        assert found.reach == pytest.approx(cold.reach, abs=1e-8)


@pytest.mark.parametrize("value", [3e-5, 1e-6])
def test_multipliers_off_by_rounding_prove_as_much(value: float) -> None:
    # A miss of sigma = 0 at the end of a long arc grew like its length squared, from arc to arc.
    problem, _, relaxation = first_mesh(value)
    whole = proved_reach(problem, relaxation)
    generator = np.random.default_rng(1)
    measure = relaxation.measure
    noise = 1.0 + 1e-11 * generator.standard_normal(measure.terminal.size)
    off = replace(relaxation, measure=replace(measure, terminal=measure.terminal * noise))
    assert proved_reach(problem, off) == pytest.approx(whole, rel=1e-6)


def test_multipliers_put_right_still_prove_no_more_than_is_true() -> None:
    # The step that puts them right is paid for: with large misses the bound must not rise.
    problem, _, relaxation = first_mesh(3e-5)
    best = finished(3e-5).t_f
    generator = np.random.default_rng(2)
    for size in 10.0 ** generator.uniform(-8.0, -1.0, 12):
        noise = 1.0 + size * generator.standard_normal(relaxation.measure.terminal.size)
        terminal = relaxation.measure.terminal * noise
        measure = replace(relaxation.measure, t_f=best, terminal=terminal)
        assert lower_bound(problem, measure) <= best


def test_no_motion_exceeds_its_largest_output() -> None:
    # The worst force is that which switches with the response: exactly F times its integral.
    problem = paper_problem("phi", 3e-5)
    rows = problem.limits[0].output_chain
    tau = np.linspace(0.0, 0.3, 60_001)
    exact = 2e3 * np.trapezoid(np.abs(impulse_response(problem.plant, tau) @ rows.T), tau, axis=0)
    found = largest_outputs(problem, rows, t_f=0.3)
    assert np.all(found >= exact)
    assert np.all(found < 30.0 * exact)


def test_excess_between_points_is_found_in_cells_of_many_periods() -> None:
    # Thirteen samples of a cell of several periods miss the largest by 4e-4, and its place by more.
    problem = paper_problem("phi", 1e-7)
    mesh = np.linspace(0.0, 1.2, 13)[1:-1]
    coarse = solve_mesh(
        problem, MeshPlan(t_f=1.2, mesh=mesh, interiors=(), points=(), margin=0.0), relaxed=False
    )
    assert coarse is not None
    largest = max(violation.excess for violation in violations(problem, coarse, tolerance=0.0))
    peaks = []
    for cell in coarse.segments:
        tau = np.linspace(0.0, cell.start - cell.end, 20_001)
        force = coarse.unknowns[cell.column] * 2e3
        states = transition(problem.plant, tau) @ cell.first
        peaks.append(np.abs((states + step_response(problem.plant, tau) * force) @ problem.rows.T))
    assert largest == pytest.approx(max(peak.max() for peak in peaks) - 1.0, rel=1e-4)


@pytest.mark.parametrize("share", [0.05, 1.0, 5.0])
def test_a_control_is_finished_whatever_slope_is_believed(share: float) -> None:
    # With a slope too small by a factor of three each step went further off, on the other side.
    problem, restriction, relaxation = first_mesh(3e-5)
    restriction, relaxation = refined(problem, restriction, relaxation, largest=3e9)
    found = on_mesh(problem, replace(restriction, slope=share * restriction.slope), relaxation)
    assert found is not None
    assert found.t_f == pytest.approx(finished(3e-5).t_f, rel=2e-6)
