"""Limits on every smaller move of each listed one: the worst of all sizes, with a bound for all.

Limits are typed in once and then serve every move of every program. Sizes of a move follow each
other by one free time T (docs/every-size.md). Between two sizes h apart every step of the jerk
falls at its own phase of a position cycle, so the deviation is smooth in T but for kinks where a
step passes a sample; it exceeds the larger of its neighbours by no more than

    K h²/8 + κ h/4 + J

K: largest second derivative by T at any phase; κ: change of the slope by one more or one less
sample that sees the acceleration, summed over the steps that may pass one within h; J: the same of
the value, where the control feeds the jerk forward. All three are residuals of other inputs to the
same loop. Where J is not nothing, or κ asks for more sizes than are laid, those on either side of
each such place are looked at instead. h is laid so that what is left is little; the sum stands in
the result, and counts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, inf, isfinite, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.requirements import (
    Mean,
    Requirement,
    Swings,
    requirements_of,
    sort_requirements,
)
from mtcommission.loop.disturbance import EncoderNoise, encoder_noise, worst_noise
from mtcommission.loop.model.assembly import INPUTS
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.respond import (
    Signal,
    every_part,
    extremes,
    free_motion,
    lay_grid,
    set_in_motion,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Corner, Machine
from mtcommission.machine.moves import Move, Positioning
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps
from mtcommission.setpoint.smaller_moves import lay_sizes, plan_sizes, size_of

Array = NDArray[np.float64]
Places = NDArray[np.int64]

CLOSER = ((0.25, 8.0), (0.035, 3.0), (0.005, 1.0), (0.001, 0.25))
"""Shares of a bound by which a size between two that were looked at may exceed both [-]: at first,
and ever closer where it may be the worst; and by how much coarser they may be laid at most. The
last one only where it decides."""

LEFT = 1.3
"""Bounds that, left at a first look, need no second one [-]."""

MOST_SIZES = 3000
"""Sizes of a move in each of its families; where more would be needed the bound is wider."""

SAMPLES = 48
"""Samples per period of free motion: the peak of a swing is missed by 0.2 % at most."""

PHASES = 8
"""Of a step within a position cycle, at which its second derivative is looked at."""

SHARES = np.geomspace(0.01, 1.0, 24)
"""Of the listed size, at which what counts during a move is looked at, where all sizes count."""

NEARER = 9
"""Sizes from the next smaller to the next larger one, at which what counts during a move is looked
at about the worst (empirical: within 0.3 % of dense sizes, without them 2 % below)."""

TOGETHER = 128
"""Sizes that are judged at once: keeps their free motion in the cache."""

LONGEST_SEEN = 2.0
"""Time after which what is held or cruised has been held for ever, where modes decay slowly [s]."""

MEAN_CYCLES = 4000
"""Position cycles of a move that are summed for a mean, at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeCheck:
    """The worst of all sizes for one requirement."""

    requirement: Requirement
    value: float  # worst over all sizes, moves and corners [own unit]
    bound: float  # what no size exceeds; nan where only sizes were looked at
    move: int  # number of the move, from 1
    size: float  # velocity step or distance of the worst [m/s or m]
    corner: Corner  # of the worst

    def share(self, machine: Machine) -> float:
        """Return the share of the bound that no size exceeds, where that is proved [-]."""
        most = self.bound if isfinite(self.bound) else self.value
        return most / self.requirement.bound(machine)


def judge_sizes(
    machine: Machine,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    only_if_kept: bool = False,
) -> tuple[SizeCheck, ...]:
    """Return the worst of all sizes that count, for each requirement but the settling time.

    Of each smaller move and the listed one, or of the listed one alone; encoder noise included.
    What counts during the move comes first, of which few sizes are looked at; ``only_if_kept``: the
    rest is looked at only if they keep that.
    """
    resolution, asked = machine.drive.encoder_resolution, sort_requirements(machine, tuned.plant)
    sizes = _Sizes(
        machine=machine,
        limits=limits,
        poles=find_poles(tuned.loops),
        corners=tuned.corners,
        noises=tuple(encoder_noise(loop, resolution=resolution) for loop in tuned.loops),
    )
    places, checks = range(len(machine.moves)), list[SizeCheck]()
    for place in places:
        for swings in asked.during:
            checks += sizes.worst_during(place, swings)
        checks += [sizes.worst_mean(place, *item) for item in asked.means]
    if not only_if_kept or all(one.share(machine) <= 1.0 for one in checks):
        checks += [sizes.worst_after(place, *item) for item in asked.after for place in places]
    by_requirement = [
        [check for check in checks if check.requirement == requirement]
        for requirement in requirements_of(machine)
    ]
    return tuple(max(own, key=lambda check: check.value) for own in by_requirement if own)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Sizes:
    """All sizes that count of each listed move, by its place among them, with the same limits."""

    machine: Machine
    limits: MotionLimits
    poles: LoopPoles
    corners: tuple[Corner, ...]
    noises: tuple[EncoderNoise, ...]  # in each corner

    def worst_after(self, place: int, requirement: Requirement, signal: Signal) -> SizeCheck:
        """Return the worst from t_e + τ on, and what no size exceeds."""
        move, between = self.machine.moves[place], 0.0
        if self.machine.requirements.every_size:
            size, found, between = self._worst_of_all(move, requirement, signal)
            value, corner = found
        else:
            size = size_of(move)
            left, corners = self._left_of(move, np.array([size]), signal)
            value, corner = float(left[0]), int(corners[0])
        noise = worst_noise(self.poles.loops, self.machine.drive.encoder_resolution)
        value, bound = requirement.with_noise(np.array([value, value + between]), noise).tolist()
        return SizeCheck(
            requirement=requirement,
            value=value,
            bound=bound,
            move=place + 1,
            size=size,
            corner=self.corners[corner],
        )

    def _worst_of_all(
        self, move: Move, requirement: Requirement, signal: Signal
    ) -> tuple[float, tuple[float, int], float]:
        """The worst of sizes laid so close that little is between them: size, (value, corner).

        And by how much a size between may exceed it [own unit].
        """
        poles, limits = self.poles, self.limits
        seen = LONGEST_SEEN
        rates = -poles.rates.real[np.abs(poles.factors) > 0.0]
        if len(rates):
            seen = min(float(np.log(1e3) / max(rates.min(), 1e-9)), LONGEST_SEEN)
        families = bound_between(poles, limits, move, signal)
        smooth = [replace(one, kink=0.0, jump=0.0) for one in families]
        least = limits.jerk_time / MOST_SIZES, seen / MOST_SIZES
        allowed, excess = requirement.bound(self.machine), inf
        sizes, left, corners = np.zeros(0), np.zeros(0), np.zeros(0, np.int64)
        for share, coarser in CLOSER:
            if share == CLOSER[-1][0] and not self._is_open(requirement, left.max(), excess):
                break
            between = list(families)
            close = [one.spacing(share * allowed) for one in between]
            is_open = families[0].jump > 0.0 or any(
                h < low for h, low in zip(close, least, strict=True)
            )
            is_cut = coarser <= 1.0 and is_open and seen / poles.dt < MOST_SIZES
            if is_cut:
                between, close = smooth, [one.spacing(share * allowed) for one in smooth]
            spacings = np.maximum(close, coarser * np.array(least))
            laid = lay_sizes(
                move,
                limits,
                pointed_spacing=spacings[0],
                spacing=min(spacings[1], seen),
                decayed=seen,
                cycle=poles.dt if is_cut else 0.0,
            )
            # Between two sizes where none can be the worst nothing more is looked at.
            may_be = np.maximum(left[:-1], left[1:]) + excess > left.max(initial=0.0)
            is_there = np.concatenate([[True], may_be, [True]])[: len(sizes) + 1]
            more = laid[is_there[np.searchsorted(sizes, laid)] & ~np.isin(laid, sizes)]
            found = self._left_of(move, more, signal)
            order = np.argsort(np.concatenate([sizes, more]))
            sizes, left, corners = (
                np.concatenate(both)[order]
                for both in zip((sizes, left, corners), (more, *found), strict=True)
            )
            excess = max(item.excess(h) for item, h in zip(between, spacings, strict=True))
            if left.max() > LEFT * allowed:
                break
            allowed = max(allowed, float(left.max()))
        worst = int(left.argmax())
        return float(sizes[worst]), (float(left[worst]), int(corners[worst])), excess

    def _is_open(self, requirement: Requirement, left: float, excess: float) -> bool:
        """Whether all sizes looked at keep the bound, and one between them might not."""
        noise = worst_noise(self.poles.loops, self.machine.drive.encoder_resolution)
        value, most = requirement.with_noise(np.array([left, left + excess]), noise).tolist()
        return bool(value <= requirement.bound(self.machine) < most)

    def _left_of(self, move: Move, sizes: Array, signal: Signal) -> tuple[Array, Places]:
        """What is left of each size in its worst corner [own unit], and which that is."""
        steps, poles = plan_sizes(move, sizes, self.limits), self.poles
        grid, found = lay_grid(poles, SAMPLES), []
        for start in range(0, len(sizes), TOGETHER):
            part = steps.only(slice(start, start + TOGETHER))
            found.append(free_motion(set_in_motion(poles, part), grid, signal=signal).residual)
        left = np.concatenate(found) if found else np.zeros((0, len(poles.loops)))
        return left.max(axis=1), left.argmax(axis=1)

    def worst_during(self, place: int, swings: Swings) -> list[SizeCheck]:
        """Return the worst of swings looked at together, of some sizes, closer about the worst."""
        move, shares = swings.moves[place], self._shares
        found = swings.largest(self.poles, self._plan(move, shares))
        if len(shares) > 1:
            worst = np.unique(found.argmax(axis=0))
            ends = shares[np.maximum(worst - 1, 0)], shares[np.minimum(worst + 1, len(shares) - 1)]
            closer = np.unique(np.geomspace(*ends, NEARER)[1:-1])
            more = swings.largest(self.poles, self._plan(move, closer))
            shares, found = np.append(shares, closer), np.concatenate([found, more])
        every, grid, checks = np.arange(self.poles.cycles), every_part(self.poles, SAMPLES), []
        for k, requirement in enumerate(swings.requirements):
            share, row = shares[[found[:, k].argmax()]], swings.rows[k : k + 1]
            alone = set_in_motion(self.poles, self._plan(move, share))
            peaks = extremes(alone, grid, row, parts=every, less=swings.less)
            values = requirement.noisy(peaks[0, :, 0], self.noises)
            checks.append(self._check(place, requirement, values, size_of(move) * share[0]))
        return checks

    def worst_mean(self, place: int, requirement: Requirement, mean: Mean) -> SizeCheck:
        """Return the worst of means, at the size at which the rigid axis has it."""
        move = self.machine.moves[place]
        steps = self._plan(move, self._shares)
        worst = int(mean.estimate(self.machine, move, steps).argmax())
        found = mean.exact(self.machine, self.poles, move, steps.only([worst]), MEAN_CYCLES)
        values = requirement.noisy(found, self.noises)
        return self._check(place, requirement, values, size_of(move) * self._shares[worst])

    @property
    def _shares(self) -> Array:
        return SHARES if self.machine.requirements.every_size else np.ones(1)

    def _plan(self, move: Move, shares: Array) -> JerkSteps:
        return plan_sizes(move, size_of(move) * shares, self.limits)

    def _check(self, place: int, requirement: Requirement, values: Array, size: float) -> SizeCheck:
        corner = int(values.argmax())
        return SizeCheck(
            requirement=requirement,
            value=float(values[corner]),
            bound=nan,
            move=place + 1,
            size=float(size),
            corner=self.corners[corner],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Between:
    """By what a residual between two sizes may exceed both."""

    bent: float  # K, second derivative by the free time [m/s²]
    kink: float  # κ of one step that passes a sample, by its weight and rate [m/s]
    jump: float  # J of all steps [m]
    cycle: float  # position cycle [s]
    passing: tuple[tuple[float, float], ...]  # weight and rate of each step that moves

    def excess(self, h: float) -> float:
        """Return the bound for sizes whose free times are ``h`` apart [m]."""
        crossings = sum(
            weight * rate * ceil(rate * h / self.cycle - 1e-9) for weight, rate in self.passing
        )
        return self.bent * h**2 / 8.0 + self.kink * crossings * h / 4.0 + self.jump

    def spacing(self, allowed: float) -> float:
        """Return the largest spacing whose excess, jumps apart, is allowed [s]."""
        slope = 0.25 * self.kink * sum(weight * rate for weight, rate in self.passing)
        if not self.bent and not slope:
            return inf
        return 2.0 * allowed / (slope + sqrt(slope**2 + 0.5 * self.bent * allowed))


POINTED_STEP, HELD_STEP = ((2.0, 1.0), (1.0, 2.0)), ((2.0, 1.0),)
POINTED_MOVE, HELD_MOVE = ((2.0, 1.0), (2.0, 3.0), (1.0, 4.0)), ((4.0, 1.0), (2.0, 2.0))
"""Weights of the steps of the jerk, and how fast they move with the free time: (1 - D^t)² y, (1 -
D^T) B, (1 - 2 D^t + 2 D^3t - D^4t) y, (1 - D^(T + t_j)) (1 - D^T) B; B = (1 - D^t_j) y has two."""


def bound_between(
    poles: LoopPoles, limits: MotionLimits, move: Move, signal: Signal
) -> tuple[Between, Between]:
    """Return what bounds sizes that do not reach the acceleration, and all others.

    Notes
    -----
    With the answer y to a jerk step and the families above, a residual is bent by at most
    Σ w r² |y''| over the steps that move. y'' is the answer to a step of the velocity, B'' the same
    less it t_j later, both behind the setpoint filter and from τ after the last step on. A step of
    the jerk that is seen by one sample more adds the answer to a pulse of the acceleration at one
    sample to the slope, and to a pulse of the jerk to the value; behind an average the slope
    changes by the latter, and the value not at all.
    """
    item, jerk = limits.setpoint_filter, limits.jerk
    averages = item.averages if item else ()
    accelerated, jerked = _pulses(poles, signal)
    kink, jump = (jerk * accelerated, jerk * jerked)
    if averages:
        kink, jump = (2.0 * jerk / averages[0] * jerked, 0.0) if len(averages) == 1 else (0.0, 0.0)
    is_move = isinstance(move, Positioning)
    families = (POINTED_MOVE, HELD_MOVE) if is_move else (POINTED_STEP, HELD_STEP)
    found = []
    for passing, second in zip(families, (0.0, limits.jerk_time), strict=True):
        weight = sum(w * r**2 for w, r in passing) / (2.0 if second else 1.0)
        found.append(
            Between(
                bent=jerk * weight * _largest_bend(poles, item, second, signal),
                kink=kink,
                jump=jump * sum(w for w, _ in passing),
                cycle=poles.dt,
                passing=passing,
            )
        )
    return found[0], found[1]


def _largest_bend(
    poles: LoopPoles, item: SetpointFilter | None, second: float, signal: Signal
) -> float:
    """Largest |y''|, or |B''| where a second step follows, at any phase and corner [per m/s]."""
    phases = (np.arange(PHASES) / PHASES * poles.dt)[:, None]
    times = np.hstack([phases, phases + second]) if second else phases
    signs = np.array([1.0, -1.0] if second else [1.0])
    steps = JerkSteps(times=times, steps=np.tile(signs, (PHASES, 1)), order=1)
    motions = set_in_motion(poles, filter_steps(steps, item))
    return float(free_motion(motions, lay_grid(poles, SAMPLES), signal=signal).residual.max())


def _pulses(poles: LoopPoles, signal: Signal) -> tuple[float, float]:
    """Largest signals from τ on after 1 m/s² and 1 m/s³ at one sample [own unit]."""
    late = max(int(poles.delay / poles.dt) - 1, 0)
    largest = np.zeros(2)
    for loop in poles.loops:
        lifted, pushes = loop.lifted, loop.lifted.B.reshape(len(loop.states), -1, len(INPUTS))
        X = pushes[:, 0, 2:]
        seen = signal.row @ lifted.C.reshape(poles.cycles, poles.outputs, -1)
        for m in range(2 * poles.recent):
            if m >= late:
                largest = np.maximum(largest, np.abs(seen @ X).max(axis=0))
            X = lifted.A @ X + (pushes[:, m + 1, 2:] if m < loop.kept else 0.0)
    return float(largest[0]), float(largest[1])
