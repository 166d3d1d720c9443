"""The program on one mesh, with points put in wherever its motion breaks a bound."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded_arcs import Piece, peaks_above, piece_states
from mtcommission.optimal.bounded_mesh import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded_problem import BoundedProblem
from mtcommission.optimal.bounded_rows import Contact, Layout, Segment, off_cores
from mtcommission.optimal.closed_form import step_response, transition

Array = NDArray[np.float64]

EXCHANGES = 6
"""Solutions of the program on one mesh, each with the points where the last broke a bound."""
STEADY = 2e-6
"""Change of the reach by new points below which others are left to the next mesh."""
BROKEN = 1e-6
"""Relative excess over a bound that calls for another point of the program; what is left is
covered by a margin."""
RADIANS_PER_SAMPLE = 0.2
"""Samples of a core among which excesses over other bounds are looked for."""
SAMPLES = 13
"""Samples of a part of a cell among which its largest excess is looked for."""
RADIANS_PER_PART = 2.4
"""Longest part of a cell, in the period of the fastest mode."""
LEAST_SLOPE = 0.3
"""Least dα/dlog t_f believed: the marginal vanishes where the first cell hides a switch."""
LARGEST_CHANGE = 0.02
"""Largest relative change of t_f on one mesh."""
LONG_WAY = 1e-3
"""Least such change that tells the slope better: points put in between lower the reach, too."""


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


def exchange(problem: BoundedProblem, layout: Layout) -> MeshOptimum | None:
    """Return the solution on the mesh with t_f such that the reach is 1."""
    found: MeshOptimum | None = None
    # While the mesh is coarse, more exactness at the bounds would be wasted.
    tolerance = max(BROKEN, 0.3 * float(np.diff(layout.mesh).min()) / layout.t_f)
    for _ in range(EXCHANGES):
        start = None if found is None else found.basis
        before, found = found, solve_mesh(problem, layout, relaxed=False, start=start)
        if found is None:
            return None
        if before is not None:
            found = steepened(before, found)
        over = [breach.contact for breach in breaches(problem, found, tolerance=tolerance)]
        worse = off_cores(problem, tuple(over), found.layout.cores)
        in_time = abs(found.reach - 1.0) < 1e-4
        if in_time and (not worse or _steady(before, found)):
            break
        layout = replace(layout, contacts=tuple(dict.fromkeys([*layout.contacts, *worse])))
        if not in_time:
            layout = layout.stretched(later(layout, found))
    return found


def _steady(before: MeshOptimum | None, after: MeshOptimum) -> bool:
    """Return whether the last points have hardly changed the reach."""
    if before is None or before.layout.t_f != after.layout.t_f:
        return False
    return before.reach - after.reach < STEADY


def steepened(before: MeshOptimum, found: MeshOptimum) -> MeshOptimum:
    """Return a solution with the slope of the way gone: the marginal knows one cell only."""
    gone = found.layout.t_f - before.layout.t_f
    if abs(gone) < LONG_WAY * found.layout.t_f:
        return found
    secant = (found.reach - before.reach) / gone
    return replace(found, slope=secant) if secant > 0.0 else found


def later(layout: Layout, found: MeshOptimum) -> float:
    """Return the t_f at which the reach should be 1, no further away than is safe."""
    change = (1.0 - found.reach) / max(found.slope * layout.t_f, LEAST_SLOPE)
    return layout.t_f * (1.0 + float(np.clip(change, -LARGEST_CHANGE, LARGEST_CHANGE)))


def breaches(problem: BoundedProblem, found: MeshOptimum, *, tolerance: float) -> list[Breach]:
    """Return where the motion of a mesh solution exceeds a bound by a relative tolerance."""
    cells = [segment for segment in found.segments if segment.limit < 0]
    part, since, step, levels = _levels(problem, found, cells)
    places, peaks = _peaks(np.abs(levels))
    over = []
    for i, k in zip(*np.nonzero(peaks > 1.0 + tolerance), strict=True):
        cell = cells[part[i]]
        remaining = max(float(cell.start - since[i] - places[i, k] * step[i]), cell.end)
        side = int(np.sign(levels[i, round(places[i, k]), k]))
        at = Contact(remaining=remaining, limit=int(k), side=side)
        over.append(Breach(contact=at, excess=float(peaks[i, k]) - 1.0))
    return over + breaches_in_cores(problem, found, tolerance=tolerance)


def _levels(
    problem: BoundedProblem, found: MeshOptimum, cells: list[Segment]
) -> tuple[NDArray[np.intp], Array, Array, Array]:
    """Return samples of all c x in short parts of the cells.

    That is: the cell of each part, the time from the start of the cell to that of the part and
    between its samples [s], shapes (n_parts,), and c x, shape (n_parts, SAMPLES, n_limits).
    """
    plant = problem.plant
    lengths = np.array([cell.start - cell.end for cell in cells])
    counts = np.ceil(lengths * problem.vibration_rate / RADIANS_PER_PART).astype(np.intp)
    part = np.repeat(np.arange(len(cells)), counts)
    span = (lengths / counts)[part]
    since = span * (np.arange(part.size) - (np.cumsum(counts) - counts)[part])
    starts = np.array([found.state(cell.first) for cell in cells])[part]
    force = found.unknowns[[cell.column for cell in cells]][part, np.newaxis] * problem.force_limit
    step = span / (SAMPLES - 1)
    flow, push = transition(plant, step), step_response(plant, step) * force
    state = np.einsum("pij,pj->pi", transition(plant, since), starts)
    state += step_response(plant, since) * force
    states = [state]
    for _ in range(SAMPLES - 1):
        states.append(np.einsum("pij,pj->pi", flow, states[-1]) + push)
    return part, since, step, np.stack(states, axis=1) @ problem.rows.T


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
    over = []
    for core in (segment for segment in found.segments if segment.limit >= 0):
        tau, states = core_states(problem, found, core)
        levels = states @ problem.rows.T
        levels[:, core.limit] = 0.0
        for at, k in peaks_above(levels, 1.0 + tolerance):
            places, peaks = _peaks(np.abs(levels[np.newaxis, at - 1 : at + 2, k : k + 1]))
            remaining = float(core.start - tau[at - 1] - places[0, 0] * tau[1])
            contact = Contact(remaining=remaining, limit=k, side=int(np.sign(levels[at, k])))
            over.append(Breach(contact=contact, excess=float(peaks[0, 0]) - 1.0))
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
