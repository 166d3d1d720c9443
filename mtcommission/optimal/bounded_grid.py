"""A first look: the bounded problem on an even grid, as a linear program.

For a given t_f the program asks for the largest multiple α of the target that can be reached
within force limit and bounds; α(t_f) = 1 is the optimum, since waiting at rest makes α grow
with t_f. The force is constant in each cell, the bounds hold at the grid points; so the result
shows the structure, not yet the solution.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz
from scipy.optimize import linprog

from mtcommission.errors import ComputationError, Outcome
from mtcommission.optimal.bounded_problem import BoundedProblem, step_response

Array = NDArray[np.float64]

FEWEST_CELLS, MOST_CELLS = 200, 600
"""Cells of the grid: enough to see every feature that the refinement needs, and few enough for
a fraction of a second (empirical)."""
RADIANS_PER_CELL = 0.6
"""Between the two, cells that resolve the fastest rate of the plant, for the last look."""
COARSE_RADIANS = 1.8
"""The same while t_f is searched: a program of a third of the cells costs a tenth."""

HORIZON = 60.0
"""Longest t_f that is searched, in multiples of the free optimum."""

TIME_TOLERANCE = 1e-3
"""|α - 1| at which the search on the grid ends; the grid itself is no better."""

TIME_STEPS = 40

STANDSTILL = 1e-3
"""Relative growth of the reach over the last third of the search that counts as none."""
LEAST_TIMES = (1.6, 2.2, 3.0, 4.2, 6.0, 10.0)
"""Where the smallest possible bound is looked for, in multiples of the free optimum: it falls with
t_f until more time does not help any more."""
LEAST_CELLS = (400, 800, 1600)
"""Grids for the smallest bound: the first for the search of its time, the others to refine it."""
LEAST_TOLERANCE = 2e-4
"""Relative change of the smallest bound, over time and over the grid, that counts as none."""

SATURATED = 1e-6
"""Distance from a limit below which a value of the program counts as on it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridOptimum:
    """The solution on the grid.

    Parameters
    ----------
    t_f
        [s].
    reach
        α, the reached multiple of the target.
    slope
        dα/dt_f from the multipliers [1/s].
    force
        F_set / F in each cell, shape (n_cells,).
    levels
        c x at the ends of the cells, shape (n_limits, n_cells).
    """

    t_f: float
    reach: float
    slope: float
    force: Array
    levels: Array


def solve_grid_time(problem: BoundedProblem, *, t_free: float) -> GridOptimum:
    """Return the time-optimal control on the grid.

    Parameters
    ----------
    problem
        The bounded problem.
    t_free
        Optimum without bounds [s], where the search starts.

    Returns
    -------
    GridOptimum

    Raises
    ------
    ComputationError
        BOUND_CANNOT_HOLD if the reach does not grow any more; BEYOND_HORIZON if it still grows
        at the end of the search.

    Examples
    --------
    >>> from tests.machines import paper_machine
    >>> from mtcommission.optimal.bounded_problem import bounded_problem
    >>> from mtcommission.optimal.solution import Bound
    >>> from mtcommission.plant import build_plant
    >>> machine = paper_machine()
    >>> problem = bounded_problem(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     bounds=(Bound(name="v_phi", value=0.005),), horizon=0.05)
    >>> round(solve_grid_time(problem, t_free=0.0435).t_f, 3)
    0.052
    """
    low, high, t_f = 0.0, np.inf, 1.05 * t_free
    found = _solve(problem, t_f, radians=COARSE_RADIANS)
    for _ in range(TIME_STEPS):
        if abs(found.reach - 1.0) < TIME_TOLERANCE or high - low < 1e-7 * high:
            return _last_look(problem, found)
        low, high = (t_f, high) if found.reach < 1.0 else (low, t_f)
        step = (1.0 - found.reach) / max(found.slope, 1e-3 / t_f)
        if high < np.inf:
            inside = low + 0.02 * (high - low) < t_f + step < high - 0.02 * (high - low)
            t_f = t_f + step if inside else 0.5 * (low + high)
        else:
            t_f = min(max(t_f + step, 1.02 * t_f), 2.0 * t_f)
        if low > HORIZON * t_free:
            raise _out_of_reach(problem, found, t_free)
        found = _solve(problem, t_f, radians=COARSE_RADIANS)
    raise ComputationError(
        Outcome.NO_CONVERGENCE, f"search for t_f on the grid stopped at {t_f:.6g} s"
    )


def _last_look(problem: BoundedProblem, found: GridOptimum) -> GridOptimum:
    """Return the solution on the fine grid, if the coarse one was not fine enough."""
    if _cells(problem, found.t_f, RADIANS_PER_CELL) > found.force.size:
        found = _solve(problem, found.t_f, radians=RADIANS_PER_CELL)
    return found


def _out_of_reach(problem: BoundedProblem, longest: GridOptimum, t_free: float) -> ComputationError:
    shorter = _solve(problem, 0.7 * longest.t_f, radians=COARSE_RADIANS)
    names = ", ".join(f"|{k.bound.name}| <= {k.bound.value:.6g}" for k in problem.limits)
    if longest.reach - shorter.reach < STANDSTILL * longest.reach:
        least = smallest_factor(problem, t_free=t_free) * (1.0 + LEAST_TOLERANCE)
        bounds = ", ".join(f"{least * k.bound.value:.4g}" for k in problem.limits)
        detail = f"{names}: the smallest possible is about {bounds} (SI units)"
        return ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)
    return ComputationError(
        Outcome.BEYOND_HORIZON, f"{names}: t_f would be longer than {longest.t_f:.4g} s"
    )


def smallest_factor(problem: BoundedProblem, *, t_free: float) -> float:
    """Return the factor of all bounds below which the target is out of reach at any time.

    Parameters
    ----------
    problem
        The bounded problem.
    t_free
        Optimum without bounds [s].

    Returns
    -------
    float
        To some ``LEAST_TOLERANCE``; inf if even the longest of ``LEAST_TIMES`` is too short.

    Source: the program of this module with the factor minimised instead of the reach maximised,
    at longer and longer times, then on finer and finer grids.
    """
    least, time = inf, LEAST_TIMES[0]
    for share in LEAST_TIMES:
        now = _least_factor(problem, share * t_free, cells=LEAST_CELLS[0])
        if now > least * (1.0 - LEAST_TOLERANCE):
            break
        least, time = now, share
    for cells in LEAST_CELLS[1:]:
        before, least = least, _least_factor(problem, time * t_free, cells=cells)
        if abs(least - before) <= LEAST_TOLERANCE * least:
            break
    return least


def _least_factor(problem: BoundedProblem, t_f: float, *, cells: int) -> float:
    """Return the least factor of all bounds with which the target is reached by t_f."""
    grid = _grid(problem, t_f, cells=cells)
    rows = grid.response.shape[0]
    result = linprog(
        np.append(np.zeros(cells), 1.0),
        A_ub=np.block(
            [[grid.response, -np.ones((rows, 1))], [-grid.response, -np.ones((rows, 1))]]
        ),
        b_ub=np.zeros(2 * rows),
        A_eq=np.column_stack([grid.moments, np.zeros(grid.target.size)]),
        b_eq=grid.target,
        bounds=[(-1.0, 1.0)] * cells + [(0.0, None)],
        method="highs",
    )
    return inf if result.x is None else float(result.x[-1])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Grid:
    """Terminal state (scaled rows) and levels as linear maps of the cells' relative forces."""

    moments: Array
    target: Array
    response: Array


def _cells(problem: BoundedProblem, t_f: float, radians: float) -> int:
    return int(np.clip(t_f * problem.rate / radians, FEWEST_CELLS, MOST_CELLS))


def _grid(problem: BoundedProblem, t_f: float, *, cells: int) -> _Grid:
    F = problem.force_limit
    edges = np.linspace(0.0, t_f, cells + 1)
    final = step_response(problem.plant, t_f - edges)[:, problem.fixed] * F
    moments = (final[:-1] - final[1:]).T
    scale = 1.0 / np.maximum(np.abs(moments).sum(axis=1), np.abs(problem.target[problem.fixed]))
    steps = step_response(problem.plant, edges) @ problem.rows.T * F
    return _Grid(
        moments=moments * scale[:, np.newaxis],
        target=problem.target[problem.fixed] * scale,
        response=np.vstack([toeplitz(column, np.zeros(cells)) for column in np.diff(steps.T)]),
    )


def _solve(problem: BoundedProblem, t_f: float, *, radians: float) -> GridOptimum:
    cells, n_limits = _cells(problem, t_f, radians), len(problem.limits)
    grid = _grid(problem, t_f, cells=cells)
    follows = np.repeat([limit.follows for limit in problem.limits], cells).astype(np.float64)
    column = -follows[:, np.newaxis]
    result = linprog(
        np.append(np.zeros(cells), -1.0),
        A_ub=np.block([[grid.response, column], [-grid.response, column]]),
        b_ub=np.tile(1.0 - follows, 2),
        A_eq=np.column_stack([grid.moments, -grid.target]),
        b_eq=np.zeros(grid.target.size),
        bounds=[(-1.0, 1.0)] * cells + [(0.0, None)],
        method="highs",
    )
    if result.status != 0 or result.x is None:
        raise ComputationError(Outcome.NO_CONVERGENCE, f"grid of {cells} cells: {result.message}")
    force = result.x[:-1]
    marginal = result.lower.marginals[0] + result.upper.marginals[0]
    return GridOptimum(
        t_f=t_f,
        reach=float(result.x[-1]),
        slope=abs(float(marginal)) * cells / t_f,
        force=force,
        levels=(grid.response @ force).reshape(n_limits, cells),
    )
