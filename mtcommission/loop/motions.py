"""Setpoints on a loop by its poles: what they leave behind, and any signal at any cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.poles import LoopPoles
from mtcommission.setpoint.pieces import INSTANT, Pieces, cut, taylor
from mtcommission.setpoint.setpoint import JerkSteps

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Cycles = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signal:
    """What is seen of a loop: a row over the outputs of a velocity cycle, shape (n_outputs,).

    Less that derivative of the delayed setpoint (0: position); None: as it is.
    """

    row: Array
    less: int | None = None


OUTPUTS, TOOL, FORCE = 3, 0, 2
"""Outputs of a velocity cycle before the plant's states: tcp, encoder, force; places of two."""


def tool_deviation(order: int) -> Signal:
    """Return the tool's deviation from the delayed setpoint [m], of a plant of some order."""
    return Signal(row=np.eye(order + OUTPUTS)[TOOL], less=0)


def output_of_states(row: Array) -> Array:
    """Return a row over the outputs of a velocity cycle from one over the plant's states."""
    return np.concatenate([np.zeros(OUTPUTS), row])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motions:
    """Setpoints on a loop: steps in rising order, and what of them the poles hold."""

    poles: LoopPoles
    steps: JerkSteps
    first: Cycles  # sample at which each step is seen first, (n_setpoints, n_steps)
    basis: Array  # weights of -S_q, -S_(q-1), ... at that sample, (n_setpoints, n_steps, q + 1)
    held: Complex  # of all steps up to each, ``forced`` cycles after its first sample,
    # (n_steps, n_setpoints, n_corners, n_poles)

    @property
    def order(self) -> int:
        """Which derivative steps."""
        return self.steps.order


def set_in_motion(poles: LoopPoles, steps: JerkSteps) -> Motions:
    """Return setpoints on a loop, ready to be asked for outputs."""
    rising = np.argsort(steps.times, axis=1, kind="stable")
    times = np.take_along_axis(steps.times, rising, axis=1)
    sizes = np.take_along_axis(steps.steps, rising, axis=1)
    q = steps.order
    first = np.ceil((times - INSTANT) / poles.dt).astype(np.int64)
    basis = _basis(sizes, first * poles.dt - times, q)
    starts = poles.starts[q::-1].reshape(q + 1, -1)  # by the power of s
    new = (basis.reshape(-1, q + 1) @ starts).reshape(*sizes.shape, *poles.factors.shape)
    faded = poles.power(np.diff(first, axis=1))
    held = np.empty((sizes.shape[1], len(sizes), *poles.factors.shape), dtype=complex)
    for j in range(len(held)):
        held[j] = new[:, j] + held[j - 1] * faded[:, j - 1] if j else new[:, j]
    own = JerkSteps(times=times, steps=sizes, order=q)
    return Motions(poles=poles, steps=own, first=first, basis=basis, held=held)


def _basis(sizes: Array, early: Array, order: int) -> Array:
    """Weights of -S_q, -S_(q-1), ... a time after steps of some sizes."""
    basis = np.empty((*sizes.shape, order + 1))
    basis[..., 0] = sizes
    for b in range(1, order + 1):
        basis[..., b] = basis[..., b - 1] * early / b
    return basis


def outputs_at(motions: Motions, n: Cycles, rows: Array) -> Array:
    """Return signals in some position cycles of each setpoint.

    ``n``: shape (n_setpoints, n_times); ``rows``: over the outputs of a velocity cycle, shape
    (n_rows, n_outputs). Result: (n_setpoints, n_corners, n_times, cycles, n_rows).
    """
    setpoint = np.repeat(np.arange(len(n)), n.shape[1])
    parts = np.arange(motions.poles.cycles)
    found = signals_at(motions, pieces_of(motions), setpoint, n.ravel(), np.atleast_2d(rows), parts)
    return np.moveaxis(found.reshape(*n.shape, *found.shape[1:]), 2, 1)


def pieces_of(motions: Motions) -> Pieces:
    """Return the setpoints as polynomials between their steps."""
    steps = motions.steps
    return cut(steps.times, steps.steps, order=steps.order)


def signals_at(
    motions: Motions, pieces: Pieces, setpoint: Cycles, n: Cycles, rows: Array, parts: Cycles
) -> Array:
    """Signals of some setpoints at some cycles, (n_times, n_corners, n_parts, n_rows)."""
    q = motions.order
    x = sampled(pieces, setpoint, np.asarray(n * motions.poles.dt), q + 1)
    steady = rows @ motions.poles.steady[:, parts, :, : q + 1]
    found = transients(motions, setpoint, n, rows, parts)
    found += (x.T @ steady.reshape(-1, q + 1).T).reshape(found.shape)
    return found


def transients(
    motions: Motions,
    setpoint: Cycles,
    n: Cycles,
    rows: Array,
    parts: Cycles,
    *,
    all_steps: bool = False,
) -> Array:
    """What the loop has beside its polynomial, (n_times, n_corners, n_parts, n_rows).

    ``all_steps``: beside that of all steps, those to come included, continued backwards.
    """
    poles, q = motions.poles, motions.order
    found = np.zeros((len(n), len(poles.loops) * len(parts) * len(rows)))
    # The last step that the poles alone tell of, and those since.
    age = n[:, None] - motions.first[setpoint]
    told = np.sum(age >= poles.forced, axis=1)
    far = np.flatnonzero(told)
    if poles.factors.size and len(far):
        last = told[far] - 1
        state = motions.held[last, setpoint[far]] * poles.power(age[far, last] - poles.forced)
        shapes = rows @ poles.shapes[:, parts]
        found[far] = seen(state, shapes.reshape(len(shapes), -1, shapes.shape[3])).reshape(
            len(far), -1
        )
    table = (rows @ poles.table[:, :, parts][..., q::-1]).reshape(len(poles.table), -1, q + 1)
    time, step = np.nonzero(age < poles.forced if all_steps else (age >= 0) & (age < poles.forced))
    if len(time):
        own, basis = setpoint[time], motions.basis[setpoint[time], step]
        to_come = np.flatnonzero(age[time, step] < 0)
        if len(to_come):
            place = own[to_come], step[to_come]
            early = n[time[to_come]] * poles.dt - motions.steps.times[place]
            basis[to_come] = _basis(motions.steps.steps[place], early, q)
        each = np.einsum("pxb,pb->px", table[np.maximum(age[time, step], 0)], basis)
        begins = np.flatnonzero(np.diff(time, prepend=-1))
        found[time[begins]] += np.add.reduceat(each, begins, axis=0)
    return found.reshape(len(n), len(poles.loops), len(parts), len(rows))


def seen(state: Complex, shapes: Complex) -> Array:
    """Return signals of modal states, shapes (n, n_corners, n_p), (n_corners, n_signals, n_p)."""
    by_corner = np.concatenate([state.real, state.imag], axis=2).transpose(1, 0, 2)
    by_part = np.concatenate([shapes.real, -shapes.imag], axis=2).transpose(0, 2, 1)
    return np.asarray((by_corner @ by_part).transpose(1, 0, 2))


def wanted(pieces: Pieces, setpoint: Cycles, t: Array, derivative: int) -> Array:
    """A derivative of each setpoint at times of its own, shape of ``t``."""
    found = sampled(pieces, setpoint, t.ravel(), derivative + 1)[derivative]
    return np.asarray(found.reshape(t.shape))


def sampled(pieces: Pieces, setpoint: Cycles, t: Array, derivatives: int) -> Array:
    """Position and derivatives of each setpoint at a time of its own, (derivatives, n_times)."""
    knots, values = pieces.knots, pieces.values
    piece = np.sum(t >= knots[:, setpoint] - INSTANT, axis=0)
    age = t - knots[np.maximum(piece - 1, 0), setpoint]
    own = values[piece, :, setpoint].T
    found = np.zeros((derivatives, len(t)))
    for k in range(min(derivatives, len(own))):
        found[k] = taylor(own[k:], age)
    return found
