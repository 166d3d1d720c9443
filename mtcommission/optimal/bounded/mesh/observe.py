"""What the two forms of a program show: where the next mesh must be fine, and the sequence.

Both forms see σ by its mean over a cell only. Where it changes sign inside one, they miss
twice the smaller part of it, |σ'| d² for a zero at a distance d from the cell's nearer end: the sum
of all is the gap that is left once both forms agree. From then on zeros that hide much get smaller
cells, and those that would hide much in larger cells keep theirs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.mesh.exchange import later
from mtcommission.optimal.bounded.mesh.forms import MeshOptimum
from mtcommission.optimal.bounded.mesh.plan import Features, feature_places, off_arcs
from mtcommission.optimal.bounded.mesh.rows import MeshPlan
from mtcommission.optimal.bounded.mesh.violations import untenable, violations_in_interiors
from mtcommission.optimal.bounded.places import ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.proof.dual_point import Measure, Stretch, stretches
from mtcommission.optimal.bounded.proof.dual_value import dual_value, negative_zones
from mtcommission.optimal.bounded.structure.detection import (
    Structure,
    detect_sequence,
    detect_structure,
    local_cell,
)
from mtcommission.optimal.bounded.structure.sequence import Sequence
from mtcommission.optimal.closed_form import impulse_response

Array = NDArray[np.float64]

TINY = 1e-300


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observation:
    """What a round has seen."""

    features: Features  # For the next mesh, at the t_f at which the reach should be 1
    guess: Sequence  # Sequence that the multipliers show
    dual_value: float  # F ∫|σ| + Σ|μ| of the relaxation's multipliers, as the proof counts it


def observe(
    problem: BoundedProblem, restriction: MeshOptimum, relaxation: MeshOptimum, *, unsplit: MeshPlan
) -> Observation:
    """Return where the next mesh should be fine, and the sequence that the multipliers show."""
    measure = relaxation.measure
    parts = stretches(problem, measure)
    found = dual_value(problem, parts, measure.atoms)
    zeros = found.zeros
    mesh = _filled(problem, relaxation.plan)
    guess = detect_sequence(problem, _structure(problem, relaxation, mesh, []), parts, zeros, mesh)
    # An interior is opened where holding the bound costs time, or cannot be done.
    zones = [(zone.end, zone.start) for zone in negative_zones(problem, measure)]
    structure = _structure(problem, relaxation, mesh, [*zones, *untenable(problem, restriction)])
    # Where an interior breaks another bound this is touched; a chain of points would hide it.
    broken = problem.settings.mesh.broken
    crossed = violations_in_interiors(problem, restriction, tolerance=broken)
    touches = (*structure.touches, *(violation.point for violation in crossed))
    structure, apart = replace(structure, touches=touches), relaxation.reach - restriction.reach
    features = _features(problem, measure, parts, zeros, mesh, structure, apart)
    features = replace(features, mesh=_filled(problem, unsplit))
    features = features.stretched(later(problem, restriction.plan, restriction))
    return Observation(features=features, guess=guess, dual_value=found.value)


def _features(
    problem: BoundedProblem,
    measure: Measure,
    parts: tuple[Stretch, ...],
    zeros: Array,
    mesh: Array,
    structure: Structure,
    apart: float,
) -> Features:
    """Return the features of a structure; ``apart``: the distance of both reaches."""
    settings = problem.settings.mesh
    local = np.array([local_cell(mesh, zero) for zero in zeros.tolist()])
    switches = np.isin(zeros, off_arcs(zeros, structure, room=1.5 * local))
    cells = local / settings.shrink
    if apart < settings.agreed:
        # Near the end of an arc a zero is its ripple, unless much of σ hides in its cell, or would
        # in a larger one.
        steepness = steepness_of_zeros(problem, measure, parts, zeros)
        much = hidden(steepness, zeros, mesh) > settings.hidden
        as_fine = ~switches & ~much & (steepness * local**2 > settings.keep_hidden)
        cells[as_fine] = local[as_fine]
        switches |= much | as_fine
    places = feature_places(structure)
    around = np.array([local_cell(mesh, place) for place in places.tolist()])
    return Features(
        t_f=float(mesh[-1]),
        mesh=mesh,
        structure=structure,
        places=np.concatenate([zeros[switches], places]),
        cells=np.concatenate([cells[switches], around / settings.shrink]),
    )


def steepness_of_zeros(
    problem: BoundedProblem, measure: Measure, parts: tuple[Stretch, ...], zeros: Array
) -> Array:
    """Return |σ'| at the zeros of σ against what it weighs of the time."""
    starts = np.array([part.start for part in parts])[::-1]
    slopes = []
    for zero in zeros.tolist():
        part = parts[len(parts) - 1 - min(int(np.searchsorted(starts, zero)), len(parts) - 1)]
        motion = impulse_response(problem.plant, np.array(zero - part.end))
        slopes.append(abs(float(part.adjoint @ problem.plant.A @ motion)))
    along = abs(float(measure.terminal @ problem.target))
    return np.array(slopes) * problem.force_limit / max(along, TINY)


def hidden(steepness: Array, zeros: Array, mesh: Array) -> Array:
    """Return what the program misses of the time for each zero of σ, relative to the time.

    It sees |∫ σ| of a cell only, so the smaller part of the cell of a zero counts twice.

    Examples
    --------
    >>> hidden(np.array([4.0]), np.array([0.7]), np.array([0.0, 1.0])).round(6)
    array([0.36])
    """
    after = np.clip(np.searchsorted(mesh, zeros), 1, mesh.size - 1)
    nearer = np.minimum(np.abs(zeros - mesh[after - 1]), np.abs(mesh[after] - zeros))
    return np.asarray(steepness * nearer**2)


def _filled(problem: BoundedProblem, plan: MeshPlan) -> Array:
    """Return the mesh with even points in the interiors, as close as the cells beside them."""
    ends = [end for interior in plan.interiors for end in (interior.start, interior.end)]
    mesh = np.unique(np.concatenate([[0.0, plan.t_f], plan.mesh, ends]))
    inner = [mesh]
    for interior in plan.interiors:
        at = np.searchsorted(mesh, [interior.end, interior.start])
        cell = min(mesh[at[0]] - mesh[at[0] - 1], mesh[at[1] + 1] - mesh[at[1]])
        count = int((interior.start - interior.end) / cell) + 2
        count = min(count, problem.settings.mesh.most_filled)
        inner.append(np.linspace(interior.end, interior.start, count)[1:-1])
    return np.unique(np.concatenate(inner))


def _structure(
    problem: BoundedProblem, relaxation: MeshOptimum, mesh: Array, zones: list[tuple[float, float]]
) -> Structure:
    """Return arcs and touch points, some zones of interiors (ends and starts) left out."""
    active = [point for point in relaxation.points if point.weight > 0.0]
    for interior in relaxation.plan.interiors:
        active += [
            ConstraintPoint(remaining=t, limit=interior.limit, side=interior.side, weight=1.0)
            for t in mesh[(mesh >= interior.end) & (mesh <= interior.start)].tolist()
            if not any(end <= t <= start for end, start in zones)
        ]
    return detect_structure(active, mesh, problem.settings.structure)
