"""The motion from rest under a force that changes its sign, in closed form, and its peaks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.closed_form import step_response
from mtcommission.optimal.free.mesh import graded_nodes
from mtcommission.optimal.free.moments import PLANTS, MomentProblem, all_moment_rows
from mtcommission.optimal.peaks import hermite_peaks, signal_rows

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

RADIANS_PER_CELL = 0.5
"""Mesh for peaks against the fastest pole: cubics through it err by 2e-4 of an oscillation."""
PARTS = 20
"""Of a cell that may hold a peak: cubics then err by 1e-9 of an oscillation."""
SELECTION_MARGIN = 1e-3
"""Relative reserve for the error of the coarse cubics."""
ROUNDOFF_MARGIN = 1e-13
"""Rise within a cell, against the peak, that is not worth a closer look."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BangBangMotion:
    """The motion from rest under a force that changes sign at given times."""

    plant: Plant  # The plant
    problem: MomentProblem  # A moment problem of it
    switching_times: Array  # Ascending, shape (n_switches,) [s]
    t_f: float  # End [s]
    first_force: float  # F_set on the first arc [N]

    def states_at(self, instants: Array) -> Array:
        """Return the states at some times, as sums of step responses: without the moments."""
        starts = np.concatenate(((0.0,), self.switching_times))
        steps = np.full(starts.size, -2.0 * self.first_force)
        steps[0], steps[2::2] = self.first_force, 2.0 * self.first_force
        # A step that is still to come has no response.
        responses = step_response(self.plant, instants[:, np.newaxis] - starts)
        return np.asarray(steps @ responses)

    @property
    def force_peak(self) -> float:
        """Largest magnitude of what is set [N]."""
        return abs(self.first_force)

    @property
    def peaks(self) -> Array:
        """Largest magnitude of each of ``Plant.signals`` on [0, t_f].

        Cubics show in which cells a peak is possible; there finer ones find it.
        """
        arcs = _arcs(self)
        nodes = graded_nodes(self.problem, float(arcs.lengths.max()), radians=RADIANS_PER_CELL)
        # A fast pole matters only for a while after each switch, for all arcs alike.
        counts = np.maximum(nodes.searchsorted(arcs.lengths), 1) + 1
        arc = np.arange(counts.size).repeat(counts)
        index = np.arange(arc.size) - (counts.cumsum() - counts).repeat(counts)
        since = np.minimum(nodes[index], arcs.lengths[arc])
        value, rate = _signals(arcs, arc, since)
        # From the end of an arc to the start of the next is a cell of no length.
        step = (since[1:] - since[:-1]) * (index[1:] > 0)
        size, third = np.abs(value), step[:, np.newaxis] / 3.0
        outer = np.maximum(size[:-1], size[1:])
        inner = np.maximum(
            np.abs(value[:-1] + third * rate[:-1]), np.abs(value[1:] - third * rate[1:])
        )
        largest = outer.max(axis=0)
        # A plateau is nearly largest everywhere, but its control points do not rise above its ends.
        rises = inner > outer + ROUNDOFF_MARGIN * largest
        chosen = ((inner >= (1.0 - SELECTION_MARGIN) * largest) & rises).any(axis=1)
        cell = chosen.nonzero()[0]
        if not cell.size:
            return np.asarray(largest)
        finer = step[cell] / PARTS
        at = since[cell, np.newaxis] + finer[:, np.newaxis] * np.arange(PARTS + 1)
        value, rate = _signals(arcs, arc[cell].repeat(PARTS + 1), at.ravel())
        start = np.arange(at.size).reshape(at.shape)[:, :-1].ravel()
        inside = hermite_peaks(
            finer.repeat(PARTS),
            value[start],
            value[start + 1],
            start_rate=rate[start],
            end_rate=rate[start + 1],
        )
        return np.asarray(np.maximum(largest, inside))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Arcs:
    """A bang-bang motion by its arcs, with the moments of the force up to each switch."""

    motion: BangBangMotion
    lengths: Array  # Shape (n_arcs,) [s]
    forces: Array  # F_set on each, shape (n_arcs,) [N]
    modal: Complex  # ∫_0^start e^{p(start - s)} F_set ds at the start of each, (n_arcs, n_rates)
    # impulse, double: The same of 1 and τ, shape (n_arcs,) [N s], [N s²].
    impulse: Array
    double: Array


def _arcs(motion: BangBangMotion) -> _Arcs:
    """Return the arcs of a motion.

    Source: variation of constants in modal coordinates.
    """
    rates = motion.problem.rates
    edges = np.concatenate(([0.0], motion.switching_times, [motion.t_f]))
    lengths = np.diff(edges)
    forces = np.full(lengths.size, motion.first_force)
    forces[1::2] *= -1.0
    less_one = np.expm1(np.multiply.outer(lengths, rates))
    gains = less_one * forces[:, np.newaxis] / rates
    modal = np.zeros_like(less_one)
    for i in range(lengths.size - 1):
        modal[i + 1] = modal[i] + less_one[i] * modal[i] + gains[i]
    pushes = lengths * forces
    impulse = pushes.cumsum() - pushes
    doubled = lengths * (impulse + 0.5 * pushes)
    return _Arcs(
        motion=motion,
        lengths=lengths,
        forces=forces,
        modal=modal,
        impulse=impulse,
        double=doubled.cumsum() - doubled,
    )


def _signals(arcs: _Arcs, arc: Index, since: Array) -> tuple[Array, Array]:
    """Return signals and their rates at times since the start of an arc, (n_times, n_signals)."""
    plant, rates = arcs.motion.plant, arcs.motion.problem.rates
    force, impulse = arcs.forces[arc], arcs.impulse[arc]
    less_one = np.expm1(np.multiply.outer(since, rates))
    modal = arcs.modal[arc] + less_one * (arcs.modal[arc] + force[:, np.newaxis] / rates)
    moments = np.empty((since.size, plant.order))
    # Of a real rate the imaginary part is void.
    moments[:, :-2] = modal.view(np.float64)[:, : plant.order - 2]
    moments[:, -2] = impulse + since * force
    moments[:, -1] = arcs.double[arc] + since * (impulse + 0.5 * since * force)
    of_moments, of_force = _rows_of_moments(plant)
    both = moments @ of_moments
    count = of_force.size
    rate = np.asarray(both[:, count:] + np.multiply.outer(force, of_force))
    return both[:, :count], rate


@lru_cache(maxsize=PLANTS)
def _rows_of_moments(plant: Plant) -> tuple[Array, Array]:
    """Return what takes moments to signals and their rates, (n, 2 n_signals), and F_set's share."""
    rows = signal_rows(plant)
    both = np.vstack([rows, rows @ plant.A])
    of_moments = np.linalg.solve(all_moment_rows(plant).T, both.T)
    return np.asarray(of_moments, dtype=np.float64), np.asarray(rows @ plant.B)
