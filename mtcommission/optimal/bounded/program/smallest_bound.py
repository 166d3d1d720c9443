"""The smallest bounds that a move can keep: at any time, or by a given one."""

from __future__ import annotations

from math import inf, isfinite

import numpy as np

from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.program.even_grid import cell_grid
from mtcommission.optimal.bounded.program.linear_program import Program, solve_program


def smallest_factor(problem: BoundedProblem, *, t_free: float) -> float:
    """Return the factor of all bounds below which the target is out of reach at any time.

    Source: the program of ``program.grid`` with the factor minimised instead of the reach
    maximised, at longer and longer times, then on finer and finer grids.
    """
    settings = problem.settings.program
    least, time = inf, settings.least_times[0]
    for share in settings.least_times:
        now = _least_factor(problem, share * t_free, cells=settings.least_cells[0])
        if now > least * (1.0 - settings.least_tolerance):
            break
        least, time = now, share
    return _refined(problem, time * t_free, least)


def smallest_factor_by(problem: BoundedProblem, t_f: float) -> float:
    """Return the factor of all bounds below which the target is out of reach by a given time.

    Examples
    --------
    The bound that the paper's sec. 5.2 asks for needs 52.3 ms:

    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.optimal.bounded.problem import (bounded_problem)
    >>> from mtcommission.optimal.solution import Bound
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = read_shipped("milling-manipulator").machine
    >>> problem = bounded_problem(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     bounds=(Bound(name="v_phi", value=0.005),), horizon=0.05)
    >>> [round(smallest_factor_by(problem, t_f), 2) for t_f in (0.0522923, 0.048)]
    [1.0, 1.63]
    """
    return _refined(
        problem, t_f, _least_factor(problem, t_f, cells=problem.settings.program.least_cells[0])
    )


def _refined(problem: BoundedProblem, t_f: float, least: float) -> float:
    """Return the factor on finer and finer grids, as far as the programs end."""
    settings = problem.settings.program
    for cells in settings.least_cells[1:]:
        if cells * len(problem.limits) > settings.least_cells[-1]:
            break
        before, now = least, _least_factor(problem, t_f, cells=cells)
        if not isfinite(now):
            break
        least = now
        if abs(least - before) <= settings.least_tolerance * least:
            break
    return least


def _least_factor(problem: BoundedProblem, t_f: float, *, cells: int) -> float:
    """Return the least factor of all bounds with which the target is reached by t_f."""
    grid = cell_grid(problem, t_f, cells=cells)
    column = -np.ones((grid.response.shape[0], 1))
    program = Program(
        cost=np.append(np.zeros(cells), 1.0),
        rows=np.block([[grid.response, column], [-grid.response, column]]),
        rooms=np.zeros(2 * grid.response.shape[0]),
        equal=np.column_stack([grid.moments, np.zeros(grid.target.size)]),
        right=grid.target,
        lower=np.append(-np.ones(cells), 0.0),
        upper=np.append(np.ones(cells), inf),
    )
    solution = solve_program(
        program, problem.settings.program, steps=problem.settings.program.steps_per_cell * cells
    )
    return inf if solution is None else float(solution.unknowns[-1])
