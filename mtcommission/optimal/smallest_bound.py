"""The smallest bounds with which a target can be reached at all, or by a given time."""

from __future__ import annotations

from math import inf, isfinite

import numpy as np

from mtcommission.optimal.linear_program import Program, solve_program
from mtcommission.optimal.problem import BoundedProblem
from mtcommission.optimal.program import STEPS, Plan, at_ends, point_rows, segments

LEAST_TIMES = (1.6, 2.2, 3.0, 4.2, 6.0, 10.0)
"""Where the smallest possible bound is looked for, in multiples of the free optimum: it falls
with t_f until more time does not help any more."""
LEAST_CELLS = (400, 800)
"""For the smallest bound: to search its time, and to refine it for a single bound."""
LEAST_TOLERANCE = 2e-4
"""Relative change of the smallest bound, over time and cells, that counts as none."""


def smallest_factor(problem: BoundedProblem, *, t_free: float) -> float:
    """Return the factor of all bounds below which the target is out of reach at any time."""
    least, time = inf, LEAST_TIMES[0]
    for share in LEAST_TIMES:
        now = _least_factor(problem, share * t_free, cells=LEAST_CELLS[0])
        if now > least * (1.0 - LEAST_TOLERANCE):
            break
        least, time = now, share
    return _finer(problem, time * t_free, least)


def smallest_factor_by(problem: BoundedProblem, t_f: float) -> float:
    """Return the factor of all bounds below which the target is out of reach by a given time."""
    return _finer(problem, t_f, _least_factor(problem, t_f, cells=LEAST_CELLS[0]))


def _finer(problem: BoundedProblem, t_f: float, least: float) -> float:
    """Return the factor on finer cells, if there is a single bound and the program ends."""
    if len(problem.limits) > 1:
        return least
    now = _least_factor(problem, t_f, cells=LEAST_CELLS[1])
    return now if isfinite(now) else least


def _least_factor(problem: BoundedProblem, t_f: float, *, cells: int) -> float:
    """Return the least factor of all bounds with which the target is reached by t_f."""
    edges = np.linspace(0.0, t_f, cells + 1)
    plan = Plan(edges=edges, points=at_ends(problem, edges))
    maps = segments(problem, plan, relaxed=True)
    rows = point_rows(problem, plan.points, maps, plan)[:, :-3]
    final, target = maps.last[-1, problem.fixed, :-3], problem.target[problem.fixed]
    scale = 1.0 / np.maximum(np.abs(final).sum(axis=1), np.abs(target))
    column = -np.ones((len(rows), 1))
    solution = solve_program(
        Program(
            cost=np.append(np.zeros(cells), 1.0),
            rows=np.block([[rows, column], [-rows, column]]),
            rooms=np.zeros(2 * len(rows)),
            equal=np.column_stack([final * scale[:, np.newaxis], np.zeros(target.size)]),
            right=target * scale,
            lower=np.append(-np.ones(cells), 0.0),
            upper=np.append(np.ones(cells), inf),
        ),
        steps=STEPS * (cells + len(rows)),
    )
    return inf if solution is None else float(solution.unknowns[-1])
