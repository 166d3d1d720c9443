"""The mesh of a round: where cells, cores and points of the program lie, from what the last saw."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.grid import SATURATED, GridOptimum
from mtcommission.optimal.bounded.measure import Core
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.reading import Reading, local_cell, read_contacts
from mtcommission.optimal.bounded.rows import Contact, Layout, off_cores

Array = NDArray[np.float64]

SHRINK = 5.0
"""Factor between the cells at a feature of two rounds."""
BACKGROUND = 80
"""Cells of the background mesh."""
GROWTH = 1.7
"""Ratio of neighbouring cells away from a feature."""
CORE_MARGINS = (3.0, 15.0)
"""Distance of a core from the ends of its arc, in cells of the round before: for orders 1
and 2, and for higher orders, where touch points that crowd towards an arc look like its end."""
JUNCTION_CELLS = (8, 30)
"""Even cells between a core and an end of its arc, for orders 1 and 2 and for higher orders,
where an order above 2 is among the bounds and the mesh itself is the result. Touch points follow
each other in a fixed ratio there, so some thirty cells show all that matter (measured)."""
BEYOND_JUNCTION = 0.5
"""How far the even cells go on beyond the end of the arc, as a share of the same distance."""
MARGIN = 1e-9
"""Relative distance from the bounds kept on a mesh."""
THINNING = 0.4
"""Share of its cell that a point keeps from its neighbour."""
MOST_GROWTH = 10.0
"""Growth of the motion over a core, as exponent of e: twenty thousand times."""
SHORT_ARC_POINTS = 60
"""Most points on an arc too short for a core."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sight:
    """What one round has seen.

    Parameters
    ----------
    t_f
        [s].
    mesh
        Remaining times between the cells on which it was seen, ascending, with even points in
        the cores [s]: a feature is known to one of its cells.
    reading
        Arcs and touch points.
    places
        Remaining times to which the next mesh is graded: switches, ends of arcs, touch points [s].
    cells
        Cells wanted there, shape of ``places`` [s].
    room
        Factor on the distance between a core and the ends of its arc.
    least_core
        Share of t_f that an arc takes at least if it gets a core.
    ease
        Factor on the cells wanted, where they would be too many.
    """

    t_f: float
    mesh: Array
    reading: Reading
    places: Array
    cells: Array
    room: float = 1.0
    least_core: float = 0.0
    ease: float = 1.0

    def stretched(self, t_f: float) -> Sight:
        """Return the same sight over another t_f [s], every place at the same share of it."""
        share = t_f / self.t_f
        arcs, touches = self.reading.arcs, self.reading.touches
        return replace(
            self,
            t_f=t_f,
            mesh=self.mesh * share,
            reading=Reading(
                arcs=tuple(replace(k, start=k.start * share, end=k.end * share) for k in arcs),
                touches=tuple(replace(k, remaining=k.remaining * share) for k in touches),
            ),
            places=self.places * share,
            cells=self.cells * share,
        )


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
    places = np.concatenate([off_arcs(switches, reading, room=cell), feature_places(reading)])
    return Sight(
        t_f=grid.t_f,
        mesh=np.append(remaining[::-1], grid.t_f),
        reading=reading,
        places=places,
        cells=np.full(places.size, cell / SHRINK),
    )


def feature_places(reading: Reading) -> Array:
    """Return the remaining times of the ends of arcs and of the touch points [s]."""
    ends = [end for arc in reading.arcs for end in (arc.start, arc.end)]
    return np.array([*ends, *(touch.remaining for touch in reading.touches)])


def off_arcs(switches: Array, reading: Reading, *, room: float | Array) -> Array:
    """Return the switches that are further than ``room`` [s] from all arcs."""
    inside = [(arc.end - room < switches) & (switches < arc.start + room) for arc in reading.arcs]
    return np.asarray(switches[~np.any([np.zeros(switches.size, dtype=bool), *inside], axis=0)])


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
        Cells graded towards switches, touch points and ends of arcs, with the cells wanted there.
    """
    arcs, background = _parted(problem, sight.reading), sight.t_f / BACKGROUND
    cores = _cores(problem, sight, arcs)
    even = np.arange(1, BACKGROUND) * background
    clouds = [np.column_stack([even, np.full(even.size, background)])]
    clouds += [
        _graded(at, min(sight.ease * cell, background), background)
        for at, cell in zip(sight.places.tolist(), sight.cells.tolist(), strict=True)
    ]
    for arc in arcs:
        if not any(core.start < arc.start and core.end > arc.end for core in cores):
            clouds.append(_spread(arc, sight.ease * local_cell(sight.mesh, arc.start) / SHRINK))
    junctions = _junctions(problem, arcs, cores)
    clouds += [np.column_stack([zone, np.gradient(zone)]) for _, zone in junctions]
    mesh = _thinned(np.vstack(clouds), sight.t_f)
    for core in cores:
        near = 0.3 * local_cell(sight.mesh, core.start) / SHRINK
        mesh = mesh[(mesh < core.end - near) | (mesh > core.start + near)]
    return Layout(
        t_f=sight.t_f,
        mesh=mesh,
        cores=cores,
        contacts=_contacts(problem, sight, mesh, cores, junctions),
        margin=MARGIN,
    )


def _junctions(
    problem: BoundedProblem, arcs: list[Core], cores: tuple[Core, ...]
) -> list[tuple[Core, Array]]:
    """Return even ascending points about the ends of each arc with a core, and that core.

    None where all bounds have orders 1 and 2: the exact sequence replaces the mesh there.
    """
    zones: list[tuple[Core, Array]] = []
    if not problem.has_high_order:
        return zones
    for core in cores:
        arc = next(arc for arc in arcs if arc.start > core.start and arc.end < core.end)
        cells = JUNCTION_CELLS[problem.limits[core.limit].order > 2]
        for inside, end in ((core.start, arc.start), (core.end, arc.end)):
            steps = np.arange(int((1.0 + BEYOND_JUNCTION) * cells) + 1) / cells
            zones.append((core, np.sort(inside + (end - inside) * steps)))
    return zones


def _cores(problem: BoundedProblem, sight: Sight, arcs: list[Core]) -> tuple[Core, ...]:
    cores = []
    for arc in arcs:
        early, late = _rooms(problem, arc, sight)
        needed = early + late + 0.8 * local_cell(sight.mesh, arc.start)
        # Motion that grows on the arc leaves a core no digits: points must do there.
        steady = problem.limits[arc.limit].growth * (arc.start - arc.end) < MOST_GROWTH
        # Points that touch in a row may look like a short arc where the order is above 2.
        least = sight.least_core * sight.t_f if problem.limits[arc.limit].order > 2 else 0.0
        if steady and arc.start - arc.end > max(needed, least):
            cores.append(replace(arc, start=arc.start - early, end=arc.end + late))
    return tuple(cores)


def _parted(problem: BoundedProblem, reading: Reading) -> list[Core]:
    """Return the arcs between the touch points of other bounds that no core may hold."""
    parts = []
    for arc in reading.arcs:
        order = problem.limits[arc.limit].order
        cuts = [
            touch.remaining
            for touch in reading.touches
            if touch.limit != arc.limit and problem.limits[touch.limit].order <= order
        ]
        inner = sorted((cut for cut in cuts if arc.end < cut < arc.start), reverse=True)
        ends = [arc.start, *inner, arc.end]
        parts += [replace(arc, start=start, end=end) for start, end in pairwise(ends)]
    return parts


def _rooms(problem: BoundedProblem, arc: Core, sight: Sight) -> tuple[float, float]:
    """Return the distances of a core from the start and the end of its arc [s]."""
    early = sight.room * local_cell(sight.mesh, arc.start)
    late = sight.room * local_cell(sight.mesh, arc.end)
    if problem.limits[arc.limit].order <= 2:
        return CORE_MARGINS[0] * early, CORE_MARGINS[0] * late
    most = 0.25 * (arc.start - arc.end)
    return min(CORE_MARGINS[1] * early, most), min(CORE_MARGINS[1] * late, most)


def _graded(centre: float, finest: float, background: float) -> Array:
    """Return points on both sides of a centre with the cells that they bound, shape (k, 2)."""
    count = int(np.ceil(np.log(2.4 * background / finest) / np.log(GROWTH)))
    cells = finest * GROWTH ** np.arange(max(count, 1))
    offsets = 0.5 * cells
    return np.column_stack(
        [np.concatenate([centre - offsets, centre + offsets]), np.tile((GROWTH - 1.0) * offsets, 2)]
    )


def _spread(arc: Core, finest: float) -> Array:
    """Return even points on an arc too short for a core, shape (k, 2)."""
    count = min(int((arc.start - arc.end) / (2.0 * finest)) + 3, SHORT_ARC_POINTS)
    points = np.linspace(arc.end, arc.start, count)
    return np.column_stack([points, np.full(count, points[1] - points[0])])


def _thinned(cloud: Array, t_f: float) -> Array:
    """Return the points that are further from the one before than a share of their cells."""
    ordered = cloud[np.argsort(cloud[:, 0])]
    kept = [0.0]
    for point, cell in ordered.tolist():
        if min(point - kept[-1], t_f - point) > THINNING * cell:
            kept.append(point)
    return np.array(kept[1:])


def _contacts(
    problem: BoundedProblem,
    sight: Sight,
    mesh: Array,
    cores: tuple[Core, ...],
    junctions: list[tuple[Core, Array]],
) -> tuple[Contact, ...]:
    """Return the mesh points where a bound may act: near arcs and touch points, ends of cores."""
    contacts: list[Contact] = []
    for arc in sight.reading.arcs:
        low = arc.end - 6.0 * local_cell(sight.mesh, arc.end)
        high = arc.start + 6.0 * local_cell(sight.mesh, arc.start)
        contacts += _points(mesh, low, high, limit=arc.limit, side=arc.side)
    for core, zone in junctions:
        contacts += _points(mesh, zone[0], zone[-1], limit=core.limit, side=core.side)
    for touch in sight.reading.touches:
        near = 4.0 * local_cell(sight.mesh, touch.remaining)
        low, high = touch.remaining - near, touch.remaining + near
        contacts += _points(mesh, low, high, limit=touch.limit, side=touch.side)
    contacts += [
        Contact(remaining=end, limit=core.limit, side=core.side)
        for core in cores
        for end in (core.start, core.end)
    ]
    return off_cores(problem, tuple(dict.fromkeys(contacts)), cores)


def _points(mesh: Array, low: float, high: float, *, limit: int, side: int) -> list[Contact]:
    inside = mesh[(mesh > low) & (mesh < high)].tolist()
    return [Contact(remaining=t, limit=limit, side=side) for t in inside]
