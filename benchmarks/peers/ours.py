"""This package: structure found, control exact, optimality proved."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.answer import Answer
from benchmarks.problems import Problem
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.damping import solve_damping_optimal
from mtcommission.optimal.free import solve_time_optimal


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver; it has no grid, so ``cells`` is not looked at."""
    del cells
    plant, move, F = problem.plant, problem.move, problem.force_limit
    if problem.weights:

        def damping() -> Answer:
            found = solve_damping_optimal(
                plant, move, force_limit=F, t_f=problem.t_f, weights=problem.weights
            )
            return Answer(t_f=found.t_f, arcs=found.arcs, cost=found.cost)

        return damping

    def fastest() -> Answer:
        if problem.bounds:
            found = solve_bounded_time_optimal(plant, move, force_limit=F, bounds=problem.bounds)
        else:
            found = solve_time_optimal(plant, move, force_limit=F)
        lower = found.certificate.t_f_lower_bound
        return Answer(t_f=found.t_f, arcs=found.arcs, lower_bound=lower)

    return fastest
