"""The first cells of a motion under bounds: as coarse as tells about how long it takes.

Wherever a motion breaks a bound between points, another point is put in. Where no time is found,
the smallest bound tells why.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.optimal.linear_program import Basis, Program, solve_program
from mtcommission.optimal.modes import in_moments
from mtcommission.optimal.problem import BoundedProblem, describe_bounds
from mtcommission.optimal.program import (
    Cells,
    Plan,
    Points,
    at_ends,
    excess,
    find_peaks,
    may_act,
    point_rows,
    segments,
    solve_cells,
)
from mtcommission.optimal.settings import SETTINGS

Array = NDArray[np.float64]


def _least_factor(problem: BoundedProblem, plan: Plan) -> float:
    """Return the least factor of all bounds with which the target is reached on the same cells."""
    cells = plan.edges.size - 1
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
        steps=SETTINGS.steps * (cells + len(rows)),
    )
    return inf if solution is None else float(solution.unknowns[-1])


def _later(cells: Cells, *, wanted: float) -> float:
    """Return the factor on t_f at which the reach should be what is wanted, within safe steps."""
    change = (wanted - cells.reach) / max(cells.slope * cells.t_f, SETTINGS.least_slope)
    return 1.0 + float(np.clip(change, -SETTINGS.largest_change, SETTINGS.largest_change))


def exchange(
    problem: BoundedProblem,
    plan: Plan,
    *,
    tolerance: float,
    start: Basis | None = None,
    relaxed: bool = True,
    wanted: float = 1.0,
) -> Cells | None:
    """Return the solution that just reaches the target and keeps the bounds to a tolerance.

    What the last program has not reached or kept is less than what it was told, or told anew.
    ``wanted``: the reach; ``relaxed``: as ``program.segments``.
    """
    found: Cells | None = None
    for _ in range(SETTINGS.exchanges):
        following = solve_cells(problem, plan, start=start, relaxed=relaxed)
        if following is None:
            break
        before, found = found, following
        # Where the first cells say nothing of the slope, a chord over more and more points must do.
        is_same = before is not None and before.weights.size == found.weights.size
        is_flat = found.slope * found.t_f < SETTINGS.least_slope
        if before is not None and (is_same or is_flat) and found.t_f != before.t_f:
            secant = (found.reach - before.reach) / (found.t_f - before.t_f)
            found = replace(found, slope=secant) if secant > 0.0 else found
        peaks = find_peaks(problem, found)
        more = Points(remaining=peaks.remaining, limit=peaks.limit)
        over = excess(problem, found, peaks) > tolerance
        over &= may_act(problem, replace(found.plan, points=more))
        is_timely = abs(found.reach - wanted) < 0.1 * tolerance
        if is_timely and not over.any():
            break
        share = 1.0 if is_timely else _later(found, wanted=wanted)
        every = found.plan.points.joined(peaks.remaining[over], peaks.limit[over])
        plan, start = replace(found.plan, points=every).scaled(share), found.basis
        if plan.edges.size * every.limit.size > SETTINGS.most_entries:
            break
    return found


def _first_edges(problem: BoundedProblem, t_f: float, *, finer: int) -> Array:
    """Return even edges; of a long move close together at its ends and those of its cruise."""
    cell = SETTINGS.radians_per_cell / finer / problem.vibration_rate
    count, fewest = int(t_f / cell), finer * SETTINGS.fewest_cells
    if problem.ramp < inf:  # on its cruise cells may be as long as they like
        most, longest = fewest, inf
        is_short = count < most
    else:
        most = int((SETTINGS.first_entries / max(len(problem.limits), 1)) ** 0.5)
        longest = t_f / SETTINGS.fewest_between
        is_short = count < SETTINGS.coarsest * most
    if is_short:
        return np.linspace(0.0, t_f, max(min(count, most), fewest) + 1)
    ramp = min(problem.ramp, 0.5 * t_f)
    places = np.unique([0.0, ramp, t_f - ramp, t_f])
    edges = [0.0]
    while edges[-1] < t_f:
        ahead = places[np.searchsorted(places, edges[-1], side="right") :]
        far = min(float(np.abs(places - edges[-1]).min()), float(ahead[0]) - edges[-1])
        edges.append(edges[-1] + min(max(cell, SETTINGS.growth * far), longest))
    return np.array(edges) * (t_f / edges[-1])


def _first_points(problem: BoundedProblem, edges: Array) -> Points:
    """Return all bounds at the ends of cells and, where those are long, evenly between.

    A long cell would keep its bounds at its end only, and run away from them before.
    """
    t_f = float(edges[-1])
    needed = t_f * problem.vibration_rate / SETTINGS.radians_per_cell
    if problem.ramp == inf and needed > SETTINGS.coarsest * edges.size:
        places = int(min(needed, SETTINGS.most_places / max(len(problem.limits), 1)))
        edges = np.union1d(edges, np.linspace(0.0, t_f, places + 1))
    return at_ends(problem, edges)


def first_cells(problem: BoundedProblem, *, t_free: float, finer: int = 1) -> Cells:
    """Return the solution on first cells that reaches the target, all bounds at all their ends.

    ``finer``: times as many cells as are enough for most.

    Raises
    ------
    ComputationError
        BOUND_CANNOT_HOLD if the reach does not grow any more; BEYOND_HORIZON if it still grows
        at the end of the search.
    """
    t_f = 1.05 * t_free
    found = earlier = _evenly(problem, t_f, finer=finer)
    faster: Cells | None = None
    slower: Cells | None = None
    missing, spare, was_slow = 1.0, 1.0, False
    for _ in range(SETTINGS.time_steps):
        # Where the reach hardly grows, as near the smallest possible bound, α alone says little.
        steepness = float(np.clip(found.slope * t_f, SETTINGS.least_slope, 1.0))
        if abs(found.reach - 1.0) < SETTINGS.time_tolerance * steepness:
            return found
        if found.reach < 1.0:
            shrinks = slower is None and faster and found.reach < faster.reach
            if faster and shrinks and _is_coarse(problem, found):
                raise beyond_time(problem, faster)
            if finer == 1 and shrinks:
                return first_cells(problem, t_free=t_free, finer=SETTINGS.finer)
            if found.t_f > SETTINGS.horizon * t_free or _is_still(earlier, found):
                raise _out_of_reach(problem, found, t_free)
            earlier = found if found.t_f > SETTINGS.longer * earlier.t_f else earlier
            faster, missing = found, 1.0 - found.reach
            # Illinois' rule: the chord moves on from an end that stays twice.
            spare, was_slow = spare * (1.0 if was_slow else 0.5), False
        else:
            slower, spare = found, found.reach - 1.0
            missing, was_slow = missing * (0.5 if was_slow else 1.0), True
        if slower is None or faster is None:
            step = (1.0 - found.reach) / max(found.slope, 1e-3 / t_f)
            low, high = (1.02, 2.0) if slower is None else (0.5, 0.98)
            t_f = float(np.clip(t_f + step, low * t_f, high * t_f))
        elif slower.t_f - faster.t_f < 1e-7 * slower.t_f:
            return found
        else:
            share = float(np.clip(missing / (missing + spare), SETTINGS.edge, 1.0 - SETTINGS.edge))
            t_f = faster.t_f + share * (slower.t_f - faster.t_f)
        try:
            found = _evenly(problem, t_f, near=found, finer=finer)
        except ComputationError as error:
            if slower is not None or found.t_f < SETTINGS.longer * t_free:
                raise
            raise beyond_time(problem, found) from error
    raise ComputationError(Outcome.NO_CONVERGENCE, Message("grid-search-stopped", t_f=t_f))


def _is_coarse(problem: BoundedProblem, found: Cells) -> bool:
    """Return whether cells are too long for the fastest mode: what they cannot do, others may."""
    count = found.t_f * problem.vibration_rate / SETTINGS.radians_per_cell
    return problem.ramp == inf and found.force.size < int(count)


def _is_still(earlier: Cells, found: Cells) -> bool:
    """Return whether the reach does not grow any more, over times some way apart."""
    is_long = found.t_f > SETTINGS.longer * earlier.t_f
    return is_long and found.reach - earlier.reach < SETTINGS.standstill * found.reach


def _evenly(problem: BoundedProblem, t_f: float, *, finer: int, near: Cells | None = None) -> Cells:
    edges = _first_edges(problem, t_f, finer=finer)
    start = near.basis if near is not None and near.force.size == edges.size - 1 else None
    points = _first_points(problem, edges)
    if near is not None:  # what the free motions of another time have asked for
        after = near.plan.points.chosen(near.plan.points.limit >= near.limits)
        points = points.joined(after.remaining, after.limit)
    elif len(problem.tails):
        points = points.joined(*_first_contacts(problem))
    found = solve_cells(problem, Plan(edges=edges, points=points), start=start)
    if found is None:
        detail = Message("grid-program-unfinished", cells=edges.size - 1, t_f=t_f)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return found


def _first_contacts(problem: BoundedProblem) -> tuple[Array, NDArray[np.intp]]:
    """Return instants after the end, as remaining times [s], at which each tail keeps the band."""
    rates = in_moments(problem.plant).functions.magnitudes
    s = np.linspace(0.0, SETTINGS.contact_radians / float(rates.min()), SETTINGS.contacts)
    machines = len(problem.tails)
    tails = len(problem.limits) + np.arange(machines)
    return np.tile(-s, machines), np.repeat(tails, SETTINGS.contacts)


def _out_of_reach(problem: BoundedProblem, longest: Cells, t_free: float) -> ComputationError:
    named = describe_bounds(problem.plant, problem.bounds)
    if longest.t_f > SETTINGS.horizon * t_free or _is_coarse(problem, longest):
        return beyond_time(problem, longest)
    least = _least_factor(problem, longest.plan)
    if least <= 0.0:  # the program knows no digit of it: nothing is proved against the bounds
        detail = Message("grid-search-stopped", t_f=longest.t_f)
        return ComputationError(Outcome.NO_CONVERGENCE, detail)
    if least < 1.0 + SETTINGS.least_tolerance:
        detail = Message("bounds-near-least", bounds=named, within=SETTINGS.least_tolerance)
        return ComputationError(Outcome.BEYOND_HORIZON, detail)
    least *= 1.0 + SETTINGS.least_tolerance
    smallest = tuple(
        Message("value-about", value=least * bound.value, unit=problem.plant.unit(bound.name))
        for bound in problem.bounds
    )
    detail = Message("bounds-below-least", bounds=named, least=smallest)
    return ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)


def beyond_time(problem: BoundedProblem, longest: Cells) -> ComputationError:
    """Return the refusal of bounds that no program of acceptable size keeps."""
    bounds = describe_bounds(problem.plant, problem.bounds)
    detail = Message("bounds-beyond-time", bounds=bounds, t_f=longest.t_f)
    return ComputationError(Outcome.BEYOND_HORIZON, detail)
