"""Where a motion on cells comes nearest to its bounds, between the ends of cells too."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.closed_form import advance, step_response
from mtcommission.optimal.exponential import powers_of
from mtcommission.optimal.free_motion import free_gains, free_moments, free_peaks, free_rates
from mtcommission.optimal.problem import ArcInterior, BoundedProblem
from mtcommission.optimal.program import Cells, Indices, follows_reach

Array = NDArray[np.float64]
NEAR = 0.02
"""Relative room below a bound within which a peak is looked at closely."""
SAMPLES, RADIANS_PER_PART = 8, 1.0
"""Of a part of a cell, among which its peaks are looked for."""
POLISHES = 4
"""Newton steps from a sample to a peak."""


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
    """Return the peaks of the free motions after the end."""
    plant = problem.plant
    weights = free_gains(plant, problem.tails) * free_moments(plant, cells.final)
    rates = np.broadcast_to(free_rates(plant), weights.shape)
    tail, s, level = free_peaks(rates, weights, offset=cells.offset)
    return Peaks(remaining=-s, limit=len(problem.limits) + tail, level=level)


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
    force, begin = cells.force[off], cells.start[off]
    lengths = begin - cells.end[off]
    counts = np.ceil(lengths * problem.vibration_rate / RADIANS_PER_PART).astype(np.intp)
    part = np.repeat(np.arange(lengths.size), counts)
    span, push = (lengths / counts)[part], force[part] * problem.force_limit
    since = span * (np.arange(part.size) - (np.cumsum(counts) - counts)[part])
    elapsed = cells.t_f - begin[part] + since
    starts = _inside(problem, cells.states[off][part], push[:, np.newaxis], since)
    step = span / SAMPLES
    levels = np.stack(
        [
            _inside(problem, starts, push[:, np.newaxis], k * step) @ problem.rows.T
            for k in range(SAMPLES + 1)
        ],
        axis=1,
    )
    along = np.vstack([levels[:, :-1].reshape(-1, len(problem.limits)), levels[-1, -1:]])
    size = np.pad(np.abs(along), ((1, 1), (0, 0)))
    inner = size[1:-1]
    at, limit = np.nonzero((inner > 1.0 - NEAR) & (inner >= size[:-2]) & (inner >= size[2:]))
    here = np.minimum(at // SAMPLES, part.size - 1)
    rows = problem.rows[limit] * np.sign(along[at, limit])[:, np.newaxis]
    places, heights = _tops(problem, starts, push, span, here, step[here] * (at % SAMPLES), rows)
    t = elapsed[here] + places
    # A peak at the start of a part may lie in the part before.
    first = np.flatnonzero(at % SAMPLES == 0)
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
    moved = advance(problem.plant, starts, since)
    return np.asarray(moved + step_response(problem.plant, since) * push)


def excess(problem: BoundedProblem, cells: Cells, peaks: Peaks) -> Array:
    """Return by what share of its bound each peak exceeds it."""
    follows = follows_reach(problem, peaks.limit)
    return np.asarray(peaks.level / np.where(follows, cells.reach, 1.0) - 1.0)
