"""Programs on finer and finer cells, until they prove the time that they take.

The multipliers of one program tell where the next has its cells: at the zeros of σ and about the
ends of arcs and touch points; well inside a boundary arc it has none but holds the bound. So proof
and program come together, and what is left between them is the gap.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.cells import beyond_time, exchange
from mtcommission.optimal.control import Arc, Bang, Interior, constant_arc
from mtcommission.optimal.problem import ArcInterior, BoundedProblem
from mtcommission.optimal.program import (
    Cells,
    Plan,
    Points,
    excess,
    find_peaks,
)
from mtcommission.optimal.proof import (
    Dual,
    Stretch,
    held_with,
    require_followable,
    slopes,
    weigh,
)
from mtcommission.optimal.sequence import Structure, boundary_arc, detect_structure, local_cell
from mtcommission.optimal.settings import SETTINGS

Array = NDArray[np.float64]


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
    require_followable(first.t_f, problem.rate, most=SETTINGS.most_radians)
    seen, edges = observe(problem, first), first.plan.edges
    plan = _planned(problem, seen, edges, first.acting)
    best: Seen | None = None
    worse = 0  # rounds since the best
    for i in range(SETTINGS.rounds):
        cells = exchange(
            problem, plan, tolerance=SETTINGS.tolerances[min(i, len(SETTINGS.tolerances) - 1)]
        )
        if cells is None:
            if seen.cells is first and i > 0:
                raise beyond_time(problem, first)
            # The arcs that it holds are not those of the optimum: shorter cells show them.
            edges = np.union1d(edges, 0.5 * (edges[1:] + edges[:-1]))
            plan = _halved(best.cells) if best else Plan(edges=edges, points=seen.cells.acting)
        else:
            seen = observe(problem, cells)
            yield seen
            if best is None or seen.gap < best.gap:
                best = seen
            # An arc held where it should not be spoils all multipliers.
            is_spoiled = seen.gap > SETTINGS.spoiled * best.gap
            plan, edges = _halved(best.cells) if is_spoiled else finer(problem, seen), seen.mesh
        # Large programs are worth their time while they bring program and proof together; one
        # round alone may hold an arc where it should not.
        worse = worse + 1 if best and seen is not best else 0
        share = SETTINGS.not_better if worse > 1 else 1.0
        entries = plan.edges.size * max(plan.points.limit.size, plan.edges.size)
        if entries > share * SETTINGS.most_entries:
            return


def _halved(cells: Cells) -> Plan:
    """Return the plan of a program with its cells halved, all else as it was."""
    plan = cells.plan
    middles = 0.5 * (plan.edges[1:] + plan.edges[:-1])
    edges = np.union1d(plan.edges, middles[plan.inside(middles) < 0])
    return replace(plan, edges=edges, points=cells.acting)


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
    steps = np.arange(1, SETTINGS.insides + 1)
    for one in interiors:
        first, last = np.searchsorted(edges, [one.end, one.start])
        cells = edges[first] - edges[first - 1], edges[min(last + 1, edges.size - 1)] - edges[last]
        inside = [one.end + cells[0] * steps, one.start - cells[1] * steps]
        kept = sorted((span.end, span.start) for span in held if one.end <= span.end < one.start)
        stops = [one.end, *(stop for span in kept for stop in span), one.start]
        for low, high in zip(stops[::2], stops[1::2], strict=True):
            if high > low:
                cell = (high - low) / SETTINGS.insides
                count = max(
                    SETTINGS.insides,
                    int((high - low) * problem.vibration_rate / SETTINGS.radians_per_cell),
                )
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
        for start, end, _ in held_with(problem, part, one.side):
            found.append(replace(one, start=start, end=end))
    return found


def finer(problem: BoundedProblem, seen: Seen) -> Plan:
    """Return the next program: cells divided where σ changes sign.

    The force may then switch there. About ends of arcs and touch points cells are halved.
    """
    edges, zeros = seen.mesh, seen.dual.zeros
    arcs, widths = seen.structure.arcs, np.diff(edges)
    around = widths[np.clip(np.searchsorted(edges, zeros), 1, widths.size) - 1]
    on_arc, hidden = np.zeros(zeros.size, dtype=bool), seen.hidden
    for arc in arcs:
        on_arc |= (arc.end <= zeros) & (zeros <= arc.start)
    large = hidden > SETTINGS.large_share * float(hidden.max(initial=0.0))
    moving = zeros[large & ~on_arc], SETTINGS.beside * around[large & ~on_arc]
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
    finer = np.unique(np.concatenate([edges, inside[apart > SETTINGS.same_time * edges[-1]]]))
    for k in range(len(problem.limits)):
        own = np.sort(points.remaining[points.limit == k])
        if own.size:
            far = np.abs(finer[1:-1, np.newaxis] - own).min(axis=1)
            near = finer[1:-1][
                far < SETTINGS.nearby * np.maximum(*map(np.diff, (finer[1:], finer[:-1])))
            ]
            points = points.joined(near, np.full(near.size, k))
    return _planned(problem, seen, finer, points)


def _planned(problem: BoundedProblem, seen: Seen, edges: Array, points: Points) -> Plan:
    """Return a plan that holds the arcs well inside their ends."""
    interiors, junctions, t_f = [], list[Array](), float(edges[-1])
    for one in seen.cells.plan.interiors:
        # What is not held any more needs cells.
        count = int((one.start - one.end) * problem.vibration_rate / SETTINGS.radians_per_cell)
        junctions.append(np.linspace(one.end, one.start, max(count, SETTINGS.junctions[1]) + 1))
        points = points.joined(junctions[-1], np.full(junctions[-1].size, one.limit))
    # What no proof is asked of, as of several machines, does without interiors.
    for arc in seen.structure.arcs if len(problem.tails) < 2 else ():
        limit, length = problem.limits[arc.limit], arc.start - arc.end
        is_high = limit.order > 2
        early, late = (
            SETTINGS.margins[is_high] * local_cell(seen.mesh, end) for end in (arc.start, arc.end)
        )
        if is_high:
            early, late = min(early, 0.25 * length), min(late, 0.25 * length)
        # Motion that grows on the arc leaves an interior no digits: points must do there. Points
        # that touch in a row may look like a short arc where the order is above 2.
        is_steady = limit.growth * length < SETTINGS.most_growth
        is_long = (
            early + late < SETTINGS.short * length and length > SETTINGS.least_arcs[is_high] * t_f
        )
        if is_steady and is_long:
            interiors.append(replace(arc, start=arc.start - early, end=arc.end + late))
            steps = np.linspace(-SETTINGS.beyond, 1.0, SETTINGS.junctions[is_high] + 1)
            junctions += [arc.start - steps * early, arc.end + steps * late]
    for new in junctions:
        inside = new[(new > 0.0) & (new < t_f)]
        apart = np.abs(edges[np.searchsorted(edges, inside) - [[1], [0]]] - inside).min(axis=0)
        edges = np.union1d(edges, inside[apart > SETTINGS.apart * abs(new[1] - new[0])])
    ends = [end for one in interiors for end in (one.start, one.end)]
    for one in interiors:
        outside = np.sort(np.concatenate([edges[edges < one.end], edges[edges > one.start]]))
        close = SETTINGS.apart * np.gradient(outside)
        edges = outside[(outside < one.end - close) | (outside > one.start + close)]
        points = points.joined(np.array([one.start, one.end]), np.full(2, one.limit))
    edges = np.unique(np.concatenate([edges, ends]))
    return Plan(edges=edges, points=points, interiors=tuple(interiors))


def finish(problem: BoundedProblem, cells: Cells, *, tolerance: float) -> Cells | None:
    """Return a control on cells with as much time as it takes to keep the bounds everywhere.

    What exceeds a bound by less than the tolerance is paid for by reach to spare: all forces are
    divided by the reach.
    """
    wanted = 1.0 + SETTINGS.spare * tolerance
    found = exchange(problem, cells.plan, tolerance=tolerance, relaxed=False, wanted=wanted)
    if found is None:
        return None
    worst = float(excess(problem, found, find_peaks(problem, found)).max(initial=0.0))
    return found if found.reach >= 1.0 + worst else None


def cell_arcs(problem: BoundedProblem, cells: Cells) -> tuple[Arc, ...]:
    """Return cells and interiors as arcs, scaled so that they reach the target once."""
    force, t_f, arcs = cells.force, cells.t_f, list[Arc]()
    begin, end, off = t_f - cells.start, t_f - cells.end, cells.interior < 0
    same = (np.abs(np.diff(force)) < SETTINGS.same_force) & off[1:] & off[:-1]
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
        control = (
            Bang(1 if share > 0.0 else -1) if abs(share) > 1.0 - SETTINGS.same_force else Interior()
        )
        force_now = share * problem.force_limit / cells.reach
        arcs.append(
            constant_arc(float(begin[i]), float(end[j - 1]), control=control, force=force_now)
        )
    return tuple(arcs)
