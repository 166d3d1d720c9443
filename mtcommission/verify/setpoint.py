"""The setpoint of a trace: its moves, how fast they were, and whether the control obeyed.

Differences over a width w are means of the derivative under a kernel that is nowhere negative
(a box for the velocity, a B-spline of width 2 w for the acceleration, of 3 w for the jerk): they
never exceed the true largest value, whatever the planner does between.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, splrep

from mtcommission.base.errors import MtcommissionError
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.measured.measurement import Array, Channel
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Setpoint, plan_setpoint, sample_setpoint
from mtcommission.verify.checks import Check, Verdict
from mtcommission.verify.trace import resolution

NOISE_GAIN = (sqrt(2.0), sqrt(6.0), sqrt(20.0))
"""Standard deviation of a first, second, third difference of unit noise."""

SIGMAS = 4.0
"""Largest of some thousand normal errors."""

WANTED = 0.02
"""Uncertainty of acceleration and jerk that is aimed at, as share of the value entered."""

LEAST_REST, LEAST_REST_STEPS = 4e-3, 4
"""Shorter stands are part of a move [s; samples of the setpoint]."""

CALM = 4.0
"""Times the noise that a resting setpoint stays within."""

HELD = 0.05
"""Share of the largest step of a setpoint from which on it has changed."""

SPLINE = 5
"""Degree: the jerk of the setpoint is then continuous, as the position cycle sees it."""

LEAST_SAMPLES = 2 * SPLINE + 2
"""Of a move and its rest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reached:
    """Largest magnitude of a derivative of the setpoint."""

    value: float  # mean over ``width`` where it is largest [SI]
    uncertainty: float  # of this value, by the resolution of the record [SI]
    width: float  # [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """A stretch of the setpoint from rest to the next move."""

    number: int  # which of the record's moves it is, from 1; 0 for none
    plan: Setpoint | None  # what the control should have sent; None: it cannot be planned
    is_planned: bool  # whether it sent that, as far as can be seen
    begin: float  # of the setpoint, before the record shows it [s]
    end: float  # from which the setpoint rests (or coasts) [s]
    until: float  # end of the dwell (of the coasting) [s]
    coasts: bool  # whether it ends at a constant velocity instead of rest
    travel: float  # from ``begin`` to ``end``, signed [m]
    velocity: Reached
    acceleration: Reached
    jerk: Reached
    blur: float  # by which begin and end may be off [s]
    is_cut: bool  # whether the record ends before the setpoint does
    start: float  # position before it [m]
    final_velocity: float  # [m/s]
    spline: BSpline  # the setpoint between, smoothed as its resolution demands

    @property
    def way(self) -> float:
        """1 where it moves forwards, -1 backwards."""
        return -1.0 if self.travel < 0.0 else 1.0

    def sample(self, t: Array) -> Array:
        """Return x_ref, v_ref, a_ref, j_ref relative to the start, shape (n, 4)."""
        if self.plan and self.is_planned:
            return self.way * sample_setpoint(self.plan, t - self.begin)
        inside = (t > self.begin) & (t < self.end)
        clipped = np.clip(t, self.begin, self.end)
        rows = np.column_stack([self.spline(clipped, nu=order) for order in range(4)])
        rows[:, 0] -= self.start
        rows[~inside] = 0.0
        after = t >= self.end
        rows[after, 0] = self.travel + self.final_velocity * (t[after] - self.end)
        rows[after, 1] = self.final_velocity
        return rows


def find_motions(
    channel: Channel, moves: tuple[Move, ...], entered: MotionLimits
) -> tuple[list[Motion], bool]:
    """Return the moves of a setpoint, and whether the record begins in the middle of one.

    ``moves``: those of the record, ``entered``: the limits in the control.
    """
    setpoint = _without_holds(channel)
    x, h = setpoint.values, setpoint.step
    noise = max(_noise(x), channel.error)
    pairs = list(runs(_moving(x, h, noise)))
    begins_moving = bool(pairs) and pairs[0][0] == 0
    ends = sorted({isinstance(move, VelocityStep) for move in moves})
    found = []
    for place, (first, last) in enumerate(pairs):
        if first == 0:
            continue
        following = pairs[place + 1][0] if place + 1 < len(pairs) else x.size
        before = pairs[place - 1][1] if place else 0
        if following - before < LEAST_SAMPLES:
            continue  # a jump
        own = _Stretch(
            x[before:following], h, float(setpoint.t[before]), first - before, last - before, noise
        )
        # A move may coast at its end, or rest; of both, the one that is known.
        either = [own.motion(entered, coasting=coasting) for coasting in ends]
        numbers = [number_of(motion, moves, entered) for motion in either]
        number = max(numbers)
        motion = either[numbers.index(number)]
        plan = planned(motion, moves[number - 1] if number else None, entered)
        found.append(own.placed(replace(motion, number=number, plan=plan)))
    return found, begins_moving


def runs(flags: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield the first sample of each run of true ones, and the one behind its last."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0)).tolist()
    return zip(edges[::2], edges[1::2], strict=True)


def _without_holds(channel: Channel) -> Channel:
    """The samples at which a setpoint that is held over some samples changes."""
    x = channel.values
    steps = np.abs(np.diff(x))
    at = np.flatnonzero(steps > HELD * steps.max())
    spacing = np.diff(at)
    held = int(np.median(spacing)) if at.size >= 8 else 1
    if held < 2 or float(np.mean(spacing % held == 0)) < 0.9:
        return channel
    phase = int(np.bincount((at + 1) % held).argmax())
    return replace(
        channel,
        start=channel.start + phase * channel.step,
        step=held * channel.step,
        values=x[phase::held],
    )


def _noise(x: Array) -> float:
    """Standard deviation of what a setpoint is written down with [m]."""
    fourth = np.abs(np.diff(x, n=4))
    floor = 1e-12 * float(np.ptp(x))
    fourth = fourth[fourth > 8.0 * floor]
    scatter = 1.4826 * float(np.median(fourth)) / sqrt(70.0) if fourth.size > 16 else 0.0
    grain = resolution(x) / sqrt(12.0)
    # Where the setpoint is exact, the fourth difference shows the planner's jerk steps.
    return max(min(scatter, 10.0 * grain) if grain else scatter, grain, floor)


def _moving(x: Array, h: float, noise: float) -> NDArray[np.bool_]:
    least = max(LEAST_REST_STEPS, ceil(LEAST_REST / h))
    moving = np.ones(x.size, dtype=bool)
    for first, last in runs(np.abs(np.diff(x)) <= CALM * noise):
        if last - first < least:
            continue
        # A slow start is quiet, too: what stands is what stays at one level.
        run = x[first : last + 1]
        for begin, end in runs(np.abs(run - np.median(run)) <= CALM * noise):
            if end - begin > least:
                moving[first + begin : first + end] = False
    return moving


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Samples from the end of one move to the begin of the one after the next."""

    x: Array
    h: float
    origin: float  # time of the first sample [s]
    first: int  # sample that moves
    last: int  # sample behind them
    noise: float

    @property
    def t(self) -> Array:
        return np.asarray(self.origin + self.h * np.arange(self.x.size, dtype=np.float64))

    def motion(self, entered: MotionLimits, *, coasting: bool) -> Motion:
        x, h, t = self.x, self.h, self.t
        level = CALM * self.noise
        start = float(np.median(x[: self.first]))
        off = np.flatnonzero(np.abs(x - start) > level)
        begin = max(int(off[0]) - 1, 0) if off.size else self.first
        top = float(np.ptp(x)) / (x.size * h)
        velocity = self._reached(1, slice(begin, x.size), wanted=WANTED * top)
        last, until, speed = min(self.last, x.size - 1), x.size - 1, 0.0
        is_cut = self.last >= x.size - 1
        if coasting and (coast := self._coast(begin, velocity)):
            last, until, speed = coast
            is_cut = False
        goal = float(x[-1])
        if not speed and not is_cut:
            goal = float(np.median(x[last:]))
            away = np.flatnonzero(np.abs(x - goal) > level)
            last = min(int(away[-1]) + 1, x.size - 1) if away.size else last
        last = max(last, begin)
        more = LEAST_SAMPLES + (last - begin) // 8  # in which it moves unseen
        part = slice(max(begin - more, 0), min(last + more, x.size))
        reached = [
            self._reached_by_filter(order, part, limit=limit)
            for order, limit in ((2, entered.acceleration), (3, entered.jerk))
        ]
        spline = _smooth(t[part], x[part], self.noise)
        return Motion(
            number=0, plan=None, is_planned=False, begin=float(t[begin]), end=float(t[last]),
            until=float(t[until]), coasts=speed != 0.0,
            travel=(float(spline(t[last])) if speed else goal) - start, velocity=velocity,
            acceleration=reached[0], jerk=reached[1], blur=h, is_cut=is_cut,
            start=start, final_velocity=speed, spline=spline,
        )  # fmt: skip

    def placed(self, motion: Motion) -> Motion:
        """The move where its plan begins and ends, which says more than digits that are lost.

        A filtered setpoint starts so slowly that its first milliseconds are below the resolution of
        a record: the plan tells how long it took to the first sample that shows it.
        """
        plan = motion.plan
        if plan is None:
            return motion
        part = self.t <= motion.until
        t, x = self.t[part], motion.way * (self.x[part] - motion.start)
        seen = int(np.argmax(np.abs(x) > CALM * self.noise))
        times = plan.duration * np.append(0.0, np.geomspace(1e-6, 1.0, START_SAMPLES))
        doubt = 2.0 * self.noise * np.array([-1.0, 0.0, 1.0])
        low, taken, high = np.interp(x[seen] + doubt, sample_setpoint(plan, times)[:, 0], times)
        begin = float(t[seen] - taken)
        if not motion.is_cut:
            # All samples tell it better than the first, if they are the plan's.
            told, speed, *_ = sample_setpoint(plan, t - begin).T
            exact = begin - float(speed @ (x - told)) / max(float(speed @ speed), 1e-300)
            off = np.abs(x - sample_setpoint(plan, t - exact)[:, 0])
            if off.max() <= CALM * self.noise:
                motion = replace(motion, is_planned=True, end=exact + plan.duration)
                begin = exact
            motion = replace(motion, end=max(motion.end, begin + plan.duration))
        return replace(motion, begin=begin, blur=0.5 * float(high - low))

    def _reached_by_filter(self, order: int, part: slice, *, limit: float) -> Reached:
        """The same where a filter leaves little of the limit."""
        rough = self._reached(order, part, wanted=WANTED * limit)
        return self._reached(order, part, wanted=WANTED * min(limit, rough.value))

    def _reached(self, order: int, part: slice, *, wanted: float) -> Reached:
        """Largest difference quotient, as coarse as the noise demands."""
        x, h = self.x[part], self.h
        gain = SIGMAS * NOISE_GAIN[order - 1] * self.noise
        width = max(ceil((gain / max(wanted, 1e-300)) ** (1.0 / order) / h), 1)
        width = int(min(width, max((x.size - 1) // (2 * order), 1)))
        difference = x
        for _ in range(order):
            difference = difference[width:] - difference[:-width]
        w = width * h
        value = float(np.abs(difference).max(initial=0.0)) / w**order
        return Reached(value=value, uncertainty=gain / w**order, width=order * w)

    def _coast(self, begin: int, velocity: Reached) -> tuple[int, int, float] | None:
        """First and last sample of the coasting that follows, and its velocity."""
        x, h = self.x, self.h
        width = max(round(velocity.width / h), 1)
        rate = np.abs(x[width:] - x[:-width]) / (width * h)
        top = float(rate.max())
        steady = top - rate <= max(1e-3 * top, CALM * self.noise / (width * h))
        steady[:begin] = False
        places = np.flatnonzero(steady)
        breaks = np.flatnonzero(np.diff(places) > 2)
        if places.size < LEAST_REST_STEPS:
            return None
        first, last = int(places[0]), int(places[breaks[0]] if breaks.size else places[-1]) + width
        middle = np.arange(first + (last - first) // 4, last - (last - first) // 8)
        if middle.size < LEAST_REST_STEPS or last - first < LEAST_REST / h:
            return None
        line = np.polynomial.Polynomial.fit(middle, x[middle], 1)
        off = np.abs(x - line(np.arange(x.size))) > CALM * self.noise + 1e-9 * float(np.ptp(x))
        before, after = np.flatnonzero(off[: middle[0]]), np.flatnonzero(off[middle[-1] :])
        return (
            int(before[-1]) + 1 if before.size else first,
            int(middle[-1] + after[0]) - 1 if after.size else x.size - 1,
            float(line.deriv()(0)) / h,
        )


def _smooth(t: Array, x: Array, noise: float) -> BSpline:
    """The spline of fewest knots that stays within the noise of the samples.

    Source: P. Dierckx, Curve and Surface Fitting with Splines (1993), chapter 5.
    """
    return BSpline(*splrep(t, x, k=SPLINE, s=t.size * noise**2, quiet=1))


SAME_SIZE = 0.02
"""Relative difference of travel and velocity up to which a move is the record's."""

ABOVE, BELOW = 1.05, 0.9
"""Shares of what was planned between which the setpoint obeys (values are rounded at entry)."""

CRUISE, CRUISE_SHARE = 0.998, 0.15
"""A velocity this near to the largest one, for this share of a move, is one that was set."""

TELLING = 0.1
"""Uncertainty, as share of what was planned, above which nothing is said for the planner."""

START_SAMPLES = 4000
"""Of a plan, close together at its start."""

PHASES = 16
"""Places of the samples within a step at which the plan is looked at."""


def number_of(motion: Motion, moves: tuple[Move, ...], entered: MotionLimits) -> int:
    """Return which of the record's moves was recorded, from 1; 0 for none of them."""
    for number, move in enumerate(moves, start=1):
        if isinstance(move, VelocityStep):
            if motion.coasts and _alike(abs(motion.final_velocity), move.velocity_step):
                return number
        elif not motion.coasts and _alike(abs(motion.travel), move.distance):
            top = _peaks(plan_setpoint(move, entered), 1, motion.velocity).max()
            slower = motion.velocity.value < (1.0 - SAME_SIZE) * top - motion.velocity.uncertainty
            faster = motion.velocity.value > (1.0 + SAME_SIZE) * move.max_velocity
            # With a lower feed it is another move; one that is slower all along is this one.
            if not faster and not (slower and _cruises(motion)):
                return number
    return 0


def _cruises(motion: Motion) -> bool:
    speed = np.abs(motion.sample(np.linspace(motion.begin, motion.end, 400))[:, 1])
    return float(np.mean(speed > CRUISE * speed.max())) > CRUISE_SHARE


def _alike(one: float, other: float) -> bool:
    return abs(one - other) <= SAME_SIZE * other


def planned(motion: Motion, move: Move | None, entered: MotionLimits) -> Setpoint | None:
    """Return what the control should have sent; None where that cannot be planned."""
    if move is None and motion.coasts:
        move = VelocityStep(velocity_step=abs(motion.final_velocity))
    elif move is None:
        velocity = motion.velocity.value + motion.velocity.uncertainty
        move = Positioning(distance=abs(motion.travel), max_velocity=velocity)
    try:
        return plan_setpoint(move, entered)
    except MtcommissionError:
        return None


def _peaks(setpoint: Setpoint, order: int, reached: Reached) -> Array:
    """Largest difference quotient of a plan over the width of the recorded one, at each phase."""
    width = reached.width / order
    times = np.arange(-order, setpoint.duration / width + order + 1, dtype=np.float64) * width
    phases = width * np.arange(PHASES, dtype=np.float64)[:, None] / PHASES
    x: Array = sample_setpoint(setpoint, (times + phases).ravel())[:, 0].reshape(PHASES, -1)
    return np.asarray(np.abs(np.diff(x, n=order, axis=1)).max(axis=1) / width**order)


def check_planner(
    motion: Motion,
    setpoint: Setpoint | None,
    entered: MotionLimits,
    units: AxisUnits,
    *,
    is_known: bool,
) -> list[Check]:
    """Return velocity, acceleration and jerk of a recorded move against what was entered.

    ``is_known``: whether it is one of the record's; else nobody entered its velocity.
    """
    top = inf
    if setpoint is not None:
        move = setpoint.move
        top = move.max_velocity if isinstance(move, Positioning) else move.velocity_step
    rows = (
        ("velocity", motion.velocity, top, units.velocity.si),
        ("acceleration", motion.acceleration, entered.acceleration, units.acceleration.si),
        ("jerk", motion.jerk, entered.jerk, units.jerk.si),
    )
    found = []
    for order, (key, reached, limit, unit) in enumerate(rows, start=1):
        plan = _peaks(setpoint, order, reached) if setpoint else None
        by = "entry" if is_known or key != "velocity" else "trace"
        found.append(_check(key, reached, limit, unit, plan, by=by))
    return found


def _check(
    key: str, reached: Reached, limit: float, unit: str, plan: Array | None, *, by: str
) -> Check:
    """What was measured against the plan's means over the same width; without one, the limit."""
    value, error = reached.value, reached.uncertainty
    predicted = low = high = None
    verdict, kind = Verdict.UNKNOWN, "coarse" if plan is not None else "no-plan"
    above, below = ABOVE * limit, -inf
    if plan is not None:
        # The samples of the record lie at one phase, which nobody knows.
        predicted = float(plan.max())
        low, high = below, above = BELOW * float(plan.min()), ABOVE * predicted
    if value - error > above or value + error < below:
        verdict, kind = Verdict.FAILS, "above" if value > above else "below"
    elif predicted is not None and error <= TELLING * predicted:
        verdict, kind = Verdict.HOLDS, "obeyed"
    return Check(
        key=f"setpoint {key}",
        unit=unit,
        predicted=predicted,
        low=low,
        high=high,
        limit=limit if plan is None and limit < inf else None,
        measured=value,
        uncertainty=error,
        verdict=verdict,
        reason=Message(
            f"verify-setpoint-{kind}", width=reached.width, entered=limit, unit=unit, by=by
        ),
        decides=key != "jerk",
    )
