"""Setpoints on a loop by its poles: what they leave behind, and any signal at any cycle."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from mtcommission.loop.poles import LoopPoles, once_for_rows
from mtcommission.setpoint.pieces import INSTANT, Pieces, cut
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
    """Setpoints on a loop: steps in rising order, and the modal states that they leave."""

    poles: LoopPoles
    steps: JerkSteps
    first: Cycles  # sample at which each step is seen first, (n_setpoints, n_steps)
    basis: Array  # weights of -S_q, -S_(q-1), ... at that sample, (n_setpoints, n_steps, q + 1)
    modal: Complex
    """Modal states by all steps up to each, ``recent`` cycles after its first sample, (n_steps,
    n_setpoints, n_corners, n_poles)."""

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
    modal = np.empty((sizes.shape[1], len(sizes), *poles.factors.shape), dtype=complex)
    for j in range(len(modal)):
        modal[j] = new[:, j] + modal[j - 1] * faded[:, j - 1] if j else new[:, j]
    own = JerkSteps(times=times, steps=sizes, order=q)
    return Motions(poles=poles, steps=own, first=first, basis=basis, modal=modal)


def _basis(sizes: Array, early: Array, order: int) -> Array:
    """Weights of -S_q, -S_(q-1), ... a time after steps of some sizes."""
    basis = np.empty((*sizes.shape, order + 1))
    basis[..., 0] = sizes
    for b in range(1, order + 1):
        basis[..., b] = basis[..., b - 1] * early / b
    return basis


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class View:
    """A loop as some signals see it in some velocity cycles of a position cycle.

    What is seen stands in the order (n_corners, n_parts, n_rows).
    """

    table: Array  # by cycles since a step and power of s, ((q + 1) recent, n_seen)
    shapes: Array  # by Re and Im of modal states, (n_corners, 2 n_poles, n_parts n_rows)
    steady: Array  # by derivative of the setpoint, (q + 1, n_seen)


@once_for_rows
def _look(poles: LoopPoles, rows: Array, parts: tuple[int, ...], order: int) -> View:
    own = list(parts)
    table = rows @ poles.table[:, :, own, :, order::-1]
    steady = (rows @ poles.steady[:, own, :, : order + 1]).reshape(-1, order + 1).T
    return View(
        table=np.moveaxis(table, -1, 1).reshape((order + 1) * poles.recent, -1),
        shapes=by_parts(rows @ poles.shapes[:, own]),
        steady=np.ascontiguousarray(steady),
    )


def by_parts(shapes: Complex) -> Array:
    """Return signals by pole, (n_corners, ..., n_poles), by Re and Im of modal states."""
    flat = shapes.reshape(len(shapes), prod(shapes.shape[1:-1]), shapes.shape[-1])
    parts = np.concatenate([flat.real, -flat.imag], axis=2)
    return np.ascontiguousarray(parts.transpose(0, 2, 1))


def seen(state: Complex, shapes: Array, *, out: Array | None = None) -> Array:
    """Return signals of modal states, (n_corners, n, n_seen); ``shapes`` from ``by_parts``."""
    parts = np.concatenate([state.real, state.imag], axis=2).transpose(1, 0, 2)
    return np.asarray(np.matmul(parts, shapes, out=out))


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
    q, t = motions.order, np.asarray(n * motions.poles.dt)
    x = pieces.sample(t, derivatives=q + 1, setpoint=setpoint)
    view = _look(motions.poles, rows, tuple(parts.tolist()), q)
    found = transients(motions, setpoint, n, rows, parts)
    found += (x.T @ view.steady).reshape(found.shape)
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
    view = _look(poles, rows, tuple(parts.tolist()), q)
    age = n[:, None] - motions.first[setpoint]
    # The steps that the table tells of, ...
    is_near = age < poles.recent if all_steps else (age >= 0) & (age < poles.recent)
    time, step = np.nonzero(is_near)
    since, basis = age[time, step], motions.basis[setpoint[time], step]
    to_come = np.flatnonzero(since < 0)
    if len(to_come):
        place = setpoint[time[to_come]], step[to_come]
        early = n[time[to_come]] * poles.dt - motions.steps.times[place]
        basis[to_come] = _basis(motions.steps.steps[place], early, q)
    column = (q + 1) * np.maximum(since, 0)[:, None] + np.arange(q + 1)
    ends = (q + 1) * np.append(0, np.cumsum(is_near.sum(axis=1)))
    weights = csr_array(
        (basis.ravel(), column.ravel(), ends), shape=(len(n), (q + 1) * poles.recent)
    )
    found = np.asarray(weights @ view.table)
    # ... and those that the poles tell of, up to the last one.
    told = np.sum(age >= poles.recent, axis=1)
    far = np.flatnonzero(told)
    if poles.factors.size and len(far):
        last = told[far] - 1
        state = motions.modal[last, setpoint[far]] * poles.power(age[far, last] - poles.recent)
        found[far] += seen(state, view.shapes).transpose(1, 0, 2).reshape(len(far), -1)
    return found.reshape(len(n), len(poles.loops), len(parts), len(rows))


def wanted(pieces: Pieces, setpoint: Cycles, t: Array, derivative: int) -> Array:
    """A derivative of each setpoint at times of its own, shape of ``t``."""
    found = pieces.sample(t.ravel(), derivatives=derivative + 1, setpoint=setpoint)[derivative]
    return np.asarray(found.reshape(t.shape))
