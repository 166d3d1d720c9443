"""What limits use of each bound, before they are judged exactly: the worst of all sizes, quickly.

All smaller moves of a listed one are families with one free time (docs/every-size.md): a ramp t
that does not reach a, a time T for which a is held, a time T₂ at ``max_velocity``. What is left of
the first depends on the jerk alone, of the second on t_j as well, both in proportion to the jerk:
each is computed once, for all accelerations. The third is computed for each.

Looked at are all corners, and the first swings of each pole that counts, where several ramps add
up most; later ones only grow less. ``limits.every_size`` has the last word.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.requirements import (
    COARSELY,
    Asked,
    Mean,
    Requirement,
    Swings,
    sort_requirements,
)
from mtcommission.loop.disturbance import EncoderNoise, worst_noise
from mtcommission.loop.mean_response import MeanResponse, average_phases
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.respond import free_motion, lay_grid, set_in_motion
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps
from mtcommission.setpoint.smaller_moves import size_of

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class During:
    """What is judged together during one listed move."""

    swings: Swings
    left: Array  # of each bound [own units]
    move: Move
    worst: float = 1.0  # size that used most the last time, by that of the move [-]

    def is_far(self, machine: Machine, acceleration: float) -> bool:
        """Return whether a response need not be looked at, so far is the limit [m/s²]."""
        most = [each.at_most(machine, acceleration) for each in self.swings.requirements]
        return bool(np.all(most < self.left))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """A machine whose requirements count as they stand, and its loop, ready for many limits."""

    machine: Machine
    poles: LoopPoles  # in every corner
    asked: Asked
    mean: MeanResponse  # of what is judged after the move
    noise: EncoderNoise  # in the worst corner
    left_after: Array  # what it leaves of each bound on what is judged after the move [own units]
    during: list[During]  # what is judged during the move, what used most the last time first
    aged: Complex  # what free times beyond the least of a family have left of the mean response
    ramps: Array  # of sizes that do not reach the acceleration [s]
    behind: dict[SetpointFilter | None, Use] = field(default_factory=dict)
    excess: dict[str, float] = field(default_factory=dict)  # see ``Use.of_means``, once known

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
        if item not in self.behind:
            self.behind[item] = Use(bench=self, item=item, factor=self.mean.behind(item))
        return self.behind[item]


def build_bench(machine: Machine, tuned: TunedLoop) -> Bench:
    """Return the bench of a machine, encoder noise taken off what is allowed."""
    noise = worst_noise(tuned.loops, machine.drive.encoder_resolution)
    poles, asked = find_poles(tuned.loops), sort_requirements(machine, tuned.plant)

    def left(requirements: Iterable[Requirement]) -> Array:
        none = np.zeros(1)
        pairs = [(item.bound(machine), item.with_noise(none, noise)[0]) for item in requirements]
        return np.array([_left(bound, taken) for bound, taken in pairs])

    mean = average_phases(poles, np.array([signal.row for _, signal in asked.after]))
    return Bench(
        machine=machine,
        poles=poles,
        asked=asked,
        mean=mean,
        noise=noise,
        left_after=left(requirement for requirement, _ in asked.after),
        during=[
            During(swings=swings, left=left(swings.requirements), move=move)
            for swings in asked.during
            for move in swings.moves
        ],
        aged=mean.since(mean.ages),
        # Two ramps are as long as the free time, which counts twice: half-way as well.
        ramps=np.sort(np.concatenate([mean.ages[1:], 0.5 * (mean.ages[:-1] + mean.ages[1:])])),
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
    factor: Complex  # of the mean response
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
            # One size alone may lie in a notch: a little less acceleration can leave more.
            share = self._share_after(steps)
            near = (share > 1.0 / FAR) & (share < FAR)
            if near.any():
                share[near] = self._share_exactly(steps.only(near))
            return share
        ramp, rise = steps.times[:, 1], steps.times[:, 2]
        worst = self._worst_pointed(kind, ramp)
        reached = ramp >= t_j * (1.0 - 1e-9)
        if reached.any():
            held = self._worst_held(kind, t_j, np.where(reached, rise, 0.0))
            worst = np.maximum(worst, held)
        return self._worst_share(jerk[:, None] * worst)

    def _worst_share(self, left: Array) -> Array:
        return np.asarray((left / self.bench.left_after).max(axis=-1))

    def _share_after(self, steps: JerkSteps) -> Array:
        """Of what is left after each setpoint by the mean over all phases, shape (n_setpoints,)."""
        return self._worst_share(self.bench.mean.residual(steps, self.factor))

    def _share_exactly(self, steps: JerkSteps) -> Array:
        """The same at the very phases at which the steps fall."""
        motions = set_in_motion(self.bench.poles, filter_steps(steps, self.item))
        grid = lay_grid(self.bench.poles, COARSELY)
        found = [
            free_motion(motions, grid, signal=signal).residual.max(axis=1)
            for _, signal in self.bench.asked.after
        ]
        return self._worst_share(np.stack(found, axis=1))

    def _worst_pointed(self, kind: type[Move], most: Array) -> Array:
        """Worst of ramps up to some, and of the next one, that do not reach a [per m/s³]."""
        ramps = self.bench.ramps
        if kind not in self.pointed:
            ramp = self.bench.mean.since(ramps)
            held = self.factor * (ramp - 1.0) ** 2
            if kind is Positioning:
                held = held * (ramp**2 - 1.0)
            self.pointed[kind] = np.maximum.accumulate(self.bench.mean.largest(held), axis=0)
        place = np.searchsorted(ramps, most * (1.0 + 1e-9))
        found = self.pointed[kind][np.minimum(place, len(ramps) - 1)]
        return np.asarray(np.where(most[:, None] > 0.0, found, 0.0))

    def _worst_held(self, kind: type[Move], t_j: Array, most: Array) -> Array:
        """Worst of times up to some for which a is held [per m/s³]."""
        mean, ages = self.bench.mean, self.bench.mean.ages
        times, row = np.unique(t_j, return_inverse=True)
        new = np.array([time for time in times.tolist() if (kind, time) not in self.held])
        if len(new):
            ramp = mean.since(new)[:, None]
            rise = ramp * self.bench.aged
            held = self.factor * (ramp - 1.0) * (rise - 1.0)
            if kind is Positioning:
                held = held * (rise * ramp - 1.0)
            worst = mean.largest(held.reshape(-1, *held.shape[2:]))
            rising = np.maximum.accumulate(worst.reshape(len(new), len(ages), -1), axis=1)
            self.held.update(
                {(kind, t): each for t, each in zip(new.tolist(), rising, strict=True)}
            )
        rising = np.array([self.held[kind, time] for time in times.tolist()])
        place = np.searchsorted(ages, most * (1.0 + 1e-9) - t_j)
        found = rising[row, np.minimum(place, len(ages) - 1)]
        return np.asarray(np.where(most[:, None] > 0.0, found, 0.0))

    def of_cruise(self, a: Array, t_j: Array | float) -> Array:
        """Return the same of sizes that reach ``max_velocity``, shape of ``a`` [-]."""
        used, bench, mean = np.zeros_like(a), self.bench, self.bench.mean
        for move in bench.machine.moves:
            is_bounded = isinstance(move, Positioning) and isfinite(move.max_velocity)
            if not (bench.every_size and is_bounded):
                continue
            steps = jerk_steps(move, acceleration=a, jerk=a / t_j)
            ramp, rise, up, fall = steps.times[:, 1:5].T
            cruise = fall - up
            held = self.factor * (mean.since(ramp) - 1.0) * (mean.since(rise) - 1.0)
            each = held[:, None] * (mean.since(up)[:, None] * bench.aged - 1.0)
            worst = self._worst_share(mean.largest(each.reshape(-1, *held.shape[1:])))
            worst = (worst.reshape(len(a), -1) * (mean.ages <= cruise[:, None])).max(axis=1)
            own = self._worst_share(mean.largest(held * (mean.since(fall) - 1.0)))
            worst = a / t_j * np.maximum(worst, own)
            used = np.maximum(used, np.where(cruise > 0.0, worst, 0.0))
        return used

    def of_after_exactly(self, a: float, t_j: float) -> float:
        """Return the share of both, of some sizes at the very phases of their steps [-]."""
        bench, worst = self.bench, 0.0
        for move in bench.machine.moves:
            sizes = np.array([size_of(move)])
            if bench.every_size:
                sizes = _lay_ages(move, a, t_j, bench.mean.ages, bench.ramps)
            full = np.full_like(sizes, a)
            steps = jerk_steps(move, acceleration=full, jerk=full / t_j, size=sizes)
            # The mean over all phases tells which sizes may be the worst.
            likely = self._share_after(steps)
            steps = steps.only(likely >= LIKELY * likely.max())
            worst = max(worst, float(self._share_exactly(steps).max()))
        return worst

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
        if requirement.key not in bench.excess:
            # Where the bound is just used the loop adds what counts.
            place, move = int(np.abs(np.log(np.maximum(worst, 1e-9))).argmin()), machine.moves[0]
            one = jerk_steps(move, acceleration=a[[place]], jerk=a[[place]] / float(t_j[place]))
            steps = filter_steps(one, self.item)
            exact = mean.exact(machine, bench.poles, move, steps, MEAN_CYCLES).max()
            excess = float(exact / mean.estimate(machine, move, steps)[0])
            bench.excess[requirement.key] = excess
        return np.asarray(worst * np.where(worst > NEAR, bench.excess[requirement.key], 1.0))

    def of_rest(
        self, a: float, t_j: float, *, is_enough: Callable[[float], bool] = lambda _: False
    ) -> float:
        """Return the largest share of what is judged during the move, in some sizes [-].

        ``is_enough``: of a share from which on more of it need not be known.
        """
        during, used, most, worst = self.bench.during, 0.0, 0, 1.0
        for place, size, share in self._of_sizes(a, t_j):
            if share > used:
                used, most, worst = share, place, size
            if is_enough(used):
                break
        if used:
            during.insert(0, replace(during.pop(most), worst=worst))
        return used

    def _of_sizes(self, a: float, t_j: float) -> Iterator[tuple[int, float, float]]:
        """What is judged during the move: of the size that was the worst, then of all others.

        By its place; with the size that uses most, by that of the move, and what it uses [-].
        """
        bench = self.bench
        for place, one in enumerate(bench.during):
            if one.is_far(bench.machine, a):
                continue
            shares = self._lay_shares(one.move, a, t_j)
            likely = int(np.abs(np.log(shares / one.worst)).argmin())
            for part in (shares[[likely]], np.delete(shares, likely)):
                if not len(part):
                    continue
                full = np.full_like(part, a)
                sizes = part * size_of(one.move)
                steps = jerk_steps(one.move, acceleration=full, jerk=full / t_j, size=sizes)
                found = one.swings.largest(bench.poles, filter_steps(steps, self.item)) / one.left
                worst = int(found.max(axis=1).argmax())
                yield place, float(part[worst]), float(found[worst].max())

    def of_rise(self, a: Array, t_j: Array) -> Array:
        """Return the share of the same that the rise of the acceleration uses, shape of ``a``.

        No less is used however the moves go on; nor, in proportion, with less acceleration: it
        then rises no shorter.
        """
        bench, used = self.bench, np.zeros_like(a)
        late = self.item.duration if self.item else 0.0
        for one in bench.during:
            if one.is_far(bench.machine, float(a.max())):
                continue
            steps = jerk_steps(one.move, acceleration=a, jerk=a / t_j)
            ramp, until = steps.times[:, 1:2], steps.times[:, 2:3]
            times = np.hstack([ramp, ramp + 0.5 * late, ramp + late + bench.mean.ages[::SPARSE]])
            rise = JerkSteps(times=steps.times[:, :2], steps=steps.steps[:, :2])
            steps = filter_steps(rise, self.item)
            share = one.swings.at(bench.poles, steps, np.minimum(times, until)) / one.left
            used = np.maximum(used, share.max(axis=1))
        return used

    def _lay_shares(self, move: Move, a: float, t_j: float) -> Array:
        """Some sizes of a move, and those that just reach the acceleration, by its own [-]."""
        if not self.bench.every_size:
            return np.ones(1)
        just = a * t_j if isinstance(move, VelocityStep) else 2.0 * a * t_j**2
        reach = just / size_of(move)
        return np.unique(np.clip([*SIZES, reach, 1.3 * reach], 1e-6, 1.0))


def _lay_ages(move: Move, a: float, t_j: float, ages: Array, ramps: Array) -> Array:
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


SIZES = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Sizes of a move at which swings are looked at, beside where a is reached
(empirical)."""


SPARSE = 4
"""Of the ages that meet every swing, one in so many is enough to see what a rise uses at least
(empirical)."""

LIKELY = 0.7
"""Share of the worst mean over all phases from which a size may be the worst at its own (empirical:
the two are within some per cent)."""

FAR = 2.0
"""Factor from a bound beyond which the mean over all phases of a step within its cycle tells enough
of one size (empirical)."""

NEAR, MEAN_CYCLES = 0.9, 600
"""Share of a mean from which it is corrected by what the loop adds to that of the rigid axis, much
the same for all limits; position cycles that are summed for that (empirical)."""

MEAN_SIZES = (0.05, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Sizes of a move at which means are looked at, as shares of the listed one
(empirical)."""
