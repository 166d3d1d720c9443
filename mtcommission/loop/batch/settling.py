"""Settling time and residual of thousands of setpoints at once, by superposed responses."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.allowance import spend
from mtcommission.loop.batch.tables import ResponseTables
from mtcommission.setpoint.pieces import INSTANT
from mtcommission.setpoint.setpoint import JerkSteps

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

CHUNK_SAMPLES = 2**21
"""Samples of free motion computed at once: keeps the responses in the cache (measured)."""


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
    spend(len(times) * (free.size / 24.0 + 1.4 * free.shape[1] + steps.shape[1] * len(free)))
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
    residual, settling = e.max(axis=1), until.copy()
    late = np.flatnonzero(residual > band)
    n = e.shape[1]
    last = n - 1 - np.argmax((e[late] > band)[:, ::-1], axis=1)
    following = np.minimum(last + 1, n - 1)
    here, there = e[late, last], e[late, following]
    ended, ends = end[late] * T, until[late]
    start = np.where(last == begin[late] - 1, ends - ended, instants[last])
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (here - band) / (here - there)
        crossing = ended + start + share * (instants[following] - start)
    settling[late] = np.where(last == n - 1, np.inf, np.maximum(ends, crossing))
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
    if not tables.transients[-1].any():
        cycles = np.minimum(cycles, len(tables.transients) - 1)
    weights = np.empty((*steps.shape, order + 1))
    weights[:, :, 0] = steps
    for p in range(1, order + 1):
        weights[:, :, p] = weights[:, :, p - 1] * early / p
    transients = tables.transients[cycles].reshape(len(times), -1, tables.transients.shape[2])
    age = times[:, -1:] - times
    coasting = np.sum(steps * age ** (order - 1), axis=1) / factorial(order - 1)
    # One small product for each setpoint: the steps of all its basis inputs at once.
    X = weights.reshape(len(times), 1, -1) @ transients
    return np.column_stack([X[:, 0], coasting])
