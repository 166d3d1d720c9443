"""The linear program on cells: the force, constant in each, that reaches farthest within bounds.

For a given t_f it asks for the largest multiple α of the target that can be reached within force
limit and bounds; α(t_f) = 1 is the optimum, since waiting at rest makes α grow with t_f. Bounds
hold at points, and wherever a motion breaks one between them, another point is put in. The
multipliers are a dual point (``proof.Measure``): what it proves says how coarse the cells are.
All times are remaining times τ = t_f - t.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.closed_form import impulse_response, step_response, transition
from mtcommission.optimal.linear_program import Basis, Program, solve_program
from mtcommission.optimal.problem import ArcInterior, BoundedProblem, describe_bounds
from mtcommission.optimal.proof import Atom, Measure, Stretch, powers_of

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

TOLERANCE = 1e-9
"""Of the simplex method, against bounds of 1."""
STEPS = 30
"""Of the simplex method, for each row and column, after which a program is given up (empirical)."""
FEWEST_CELLS, MOST_CELLS = 100, 400
"""At first: enough to see every feature, few enough for a fraction of a second (empirical)."""
RADIANS_PER_CELL = 0.8
"""Between the two, cells that resolve the fastest mode (empirical)."""
GROWTH = 0.15
"""Of cells with the distance from the ends of a long move and of its cruise (empirical)."""
NEAR = 0.02
"""Relative room below a bound within which a peak is looked at closely."""
SAMPLES, RADIANS_PER_PART = 8, 1.0
"""Of a part of a cell, among which its peaks are looked for."""
POLISHES = 4
"""Newton steps from a sample to a peak."""
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
EXCHANGES = 20
"""Rounds at most in which peaks become points and t_f is corrected."""
LEAST_TIMES = (1.6, 2.2, 3.0, 4.2, 6.0, 10.0)
"""Where the smallest possible bound is looked for, in multiples of the free optimum: it falls
with t_f until more time does not help any more."""
LEAST_CELLS = (400, 800)
"""For the smallest bound: to search its time, and to refine it for a single bound."""
LEAST_TOLERANCE = 2e-4
"""Relative change of the smallest bound, over time and cells, that counts as none."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Points:
    """Where bounds are imposed."""

    remaining: Array  # Shape (k,) [s]
    limit: Indices  # Index of the bound, shape (k,)

    def joined(self, remaining: Array, limit: Indices) -> Points:
        """Return these and others."""
        return Points(
            remaining=np.append(self.remaining, remaining), limit=np.append(self.limit, limit)
        )

    def chosen(self, which: NDArray[np.bool_]) -> Points:
        """Return some of them."""
        return Points(remaining=self.remaining[which], limit=self.limit[which])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plan:
    """Where the force is constant, where a bound is held, and where the others are imposed."""

    edges: Array  # Ascending from 0 to t_f, none inside an interior, shape (n + 1,) [s]
    points: Points
    interiors: tuple[ArcInterior, ...] = ()  # In order of time

    @property
    def t_f(self) -> float:
        """Final time [s]."""
        return float(self.edges[-1])

    def scaled(self, share: float) -> Plan:
        """Return the plan over another time, every place at the same share of it."""
        return Plan(
            edges=self.edges * share,
            points=replace(self.points, remaining=self.points.remaining * share),
            interiors=tuple(
                replace(one, start=one.start * share, end=one.end * share) for one in self.interiors
            ),
        )

    def inside(self, remaining: Array) -> Indices:
        """Return the index of the interior that holds each remaining time; -1 without one."""
        index = np.full(remaining.shape, -1)
        for i, one in enumerate(self.interiors):
            index[(one.end < remaining) & (remaining < one.start)] = i
        return index


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Segments:
    """Cells and interiors in order of time, their states as affine functions of the unknowns.

    The unknowns are the forces of the cells, the jumps off the interiors and the reach; a last
    column holds what is constant.
    """

    start: Array  # Remaining times start > end, shape (m,) [s]
    end: Array
    interior: Indices  # Index of the interior; -1 in a cell, shape (m,)
    column: Indices  # Unknown that is the cell's force, shape (m,)
    first: Array  # Where the motion starts, shape (m, n, n_unknowns + 1)
    last: Array  # Where it ends: in an interior behind the jump

    @property
    def cells(self) -> int:
        """Number of cells: their forces come first among the unknowns."""
        return int((self.interior < 0).sum())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cells:
    """The solution of a program."""

    plan: Plan
    start: Array  # Of cells and interiors in order of time, as ``Segments`` [s]
    end: Array
    interior: Indices
    force: Array  # F_set / F in each; 0 in interiors
    states: Array  # Where they start, shape (m, n)
    weights: Array  # Signed multiplier of each point, shape (k,)
    terminal: Array  # Λ, shape (n,)
    reach: float  # α
    slope: float  # dα/dt_f [1/s]
    basis: Basis  # Where a program like it may start

    @property
    def t_f(self) -> float:
        """Final time [s]."""
        return self.plan.t_f

    @property
    def acting(self) -> Points:
        """The points with a multiplier."""
        return self.plan.points.chosen(self.weights != 0.0)

    @property
    def measure(self) -> Measure:
        """The multipliers."""
        points, weights = self.acting, self.weights[self.weights != 0.0]
        atoms = zip(points.remaining.tolist(), points.limit.tolist(), weights.tolist(), strict=True)
        return Measure(
            t_f=self.t_f,
            terminal=self.terminal,
            atoms=tuple(Atom(remaining=at, limit=k, weight=weight) for at, k, weight in atoms),
            interiors=self.plan.interiors,
        )


def segments(problem: BoundedProblem, plan: Plan, *, relaxed: bool) -> Segments:
    """Return what the unknowns do to the states.

    An interior is entered on the bound and its derivatives, relaxed by any impulses of the force;
    these have the multipliers of a measure with a density on the interior.
    """
    plant, times = problem.plant, plan.edges[::-1]
    lengths = times[:-1] - times[1:]
    interior = plan.inside(0.5 * (times[:-1] + times[1:]))
    orders = [problem.limits[one.limit].order for one in plan.interiors]
    cells = int((interior < 0).sum())
    jump = cells
    width = cells + (sum(orders) if relaxed else 0) + 2
    flows, pushes = transition(plant, lengths), step_response(plant, lengths) * problem.force_limit
    column = np.where(interior < 0, np.cumsum(interior < 0) - 1, -1)
    first, last = np.zeros((2, lengths.size, plant.order, width))
    state = np.zeros((plant.order, width))
    for i, held in enumerate(interior.tolist()):
        first[i] = state
        if held < 0:
            state = flows[i] @ state
            state[:, column[i]] += pushes[i]
        else:
            one = plan.interiors[held]
            limit = problem.limits[one.limit]
            # Off the bound by rounding, the motion would leave it further and further.
            first[i] -= limit.impulses @ entry(problem, one, state)
            state = limit.boundary_flow.over(float(lengths[i])) @ first[i]
            if relaxed:
                unit = problem.force_limit / problem.rate
                state[:, jump : jump + limit.order] += limit.force_chain * unit
                jump += limit.order
        last[i] = state
    return Segments(
        start=times[:-1], end=times[1:], interior=interior, column=column, first=first, last=last
    )


def entry(problem: BoundedProblem, interior: ArcInterior, states: Array) -> Array:
    """Return what the maps of states miss of the bound held and its derivatives."""
    limit = problem.limits[interior.limit]
    missed = limit.output_chain @ states
    missed[0, -2 if limit.follows else -1] -= interior.side
    return np.asarray(missed)


def _point_rows(problem: BoundedProblem, points: Points, maps: Segments, plan: Plan) -> Array:
    """Return c x at the points over the unknowns and the constant."""
    plant = problem.plant
    index = np.searchsorted(-maps.start, -points.remaining, side="left") - 1
    since = maps.start[index] - points.remaining
    signal = problem.rows[points.limit]
    push = np.sum(step_response(plant, since) * signal, axis=1) * problem.force_limit
    moved = np.einsum("ki,kij->kj", signal, transition(plant, since))
    rows = np.empty((points.limit.size, maps.first.shape[2]))
    for i in np.unique(index).tolist():
        own, held = index == i, int(maps.interior[i])
        if held < 0:
            rows[own] = moved[own] @ maps.first[i]
            rows[own, maps.column[i]] += push[own]
            continue
        flow = problem.limits[plan.interiors[held].limit].boundary_flow
        for k in np.flatnonzero(own).tolist():
            at_end = points.remaining[k] == maps.end[i]
            state = maps.last[i] if at_end else flow.over(float(since[k])) @ maps.first[i]
            rows[k] = signal[k] @ state
    return rows


def solve_cells(
    problem: BoundedProblem, plan: Plan, *, start: Basis | None = None, relaxed: bool = True
) -> Cells | None:
    """Return the control that reaches farthest; None where the simplex method gives up.

    Points that may not act are dropped (``may_act``).
    """
    plan = replace(plan, points=plan.points.chosen(may_act(problem, plan)))
    maps = segments(problem, plan, relaxed=relaxed)
    n, size = maps.cells, maps.first.shape[2] - 2
    points, fixed, target = plan.points, problem.fixed, problem.target[problem.fixed]
    rows = _point_rows(problem, points, maps, plan)
    final = maps.last[-1, fixed].copy()
    scale = 1.0 / np.maximum(np.abs(final[:, :n]).sum(axis=1), np.abs(target))
    final[:, -2] -= target
    equal = [final * scale[:, np.newaxis]]
    held = [np.empty((0, size + 2))]
    for i in np.flatnonzero(maps.interior >= 0).tolist() if not relaxed else ():
        one = plan.interiors[maps.interior[i]]
        gain = problem.limits[one.limit].feedback / problem.force_limit
        # What is missed grows with its power of the time: over the interior it counts alike.
        radians = problem.rate * (one.start - one.end)
        growth = [max(radians, 1.0) ** j for j in range(problem.limits[one.limit].order)]
        equal.append(entry(problem, one, maps.last[i - 1]) * np.array(growth)[:, np.newaxis])
        held += [gain @ maps.first[i : i + 1], gain @ maps.last[i : i + 1]]
    # A bound that follows the reach has two rows, the others one with a floor and a ceiling.
    follows = np.array([limit.follows for limit in problem.limits])[points.limit]
    index = np.repeat(np.arange(follows.size), 1 + follows)
    sign = np.where(np.diff(index, prepend=-1) == 0, -1.0, 1.0)
    first = sum(map(len, held))
    follows = np.append(np.zeros(first, dtype=bool), follows[index])
    every = np.vstack([*held, rows[index] * sign[:, np.newaxis]])
    every[:, -2] -= follows
    equations = np.vstack(equal)
    solution = solve_program(
        Program(
            cost=np.append(np.zeros(size), -1.0),
            rows=every[:, :-1],
            rooms=np.where(follows, 0.0, 1.0) - every[:, -1],
            floors=np.where(follows, -inf, -1.0 - every[:, -1]),
            equal=equations[:, :-1],
            right=-equations[:, -1],
            lower=np.concatenate([-np.ones(n), np.full(size - n, -inf), [0.0]]),
            upper=np.append(np.ones(n), np.full(size - n + 1, inf)),
        ),
        steps=STEPS * (n + points.limit.size),
        tolerance=TOLERANCE,
        start=start,
        is_solvable=relaxed,
    )
    if solution is None:
        return None
    terminal = np.zeros(problem.plant.order)
    terminal[fixed] = solution.equal[: target.size] * scale
    # F |σ| at the start, extrapolated from its means over the first two cells.
    lengths = (maps.start - maps.end)[:2]
    early, second = np.abs(solution.bounds[:2]) / lengths
    slope = early + (early - second) * lengths[0] / sum(lengths)
    force = np.append(np.clip(solution.unknowns[:n], -1.0, 1.0), 0.0)
    weights = -solution.rows[first:] * sign
    return Cells(
        plan=plan,
        start=maps.start,
        end=maps.end,
        interior=maps.interior,
        force=force[maps.column],
        states=maps.first @ np.append(solution.unknowns, 1.0),
        weights=np.bincount(index, weights, points.limit.size).astype(np.float64),
        terminal=terminal,
        reach=float(solution.unknowns[size]),
        slope=float(max(slope, 0.5 * early)),
        basis=solution.basis,
    )


def may_act(problem: BoundedProblem, plan: Plan) -> NDArray[np.bool_]:
    """Return which points may carry an atom: off the interiors, or of a higher order inside one.

    An atom inside an interior jumps Λ by a multiple of c. With order r that leaves σ = 0 if
    c B = ... = c A^(r-1) B = 0; on others it would end the interior.
    """
    orders = np.array([limit.order for limit in problem.limits])
    held = np.array([orders[one.limit] for one in plan.interiors] + [0])
    return np.asarray(orders[plan.points.limit] > held[plan.inside(plan.points.remaining)])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Peaks:
    """Where bounded signals are largest, near their bounds or beyond."""

    remaining: Array  # [s]
    limit: Indices
    level: Array  # |c x|


def find_peaks(problem: BoundedProblem, cells: Cells) -> Peaks:
    """Return the peaks of the motion under a solution, between the ends of cells too."""
    off = cells.interior < 0
    found = [_cell_peaks(problem, cells, off)]
    for i in np.flatnonzero(~off).tolist():
        one = cells.plan.interiors[cells.interior[i]]
        found.append(_interior_peaks(problem, one, cells.states[i]))
    return Peaks(
        remaining=np.concatenate([peaks.remaining for peaks in found]),
        limit=np.concatenate([peaks.limit for peaks in found]),
        level=np.concatenate([peaks.level for peaks in found]),
    )


def _interior_peaks(problem: BoundedProblem, one: ArcInterior, entered: Array) -> Peaks:
    """Return the peaks of the other signals while one is held."""
    length, flow = one.start - one.end, problem.limits[one.limit].boundary_flow
    count = int(np.ceil(length * problem.vibration_rate * SAMPLES / RADIANS_PER_PART)) + 1
    states = powers_of(flow.over(length / count), entered, count)
    size = np.abs(states @ problem.rows.T)
    size[:, one.limit] = 0.0
    inner = size[1:-1]
    at, limit = np.nonzero((inner > 1.0 - NEAR) & (inner >= size[:-2]) & (inner >= size[2:]))
    times = np.asarray(one.start - length / count * (at + 1), dtype=np.float64)
    levels = inner[at, limit]
    for k, (index, sample) in enumerate(zip(limit.tolist(), (at + 1).tolist(), strict=True)):
        state, row = states[sample], problem.rows[index]
        for _ in range(POLISHES):
            rate = flow.matrix @ state
            slope, bend = float(row @ rate), float(row @ flow.matrix @ rate)
            step = -slope / bend if bend != 0.0 else 0.0
            if abs(step) > length / count:
                break
            state = flow.over(step) @ state
            times[k] -= step
        levels[k] = max(levels[k], abs(float(row @ state)))
    return Peaks(remaining=times, limit=limit, level=levels)


def _cell_peaks(problem: BoundedProblem, cells: Cells, off: NDArray[np.bool_]) -> Peaks:
    plant, force, begin = problem.plant, cells.force[off], cells.start[off]
    lengths = begin - cells.end[off]
    counts = np.ceil(lengths * problem.vibration_rate / RADIANS_PER_PART).astype(np.intp)
    part = np.repeat(np.arange(lengths.size), counts)
    span, push = (lengths / counts)[part], force[part] * problem.force_limit
    since = span * (np.arange(part.size) - (np.cumsum(counts) - counts)[part])
    elapsed = cells.t_f - begin[part] + since
    starts = np.einsum("pij,pj->pi", transition(plant, since), cells.states[off][part])
    starts = starts + step_response(plant, since) * push[:, np.newaxis]
    step = span / SAMPLES
    flows, pushes = transition(plant, step), step_response(plant, step) * push[:, np.newaxis]
    states = [starts]
    for _ in range(SAMPLES):
        states.append(np.einsum("pij,pj->pi", flows, states[-1]) + pushes)
    levels = np.stack(states, axis=1) @ problem.rows.T
    along = np.vstack([levels[:, :-1].reshape(-1, len(problem.limits)), levels[-1, -1:]])
    size = np.pad(np.abs(along), ((1, 1), (0, 0)))
    inner = size[1:-1]
    at, limit = np.nonzero((inner > 1.0 - NEAR) & (inner >= size[:-2]) & (inner >= size[2:]))
    here = np.minimum(at // SAMPLES, part.size - 1)
    rows = problem.rows[limit] * np.sign(along[at, limit])[:, np.newaxis]
    # A peak at the start of a part may lie in the part before.
    places, heights = _tops(problem, starts, push, span, here, step[here] * (at % SAMPLES), rows)
    back = np.maximum(here - 1, 0)
    others, beyond = _tops(problem, starts, push, span, back, span[back], rows)
    takes = (at % SAMPLES == 0) & (beyond > heights)
    t = np.where(takes, elapsed[back] + others, elapsed[here] + places)
    return Peaks(
        remaining=np.maximum(cells.t_f - t, 0.0),
        limit=limit,
        level=np.where(takes, beyond, heights),
    )


def _tops(
    problem: BoundedProblem,
    starts: Array,
    push: Array,
    span: Array,
    part: Indices,
    since: Array,
    rows: Array,
) -> tuple[Array, Array]:
    """Return places since the starts of parts and heights of peaks, by Newton's method inside."""
    plant, starts, push, span = problem.plant, starts[part], push[part, np.newaxis], span[part]
    place, best = since, np.full(since.shape, -inf)
    for _ in range(POLISHES + 1):
        states = _inside(problem, starts, push, place)
        level = np.sum(states * rows, axis=1)
        since, best = np.where(level > best, place, since), np.maximum(level, best)
        rates = states @ plant.A.T + plant.B * push
        slope, bend = np.sum(rates * rows, axis=1), np.sum(rates @ plant.A.T * rows, axis=1)
        step = np.divide(-slope, bend, out=np.sign(slope) * span, where=bend < 0.0)
        place = np.clip(place + step, 0.0, span)
    return since, best


def _inside(problem: BoundedProblem, starts: Array, push: Array, since: Array) -> Array:
    moved = np.einsum("pij,pj->pi", transition(problem.plant, since), starts)
    return np.asarray(moved + step_response(problem.plant, since) * push)


def excess(problem: BoundedProblem, cells: Cells, peaks: Peaks) -> Array:
    """Return by what share of its bound each peak exceeds it."""
    follows = np.array([limit.follows for limit in problem.limits])[peaks.limit]
    return np.asarray(peaks.level / np.where(follows, cells.reach, 1.0) - 1.0)


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


def first_edges(problem: BoundedProblem, t_f: float, *, radians: float) -> Array:
    """Return even edges; of a long move close together at its ends and those of its cruise."""
    cell = radians / problem.vibration_rate
    if t_f / cell < MOST_CELLS:
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

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.optimal.problem import bounded_problem
    >>> from mtcommission.optimal.solution import Bound
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = read_shipped("milling-manipulator").machine
    >>> problem = bounded_problem(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     bounds=(Bound(name="v_phi", value=0.005),), horizon=0.05)
    >>> round(first_cells(problem, t_free=0.0435).t_f, 3)
    0.052
    """
    t_f, slower = 1.05 * t_free, None
    found = _evenly(problem, t_f)
    faster, missing, spare, was_slow = found, 1.0, 1.0, False
    for _ in range(TIME_STEPS):
        # Where the reach hardly grows, as near the smallest possible bound, α alone says little.
        steepness = float(np.clip(found.slope * t_f, *STEEPNESS))
        if abs(found.reach - 1.0) < TIME_TOLERANCE * steepness:
            return found
        if found.reach < 1.0:
            before, faster, missing = faster, found, 1.0 - found.reach
            is_still = found.reach - before.reach < STANDSTILL * found.reach
            if found.t_f > HORIZON * t_free or (found.t_f > LONGER * before.t_f and is_still):
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


def _evenly(problem: BoundedProblem, t_f: float, *, near: Cells | None = None) -> Cells:
    edges = first_edges(problem, t_f, radians=RADIANS_PER_CELL)
    start = near.basis if near is not None and near.force.size == edges.size - 1 else None
    found = solve_cells(problem, Plan(edges=edges, points=_at_ends(problem, edges)), start=start)
    if found is None:
        detail = Message("grid-program-unfinished", cells=edges.size - 1, t_f=t_f)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return found


def _at_ends(problem: BoundedProblem, edges: Array) -> Points:
    count = len(problem.limits)
    return Points(
        remaining=np.tile(edges[:-1], count),
        limit=np.repeat(np.arange(count), edges.size - 1),
    )


def _out_of_reach(problem: BoundedProblem, longest: Cells, t_free: float) -> ComputationError:
    named = describe_bounds(problem.plant, problem.bounds)
    if longest.t_f > HORIZON * t_free:
        return beyond_time(problem, longest)
    least = smallest_factor(problem, t_free=t_free)
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
    """Return the factor of all bounds below which the target is out of reach by a given time.

    Examples
    --------
    The bound that the paper's sec. 5.2 asks for needs 52.3 ms:

    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.optimal.problem import bounded_problem
    >>> from mtcommission.optimal.solution import Bound
    >>> from mtcommission.plant.plant import build_plant
    >>> machine = read_shipped("milling-manipulator").machine
    >>> problem = bounded_problem(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     bounds=(Bound(name="v_phi", value=0.005),), horizon=0.05)
    >>> [round(smallest_factor_by(problem, t_f), 2) for t_f in (0.0522923, 0.048)]
    [1.0, 1.63]
    """
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
    plan = Plan(edges=edges, points=_at_ends(problem, edges))
    maps = segments(problem, plan, relaxed=True)
    rows = _point_rows(problem, plan.points, maps, plan)[:, :-2]
    final, target = maps.last[-1, problem.fixed, :-2], problem.target[problem.fixed]
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


def steepness(problem: BoundedProblem, parts: tuple[Stretch, ...], zeros: Array) -> Array:
    """Return F |σ'| at the zeros of σ."""
    ordered = parts[::-1]
    ends = np.array([part.end for part in ordered])
    index = np.searchsorted(ends, zeros, side="right") - 1
    adjoints = np.array([part.adjoint for part in ordered])[index]
    motion = impulse_response(problem.plant, zeros - ends[index])
    return np.asarray(problem.force_limit * np.abs(np.sum(adjoints @ problem.plant.A * motion, 1)))
