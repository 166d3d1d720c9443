"""The motion of many loops under one setpoint: all samples of a chunk advance together.

First the setpoint moves, when only the bounded signals count; then stretches of free motion, after
each of which the samples that have decayed are left behind.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil, inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.allowance import spend
from mtcommission.loop.analysis.quantisation import SIGMAS, encoder_noise
from mtcommission.loop.batch.loops import hand_down_setpoint
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.simulate.mean_force import rms_force, window_shares
from mtcommission.loop.simulate.response import DECAYED, HORIZON
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import (
    CONTOUR_DEVIATION,
    RMS_FORCE,
    SET_FORCE,
    Requirement,
    peak_of,
)
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

Array = NDArray[np.float64]

EARLIEST_STOP = 0.02
"""Shortest stretch of free motion after which a sample may count as decayed [s]."""

GROWN = 1e9
"""Bands beyond which a sample is given up: its loop is unstable."""

BLOCK = 16
"""Position cycles whose signals are looked at together (measured: more leave the cache)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signals:
    """What is bounded besides the tool's deviation.

    Parameters
    ----------
    rows
        Over the loop's state, shape (n_signals, n). The last one is the motor force where
        ``continuous`` is finite (its RMS is bounded).
    bounds
        Largest allowed magnitude of the others [own units].
    names
        Of everything that is bounded here, as in the verdict.
    contour
        Bound on the tool's deviation along the path [m].
    continuous, static_load
        Bound on the RMS force, and the load that adds to it [N].
    tool_noise, force_noise
        What the steps of the encoder add to the tool's position and to the set force [m, N].
    """

    rows: Array
    bounds: Array
    names: tuple[Requirement, ...]
    contour: float
    continuous: float
    static_load: float
    tool_noise: float
    force_noise: float


def bounded_signals(machine: Machine, plant: Plant, loop: SampledLoop) -> Signals:
    """Return set force, bounded peaks, contour, and the motor force where its RMS is bounded.

    Parameters
    ----------
    machine, plant, loop
        Nominal.

    Returns
    -------
    Signals
    """
    drive, needs, size = machine.drive, machine.requirements, loop.own_size
    noise = encoder_noise(loop, resolution=drive.encoder_resolution)
    outputs = loop.observation[:, :size]
    states = outputs[-plant.order :]
    rows = [
        outputs[loop.outputs.index("force")],
        *(plant.row(p.name) @ states for p in needs.peaks),
    ]
    names = [SET_FORCE, *(peak_of(peak.name) for peak in needs.peaks)]
    if isfinite(needs.contour_deviation):
        names.append(CONTOUR_DEVIATION)
    if isfinite(drive.continuous_force):
        rows.append(states[plant.force])
        names.append(RMS_FORCE)
    return Signals(
        rows=np.array(rows),
        bounds=np.array([drive.motion_force, *(peak.bound for peak in needs.peaks)]),
        names=tuple(names),
        contour=needs.contour_deviation,
        continuous=drive.continuous_force,
        static_load=drive.static_load,
        tool_noise=noise.tool,
        force_noise=noise.force,
    )


@dataclass(slots=True, kw_only=True, eq=False)
class BatchRun:
    """What is known so far of the motion of one chunk.

    Parameters
    ----------
    settling, residual
        Shape (n_samples,) [s, m].
    peaks
        Of the signals with a bound, shape (n_samples, n_bounds).
    contour
        Largest |e| of the tool, where its path is bounded, shape (n_samples,) [m].
    first, square
        Integrals of the motor force and of its square over [0, t_e + dwell], (n_samples,).
    X
        Loop state of the samples that still move, shape (n_alive, n, 1).
    alive
        Which samples those are.
    last
        Their latest deviation, shape (n_alive,) [m]; empty before the first stretch.
    """

    settling: Array
    residual: Array
    peaks: Array
    contour: Array
    first: Array
    square: Array
    X: Array
    alive: NDArray[np.intp]
    last: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Course:
    """One setpoint on its way through the loop; ``fed`` is what it hands down at each cycle."""

    loop: SampledLoop
    signals: Signals
    setpoint: Setpoint
    fed: Array


@np.errstate(over="ignore", invalid="ignore")  # an unstable loop grows beyond all numbers
def run_batch(
    machine: Machine,
    loop: SampledLoop,
    rows: Array,
    signals: Signals,
    setpoint: Setpoint,
) -> BatchRun:
    """Return settling time, residual and use of the bounds of one setpoint on a chunk of samples.

    Parameters
    ----------
    machine, loop
        Nominal.
    rows
        The loops of the chunk, from ``lift_on_plants`` with these signals.
    signals
        What is bounded.
    setpoint
        Filters included.

    Returns
    -------
    BatchRun
        Settling time and residual are inf where a sample is outside the band even in the last
        stretch of the horizon.
    """
    T_p, until = loop.controller.position_cycle, setpoint.duration + loop.controller.reference_delay
    band = machine.requirements.tcp_deviation
    first = int(until / T_p)
    stretch = ceil(max(min(longest_period(loop.plant), 0.2), EARLIEST_STOP) / T_p)
    last = first + ceil(HORIZON / T_p)
    fed = hand_down_setpoint(loop, setpoint, last + stretch)
    course = _Course(loop=loop, signals=signals, setpoint=setpoint, fed=fed)
    run = _at_rest(rows, signals, until=until)
    if isfinite(signals.contour):
        for start in range(0, first, BLOCK):
            tip = _advance(run, course, rows, start, min(start + BLOCK, first))
            _note_contour(run, course, tip, start)
    else:
        tool = loop.controller.cycles
        _advance(run, course, np.ascontiguousarray(rows[:, :-tool]), 0, first)
    for start in range(first, last, stretch):
        tip = _advance(run, course, rows, start, start + stretch)
        _note_contour(run, course, tip, start)
        t, e = _deviation(course, tip, start, until=until)
        size = _note(run, t, np.abs(e), band=band)
        grown = ~(size <= GROWN * band)  # not a number any more, too
        _give_up(run, run.alive[grown])
        moving = (size > DECAYED * band) & ~grown
        run.alive, run.X, run.last = (
            run.alive[moving],
            run.X[moving],
            run.last[moving],
        )
        rows = rows[moving]
        if not run.alive.size:
            return run
    lost = run.alive[size[moving] > band]
    run.settling[lost], run.residual[lost] = inf, inf
    return run


def _give_up(run: BatchRun, lost: NDArray[np.intp]) -> None:
    """Note that some samples keep nothing: their loops are unstable."""
    for values in (run.settling, run.residual, run.peaks, run.contour, run.square):
        values[lost] = inf
    run.first[lost] = 0.0


def _at_rest(rows: Array, signals: Signals, *, until: float) -> BatchRun:
    count, n = len(rows), rows.shape[2]
    return BatchRun(
        settling=np.full(count, until),
        residual=np.zeros(count),
        peaks=np.zeros((count, len(signals.bounds))),
        contour=np.zeros(count),
        first=np.zeros(count),
        square=np.zeros(count),
        X=np.zeros((count, n, 1)),
        alive=np.arange(count),
    )


def _advance(run: BatchRun, course: _Course, rows: Array, start: int, stop: int) -> Array:
    """Advance by some position cycles; return what ``rows`` hold behind the signals.

    That is the tool at every velocity cycle, shape (n_alive, n_cycles of both), if anything.
    """
    n, held = rows.shape[2], course.loop.held
    behind = n + len(course.signals.rows) * course.loop.controller.cycles
    tips = []
    for begin in range(start, stop, BLOCK):
        count = min(BLOCK, stop - begin)
        spend(0.5 * count * rows.size, calls=0.5 * count + 10)
        seen = np.empty((len(rows), count, rows.shape[1] - n))
        for k in range(count):
            Y = rows @ run.X
            seen[:, k] = Y[:, n:, 0]
            run.X = Y[:, :n]
            run.X[:, held:, 0] += course.fed[begin + k]
        _note_signals(run, course, seen[:, :, : behind - n], begin)
        tips.append(seen[:, :, behind - n :].reshape(len(rows), -1))
    return np.concatenate(tips, axis=1) if tips else np.zeros((len(rows), 0))


def _note_signals(run: BatchRun, course: _Course, values: Array, begin: int) -> None:
    """Add a block of the bounded signals, shape (n_alive, n_block, n_signals velocity cycles)."""
    controller, signals, setpoint = course.loop.controller, course.signals, course.setpoint
    cycles, step, alive = controller.cycles, controller.velocity_cycle, run.alive
    values = values.reshape(len(alive), values.shape[1], -1, cycles)
    peaks = np.abs(values[:, :, : len(signals.bounds)]).max(axis=(1, 3))
    run.peaks[alive] = np.maximum(run.peaks[alive], peaks)
    if isfinite(signals.continuous):
        t: Array = step * np.arange(values.shape[1] * cycles, dtype=np.float64)
        t += begin * controller.position_cycle
        window = setpoint.duration + setpoint.move.dwell
        share = window_shares(t, window, step=step)
        force = values[:, :, -1].reshape(len(alive), -1)
        run.first[alive] += force @ share
        run.square[alive] += force**2 @ share


def shares_of_bounds(run: BatchRun, signals: Signals, setpoint: Setpoint) -> Array:
    """Return the share of every bound that is used, shape (n_samples, n_names) [-].

    Parameters
    ----------
    run
        From ``run_batch``.
    signals, setpoint
        What it was run with. The motion may go either way against the static load.

    Returns
    -------
    ndarray
    """
    used = run.peaks / signals.bounds
    used[:, 0] += signals.force_noise / signals.bounds[0]
    if isfinite(signals.contour):
        used = np.column_stack([used, (run.contour + signals.tool_noise) / signals.contour])
    if isfinite(signals.continuous):
        window, load = setpoint.duration + setpoint.move.dwell, signals.static_load
        rms = rms_force(run.first, run.square, window=window, static_load=load)
        rms = np.hypot(rms, signals.force_noise / SIGMAS)
        used = np.column_stack([used, rms / signals.continuous])
    return np.asarray(used)


def _note_contour(run: BatchRun, course: _Course, tip: Array, start: int) -> None:
    """Add what the tool deviates along the path, from a position cycle on."""
    e = tip - _delayed_reference(course, tip.shape[1], start)[1]
    run.contour[run.alive] = np.maximum(run.contour[run.alive], np.abs(e).max(axis=1))


def _delayed_reference(course: _Course, count: int, start: int) -> tuple[Array, Array]:
    """Instants of velocity cycles from a position cycle on, and where the tool should be."""
    controller = course.loop.controller
    t: Array = controller.velocity_cycle * np.arange(count, dtype=np.float64)
    t += start * controller.position_cycle
    return t, sample_setpoint(course.setpoint, t - controller.reference_delay)[:, 0]


def _deviation(course: _Course, tip: Array, start: int, *, until: float) -> tuple[Array, Array]:
    """Instants and deviations of a stretch of free motion, those before t_e + τ left out.

    t_e + τ lies between two samples: there the tool is interpolated against the setpoint that by
    then rests or coasts.
    """
    setpoint = course.setpoint
    t, reference = _delayed_reference(course, tip.shape[1], start)
    e = tip - reference
    begin = int(np.argmax(t >= until - 1e-12))
    if begin == 0:
        return t, e
    end, speed = sample_setpoint(setpoint, np.array([setpoint.duration]))[0, :2]
    before = tip[:, begin - 1] - end - speed * (t[begin - 1] - until)
    share = (until - t[begin - 1]) / (t[begin] - t[begin - 1])
    at_end = before + share * (e[:, begin] - before)
    return np.append(until, t[begin:]), np.column_stack([at_end, e[:, begin:]])


def _note(run: BatchRun, t: Array, e: Array, *, band: float) -> Array:
    """Add a stretch of |e| to what is known; return its largest, shape (n_alive,)."""
    alive = run.alive
    run.residual[alive] = np.maximum(run.residual[alive], e.max(axis=1))
    if run.last.size:  # a crossing may lie between two stretches
        e = np.hstack([run.last[:, None], e])
        t = np.append(2.0 * t[0] - t[1], t)
    outside = e > band
    row = np.flatnonzero(outside.any(axis=1))
    final = e.shape[1] - 1 - np.argmax(outside[row, ::-1], axis=1)
    following = np.minimum(final + 1, e.shape[1] - 1)
    here, there = e[row, final], e[row, following]
    crosses = following > final
    share = np.where(crosses, (here - band) / np.where(crosses, here - there, 1.0), 0.0)
    run.settling[alive[row]] = t[final] + (t[following] - t[final]) * share
    run.last = e[:, -1]
    return np.asarray(e.max(axis=1))
