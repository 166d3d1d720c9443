"""The motion under a bang-bang force, in closed form, and its exact peaks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine import Positioning
from mtcommission.optimal.mesh import graded_nodes
from mtcommission.optimal.moments import MomentProblem, moment_problem, moment_rows
from mtcommission.optimal.peaks import signal_rows
from mtcommission.optimal.switching import newton_quotient
from mtcommission.plant import Plant

Array = NDArray[np.float64]
Index = NDArray[np.intp]

RADIANS_PER_CELL = 0.25
"""Mesh for peaks against the fastest pole (empirical): cubics through it err by 1e-5 of an
oscillation and by 1e-4 of a radian in the place of its peak; Newton's parabola there then errs by
the cube of that."""
PLANTS = 32
"""Plants whose rows are kept."""
SELECTION_MARGIN = 1e-3
"""Relative reserve for the error of the mesh."""
ROUNDOFF_MARGIN = 1e-13
"""Rise within a cell, against the peak, that is not worth a closer look."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SignalRows:
    """Signals of a plant and their derivatives, from the moments of the force.

    Parameters
    ----------
    problem
        Moment functions with ψ = τ, so that every state follows from the moments.
    values, slopes, bends
        Rows that take the moments to the signals, their first and second derivatives but for
        the force's own part, shape (n_signals, n).
    slope_of_force, bend_of_force
        That part per newton of F_set, shape (n_signals,).
    """

    problem: MomentProblem
    values: Array
    slopes: Array
    bends: Array
    slope_of_force: Array
    bend_of_force: Array


@lru_cache(maxsize=PLANTS)
def signals_of_moments(plant: Plant) -> SignalRows:
    """Return how ``Plant.signals`` follow from moments.

    Parameters
    ----------
    plant
        Plant with n states.

    Returns
    -------
    SignalRows
    """
    problem = moment_problem(plant, Positioning(distance=1.0))
    states = np.linalg.inv(moment_rows(plant, problem))
    rows = signal_rows(plant)
    slopes = rows @ plant.A
    return SignalRows(
        problem=problem,
        values=rows @ states,
        slopes=slopes @ states,
        bends=slopes @ plant.A @ states,
        slope_of_force=rows @ plant.B,
        bend_of_force=slopes @ plant.B,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BangBangMotion:
    """A bang-bang force from rest, with the moments gathered up to each switch.

    Parameters
    ----------
    rows
        Signals of the plant.
    starts
        Starts of the arcs, shape (n_arcs,) [s].
    t_f
        End of the last arc [s].
    forces
        F_set on each arc, shape (n_arcs,) [N].
    gathered
        ∫_0^start φ(start - s) F_set ds at each start: modal part, shape (n_arcs, n_rates).
    impulse, double
        The same for φ = 1 and ψ = τ, shape (n_arcs,) [N s], [N s²].
    """

    rows: SignalRows
    starts: Array
    t_f: float
    forces: Array
    gathered: NDArray[np.complex128]
    impulse: Array
    double: Array


def bang_bang_motion(
    plant: Plant, switching_times: Array, *, t_f: float, first_force: float
) -> BangBangMotion:
    """Return the motion under a force that changes sign at the given times.

    Parameters
    ----------
    plant
        The plant, at rest at t = 0.
    switching_times
        Ascending, shape (n_switches,) [s].
    t_f
        End [s].
    first_force
        F_set on the first arc [N].

    Returns
    -------
    BangBangMotion

    Source: variation of constants in modal coordinates.
    """
    rows, count = signals_of_moments(plant), switching_times.size + 1
    rates = rows.problem.rates
    starts = np.zeros(count)
    starts[1:] = switching_times
    forces = np.full(count, first_force)
    forces[1::2] = -first_force
    lengths = starts[1:] - starts[:-1]
    less_one = np.expm1(lengths[:, np.newaxis] * rates)
    growth, gain = less_one + 1.0, less_one / rates * forces[:-1, np.newaxis]
    gathered = np.zeros((count, rates.size), dtype=complex)
    for i in range(count - 1):
        gathered[i + 1] = growth[i] * gathered[i] + gain[i]
    pushes = lengths * forces[:-1]
    impulse, double = np.zeros(count), np.zeros(count)
    pushes.cumsum(out=impulse[1:])
    (lengths * (impulse[:-1] + 0.5 * pushes)).cumsum(out=double[1:])
    return BangBangMotion(
        rows=rows,
        starts=starts,
        t_f=t_f,
        forces=forces,
        gathered=gathered,
        impulse=impulse,
        double=double,
    )


def moments_at(motion: BangBangMotion, since: Array, arc: Index) -> Array:
    """Return the moments of the force up to some instants.

    Parameters
    ----------
    motion
        The motion.
    since
        Time since the start of the arc, up to its end, shape (k,) [s].
    arc
        Index of each arc, shape (k,).

    Returns
    -------
    ndarray, shape (k, n)
    """
    rates, force, impulse = motion.rows.problem.rates, motion.forces[arc], motion.impulse[arc]
    less_one = np.expm1(since[:, np.newaxis] * rates)
    steady = motion.forces[:, np.newaxis] / rates
    modal = less_one * (motion.gathered + steady)[arc] + motion.gathered[arc]
    moments = np.empty((since.size, 2 * rates.size + 1))
    moments[:, :-1] = modal.view(np.float64)
    moments[:, -2] = impulse + since * force
    moments[:, -1] = motion.double[arc] + since * (impulse + 0.5 * since * force)
    return moments


def signal_peaks(motion: BangBangMotion) -> Array:
    """Return the largest magnitude of each of ``Plant.signals`` on [0, t_f].

    Parameters
    ----------
    motion
        The motion.

    Returns
    -------
    ndarray, shape (n_signals,)

    Source: cubic Hermite interpolation shows where a peak is possible; there Newton's method on
    the exact derivative.
    """
    arc, since, step = _cells(motion)
    rows = motion.rows
    end = np.append(since, motion.t_f - motion.starts[-1])
    moments = moments_at(motion, end, np.append(arc, arc[-1]))
    values, rates = moments @ rows.values.T, moments @ rows.slopes.T
    drive, h = motion.forces[arc, np.newaxis] * rows.slope_of_force, step[:, np.newaxis]
    first, last = h * (rates[:-1] + drive), h * (rates[1:] + drive)
    size = np.abs(values)
    largest = size.max(axis=0)
    cell, signal = np.nonzero(_may_peak(values, size, first, last, largest))
    if not cell.size:
        return np.asarray(largest)
    at = cell, signal
    share = _peak_of_cubic(values[at], values[cell + 1, signal], first[at], last[at])
    on, length = arc[cell], step[cell]
    there = moments_at(motion, since[cell] + share * length, on)
    slope = (there * rows.slopes[signal]).sum(axis=1)
    slope += motion.forces[on] * rows.slope_of_force[signal]
    bend = (there * rows.bends[signal]).sum(axis=1)
    bend += motion.forces[on] * rows.bend_of_force[signal]
    shift = -newton_quotient(slope, bend)
    shift = np.minimum(np.maximum(shift, -share * length), (1.0 - share) * length)
    inside = (there * rows.values[signal]).sum(axis=1) + shift * (slope + 0.5 * shift * bend)
    np.maximum.at(largest, signal, np.abs(inside))
    return np.asarray(largest)


def _cells(motion: BangBangMotion) -> tuple[Index, Array, Array]:
    """Return arc, start since the start of the arc, and length of the cells of the mesh.

    A fast pole matters only for a while after each switch, so all arcs share one graded mesh.
    """
    lengths = np.append(motion.starts[1:], motion.t_f) - motion.starts
    nodes = graded_nodes(motion.rows.problem, float(lengths.max()), radians=RADIANS_PER_CELL)
    counts = np.maximum(nodes.searchsorted(lengths), 1)
    arc = np.repeat(np.arange(lengths.size), counts)
    index = np.arange(arc.size) - np.repeat(np.cumsum(counts) - counts, counts)
    since = nodes[index]
    return arc, since, np.minimum(nodes[index + 1], lengths[arc]) - since


def _may_peak(
    values: Array, size: Array, first: Array, last: Array, largest: Array
) -> NDArray[np.bool_]:
    inner = np.maximum(np.abs(values[:-1] + first / 3.0), np.abs(values[1:] - last / 3.0))
    # A plateau is nearly largest everywhere, but its control points do not rise above its ends.
    rises = inner > np.maximum(size[:-1], size[1:]) + ROUNDOFF_MARGIN * largest
    return np.asarray(rises & (inner * (1.0 + SELECTION_MARGIN) >= largest))


def _peak_of_cubic(left: Array, right: Array, first: Array, last: Array) -> Array:
    """Return where the magnitude of each cubic is largest, from 0 to 1."""
    square = 3.0 * (right - left) - 2.0 * first - last
    cube = first + last - 2.0 * (right - left)
    # Both roots of first + 2 square s + 3 cube s², in the form that does not cancel.
    q = -(square + np.copysign(np.sqrt(np.maximum(square**2 - 3.0 * first * cube, 0.0)), square))
    roots = np.array([newton_quotient(q, 3.0 * cube), newton_quotient(first, q)])
    share = np.minimum(np.maximum(roots, 0.0), 1.0)
    height = np.abs(left + share * (first + share * (square + share * cube)))
    return np.asarray(np.where(height[0] > height[1], share[0], share[1]))
