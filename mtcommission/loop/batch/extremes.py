"""Peaks and RMS force of setpoints while they move, by simulating them side by side.

Each setpoint has a clock of its own: where nothing steps for longer than the loop remembers, the
loop follows a polynomial, known in closed form, and the clock leaps to shortly before the next
step. So a move of minutes takes no longer than the steps in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, log

import numpy as np
from numpy.typing import NDArray

from mtcommission.allowance import spend
from mtcommission.loop.batch.tables import following_states
from mtcommission.loop.model.assembly import LiftedLoop, SampledLoop
from mtcommission.loop.simulate.mean_force import rms_force, sum_free_force, window_shares
from mtcommission.loop.simulate.response import steady_state
from mtcommission.setpoint.pieces import INSTANT, Pieces, cut
from mtcommission.setpoint.setpoint import JerkSteps

Array = NDArray[np.float64]

BLOCK = 32
"""Position cycles whose outputs are computed together: keeps them in the cache."""

REMEMBERED = 1e-9
"""Share to which every mode of the loop has decayed where it counts as following [-]."""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
"""Of the quadrature over a leap: exact for the square of a cubic."""


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
    spend(0.0, calls=100)  # before and after the stretches
    lifted = loop.lifted
    per_cycle, count = signals.shape[1], len(steps.times)
    rows = len(lifted.outputs) // per_cycle
    step = lifted.dt / rows
    C = lifted.C.reshape(rows, per_cycle, -1)
    C_s, C_f = (signals @ C).reshape(-1, len(lifted.A)), C[:, -1]
    window = steps.duration + (dwell or 0.0)
    largest, deviation = np.zeros((len(C_s), count)), np.zeros(count)
    first, square = np.zeros((2, count))
    before = step * np.arange(rows)[:, None]
    pieces = cut(steps.times, steps.steps, order=steps.order)
    for stretch in _move(lifted, pieces, lag=loop.controller.reference_delay, tail=tail):
        # What a position cycle computes acts in the next one, so no reference feeds through.
        cells, n = stretch.times.size, len(lifted.A)
        each = 120.0 + 0.17 * n * (n + len(C_s) + rows) + rows * (2.0 * len(signals) + 10.0)
        spend(cells * (each + 50.0 * rows * with_deviation), calls=0.5 * len(stretch.times) + 10)
        motion, instants = C_s @ stretch.states, stretch.times[:, None, :] + before
        np.maximum(largest, np.abs(motion, out=motion).max(axis=0), out=largest)
        if with_deviation:
            ages = instants - loop.controller.reference_delay
            e = C[:, 0] @ stretch.states - pieces.sample(ages, derivatives=1)[0]
            np.maximum(deviation, np.abs(e, out=e).max(axis=(0, 1)), out=deviation)
        if dwell is not None:
            force = C_f @ stretch.states
            share = (
                window_shares(instants, window, step=step)
                if stretch.shares is None
                else stretch.shares[:, None, :] / rows
            )
            first += (share * force).sum(axis=(0, 1))
            square += (share * force**2).sum(axis=(0, 1))
    if dwell is not None:
        until = stretch.until
        following = pieces.sample(until, derivatives=2)
        left = sum_free_force(
            lifted, stretch.last - steady_state(lifted) @ following, window - until, cycles=rows
        )
        first, square = first + left.first, square + left.square
    rms = rms_force(first, square, window=window, static_load=static_load)
    return Extremes(
        peaks=largest.reshape(rows, len(signals), -1).max(axis=0).T,
        deviation=deviation if with_deviation else np.full(count, np.nan),
        rms_force=rms if dwell is not None else np.full(count, np.nan),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Stretch:
    """Some instants of every setpoint, each on a clock of its own.

    ``times`` has the shape (n_times, n_limits), ``states`` (n_times, n, n_limits); ``until`` and
    ``last`` are where the clocks and the states stand afterwards. ``shares`` is what each instant
    stands for [s], where these are not position cycles one after the other but nodes of a leap.
    """

    times: Array
    states: Array
    until: Array
    last: Array
    shares: Array | None = None


def _move(lifted: LiftedLoop, pieces: Pieces, *, lag: float, tail: float) -> Iterator[_Stretch]:
    """Yield position cycles and leaps until every setpoint has ended for as long as ``tail``."""
    dt, end = lifted.dt, pieces.knots[-1] + tail
    memory = _memory(lifted) + lag
    order = pieces.values.shape[1] - 1
    following = following_states(lifted, order).T
    X, clock = np.zeros((len(lifted.A), len(end))), np.zeros(len(end))

    def follow(t: Array) -> Array:
        return following @ np.moveaxis(pieces.sample(t, derivatives=order + 1), 0, -2)

    while (left := int(np.ceil(np.max(end - clock) / dt - INSTANT / dt))) > 0:
        t = clock + dt * np.arange(min(BLOCK, left), dtype=np.float64)[:, None]
        drive = lifted.B @ np.moveaxis(pieces.sample(t, derivatives=4), 0, 1)
        history = np.empty((len(t) + 1, *X.shape))
        history[0] = X
        for i in range(len(t)):
            np.matmul(lifted.A, history[i], out=history[i + 1])
            history[i + 1] += drive[i]
        X, clock = history[-1], t[-1] + dt
        yield _Stretch(times=t, states=history[:-1], until=clock, last=X)
        leap = dt * _cycles_to_leap(pieces.knots, clock, memory=memory, dt=dt)
        if leap.any():
            t = clock + leap * (1.0 + NODES[:, None]) / 2.0
            states = np.where(leap > 0.0, follow(t), X)  # those that do not leap stay
            clock = clock + leap
            X = np.where(leap > 0.0, follow(clock), X)
            shares = leap * WEIGHTS[:, None] / 2.0
            yield _Stretch(times=t, states=states, until=clock, last=X, shares=shares)


def _memory(lifted: LiftedLoop) -> float:
    """How long a step is remembered [s]; inf for a loop that never forgets."""
    slowest = float(np.max(np.abs(np.linalg.eigvals(lifted.A))))
    return log(REMEMBERED) / log(slowest) * lifted.dt if slowest < 1.0 else inf


def _cycles_to_leap(knots: Array, clock: Array, *, memory: float, dt: float) -> Array:
    """Whole position cycles until shortly before the next step, where the last is forgotten.

    Zero elsewhere, and where a block of cycles is as quick; shape (n_limits,).
    """
    ahead = knots - clock
    until = np.where(ahead > 0.0, ahead, np.inf).min(axis=0)
    forgotten = np.where(ahead <= 0.0, -ahead, np.inf).min(axis=0) >= memory
    cycles = np.floor(np.where(np.isfinite(until), until, 0.0) / dt) - 1.0
    return np.where(forgotten & (cycles > BLOCK), cycles, 0.0)
