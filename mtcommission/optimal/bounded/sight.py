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

from mtcommission.optimal.bounded.arcs import Sequence
from mtcommission.optimal.bounded.breaches import BROKEN, breaches_in_cores, untenable
from mtcommission.optimal.bounded.dual import dual_value, negative_zones
from mtcommission.optimal.bounded.exchange import later
from mtcommission.optimal.bounded.layout import SHRINK, Sight, feature_places, off_arcs
from mtcommission.optimal.bounded.measure import Measure, Stretch, stretches
from mtcommission.optimal.bounded.mesh import MeshOptimum
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.reading import Reading, local_cell, read_contacts, read_sequence
from mtcommission.optimal.bounded.rows import Contact, Layout
from mtcommission.optimal.closed_form import impulse_response

Array = NDArray[np.float64]

MOST_FILLED = 2000
"""Most points with which a core is read."""
AGREED = 1e-6
"""Distance of the reaches of both forms from which on what is hidden is the rest of the gap."""
HIDDEN = 1e-8
"""What one cell may hide of the time, relative to it: a hundredth of the gap allowed."""
TINY = 1e-300
KEEP = 1e-7
"""What a cell of twice the size might hide: above that a zero keeps its cell."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Look:
    """What a round has seen.

    Parameters
    ----------
    sight
        For the next mesh, at the t_f at which the reach should be 1.
    guess
        Sequence that the multipliers show.
    dual_value
        F ∫|σ| + Σ|μ| of the relaxation's multipliers, as the proof counts it.
    """

    sight: Sight
    guess: Sequence
    dual_value: float


def look(
    problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum, *, unsplit: Layout
) -> Look:
    """Return where the next mesh should be fine, and the sequence that the multipliers show.

    Parameters
    ----------
    problem
        The bounded problem.
    kept, relaxed
        The two forms of one program.
    unsplit
        Its mesh before cells were split: what is known of the ends of arcs is known to its cells.

    Returns
    -------
    Look
    """
    measure = relaxed.measure
    parts = stretches(problem, measure)
    found = dual_value(problem, parts, measure.atoms)
    zeros = found.zeros
    mesh = _filled(relaxed.layout)
    guess = read_sequence(problem, _read(relaxed, mesh, []), parts, zeros, mesh)
    # A core is opened where holding the bound costs time, or cannot be done.
    zones = [(zone.end, zone.start) for zone in negative_zones(problem, measure)]
    reading = _read(relaxed, mesh, [*zones, *untenable(problem, kept)])
    # Where a core breaks another bound this is touched; a chain of points would hide it.
    crossed = [breach.contact for breach in breaches_in_cores(problem, kept, tolerance=BROKEN)]
    reading = replace(reading, touches=(*reading.touches, *crossed))
    sight = _sight(problem, measure, parts, zeros, mesh, reading, relaxed.reach - kept.reach)
    sight = replace(sight, mesh=_filled(unsplit)).stretched(later(kept.layout, kept))
    return Look(sight=sight, guess=guess, dual_value=found.value)


def _sight(
    problem: BoundedProblem,
    measure: Measure,
    parts: tuple[Stretch, ...],
    zeros: Array,
    mesh: Array,
    reading: Reading,
    apart: float,
) -> Sight:
    """Return the sight of a reading; ``apart`` is the distance of the reaches of both forms."""
    local = np.array([local_cell(mesh, zero) for zero in zeros.tolist()])
    switches = np.isin(zeros, off_arcs(zeros, reading, room=1.5 * local))
    cells = local / SHRINK
    if apart < AGREED:
        # Near the end of an arc a zero is its ripple, unless much of σ hides in its cell, or would
        # in a larger one.
        steepness = steepness_of_zeros(problem, measure, parts, zeros)
        much = hidden(steepness, zeros, mesh) > HIDDEN
        as_fine = ~switches & ~much & (steepness * local**2 > KEEP)
        cells[as_fine] = local[as_fine]
        switches |= much | as_fine
    places = feature_places(reading)
    around = np.array([local_cell(mesh, place) for place in places.tolist()])
    return Sight(
        t_f=float(mesh[-1]),
        mesh=mesh,
        reading=reading,
        places=np.concatenate([zeros[switches], places]),
        cells=np.concatenate([cells[switches], around / SHRINK]),
    )


def steepness_of_zeros(
    problem: BoundedProblem, measure: Measure, parts: tuple[Stretch, ...], zeros: Array
) -> Array:
    """Return |σ'| at the zeros of σ against what it weighs of the time.

    Parameters
    ----------
    problem
        The bounded problem.
    measure
        Dual point.
    parts
        Its stretches.
    zeros
        Remaining times, shape (n_zeros,) [s].

    Returns
    -------
    ndarray, shape (n_zeros,)
        [1/s²].
    """
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

    Parameters
    ----------
    steepness
        |σ'| at the zeros against what σ weighs of the time, shape (n_zeros,) [1/s²].
    zeros
        Remaining times, shape (n_zeros,) [s].
    mesh
        Remaining times between cells, ascending [s].

    Returns
    -------
    ndarray, shape (n_zeros,)

    Examples
    --------
    >>> hidden(np.array([4.0]), np.array([0.7]), np.array([0.0, 1.0])).round(6)
    array([0.36])
    """
    after = np.clip(np.searchsorted(mesh, zeros), 1, mesh.size - 1)
    nearer = np.minimum(np.abs(zeros - mesh[after - 1]), np.abs(mesh[after] - zeros))
    return np.asarray(steepness * nearer**2)


def _filled(layout: Layout) -> Array:
    """Return the mesh with even points in the cores, as close as the cells beside them."""
    ends = [end for core in layout.cores for end in (core.start, core.end)]
    mesh = np.unique(np.concatenate([[0.0, layout.t_f], layout.mesh, ends]))
    inner = [mesh]
    for core in layout.cores:
        at = np.searchsorted(mesh, [core.end, core.start])
        cell = min(mesh[at[0]] - mesh[at[0] - 1], mesh[at[1] + 1] - mesh[at[1]])
        count = int((core.start - core.end) / cell) + 2
        inner.append(np.linspace(core.end, core.start, min(count, MOST_FILLED))[1:-1])
    return np.unique(np.concatenate(inner))


def _read(relaxed: MeshOptimum, mesh: Array, zones: list[tuple[float, float]]) -> Reading:
    """Return arcs and touch points, zones of cores (remaining times of end and start) left out."""
    active = [contact for contact in relaxed.contacts if contact.weight > 0.0]
    for core in relaxed.layout.cores:
        active += [
            Contact(remaining=t, limit=core.limit, side=core.side, weight=1.0)
            for t in mesh[(mesh >= core.end) & (mesh <= core.start)].tolist()
            if not any(end <= t <= start for end, start in zones)
        ]
    return read_contacts(active, mesh)
