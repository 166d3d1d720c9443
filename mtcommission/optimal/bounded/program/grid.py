"""Where the search begins: the bounded problem on an even grid, as a linear program.

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
from mtcommission.optimal.bounded.problem import BoundedProblem, describe_bounds
from mtcommission.optimal.bounded.program.even_grid import cell_grid
from mtcommission.optimal.bounded.program.linear_program import Basis, Program, solve_program
from mtcommission.optimal.bounded.program.smallest_bound import smallest_factor

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridOptimum:
    """The solution on the grid."""

    t_f: float  # [s]
    reach: float  # α, the reached multiple of the target
    slope: float  # dα/dt_f from the multipliers [1/s]
    force: Array  # F_set / F in each cell, shape (n_cells,)
    levels: Array  # c x at the ends of the cells, shape (n_limits, n_cells)
    basis: Basis  # Where the program for another t_f may start


def solve_grid_time(problem: BoundedProblem, *, t_free: float) -> GridOptimum:
    """Return the time-optimal control on the grid.

    Raises
    ------
    ComputationError
        BOUND_CANNOT_HOLD if the reach does not grow any more; BEYOND_HORIZON if it still grows
        at the end of the search.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.optimal.bounded.problem import (bounded_problem)
    >>> from mtcommission.optimal.solution import Bound
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = read_shipped("milling-manipulator").machine
    >>> problem = bounded_problem(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     bounds=(Bound(name="v_phi", value=0.005),), horizon=0.05)
    >>> round(solve_grid_time(problem, t_free=0.0435).t_f, 3)
    0.052
    """
    settings = problem.settings.program
    t_f, slower = 1.05 * t_free, None
    found = _solve(problem, t_f, radians=settings.coarse_radians)
    faster, missing, spare, was_slow = found, 1.0, 1.0, False
    for _ in range(settings.time_steps):
        # Where the reach hardly grows, as near the smallest possible bound, α alone says little.
        steepness = float(np.clip(found.slope * t_f, *settings.steepness))
        if abs(found.reach - 1.0) < settings.time_tolerance * steepness:
            return _on_fine_grid(problem, found)
        if found.reach < 1.0:
            before, faster, missing = faster, found, 1.0 - found.reach
            if _stands_still(problem, before, found) or found.t_f > settings.horizon * t_free:
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
            return _on_fine_grid(problem, found)
        else:
            share = float(np.clip(missing / (missing + spare), *settings.inside))
            t_f = faster.t_f + share * (slower.t_f - faster.t_f)
        try:
            found = _solve(problem, t_f, radians=settings.coarse_radians, near=found)
        except ComputationError as error:
            if slower is not None or found.t_f < settings.far * t_free:
                raise
            raise _beyond(problem, found) from error
    raise ComputationError(
        Outcome.NO_CONVERGENCE,
        Message("grid-search-stopped", t_f=t_f),
    )


def _stands_still(problem: BoundedProblem, before: GridOptimum, after: GridOptimum) -> bool:
    """Return whether a time much longer has not made the reach grow."""
    settings = problem.settings.program
    return (
        after.t_f > settings.longer * before.t_f
        and after.reach - before.reach < settings.standstill * after.reach
    )


def _on_fine_grid(problem: BoundedProblem, found: GridOptimum) -> GridOptimum:
    """Return the solution on the fine grid, if the coarse one was not fine enough."""
    settings = problem.settings.program
    if _cells(problem, found.t_f, settings.radians_per_cell) > found.force.size:
        found = _solve(problem, found.t_f, radians=settings.radians_per_cell)
    return found


def _out_of_reach(problem: BoundedProblem, longest: GridOptimum, t_free: float) -> ComputationError:
    settings = problem.settings.program
    named = describe_bounds(problem.plant, problem.bounds)
    if longest.t_f <= settings.horizon * t_free:
        least = smallest_factor(problem, t_free=t_free)
        if least <= 0.0:  # the program knows no digit of it: nothing is proved against the bounds
            detail = Message("grid-search-stopped", t_f=longest.t_f)
            return ComputationError(Outcome.NO_CONVERGENCE, detail)
        if least < 1.0:
            detail = Message("bounds-near-least", bounds=named, above=1.0 / least - 1.0)
            return ComputationError(Outcome.BEYOND_HORIZON, detail)
        least *= 1.0 + settings.least_tolerance
        smallest = tuple(
            Message("value-about", value=least * bound.value, unit=problem.plant.unit(bound.name))
            for bound in problem.bounds
        )
        detail = Message("bounds-below-least", bounds=named, least=smallest)
        return ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)
    return _beyond(problem, longest)


def _beyond(problem: BoundedProblem, longest: GridOptimum) -> ComputationError:
    bounds = describe_bounds(problem.plant, problem.bounds)
    detail = Message("bounds-beyond-time", bounds=bounds, t_f=longest.t_f)
    return ComputationError(Outcome.BEYOND_HORIZON, detail)


def _cells(problem: BoundedProblem, t_f: float, radians: float) -> int:
    settings = problem.settings.program
    fewest = (
        settings.fewest_cells
        if radians == settings.radians_per_cell
        else settings.fewest_cells // 2
    )
    return int(np.clip(t_f * problem.vibration_rate / radians, fewest, settings.most_cells))


def _solve(
    problem: BoundedProblem, t_f: float, *, radians: float, near: GridOptimum | None = None
) -> GridOptimum:
    """Return the optimum of a grid; where the simplex method gives up, of a slightly finer one."""
    cells = _cells(problem, t_f, radians)
    for extra in problem.settings.program.other_grids:
        found = _attempt(problem, t_f, cells=cells + cells * extra // 100, near=near)
        if found is not None:
            return found
    detail = Message("grid-program-unfinished", cells=cells, t_f=t_f)
    raise ComputationError(Outcome.NO_CONVERGENCE, detail)


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
    settings = problem.settings.program
    steps = settings.steps_per_cell * cells
    solution = solve_program(program, settings, steps=steps, start=start)
    if solution is None:
        return None
    force = solution.unknowns[:-1]
    first, second = np.abs(solution.bounds[:2])
    return GridOptimum(
        t_f=t_f,
        reach=float(solution.unknowns[-1]),
        # F |σ| at the start, extrapolated from its means over the first two cells.
        slope=max(float(1.5 * first - 0.5 * second), 0.5 * float(first)) * cells / t_f,
        force=force,
        levels=(grid.response @ force).reshape(n_limits, cells),
        basis=solution.basis,
    )
