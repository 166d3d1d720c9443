"""What limits use of each bound, before they are judged exactly: the worst of all sizes, quickly.

All smaller moves of a listed one are families with one free time (docs/every-size.md): a ramp t
that does not reach a, a time T for which a is held, a time T₂ at ``max_velocity``. What is left of
the first depends on the jerk alone, of the second on t_j as well, both in proportion to the jerk:
each is computed once, for all accelerations. The third is computed for each.

Looked at are all corners, and the first swings of each pole that counts, where several ramps add
up most; later ones only grow less. ``limits.verify`` has the last word.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isfinite, log, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.quantisation import encoder_noise
from mtcommission.loop.mean_response import MeanResponse, average_phases
from mtcommission.loop.respond import (
    RAMPS,
    LoopPoles,
    extremes,
    find_poles,
    lay_grid,
    set_in_motion,
    where_signals_lead,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, Move, Positioning, VelocityStep, moving_mass
from mtcommission.machine.requirement import slow_to_feed
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.verdict.every_size import rigid_rms

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Cycles = NDArray[np.int64]

SAMPLES = 12
"""Samples to a period, of free motion and of the free times (empirical: 3 % of a swing's peak)."""

SWINGS = 1.75
"""Periods of each pole for which free times are looked at densely (empirical)."""

COUNTS = 0.03
"""A pole counts if ramps excite it to this share of the one that they excite most [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """A machine whose requirements count as they stand, and its loop, ready for many limits."""

    machine: Machine
    poles: LoopPoles  # in every corner
    mean: MeanResponse
    leading: tuple[LoopPoles, Cycles]  # where signals swing furthest
    signals: Array  # set force and bounded peaks, rows over the outputs of a velocity cycle
    bounds: Array  # what encoder noise leaves of theirs [own units]
    band: float  # the same of the band [m]
    contour: float  # and of the contour deviation; inf: none is asked for [m]
    ages: Array  # free times looked at beyond the least of a family [s]
    every_size: bool
    behind: dict[SetpointFilter | None, BehindFilter] = field(default_factory=dict)

    @property
    def delay(self) -> float:
        """τ [s]."""
        return self.poles.delay

    def durations(self, item: SetpointFilter | None, a: Array, t_j: Array | float) -> Array:
        """Return t_e of the slowest listed move, shape of ``a`` [s]."""
        jerk = a / t_j
        each = [jerk_steps(move, acceleration=a, jerk=jerk).duration for move in self.machine.moves]
        return np.asarray(np.max(each, axis=0) + (item.duration if item else 0.0))

    def use(self, item: SetpointFilter | None, t_j: float) -> Use:
        """Return what limits with a filter and a jerk time use."""
        if item not in self.behind:
            self.behind[item] = BehindFilter(bench=self, item=item, factor=self.mean.behind(item))
        return Use(behind=self.behind[item], t_j=t_j)


def build_bench(machine: Machine, plant: Plant, tuned: TunedLoop) -> Bench:
    """Return the bench of a machine, encoder noise taken off what is allowed."""
    needs, drive, n = machine.requirements, machine.drive, plant.order
    noises = [encoder_noise(loop, resolution=drive.encoder_resolution) for loop in tuned.loops]
    tool, force = max(item.tool for item in noises), max(item.force for item in noises)
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])  # tcp, encoder, force, then the states
    rows = [np.eye(n + 3)[2], *(outputs @ plant.row(peak.name) for peak in needs.peaks)]
    poles = find_poles(tuned.loops)
    return Bench(
        machine=machine,
        poles=poles,
        mean=average_phases(poles),
        leading=where_signals_lead(poles, np.array(rows)),
        signals=np.array(rows),
        bounds=np.array([_left(drive.motion_force, force), *(peak.bound for peak in needs.peaks)]),
        band=_left(needs.tcp_deviation, tool),
        contour=_left(needs.contour_deviation, tool),
        ages=_ages(poles),
        every_size=needs.every_size,
    )


def _left(bound: float, noise: float) -> float:
    """What noise leaves of a bound; hardly anything where that is nothing."""
    return max(bound - noise, 1e-3 * bound)


def counting_poles(poles: LoopPoles) -> Complex:
    """Return the nominal poles that ramps excite at the tool, in the continuous plane [1/s]."""
    p = poles.rates[0]
    sizes = np.abs(poles.shapes[0, :, 0]).max(axis=0) * np.abs(poles.starts[3, 0])
    there = np.flatnonzero(sizes > 0.0)
    excited = [sizes[there] * np.minimum(np.abs(p[there]) * t, 2.0) ** 2 for t in RAMPS]
    counts = np.any([each >= COUNTS * each.max(initial=0.0) for each in excited], axis=0)
    return np.asarray(p[there[counts]])


def _ages(poles: LoopPoles) -> Array:
    """Free times that meet the swings of every pole of the nominal loop that counts."""
    found, gone = [np.zeros(1)], 1e-3
    for pole in counting_poles(poles):
        period, fades = 2.0 * pi / abs(pole), log(1e3) / max(-pole.real, 1e-9)
        dense = min(SWINGS * period, fades)
        found.append(np.arange(0.0, dense, period / SAMPLES))
        found.append(np.geomspace(dense, max(fades, 1.01 * dense), 9))
        gone = max(gone, fades)
    ages = np.unique(np.concatenate(found))
    finest = np.min(np.diff(ages[:2])) if len(ages) > 1 else gone
    return np.asarray(ages[np.append(True, np.diff(ages) > 0.3 * finest)])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BehindFilter:
    """What all limits behind a setpoint filter share: ramps that do not reach a, and more."""

    bench: Bench
    item: SetpointFilter | None
    factor: Complex  # of the mean response
    pointed: dict[type[Move], tuple[Array, Array]] = field(default_factory=dict)
    held: dict[tuple[type[Move], float], tuple[Array, Array]] = field(default_factory=dict)

    def worst_of(self, steps: JerkSteps) -> Array:
        """Return the residual of each setpoint in its worst corner, shape (n_setpoints,) [m]."""
        return self.bench.mean.residual(steps, self.item, self.factor)

    def peaks(self, steps: JerkSteps) -> Array:
        """Return the largest of each signal, worst corner, shape (n_setpoints, n_signals)."""
        poles, parts = self.bench.leading
        motions = set_in_motion(poles, filter_steps(steps, self.item))
        grid = lay_grid(poles, SAMPLES)
        found = extremes(motions, grid, self.bench.signals, parts=parts, with_deviation=False)
        return np.asarray(found.peaks.max(axis=1))

    def contour(self, steps: JerkSteps) -> float:
        """Return the largest deviation along the path, worst corner and setpoint [m]."""
        poles, none = self.bench.poles, self.bench.signals[:0]
        motions, parts = set_in_motion(poles, filter_steps(steps, self.item)), np.zeros(1, np.int64)
        grid = lay_grid(poles, SAMPLES)
        found = extremes(motions, grid, none, parts=parts, with_deviation=True)
        return float(found.deviation.max())

    def worst_pointed(self, kind: type[Move], most: Array) -> Array:
        """Return the worst of ramps up to some that do not reach a [m per m/s³]."""
        if kind not in self.pointed:
            t = _finer(self.bench.ages)[1:]
            size = t**2 if kind is VelocityStep else 2.0 * t**3
            steps = _unlimited(kind, a=np.full_like(t, inf), size=size)
            self.pointed[kind] = t, np.maximum.accumulate(self.worst_of(steps))
        return _up_to(*self.pointed[kind], most)

    def worst_held(self, kind: type[Move], t_j: float, most: Array) -> Array:
        """Return the worst of times up to some for which a is held [m per m/s³]."""
        if (kind, t_j) not in self.held:
            T = t_j + self.bench.ages
            size = t_j * T if kind is VelocityStep else t_j * T * (T + t_j)
            steps = _unlimited(kind, a=np.full_like(T, t_j), size=size)
            self.held[kind, t_j] = T, np.maximum.accumulate(self.worst_of(steps))
        return _up_to(*self.held[kind, t_j], most)


def _finer(ages: Array) -> Array:
    """Twice as many: two ramps are as long as the free time, which counts twice."""
    return np.sort(np.concatenate([ages, 0.5 * (ages[:-1] + ages[1:])]))


def _unlimited(kind: type[Move], *, a: Array, size: Array) -> JerkSteps:
    """Setpoints at a jerk of 1 that no velocity limits."""
    move = VelocityStep(velocity_step=1.0) if kind is VelocityStep else Positioning(distance=1.0)
    a = np.where(np.isfinite(a), a, 1e6)
    return jerk_steps(move, acceleration=a, jerk=np.ones_like(a), size=size)


def _up_to(times: Array, rising: Array, most: Array) -> Array:
    """The worst of all times up to some, and of the next one."""
    place = np.searchsorted(times, most * (1.0 + 1e-9))
    return np.asarray(np.where(most > 0.0, rising[np.minimum(place, len(times) - 1)], 0.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Use:
    """Shares of what is allowed that limits with one filter and one jerk time use."""

    behind: BehindFilter
    t_j: float

    @property
    def bench(self) -> Bench:
        """Whose requirements count."""
        return self.behind.bench

    def of_band(self, a: Array) -> Array:
        """Return the share of the band, sizes that reach ``max_velocity`` apart, shape of ``a``."""
        used = np.zeros_like(a)
        for move in self.bench.machine.moves:
            used = np.maximum(used, self._of_move(move, a))
        return used

    def _of_move(self, move: Move, a: Array) -> Array:
        jerk, kind = a / self.t_j, type(move)
        steps = jerk_steps(move, acceleration=a, jerk=jerk)
        if not self.bench.every_size:
            return self.behind.worst_of(steps) / self.bench.band
        ramp, rise = steps.times[:, 1], steps.times[:, 2]
        worst = self.behind.worst_pointed(kind, ramp)
        reached = ramp >= self.t_j * (1.0 - 1e-9)
        if reached.any():
            held = self.behind.worst_held(kind, self.t_j, np.where(reached, rise, 0.0))
            worst = np.maximum(worst, held)
        return jerk * worst / self.bench.band

    def of_cruise(self, a: Array) -> Array:
        """Return the share of the band of sizes that reach ``max_velocity``, shape of ``a`` [-]."""
        used, bench = np.zeros_like(a), self.bench
        for move in bench.machine.moves:
            is_bounded = isinstance(move, Positioning) and isfinite(move.max_velocity)
            if not (bench.every_size and is_bounded):
                continue
            assert isinstance(move, Positioning)
            own = jerk_steps(move, acceleration=a, jerk=a / self.t_j).times
            cruise = own[:, 4] - own[:, 3]
            sizes = move.max_velocity * (own[:, 3:4] + np.minimum(bench.ages, cruise[:, None]))
            full = np.repeat(a, len(bench.ages))
            steps = jerk_steps(move, acceleration=full, jerk=full / self.t_j, size=sizes.ravel())
            worst = self.behind.worst_of(steps).reshape(sizes.shape).max(axis=1)
            used = np.maximum(used, np.where(cruise > 0.0, worst / bench.band, 0.0))
        return used

    def of_rest(self, a: float) -> float:
        """Return the largest share of force, peaks, contour and RMS force in some sizes [-].

        Or that of the RMS force alone, where that is too much.
        """
        bench, item = self.bench, self.behind.item
        used = rms_share(bench.machine, item, a, self.t_j)
        is_alone = len(bench.bounds) == 1 and not isfinite(bench.contour)
        # Far from the limit the force need not be looked at: no loop swings that far.
        rigid = heaviest(bench.machine) * a
        if used > BROKEN or (is_alone and SAFE * rigid < bench.bounds[0]):
            return used
        for move in bench.machine.moves:
            shares = np.array(SIZES) if bench.every_size else np.ones(1)
            peaks = self.behind.peaks(self._sizes(move, shares, a))
            used = max(used, float((peaks / bench.bounds).max()))
            if isfinite(bench.contour):
                slower = slow_to_feed(move, bench.machine.requirements.contour_feed)
                deviation = self.behind.contour(self._sizes(slower, shares, a))
                used = max(used, deviation / bench.contour)
        return used

    def _sizes(self, move: Move, shares: Array, a: float) -> JerkSteps:
        """Some sizes of a move, and those that just reach the acceleration."""
        if self.bench.every_size:
            reach = _just_reached(move, a, self.t_j) / size_of(move)
            shares = np.unique(np.clip(np.append(shares, [reach, 1.3 * reach]), 1e-6, 1.0))
        full = np.full_like(shares, a)
        sizes = shares * size_of(move)
        return jerk_steps(move, acceleration=full, jerk=full / self.t_j, size=sizes)


SIZES = (0.03, 0.2, 0.5, 1.0)
"""Sizes of a move at which force, peaks and contour are looked at, beside where a is reached."""


def _just_reached(move: Move, a: float, t_j: float) -> float:
    """Size of the move that just reaches the acceleration, own unit."""
    return a * t_j if isinstance(move, VelocityStep) else 2.0 * a * t_j**2


BROKEN = 1.01
"""Share of the RMS force at which nothing else need be looked at [-]."""

SAFE = 2.0
"""Factor by which a loop may ask for more force than the rigid axis, at most [-] (empirical)."""

RMS_SIZES = (0.05, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Sizes of a move at which the RMS force is looked at, as shares of the listed one."""


def heaviest(machine: Machine) -> float:
    """Return the moving mass with the largest payload [kg]."""
    return moving_mass(machine) + max(machine.requirements.payload)


def rms_share(machine: Machine, item: SetpointFilter | None, a: float, t_j: float) -> float:
    """Return the share of the RMS force that the rigid axis uses, heaviest payload [-]."""
    drive, needs, worst = machine.drive, machine.requirements, 0.0
    most = float(np.hypot(heaviest(machine) * a, drive.static_load))
    if not isfinite(drive.continuous_force) or most < drive.continuous_force:
        return 0.0
    for move in machine.moves:
        sizes = size_of(move) * np.array(RMS_SIZES if needs.every_size else (1.0,))
        full = np.full_like(sizes, a)
        steps = filter_steps(jerk_steps(move, acceleration=full, jerk=full / t_j, size=sizes), item)
        worst = max(worst, float(rigid_rms(machine, move, steps).max()))
    return worst / drive.continuous_force
