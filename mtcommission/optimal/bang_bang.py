"""The motion under a bang-bang force, in closed form, and its exact peaks."""

from __future__ import annotations

from dataclasses import dataclass

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
SELECTION_MARGIN = 1e-3
"""Relative reserve for the error of the mesh."""
ROUNDOFF_MARGIN = 1e-13
"""Rise within a cell, against the peak, that is not worth a closer look."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BangBangMotion:
    """A bang-bang force from rest, with the moments gathered up to each switch.

    Parameters
    ----------
    plant
        The plant.
    starts
        Starts of the arcs, shape (n_arcs,) [s].
    t_f
        End of the last arc [s].
    forces
        F_set on each arc, shape (n_arcs,) [N].
    problem
        Moment functions with ψ = τ, so that every state follows from the moments.
    states_of_moments
        Matrix that takes all moments up to a time to the states then, shape (n, n).
    gathered
        ∫_0^start φ(start - s) F_set ds at each start: modal part, shape (n_arcs, n_rates).
    impulse, double
        The same for φ = 1 and ψ = τ, shape (n_arcs,) [N s], [N s²].
    """

    plant: Plant
    starts: Array
    t_f: float
    forces: Array
    problem: MomentProblem
    states_of_moments: Array
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
    problem = moment_problem(plant, Positioning(distance=1.0))
    starts = np.append(0.0, switching_times)
    forces = first_force * (-1.0) ** np.arange(starts.size)
    lengths = np.diff(starts)
    growth = np.exp(lengths[:, np.newaxis] * problem.rates)
    gain = np.expm1(lengths[:, np.newaxis] * problem.rates) / problem.rates
    gathered = np.zeros((starts.size, problem.rates.size), dtype=complex)
    for i in range(lengths.size):
        gathered[i + 1] = growth[i] * gathered[i] + gain[i] * forces[i]
    impulse = np.append(0.0, np.cumsum(lengths * forces[:-1]))
    steps = lengths * impulse[:-1] + 0.5 * lengths**2 * forces[:-1]
    return BangBangMotion(
        plant=plant,
        starts=starts,
        t_f=t_f,
        forces=np.asarray(forces),
        problem=problem,
        states_of_moments=np.asarray(np.linalg.inv(moment_rows(plant, problem))),
        gathered=gathered,
        impulse=impulse,
        double=np.append(0.0, np.cumsum(steps)),
    )


def states_at(motion: BangBangMotion, since: Array, arc: Index) -> Array:
    """Return the states on the arcs with the given indices.

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
    rates, force, impulse = motion.problem.rates, motion.forces[arc], motion.impulse[arc]
    less_one = np.expm1(since[:, np.newaxis] * rates)
    modal = (less_one + 1.0) * motion.gathered[arc] + less_one * (force[:, np.newaxis] / rates)
    moments = np.empty((since.size, 2 * rates.size + 1))
    moments[:, :-1] = modal.view(np.float64)
    moments[:, -2] = impulse + since * force
    moments[:, -1] = motion.double[arc] + since * (impulse + 0.5 * since * force)
    return np.asarray(moments @ motion.states_of_moments.T)


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
    rows = signal_rows(motion.plant)
    end = np.append(since, motion.t_f - motion.starts[-1])
    states = states_at(motion, end, np.append(arc, arc[-1]))
    slopes, jumps = rows @ motion.plant.A, rows @ motion.plant.B
    values, rates = states @ rows.T, states @ slopes.T
    drive, h = motion.forces[arc, np.newaxis] * jumps, step[:, np.newaxis]
    first, last = h * (rates[:-1] + drive), h * (rates[1:] + drive)
    largest = np.abs(values).max(axis=0)
    cell, signal = np.nonzero(_may_peak(values, first, last, largest))
    if not cell.size:
        return np.asarray(largest)
    at = cell, signal
    share = _peak_of_cubic(values[at], values[cell + 1, signal], first[at], last[at])
    on = arc[cell]
    x = states_at(motion, since[cell] + share * step[cell], on)
    rate = x @ motion.plant.A.T + motion.forces[on, np.newaxis] * motion.plant.B
    slope, bend = ((rate * weights).sum(axis=1) for weights in (rows[signal], slopes[signal]))
    most = np.array([-share, 1.0 - share]) * step[cell]
    shift = np.minimum(np.maximum(-newton_quotient(slope, bend), most[0]), most[1])
    inside = (x * rows[signal]).sum(axis=1) + shift * (slope + 0.5 * shift * bend)
    np.maximum.at(largest, signal, np.abs(inside))
    return np.asarray(largest)


def _cells(motion: BangBangMotion) -> tuple[Index, Array, Array]:
    """Return arc, start since the start of the arc, and length of the cells of the mesh.

    A fast pole matters only for a while after each switch, so all arcs share one graded mesh.
    """
    lengths = np.diff(motion.starts, append=motion.t_f)
    nodes = graded_nodes(motion.problem, float(lengths.max()), radians=RADIANS_PER_CELL)
    counts = np.maximum(nodes.searchsorted(lengths), 1)
    arc = np.repeat(np.arange(lengths.size), counts)
    index = np.arange(arc.size) - np.repeat(np.cumsum(counts) - counts, counts)
    since = nodes[index]
    return arc, since, np.minimum(nodes[index + 1], lengths[arc]) - since


def _may_peak(values: Array, first: Array, last: Array, largest: Array) -> NDArray[np.bool_]:
    size = np.abs(values)
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
