"""The motion under a bang-bang force, in closed form, and its exact peaks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

from mtcommission.optimal.free.mesh import Grading
from mtcommission.optimal.free.moments import PLANTS, MomentProblem, all_moment_rows
from mtcommission.optimal.free.switching import newton_quotient
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

RADIANS_PER_CELL = 0.35
"""Mesh for peaks against the fastest pole (empirical): cubics through it err by 4e-5 of an
oscillation and by 3e-4 of a radian in the place of its peak; the series of third order there then
errs by the fourth power of that."""
SELECTION_MARGIN = 1e-3
"""Relative reserve for the error of the cubics."""
NEAR = 0.1
"""Third term of the slope's series against the second up to which Newton's step is trusted; some
1e-3 is usual at a peak."""
ROUNDOFF_MARGIN = 1e-13
"""Rise within a cell, against the peak, that is not worth a closer look."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SignalRows:
    """Signals of a plant and their derivatives, from the moments of the force."""

    rates: Complex  # Of the moment functions, shape (n_rates,) [1/s]
    # Rows that take the moments, those of 1 and τ last, to the signals and their first three
    # derivatives, but for the force's own part, shape (4, n_signals, n).
    derivatives: Array
    # That part per newton of F_set, shape (4, n_signals); 0 for the signals themselves.
    of_force: Array


@lru_cache(maxsize=PLANTS)
def signals_of_moments(plant: Plant, problem: MomentProblem) -> SignalRows:
    """Return how ``Plant.signals`` follow from moments."""
    n, moments = plant.order, all_moment_rows(plant)
    rows = np.empty((4, len(plant.signals), n))
    rows[0, :n] = dgesv(moments, np.eye(n))[2]
    np.matmul(plant.C, rows[0, :n], out=rows[0, n:])
    # Moments m of a force obey dm/dt = D^T m + (rows B) F_set.
    for before, after in pairwise(rows):
        np.matmul(before, problem.joint_differentiation.T, out=after)
    of_force = np.zeros(rows.shape[:2])
    np.matmul(rows[:-1].reshape(-1, n), moments @ plant.B, out=of_force[1:].reshape(-1))
    return SignalRows(rates=problem.rates, derivatives=rows, of_force=of_force)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BangBangMotion:
    """The motion from rest under a force that changes sign at given times."""

    plant: Plant  # The plant
    problem: MomentProblem  # A moment problem of it
    grading: Grading  # Of its moment functions, up to t_f or beyond
    switching_times: Array  # Ascending, shape (n_switches,) [s]
    t_f: float  # End [s]
    first_force: float  # F_set on the first arc [N]

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals`` on [0, t_f]."""
        return signal_peaks(gather_moments(self), self.grading)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GatheredMoments:
    """A bang-bang motion by its arcs, with the moments gathered up to each switch."""

    rows: SignalRows  # Signals of the plant
    lengths: Array  # Of the arcs, shape (n_arcs,) [s]
    forces: Array  # F_set on each arc, shape (n_arcs,) [N]
    # ∫_0^start φ(start - s) F_set ds at the start of each arc: modal part, shape (n_arcs,
    # n_rates).
    gathered: Complex
    # The same less the equilibrium under the force of the arc, shape (n_arcs, n_rates).
    turning: Complex
    # impulse, double: As ``gathered`` for φ = 1 and ψ = τ, shape (n_arcs,) [N s], [N s²].
    impulse: Array
    double: Array


def gather_moments(motion: BangBangMotion) -> GatheredMoments:
    """Return the arcs of a motion with the moments at their starts.

    Source: variation of constants in modal coordinates.
    """
    rows = signals_of_moments(motion.plant, motion.problem)
    edges = np.concatenate(((0.0,), motion.switching_times, (motion.t_f,)))
    lengths = edges[1:] - edges[:-1]
    forces = np.full(lengths.size, motion.first_force)
    forces[1::2] = -motion.first_force
    steady = forces[:, np.newaxis] / rows.rates
    less_one = np.expm1(lengths[:, np.newaxis] * rows.rates)
    growth, gain = less_one + 1.0, less_one * steady
    known = [[0j] * rows.rates.size]
    for grown, gained in zip(growth[:-1].tolist(), gain[:-1].tolist(), strict=True):
        known.append([g * z + d for g, z, d in zip(grown, known[-1], gained, strict=True)])
    gathered = np.array(known)
    pushes = lengths * forces
    impulse = pushes.cumsum() - pushes
    doubled = lengths * (impulse + 0.5 * pushes)
    return GatheredMoments(
        rows=rows,
        lengths=lengths,
        forces=forces,
        gathered=gathered,
        turning=gathered + steady,
        impulse=impulse,
        double=doubled.cumsum() - doubled,
    )


def moments_at(motion: GatheredMoments, since: Array, arc: Index, less_one: Complex) -> Array:
    """Return the moments of the force up to some instants."""
    impulse, push = motion.impulse.take(arc), since * motion.forces.take(arc)
    modal = less_one * motion.turning.take(arc, axis=0)
    modal += motion.gathered.take(arc, axis=0)
    moments = np.empty((since.size, motion.rows.derivatives.shape[2]))
    # Of a real rate the imaginary part is void.
    moments[:, :-2] = modal.view(np.float64)[:, : moments.shape[1] - 2]
    moments[:, -2] = impulse + push
    moments[:, -1] = motion.double.take(arc) + since * (impulse + 0.5 * push)
    return moments


def signal_peaks(motion: GatheredMoments, grading: Grading) -> Array:
    """Return the largest magnitude of each of ``Plant.signals`` on [0, t_f].

    Source: cubic Hermite interpolation shows where a peak is possible; there Newton's method on
    the exact derivative.
    """
    rows, cells = motion.rows, _cells(motion, grading)
    cubics = _cubics(motion, cells)
    largest = np.abs(cubics.values).max(axis=1)
    signal, cell, share = _possible_peaks(cubics, largest)
    on, length = cells.arc.take(cell), cells.step.take(cell)
    since = cells.since.take(cell) + share * length
    less_one = np.expm1(since[:, np.newaxis] * rows.rates)
    there = moments_at(motion, since, on, less_one)
    series = (rows.derivatives.take(signal, axis=1) * there).sum(axis=2)
    series += rows.of_force.take(signal, axis=1) * motion.forces.take(on)
    value, slope, bend, jerk = series
    shift = -newton_quotient(slope, bend)
    # Where a fast pole has nearly decayed a cubic may see a peak that is none: stay in its place.
    shift *= np.abs(shift * jerk) <= NEAR * np.abs(bend)
    shift = np.minimum(np.maximum(shift, -share * length), (1.0 - share) * length)
    heights = np.abs(value + shift * (slope + shift * (bend / 2.0 + shift * jerk / 6.0)))
    for i, height in zip(signal.tolist(), heights.tolist(), strict=True):
        largest[i] = max(largest[i], height)
    return np.asarray(largest)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Cells:
    """The mesh for peaks: its cells in the order of time, and the end of the motion."""

    nodes: Array  # Times since the start of an arc, the same for all arcs, and last the end [s]
    index: Index  # Which of them is the start of each cell, and last the end, shape (n_cells + 1,)
    arc: Index  # Of each cell and of the end, shape (n_cells + 1,)
    # Start of each cell since the start of its arc, and the end, shape (n_cells + 1,) [s].
    since: Array
    step: Array  # Lengths, shape (n_cells,) [s]


def _cells(motion: GatheredMoments, grading: Grading) -> _Cells:
    """Return the mesh: a fast pole matters only for a while after each switch, for all arcs alike.

    So all arcs share one graded mesh.
    """
    lengths = motion.lengths
    graded = grading.nodes(float(lengths.max()), radians=RADIANS_PER_CELL)
    counts = np.maximum(graded.searchsorted(lengths), 1)
    ends = counts.cumsum()
    # The end of the motion counts as a cell of no length, whose start is a node of its own.
    nodes = np.concatenate((graded, lengths[-1:]))
    arc = np.arange(lengths.size).repeat(counts)
    arc = np.concatenate((arc, arc[-1:]))
    index = np.arange(arc.size) - (ends - counts).take(arc)
    index[-1] = graded.size
    since = nodes.take(index)
    step = since[1:] - since[:-1]
    last = ends - 1
    step[last] = lengths - since.take(last)
    return _Cells(nodes=nodes, index=index, arc=arc, since=since, step=step)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Cubics:
    """Cubics through the signals and their rates at the ends of the cells."""

    values: Array  # Shape (n_signals, n_cells + 1)
    # first, last: A third of the length times the rate at the start and end, shape
    # (n_signals, n_cells).
    first: Array
    last: Array


def _cubics(motion: GatheredMoments, cells: _Cells) -> _Cubics:
    rows = motion.rows
    less_one = np.expm1(cells.nodes[:, np.newaxis] * rows.rates)
    moments = moments_at(motion, cells.since, cells.arc, less_one.take(cells.index, axis=0))
    n_signals, n = rows.derivatives.shape[1:]
    both = rows.derivatives[:2].reshape(-1, n) @ moments.T
    rates, third = both[n_signals:], cells.step / 3.0
    first, last = third * rates[:, :-1], third * rates[:, 1:]
    push = third * motion.forces.take(cells.arc[:-1])
    # A signal on whose rate the set force acts at once has a rate that jumps with it.
    for i in rows.of_force[1].nonzero()[0].tolist():
        by_force = rows.of_force[1, i] * push
        first[i] += by_force
        last[i] += by_force
    return _Cubics(values=both[:n_signals], first=first, last=last)


def _possible_peaks(cubics: _Cubics, largest: Array) -> tuple[Index, Index, Array]:
    """Return signal, cell, and share of the cell where a magnitude may exceed the largest so far.

    A cubic stays within its control points.
    """
    left, right = cubics.values[:, :-1], cubics.values[:, 1:]
    inner = np.maximum(np.abs(left + cubics.first), np.abs(right - cubics.last))
    at = (inner >= (largest / (1.0 + SELECTION_MARGIN))[:, np.newaxis]).ravel().nonzero()[0]
    # A plateau is nearly largest everywhere, but its control points do not rise above its ends.
    signal = at // inner.shape[1]
    start = cubics.values.take(at + signal)
    end = cubics.values.take(at + signal + 1)
    outer = np.maximum(np.abs(start), np.abs(end)) + ROUNDOFF_MARGIN * largest.take(signal)
    rises = inner.take(at) > outer
    at, signal, start, end = at[rises], signal[rises], start[rises], end[rises]
    share = _peak_of_cubic(start, end, 3.0 * cubics.first.take(at), 3.0 * cubics.last.take(at))
    return signal, at % inner.shape[1], share


def _peak_of_cubic(left: Array, right: Array, first: Array, last: Array) -> Array:
    """Return where the magnitude of each cubic is largest, from 0 to 1."""
    square = 3.0 * (right - left) - 2.0 * first - last
    cube = first + last - 2.0 * (right - left)
    # Of the roots of first + 2 square s + 3 cube s² the one where |y| falls behind it, in the form
    # that does not cancel.
    root = np.sqrt(np.maximum(square * square - 3.0 * first * cube, 0.0))
    share = newton_quotient(first, np.copysign(root, left + right) - square)
    return np.asarray(np.minimum(np.maximum(share, 0.0), 1.0))
