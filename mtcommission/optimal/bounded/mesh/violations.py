"""Where the motion on a mesh exceeds bounds or force limit, between the points of its program."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.mesh.forms import MeshOptimum
from mtcommission.optimal.bounded.mesh.rows import Segment
from mtcommission.optimal.bounded.places import FORCE, ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.structure.sequence import Piece, piece_states
from mtcommission.optimal.closed_form import step_response, transition

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Violation:
    """A place where a motion exceeds a bound."""

    point: ConstraintPoint  # The place
    excess: float  # Relative excess


def violations(problem: BoundedProblem, found: MeshOptimum, *, tolerance: float) -> list[Violation]:
    """Return where the motion of a mesh solution exceeds a bound by a relative tolerance."""
    settings = problem.settings.mesh
    cells = [segment for segment in found.segments if segment.limit < 0]
    part, since, step = _parts(problem, cells)
    places, peaks = _peaks(np.abs(_levels(problem, found, cells, part, since, step)))
    rows, limits = np.nonzero(peaks > 1.0 - settings.near_peak)
    # A vertex among samples so far apart is off by 1e-6: looked at once more from close by.
    first = np.clip(places[rows, limits] - 1.0, 0.0, settings.part_samples - 3.0)
    part, since = part[rows], since[rows] + first * step[rows]
    step = 2.0 * step[rows] / (settings.part_samples - 1)
    close = _levels(problem, found, cells, part, since, step)
    levels = np.take_along_axis(close, limits[:, np.newaxis, np.newaxis], axis=2)
    places, peaks = _peaks(np.abs(levels))
    over = []
    for i in np.nonzero(peaks[:, 0] > 1.0 + tolerance)[0].tolist():
        cell, place = cells[part[i]], float(places[i, 0])
        at = ConstraintPoint(
            remaining=max(float(cell.start - since[i] - place * step[i]), cell.end),
            limit=int(limits[i]),
            side=int(np.sign(levels[i, round(place), 0])),
        )
        over.append(Violation(point=at, excess=float(peaks[i, 0]) - 1.0))
    return over + violations_in_interiors(problem, found, tolerance=tolerance)


def _parts(problem: BoundedProblem, cells: list[Segment]) -> tuple[NDArray[np.intp], Array, Array]:
    """Return the cell of each part, when it starts since that of the cell, and between its samples.

    Each of shape (n_parts,), times in s.
    """
    settings = problem.settings.mesh
    lengths = np.array([cell.start - cell.end for cell in cells])
    counts = np.ceil(lengths * problem.vibration_rate / settings.radians_per_part).astype(np.intp)
    part = np.repeat(np.arange(len(cells)), counts)
    span = (lengths / counts)[part]
    since = span * (np.arange(part.size) - (np.cumsum(counts) - counts)[part])
    return part, since, span / (settings.part_samples - 1)


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
    starts = np.array([cell.first for cell in cells])[part]
    force = found.unknowns[[cell.column for cell in cells]][part, np.newaxis] * problem.force_limit
    flow, push = transition(plant, step), step_response(plant, step) * force
    state = np.einsum("pij,pj->pi", transition(plant, since), starts)
    state += step_response(plant, since) * force
    states = [state]
    for _ in range(problem.settings.mesh.part_samples - 1):
        states.append(np.einsum("pij,pj->pi", flow, states[-1]) + push)
    return np.stack(states, axis=1) @ problem.rows.T


def violations_in_interiors(
    problem: BoundedProblem, found: MeshOptimum, *, tolerance: float
) -> list[Violation]:
    """Return where the motion in an interior exceeds a bound other than the one held there."""
    over: list[Violation] = []
    for interior in (segment for segment in found.segments if segment.limit >= 0):
        rows = problem.rows.copy()
        rows[interior.limit] = 0.0
        over += _above(problem, found, interior, rows, tolerance=tolerance)
    return over


def saturations(
    problem: BoundedProblem, found: MeshOptimum, *, tolerance: float
) -> list[Violation]:
    """Return where boundary control inside an interior takes more than the force limit."""
    over: list[Violation] = []
    for interior in (segment for segment in found.segments if segment.limit >= 0):
        force = problem.limits[interior.limit].feedback[np.newaxis] / problem.force_limit
        over += [
            replace(violation, point=replace(violation.point, limit=FORCE))
            for violation in _above(problem, found, interior, force, tolerance=tolerance)
        ]
    return over


def _above(
    problem: BoundedProblem, found: MeshOptimum, interior: Segment, rows: Array, *, tolerance: float
) -> list[Violation]:
    """Return the peaks of signals along an interior, its ends among them, that exceed 1."""
    settings = problem.settings.mesh
    tau, states = interior_states(problem, found, interior)
    size = np.abs(states @ rows.T)
    beside = np.pad(size, ((1, 1), (0, 0)))
    peaks = (size > 1.0 - settings.near_peak) & (size >= beside[:-2]) & (size > beside[2:])
    piece = Piece(limit=interior.limit, side=0, duration=float(tau[-1]))
    over = []
    for at, k in zip(*np.nonzero(peaks), strict=True):
        first, last = max(int(at) - 1, 0), min(int(at) + 1, tau.size - 1)
        finer = np.linspace(0.0, tau[last] - tau[first], 2 * settings.finer_samples + 1)
        levels = piece_states(problem, piece, states[first], finer) @ rows[k]
        places, heights = _peaks(np.abs(levels)[np.newaxis, :, np.newaxis])
        if heights[0, 0] > 1.0 + tolerance:
            remaining = interior.start - tau[first] - places[0, 0] * finer[1]
            side = int(np.sign(levels[round(places[0, 0])]))
            point = ConstraintPoint(remaining=float(remaining), limit=int(k), side=side)
            over.append(Violation(point=point, excess=float(heights[0, 0]) - 1.0))
    return over


def interior_states(
    problem: BoundedProblem, found: MeshOptimum, interior: Segment
) -> tuple[Array, Array]:
    """Return times since the start of an interior [s] and states, shapes (k,) and (k, n)."""
    length, step = interior.start - interior.end, problem.settings.mesh.radians_per_sample
    count = int(np.ceil(length * problem.rate / step)) + 4
    tau = np.linspace(0.0, length, count)
    piece = Piece(limit=interior.limit, side=0, duration=float(tau[-1]))
    return tau, piece_states(problem, piece, interior.first, tau)


def untenable(problem: BoundedProblem, found: MeshOptimum) -> list[tuple[float, float]]:
    """Return where an interior cannot hold its bound.

    There the boundary control takes more than the force limit, or the motion exceeds another bound
    on which no point may act (``mesh.rows.off_interiors``).
    """
    zones = []
    orders = np.array([limit.order for limit in problem.limits])
    for interior in (segment for segment in found.segments if segment.limit >= 0):
        tau, states = interior_states(problem, found, interior)
        held = problem.limits[interior.limit]
        levels = np.abs(states @ problem.rows.T)
        levels[:, (orders > held.order) | (np.arange(orders.size) == interior.limit)] = 0.0
        force = np.abs(states @ held.feedback) / problem.force_limit
        over = np.maximum(levels.max(axis=1), force) > 1.0 + problem.settings.mesh.broken
        edges = np.nonzero(np.diff(np.concatenate([[0], over, [0]])))[0]
        for first, stop in zip(edges[::2], edges[1::2], strict=True):
            ends = tau[[max(first - 1, 0), min(stop, tau.size - 1)]]
            zones.append((float(interior.start - ends[1]), float(interior.start - ends[0])))
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
