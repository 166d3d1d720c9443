"""The linear response to thousands of setpoints at once, for the search.

A setpoint is a sum of jerk steps. A jerk step of 1 that began the time s before position
sample n is, at that and all later samples, sum_p s^p/p! times the p-th basis input, where
basis p is the setpoint whose p-th lower derivative steps at sample n (p = 0: jerk, 1:
acceleration, 2: velocity, 3: position). So the state of the sampled loop at the end of any
setpoint is a short sum over tabulated states, exact for any instants of the steps, and what
follows is free motion, one matrix product for all setpoints.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.response import steady_state
from mtcommission.loop.sampled import LiftedLoop, SampledLoop
from mtcommission.setpoint import INSTANT, JerkSteps

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

SEARCH_HORIZON = 0.5
"""Free motion looked at by the search after t_e [s]; what settles later counts as inf there."""

CHUNK = 512
"""Setpoints per matrix product: keeps the responses in the cache (measured)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResponseTables:
    """What the search needs of one loop.

    Parameters
    ----------
    dt, reference_delay
        [s].
    spacing
        Distance of the samples of the free motion [s].
    order
        Highest derivative that steps: 3 jerk, 4 snap (behind a moving average).
    states
        Loop state n cycles after a basis input began, shape (order + 1, n_cycles, n).
    free_motion
        Tool deviation at later velocity cycles per unit state, shape (n, n_samples).
    steady
        From ``steady_state``, shape (n, 2).
    steady_deviation
        Tool deviation while coasting, per unit velocity [s].
    """

    dt: float
    spacing: float
    reference_delay: float
    order: int
    states: Array
    free_motion: NDArray[np.floating]
    steady: Array
    steady_deviation: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Settling:
    """Judgement of many setpoints on one loop.

    Parameters
    ----------
    settling_time
        Shape (n_limits,) [s]; inf where the horizon ends first.
    residual_deviation
        Shape (n_limits,) [m].
    """

    settling_time: Array
    residual_deviation: Array


def build_tables(
    loop: SampledLoop,
    lifted: LiftedLoop,
    *,
    longest: float,
    filtered: bool = False,
    stride: int = 1,
) -> ResponseTables:
    """Return the tables of one loop.

    Parameters
    ----------
    loop, lifted
        The same loop as arithmetic and as matrices.
    longest
        Longest setpoint that will be asked for [s].
    filtered
        Whether the setpoints come from a moving average.
    stride
        Velocity cycles from one sample of the free motion to the next; above 1 the samples are
        in single precision too: for a first look.

    Returns
    -------
    ResponseTables
    """
    T, order = lifted.dt, 4 if filtered else 3
    count = int(np.ceil(longest / T)) + 3
    t = np.arange(count, dtype=np.float64) * T
    states = np.empty((order + 1, count, len(lifted.A)))
    for p in range(order + 1):
        references = np.column_stack([_basis(t, order - p - derivative) for derivative in range(4)])
        X = np.zeros(len(lifted.A))
        for i in range(count):
            states[p, i] = X
            X = lifted.A @ X + lifted.B @ references[i]
    tool = [i for i, name in enumerate(lifted.outputs) if name.startswith("tcp[")]
    rows = lifted.C[tool]
    pieces = []
    for _ in range(int(np.ceil(search_horizon(lifted) / T))):
        pieces.append(rows)
        rows = rows @ lifted.A
    free_motion = np.concatenate(pieces)[::stride].T
    steady = steady_state(lifted)
    tau = loop.controller.reference_delay
    return ResponseTables(
        dt=T,
        spacing=stride * loop.controller.velocity_cycle,
        reference_delay=tau,
        order=order,
        states=states,
        free_motion=free_motion.astype(np.float64 if stride == 1 else np.float32),
        steady=steady,
        steady_deviation=float(lifted.C[tool[0]] @ steady[:, 1]) + tau,
    )


def search_horizon(lifted: LiftedLoop) -> float:
    """Return how long the search follows the free motion of a loop [s].

    Until its slowest mode has decayed to a thousandth, at most ``SEARCH_HORIZON``.

    Parameters
    ----------
    lifted
        A stable loop.

    Returns
    -------
    float
    """
    slowest = float(np.max(np.abs(np.linalg.eigvals(lifted.A))))
    needed = -np.log(1e3) / np.log(slowest) * lifted.dt if slowest < 1.0 else SEARCH_HORIZON
    return min(needed, SEARCH_HORIZON)


def _basis(t: Array, power: int) -> Array:
    """t^power / power!, zero for a negative power."""
    return np.zeros_like(t) if power < 0 else t**power / factorial(power)


def settle(tables: ResponseTables, steps: JerkSteps, *, band: float) -> Settling:
    """Return settling time and residual deviation of many setpoints on one loop.

    Parameters
    ----------
    tables
        Of the loop; of order 4 if ``steps`` are snap steps.
    steps
        Instants and sizes of the steps of the highest derivative.
    band
        [m].

    Returns
    -------
    Settling
    """
    count = len(steps.times)
    settling, residual = np.empty(count), np.empty(count)
    for start in range(0, count, CHUNK):
        part = slice(start, start + CHUNK)
        settling[part], residual[part] = _settle_chunk(
            tables, steps.times[part], steps.steps[part], band
        )
    return Settling(settling_time=settling, residual_deviation=residual)


def _settle_chunk(
    tables: ResponseTables, times: Array, steps: Array, band: float
) -> tuple[Array, Array]:
    T, T_v = tables.dt, tables.spacing
    t_e = times[:, -1]
    end = np.ceil((t_e - INSTANT) / T).astype(np.int64)
    X, reference, velocity = _state_at(tables, times, steps, end)
    X -= reference[:, None] * tables.steady[:, 0] + velocity[:, None] * tables.steady[:, 1]
    e = X.astype(tables.free_motion.dtype) @ tables.free_motion
    e += (velocity * tables.steady_deviation)[:, None].astype(e.dtype)
    np.abs(e, out=e)

    # Before t_e + τ the delayed setpoint still moves; those samples do not count.
    begin = np.ceil((t_e + tables.reference_delay - end * T) / T_v - 1e-9).astype(np.int64)
    begin = np.maximum(begin, 0)
    head = int(begin.max()) + 1
    e[:, :head][np.arange(head) < begin[:, None]] = 0.0
    residual = e.max(axis=1)
    outside = e > band
    n = e.shape[1]
    last = n - 1 - np.argmax(outside[:, ::-1], axis=1)
    settled = ~outside.any(axis=1)
    following = np.minimum(last + 1, n - 1)
    rows = np.arange(len(e))
    here, there = e[rows, last], e[rows, following]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = last + (here - band) / (here - there)
    until = t_e + tables.reference_delay
    settling = np.where(settled, until, np.maximum(until, end * T + crossing * T_v))
    settling[~settled & (last >= n - 1)] = np.inf
    return settling, residual


def _state_at(
    tables: ResponseTables, times: Array, steps: Array, end: IntArray
) -> tuple[Array, Array, Array]:
    """Loop state, x_ref and v_ref at position sample ``end`` of each setpoint."""
    T, order = tables.dt, tables.order
    begun = np.ceil((times - INSTANT) / T).astype(np.int64)
    early = np.maximum(begun * T - times, 0.0)
    index = end[:, None] - begun
    X = np.zeros((len(times), tables.states.shape[2]))
    for p in range(order + 1):
        weight = steps * early**p / factorial(p)
        X += np.einsum("ms,msn->mn", weight, tables.states[p][index])
    age = end[:, None] * T - times
    reference = np.sum(steps * age**order, axis=1) / factorial(order)
    velocity = np.sum(steps * age ** (order - 1), axis=1) / factorial(order - 1)
    return X, reference, velocity


def moving_average_steps(steps: JerkSteps, *, time: float) -> JerkSteps:
    """Return the snap steps of the same setpoints behind a moving average.

    Parameters
    ----------
    steps
        Jerk steps.
    time
        Length of the average [s], > 0.

    Returns
    -------
    JerkSteps
        ``steps`` now in m/s⁴; the last instant is the end of the filtered setpoint.
    """
    return JerkSteps(
        times=np.hstack([steps.times, steps.times + time]),
        steps=np.hstack([steps.steps, -steps.steps]) / time,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extremes:
    """What a setpoint demands of one loop while it moves.

    Parameters
    ----------
    peaks
        Largest magnitude of each signal, shape (n_limits, n_signals).
    mean_force, mean_square_force
        Of the motor force over [0, t_e + dwell], shape (n_limits,) [N, N²].
    """

    peaks: Array
    mean_force: Array
    mean_square_force: Array


def find_extremes(
    lifted: LiftedLoop, steps: JerkSteps, *, signals: Array, order: int, dwell: float, tail: float
) -> Extremes:
    """Return peaks and mean forces of a moderate number of setpoints on one loop.

    Parameters
    ----------
    lifted
        The loop; the last of its outputs per velocity cycle is the motor force.
    steps
        Steps of the derivative ``order``.
    signals
        Rows over the outputs of one velocity cycle, shape (n_signals, n_outputs).
    order
        3 jerk, 4 snap.
    dwell
        Rest after the setpoint that counts for the mean [s].
    tail
        Free motion looked at after the longest setpoint [s].

    Returns
    -------
    Extremes
    """
    per_cycle = signals.shape[1]
    rows = len(lifted.outputs) // per_cycle
    C = lifted.C.reshape(rows, per_cycle, -1)
    D = lifted.D.reshape(rows, per_cycle, -1)
    C_s, D_s = (signals @ C).reshape(-1, len(lifted.A)), (signals @ D).reshape(-1, 4)
    C_f, D_f = C[:, -1], D[:, -1]
    window = steps.duration + dwell
    cycles = int(np.ceil((float(np.max(steps.duration)) + tail) / lifted.dt))
    starts = np.arange(cycles, dtype=np.float64) * lifted.dt
    age = starts[:, None, None] - steps.times
    weights = np.where(age >= -INSTANT, steps.steps, 0.0)
    age = np.maximum(age, 0.0)
    references = np.stack(
        [np.sum(weights * _basis(age, order - i), axis=2) for i in range(4)], axis=1
    )
    history = np.empty((cycles, len(lifted.A), len(window)))
    X = np.zeros(history.shape[1:])
    for k, r in enumerate(references):
        history[k] = X
        X = lifted.A @ X + lifted.B @ r
    largest = np.abs(C_s @ history + D_s @ references).max(axis=0)
    step = lifted.dt / rows
    times = (starts[:, None] + step * np.arange(rows))[:, :, None]
    # Each sample stands for the cycle about it; the window cuts the last one.
    share = np.clip((window - times) / step + 0.5, 0.0, 1.0) * step
    force = C_f @ history + D_f @ references
    first = (share * force).sum(axis=(0, 1))
    second = (share * force**2).sum(axis=(0, 1))
    return Extremes(
        peaks=largest.reshape(rows, len(signals), -1).max(axis=0).T,
        mean_force=first / window,
        mean_square_force=second / window,
    )
