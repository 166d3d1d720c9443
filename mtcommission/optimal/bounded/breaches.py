"""Where the motion on a mesh exceeds bounds or force limit, between the points of its program."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.arcs import Piece, piece_states
from mtcommission.optimal.bounded.mesh import MeshOptimum
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.rows import FORCE, Contact, Segment
from mtcommission.optimal.closed_form import step_response, transition

Array = NDArray[np.float64]

BROKEN = 1e-6
"""Relative excess over a bound that calls for another point of the program; what is left is
covered by a margin."""
RADIANS_PER_SAMPLE = 0.2
"""Samples of a core among which peaks of signals are looked for."""
NEAR_PEAK = 0.05
"""Relative room below a bound within which a peak between two such samples is looked at closely."""
FINER = 16
"""Samples on each side of such a peak."""
SAMPLES = 13
"""Samples of a part of a cell among which its largest excess is looked for."""
RADIANS_PER_PART = 2.4
"""Longest part of a cell, in the period of the fastest mode."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Breach:
    """A place where a motion exceeds a bound.

    Parameters
    ----------
    contact
        The place.
    excess
        Relative excess.
    """

    contact: Contact
    excess: float


def breaches(problem: BoundedProblem, found: MeshOptimum, *, tolerance: float) -> list[Breach]:
    """Return where the motion of a mesh solution exceeds a bound by a relative tolerance."""
    cells = [segment for segment in found.segments if segment.limit < 0]
    part, since, step = _parts(problem, cells)
    places, peaks = _peaks(np.abs(_levels(problem, found, cells, part, since, step)))
    rows, limits = np.nonzero(peaks > 1.0 - NEAR_PEAK)
    # A vertex among samples so far apart is off by 1e-6: looked at once more from close by.
    first = np.clip(places[rows, limits] - 1.0, 0.0, SAMPLES - 3.0)
    part, since, step = (
        part[rows],
        since[rows] + first * step[rows],
        2.0 * step[rows] / (SAMPLES - 1),
    )
    close = _levels(problem, found, cells, part, since, step)
    levels = np.take_along_axis(close, limits[:, np.newaxis, np.newaxis], axis=2)
    places, peaks = _peaks(np.abs(levels))
    over = []
    for i in np.nonzero(peaks[:, 0] > 1.0 + tolerance)[0].tolist():
        cell, place = cells[part[i]], float(places[i, 0])
        at = Contact(
            remaining=max(float(cell.start - since[i] - place * step[i]), cell.end),
            limit=int(limits[i]),
            side=int(np.sign(levels[i, round(place), 0])),
        )
        over.append(Breach(contact=at, excess=float(peaks[i, 0]) - 1.0))
    return over + breaches_in_cores(problem, found, tolerance=tolerance)


def _parts(problem: BoundedProblem, cells: list[Segment]) -> tuple[NDArray[np.intp], Array, Array]:
    """Return the cell of each part, when it starts since that of the cell, and between its samples.

    Each of shape (n_parts,), times in s.
    """
    lengths = np.array([cell.start - cell.end for cell in cells])
    counts = np.ceil(lengths * problem.vibration_rate / RADIANS_PER_PART).astype(np.intp)
    part = np.repeat(np.arange(len(cells)), counts)
    span = (lengths / counts)[part]
    since = span * (np.arange(part.size) - (np.cumsum(counts) - counts)[part])
    return part, since, span / (SAMPLES - 1)


def _levels(
    problem: BoundedProblem,
    found: MeshOptimum,
    cells: list[Segment],
    part: NDArray[np.intp],
    since: Array,
    step: Array,
) -> Array:
    """Return samples of all c x in parts of cells, shape (n_parts, SAMPLES, n_limits)."""
    plant = problem.plant
    starts = np.array([found.state(cell.first) for cell in cells])[part]
    force = found.unknowns[[cell.column for cell in cells]][part, np.newaxis] * problem.force_limit
    flow, push = transition(plant, step), step_response(plant, step) * force
    state = np.einsum("pij,pj->pi", transition(plant, since), starts)
    state += step_response(plant, since) * force
    states = [state]
    for _ in range(SAMPLES - 1):
        states.append(np.einsum("pij,pj->pi", flow, states[-1]) + push)
    return np.stack(states, axis=1) @ problem.rows.T


def breaches_in_cores(
    problem: BoundedProblem, found: MeshOptimum, *, tolerance: float
) -> list[Breach]:
    """Return where the motion in a core exceeds a bound other than the one held there.

    Parameters
    ----------
    problem
        The bounded problem.
    found
        Solution of the kept form.
    tolerance
        Relative excess from which on it counts.

    Returns
    -------
    list of Breach
    """
    over: list[Breach] = []
    for core in (segment for segment in found.segments if segment.limit >= 0):
        rows = problem.rows.copy()
        rows[core.limit] = 0.0
        over += _above(problem, found, core, rows, tolerance=tolerance)
    return over


def overloads(problem: BoundedProblem, found: MeshOptimum, *, tolerance: float) -> list[Breach]:
    """Return where boundary control inside a core takes more than the force limit.

    Parameters
    ----------
    problem
        The bounded problem.
    found
        Solution of the kept form.
    tolerance
        Relative excess from which on it counts.

    Returns
    -------
    list of Breach
    """
    over: list[Breach] = []
    for core in (segment for segment in found.segments if segment.limit >= 0):
        force = problem.limits[core.limit].feedback[np.newaxis] / problem.force_limit
        over += [
            replace(breach, contact=replace(breach.contact, limit=FORCE))
            for breach in _above(problem, found, core, force, tolerance=tolerance)
        ]
    return over


def _above(
    problem: BoundedProblem, found: MeshOptimum, core: Segment, rows: Array, *, tolerance: float
) -> list[Breach]:
    """Return the peaks of signals along a core, its ends among them, that exceed 1."""
    tau, states = core_states(problem, found, core)
    size = np.abs(states @ rows.T)
    beside = np.pad(size, ((1, 1), (0, 0)))
    peaks = (size > 1.0 - NEAR_PEAK) & (size >= beside[:-2]) & (size > beside[2:])
    piece = Piece(limit=core.limit, side=0, duration=float(tau[-1]))
    over = []
    for at, k in zip(*np.nonzero(peaks), strict=True):
        first, last = max(int(at) - 1, 0), min(int(at) + 1, tau.size - 1)
        finer = np.linspace(0.0, tau[last] - tau[first], 2 * FINER + 1)
        levels = piece_states(problem, piece, states[first], finer) @ rows[k]
        places, heights = _peaks(np.abs(levels)[np.newaxis, :, np.newaxis])
        if heights[0, 0] > 1.0 + tolerance:
            remaining = core.start - tau[first] - places[0, 0] * finer[1]
            side = int(np.sign(levels[round(places[0, 0])]))
            contact = Contact(remaining=float(remaining), limit=int(k), side=side)
            over.append(Breach(contact=contact, excess=float(heights[0, 0]) - 1.0))
    return over


def core_states(problem: BoundedProblem, found: MeshOptimum, core: Segment) -> tuple[Array, Array]:
    """Return times since the start of a core [s] and the states there, shapes (k,) and (k, n)."""
    count = int(np.ceil((core.start - core.end) * problem.rate / RADIANS_PER_SAMPLE)) + 4
    tau = np.linspace(0.0, core.start - core.end, count)
    piece = Piece(limit=core.limit, side=0, duration=float(tau[-1]))
    return tau, piece_states(problem, piece, found.state(core.first), tau)


def untenable(problem: BoundedProblem, found: MeshOptimum) -> list[tuple[float, float]]:
    """Return where a core cannot hold its bound.

    There the boundary control takes more than the force limit, or the motion exceeds another bound
    on which no point may act (``bounded_rows.off_cores``).

    Parameters
    ----------
    problem
        The bounded problem.
    found
        Solution of the kept form.

    Returns
    -------
    list of (float, float)
        Remaining times, later end first [s].
    """
    zones = []
    orders = np.array([limit.order for limit in problem.limits])
    for core in (segment for segment in found.segments if segment.limit >= 0):
        tau, states = core_states(problem, found, core)
        held = problem.limits[core.limit]
        levels = np.abs(states @ problem.rows.T)
        levels[:, (orders > held.order) | (np.arange(orders.size) == core.limit)] = 0.0
        force = np.abs(states @ held.feedback) / problem.force_limit
        over = np.maximum(levels.max(axis=1), force) > 1.0 + BROKEN
        edges = np.nonzero(np.diff(np.concatenate([[0], over, [0]])))[0]
        for first, stop in zip(edges[::2], edges[1::2], strict=True):
            ends = tau[[max(first - 1, 0), min(stop, tau.size - 1)]]
            zones.append((float(core.start - ends[1]), float(core.start - ends[0])))
    return zones


def _peaks(levels: Array) -> tuple[Array, Array]:
    """Return places, in samples, and heights of the vertices beside the largest samples.

    The vertex of a parabola: a peak between two samples may exceed what both of them keep.
    """
    at = np.clip(levels.argmax(axis=1), 1, levels.shape[1] - 2)
    before, here, after = (
        np.take_along_axis(levels, (at + k)[:, np.newaxis], axis=1)[:, 0] for k in (-1, 0, 1)
    )
    bend = before - 2.0 * here + after
    edge = np.sign(after - before)
    vertex = np.divide(0.5 * (before - after), bend, out=edge.copy(), where=bend < 0.0)
    offset = np.clip(vertex, -1.0, 1.0)
    return at + offset, here + 0.5 * offset * (after - before) + 0.5 * offset**2 * bend
