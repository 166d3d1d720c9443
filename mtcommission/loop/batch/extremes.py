"""Peaks and RMS force of setpoints while they move, by simulating them side by side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import LiftedLoop, SampledLoop
from mtcommission.loop.simulate.mean_force import rms_force, sum_free_force, window_shares
from mtcommission.loop.simulate.response import steady_state
from mtcommission.setpoint.setpoint import INSTANT, JerkSteps

Array = NDArray[np.float64]

BLOCK = 32
"""Position cycles whose outputs are computed together: keeps them in the cache."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extremes:
    """What a setpoint demands of one loop while it moves.

    Parameters
    ----------
    peaks
        Largest magnitude of each signal, shape (n_limits, n_signals).
    deviation
        Largest |e| of the tool, shape (n_limits,) [m]; nan where it was not asked for.
    rms_force
        Of the motor over [0, t_e + dwell], static load included in its worse direction, shape
        (n_limits,) [N]; nan without dwell.
    """

    peaks: Array
    deviation: Array
    rms_force: Array


def find_extremes(
    loop: SampledLoop,
    steps: JerkSteps,
    *,
    signals: Array,
    dwell: float | None,
    tail: float,
    static_load: float = 0.0,
    with_deviation: bool = False,
) -> Extremes:
    """Return peaks and RMS force of a moderate number of setpoints on one loop.

    Parameters
    ----------
    loop
        Under its controller; the last of its outputs per velocity cycle is the motor force.
    steps
        Of the setpoints.
    signals
        Rows over the outputs of one velocity cycle, shape (n_signals, n_outputs).
    dwell
        Rest after the setpoint that counts for the RMS force [s]; None: it is not wanted.
    tail
        Free motion looked at after the longest setpoint [s].
    static_load
        That the motor bears besides [N].
    with_deviation
        Whether the tool's deviation from the delayed setpoint is wanted.

    Returns
    -------
    Extremes
    """
    lifted = loop.lifted
    per_cycle, count = signals.shape[1], len(steps.times)
    rows = len(lifted.outputs) // per_cycle
    step = lifted.dt / rows
    C = lifted.C.reshape(rows, per_cycle, -1)
    C_s, C_f = (signals @ C).reshape(-1, len(lifted.A)), C[:, -1]
    window = steps.duration + (dwell or 0.0)
    largest, deviation = np.zeros((len(C_s), count)), np.zeros(count)
    first, square = np.zeros((2, count))
    for t, history in _move(lifted, steps, tail=tail):
        # What a position cycle computes acts in the next one, so no reference feeds through.
        motion, before = C_s @ history[:-1], step * np.arange(rows)
        np.maximum(largest, np.abs(motion, out=motion).max(axis=0), out=largest)
        if with_deviation:
            ages = np.add.outer(t, before - loop.controller.reference_delay)
            e = C[:, 0] @ history[:-1] - _positions(steps, ages)
            np.maximum(deviation, np.abs(e, out=e).max(axis=(0, 1)), out=deviation)
        if dwell is not None:
            force = C_f @ history[:-1]
            share = window_shares(np.add.outer(t, before)[:, :, None], window, step=step)
            first += (share * force).sum(axis=(0, 1))
            square += (share * force**2).sum(axis=(0, 1))
    if dwell is not None:
        until = t[-1] + lifted.dt
        following = _references(steps, np.array([until]))[0, :2]
        left = sum_free_force(
            lifted, history[-1] - steady_state(lifted) @ following, window - until, cycles=rows
        )
        first, square = first + left.first, square + left.square
    rms = rms_force(first, square, window=window, static_load=static_load)
    return Extremes(
        peaks=largest.reshape(rows, len(signals), -1).max(axis=0).T,
        deviation=deviation if with_deviation else np.full(count, np.nan),
        rms_force=rms if dwell is not None else np.full(count, np.nan),
    )


def _move(lifted: LiftedLoop, steps: JerkSteps, *, tail: float) -> Iterator[tuple[Array, Array]]:
    """Yield the times of some position cycles, shape (n_times,), and the states there.

    These of shape (n_times + 1, n, n_limits), the state after the last of them included.
    """
    X = np.zeros((len(lifted.A), len(steps.times)))
    count = int(np.ceil((float(np.max(steps.duration)) + tail) / lifted.dt))
    for start in range(0, count, BLOCK):
        t = lifted.dt * np.arange(start, min(start + BLOCK, count), dtype=np.float64)
        drive = lifted.B @ _references(steps, t)
        history = np.empty((len(t) + 1, *X.shape))
        history[0] = X
        for i in range(len(t)):
            np.matmul(lifted.A, history[i], out=history[i + 1])
            history[i + 1] += drive[i]
        X = history[-1]
        yield t, history


def _references(steps: JerkSteps, t: Array) -> Array:
    """x_ref, v_ref, a_ref, j_ref of all setpoints at the times t, (n_times, 4, n_limits)."""
    # The few steps go first: numpy adds along the first axis far quicker than along the last.
    age = t[:, None] - steps.times.T[:, None, :]
    term = steps.steps.T[:, None, :] * (age >= -INSTANT)
    age = np.maximum(age, 0.0)
    result, order = np.zeros((len(t), 4, len(steps.times))), steps.order
    for power in range(order + 1):
        if power:
            term = term * age / power
        if order - power < 4:
            result[:, order - power] = term.sum(axis=0)
    return result


def _positions(steps: JerkSteps, t: Array) -> Array:
    """x_ref of all setpoints at the times t of any shape, shape (*t.shape, n_limits)."""
    x, order = np.zeros((*t.shape, len(steps.times))), steps.order
    for time, size in zip(steps.times.T, steps.steps.T, strict=True):
        age = np.maximum(t[..., None] - time, 0.0)
        term = size * age
        for _ in range(order - 1):
            term *= age  # numpy's power takes five times as long
        x += term
    return x / factorial(order)
