"""Programs on finer and finer cells, until they prove the time that they take.

First cells tell about how long the move takes; wherever a motion breaks a bound between points,
another point is put in. The multipliers of one program tell where the next has its cells: at the
zeros of σ and about the ends of arcs and touch points; well inside a boundary arc it has none but
holds the bound. So proof and program come together, and what is left between them is the gap.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.optimal.control import Arc, Bang, Interior, constant_arc
from mtcommission.optimal.linear_program import Basis, Program, solve_program
from mtcommission.optimal.modes import in_moments
from mtcommission.optimal.problem import ArcInterior, BoundedProblem, describe_bounds
from mtcommission.optimal.program import (
    STEPS,
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
from mtcommission.optimal.proof import (
    Dual,
    Stretch,
    densities,
    require_followable,
    slopes,
    weigh,
)
from mtcommission.optimal.sequence import Structure, boundary_arc, detect_structure, local_cell

Array = NDArray[np.float64]

LEAST_TIMES = (1.6, 2.2, 3.0, 4.2, 6.0, 10.0)
"""Where the smallest possible bound is looked for, in multiples of the free optimum: it falls
with t_f until more time does not help any more."""
LEAST_CELLS = (400, 800)
"""For the smallest bound: to search its time, and to refine it for a single bound."""
LEAST_TOLERANCE = 2e-4
"""Relative change of the smallest bound, over time and cells, that counts as none."""


def _smallest_factor(problem: BoundedProblem, *, t_free: float) -> float:
    """Return the factor of all bounds below which the target is out of reach at any time."""
    least, time = inf, LEAST_TIMES[0]
    for share in LEAST_TIMES:
        now = _least_factor(problem, share * t_free, cells=LEAST_CELLS[0])
        if now > least * (1.0 - LEAST_TOLERANCE):
            break
        least, time = now, share
    if len(problem.limits) == 1:
        now = _least_factor(problem, time * t_free, cells=LEAST_CELLS[1])
        least = now if isfinite(now) else least
    return least


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


FEWEST_CELLS, MOST_CELLS = 100, (400, 900)
"""At first: enough to see every feature, few enough for a fraction of a second; the more without a
cruise, of which one knows where it begins and ends (empirical)."""
RADIANS_PER_CELL = 0.8
"""Between the two, cells that resolve the fastest mode (empirical)."""
GROWTH = 0.15
"""Of cells with the distance from the ends of a long move and of its cruise (empirical)."""
TIME_STEPS, HORIZON = 40, 60.0
"""Programs of the first search of t_f, and its longest t_f in multiples of the free optimum."""
FAR = 3.0
"""The same from which on a program that rounding spoils ends the search."""
TIME_TOLERANCE = 1e-3
"""|α - 1| at which the first search ends, times dα/dlog t_f between the next two."""
STEEPNESS = (0.01, 1.0)
LONGER, STANDSTILL = 1.5, 1e-3
"""Factor between two times over which the reach has to grow, by how much, or it never will."""
INSIDE = (0.02, 0.98)
"""Share of a bracket of t_f in which the next time lies."""
LEAST_SLOPE, LARGEST_CHANGE = 0.3, 0.02
"""Least dα/dlog t_f that is believed, and largest relative change of t_f in one step."""
MOST_ENTRIES = 1.5e6
"""Cells times points of a program: some seconds."""
CONTACT_RADIANS, CONTACTS = 6.3, 12
"""Of the slowest mode, over which the free motion is asked at first, and at how many instants."""
EXCHANGES = 20
"""Rounds at most in which peaks become points and t_f is corrected."""


def later(cells: Cells, *, wanted: float = 1.0) -> float:
    """Return the factor on t_f at which the reach should be what is wanted, within safe steps."""
    change = (wanted - cells.reach) / max(cells.slope * cells.t_f, LEAST_SLOPE)
    return 1.0 + float(np.clip(change, -LARGEST_CHANGE, LARGEST_CHANGE))


def exchange(
    problem: BoundedProblem, plan: Plan, *, tolerance: float, start: Basis | None = None
) -> Cells | None:
    """Return the solution that just reaches the target and keeps the bounds to a tolerance.

    What the last program has not reached or kept is less than what it was told, or told anew.
    """
    found: Cells | None = None
    for _ in range(EXCHANGES):
        following = solve_cells(problem, plan, start=start)
        if following is None:
            break
        before, found = found, following
        # Where the first cells say nothing of the slope, a chord over more and more points must do.
        is_same = before is not None and before.weights.size == found.weights.size
        is_flat = found.slope * found.t_f < LEAST_SLOPE
        if before is not None and (is_same or is_flat) and found.t_f != before.t_f:
            secant = (found.reach - before.reach) / (found.t_f - before.t_f)
            found = replace(found, slope=secant) if secant > 0.0 else found
        peaks = find_peaks(problem, found)
        more = Points(remaining=peaks.remaining, limit=peaks.limit)
        over = excess(problem, found, peaks) > tolerance
        over &= may_act(problem, replace(found.plan, points=more))
        is_timely = abs(found.reach - 1.0) < 0.1 * tolerance
        if is_timely and not over.any():
            break
        share = 1.0 if is_timely else later(found)
        every = found.plan.points.joined(peaks.remaining[over], peaks.limit[over])
        plan, start = replace(found.plan, points=every).scaled(share), found.basis
        if plan.edges.size * every.limit.size > MOST_ENTRIES:
            break
    return found


def _first_edges(problem: BoundedProblem, t_f: float, *, radians: float) -> Array:
    """Return even edges; of a long move close together at its ends and those of its cruise."""
    cell = radians / problem.vibration_rate
    if t_f / cell < MOST_CELLS[bool(problem.ramp == inf)]:
        return np.linspace(0.0, t_f, max(int(t_f / cell), FEWEST_CELLS) + 1)
    ramp = min(problem.ramp, 0.5 * t_f)
    places = np.unique([0.0, ramp, t_f - ramp, t_f])
    edges = [0.0]
    while edges[-1] < t_f:
        ahead = places[np.searchsorted(places, edges[-1], side="right") :]
        far = min(float(np.abs(places - edges[-1]).min()), float(ahead[0]) - edges[-1])
        edges.append(edges[-1] + max(cell, GROWTH * far))
    return np.array(edges) * (t_f / edges[-1])


def first_cells(problem: BoundedProblem, *, t_free: float) -> Cells:
    """Return the solution on first cells that reaches the target, all bounds at all their ends.

    Raises
    ------
    ComputationError
        BOUND_CANNOT_HOLD if the reach does not grow any more; BEYOND_HORIZON if it still grows
        at the end of the search.
    """
    t_f = 1.05 * t_free
    found = earlier = _evenly(problem, t_f)
    faster: Cells | None = None
    slower: Cells | None = None
    missing, spare, was_slow = 1.0, 1.0, False
    for _ in range(TIME_STEPS):
        # Where the reach hardly grows, as near the smallest possible bound, α alone says little.
        steepness = float(np.clip(found.slope * t_f, *STEEPNESS))
        if abs(found.reach - 1.0) < TIME_TOLERANCE * steepness:
            return found
        if found.reach < 1.0:
            if found.t_f > HORIZON * t_free or _is_still(earlier, found):
                raise _out_of_reach(problem, found, t_free)
            earlier = found if found.t_f > LONGER * earlier.t_f else earlier
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
            share = float(np.clip(missing / (missing + spare), *INSIDE))
            t_f = faster.t_f + share * (slower.t_f - faster.t_f)
        try:
            found = _evenly(problem, t_f, near=found)
        except ComputationError as error:
            if slower is not None or found.t_f < FAR * t_free:
                raise
            raise beyond_time(problem, found) from error
    raise ComputationError(Outcome.NO_CONVERGENCE, Message("grid-search-stopped", t_f=t_f))


def _is_still(earlier: Cells, found: Cells) -> bool:
    """Return whether the reach does not grow any more, over times some way apart."""
    is_long = found.t_f > LONGER * earlier.t_f
    return is_long and found.reach - earlier.reach < STANDSTILL * found.reach


def _evenly(problem: BoundedProblem, t_f: float, *, near: Cells | None = None) -> Cells:
    edges = _first_edges(problem, t_f, radians=RADIANS_PER_CELL)
    start = near.basis if near is not None and near.force.size == edges.size - 1 else None
    points = at_ends(problem, edges)
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
    s = np.linspace(0.0, CONTACT_RADIANS / float(rates.min()), CONTACTS)
    machines = len(problem.tails)
    tails = len(problem.limits) + np.arange(machines)
    return np.tile(-s, machines), np.repeat(tails, CONTACTS)


def _out_of_reach(problem: BoundedProblem, longest: Cells, t_free: float) -> ComputationError:
    named = describe_bounds(problem.plant, problem.bounds)
    if longest.t_f > HORIZON * t_free:
        return beyond_time(problem, longest)
    least = _smallest_factor(problem, t_free=t_free)
    if least <= 0.0:  # the program knows no digit of it: nothing is proved against the bounds
        detail = Message("grid-search-stopped", t_f=longest.t_f)
        return ComputationError(Outcome.NO_CONVERGENCE, detail)
    if least < 1.0:
        detail = Message("bounds-near-least", bounds=named, above=1.0 / least - 1.0)
        return ComputationError(Outcome.BEYOND_HORIZON, detail)
    least *= 1.0 + LEAST_TOLERANCE
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


ROUNDS = 10
"""Programs on finer and finer cells."""
MOST_RADIANS = 3e5
"""Fastest rate times t_f up to which a control under bounds is looked for."""
PATIENCE = 2
"""Programs in succession that prove less than the best one, after which the search ends."""
LOST, BLIND = 0.05, 1
"""Distance of the reach from 1 at which a program has not even found the time, and how many of the
first ones may end so: their cells are too long for the bounds then."""
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
"""What the programs of the rounds may miss of bounds and target; the last from there on."""
LEAST_HIDDEN, LARGE_SHARE = 3e-10, 0.01
"""Share of the time that a zero of σ hides in its cell, and of the largest, from which its cell is
divided."""
BESIDE = 1.0 / 8.0
"""Distance from a zero of further edges, in its cell: it moves when the program is solved again."""
NEARBY = 3.0
"""Cells about an acting point in which new edges become points, too."""
MARGINS, SHORT = (3.0, 15.0), 0.7
"""Cells between an interior and the ends of its arc, for orders 1 and 2 and for higher ones, and
the share of its arc that they may take."""
LEAST_ARCS = (0.0, 0.06)
"""Share of t_f from which an arc has an interior, by order as before."""
JUNCTIONS, BEYOND = (6, 30), 0.3
"""Even cells at an end of an arc from its interior on, by order, and how far they go beyond."""
WIDER, SETBACK = 4.0, 3.0
"""Factor on that after a program that proves less than one before, and on the gap from which the
one before is refined instead."""
INSIDES, APART = 8, 0.3
"""Edges inside an interior from each end on, for what looks at its cells, and the share of one that
others keep from its ends."""
WRONG, PARTING = 1e-6, 1e-6
"""Share of the largest density that counts as none, and excess over another bound that parts an
arc."""
MOST_GROWTH = 10.0
"""Growth of the motion over an interior, as exponent of e, from which no digits are left."""
SEVERAL = 2
"""Machines from which on no interiors are held: what no proof is asked of does without them."""
LEAST_CELL = 1e-9
"""Share of t_f that new edges keep from old ones."""
FINISHES, SPARE = 16, 2e-9
"""Programs until a control on cells keeps everything, and the reach that it has to spare."""
POINT_EXCESS = 3e-8
"""Excess over a bound that calls for another point then; less is paid for by time."""
FULL = 1.0 - 1e-9
"""Share of the force limit from which a cell is a bang arc, as is one within that of the next."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seen:
    """What the multipliers of a program show."""

    cells: Cells
    mesh: Array  # Its edges, and some in the interiors
    dual: Dual  # Their worth
    hidden: Array  # Share of the time that each zero of σ hides in its cell
    structure: Structure
    gap: float  # Relative distance of t_f from the time that they exclude


def refined(problem: BoundedProblem, first: Cells) -> Iterator[Seen]:
    """Yield what programs on finer and finer cells show, until they become too large.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG; BEYOND_HORIZON where first cells are too long for the bounds.
    """
    require_followable(first.t_f, problem.rate, most=MOST_RADIANS)
    best, room, worse, edges = observe(problem, first), 1.0, 0, first.plan.edges
    plan = _planned(problem, best, edges, first.acting, room=room)
    for i in range(ROUNDS):
        cells = exchange(problem, plan, tolerance=TOLERANCES[min(i, len(TOLERANCES) - 1)])
        if cells is None or abs(cells.reach - 1.0) > LOST:
            if best.cells is first and i >= BLIND:
                raise beyond_time(problem, first)
            # The arcs that it holds are not those of the optimum: shorter cells show them.
            edges = np.union1d(edges, 0.5 * (edges[1:] + edges[:-1]))
            plan = Plan(edges=edges, points=best.cells.acting)
        else:
            seen = observe(problem, cells)
            yield seen
            if seen.gap < best.gap or best.cells is first:
                best, worse = seen, 0
            else:
                # Points that crowd towards an arc look like its end: an interior there is too long.
                room, worse = room * WIDER, worse + 1
            if worse == PATIENCE:
                return
            base = best if seen.gap > SETBACK * best.gap else seen
            plan = finer(problem, base, room=room)
            edges = plan.edges
        if plan.edges.size * max(plan.points.limit.size, plan.edges.size) > MOST_ENTRIES:
            return


def observe(problem: BoundedProblem, cells: Cells) -> Seen:
    """Return what the multipliers of a program show."""
    measure, edges = cells.measure, cells.plan.edges
    dual = weigh(problem, measure)
    zeros, held = dual.zeros, _rightly_held(problem, dual.parts, measure.interiors)
    mesh = _with_insides(problem, edges, measure.interiors, held)
    structure = detect_structure(measure.atoms, mesh, held)
    after = np.clip(np.searchsorted(edges, zeros), 1, edges.size - 1)
    nearer = np.minimum(zeros - edges[after - 1], edges[after] - zeros)
    along = abs(float(measure.terminal @ problem.target))
    return Seen(
        cells=cells,
        mesh=mesh,
        dual=dual,
        # The program sees |∫ σ| of a cell only, so the smaller part of its zero's counts twice.
        hidden=problem.force_limit * np.abs(slopes(problem, dual.parts, zeros)) * nearer**2 / along,
        structure=structure,
        # A reach below 1 is missing time.
        gap=1.0 - dual.lower_bound / cells.t_f + max(1.0 - cells.reach, 0.0),
    )


def _with_insides(
    problem: BoundedProblem,
    edges: Array,
    interiors: tuple[ArcInterior, ...],
    held: list[ArcInterior],
) -> Array:
    """Return the edges with some in the interiors: about their ends, and where holding costs time.

    An end has cells of one size on both sides.
    """
    more = [edges]
    steps = np.arange(1, INSIDES + 1)
    for one in interiors:
        first, last = np.searchsorted(edges, [one.end, one.start])
        cells = edges[first] - edges[first - 1], edges[min(last + 1, edges.size - 1)] - edges[last]
        inside = [one.end + cells[0] * steps, one.start - cells[1] * steps]
        kept = sorted((span.end, span.start) for span in held if one.end <= span.end < one.start)
        stops = [one.end, *(stop for span in kept for stop in span), one.start]
        for low, high in zip(stops[::2], stops[1::2], strict=True):
            if high > low:
                cell = (high - low) / INSIDES
                count = max(INSIDES, int((high - low) * problem.vibration_rate / RADIANS_PER_CELL))
                inside += [np.linspace(low, high, count + 1)]
                inside += [low - cell * steps, high + cell * steps]
        every = np.concatenate(inside)
        more.append(every[(every > one.end) & (every < one.start)])
    return np.unique(np.concatenate(more))


def _rightly_held(
    problem: BoundedProblem, parts: tuple[Stretch, ...], interiors: tuple[ArcInterior, ...]
) -> list[ArcInterior]:
    """Return where in the interiors the density has the sign of the side: where holding pays."""
    found: list[ArcInterior] = []
    for one in interiors:
        middle = 0.5 * (one.start + one.end)
        part = next(part for part in parts if part.end <= middle <= part.start)
        density = one.side * densities(problem, part)[0]
        tau = np.linspace(part.end, part.start, density.size)
        right = density > -WRONG * np.abs(density).max()
        turns = np.flatnonzero(np.diff(np.pad(right.astype(np.int8), 1)))
        for first, stop in zip(turns[::2].tolist(), turns[1::2].tolist(), strict=True):
            if stop - first > 1:
                found.append(replace(one, end=float(tau[first]), start=float(tau[stop - 1])))
    return found


def finer(problem: BoundedProblem, seen: Seen, *, room: float) -> Plan:
    """Return the next program: cells divided where σ changes sign.

    The force may then switch there. About ends of arcs and touch points cells are halved.
    """
    edges, zeros = seen.mesh, seen.dual.zeros
    arcs, widths = seen.structure.arcs, np.diff(edges)
    around = widths[np.clip(np.searchsorted(edges, zeros), 1, widths.size) - 1]
    on_arc, hidden = np.zeros(zeros.size, dtype=bool), seen.hidden
    for arc in arcs:
        on_arc |= (arc.end <= zeros) & (zeros <= arc.start)
    large = hidden > max(LEAST_HIDDEN, LARGE_SHARE * float(hidden.max(initial=0.0)))
    moving = zeros[large & ~on_arc], BESIDE * around[large & ~on_arc]
    points = seen.cells.acting
    touched = [touch.remaining for touch in seen.structure.touches]
    ends = [end for arc in arcs for end in (arc.start, arc.end)]
    here = np.clip(np.searchsorted(edges, [*touched, *ends]), 1, widths.size).astype(np.intp)
    middles = 0.5 * (edges[:-1] + edges[1:])
    beside = np.unique([here - 1, np.minimum(here, widths.size - 1)])
    new = np.concatenate(
        [zeros[large], moving[0] - moving[1], moving[0] + moving[1], middles[beside]]
    )
    inside = new[(new > 0.0) & (new < edges[-1])]
    apart = np.abs(edges[np.searchsorted(edges, inside) - [[1], [0]]] - inside).min(axis=0)
    finer = np.unique(np.concatenate([edges, inside[apart > LEAST_CELL * edges[-1]]]))
    for k in range(len(problem.limits)):
        own = np.sort(points.remaining[points.limit == k])
        if own.size:
            far = np.abs(finer[1:-1, np.newaxis] - own).min(axis=1)
            near = finer[1:-1][far < NEARBY * np.maximum(*map(np.diff, (finer[1:], finer[:-1])))]
            points = points.joined(near, np.full(near.size, k))
    return _planned(problem, seen, finer, points, room=room)


def _planned(
    problem: BoundedProblem, seen: Seen, edges: Array, points: Points, *, room: float
) -> Plan:
    """Return a plan that holds the arcs well inside their ends."""
    interiors, junctions, t_f = [], list[Array](), float(edges[-1])
    for one in seen.cells.plan.interiors:
        # What is not held any more needs cells.
        count = int((one.start - one.end) * problem.vibration_rate / RADIANS_PER_CELL)
        junctions.append(np.linspace(one.end, one.start, max(count, JUNCTIONS[1]) + 1))
        points = points.joined(junctions[-1], np.full(junctions[-1].size, one.limit))
    for arc in _parted(problem, seen) if len(problem.tails) < SEVERAL else ():
        limit, length = problem.limits[arc.limit], arc.start - arc.end
        is_high = limit.order > 2
        early, late = (
            room * MARGINS[is_high] * local_cell(seen.mesh, end) for end in (arc.start, arc.end)
        )
        if is_high:
            early, late = min(early, 0.25 * length), min(late, 0.25 * length)
        # Motion that grows on the arc leaves an interior no digits: points must do there. Points
        # that touch in a row may look like a short arc where the order is above 2.
        is_steady = limit.growth * length < MOST_GROWTH
        is_long = early + late < SHORT * length and length > LEAST_ARCS[is_high] * t_f
        if is_steady and is_long:
            interiors.append(replace(arc, start=arc.start - early, end=arc.end + late))
            steps = np.linspace(-BEYOND, 1.0, JUNCTIONS[is_high] + 1)
            junctions += [arc.start - steps * early, arc.end + steps * late]
    for new in junctions:
        inside = new[(new > 0.0) & (new < t_f)]
        apart = np.abs(edges[np.searchsorted(edges, inside) - [[1], [0]]] - inside).min(axis=0)
        edges = np.union1d(edges, inside[apart > APART * abs(new[1] - new[0])])
    ends = [end for one in interiors for end in (one.start, one.end)]
    for one in interiors:
        outside = np.sort(np.concatenate([edges[edges < one.end], edges[edges > one.start]]))
        close = APART * np.gradient(outside)
        edges = outside[(outside < one.end - close) | (outside > one.start + close)]
        points = points.joined(np.array([one.start, one.end]), np.full(2, one.limit))
    edges = np.unique(np.concatenate([edges, ends]))
    return Plan(edges=edges, points=points, interiors=tuple(interiors))


def _parted(problem: BoundedProblem, seen: Seen) -> list[ArcInterior]:
    """Return the arcs between the places of other bounds that no interior may hold."""
    cells, parts = seen.cells, list[ArcInterior]()
    peaks = find_peaks(problem, cells)
    over = excess(problem, cells, peaks) > PARTING
    acting = cells.acting
    for arc in seen.structure.arcs:
        order = problem.limits[arc.limit].order
        cuts = [
            at
            for limits, places in (
                (peaks.limit[over], peaks.remaining[over]),
                (acting.limit, acting.remaining),
            )
            for k, at in zip(limits.tolist(), places.tolist(), strict=True)
            if arc.end < at < arc.start and k != arc.limit and problem.limits[k].order <= order
        ]
        stops = [arc.start, *sorted(cuts, reverse=True), arc.end]
        parts += [replace(arc, start=start, end=end) for start, end in pairwise(stops)]
    return parts


def finishes(problem: BoundedProblem, cells: Cells) -> Iterator[Cells]:
    """Yield controls on cells with as much time as it takes to keep the bounds everywhere.

    What exceeds a bound is paid for by reach to spare: all forces are divided by the reach.
    """
    plan, start, slope = cells.plan, None, cells.slope
    before: Cells | None = None
    slower: Cells | None = None
    for attempt in range(FINISHES):
        found = solve_cells(problem, plan, start=start, relaxed=False)
        if found is None:
            break
        # Other points change the reach as well, yet what the first cells say of it may be nothing.
        if before is not None and found.t_f != before.t_f:
            secant = (found.reach - before.reach) / (found.t_f - before.t_f)
            slope = secant if secant > 0.0 else slope
        before = found
        peaks = find_peaks(problem, found)
        over = excess(problem, found, peaks)
        worst = max(float(over.max(initial=0.0)), 0.0)
        wanted = 1.0 + worst + SPARE
        most = wanted + 10.0 * SPARE + worst * (1.0 if attempt < FINISHES // 2 else 10.0)
        if wanted - 0.5 * SPARE <= found.reach <= most:
            yield found
        elif found.reach > most and (slower is None or found.t_f < slower.t_f):
            slower = found
        bad = over > (POINT_EXCESS if attempt < FINISHES // 2 else inf)
        more = found.plan.points.joined(peaks.remaining[bad], peaks.limit[bad])
        share = later(replace(found, slope=slope), wanted=wanted + SPARE + 0.5 * worst)
        share = 1.0 if bad.any() and abs(found.reach - 1.0) < worst else share
        plan, start = replace(found.plan, points=more).scaled(share), found.basis
    if slower is not None:
        yield slower


def cell_arcs(problem: BoundedProblem, cells: Cells) -> tuple[Arc, ...]:
    """Return cells and interiors as arcs, scaled so that they reach the target once."""
    force, t_f, arcs = cells.force, cells.t_f, list[Arc]()
    begin, end, off = t_f - cells.start, t_f - cells.end, cells.interior < 0
    same = (np.abs(np.diff(force)) < 1.0 - FULL) & off[1:] & off[:-1]
    starts = [0, *(np.flatnonzero(~same) + 1).tolist(), force.size]
    for i, j in pairwise(starts):
        if not off[i]:
            index = cells.plan.interiors[cells.interior[i]].limit
            state = cells.states[i] / cells.reach
            arcs.append(
                boundary_arc(problem, index, float(begin[i]), float(end[j - 1]), state=state)
            )
            continue
        if end[j - 1] <= begin[i]:
            continue  # a cell that is shorter than the rounding of its time
        share = float(force[i:j] @ (end - begin)[i:j] / (end[j - 1] - begin[i]))
        control = Bang(1 if share > 0.0 else -1) if abs(share) > FULL else Interior()
        force_now = share * problem.force_limit / cells.reach
        arcs.append(
            constant_arc(float(begin[i]), float(end[j - 1]), control=control, force=force_now)
        )
    return tuple(arcs)
