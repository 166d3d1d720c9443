"""The same limits on thousands of machines at once: settling, residual, use of the bounds.

The loops of all samples advance together, driven by the same setpoint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import ceil, inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits import MotionLimits
from mtcommission.loop.response import DECAYED, HORIZON
from mtcommission.loop.sampled import SampledLoop
from mtcommission.loop.tuning import TunedLoop
from mtcommission.machine import Machine
from mtcommission.plant import Plant
from mtcommission.rules import longest_period
from mtcommission.setpoint import Setpoint, plan_setpoint, sample_setpoint
from mtcommission.variations import Variations
from mtcommission.varied_loops import VariedLoops, build_loops, hand_down, own_size

Array = NDArray[np.float64]

CHUNK = 1000
"""Samples advanced at once: keeps their matrices in the cache (measured)."""

EARLIEST_STOP = 0.02
"""Shortest stretch of free motion after which a sample may count as decayed [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedResponse:
    """What limits do on many machines.

    Parameters
    ----------
    settling_time
        Slowest move, shape (n_samples,) [s]; inf where it has not decayed within the horizon.
    residual_deviation
        Worst move, shape (n_samples,) [m]; inf like the settling time.
    usage
        Largest share of a bound that is used: set force, peaks, RMS force; worst move, shape
        (n_samples,) [-]. Above 1 the force would saturate, and the motion differs.
    """

    settling_time: Array
    residual_deviation: Array
    usage: Array

    def meets(self, machine: Machine) -> NDArray[np.bool_]:
        """Return which samples keep all requirements, shape (n_samples,)."""
        needs = machine.requirements
        kept = (self.residual_deviation <= needs.tcp_deviation) & (self.usage <= 1.0)
        return np.asarray(kept & (self.settling_time <= needs.max_settling_time))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Signals:
    """What is bounded besides the tool's deviation, as rows over the loop's state.

    The last row is the motor force where ``continuous`` is finite (its RMS is bounded); the
    others have their peaks bounded by ``bounds``.
    """

    rows: Array
    bounds: Array
    continuous: float
    static_load: float


@dataclass(slots=True, kw_only=True, eq=False)
class _Progress:
    """What is known so far of the motion of one chunk."""

    settling: Array
    residual: Array
    peaks: Array
    first: Array
    square: Array
    last: Array = field(default_factory=lambda: np.zeros(0))


def respond_to_variations(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    variations: Variations,
) -> VariedResponse:
    """Return settling time and residual deviation of the same limits on many machines.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the force is not saturated here.
    limits
        Acceleration and jerk.
    variations
        The machines.

    Returns
    -------
    VariedResponse
    """
    time = machine.control.moving_average_time
    setpoints = [plan_setpoint(move, limits, moving_average=time) for move in machine.moves]
    return follow_setpoints(machine, plant, tuned, setpoints, variations=variations)


def follow_setpoints(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    setpoints: Sequence[Setpoint],
    *,
    variations: Variations,
) -> VariedResponse:
    """Return what given setpoints do on many machines, worst over the setpoints.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the force is not saturated here.
    setpoints
        One for each move, filters included.
    variations
        The machines.

    Returns
    -------
    VariedResponse
    """
    found = follow_each(machine, plant, tuned, setpoints, variations=variations)
    return VariedResponse(
        settling_time=np.max([item.settling_time for item in found], axis=0),
        residual_deviation=np.max([item.residual_deviation for item in found], axis=0),
        usage=np.max([item.usage for item in found], axis=0),
    )


def follow_each(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    setpoints: Sequence[Setpoint],
    *,
    variations: Variations,
) -> tuple[VariedResponse, ...]:
    """Return what each of many setpoints does on many machines.

    Parameters
    ----------
    machine, plant, tuned
        See ``follow_setpoints``.
    setpoints
        Filters included.
    variations
        The machines.

    Returns
    -------
    tuple of VariedResponse
        In the order of the setpoints.
    """
    count, loop = len(variations.payload), tuned.loops[0]
    signals = _bounded_signals(machine, plant, loop)
    found = [
        VariedResponse(
            settling_time=np.zeros(count), residual_deviation=np.zeros(count), usage=np.zeros(count)
        )
        for _ in setpoints
    ]
    for start in range(0, count, CHUNK):
        part = slice(start, start + CHUNK)
        lifted = build_loops(
            machine, plant, tuned, variations=variations, part=part, signals=signals.rows
        )
        for response, setpoint in zip(found, setpoints, strict=True):
            progress = _respond(machine, plant, loop, lifted, signals, setpoint)
            response.settling_time[part] = progress.settling
            response.residual_deviation[part] = progress.residual
            response.usage[part] = _usage(progress, signals, setpoint)
    return tuple(found)


def _bounded_signals(machine: Machine, plant: Plant, loop: SampledLoop) -> _Signals:
    """Set force, bounded peaks, and the motor force where its RMS is bounded."""
    drive, peaks, size = machine.drive, machine.requirements.peaks, own_size(loop)
    outputs = loop.observation[:, :size]
    states = outputs[-plant.order :]
    rows = [outputs[loop.outputs.index("force")], *(plant.row(p.name) @ states for p in peaks)]
    if isfinite(drive.continuous_force):
        rows.append(states[plant.force])
    return _Signals(
        rows=np.array(rows),
        bounds=np.array([drive.motion_force, *(peak.bound for peak in peaks)]),
        continuous=drive.continuous_force,
        static_load=drive.static_load,
    )


def _respond(
    machine: Machine,
    plant: Plant,
    loop: SampledLoop,
    lifted: VariedLoops,
    signals: _Signals,
    setpoint: Setpoint,
) -> _Progress:
    """Settling time, residual and use of the bounds of one setpoint on all samples of a chunk."""
    T_p, tau = loop.controller.position_cycle, loop.controller.reference_delay
    until = setpoint.duration + tau
    first = int(until / T_p)
    stretch = ceil(max(min(longest_period(plant), 0.2), EARLIEST_STOP) / T_p)
    last = first + ceil(HORIZON / T_p)
    fed = hand_down(loop, setpoint, last + stretch)
    count, n, cycles = len(lifted.rows), lifted.rows.shape[2], loop.controller.cycles
    progress = _Progress(
        settling=np.full(count, until),
        residual=np.zeros(count),
        peaks=np.zeros((count, len(signals.bounds))),
        first=np.zeros(count),
        square=np.zeros(count),
    )
    alive, X = np.arange(count), np.zeros((count, n, 1))
    moving_rows = np.ascontiguousarray(lifted.rows[:, :-cycles])
    for k in range(first):
        Y = moving_rows @ X
        _note_signals(progress, alive, Y[:, n:, 0], k, loop, signals, setpoint)
        X = Y[:, :n]
        X[:, loop.held :, 0] += fed[k]
    rows = lifted.rows
    band, step = machine.requirements.tcp_deviation, loop.controller.velocity_cycle
    for start in range(first, last, stretch):
        pieces = []
        for k in range(start, start + stretch):
            Y = rows @ X
            pieces.append(Y[:, -cycles:, 0])
            _note_signals(progress, alive, Y[:, n:-cycles, 0], k, loop, signals, setpoint)
            X = Y[:, :n]
            X[:, loop.held :, 0] += fed[k]
        t: Array = start * T_p + step * np.arange(stretch * cycles, dtype=np.float64)
        tip = np.concatenate(pieces, axis=1)
        e = tip - sample_setpoint(setpoint, t - tau)[:, 0]
        if start == first:
            t, e = _begin_at_end(setpoint, t, tip, e, until=until)
        moving = _note(progress, alive, t, np.abs(e), band=band)
        alive, rows, X = alive[moving], rows[moving], X[moving]
        if not alive.size:
            return progress
        progress.last = progress.last[moving]
    progress.settling[alive], progress.residual[alive] = inf, inf
    return progress


def _note_signals(
    progress: _Progress,
    alive: NDArray[np.intp],
    values: Array,
    cycle: int,
    loop: SampledLoop,
    signals: _Signals,
    setpoint: Setpoint,
) -> None:
    """Add one position cycle of the bounded signals, shape (n_alive, n_signals cycles)."""
    cycles, step = loop.controller.cycles, loop.controller.velocity_cycle
    values = values.reshape(len(alive), -1, cycles)
    peaks = np.abs(values[:, : len(signals.bounds)]).max(axis=2)
    progress.peaks[alive] = np.maximum(progress.peaks[alive], peaks)
    if isfinite(signals.continuous):
        # Each sample stands for the velocity cycle about it; the window cuts the last one.
        t = cycle * loop.controller.position_cycle + step * np.arange(cycles)
        window = setpoint.duration + setpoint.move.dwell
        share = np.clip((window - t) / step + 0.5, 0.0, 1.0) * step
        progress.first[alive] += values[:, -1] @ share
        progress.square[alive] += values[:, -1] ** 2 @ share


def _usage(progress: _Progress, signals: _Signals, setpoint: Setpoint) -> Array:
    """Largest share of a bound that is used; the motion may go either way against the load."""
    used = (progress.peaks / signals.bounds).max(axis=1)
    if not isfinite(signals.continuous):
        return np.asarray(used)
    window, load = setpoint.duration + setpoint.move.dwell, abs(signals.static_load)
    mean, square = progress.first / window, progress.square / window
    rms = np.sqrt(square + load**2 + 2.0 * load * np.abs(mean))
    return np.asarray(np.maximum(used, rms / signals.continuous))


def _begin_at_end(
    setpoint: Setpoint, t: Array, tip: Array, e: Array, *, until: float
) -> tuple[Array, Array]:
    """Times and deviations from t_e + τ on, which lies between two samples.

    There the tool is interpolated against the setpoint that by then rests or coasts.
    """
    begin = int(np.argmax(t >= until - 1e-12))
    if begin == 0:
        return t, e
    end, speed = sample_setpoint(setpoint, np.array([setpoint.duration]))[0, :2]
    before = tip[:, begin - 1] - end - speed * (t[begin - 1] - until)
    share = (until - t[begin - 1]) / (t[begin] - t[begin - 1])
    at_end = before + share * (e[:, begin] - before)
    return np.append(until, t[begin:]), np.column_stack([at_end, e[:, begin:]])


def _note(
    progress: _Progress, alive: NDArray[np.intp], t: Array, e: Array, *, band: float
) -> NDArray[np.bool_]:
    """Add a stretch of |e| to what is known; return which samples have not decayed yet."""
    progress.residual[alive] = np.maximum(progress.residual[alive], e.max(axis=1))
    if progress.last.size:  # a crossing may lie between two stretches
        e = np.hstack([progress.last[:, None], e])
        t = np.append(2.0 * t[0] - t[1], t)
    outside = e > band
    row = np.flatnonzero(outside.any(axis=1))
    final = e.shape[1] - 1 - np.argmax(outside[row, ::-1], axis=1)
    following = np.minimum(final + 1, e.shape[1] - 1)
    here, there = e[row, final], e[row, following]
    share = np.where(following > final, (here - band) / np.maximum(here - there, 1e-300), 0.0)
    progress.settling[alive[row]] = t[final] + (t[following] - t[final]) * share
    progress.last = e[:, -1]
    return np.asarray(e.max(axis=1) > DECAYED * band)
