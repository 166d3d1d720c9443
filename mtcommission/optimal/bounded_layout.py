"""The mesh of a round: where cells, cores and points of the program lie, from what the last saw."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded_dual import Core
from mtcommission.optimal.bounded_grid import SATURATED, GridOptimum
from mtcommission.optimal.bounded_mesh import Contact, Layout, off_cores
from mtcommission.optimal.bounded_problem import BoundedProblem
from mtcommission.optimal.bounded_reading import Reading, read_contacts

Array = NDArray[np.float64]

SHRINK = 5.0
"""Factor between the finest cells of two rounds."""
BACKGROUND = 80
"""Cells of the background mesh."""
GROWTH = 1.7
"""Ratio of neighbouring cells away from a feature."""
CORE_MARGINS = (3.0, 15.0)
"""Distance of a core from the ends of its arc, in finest cells of the round before: for orders 1
and 2, and for higher orders, where touch points that crowd towards an arc look like its end."""
MARGIN = 1e-9
"""Relative distance from the bounds kept on a mesh."""
SHORT_ARC_POINTS = 60
"""Most points on an arc too short for a core."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sight:
    """What one round has seen.

    Parameters
    ----------
    t_f
        [s].
    finest
        Smallest cell on which it was seen [s].
    reading
        Arcs and touch points.
    switches
        Remaining times of the switches off the arcs [s].
    """

    t_f: float
    finest: float
    reading: Reading
    switches: Array


def first_sight(problem: BoundedProblem, grid: GridOptimum) -> Sight:
    """Return what the even grid shows.

    Parameters
    ----------
    problem
        The bounded problem.
    grid
        Its solution on the grid.

    Returns
    -------
    Sight
    """
    cell = grid.t_f / grid.force.size
    remaining = grid.t_f - cell * np.arange(1, grid.force.size + 1)
    active = [
        Contact(remaining=float(remaining[i]), limit=k, side=int(np.sign(levels[i])), weight=1.0)
        for k, levels in enumerate(grid.levels)
        for i in np.nonzero(np.abs(levels) > 1.0 - SATURATED)[0]
    ]
    reading = read_contacts(active, np.append(remaining[::-1], grid.t_f))
    loose = np.abs(grid.force) < 1.0 - SATURATED
    turning = np.append(False, grid.force[1:] * grid.force[:-1] < 0.0)
    switches = (remaining + 0.5 * cell)[loose | turning]
    return Sight(
        t_f=grid.t_f,
        finest=cell,
        reading=reading,
        switches=off_arcs(switches, reading, cell),
    )


def off_arcs(switches: Array, reading: Reading, room: float) -> Array:
    """Return the switches that are further than ``room`` [s] from all arcs."""
    inside = [(arc.end - room < switches) & (switches < arc.start + room) for arc in reading.arcs]
    return np.asarray(switches[~np.any([np.zeros(switches.size, dtype=bool), *inside], axis=0)])


def narrowed(problem: BoundedProblem, sight: Sight) -> Reading:
    """Return the arcs, each shorter by its room at both ends; the short ones are left out."""
    arcs = tuple(
        replace(arc, start=arc.start - room, end=arc.end + room)
        for arc in sight.reading.arcs
        if arc.start - arc.end > 3.0 * (room := _room(problem, arc, sight))
    )
    return replace(sight.reading, arcs=arcs)


def lay_out(problem: BoundedProblem, sight: Sight) -> Layout:
    """Return mesh, cores and points of the next program.

    Parameters
    ----------
    problem
        The bounded problem.
    sight
        What the last round has seen.

    Returns
    -------
    Layout
        Cells graded towards switches, touch points and ends of arcs.
    """
    finest, background = sight.finest / SHRINK, sight.t_f / BACKGROUND
    cores = tuple(
        replace(arc, start=arc.start - room, end=arc.end + room)
        for arc in sight.reading.arcs
        if arc.start - arc.end > 2.0 * (room := _room(problem, arc, sight)) + 4.0 * finest
    )
    points = [np.arange(1, BACKGROUND) * background]
    ends = [end for arc in sight.reading.arcs for end in (arc.start, arc.end)]
    centres = [*sight.switches, *ends, *(touch.remaining for touch in sight.reading.touches)]
    points += [_graded(centre, finest, background) for centre in centres]
    for arc in sight.reading.arcs:
        if not any(core.start < arc.start and core.end > arc.end for core in cores):
            count = min(int((arc.start - arc.end) / (2.0 * finest)) + 3, SHORT_ARC_POINTS)
            points.append(np.linspace(arc.end, arc.start, count))
    mesh = _thinned(np.concatenate(points), 0.4 * finest, sight.t_f)
    near = 0.3 * finest
    clear = [(mesh < core.end - near) | (mesh > core.start + near) for core in cores]
    mesh = mesh[np.all([np.ones(mesh.size, dtype=bool), *clear], axis=0)]
    return Layout(
        t_f=sight.t_f,
        mesh=mesh,
        cores=cores,
        contacts=_contacts(problem, sight, mesh, cores),
        margin=MARGIN,
    )


def _room(problem: BoundedProblem, arc: Core, sight: Sight) -> float:
    """Return the distance of a core from the ends of its arc [s]."""
    if problem.limits[arc.limit].order <= 2:
        return CORE_MARGINS[0] * sight.finest
    return min(CORE_MARGINS[1] * sight.finest, 0.25 * (arc.start - arc.end))


def _graded(centre: float, finest: float, background: float) -> Array:
    count = int(np.ceil(np.log(2.4 * background / finest) / np.log(GROWTH)))
    offsets = 0.5 * finest * GROWTH ** np.arange(count)
    return np.concatenate([centre - offsets, centre + offsets])


def _thinned(points: Array, distance: float, t_f: float) -> Array:
    ordered = np.unique(points[(points > distance) & (points < t_f - distance)])
    kept = [float(ordered[0])]
    for point in ordered[1:].tolist():
        if point - kept[-1] > distance:
            kept.append(point)
    return np.array(kept)


def _contacts(
    problem: BoundedProblem, sight: Sight, mesh: Array, cores: tuple[Core, ...]
) -> tuple[Contact, ...]:
    """Return the mesh points where a bound may act: near arcs and touch points, ends of cores."""
    zones = [(arc.end, arc.start, 6.0, arc.limit, arc.side) for arc in sight.reading.arcs]
    zones += [
        (touch.remaining, touch.remaining, 4.0, touch.limit, touch.side)
        for touch in sight.reading.touches
    ]
    contacts = [
        Contact(remaining=t, limit=limit, side=side)
        for low, high, cells, limit, side in zones
        for t in mesh[(mesh > low - cells * sight.finest) & (mesh < high + cells * sight.finest)]
    ]
    contacts += [
        Contact(remaining=end, limit=core.limit, side=core.side)
        for core in cores
        for end in (core.start, core.end)
    ]
    return off_cores(problem, tuple(dict.fromkeys(contacts)), cores)
