"""The motion under a bang-bang force, in closed form, and its exact peaks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine import Positioning
from mtcommission.optimal.mesh import graded_nodes
from mtcommission.optimal.moments import MomentProblem, moment_problem, moment_rows
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.plant import Plant

Array = NDArray[np.float64]
Index = NDArray[np.intp]

RADIANS_PER_CELL = 0.4
"""First mesh for peaks against the fastest pole (empirical; the result does not depend on it)."""
REFINEMENTS = (16, 8)
"""Cells into which cells with a possible peak are divided: |p| h falls to 0.003, where cubic
interpolation is exact to 1e-13."""
SELECTION_MARGIN = 1e-3
"""Relative reserve for the error of the first mesh, (0.4)^4 / 384 = 7e-5 of the oscillation."""

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


def states_at(motion: BangBangMotion, t: Array, arc: Index) -> Array:
    """Return the states at times t, each on the arc with the given index.

    Parameters
    ----------
    motion
        The motion.
    t
        Shape (k,) [s].
    arc
        Index of the arc on which each time lies (its end counts, too), shape (k,).

    Returns
    -------
    ndarray, shape (k, n)
    """
    since = t - motion.starts[arc]
    force = motion.forces[arc]
    exponent = since[:, np.newaxis] * motion.problem.rates
    modal = np.exp(exponent) * motion.gathered[arc]
    modal += np.expm1(exponent) / motion.problem.rates * force[:, np.newaxis]
    impulse = motion.impulse[arc] + since * force
    double = motion.double[arc] + since * motion.impulse[arc] + 0.5 * since**2 * force
    columns = modal.view(np.float64)[:, : 2 * motion.problem.rates.size - 1]
    moments = np.column_stack([columns, impulse, double])
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

    Source: cubic Hermite interpolation, refined where its control polygon allows a peak.
    """
    lengths = np.diff(motion.starts, append=motion.t_f)
    # A fast pole matters only for a while after each switch.
    offsets = [
        graded_nodes(motion.problem, float(length), radians=RADIANS_PER_CELL) for length in lengths
    ]
    arc = np.repeat(np.arange(lengths.size), [nodes.size - 1 for nodes in offsets])
    step = np.concatenate([np.diff(nodes) for nodes in offsets])
    start = motion.starts[arc] + np.concatenate([nodes[:-1] for nodes in offsets])
    rows = signal_rows(motion.plant)
    largest = np.zeros(rows.shape[0])
    for parts in (*REFINEMENTS, 1):
        if not arc.size:
            return largest
        first, last = states_at(motion, start, arc), states_at(motion, start + step, arc)
        drive = np.outer(motion.forces[arc], motion.plant.B)
        rates = (
            (first @ motion.plant.A.T + drive) @ rows.T,
            (last @ motion.plant.A.T + drive) @ rows.T,
        )
        values = first @ rows.T, last @ rows.T
        largest = np.maximum(largest, np.abs(np.concatenate(values)).max(axis=0))
        if parts == 1:
            break
        keep = _may_peak(step, *values, *rates, largest=largest)
        index = np.tile(np.arange(parts), int(keep.sum()))
        arc, step = np.repeat(arc[keep], parts), np.repeat(step[keep] / parts, parts)
        start = np.repeat(start[keep], parts) + index * step
    inside = hermite_peaks(step, *values, start_rate=rates[0], end_rate=rates[1])
    return np.maximum(inside, largest)


def _may_peak(
    step: Array, first: Array, last: Array, first_rate: Array, last_rate: Array, *, largest: Array
) -> NDArray[np.bool_]:
    third = step[:, np.newaxis] / 3.0
    inner = np.maximum(np.abs(first + third * first_rate), np.abs(last - third * last_rate))
    # A plateau is nearly largest everywhere, but its control points do not rise above its ends.
    rises = inner > np.maximum(np.abs(first), np.abs(last)) + ROUNDOFF_MARGIN * largest
    return np.asarray(np.any(rises & (inner * (1.0 + SELECTION_MARGIN) >= largest), axis=1))
