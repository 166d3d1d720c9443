"""A first look: the bounded problem on an even grid, as a linear program.

For a given t_f the program asks for the largest multiple α of the target that can be reached
within force limit and bounds; α(t_f) = 1 is the optimum, since waiting at rest makes α grow
with t_f. The force is constant in each cell, the bounds hold at the grid points; so the result
shows the structure, not yet the solution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz
from scipy.optimize import linprog

from mtcommission.errors import ComputationError, Outcome
from mtcommission.optimal.bounded_problem import BoundedProblem, step_response

Array = NDArray[np.float64]

CELLS = 200
"""Cells of the grid: enough to see every feature that the refinement needs (empirical)."""

HORIZON = 60.0
"""Longest t_f that is searched, in multiples of the free optimum."""

TIME_TOLERANCE = 1e-3
"""|α - 1| at which the search on the grid ends; the grid itself is no better."""

TIME_STEPS = 40

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
    found = _solve(problem, t_f)
    for _ in range(TIME_STEPS):
        if abs(found.reach - 1.0) < TIME_TOLERANCE or high - low < 1e-7 * high:
            return found
        low, high = (t_f, high) if found.reach < 1.0 else (low, t_f)
        step = (1.0 - found.reach) / max(found.slope, 1e-3 / t_f)
        if high < np.inf:
            inside = low + 0.02 * (high - low) < t_f + step < high - 0.02 * (high - low)
            t_f = t_f + step if inside else 0.5 * (low + high)
        else:
            t_f = min(max(t_f + step, 1.02 * t_f), 2.0 * t_f)
        if low > HORIZON * t_free:
            raise _out_of_reach(problem, found)
        found = _solve(problem, t_f)
    raise ComputationError(
        Outcome.NO_CONVERGENCE, f"search for t_f on the grid stopped at {t_f:.6g} s"
    )


def _out_of_reach(problem: BoundedProblem, longest: GridOptimum) -> ComputationError:
    shorter = _solve(problem, 0.7 * longest.t_f)
    names = ", ".join(f"|{k.bound.name}| <= {k.bound.value:.6g}" for k in problem.limits)
    if longest.reach - shorter.reach < 1e-3 * longest.reach:
        # Everything but the target scales: with wider bounds the reach scales with them at most.
        least = ", ".join(f"{k.bound.value / longest.reach:.4g}" for k in problem.limits)
        detail = f"{names}: the move needs about {least} (SI units) however slow it is"
        return ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)
    return ComputationError(
        Outcome.BEYOND_HORIZON, f"{names}: t_f would be longer than {longest.t_f:.4g} s"
    )


def _solve(problem: BoundedProblem, t_f: float) -> GridOptimum:
    F, n_limits = problem.force_limit, len(problem.limits)
    edges = np.linspace(0.0, t_f, CELLS + 1)
    final = step_response(problem.plant, t_f - edges)[:, problem.fixed] * F
    moments = (final[:-1] - final[1:]).T
    scale = 1.0 / np.maximum(np.abs(moments).sum(axis=1), np.abs(problem.target[problem.fixed]))
    steps = step_response(problem.plant, edges) @ problem.rows.T * F
    response = np.vstack([toeplitz(column, np.zeros(CELLS)) for column in np.diff(steps.T)])
    follows = np.repeat([limit.follows for limit in problem.limits], CELLS).astype(np.float64)
    column = -follows[:, np.newaxis]
    result = linprog(
        np.append(np.zeros(CELLS), -1.0),
        A_ub=np.block([[response, column], [-response, column]]),
        b_ub=np.tile(1.0 - follows, 2),
        A_eq=np.column_stack([moments, -problem.target[problem.fixed]]) * scale[:, np.newaxis],
        b_eq=np.zeros(scale.size),
        bounds=[(-1.0, 1.0)] * CELLS + [(0.0, None)],
        method="highs",
    )
    if result.status != 0 or result.x is None:
        raise ComputationError(Outcome.NO_CONVERGENCE, f"grid of {CELLS} cells: {result.message}")
    force = result.x[:-1]
    marginal = result.lower.marginals[0] + result.upper.marginals[0]
    return GridOptimum(
        t_f=t_f,
        reach=float(result.x[-1]),
        slope=abs(float(marginal)) * CELLS / t_f,
        force=force,
        levels=(response @ force).reshape(n_limits, CELLS),
    )
