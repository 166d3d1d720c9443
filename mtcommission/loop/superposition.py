"""The linear response to thousands of setpoints at once, for the search.

A setpoint is a sum of jerk steps. A jerk step of 1 that began the time s before position
sample n is, at that and all later samples, sum_p s^p/p! times the p-th basis input, where
basis p is the setpoint whose p-th lower derivative steps at sample n (p = 0: jerk, 1:
acceleration, 2: velocity, 3: position). The loop answers a basis input by following its
polynomial, once settled, plus a transient A^n X_0 that is known from the first sample. At the
end of a setpoint the polynomials add up to rest or coasting, so the transients alone are
tabulated and summed: exact for any instants of the steps, and without the cancellation of
large positions. What follows is free motion, one matrix product for all setpoints.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.sampled import LiftedLoop, SampledLoop
from mtcommission.plant import Plant
from mtcommission.setpoint import INSTANT, JerkSteps

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

SEARCH_HORIZON = 2.0
"""Free motion looked at by the search after t_e [s]; what settles later counts as inf there."""

CHUNK_SAMPLES = 2**21
"""Samples of free motion computed at once: keeps the responses in the cache (measured)."""

FORGOTTEN = 1e-13
"""A transient whose every state has fallen below this share of its peak counts as zero."""

DECAY = 1e3
"""A mode is followed until it has decayed by this factor."""

SKETCH_SAMPLES = 12
"""Samples per period at a first look: the peak of a swing is missed by 3 % at most (more of what
dies out within one spacing after t_e + τ)."""

SKETCH_SPACING = 2e-3
"""Largest distance of samples at a first look [s]: some ten per period of the servo's own
motion, which no bandwidth below 50 Hz exceeds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResponseTables:
    """What the search needs of one loop.

    Parameters
    ----------
    dt, reference_delay
        [s].
    instants
        When the free motion is sampled, after the end of the setpoint's last position cycle,
        shape (n_samples,) [s].
    order
        Highest derivative that steps: 3 jerk, 4 snap (behind a moving average).
    transients
        Loop state less its steady motion, n cycles after a basis input began, shape
        (order + 1, n_cycles, n); the last one stands for all later cycles and is zero where the
        transient has decayed before the longest setpoint ends.
    free_motion
        Tool deviation at later velocity cycles, shape (n + 1, n_samples): per unit transient and,
        in the last row, per unit velocity while coasting [s], the same in every position cycle
        with a ripple inside it where held setpoints meet moving states.
    """

    dt: float
    instants: Array
    reference_delay: float
    order: int
    transients: Array
    free_motion: NDArray[np.floating]


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
) -> ResponseTables:
    """Return the tables of one loop, with the free motion at every velocity cycle.

    Parameters
    ----------
    loop, lifted
        The same loop as arithmetic and as matrices.
    longest
        Longest setpoint that will be asked for [s].
    filtered
        Whether the setpoints come from a moving average.

    Returns
    -------
    ResponseTables
    """
    T, order = lifted.dt, 4 if filtered else 3
    following = _following_states(lifted, order)
    tool = [i for i, name in enumerate(lifted.outputs) if name.startswith("tcp[")]
    rows = lifted.C[tool]
    pieces = []
    for _ in range(int(np.ceil(search_horizon(lifted) / T))):
        pieces.append(rows)
        rows = rows @ lifted.A
    tau, T_v = loop.controller.reference_delay, loop.controller.velocity_cycle
    ripple = lifted.C[tool] @ following[1] + tau - T_v * np.arange(len(tool))
    coasting = np.tile(ripple, len(pieces))
    instants: Array = np.arange(len(coasting), dtype=np.float64) * T_v
    return ResponseTables(
        dt=T,
        instants=instants,
        reference_delay=tau,
        order=order,
        transients=_transients(lifted, -following[::-1], count=int(np.ceil(longest / T)) + 3),
        free_motion=np.vstack([np.concatenate(pieces).T, coasting]),
    )


def _transients(lifted: LiftedLoop, start: Array, *, count: int) -> Array:
    """Free motion from some states, shape (n_states, <= count, n); ends in zero once decayed."""
    found, largest = [start], np.abs(start)
    while len(found) < count:
        found.append(found[-1] @ lifted.A.T)
        size = np.abs(found[-1])
        if np.all(size <= FORGOTTEN * largest):
            found[-1] = np.zeros_like(start)
            break
        np.maximum(largest, size, out=largest)
    return np.stack(found, axis=1)


def _following_states(lifted: LiftedLoop, order: int) -> Array:
    """Loop state while it follows a polynomial, per unit of each derivative of the position.

    X = sum_k S_k d^k x_ref/dt^k solves X⁺ = A X + B r for every polynomial of the order, with
    the derivatives one cycle later by Taylor; shape (order + 1, n), S_0 first.
    """
    n, T = len(lifted.A), lifted.dt
    inverse = np.linalg.inv(np.eye(n) - lifted.A)
    S = np.zeros((order + 1, n))
    for k in range(order + 1):
        later = sum((S[k - i] * (T**i / factorial(i)) for i in range(1, k + 1)), np.zeros(n))
        S[k] = inverse @ ((lifted.B[:, k] if k < 4 else 0.0) - later)
    return S


def search_horizon(lifted: LiftedLoop) -> float:
    """Return how long the search follows the free motion of a loop [s].

    Until its slowest mode has decayed by ``DECAY``, at most ``SEARCH_HORIZON``.

    Parameters
    ----------
    lifted
        A stable loop.

    Returns
    -------
    float
    """
    slowest = float(np.max(np.abs(np.linalg.eigvals(lifted.A))))
    needed = -np.log(DECAY) / np.log(slowest) * lifted.dt if slowest < 1.0 else SEARCH_HORIZON
    return min(needed, SEARCH_HORIZON)


def sketch_tables(tables: ResponseTables, plant: Plant) -> ResponseTables:
    """Return the same tables with fewer samples in single precision, for a first look.

    The samples follow the fastest mode that has not decayed yet (at half the plant's own rate
    of decay, in case the loop slows it).

    Parameters
    ----------
    tables
        From ``build_tables``.
    plant
        The plant of that loop.

    Returns
    -------
    ResponseTables
    """
    t = tables.instants
    fastest = np.full_like(t, 1.0 / (SKETCH_SAMPLES * SKETCH_SPACING))
    for mode in plant.modes:
        rate = max(0.5 * mode.damping_ratio * mode.natural_frequency, 1e-9)
        alive = t < np.log(DECAY) / rate
        fastest[alive] = np.maximum(fastest[alive], mode.frequency_hz)
    step = t[1] - t[0]
    periods = np.floor(np.cumsum(SKETCH_SAMPLES * fastest * step) + 1e-9)
    kept = np.flatnonzero(np.diff(periods, prepend=-1.0))
    return replace(
        tables,
        instants=t[kept],
        free_motion=tables.free_motion[:, kept].astype(np.float32),
    )


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
    chunk = max(CHUNK_SAMPLES // len(tables.instants), 16)
    for start in range(0, count, chunk):
        part = slice(start, start + chunk)
        settling[part], residual[part] = _settle_chunk(
            tables, steps.times[part], steps.steps[part], band
        )
    return Settling(settling_time=settling, residual_deviation=residual)


def _settle_chunk(
    tables: ResponseTables, times: Array, steps: Array, band: float
) -> tuple[Array, Array]:
    T, t_e = tables.dt, times[:, -1]
    end = np.ceil((t_e - INSTANT) / T).astype(np.int64)
    free, instants = tables.free_motion, tables.instants
    e = _motion_from(tables, times, steps, end).astype(free.dtype) @ free
    if tables.reference_delay < T:
        # The judgement begins in the position cycle in which the setpoint ends. What the
        # setpoint does in it reaches the drive a cycle later, so its motion is free, too.
        own = instants < T - INSTANT
        before = _motion_from(tables, times, steps, end - 1).astype(free.dtype)
        e = np.hstack([before @ free[:, own], e])
        instants = np.concatenate([instants[own] - T, instants])

    # Before t_e + τ the delayed setpoint still moves; those samples do not count. The last of
    # them becomes the deviation at t_e + τ itself, between two samples.
    until = t_e + tables.reference_delay
    begin = np.searchsorted(instants, until - end * T - INSTANT)
    rows, prior = np.arange(len(e)), np.maximum(begin - 1, 0)
    gap = np.where(begin > 0, instants[begin] - instants[prior], 1.0)
    share = np.where(begin > 0, (until - end * T - instants[prior]) / gap, 0.0)
    at_end = e[rows, prior] + share * (e[rows, begin] - e[rows, prior])
    np.abs(e, out=e)
    head = int(begin.max()) + 1
    e[:, :head][np.arange(e.shape[1])[:head] < begin[:, None]] = 0.0
    e[rows, prior] = np.where(begin > 0, np.abs(at_end), e[rows, prior])
    residual = e.max(axis=1)
    outside = e > band
    n = e.shape[1]
    last = n - 1 - np.argmax(outside[:, ::-1], axis=1)
    settled = ~outside.any(axis=1)
    following = np.minimum(last + 1, n - 1)
    here, there = e[rows, last], e[rows, following]
    start = np.where(last == begin - 1, until - end * T, instants[last])
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (here - band) / (here - there)
        crossing = end * T + start + share * (instants[following] - start)
    settling = np.where(settled, until, np.maximum(until, crossing))
    settling[~settled & (last == n - 1)] = np.inf
    return settling, residual


def _motion_from(tables: ResponseTables, times: Array, steps: Array, at: IntArray) -> Array:
    """Loop state at a position sample, less that of coasting on, and the velocity of coasting.

    Shape (n_limits, n + 1), of each setpoint as at its end.
    A step still to come counts by its polynomial continued backwards, which coasting has and
    the loop has not.
    """
    T, order = tables.dt, tables.order
    begun = np.minimum(np.ceil((times - INSTANT) / T).astype(np.int64), at[:, None])
    early = begun * T - times
    cycles = at[:, None] - begun
    if not tables.transients[:, -1].any():
        cycles = np.minimum(cycles, tables.transients.shape[1] - 1)
    X = np.zeros((len(times), tables.transients.shape[2] + 1))
    for p in range(order + 1):
        weight = steps * early**p / factorial(p)
        X[:, :-1] += np.einsum("ms,msn->mn", weight, tables.transients[p][cycles])
    age = times[:, -1:] - times
    X[:, -1] = np.sum(steps * age ** (order - 1), axis=1) / factorial(order - 1)
    return X


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
    step = lifted.dt / rows
    X = np.zeros((len(lifted.A), len(steps.times)))
    largest = np.zeros((len(C_s), len(steps.times)))
    first, second = np.zeros((2, len(steps.times)))
    count = int(np.ceil((float(np.max(steps.duration)) + tail) / lifted.dt))
    for start in range(0, count, BLOCK):
        t = lifted.dt * np.arange(start, min(start + BLOCK, count), dtype=np.float64)
        r = _references(steps, t, order=order)
        drive = lifted.B @ r
        history = np.empty_like(drive)
        for i in range(len(t)):
            history[i] = X
            X = lifted.A @ X + drive[i]
        np.maximum(largest, np.abs(C_s @ history + D_s @ r).max(axis=0), out=largest)
        # Each sample stands for the cycle about it; the window cuts the last one.
        times = t[:, None, None] + step * np.arange(rows)[:, None]
        share = np.clip((window - times) / step + 0.5, 0.0, 1.0) * step
        force = C_f @ history + D_f @ r
        first += (share * force).sum(axis=(0, 1))
        second += (share * force**2).sum(axis=(0, 1))
    return Extremes(
        peaks=largest.reshape(rows, len(signals), -1).max(axis=0).T,
        mean_force=first / window,
        mean_square_force=second / window,
    )


BLOCK = 32
"""Position cycles whose outputs are computed together: bounds the memory for slow moves."""


def _references(steps: JerkSteps, t: Array, *, order: int) -> Array:
    """x_ref, v_ref, a_ref, j_ref of all setpoints at the times t, (n_times, 4, n_limits)."""
    age = t[:, None, None] - steps.times
    term = steps.steps * (age >= -INSTANT)
    age = np.maximum(age, 0.0)
    result = np.zeros((len(t), 4, len(steps.times)))
    for power in range(order + 1):
        if power:
            term = term * age / power
        if order - power < 4:
            result[:, order - power] = term.sum(axis=2)
    return result
