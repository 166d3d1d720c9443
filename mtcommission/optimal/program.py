"""The linear program on cells: the force, constant in each, that reaches farthest within bounds.

For a given t_f it asks for the largest multiple α of the target that can be reached within force
limit and bounds; α(t_f) = 1 is the optimum, since waiting at rest makes α grow with t_f. Bounds
hold at points, and wherever a motion breaks one between them, another point is put in. The
multipliers are a dual point (``proof.Measure``): what it proves says how coarse the cells are.
All times are remaining times τ = t_f - t.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.control import powers_of
from mtcommission.optimal.linear_program import Basis, Program, solve_program
from mtcommission.optimal.modes import (
    driven,
    free_peaks,
    free_waves,
    in_moments,
    rows_after,
    step_response,
    transition,
)
from mtcommission.optimal.problem import ArcInterior, Atom, BoundedProblem
from mtcommission.optimal.proof import Measure
from mtcommission.optimal.settings import SETTINGS

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Points:
    """Where bounds are imposed; those of the free motion after t_f at negative remaining times."""

    remaining: Array  # Shape (k,) [s]
    limit: Indices  # Index of the bound, shape (k,); of the tail, behind those of all limits

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
            points=replace(
                self.points,
                remaining=self.points.remaining * np.where(self.points.remaining > 0.0, share, 1.0),
            ),
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

    The unknowns are the forces of the cells, the jumps off the interiors, the offset of the
    reference over the band, and the reach; a last column holds what is constant.
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
    final: Array  # State at the end, shape (n,)
    offset: float  # y
    weights: Array  # Signed multiplier of each point, shape (k,)
    limits: int  # How many bounds there are before the end
    terminal: Array  # Λ, shape (n,)
    spent: float  # What a band is worth
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
            atoms=tuple(
                Atom(remaining=at, limit=k, weight=weight)
                for at, k, weight in atoms
                if k < self.limits
            ),
            interiors=self.plan.interiors,
            spent=self.spent,
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
    width = cells + (sum(orders) if relaxed else 0) + 3
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


def point_rows(problem: BoundedProblem, points: Points, maps: Segments, plan: Plan) -> Array:
    """Return c x at the points over the unknowns and the constant."""
    plant, rows = problem.plant, np.empty((points.limit.size, maps.first.shape[2]))
    after = points.limit >= len(problem.limits)
    signal = problem.tails[points.limit[after] - len(problem.limits)]
    rows[after] = rows_after(plant, signal, -points.remaining[after]) @ maps.last[-1]
    rows[after, -3] -= 1.0
    rows[~after] = _limit_rows(problem, points.chosen(~after), maps, plan)
    return rows


def _limit_rows(problem: BoundedProblem, points: Points, maps: Segments, plan: Plan) -> Array:
    plant = problem.plant
    index = np.searchsorted(-maps.start, -points.remaining, side="left") - 1
    since = maps.start[index] - points.remaining
    signal = problem.rows[points.limit]
    push = np.sum(step_response(plant, since) * signal, axis=1) * problem.force_limit
    moved = rows_after(plant, signal, since)
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
    points, goal = plan.points, problem.ends @ problem.target
    rows = point_rows(problem, points, maps, plan)
    final = problem.ends @ maps.last[-1]
    scale = 1.0 / np.maximum(np.abs(final[:, :n]).sum(axis=1), np.abs(goal))
    final[:, -3] += problem.offsets
    final[:, -2] -= goal
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
    follows = follows_reach(problem, points.limit)
    index = np.repeat(np.arange(follows.size), 1 + follows)
    sign = np.where(np.diff(index, prepend=-1) == 0, -1.0, 1.0)
    first = sum(map(len, held))
    follows = np.append(np.zeros(first, dtype=bool), follows[index])
    every = np.vstack([*held, rows[index] * sign[:, np.newaxis]])
    every[:, -2] -= follows
    equations = np.vstack(equal)
    beside = SETTINGS.largest_offset if len(problem.tails) else 0.0
    solution = solve_program(
        Program(
            cost=np.append(np.zeros(size), -1.0),
            rows=every[:, :-1],
            rooms=np.where(follows, 0.0, 1.0) - every[:, -1],
            floors=np.where(follows, -inf, -1.0 - every[:, -1]),
            equal=equations[:, :-1],
            right=-equations[:, -1],
            lower=np.concatenate([-np.ones(n), np.full(size - n - 1, -inf), [-beside, 0.0]]),
            upper=np.concatenate([np.ones(n), np.full(size - n - 1, inf), [beside, inf]]),
        ),
        steps=SETTINGS.steps * (n + points.limit.size),
        tolerance=SETTINGS.tolerance,
        start=start,
        is_solvable=relaxed,
    )
    if solution is None:
        return None
    # F |σ| at the start, extrapolated from its means over the first two cells.
    lengths = (maps.start - maps.end)[:2]
    early, second = np.abs(solution.bounds[:2]) / lengths
    slope = early + (early - second) * lengths[0] / sum(lengths)
    force = np.append(np.clip(solution.unknowns[:n], -1.0, 1.0), 0.0)
    signed = -solution.rows[first:] * sign
    weights = np.bincount(index, signed, points.limit.size).astype(np.float64)
    # Bounds after the end are worth what they allow, and the adjoint starts behind them.
    after, prices = points.limit >= len(problem.limits), solution.equal[: goal.size] * scale
    tail = problem.tails[points.limit[after] - len(problem.limits)]
    freed = rows_after(problem.plant, tail, -points.remaining[after])
    unbalanced = float(prices @ problem.offsets + weights[after].sum())
    unknowns = np.append(solution.unknowns, 1.0)
    return Cells(
        plan=plan,
        start=maps.start,
        end=maps.end,
        interior=maps.interior,
        force=force[maps.column],
        states=maps.first @ unknowns,
        final=maps.last[-1] @ unknowns,
        offset=float(solution.unknowns[size - 1]),
        weights=weights,
        limits=len(problem.limits),
        terminal=prices @ problem.ends - weights[after] @ freed,
        spent=float(np.abs(weights[after]).sum()) + abs(unbalanced),
        reach=float(solution.unknowns[size]),
        slope=float(max(slope, 0.5 * early)),
        basis=solution.basis,
    )


def may_act(problem: BoundedProblem, plan: Plan) -> NDArray[np.bool_]:
    """Return which points may carry an atom: off the interiors, or of a higher order inside one.

    An atom inside an interior jumps Λ by a multiple of c. With order r that leaves σ = 0 if
    c B = ... = c A^(r-1) B = 0; on others it would end the interior.
    """
    orders = np.append(problem.orders, np.ones(len(problem.tails), dtype=np.intp))
    held = np.array([orders[one.limit] for one in plan.interiors] + [0])
    return np.asarray(orders[plan.points.limit] > held[plan.inside(plan.points.remaining)])


def follows_reach(problem: BoundedProblem, limit: Indices) -> NDArray[np.bool_]:
    """Return which bounds, or tails, are scaled with the reach."""
    every = [*(limit.follows for limit in problem.limits), *(False for _ in problem.tails)]
    return np.array(every, dtype=np.bool_)[limit]


def at_ends(problem: BoundedProblem, edges: Array) -> Points:
    """Return all bounds at the ends of all cells, which ``edges`` [s] part."""
    count = len(problem.limits)
    return Points(
        remaining=np.tile(edges[:-1], count),
        limit=np.repeat(np.arange(count), edges.size - 1),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Peaks:
    """Where bounded signals are largest, near their bounds or beyond."""

    remaining: Array  # [s]
    limit: Indices
    level: Array  # |c x|


def find_peaks(problem: BoundedProblem, cells: Cells) -> Peaks:
    """Return the peaks of the motion under a solution, between the ends of cells too."""
    off = cells.interior < 0
    found = [_cell_peaks(problem, cells, off)] if problem.limits else []
    for i in np.flatnonzero(~off).tolist():
        one = cells.plan.interiors[cells.interior[i]]
        found.append(_interior_peaks(problem, one, cells.states[i]))
    if len(problem.tails):
        found.append(_tail_peaks(problem, cells))
    return Peaks(
        remaining=np.concatenate([peaks.remaining for peaks in found]),
        limit=np.concatenate([peaks.limit for peaks in found]),
        level=np.concatenate([peaks.level for peaks in found]),
    )


def _tail_peaks(problem: BoundedProblem, cells: Cells) -> Peaks:
    plant = problem.plant
    weights = free_waves(plant, problem.tails, cells.final)
    rates = np.broadcast_to(in_moments(plant).functions.rates, weights.shape)
    tail, s, level = free_peaks(rates, weights, offset=cells.offset)
    return Peaks(remaining=-s, limit=len(problem.limits) + tail, level=level)


def _interior_peaks(problem: BoundedProblem, one: ArcInterior, entered: Array) -> Peaks:
    """Return the peaks of the other signals while one is held."""
    length, flow = one.start - one.end, problem.limits[one.limit].boundary_flow
    count = (
        int(np.ceil(length * problem.vibration_rate * SETTINGS.samples / SETTINGS.radians_per_part))
        + 1
    )
    states = powers_of(flow.over(length / count), entered, count)
    size = np.abs(states @ problem.rows.T)
    size[:, one.limit] = 0.0
    inner = size[1:-1]
    at, limit = np.nonzero(
        (inner > 1.0 - SETTINGS.near) & (inner >= size[:-2]) & (inner >= size[2:])
    )
    times = np.asarray(one.start - length / count * (at + 1), dtype=np.float64)
    levels = inner[at, limit]
    for k, (index, sample) in enumerate(zip(limit.tolist(), (at + 1).tolist(), strict=True)):
        state, row = states[sample], problem.rows[index]
        for _ in range(SETTINGS.polishes):
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
    force, begin = cells.force[off], cells.start[off]
    lengths = begin - cells.end[off]
    counts = 1 + (lengths * problem.vibration_rate / SETTINGS.radians_per_part).astype(np.intp)
    part = np.repeat(np.arange(lengths.size), counts)
    span, push = (lengths / counts)[part], force[part] * problem.force_limit
    since = span * (np.arange(part.size) - (np.cumsum(counts) - counts)[part])
    elapsed = cells.t_f - begin[part] + since
    starts = driven(problem.plant, cells.states[off][part], push, since)
    step = span / SETTINGS.samples
    levels = np.stack(
        [
            driven(problem.plant, starts, push, k * step) @ problem.rows.T
            for k in range(SETTINGS.samples + 1)
        ],
        axis=1,
    )
    along = np.vstack([levels[:, :-1].reshape(-1, len(problem.limits)), levels[-1, -1:]])
    size = np.pad(np.abs(along), ((1, 1), (0, 0)))
    inner = size[1:-1]
    at, limit = np.nonzero(
        (inner > 1.0 - SETTINGS.near) & (inner >= size[:-2]) & (inner >= size[2:])
    )
    here = np.minimum(at // SETTINGS.samples, part.size - 1)
    rows = problem.rows[limit] * np.sign(along[at, limit])[:, np.newaxis]
    places, heights = _tops(
        problem, starts, push, span, here, step[here] * (at % SETTINGS.samples), rows
    )
    t = elapsed[here] + places
    # A peak at the start of a part may lie in the part before.
    first = np.flatnonzero(at % SETTINGS.samples == 0)
    back = np.maximum(here[first] - 1, 0)
    others, beyond = _tops(problem, starts, push, span, back, span[back], rows[first])
    higher = beyond > heights[first]
    t[first] = np.where(higher, elapsed[back] + others, t[first])
    heights[first] = np.maximum(beyond, heights[first])
    return Peaks(remaining=np.maximum(cells.t_f - t, 0.0), limit=limit, level=heights)


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
    plant, starts, push, span = problem.plant, starts[part], push[part], span[part]
    place, best = since, np.full(since.shape, -inf)
    for _ in range(SETTINGS.polishes + 1):
        states = driven(plant, starts, push, place)
        level = np.sum(states * rows, axis=1)
        since, best = np.where(level > best, place, since), np.maximum(level, best)
        rates = states @ plant.A.T + np.multiply.outer(push, plant.B)
        slope, bend = np.sum(rates * rows, axis=1), np.sum(rates @ plant.A.T * rows, axis=1)
        step = np.divide(-slope, bend, out=np.sign(slope) * span, where=bend < 0.0)
        place = np.clip(place + step, 0.0, span)
    return since, best


def excess(problem: BoundedProblem, cells: Cells, peaks: Peaks) -> Array:
    """Return by what share of its bound each peak exceeds it."""
    follows = follows_reach(problem, peaks.limit)
    return np.asarray(peaks.level / np.where(follows, cells.reach, 1.0) - 1.0)
