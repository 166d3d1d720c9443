"""The mesh of a round: where its cells, interiors and points lie, from what the last has seen."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.mesh.rows import MeshPlan, off_interiors
from mtcommission.optimal.bounded.places import ArcInterior, ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.program.grid import GridOptimum
from mtcommission.optimal.bounded.structure.detection import Structure, detect_structure, local_cell

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Features:
    """What one round has seen."""

    t_f: float  # [s]
    # Remaining times between the cells on which it was seen, ascending, with even points in
    # the interiors [s]: a feature is known to one of its cells.
    mesh: Array
    structure: Structure  # Arcs and touch points
    # Remaining times to which the next mesh is graded: switches, ends of arcs, touch points
    # [s].
    places: Array
    cells: Array  # Cells wanted there, shape of ``places`` [s]
    room: float = 1.0  # Factor on the distance between an interior and the ends of its arc
    least_interior: float = 0.0  # Share of t_f that an arc takes at least if it gets an interior
    ease: float = 1.0  # Factor on the cells wanted, where they would be too many

    def stretched(self, t_f: float) -> Features:
        """Return the same features over another t_f [s], every place at the same share of it."""
        share = t_f / self.t_f
        return replace(
            self,
            t_f=t_f,
            mesh=self.mesh * share,
            structure=Structure(
                arcs=tuple(arc.stretched(share) for arc in self.structure.arcs),
                touches=tuple(touch.stretched(share) for touch in self.structure.touches),
            ),
            places=self.places * share,
            cells=self.cells * share,
        )


def first_features(problem: BoundedProblem, grid: GridOptimum) -> Features:
    """Return what the even grid shows."""
    settings = problem.settings.program
    cell = grid.t_f / grid.force.size
    remaining = grid.t_f - cell * np.arange(1, grid.force.size + 1)
    active = [
        ConstraintPoint(
            remaining=float(remaining[i]), limit=k, side=int(np.sign(levels[i])), weight=1.0
        )
        for k, levels in enumerate(grid.levels)
        for i in np.nonzero(np.abs(levels) > 1.0 - settings.saturated)[0]
    ]
    structure = detect_structure(
        active, np.append(remaining[::-1], grid.t_f), problem.settings.structure
    )
    loose = np.abs(grid.force) < 1.0 - settings.saturated
    turning = np.append(False, grid.force[1:] * grid.force[:-1] < 0.0)
    switches = (remaining + 0.5 * cell)[loose | turning]
    places = np.concatenate([off_arcs(switches, structure, room=cell), feature_places(structure)])
    return Features(
        t_f=grid.t_f,
        mesh=np.append(remaining[::-1], grid.t_f),
        structure=structure,
        places=places,
        cells=np.full(places.size, cell / problem.settings.mesh.shrink),
    )


def feature_places(structure: Structure) -> Array:
    """Return the remaining times of the ends of arcs and of the touch points [s]."""
    ends = [end for arc in structure.arcs for end in (arc.start, arc.end)]
    return np.array([*ends, *(touch.remaining for touch in structure.touches)])


def off_arcs(switches: Array, structure: Structure, *, room: float | Array) -> Array:
    """Return the switches that are further than ``room`` [s] from all arcs."""
    inside = [(arc.end - room < switches) & (switches < arc.start + room) for arc in structure.arcs]
    return np.asarray(switches[~np.any([np.zeros(switches.size, dtype=bool), *inside], axis=0)])


def plan_mesh(problem: BoundedProblem, features: Features) -> MeshPlan:
    """Return mesh, interiors and points of the next program."""
    settings = problem.settings.mesh
    arcs, background = _parted(problem, features.structure), features.t_f / settings.background
    interiors = _interiors(problem, features, arcs)
    even = np.arange(1, settings.background) * background
    clouds = [np.column_stack([even, np.full(even.size, background)])]
    clouds += [
        _graded(at, min(features.ease * cell, background), background, ratio=settings.grading)
        for at, cell in zip(features.places.tolist(), features.cells.tolist(), strict=True)
    ]
    for arc in arcs:
        if not any(interior.start < arc.start and interior.end > arc.end for interior in interiors):
            finest = features.ease * local_cell(features.mesh, arc.start) / settings.shrink
            clouds.append(_spread(arc, finest, most=settings.short_arc_points))
    junctions = _junctions(problem, arcs, interiors)
    clouds += [np.column_stack([zone, np.gradient(zone)]) for _, zone in junctions]
    mesh = _thinned(np.vstack(clouds), features.t_f, share=settings.thinning)
    for interior in interiors:
        near = 0.3 * local_cell(features.mesh, interior.start) / settings.shrink
        mesh = mesh[(mesh < interior.end - near) | (mesh > interior.start + near)]
    return MeshPlan(
        t_f=features.t_f,
        mesh=mesh,
        interiors=interiors,
        points=_constraint_points(problem, features, mesh, interiors, junctions),
        margin=settings.margin,
    )


def _junctions(
    problem: BoundedProblem, arcs: list[ArcInterior], interiors: tuple[ArcInterior, ...]
) -> list[tuple[ArcInterior, Array]]:
    """Return even ascending points about the ends of each arc with an interior, and that interior.

    None where all bounds have orders 1 and 2: the exact sequence replaces the mesh there.
    """
    settings = problem.settings.mesh
    zones: list[tuple[ArcInterior, Array]] = []
    if not problem.has_high_order:
        return zones
    for interior in interiors:
        arc = next(arc for arc in arcs if arc.start > interior.start and arc.end < interior.end)
        cells = settings.junction_cells[problem.limits[interior.limit].order > 2]
        for inside, end in ((interior.start, arc.start), (interior.end, arc.end)):
            steps = np.arange(int((1.0 + settings.beyond_junction) * cells) + 1) / cells
            zones.append((interior, np.sort(inside + (end - inside) * steps)))
    return zones


def _interiors(
    problem: BoundedProblem, features: Features, arcs: list[ArcInterior]
) -> tuple[ArcInterior, ...]:
    interiors = []
    for arc in arcs:
        early, late = _rooms(problem, arc, features)
        needed = early + late + 0.8 * local_cell(features.mesh, arc.start)
        # Motion that grows on the arc leaves an interior no digits: points must do there.
        limit = problem.limits[arc.limit]
        growth = limit.growth * (arc.start - arc.end)
        steady = growth < problem.settings.structure.most_growth
        # Points that touch in a row may look like a short arc where the order is above 2.
        least = features.least_interior * features.t_f if limit.order > 2 else 0.0
        if steady and arc.start - arc.end > max(needed, least):
            interiors.append(replace(arc, start=arc.start - early, end=arc.end + late))
    return tuple(interiors)


def _parted(problem: BoundedProblem, structure: Structure) -> list[ArcInterior]:
    """Return the arcs between the touch points of other bounds that no interior may hold."""
    parts = []
    for arc in structure.arcs:
        order = problem.limits[arc.limit].order
        cuts = [
            touch.remaining
            for touch in structure.touches
            if touch.limit != arc.limit and problem.limits[touch.limit].order <= order
        ]
        inner = sorted((cut for cut in cuts if arc.end < cut < arc.start), reverse=True)
        ends = [arc.start, *inner, arc.end]
        parts += [replace(arc, start=start, end=end) for start, end in pairwise(ends)]
    return parts


def _rooms(problem: BoundedProblem, arc: ArcInterior, features: Features) -> tuple[float, float]:
    """Return the distances of an interior from the start and the end of its arc [s]."""
    settings = problem.settings.mesh
    early = features.room * local_cell(features.mesh, arc.start)
    late = features.room * local_cell(features.mesh, arc.end)
    low_order, high_order = settings.interior_margins
    if problem.limits[arc.limit].order <= 2:
        return low_order * early, low_order * late
    most = 0.25 * (arc.start - arc.end)
    return min(high_order * early, most), min(high_order * late, most)


def _graded(centre: float, finest: float, background: float, *, ratio: float) -> Array:
    """Return points on both sides of a centre with the cells that they bound, shape (k, 2)."""
    count = int(np.ceil(np.log(2.4 * background / finest) / np.log(ratio)))
    cells = finest * ratio ** np.arange(max(count, 1))
    offsets = 0.5 * cells
    places = np.concatenate([centre - offsets, centre + offsets])
    return np.column_stack([places, np.tile((ratio - 1.0) * offsets, 2)])


def _spread(arc: ArcInterior, finest: float, *, most: int) -> Array:
    """Return even points on an arc too short for an interior, shape (k, 2)."""
    count = min(int((arc.start - arc.end) / (2.0 * finest)) + 3, most)
    points = np.linspace(arc.end, arc.start, count)
    return np.column_stack([points, np.full(count, points[1] - points[0])])


def _thinned(cloud: Array, t_f: float, *, share: float) -> Array:
    """Return the points that are further from the one before than a share of their cells."""
    ordered = cloud[np.argsort(cloud[:, 0])]
    kept = [0.0]
    for point, cell in ordered.tolist():
        if min(point - kept[-1], t_f - point) > share * cell:
            kept.append(point)
    return np.array(kept[1:])


def _constraint_points(
    problem: BoundedProblem,
    features: Features,
    mesh: Array,
    interiors: tuple[ArcInterior, ...],
    junctions: list[tuple[ArcInterior, Array]],
) -> tuple[ConstraintPoint, ...]:
    """Return the mesh points where a bound may act: near arcs, touch points, ends of interiors."""
    points: list[ConstraintPoint] = []
    for arc in features.structure.arcs:
        low = arc.end - 6.0 * local_cell(features.mesh, arc.end)
        high = arc.start + 6.0 * local_cell(features.mesh, arc.start)
        points += _points(mesh, low, high, limit=arc.limit, side=arc.side)
    for interior, zone in junctions:
        points += _points(mesh, zone[0], zone[-1], limit=interior.limit, side=interior.side)
    for touch in features.structure.touches:
        near = 4.0 * local_cell(features.mesh, touch.remaining)
        low, high = touch.remaining - near, touch.remaining + near
        points += _points(mesh, low, high, limit=touch.limit, side=touch.side)
    points += [
        ConstraintPoint(remaining=end, limit=interior.limit, side=interior.side)
        for interior in interiors
        for end in (interior.start, interior.end)
    ]
    return off_interiors(problem, tuple(dict.fromkeys(points)), interiors)


def _points(
    mesh: Array, low: float, high: float, *, limit: int, side: int
) -> list[ConstraintPoint]:
    inside = mesh[(mesh > low) & (mesh < high)].tolist()
    return [ConstraintPoint(remaining=t, limit=limit, side=side) for t in inside]
