"""The setpoint of a trace: its moves, how fast they were, and what the loop was given.

Differences over a width w are means of the derivative under a kernel that is nowhere negative
(a box for the velocity, a B-spline of width 2 w for the acceleration, of 3 w for the jerk): they
never exceed the true largest value, whatever the planner does between.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline, make_lsq_spline

from mtcommission.verify.trace import Array, Channel, resolution

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

SPLINE = 5
"""Degree: the jerk of the setpoint is then continuous, as the position cycle sees it."""

SPACINGS = (64, 48, 32, 24, 16, 12, 8, 6, 4, 3, 2)
"""Samples between knots that are tried, the smoothest first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reached:
    """Largest magnitude of a derivative of the setpoint."""

    value: float  # Mean over ``width`` where it is largest [SI]
    uncertainty: float  # Of this value, by the resolution of the record [SI]
    width: float  # Over which it is a mean [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """A stretch of the setpoint from rest to the next move."""

    # begin, end, until: First sample that moves, instant from which the setpoint rests (or coasts),
    # end of the dwell (of the coasting) [s].
    begin: float
    end: float
    until: float
    coasts: bool  # Whether it ends at a constant velocity instead of rest
    travel: float  # Way from ``begin`` to ``end``, signed [m]
    # velocity, acceleration, jerk: Largest magnitudes.
    velocity: Reached
    acceleration: Reached
    jerk: Reached
    # How far ``begin`` and ``end`` may be off, since the first and last steps are below the
    # resolution [s].
    blur: float
    is_cut: bool  # Whether the record ends before the setpoint does
    # start, final_velocity: Position before it [m], and velocity after it [m/s].
    start: float
    final_velocity: float
    spline: BSpline  # The setpoint between, smoothed as its resolution demands
    misfit: float  # RMS distance of the recorded setpoint from it [m]

    def sample(self, t: Array) -> Array:
        """Return x_ref, v_ref, a_ref, j_ref relative to the start, shape (n, 4)."""
        inside = (t > self.begin) & (t < self.end)
        rows = np.zeros((t.size, 4))
        clipped = np.clip(t, self.begin, self.end)
        for order in range(4):
            values = np.asarray(self.spline(clipped, nu=order))
            rows[:, order] = np.where(inside, values, 0.0)
        rows[:, 0] -= np.where(inside, self.start, 0.0)
        after = t >= self.end
        rows[after, 0] = self.travel + self.final_velocity * (t[after] - self.end)
        rows[after, 1] = self.final_velocity
        return rows


def find_motions(
    channel: Channel, *, acceleration: float, jerk: float, coasting: bool
) -> tuple[list[Motion], bool]:
    """Return the moves of a setpoint, and whether the record begins in the middle of one."""
    setpoint = _without_holds(channel)
    x, h = setpoint.values, setpoint.step
    noise = max(_noise(x), channel.error)
    moving = _moving(x, h, noise)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], moving, [False]]).astype(np.int8)))
    pairs = list(zip(edges[::2], edges[1::2], strict=True))
    begins_moving = bool(pairs) and pairs[0][0] == 0
    found = []
    for place, (first, last) in enumerate(pairs):
        if first == 0:
            continue
        following = pairs[place + 1][0] if place + 1 < len(pairs) else x.size
        before = pairs[place - 1][1] if place else 0
        window = slice(before, following)
        own = _Stretch(x[window], h, float(setpoint.t[before]), first - before, last - before)
        found.append(own.motion(noise, acceleration=acceleration, jerk=jerk, coasting=coasting))
    return found, begins_moving


def _without_holds(channel: Channel) -> Channel:
    """The samples at which a setpoint that is held over some samples changes."""
    x = channel.values
    steps = np.abs(np.diff(x))
    usual = float(steps.max())
    at = np.flatnonzero(steps > 0.05 * usual)
    if at.size < 8:
        return channel
    spacing = np.diff(at)
    held = int(np.median(spacing))
    if held < 2 or float(np.mean(spacing % held == 0)) < 0.9:
        return channel
    phase = int(np.bincount((at + 1) % held).argmax())
    return Channel(
        role=channel.role,
        name=channel.name,
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
    """Which samples are part of a move."""
    quiet = np.abs(np.diff(x)) <= CALM * noise
    least = max(LEAST_REST_STEPS, ceil(LEAST_REST / h))
    moving = np.ones(x.size, dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], quiet, [False]]).astype(np.int8)))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first < least:
            continue
        # A slow start is quiet, too: what stands is what stays at one level.
        run = x[first : last + 1]
        level = np.abs(run - np.median(run)) <= CALM * noise
        ends = np.flatnonzero(np.diff(np.concatenate([[False], level, [False]]).astype(np.int8)))
        for begin, end in zip(ends[::2], ends[1::2], strict=True):
            if end - begin > least:
                moving[first + begin : first + end] = False
    return moving


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Samples from the end of one move to the begin of the one after the next."""

    x: Array
    h: float
    origin: float
    first: int
    last: int

    def motion(self, noise: float, *, acceleration: float, jerk: float, coasting: bool) -> Motion:
        x, h = self.x, self.h
        level = CALM * noise
        start = float(np.median(x[: self.first]))
        off = np.flatnonzero(np.abs(x - start) > level)
        begin = int(off[0]) - 1 if off.size else self.first
        last, until, speed = min(self.last, x.size - 1), x.size - 1, 0.0
        is_cut = self.last >= x.size - 1
        velocity = self._reached(1, slice(begin, x.size), noise, wanted=WANTED * _top(x, h))
        if coasting:
            coast = self._coast(begin, noise, velocity)
            if coast is not None:
                last, until, speed = coast
                is_cut = False
        end_level = x[last] if speed == 0.0 else 0.0
        if speed == 0.0 and not is_cut:
            end_level = float(np.median(x[last:]))
            away = np.flatnonzero(np.abs(x - end_level) > level)
            last = min(int(away[-1]) + 1, x.size - 1) if away.size else last
        part = slice(max(begin - 8, 0), min(last + 9, x.size))
        reached = [
            self._reached_by_filter(order, part, noise, limit=limit)
            for order, limit in ((2, acceleration), (3, jerk))
        ]
        blur = (6.0 * level / max(reached[1].value, 1e-300)) ** (1.0 / 3.0)
        blur = min(blur, 0.25 * h * (last - begin))
        t: Array = self.origin + h * np.arange(x.size, dtype=np.float64)
        begin_t, end_t = max(t[begin] - blur + h, t[0]), min(t[last] + blur - h, t[until])
        begin_t, end_t = min(begin_t, t[begin] + h), max(end_t, t[last] - h)
        spline, misfit = _smooth(t[part], x[part], noise)
        if is_cut:
            travel = float(x[-1] - start)
        elif speed:
            travel = float(spline(end_t)) - start
        else:
            travel = float(end_level) - start
        return Motion(
            begin=float(begin_t), end=float(end_t), until=float(t[until]), coasts=speed != 0.0,
            travel=travel, velocity=velocity, acceleration=reached[0], jerk=reached[1],
            blur=blur + h, is_cut=is_cut, start=start, final_velocity=speed, spline=spline,
            misfit=misfit,
        )  # fmt: skip

    def _reached_by_filter(self, order: int, part: slice, noise: float, *, limit: float) -> Reached:
        """The same where a filter leaves little of the limit: wider if that tells too little."""
        rough = self._reached(order, part, noise, wanted=WANTED * limit)
        if rough.uncertainty <= 2.0 * WANTED * rough.value:
            return rough
        return self._reached(order, part, noise, wanted=WANTED * min(limit, rough.value))

    def _reached(self, order: int, part: slice, noise: float, *, wanted: float) -> Reached:
        """Largest difference quotient, as coarse as the noise demands."""
        x, h = self.x[part], self.h
        gain = SIGMAS * NOISE_GAIN[order - 1] * noise
        width = max(ceil((gain / max(wanted, 1e-300)) ** (1.0 / order) / h), 1)
        width = int(min(width, max((x.size - 1) // (2 * order), 1)))
        difference = x
        for _ in range(order):
            difference = difference[width:] - difference[:-width]
        w = width * h
        value = float(np.abs(difference).max()) / w**order if difference.size else 0.0
        return Reached(value=value, uncertainty=gain / w**order, width=order * w)

    def _coast(self, begin: int, noise: float, velocity: Reached) -> tuple[int, int, float] | None:
        """First and last sample of the coasting that follows, and its velocity."""
        x, h = self.x, self.h
        width = max(round(velocity.width / h), 1)
        rate = (x[width:] - x[:-width]) / (width * h)
        top = float(np.abs(rate).max())
        steady = np.abs(np.abs(rate) - top) <= max(1e-3 * top, CALM * noise / (width * h))
        steady[:begin] = False
        places = np.flatnonzero(steady)
        if places.size < LEAST_REST_STEPS:
            return None
        breaks = np.flatnonzero(np.diff(places) > 2)
        stop = places[breaks[0]] if breaks.size else places[-1]
        first, last = int(places[0]), int(stop) + width
        if last - first < max(LEAST_REST_STEPS, LEAST_REST / h):
            return None
        middle = np.arange(first + (last - first) // 4, last - (last - first) // 8)
        if middle.size < LEAST_REST_STEPS:
            return None
        line = np.polynomial.Polynomial.fit(middle, x[middle], 1)
        every = np.arange(x.size)
        on_line = np.abs(x - line(every)) <= CALM * noise + 1e-9 * abs(float(np.ptp(x)))
        off_before = np.flatnonzero(~on_line[: middle[0]])
        off_after = np.flatnonzero(~on_line[middle[-1] :])
        first = int(off_before[-1]) + 1 if off_before.size else first
        last = int(middle[-1] + off_after[0]) - 1 if off_after.size else x.size - 1
        return first, last, float(line.deriv()(0)) / h


def _top(x: Array, h: float) -> float:
    """Velocity that a move has on the whole, to aim at [m/s]."""
    return float(np.ptp(x)) / (x.size * h)


def _smooth(t: Array, x: Array, noise: float) -> tuple[BSpline, float]:
    """The smoothest spline that stays within the noise of the samples."""
    for spacing in SPACINGS:
        if t.size < 4 * spacing + 2 * SPLINE:
            continue
        inner = t[spacing:-spacing:spacing] if spacing < t.size // 2 else t[:0]
        knots = np.concatenate([[t[0]] * (SPLINE + 1), inner, [t[-1]] * (SPLINE + 1)])
        found = make_lsq_spline(t, x, knots, k=SPLINE)
        off = np.abs(np.asarray(found(t)) - x)
        misfit = float(np.sqrt(np.mean(off**2)))
        if misfit <= 1.2 * noise and float(off.max()) <= CALM * noise:
            return found, misfit
    return make_interp_spline(t, x, k=SPLINE), 0.0
