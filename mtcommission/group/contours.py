"""What contours do: circles and their entry, corners, lines, of two axes.

**Circle.** An axis answers x = cos(ω t), ω = v/R, with |G| cos(ω t + arg G) at the tool, G of
filter, wait and loop. Two axes draw (R/2) ((G_x + G_y) e^{iωt} + conj(G_x - G_y) e^{-iωt}), an
ellipse about the delayed circle, whose radius lies between R (|G_x + G_y| ± |G_x - G_y|)/2. Exact
for the linear loop while the circle lasts.

**Corner, entry.** The velocity turns at once, on an arc that the control puts in, or for good into
a circle. An axis answers a step of velocity with s(t), filter, wait and loop together; the tool is
then at x_i(t) = v u_i (t - T_i) + Σ_k Δv_ik s_i(t - t_k), T_i the delay of axis i, Δv_ik the steps
in which the velocity turns; in the same way by steps of acceleration where a circle begins. A
corner's deviation is the larger of the distances from the path to its two lines and from the corner
to the path: without an arc proportional to v, behind a moving average alone v T/4 sin(α/2).

**Line.** Both axes get their share of one motion, so that the tool leaves it by |u_x u_y| times
what their answers to the whole motion differ by.

Source: derived here; for small ω a lag gives -v²/(2 R Kv²), a moving average -v² T²/(24 R) (facts
of the project), held to by tests.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import atan2, ceil, cos, hypot, inf, pi, radians, sin, sqrt, tan

import numpy as np
from numpy.typing import NDArray

from mtcommission.controls.control import Corner, CornerRule
from mtcommission.group.follow import Circles, Follower, instants_of, starts_of
from mtcommission.machine.moves import VelocityStep
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import JerkSteps, jerk_steps

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

Pair = tuple[Follower, Follower]
"""The two axes that draw circles and corners."""

DIRECTIONS = np.exp(1j * pi / 16 * np.arange(16))
"""In which a corner or a circle is entered, over half a turn (design choice)."""

ENTRIES = 24
"""Circles whose entry is looked at, between the slowest and the fastest (empirical)."""

ANGLES = (15.0, 30.0, 45.0, 60.0, 90.0, 120.0, 135.0, 150.0)
"""Changes of direction that are looked at [degrees]."""

SHARES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Of the tolerance that an arc may take, the rest is the loop's."""

HALVINGS = 9
"""Of the range of speeds: to 0.2 % of it."""

RISES = np.array((0.05, 0.2, 0.5, 1.0))
"""Shares of the feed to which a line accelerates."""

SLOPES = np.arange(1, 8) * pi / 16
"""Directions of lines that are looked at, beside those in which two axes are at their limits [rad]:
lines along an axis leave nothing, and the others mirror these."""


# Circles


@dataclass(frozen=True, slots=True, kw_only=True)
class Deviation:
    """How circles come out, as shares of their radius [-], each of the shape of what is asked."""

    radius: Array  # of the mean radius; negative: too small
    ellipse: Complex
    """E: the radius is off by Re E cos 2θ + Im E sin 2θ, too, θ the tool's angle, counterclockwise;
    clockwise Im E has the other sign."""

    @property
    def form(self) -> Array:
        """Largest less smallest radius."""
        return np.asarray(2.0 * np.abs(self.ellipse))

    @property
    def largest(self) -> Array:
        """How far the tool is from the circle at most."""
        return np.asarray(np.abs(self.radius) + np.abs(self.ellipse))


def deviate(first: Complex, second: Complex) -> Deviation:
    """Return the deviations of circles from the complex responses of two axes."""
    mean = 0.5 * np.abs(first + second)
    E = 0.25 * np.conj(first - second) * (first + second) / mean
    return Deviation(radius=mean - 1.0, ellipse=E)


def every_circle(pair: Pair, omega: Array) -> Deviation:
    """Return circles in every pair of corners, the nominal first, shape (n_pairs, n_omega)."""
    first, second = (axis.response(omega) for axis in pair)
    found = deviate(first[:, None], second[None])
    return Deviation(
        radius=found.radius.reshape(-1, omega.size), ellipse=found.ellipse.reshape(-1, omega.size)
    )


def worst_circle(pair: Pair, omega: Array) -> tuple[Deviation, NDArray[np.intp]]:
    """Return the worst deviation of every pair of corners, and which pair it is, (n_omega,)."""
    every = every_circle(pair, omega)
    worst = every.largest.argmax(axis=0)
    at = worst, np.arange(omega.size)
    return Deviation(radius=every.radius[at], ellipse=every.ellipse[at]), worst


def entries_at_first_look(pair: Pair) -> Array:
    """Return what ``find_entries`` does, as if each axis alone had its step of acceleration."""
    worst = 0.0
    for axis in pair:
        starts = starts_of([axis])
        found = axis.to_step(2, starts, axis.cycles(0.0))
        worst = max(worst, float(np.abs(found - 0.5 * _late(axis, starts, found) ** 2).max()))
    return np.asarray(worst * pair[0].omega ** 2)


def _late(axis: Follower, starts: Array, found: Array) -> Array:
    """Time since a step without the lag, of slow motion: (n_starts, n_corners, n_times) [s]."""
    t = axis.step * np.arange(found.shape[2])
    return np.asarray(np.maximum(t - starts[:, None, None] - axis.lag[:, None], 0.0))


def find_entries(pair: Pair) -> Array:
    """Return how far the tool is off a line and the circle that is entered from it, at most.

    As shares of the radius, by the angular velocities of the pair, shape (n_omega,) [-]: in every
    direction, at every phase of the cycle, in the nominal machines and those that are furthest off.
    """
    omega = np.geomspace(pair[0].omega[0], pair[0].omega[-1], ENTRIES)
    axes = turnings(pair, derivative=2)
    step, starts = axes[0].step, axes[0].starts
    length = max(one.tool.shape[2] for one in axes)
    # The mean acceleration of each step, so that the velocity is exact at its ends.
    turned = np.exp(1j * np.outer(omega, step * np.arange(length)))
    mean = np.exp(1j * omega * step) - 1.0
    changes = (turned * mean[:, None] / step) * (1.0 - np.exp(-1j * omega * step))[:, None]
    changes[:, 0] = mean / step
    padded = 1 << (2 * length).bit_length()
    turning, t = np.fft.fft(changes, padded), step * np.arange(length)
    worst = np.zeros(ENTRIES)
    answers = []
    for one in axes:
        spectrum = turning[:, None, None] * np.fft.fft(one.extended(length), padded)
        found = np.fft.ifft(spectrum)[..., :length]
        answers.append(found + (t - starts[:, None, None] - one.lag[:, None]))
    centre = 1j / omega[:, None]
    for k in range(len(starts)):
        for C_x in np.moveaxis(answers[0][:, k], 1, 0):
            for C_y in np.moveaxis(answers[1][:, k], 1, 0):
                for z in _in_directions(C_x, C_y):
                    from_circle = np.abs(np.abs(z - centre) - centre.imag)
                    off = np.where(
                        z.real < 0.0, np.minimum(np.abs(z.imag), from_circle), from_circle
                    )
                    worst = np.maximum(worst, off.max(axis=1) * omega)
    known = np.log(np.maximum(worst, 1e-30))
    return np.asarray(np.exp(np.interp(np.log(pair[0].omega), np.log(omega), known)))


def _in_directions(C_x: Complex, C_y: Complex) -> Iterator[Complex]:
    """The tool in the path's own directions, from the axes' answers to it, entered in each."""
    for turn in DIRECTIONS:
        yield np.conj(turn) * ((turn * C_x).real + 1j * (turn * C_y).imag)


# A circle test

SINCE = (np.arange(121) / 120) ** 1.5
"""When after a reversal the tool is looked at, close together where it moves most, in times of the
loop [-]."""

PLACES = 720
"""Of a circle that are drawn, beside those after each reversal."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """A circle as a ballbar sees it: radius less the nominal one over the angle."""

    angle: Array  # [rad]
    deviation: Array  # outwards positive [m]

    @property
    def largest(self) -> float:
        """Radial deviation F_max of ISO 230-4 [m]."""
        return float(self.deviation.max())

    @property
    def least(self) -> float:
        """Radial deviation F_min of ISO 230-4 [m]."""
        return float(self.deviation.min())

    @property
    def circular(self) -> float:
        """Circular deviation G of ISO 230-4 about the centre: largest less smallest radius [m]."""
        return self.largest - self.least


def trace_circles(pair: Pair, circles: Circles) -> list[Trace]:
    """Return how the nominal machine draws circles, counterclockwise, their reversals included."""
    every = [axis.reversals(circles)[:, 0] for axis in pair]
    return [
        _trace(pair, radius, feed, [off[k] for off in every])
        for k, (radius, feed) in enumerate(circles)
    ]


def _trace(pair: Pair, radius: float, feed: float, offs: Sequence[Array]) -> Trace:
    omega, quarters = feed / radius, (0.0, 0.5 * pi)
    late = [quarter + omega * axis.reverses for axis, quarter in zip(pair, quarters, strict=True)]
    every = [np.arange(PLACES) * 2.0 * pi / PLACES]
    every += [
        half + after + omega * axis.fades * SINCE
        for axis, after in zip(pair, late, strict=True)
        for half in (0.0, pi)
    ]
    phase = np.unique(np.concatenate(every) % (2.0 * pi))
    path = []
    for axis, quarter, after, off in zip(pair, quarters, late, offs, strict=True):
        answer = axis.response(np.array([omega]))[0, 0]
        position = radius * (answer * np.exp(1j * (phase - quarter))).real
        # From one reversal to the next; friction throws the tool to the side it comes from.
        halves, since = np.divmod(phase - after, pi)
        t = axis.poles.velocity_cycle * np.arange(off.size)
        thrown = np.interp(since / omega, t, off, right=0.0)
        path.append(position + np.where(halves % 2 == 0, thrown, -thrown))
    return Trace(angle=np.arctan2(path[1], path[0]), deviation=np.hypot(*path) - radius)


# Corners


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Turning:
    """How an axis answers a step of velocity or acceleration, in some corners of the machine."""

    step: float  # of time [s]
    starts: Array  # when the step comes, within the first position cycle [s]
    tool: Array  # its position for a step of 1, (n_starts, n_corners, n_times)
    lag: Array  # of slow motion behind the setpoint, (n_corners,) [s]
    largest_step: float = inf  # of velocity, that the force allows [m/s]

    def extended(self, length: int) -> Array:
        """Return ``tool`` as it coasts on for more times."""
        last = self.tool[..., -1:]
        slope = last - self.tool[..., -2:-1]
        more = last + slope * np.arange(1, length - self.tool.shape[2] + 1)
        return np.concatenate([self.tool, more], axis=2)


def turnings(pair: Pair, *, derivative: int = 1) -> tuple[Turning, Turning]:
    """Return how two axes answer steps, in the nominal machine and the one that is furthest off."""
    starts, found = starts_of(pair), []
    cycles = max(axis.cycles(0.0) for axis in pair)
    for axis in pair:
        tool = axis.to_step(derivative, starts, cycles)
        ideal = _late(axis, starts, tool) ** derivative / derivative
        worst = int(np.abs(tool - ideal).max(axis=(0, 2)).argmax())
        own = [0, worst] if worst else [0]
        found.append(
            Turning(
                step=axis.step,
                starts=starts,
                tool=tool[:, own],
                lag=axis.lag[own],
                largest_step=axis.largest_step(starts),
            )
        )
    return found[0], found[1]


def corner_deviation(
    axes: tuple[Turning, Turning], angle: float, speed: float, arc: float = 0.0
) -> float:
    """Return the largest deviation at a corner [m], every direction and pair of corners.

    ``angle``: change of direction [rad]; ``speed``: constant, along the path [m/s]; ``arc``: radius
    of that which the control puts in [m], 0: none, the velocity turns at once.
    """
    first, _ = axes
    step, turns = first.step, angle * arc / speed
    count = max(ceil(turns / step), 1)
    # The arc begins before the corner, by the length of its tangent.
    begin = -arc * tan(0.5 * angle) / speed
    turned = np.diff(np.exp(1j * angle * np.minimum(np.arange(count + 1) / count, 1.0)))
    length = max(one.tool.shape[2] for one in axes) + count
    # An arc turns the velocity a little in every cycle, so that it has no phase of its own.
    phases, t = 1 if arc else len(first.starts), begin + step * np.arange(length)
    tools = [one.extended(length) for one in axes]
    worst = 0.0
    for k in range(phases):
        (x, y) = (
            [
                t - first.starts[k] - late + np.convolve(turned, tool)[:length]
                for late, tool in zip(one.lag, own[k], strict=True)
            ]
            for one, own in zip(axes, tools, strict=True)
        )
        worst = max(
            worst, *(_hausdorff(z, angle) for a in x for b in y for z in _in_directions(a, b))
        )
    return speed * worst


def _hausdorff(path: Complex, angle: float) -> float:
    """Distance between a path and the corner at the origin, entered along the real axis."""
    behind = path * np.exp(-1j * angle)
    nearest = np.abs(path)
    nearest = np.minimum(nearest, np.where(path.real < 0.0, np.abs(path.imag), inf))
    nearest = np.minimum(nearest, np.where(behind.real > 0.0, np.abs(behind.imag), inf))
    # Between two instants the path comes nearer to the corner than at either.
    legs = np.diff(path)
    share = -(path[:-1] * legs.conj()).real / np.maximum(np.abs(legs) ** 2, 1e-300)
    closest = np.abs(path[:-1] + np.clip(share, 0.0, 1.0) * legs).min()
    return float(max(nearest.max(), closest))


@dataclass(frozen=True, slots=True, kw_only=True)
class CornerSpeed:
    """How fast a corner is passed within the tolerance."""

    angle_deg: float  # change of direction
    speed: float  # [m/s]
    arc_radius: float  # of what the control puts in [m]; 0: the velocity turns at once
    deviation_without_slowing: float  # at the feed [m]

    @property
    def angle(self) -> float:
        """Change of direction [rad]."""
        return radians(self.angle_deg)

    @property
    def arc_deviation(self) -> float:
        """Distance of the arc from the corner [m]."""
        s = cos(0.5 * self.angle)
        return self.arc_radius * (1.0 - s) / s


def speeds_at_once(
    axes: tuple[Turning, Turning], *, tolerance: float, feed: float
) -> tuple[CornerSpeed, ...]:
    """Return the largest speed over the angle where the velocity turns at once.

    No axis steps its velocity by more than its force allows.
    """
    largest_step, found = min(axis.largest_step for axis in axes), []
    for degrees in ANGLES:
        angle = radians(degrees)
        off = corner_deviation(axes, angle, feed)
        speed = min(feed, feed * tolerance / off, largest_step / (2.0 * sin(0.5 * angle)))
        found.append(
            CornerSpeed(
                angle_deg=degrees, speed=speed, arc_radius=0.0, deviation_without_slowing=off
            )
        )
    return tuple(found)


def speeds_on_arcs(
    axes: tuple[Turning, Turning], *, tolerance: float, feed: float, acceleration: float
) -> tuple[CornerSpeed, ...]:
    """Return the same where the control puts an arc in: v² <= acceleration times its radius.

    A control is told one deviation for the arcs of all corners: that which passes a right angle
    soonest, none where turning at once is as fast there.
    """
    plain = speeds_at_once(axes, tolerance=tolerance, feed=feed)
    right = plain[ANGLES.index(90.0)]

    def on_arc(one: CornerSpeed, share: float, *, least: float = 0.0) -> CornerSpeed:
        s = cos(0.5 * one.angle)
        arc = share * tolerance * s / (1.0 - s)
        low, high = 0.0, min(feed, sqrt(acceleration * arc))
        is_slower = bool(least) and corner_deviation(axes, one.angle, least, arc) > tolerance
        if high <= least or is_slower:
            return replace(one, speed=0.0, arc_radius=arc)
        if corner_deviation(axes, one.angle, high, arc) <= tolerance:
            low = high
        for _ in range(0 if low else HALVINGS):
            middle = 0.5 * (low + high)
            off = corner_deviation(axes, one.angle, middle, arc)
            low, high = (middle, high) if off <= tolerance else (low, middle)
        return replace(one, speed=low, arc_radius=arc)

    tried = (on_arc(right, share, least=right.speed) for share in SHARES)
    best = max(tried, key=lambda one: one.speed)
    if best.speed <= right.speed:
        return plain
    return tuple(on_arc(one, best.arc_deviation / tolerance) for one in plain)


def tell_corner(
    rule: CornerRule,
    speeds: tuple[CornerSpeed, ...],
    *,
    tolerance: float,
    accelerations: tuple[float, float],
) -> float:
    """Return what a control is told so that it passes no corner faster [SI]; 0: no value does.

    ``accelerations``: of both axes [m/s²].
    """
    s = np.cos([0.5 * one.angle for one in speeds])
    v = np.array([one.speed for one in speeds])
    q = float((v**2 * (1.0 - s) / s).min())
    square = cos(0.25 * pi)
    found = {
        # At 45 degrees to both axes each of them steps by the least share of the whole.
        Corner.STEP: float((2.0 * np.sqrt(1.0 - s**2) * v).min()) * square,
        Corner.JUNCTION: sqrt(q * square / (1.0 - square)),
        # In no direction do two axes together have more than this.
        Corner.DEVIATION: q / hypot(*accelerations),
        Corner.ARC: max(one.arc_deviation for one in speeds),
        Corner.OWN: tolerance,
    }[rule.kind]
    return 0.0 if found < rule.least else min(found, rule.most)


# Lines


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLimits:
    """What a control keeps along the path: what it is told for it, and the limits of the axes."""

    acceleration: float  # told [m/s²]; inf: nothing
    jerk: float  # told [m/s³]; inf: nothing
    accelerations: tuple[float, float]  # of both axes
    jerks: tuple[float, float]

    @property
    def on_circles(self) -> tuple[float, float]:
        """Acceleration and jerk that a circle may take, whose direction turns."""
        return (
            min(self.acceleration, *self.accelerations),
            min(self.jerk, *self.jerks),
        )

    def within(self, own: MotionLimits) -> MotionLimits:
        """Return the limits of an axis as far as those that the path is told leave them."""
        return replace(
            own,
            acceleration=min(own.acceleration, self.acceleration),
            jerk=min(own.jerk, self.jerk),
        )

    def along(self, slopes: Array) -> tuple[Array, Array]:
        """Return acceleration and jerk of lines in some directions [rad], shape of these."""
        shares = np.array([np.cos(slopes), np.sin(slopes)])
        a, j = (
            np.minimum(told, np.min(np.array(axes)[:, None] / shares, axis=0))
            for told, axes in (
                (self.acceleration, self.accelerations),
                (self.jerk, self.jerks),
            )
        )
        return a, j


def line_deviation(pair: Pair, *, feed: float, limits: PathLimits) -> tuple[float, float]:
    """Return how far the tool leaves a line at most while it starts or stops on it, and which.

    Up to the feed [m/s]; result [m], and the direction of the worst line [rad].
    """
    bends = [atan2(y, x) for x, y in (limits.accelerations, limits.jerks)]
    slopes = np.append(SLOPES, bends)
    a, j = (np.repeat(one, len(RISES)) for one in limits.along(slopes))
    sizes = np.tile(feed * RISES, len(slopes))
    steps = jerk_steps(VelocityStep(velocity_step=feed), acceleration=a, jerk=j, size=sizes)
    own = (np.split(one, len(slopes)) for one in (steps.times, steps.steps))
    apart = [
        _apart(pair, JerkSteps(times=times, steps=sizes)) for times, sizes in zip(*own, strict=True)
    ]
    off = np.sin(slopes) * np.cos(slopes) * np.array(apart)
    worst = int(off.argmax())
    return float(off[worst]), float(slopes[worst])


def _apart(pair: Pair, steps: JerkSteps) -> float:
    """How far two axes are apart at most behind the same setpoints, in any corner of each [m]."""
    each = instants_of(pair, steps)
    x, y = (np.moveaxis(axis.tool(steps, each), 1, 0) for axis in pair)
    return max(float(np.abs(one - other).max()) for one in x for other in y)
