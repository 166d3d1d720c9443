"""Corners of two axes: how far the tool is from the corner, and how fast it may go there.

A control lets the velocity turn at once, or on an arc that it puts into the corner. An axis answers
a step of velocity with s(t), filter, delay and loop together; the tool is then at

    x_i(t) = v u_i (t - T_i) + Σ_k Δv_ik s_i(t - t_k)

with T_i the delay of axis i and Δv_ik the steps in which the velocity turns. The deviation is the
larger of the distances from the path to the corner's two lines and from the corner to the path.
Without an arc it is proportional to v; behind a moving average alone v T/4 sin(α/2).

Source: derived here; the rules of the controls as ``rules`` names them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, cos, inf, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.answers import PHASES, AxisAnswers

Array = NDArray[np.float64]

ANGLES = (15.0, 30.0, 45.0, 60.0, 90.0, 120.0, 135.0, 150.0)
"""Changes of direction that are looked at [degrees]."""

DIRECTIONS = 16
"""Directions in which the corner is entered, over half a turn (design choice)."""

SHARES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Of the tolerance that an arc may take, the rest is the loop's."""

HALVINGS = 9
"""Of the range of speeds: to 0.2 % of it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Turning:
    """How an axis answers a step of velocity of 1 m/s, in some corners of the machine."""

    step: float  # of time [s]
    starts: tuple[float, ...]  # when the step comes, within the first position cycle [s]
    tool: Array  # its position, (n_starts, n_corners, n_times) [m per m/s]
    lag: Array  # of slow motion behind the setpoint, (n_corners,) [s]
    largest_step: float = inf  # that the force allows [m/s]

    def leading(self) -> Turning:
        """Return the same in the nominal machine and in the corner that is furthest off alone."""
        t = self.step * np.arange(self.tool.shape[2]) - np.array(self.starts)[:, None]
        ideal = np.maximum(t[:, None] - self.lag[:, None], 0.0)
        worst = int(np.abs(self.tool - ideal).max(axis=(0, 2)).argmax())
        own = [0, worst] if worst else [0]
        return replace(self, tool=self.tool[:, own], lag=self.lag[own])


def turn(axis: AxisAnswers, force_limit: float) -> Turning:
    """Return how an axis of some force [N] answers a step of velocity, at every phase."""
    return Turning(
        step=axis.step,
        starts=tuple(phase * axis.poles.dt for phase in PHASES),
        tool=np.array([axis.to_velocity(phase) for phase in PHASES]),
        lag=axis.lag,
        largest_step=axis.largest_step(force_limit),
    ).leading()


@dataclass(frozen=True, slots=True, kw_only=True)
class Arc:
    """What a control puts into a corner; no arc: the velocity turns at once."""

    radius: float  # [m]; 0: none
    deviation: float  # of the arc from the corner [m]


def arc_within(deviation: float, angle: float) -> Arc:
    """Return the arc that passes a corner of a change of direction [rad] at some distance [m]."""
    s = cos(0.5 * angle)
    return Arc(radius=deviation * s / (1.0 - s), deviation=deviation)


NO_ARC = Arc(radius=0.0, deviation=0.0)


def corner_deviation(axes: tuple[Turning, Turning], angle: float, speed: float, arc: Arc) -> float:
    """Return the largest deviation at a corner [m], every direction and pair of corners.

    ``angle``: change of direction [rad]; ``speed``: constant, along the path [m/s].
    """
    first, second = axes
    # An arc turns the velocity a little in every cycle, so that it has no phase of its own.
    phases = 1 if arc.radius else len(first.starts)
    return max(
        _deviation((a, b), (first.step, start, first.lag[i], second.lag[k]), angle, speed, arc)
        for start, one, other in zip(
            first.starts[:phases], first.tool[:phases], second.tool[:phases], strict=True
        )
        for i, a in enumerate(one)
        for k, b in enumerate(other)
    )


def _deviation(
    tools: tuple[Array, Array],
    times: tuple[float, float, float, float],
    angle: float,
    speed: float,
    arc: Arc,
) -> float:
    step, start, *lags = times
    # The arc begins before the corner, by the length of its tangent.
    turns = angle * arc.radius / speed
    count = max(ceil(turns / step), 1)
    begin = -arc.radius * sin(0.5 * angle) / max(cos(0.5 * angle), 1e-9) / speed
    headings = angle * np.minimum(np.arange(count + 1) / count, 1.0)
    length = max(len(tool) for tool in tools) + count
    t = begin + step * np.arange(length) - start
    worst = 0.0
    for direction in np.arange(DIRECTIONS) * pi / DIRECTIONS:
        path = []
        for tool, lag, quarter in zip(tools, lags, (0.0, 0.5 * pi), strict=True):
            # Cosine of the heading for the first axis, its sine for the second.
            u = np.cos(direction + headings - quarter)
            held = np.append(tool, tool[-1] + step * np.arange(1, length - len(tool) + 1))
            moved = u[0] * (t - lag) + np.convolve(np.diff(u), held)[:length]
            path.append(speed * moved)
        worst = max(worst, _hausdorff(np.array(path), direction, angle))
    return worst


def _hausdorff(path: Array, direction: float, angle: float) -> float:
    """Distance between a path, (2, n), and the corner at the origin, either way."""
    from_corner = np.hypot(*path)
    nearest = from_corner.copy()
    for heading, sign in ((direction, -1.0), (direction + angle, 1.0)):
        along = sign * (cos(heading) * path[0] + sin(heading) * path[1])
        beside = np.abs(sin(heading) * path[0] - cos(heading) * path[1])
        nearest = np.minimum(nearest, np.where(along > 0.0, beside, from_corner))
    # Between two instants the path comes nearer to the corner than at either.
    legs = np.diff(path, axis=1)
    share = -np.sum(path[:, :-1] * legs, axis=0) / np.maximum(np.sum(legs**2, axis=0), 1e-300)
    closest = np.hypot(*(path[:, :-1] + np.clip(share, 0.0, 1.0) * legs)).min()
    return float(max(nearest.max(), closest))


@dataclass(frozen=True, slots=True, kw_only=True)
class CornerSpeed:
    """How fast a corner is passed within the tolerance."""

    angle: float  # change of direction [rad]
    speed: float  # [m/s]
    arc: Arc
    deviation: float  # without slowing down, at the feed [m]


def speeds_at_once(
    axes: tuple[Turning, Turning], *, tolerance: float, feed: float
) -> Iterator[CornerSpeed]:
    """Yield the largest speed over the angle where the velocity turns at once.

    No axis steps its velocity by more than its force allows.
    """
    largest_step = min(axis.largest_step for axis in axes)
    for degrees in ANGLES:
        angle = degrees * pi / 180.0
        off = corner_deviation(axes, angle, feed, NO_ARC)
        speed = min(feed, feed * tolerance / off, largest_step / (2.0 * sin(0.5 * angle)))
        yield CornerSpeed(angle=angle, speed=speed, arc=NO_ARC, deviation=off)


def speeds_on_arcs(
    axes: tuple[Turning, Turning],
    *,
    tolerance: float,
    feed: float,
    acceleration: float,
) -> Iterator[CornerSpeed]:
    """Yield the same where the control puts an arc in: v² <= acceleration times its radius.

    A control is told one deviation for the arcs of all corners: that which passes a right angle
    soonest, none where turning at once is as fast there.
    """
    plain = tuple(speeds_at_once(axes, tolerance=tolerance, feed=feed))
    right = next(one for one in plain if one.angle == 0.5 * pi)

    def on_arc(one: CornerSpeed, share: float, *, least: float = 0.0) -> CornerSpeed:
        arc = arc_within(share * tolerance, one.angle)
        low, high = 0.0, min(feed, sqrt(acceleration * arc.radius))
        is_slower = bool(least) and corner_deviation(axes, one.angle, least, arc) > tolerance
        if high <= least or is_slower:
            return replace(one, speed=0.0, arc=arc)
        if corner_deviation(axes, one.angle, high, arc) <= tolerance:
            low = high
        for _ in range(0 if low else HALVINGS):
            middle = 0.5 * (low + high)
            off = corner_deviation(axes, one.angle, middle, arc)
            low, high = (middle, high) if off <= tolerance else (low, middle)
        return replace(one, speed=low, arc=arc)

    tried = (on_arc(right, share, least=right.speed) for share in SHARES)
    best = max(tried, key=lambda one: one.speed)
    if best.speed <= right.speed:
        yield from plain
        return
    share = best.arc.deviation / tolerance
    yield from (on_arc(one, share) for one in plain)
