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

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded.cells import STEPS_PER_CELL, cell_grid
from mtcommission.optimal.bounded.least import LEAST_TOLERANCE, smallest_factor
from mtcommission.optimal.bounded.problem import BoundedProblem, bounds_text
from mtcommission.optimal.bounded.program import Basis, Program, solve_program

Array = NDArray[np.float64]

FEWEST_CELLS, MOST_CELLS = 200, 600
"""Cells of the grid: enough to see every feature that the refinement needs, and few enough for
a fraction of a second (empirical)."""
RADIANS_PER_CELL = 0.6
"""Between the two, cells that resolve the fastest mode of the plant, for the last look."""
COARSE_RADIANS = 1.8
"""The same while t_f is searched: a program of a third of the cells costs a tenth."""

HORIZON = 60.0
"""Longest t_f that is searched, in multiples of the free optimum."""

FAR = 3.0
"""The same from which on a program that rounding spoils ends the search: the forces that so tight
a bound leaves are too small beside the force limit for the simplex method."""

TIME_TOLERANCE = 1e-3
"""|α - 1| at which the search on the grid ends; the grid itself is no better."""

STEEPNESS = (0.01, 1.0)
"""Least and largest dα/dlog t_f by which that tolerance is multiplied."""

TIME_STEPS = 40

LONGER = 1.5
"""Factor between two times over which the reach has to grow, or it never will."""
STANDSTILL = 1e-3
"""Relative growth of the reach over such a factor that counts as none."""
INSIDE = (0.02, 0.98)
"""Share of the bracket of t_f in which the next time lies."""
OTHER_GRIDS = (0, 7, 23)
"""Per cent of cells added where the simplex method gives up for rounding."""

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
    basis
        Where the program for another t_f may start.
    """

    t_f: float
    reach: float
    slope: float
    force: Array
    levels: Array
    basis: Basis


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
    >>> from mtcommission.optimal.bounded.problem import bounded_problem
    >>> from mtcommission.optimal.solution import Bound
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = paper_machine()
    >>> problem = bounded_problem(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     bounds=(Bound(name="v_phi", value=0.005),), horizon=0.05)
    >>> round(solve_grid_time(problem, t_free=0.0435).t_f, 3)
    0.052
    """
    t_f, slower = 1.05 * t_free, None
    found = _solve(problem, t_f, radians=COARSE_RADIANS)
    faster, missing, spare, was_slow = found, 1.0, 1.0, False
    for _ in range(TIME_STEPS):
        # Where the reach hardly grows, as near the smallest possible bound, α alone says little.
        steepness = float(np.clip(found.slope * t_f, *STEEPNESS))
        if abs(found.reach - 1.0) < TIME_TOLERANCE * steepness:
            return _last_look(problem, found)
        if found.reach < 1.0:
            before, faster, missing = faster, found, 1.0 - found.reach
            if _stands_still(before, found) or found.t_f > HORIZON * t_free:
                raise _out_of_reach(problem, found, t_free)
            # Illinois' rule: the chord moves on from an end that stays twice.
            spare, was_slow = spare * (1.0 if was_slow else 0.5), False
        else:
            slower, spare = found, found.reach - 1.0
            missing, was_slow = missing * (0.5 if was_slow else 1.0), True
        if slower is None:
            step = (1.0 - found.reach) / max(found.slope, 1e-3 / t_f)
            t_f = min(max(t_f + step, 1.02 * t_f), 2.0 * t_f)
        elif slower.t_f - faster.t_f < 1e-7 * slower.t_f:
            return _last_look(problem, found)
        else:
            share = float(np.clip(missing / (missing + spare), *INSIDE))
            t_f = faster.t_f + share * (slower.t_f - faster.t_f)
        try:
            found = _solve(problem, t_f, radians=COARSE_RADIANS, near=found)
        except ComputationError as error:
            if slower is not None or found.t_f < FAR * t_free:
                raise
            raise _beyond(problem, found) from error
    raise ComputationError(
        Outcome.NO_CONVERGENCE,
        Message("verbatim", text=f"search for t_f on the grid stopped at {t_f:.6g} s"),
    )


def _stands_still(before: GridOptimum, after: GridOptimum) -> bool:
    """Return whether a time much longer has not made the reach grow."""
    return after.t_f > LONGER * before.t_f and after.reach - before.reach < STANDSTILL * after.reach


def _last_look(problem: BoundedProblem, found: GridOptimum) -> GridOptimum:
    """Return the solution on the fine grid, if the coarse one was not fine enough."""
    if _cells(problem, found.t_f, RADIANS_PER_CELL) > found.force.size:
        found = _solve(problem, found.t_f, radians=RADIANS_PER_CELL)
    return found


def _out_of_reach(problem: BoundedProblem, longest: GridOptimum, t_free: float) -> ComputationError:
    names = _named(problem)
    if longest.t_f <= HORIZON * t_free:
        least = smallest_factor(problem, t_free=t_free)
        if least < 1.0:
            detail = f"{names}: only some {100.0 * (1.0 / least - 1.0):.1g} % above the least"
            return ComputationError(Outcome.BEYOND_HORIZON, Message("verbatim", text=detail))
        least *= 1.0 + LEAST_TOLERANCE
        units = [problem.plant.unit(k.bound.name) for k in problem.limits]
        values = [f"{least * k.bound.value:.4g}" for k in problem.limits]
        bounds = ", ".join(f"{value} {unit}" for value, unit in zip(values, units, strict=True))
        detail = f"{names}: the smallest possible is about {bounds}"
        return ComputationError(Outcome.BOUND_CANNOT_HOLD, Message("verbatim", text=detail))
    return _beyond(problem, longest)


def _beyond(problem: BoundedProblem, longest: GridOptimum) -> ComputationError:
    return ComputationError(
        Outcome.BEYOND_HORIZON,
        Message(
            "verbatim", text=f"{_named(problem)}: t_f would be longer than {longest.t_f:.4g} s"
        ),
    )


def _named(problem: BoundedProblem) -> str:
    return bounds_text(problem.plant, tuple(limit.bound for limit in problem.limits))


def _cells(problem: BoundedProblem, t_f: float, radians: float) -> int:
    fewest = FEWEST_CELLS if radians == RADIANS_PER_CELL else FEWEST_CELLS // 2
    return int(np.clip(t_f * problem.vibration_rate / radians, fewest, MOST_CELLS))


def _solve(
    problem: BoundedProblem, t_f: float, *, radians: float, near: GridOptimum | None = None
) -> GridOptimum:
    """Return the optimum of a grid; where the simplex method gives up, of a slightly finer one."""
    cells = _cells(problem, t_f, radians)
    for extra in OTHER_GRIDS:
        found = _attempt(problem, t_f, cells=cells + cells * extra // 100, near=near)
        if found is not None:
            return found
    detail = f"the linear program of {cells} cells for {t_f:.6g} s did not end"
    raise ComputationError(Outcome.NO_CONVERGENCE, Message("verbatim", text=detail))


def _attempt(
    problem: BoundedProblem, t_f: float, *, cells: int, near: GridOptimum | None
) -> GridOptimum | None:
    grid, n_limits = cell_grid(problem, t_f, cells=cells), len(problem.limits)
    follows = np.repeat([limit.follows for limit in problem.limits], cells)
    column = -follows[:, np.newaxis].astype(np.float64)
    # A bound that follows the reach has two rows, the others one with a floor and a ceiling.
    program = Program(
        cost=np.append(np.zeros(cells), -1.0),
        rows=np.block([[grid.response, column], [-grid.response[follows], column[follows]]]),
        rooms=np.append(np.where(follows, 0.0, 1.0), np.zeros(follows.sum())),
        floors=np.append(np.where(follows, -inf, -1.0), np.full(follows.sum(), -inf)),
        equal=np.column_stack([grid.moments, -grid.target]),
        right=np.zeros(grid.target.size),
        lower=np.append(-np.ones(cells), 0.0),
        upper=np.append(np.ones(cells), inf),
    )
    start = near.basis if near is not None and near.force.size == cells else None
    answer = solve_program(program, steps=STEPS_PER_CELL * cells, start=start)
    if answer is None:
        return None
    force = answer.unknowns[:-1]
    first, second = np.abs(answer.bounds[:2])
    return GridOptimum(
        t_f=t_f,
        reach=float(answer.unknowns[-1]),
        # F |σ| at the start, extrapolated from its means over the first two cells.
        slope=max(float(1.5 * first - 0.5 * second), 0.5 * float(first)) * cells / t_f,
        force=force,
        levels=(grid.response @ force).reshape(n_limits, cells),
        basis=answer.basis,
    )
