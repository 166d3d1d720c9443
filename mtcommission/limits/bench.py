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
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.quantisation import encoder_noise
from mtcommission.loop.mean_response import MeanResponse, average_phases
from mtcommission.loop.respond import (
    LoopPoles,
    extremes,
    find_poles,
    free_motion,
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
from mtcommission.verdict.every_size import rigid_rms, rms_forces

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Cycles = NDArray[np.int64]

SAMPLES = 12
"""Samples to a period, of free motion and of the free times (empirical: 3 % of a swing's peak)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """A machine whose requirements count as they stand, and its loop, ready for many limits."""

    machine: Machine
    poles: LoopPoles  # in every corner
    mean: MeanResponse
    signals: Array  # set force and bounded peaks, rows over the outputs of a velocity cycle
    bounds: Array  # what encoder noise leaves of theirs [own units]
    band: float  # the same of the band [m]
    contour: float  # and of the contour deviation; inf: none is asked for [m]
    ages: Array  # free times looked at beyond the least of a family [s]
    aged: Complex  # what each has left of the mean response
    ramps: Array  # of sizes that do not reach the acceleration [s]
    every_size: bool
    behind: dict[SetpointFilter | None, BehindFilter] = field(default_factory=dict)
    excess: list[float] = field(default_factory=list)  # see ``Use.of_rms``, once it is known

    @property
    def delay(self) -> float:
        """τ [s]."""
        return self.poles.delay

    @property
    def leading(self) -> tuple[LoopPoles, Cycles]:
        """Where signals swing furthest."""
        return where_signals_lead(self.poles, self.signals)

    def durations(self, item: SetpointFilter | None, a: Array, t_j: Array | float) -> Array:
        """Return t_e of the slowest listed move, shape of ``a`` [s]."""
        jerk = a / t_j
        each = [jerk_steps(move, acceleration=a, jerk=jerk).duration for move in self.machine.moves]
        return np.asarray(np.max(each, axis=0) + (item.duration if item else 0.0))

    def use(self, item: SetpointFilter | None, t_j: Array | float) -> Use:
        """Return what limits with a filter and some jerk times use."""
        if item not in self.behind:
            self.behind[item] = BehindFilter(bench=self, item=item, factor=self.mean.behind(item))
        return Use(bench=self, behind=self.behind[item], t_j=np.asarray(t_j))


def build_bench(machine: Machine, plant: Plant, tuned: TunedLoop) -> Bench:
    """Return the bench of a machine, encoder noise taken off what is allowed."""
    needs, drive, n = machine.requirements, machine.drive, plant.order
    noises = [encoder_noise(loop, resolution=drive.encoder_resolution) for loop in tuned.loops]
    tool, force = max(item.tool for item in noises), max(item.force for item in noises)
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])  # tcp, encoder, force, then the states
    rows = [np.eye(n + 3)[2], *(outputs @ plant.row(peak.name) for peak in needs.peaks)]
    poles = find_poles(tuned.loops)
    mean = average_phases(poles)
    ages = mean.ages
    return Bench(
        machine=machine,
        poles=poles,
        mean=mean,
        signals=np.array(rows),
        bounds=np.array([_left(drive.motion_force, force), *(peak.bound for peak in needs.peaks)]),
        band=_left(needs.tcp_deviation, tool),
        contour=_left(needs.contour_deviation, tool),
        ages=ages,
        aged=mean.since(ages),
        # Two ramps are as long as the free time, which counts twice: half-way as well.
        ramps=np.sort(np.concatenate([ages[1:], 0.5 * (ages[:-1] + ages[1:])])),
        every_size=needs.every_size,
    )


def _left(bound: float, noise: float) -> float:
    """What noise leaves of a bound; hardly anything where that is nothing."""
    return max(bound - noise, 1e-3 * bound)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BehindFilter:
    """What all limits behind a setpoint filter share: ramps that do not reach a, and more."""

    bench: Bench
    item: SetpointFilter | None
    factor: Complex  # of the mean response
    pointed: dict[type[Move], Array] = field(default_factory=dict)
    held: dict[tuple[type[Move], float], Array] = field(default_factory=dict)

    def worst_of(self, steps: JerkSteps) -> Array:
        """Return the residual of each setpoint in its worst corner, shape (n_setpoints,) [m]."""
        return self.bench.mean.residual(steps, self.factor)

    def worst_exactly(self, steps: JerkSteps) -> Array:
        """Return the same at the very phases at which the steps fall, shape (n_setpoints,) [m]."""
        motions = set_in_motion(self.bench.poles, filter_steps(steps, self.item))
        free = free_motion(motions, lay_grid(self.bench.poles, SAMPLES))
        return np.asarray(free.residual.max(axis=1))

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
            ramp = self.bench.mean.since(self.bench.ramps)
            held = self.factor * (ramp - 1.0) ** 2
            if kind is Positioning:
                held = held * (ramp**2 - 1.0)
            self.pointed[kind] = np.maximum.accumulate(self.bench.mean.largest(held))
        return _up_to(self.bench.ramps, self.pointed[kind], most)

    def worst_held(self, kind: type[Move], t_j: Array, most: Array) -> Array:
        """Return the worst of times up to some for which a is held [m per m/s³]."""
        mean, ages = self.bench.mean, self.bench.ages
        times, row = np.unique(t_j, return_inverse=True)
        new = np.array([time for time in times.tolist() if (kind, time) not in self.held])
        if len(new):
            ramp = mean.since(new)[:, None]
            rise = ramp * self.bench.aged
            held = self.factor * (ramp - 1.0) * (rise - 1.0)
            if kind is Positioning:
                held = held * (rise * ramp - 1.0)
            worst = mean.largest(held.reshape(-1, *held.shape[2:])).reshape(len(new), -1)
            rising = np.maximum.accumulate(worst, axis=1)
            self.held.update(
                {(kind, t): each for t, each in zip(new.tolist(), rising, strict=True)}
            )
        rising = np.array([self.held[kind, time] for time in times.tolist()])
        place = np.searchsorted(ages, most * (1.0 + 1e-9) - t_j)
        found = rising[row, np.minimum(place, len(ages) - 1)]
        return np.asarray(np.where(most > 0.0, found, 0.0))


def lay_ages(move: Move, a: float, t_j: float, ages: Array, ramps: Array) -> Array:
    """Return sizes of a move whose free times have some ages, and its own [m/s or m]."""
    jerk, held = a / t_j, t_j + ages
    pointed = ramps[ramps < t_j]
    if isinstance(move, VelocityStep):
        found = [jerk * pointed**2, a * held]
    else:
        found = [2.0 * jerk * pointed**3, a * held * (held + t_j)]
        if isfinite(move.max_velocity):
            own = jerk_steps(move, acceleration=np.array([a]), jerk=np.array([jerk])).times[0]
            found.append(move.max_velocity * (own[3] + ages))
    sizes = np.concatenate([*found, [size_of(move)]])
    return np.asarray(sizes[sizes <= size_of(move)])


def _up_to(times: Array, rising: Array, most: Array) -> Array:
    """The worst of all times up to some, and of the next one."""
    place = np.searchsorted(times, most * (1.0 + 1e-9))
    return np.asarray(np.where(most > 0.0, rising[np.minimum(place, len(times) - 1)], 0.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Use:
    """Shares of what is allowed that limits with one filter use."""

    bench: Bench  # whose requirements count
    behind: BehindFilter
    t_j: Array  # jerk times, as many as accelerations asked for, or one for all [s]

    def of_band(self, a: Array) -> Array:
        """Return the share of the band, sizes that reach ``max_velocity`` apart, shape of ``a``."""
        used = np.zeros_like(a)
        for move in self.bench.machine.moves:
            used = np.maximum(used, self._of_move(move, a))
        return used

    def _of_move(self, move: Move, a: Array) -> Array:
        jerk, kind, t_j = a / self.t_j, type(move), np.broadcast_to(self.t_j, a.shape)
        steps = jerk_steps(move, acceleration=a, jerk=jerk)
        if not self.bench.every_size:
            return self.behind.worst_of(steps) / self.bench.band
        ramp, rise = steps.times[:, 1], steps.times[:, 2]
        worst = self.behind.worst_pointed(kind, ramp)
        reached = ramp >= t_j * (1.0 - 1e-9)
        if reached.any():
            held = self.behind.worst_held(kind, t_j, np.where(reached, rise, 0.0))
            worst = np.maximum(worst, held)
        return jerk * worst / self.bench.band

    def of_cruise(self, a: Array) -> Array:
        """Return the share of the band of sizes that reach ``max_velocity``, shape of ``a`` [-]."""
        used, bench, mean = np.zeros_like(a), self.bench, self.bench.mean
        for move in bench.machine.moves:
            is_bounded = isinstance(move, Positioning) and isfinite(move.max_velocity)
            if not (bench.every_size and is_bounded):
                continue
            steps = jerk_steps(move, acceleration=a, jerk=a / self.t_j)
            ramp, rise, up, fall = steps.times[:, 1:5].T
            cruise = fall - up
            held = self.behind.factor * (mean.since(ramp) - 1.0) * (mean.since(rise) - 1.0)
            each = held[:, None] * (mean.since(up)[:, None] * bench.aged - 1.0)
            worst = mean.largest(each.reshape(-1, *held.shape[1:])).reshape(len(a), -1)
            worst = (worst * (bench.ages <= cruise[:, None])).max(axis=1)
            worst = a / self.t_j * np.maximum(worst, mean.largest(held * (mean.since(fall) - 1.0)))
            used = np.maximum(used, np.where(cruise > 0.0, worst / bench.band, 0.0))
        return used

    def of_band_exactly(self, a: float) -> float:
        """Return the share of the band that the worst of some sizes uses at its phases [-]."""
        bench, worst = self.bench, 0.0
        for move in bench.machine.moves:
            sizes = np.array([size_of(move)])
            if bench.every_size:
                sizes = lay_ages(move, a, float(self.t_j), bench.ages, bench.ramps)
            full = np.full_like(sizes, a)
            steps = jerk_steps(move, acceleration=full, jerk=full / self.t_j, size=sizes)
            worst = max(worst, float(self.behind.worst_exactly(steps).max()))
        return worst / bench.band

    def of_rms(self, a: Array) -> Array:
        """Return the share of the RMS force, shape of ``a`` [-]."""
        t_j = np.broadcast_to(self.t_j, a.shape)
        share = rms_share(self.bench.machine, self.behind.item, a, t_j)
        if share.max(initial=0.0) <= NEAR:
            return share
        if not self.bench.excess:
            place = int(share.argmax())
            self.bench.excess.append(self._excess(float(a[place]), float(t_j[place])))
        return np.asarray(share * np.where(share > NEAR, self.bench.excess[0], 1.0))

    def _excess(self, a: float, t_j: float) -> float:
        """RMS force in the loop over that of the rigid axis: much the same for all limits [-]."""
        machine, item, full = self.bench.machine, self.behind.item, np.array([a])
        move, load = machine.moves[0], machine.drive.static_load
        steps = filter_steps(jerk_steps(move, acceleration=full, jerk=full / t_j), item)
        force = rms_forces(self.bench.poles, steps, move.dwell, static_load=load, most=RMS_CYCLES)
        return max(float(force.max() / rigid_rms(machine, move, steps)[0]), 1.0)

    def of_rest(self, a: float) -> float:
        """Return the largest share of force, peaks and contour in some sizes [-]."""
        bench, used = self.bench, 0.0
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
            reach = _just_reached(move, a, float(self.t_j)) / size_of(move)
            shares = np.unique(np.clip(np.append(shares, [reach, 1.3 * reach]), 1e-6, 1.0))
        full = np.full_like(shares, a)
        sizes = shares * size_of(move)
        return jerk_steps(move, acceleration=full, jerk=full / self.t_j, size=sizes)


SIZES = (0.03, 0.2, 0.5, 1.0)
"""Sizes of a move at which force, peaks and contour are looked at, beside where a is reached."""


def _just_reached(move: Move, a: float, t_j: float) -> float:
    """Size of the move that just reaches the acceleration, own unit."""
    return a * t_j if isinstance(move, VelocityStep) else 2.0 * a * t_j**2


NEAR, RMS_CYCLES = 0.9, 600
"""Share of the RMS force from which it is corrected by what the loop adds to that of the rigid
axis; position cycles that are summed for that."""

RMS_SIZES = (0.05, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Sizes of a move at which the RMS force is looked at, as shares of the listed one."""


def heaviest(machine: Machine) -> float:
    """Return the moving mass with the largest payload [kg]."""
    return moving_mass(machine) + max(machine.requirements.payload)


def rms_share(machine: Machine, item: SetpointFilter | None, a: Array, t_j: Array) -> Array:
    """Return the share of the RMS force that the rigid axis uses, heaviest payload, (n_a,) [-]."""
    drive, needs, worst = machine.drive, machine.requirements, np.zeros_like(a)
    most = np.hypot(heaviest(machine) * a.max(initial=0.0), drive.static_load)
    if most < drive.continuous_force:
        return worst
    shares = np.array(RMS_SIZES if needs.every_size else (1.0,))
    full, ramps = np.repeat(a, len(shares)), np.repeat(t_j, len(shares))
    for move in machine.moves:
        sizes = np.tile(size_of(move) * shares, len(a))
        steps = filter_steps(
            jerk_steps(move, acceleration=full, jerk=full / ramps, size=sizes), item
        )
        force = rigid_rms(machine, move, steps).reshape(len(a), -1).max(axis=1)
        worst = np.maximum(worst, force)
    return np.asarray(worst / drive.continuous_force)
