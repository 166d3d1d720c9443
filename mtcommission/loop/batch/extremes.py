"""Peaks and mean forces of setpoints while they move, by simulating them side by side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import LiftedLoop, SampledLoop
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
    mean_force, mean_square_force
        Of the motor force over [0, t_e + dwell], shape (n_limits,) [N, N²]; nan without dwell.
    """

    peaks: Array
    mean_force: Array
    mean_square_force: Array


def find_extremes(
    loop: SampledLoop,
    steps: JerkSteps,
    *,
    signals: Array,
    order: int,
    dwell: float | None,
    tail: float,
) -> Extremes:
    """Return peaks and mean forces of a moderate number of setpoints on one loop.

    Parameters
    ----------
    loop
        Under its controller; the last of its outputs per velocity cycle is the motor force.
    steps
        Steps of the derivative ``order``.
    signals
        Rows over the outputs of one velocity cycle, shape (n_signals, n_outputs).
    order
        3 jerk, 4 snap.
    dwell
        Rest after the setpoint that counts for the means [s]; None: they are not wanted.
    tail
        Free motion looked at after the longest setpoint [s].

    Returns
    -------
    Extremes
    """
    lifted = loop.lifted
    per_cycle, count = signals.shape[1], len(steps.times)
    rows = len(lifted.outputs) // per_cycle
    C = lifted.C.reshape(rows, per_cycle, -1)
    C_s, C_f = (signals @ C).reshape(-1, len(lifted.A)), C[:, -1]
    window = steps.duration + (dwell or 0.0)
    largest = np.zeros((len(C_s), count))
    first, second = np.full((2, count), np.nan if dwell is None else 0.0)
    for t, history in _move(lifted, steps, order=order, tail=tail):
        # What a position cycle computes acts in the next one, so no reference feeds through.
        motion = C_s @ history
        np.maximum(largest, np.abs(motion, out=motion).max(axis=0), out=largest)
        if dwell is not None:
            force = C_f @ history
            share = _shares(t, window, dt=lifted.dt, rows=rows)
            first += (share * force).sum(axis=(0, 1))
            second += (share * force**2).sum(axis=(0, 1))
    return Extremes(
        peaks=largest.reshape(rows, len(signals), -1).max(axis=0).T,
        mean_force=first / window,
        mean_square_force=second / window,
    )


def _move(
    lifted: LiftedLoop, steps: JerkSteps, *, order: int, tail: float
) -> Iterator[tuple[Array, Array]]:
    """Yield the times of some position cycles, shape (n_times,), and the states there.

    These of shape (n_times, n, n_limits); at rest in the first.
    """
    X = np.zeros((len(lifted.A), len(steps.times)))
    count = int(np.ceil((float(np.max(steps.duration)) + tail) / lifted.dt))
    for start in range(0, count, BLOCK):
        t = lifted.dt * np.arange(start, min(start + BLOCK, count), dtype=np.float64)
        drive = lifted.B @ _references(steps, t, order=order)
        history = np.empty((len(t) + 1, *X.shape))
        history[0] = X
        for i in range(len(t)):
            np.matmul(lifted.A, history[i], out=history[i + 1])
            history[i + 1] += drive[i]
        X = history[-1]
        yield t, history[:-1]


def _shares(t: Array, window: Array, *, dt: float, rows: int) -> Array | float:
    """How much of a velocity cycle each sample stands for, (n_times, rows, n_limits) [s].

    The cycle lies about the sample; the window cuts the last one.
    """
    step = dt / rows
    if float(t[-1]) + dt <= float(np.min(window)):
        return step
    times = t[:, None, None] + step * np.arange(rows)[:, None]
    return step * np.clip((window - times) / step + 0.5, 0.0, 1.0)


def _references(steps: JerkSteps, t: Array, *, order: int) -> Array:
    """x_ref, v_ref, a_ref, j_ref of all setpoints at the times t, (n_times, 4, n_limits)."""
    # The few steps go first: numpy adds along the first axis far quicker than along the last.
    age = t[:, None] - steps.times.T[:, None, :]
    term = steps.steps.T[:, None, :] * (age >= -INSTANT)
    age = np.maximum(age, 0.0)
    result = np.zeros((len(t), 4, len(steps.times)))
    for power in range(order + 1):
        if power:
            term = term * age / power
        if order - power < 4:
            result[:, order - power] = term.sum(axis=0)
    return result
