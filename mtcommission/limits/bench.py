"""What limits use of each bound, before they are judged exactly: the worst of all sizes, quickly.

All smaller moves of a listed one are families with one free time (docs/every-size.md): a ramp t
that does not reach a, a time T for which a is held, a time T₂ at ``max_velocity``. What is left of
the first depends on the jerk alone, of the second on t_j as well, both in proportion to the jerk:
each is computed once, for all accelerations. The third is computed for each.

Looked at are all corners, and the first swings of each pole that counts, where several ramps add
up most; later ones only grow less. ``limits.every_size`` has the last word.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.requirements import (
    Asked,
    Mean,
    Requirement,
    Swings,
    sort_requirements,
)
from mtcommission.loop.disturbance import EncoderNoise, worst_noise
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.residuals import Lapse, Modal, Residuals, find_residuals
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps
from mtcommission.setpoint.smaller_moves import size_of

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class During:
    """What is judged together during one listed move."""

    swings: Swings
    left: Array  # of each bound [own units]
    move: Move

    def expected(self, machine: Machine, acceleration: float) -> float:
        """Return the share that an acceleration [m/s²] is not expected to exceed [-]."""
        most = [each.at_most(machine, acceleration) for each in self.swings.requirements]
        return float(np.max(most / self.left))


@dataclass(slots=True, kw_only=True, eq=False)
class Learnt:
    """What is known of a bench by limits that were looked at: it only saves looking again."""

    behind: dict[SetpointFilter | None, Use] = field(default_factory=dict)
    excess: dict[str, float] = field(default_factory=dict)  # see ``Use.of_means``
    hardest: int = 0  # which of ``Bench.during`` used most the last time
    as_expected: set[int] = field(default_factory=set)  # which use no more than that


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """A machine whose requirements count as they stand, and its loop, ready for many limits."""

    machine: Machine
    poles: LoopPoles  # in every corner
    asked: Asked
    after: Residuals  # of what is judged after the move
    noise: EncoderNoise  # in the worst corner
    left_after: Array  # what it leaves of each bound on what is judged after the move [own units]
    during: tuple[During, ...]  # what is judged during the move
    ramps: Array  # of sizes that do not reach the acceleration [s]
    learnt: Learnt = field(default_factory=Learnt)

    @property
    def every_size(self) -> bool:
        """Whether every smaller move counts, too."""
        return self.machine.requirements.every_size

    def durations(self, item: SetpointFilter | None, a: Array, t_j: Array | float) -> Array:
        """Return t_e of the slowest listed move, shape of ``a`` [s]."""
        jerk = a / t_j
        each = [jerk_steps(move, acceleration=a, jerk=jerk).duration for move in self.machine.moves]
        return np.asarray(np.max(each, axis=0) + (item.duration if item else 0.0))

    def ramps_reached(self, a: Array, t_j: Array | float) -> Array:
        """Return the longest ramp of all listed moves, shape of ``a`` [s]."""
        moves = self.machine.moves
        each = [jerk_steps(move, acceleration=a, jerk=a / t_j).times[:, 1] for move in moves]
        return np.asarray(np.minimum(np.max(each, axis=0), t_j))

    def use(self, item: SetpointFilter | None) -> Use:
        """Return what limits behind a filter use."""
        known = self.learnt.behind
        if item not in known:
            known[item] = Use(bench=self, item=item, step=self.after.behind(item))
        return known[item]


def build_bench(machine: Machine, tuned: TunedLoop) -> Bench:
    """Return the bench of a machine, encoder noise taken off what is allowed."""
    noise = worst_noise(tuned.loops, machine.drive.encoder_resolution)
    poles, asked = find_poles(tuned.loops), sort_requirements(machine, tuned.plant)

    def left(requirements: Iterable[Requirement]) -> Array:
        none = np.zeros(1)
        pairs = [(item.bound(machine), item.with_noise(none, noise)[0]) for item in requirements]
        return np.array([_left(bound, taken) for bound, taken in pairs])

    after = find_residuals(poles, np.array([signal.row for _, signal in asked.after]))
    ages = after.ages.time
    return Bench(
        machine=machine,
        poles=poles,
        asked=asked,
        after=after,
        noise=noise,
        left_after=left(requirement for requirement, _ in asked.after),
        during=tuple(
            During(swings=swings, left=left(swings.requirements), move=move)
            for swings in asked.during
            for move in swings.moves
        ),
        # Two ramps are as long as the free time, which counts twice: half-way as well.
        ramps=np.sort(np.append(ages[1:], 0.5 * (ages[:-1] + ages[1:]))),
    )


def _left(bound: float, noise: float) -> float:
    """What noise leaves of a bound; hardly anything where that is nothing."""
    return max(bound - noise, 1e-3 * bound)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Use:
    """Shares of what is allowed that limits behind one setpoint filter use.

    Of accelerations [m/s²] and jerk times [s], as many or one for all. What is left by
    ramps that do not reach a, and by times for which it is held, is kept once it is known.
    """

    bench: Bench  # whose requirements count
    item: SetpointFilter | None
    step: Modal  # what one of the jerk leaves, by its phase
    pointed: dict[type[Move], Array] = field(default_factory=dict)
    held: dict[tuple[type[Move], float], Array] = field(default_factory=dict)

    def of_after(self, a: Array, t_j: Array | float) -> Array:
        """Return the share of what is judged after the move, but ``of_cruise``, shape of ``a``."""
        each = np.broadcast_to(t_j, a.shape)
        shares = [self._of_move(move, a, each) for move in self.bench.machine.moves]
        return np.asarray(np.max(shares, axis=0))

    def _of_move(self, move: Move, a: Array, t_j: Array) -> Array:
        jerk, kind = a / t_j, type(move)
        steps = jerk_steps(move, acceleration=a, jerk=jerk)
        if not self.bench.every_size:
            return self._worst_share(self.bench.after.of_moves(self.step, steps))
        ramp, rise = steps.times[:, 1], steps.times[:, 2]
        worst = self._worst_pointed(kind, ramp)
        reached = ramp >= t_j * (1.0 - 1e-9)
        if reached.any():
            held = self._worst_held(kind, t_j, np.where(reached, rise, 0.0))
            worst = np.maximum(worst, held)
        return self._worst_share(jerk[:, None] * worst)

    def _worst_share(self, left: Array) -> Array:
        return np.asarray((left / self.bench.left_after).max(axis=-1))

    def _after_move(self, kind: type[Move], ramp: Lapse, rise: Lapse) -> Array:
        """What is left of moves that do not reach ``max_velocity``, signals last [per m/s³]."""
        after = self.bench.after
        if kind is Positioning:
            modal = after.of_pair(self.step, ramp + rise, ramp, rise)
        else:
            modal = after.of_change(self.step, None, ramp, rise)
        found = after.largest(modal.reshape(-1, *modal.shape[-2:]))
        return found.reshape(*modal.shape[:-2], -1)

    def _worst_pointed(self, kind: type[Move], most: Array) -> Array:
        """Worst of ramps up to some, and of the next one, that do not reach a [per m/s³]."""
        ramps = self.bench.ramps
        if kind not in self.pointed:
            each = self.bench.after.after(ramps)
            left = self._after_move(kind, each, each)
            self.pointed[kind] = np.maximum.accumulate(left, axis=0)
        place = np.searchsorted(ramps, most * (1.0 + 1e-9))
        found = self.pointed[kind][np.minimum(place, len(ramps) - 1)]
        return np.asarray(np.where(most[:, None] > 0.0, found, 0.0))

    def _worst_held(self, kind: type[Move], t_j: Array, most: Array) -> Array:
        """Worst of times up to some for which a is held [per m/s³]."""
        ages = self.bench.after.ages
        times, row = np.unique(t_j, return_inverse=True)
        new = np.array([time for time in times.tolist() if (kind, time) not in self.held])
        if len(new):
            ramp = self.bench.after.after(new[:, None])
            left = self._after_move(kind, ramp, ramp + ages)
            rising = np.maximum.accumulate(left, axis=1)
            self.held.update(
                {(kind, t): each for t, each in zip(new.tolist(), rising, strict=True)}
            )
        rising = np.array([self.held[kind, time] for time in times.tolist()])
        place = np.searchsorted(ages.time, most * (1.0 + 1e-9) - t_j)
        found = rising[row, np.minimum(place, len(ages.time) - 1)]
        return np.asarray(np.where(most[:, None] > 0.0, found, 0.0))

    def of_cruise(self, a: Array, t_j: Array | float) -> Array:
        """Return the same of sizes that reach ``max_velocity``, shape of ``a`` [-]."""
        used, bench, after = np.zeros_like(a), self.bench, self.bench.after
        for move in bench.machine.moves:
            is_bounded = isinstance(move, Positioning) and isfinite(move.max_velocity)
            if not (bench.every_size and is_bounded):
                continue
            steps = jerk_steps(move, acceleration=a, jerk=a / t_j)
            ramp, rise, up, fall = map(after.after, steps.times[:, 1:5].T[..., None])
            cruise, later = fall.time - up.time, up + after.ages
            brake = Lapse(
                np.hstack([later.time, fall.time]), np.concatenate([later.left, fall.left], axis=1)
            )
            modal = after.of_pair(self.step, brake, ramp, rise)
            worst = self._worst_share(after.largest(modal.reshape(-1, *modal.shape[-2:])))
            is_there = np.hstack([after.ages.time <= cruise, cruise > 0.0])
            worst = a / t_j * (worst.reshape(is_there.shape) * is_there).max(axis=1)
            used = np.maximum(used, worst)
        return used

    def of_means(self, a: Array, t_j: Array | float) -> Array:
        """Return the largest share of what is a mean over the move, shape of ``a`` [-]."""
        each = np.broadcast_to(t_j, a.shape)
        shares = [self._of_mean(*item, a, each) for item in self.bench.asked.means]
        return np.max(shares, axis=0, initial=0.0) if shares else np.zeros_like(a)

    def _of_mean(self, requirement: Requirement, mean: Mean, a: Array, t_j: Array) -> Array:
        """As the rigid axis uses it, and near the bound with what the loop adds to that."""
        machine, bench, worst = self.bench.machine, self.bench, np.zeros_like(a)
        bound = requirement.bound(machine)
        if requirement.at_most(machine, float(a.max(initial=0.0))) < bound:
            return worst
        shares = np.array(MEAN_SIZES if bench.every_size else (1.0,))
        full, ramps = np.repeat(a, len(shares)), np.repeat(t_j, len(shares))
        for move in machine.moves:
            sizes = np.tile(size_of(move) * shares, len(a))
            steps = jerk_steps(move, acceleration=full, jerk=full / ramps, size=sizes)
            found = mean.estimate(machine, move, filter_steps(steps, self.item))
            worst = np.maximum(worst, found.reshape(len(a), -1).max(axis=1))
        worst = worst / bound
        if worst.max(initial=0.0) <= NEAR:
            return worst
        if requirement.key not in bench.learnt.excess:
            # Where the bound is just used the loop adds what counts.
            place, move = int(np.abs(np.log(np.maximum(worst, 1e-9))).argmin()), machine.moves[0]
            one = jerk_steps(move, acceleration=a[[place]], jerk=a[[place]] / float(t_j[place]))
            steps = filter_steps(one, self.item)
            exact = mean.exact(machine, bench.poles, move, steps, MEAN_CYCLES).max()
            excess = float(exact / mean.estimate(machine, move, steps)[0])
            bench.learnt.excess[requirement.key] = excess
        return np.asarray(worst * np.where(worst > NEAR, bench.learnt.excess[requirement.key], 1.0))

    def of_rest(
        self, a: float, t_j: float, *, is_enough: Callable[[float], bool] = lambda _: False
    ) -> float:
        """Return the largest share of what is judged during the move, in some sizes [-].

        ``is_enough``: of a share from which on more of it need not be known.
        """
        bench, learnt, used = self.bench, self.bench.learnt, 0.0
        for place in sorted(range(len(bench.during)), key=lambda k: k != learnt.hardest):
            one = bench.during[place]
            expected = one.expected(bench.machine, a)
            if expected < 1.0 and place in learnt.as_expected:
                continue
            steps = filter_steps(self._sizes(one.move, a, t_j), self.item)
            share = float((one.swings.largest(bench.poles, steps) / one.left).max())
            if share <= expected:
                learnt.as_expected.add(place)
            if share > used:
                used, learnt.hardest = share, place
            if is_enough(used):
                break
        return used

    def of_rise(self, a: Array, t_j: Array) -> Array:
        """Return the share of the same that the rise of the acceleration uses, shape of ``a``.

        No less is used however the moves go on; nor, in proportion, with less acceleration: it
        then rises no shorter.
        """
        bench, used = self.bench, np.zeros_like(a)
        late = self.item.duration if self.item else 0.0
        for one in bench.during:
            if one.expected(bench.machine, float(a.max())) < 1.0:
                continue
            steps = jerk_steps(one.move, acceleration=a, jerk=a / t_j)
            ramp, until = steps.times[:, 1:2], steps.times[:, 2:3]
            swings = bench.after.ages.time[::SPARSE]
            times = np.hstack([ramp, ramp + 0.5 * late, ramp + late + swings])
            rise = JerkSteps(times=steps.times[:, :2], steps=steps.steps[:, :2])
            steps = filter_steps(rise, self.item)
            share = one.swings.at(bench.poles, steps, np.minimum(times, until)) / one.left
            used = np.maximum(used, share.max(axis=1))
        return used

    def _sizes(self, move: Move, a: float, t_j: float) -> JerkSteps:
        """Some sizes of a move, and those that just reach the acceleration."""
        shares = np.ones(1)
        if self.bench.every_size:
            just = a * t_j if isinstance(move, VelocityStep) else 2.0 * a * t_j**2
            reach = just / size_of(move)
            shares = np.unique(np.clip([*SIZES, reach, 1.3 * reach], 1e-6, 1.0))
        full, sizes = np.full_like(shares, a), shares * size_of(move)
        return jerk_steps(move, acceleration=full, jerk=full / t_j, size=sizes)


SIZES = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Sizes of a move at which swings are looked at, beside where a is reached
(empirical)."""


SPARSE = 4
"""Of the ages that meet every swing, one in so many is enough to see what a rise uses at least
(empirical)."""

NEAR, MEAN_CYCLES = 0.9, 600
"""Share of a mean from which it is corrected by what the loop adds to that of the rigid axis, much
the same for all limits; position cycles that are summed for that (empirical)."""

MEAN_SIZES = (0.05, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Sizes of a move at which means are looked at, as shares of the listed one
(empirical)."""
