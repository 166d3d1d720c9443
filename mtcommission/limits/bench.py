"""What limits use of each bound, before they are judged exactly: the worst of all sizes, quickly.

All smaller moves of a listed one are families with one free time (docs/every-size.md): a ramp t
that does not reach a, a time T for which a is held, a time T₂ at ``max_velocity``. What is left of
the first depends on the jerk alone, of the second on t_j as well, both in proportion to the jerk:
each is computed once, for all accelerations. The third is computed for each.

Looked at are all corners, and the first swings of each pole that counts, where several ramps add
up most; later ones only grow less. ``limits.verify`` has the last word.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import inf, isfinite, log, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.quantisation import EncoderNoise, encoder_noise
from mtcommission.loop.respond import (
    RAMPS,
    LoopPoles,
    extremes,
    find_poles,
    free_motion,
    lay_grid,
    set_in_motion,
    where_signals_lead,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, Move, Positioning, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.plant.plant import Plant
from mtcommission.requirements.requirement import Mean, Requirement
from mtcommission.requirements.together import Asked, Swings, sort_requirements
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps
from mtcommission.setpoint.smaller_moves import size_of

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
    asked: Asked
    noise: EncoderNoise  # in the worst corner
    band: float  # what it leaves of the band in which moves settle [m]
    left_after: Array  # and of each bound on what is judged after the move [own units]
    left_during: tuple[Array, ...]  # and during it
    leading: tuple[tuple[LoopPoles, Cycles], ...]  # where signals during the move swing furthest
    parts: Cycles  # velocity cycles of a position cycle at which free motion is looked at
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
            self.behind[item] = BehindFilter(bench=self, item=item)
        return Use(behind=self.behind[item], t_j=t_j)


def build_bench(machine: Machine, plant: Plant, tuned: TunedLoop) -> Bench:
    """Return the bench of a machine, encoder noise taken off what is allowed."""
    resolution = machine.drive.encoder_resolution
    noises = [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]
    noise = EncoderNoise(tool=max(n.tool for n in noises), force=max(n.force for n in noises))
    poles, asked = find_poles(tuned.loops), sort_requirements(machine, plant)

    def left(requirements: Iterable[Requirement]) -> Array:
        none = np.zeros(1)
        pairs = [(item.bound(machine), item.with_noise(none, noise)[0]) for item in requirements]
        return np.array([_left(bound, taken) for bound, taken in pairs])

    return Bench(
        machine=machine,
        poles=poles,
        asked=asked,
        noise=noise,
        band=_left(machine.requirements.tcp_deviation, noise.tool),
        left_after=left(requirement for requirement, _ in asked.after),
        left_during=tuple(left(swings.requirements) for swings in asked.during),
        leading=tuple(_where_to_look(poles, swings) for swings in asked.during),
        parts=_parts(poles),
        ages=_ages(poles),
        every_size=machine.requirements.every_size,
    )


def _where_to_look(poles: LoopPoles, swings: Swings) -> tuple[LoopPoles, Cycles]:
    """Corners and velocity cycles; what follows the setpoint is off most in any corner."""
    if swings.less is None:
        return where_signals_lead(poles, swings.rows)
    return poles, np.zeros(1, np.int64)


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


def _parts(poles: LoopPoles) -> Cycles:
    """Velocity cycles of a position cycle that meet the fastest pole that counts often enough."""
    fastest = np.max(np.abs(counting_poles(poles)), initial=1.0)
    stride = max(int(2.0 * pi / (SAMPLES * fastest * poles.velocity_cycle)), 1)
    return np.arange(0, poles.cycles, min(stride, poles.cycles))


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
    pointed: dict[type[Move], tuple[Array, Array]] = field(default_factory=dict)
    held: dict[tuple[type[Move], float], tuple[Array, Array]] = field(default_factory=dict)

    def worst_after(self, steps: JerkSteps) -> Array:
        """Return what is left after each setpoint, worst corner, (n_setpoints, n_requirements)."""
        poles = self.bench.poles
        motions, grid = (
            set_in_motion(poles, filter_steps(steps, self.item)),
            lay_grid(poles, SAMPLES),
        )
        found = [
            free_motion(motions, grid, parts=self.bench.parts, signal=signal).residual.max(axis=1)
            for _, signal in self.bench.asked.after
        ]
        return np.stack(found, axis=1)

    def worst_during(self, place: int, steps: JerkSteps) -> Array:
        """Return the largest of swings looked at together, worst corner, (n_setpoints, n_rows)."""
        (poles, parts), swings = self.bench.leading[place], self.bench.asked.during[place]
        motions, grid = (
            set_in_motion(poles, filter_steps(steps, self.item)),
            lay_grid(poles, SAMPLES),
        )
        found = extremes(motions, grid, swings.rows, parts=parts, less=swings.less)
        return np.asarray(found.max(axis=1))

    def worst_pointed(self, kind: type[Move], most: Array) -> Array:
        """Return the worst of ramps up to some that do not reach a [per m/s³]."""
        if kind not in self.pointed:
            t = _finer(self.bench.ages)[1:]
            size = t**2 if kind is VelocityStep else 2.0 * t**3
            steps = _unlimited(kind, a=np.full_like(t, inf), size=size)
            self.pointed[kind] = t, np.maximum.accumulate(self.worst_after(steps))
        return _up_to(*self.pointed[kind], most)

    def worst_held(self, kind: type[Move], t_j: float, most: Array) -> Array:
        """Return the worst of times up to some for which a is held [per m/s³]."""
        if (kind, t_j) not in self.held:
            T = t_j + self.bench.ages
            size = t_j * T if kind is VelocityStep else t_j * T * (T + t_j)
            steps = _unlimited(kind, a=np.full_like(T, t_j), size=size)
            self.held[kind, t_j] = T, np.maximum.accumulate(self.worst_after(steps))
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
    found = rising[np.minimum(place, len(times) - 1)]
    return np.asarray(np.where(most[:, None] > 0.0, found, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Use:
    """Shares of what is allowed that limits with one filter and one jerk time use."""

    behind: BehindFilter
    t_j: float

    @property
    def bench(self) -> Bench:
        """Whose requirements count."""
        return self.behind.bench

    def of_after(self, a: Array) -> Array:
        """Return the share of what is judged after the move, but ``of_cruise``, shape of ``a``."""
        used = np.zeros_like(a)
        for move in self.bench.machine.moves:
            used = np.maximum(used, self._of_move(move, a))
        return used

    def _of_move(self, move: Move, a: Array) -> Array:
        jerk, kind = a / self.t_j, type(move)
        steps = jerk_steps(move, acceleration=a, jerk=jerk)
        if not self.bench.every_size:
            return np.asarray((self.behind.worst_after(steps) / self.bench.left_after).max(axis=1))
        ramp, rise = steps.times[:, 1], steps.times[:, 2]
        worst = self.behind.worst_pointed(kind, ramp)
        reached = ramp >= self.t_j * (1.0 - 1e-9)
        if reached.any():
            held = self.behind.worst_held(kind, self.t_j, np.where(reached, rise, 0.0))
            worst = np.maximum(worst, held)
        return np.asarray((jerk[:, None] * worst / self.bench.left_after).max(axis=1))

    def of_cruise(self, a: Array) -> Array:
        """Return the same of sizes that reach ``max_velocity``, shape of ``a`` [-]."""
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
            worst = self.behind.worst_after(steps).reshape(*sizes.shape, -1).max(axis=1)
            share = (worst / self.bench.left_after).max(axis=1)
            used = np.maximum(used, np.where(cruise > 0.0, share, 0.0))
        return used

    def of_rest(self, a: float) -> float:
        """Return the largest share of what is judged during the move, in some sizes [-].

        Or that of the means alone, where that is too much.
        """
        bench = self.bench
        used = max((self._of_mean(*item, a) for item in bench.asked.means), default=0.0)
        during = list(zip(bench.asked.during, bench.left_during, strict=True))
        # Far from the limit a response need not be looked at.
        is_far = all(
            requirement.at_most(bench.machine, a) < left
            for swings, own in during
            for requirement, left in zip(swings.requirements, own, strict=True)
        )
        if used > BROKEN or is_far:
            return used
        shares = np.array(SIZES) if bench.every_size else np.ones(1)
        for place, (swings, left) in enumerate(during):
            for move in swings.moves:
                worst = self.behind.worst_during(place, self._sizes(move, shares, a))
                used = max(used, float((worst / left).max()))
        return used

    def _of_mean(self, requirement: Requirement, mean: Mean, a: float) -> float:
        """The share of a mean that the rigid axis uses [-]."""
        machine, worst = self.bench.machine, 0.0
        bound = requirement.bound(machine)
        if requirement.at_most(machine, a) < bound:
            return 0.0
        for move in machine.moves:
            sizes = size_of(move) * np.array(MEAN_SIZES if self.bench.every_size else (1.0,))
            full = np.full_like(sizes, a)
            steps = jerk_steps(move, acceleration=full, jerk=full / self.t_j, size=sizes)
            found = mean.estimate(machine, move, filter_steps(steps, self.behind.item))
            worst = max(worst, float(found.max()))
        return worst / bound

    def _sizes(self, move: Move, shares: Array, a: float) -> JerkSteps:
        """Some sizes of a move, and those that just reach the acceleration."""
        if self.bench.every_size:
            reach = _just_reached(move, a, self.t_j) / size_of(move)
            shares = np.unique(np.clip(np.append(shares, [reach, 1.3 * reach]), 1e-6, 1.0))
        full = np.full_like(shares, a)
        sizes = shares * size_of(move)
        return jerk_steps(move, acceleration=full, jerk=full / self.t_j, size=sizes)


SIZES = (0.03, 0.2, 0.5, 1.0)
"""Sizes of a move at which swings are looked at, beside where a is reached."""


def _just_reached(move: Move, a: float, t_j: float) -> float:
    """Size of the move that just reaches the acceleration, own unit."""
    return a * t_j if isinstance(move, VelocityStep) else 2.0 * a * t_j**2


BROKEN = 1.01
"""Share of a mean at which nothing else need be looked at [-]."""

MEAN_SIZES = (0.05, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Sizes of a move at which means are looked at, as shares of the listed one."""
