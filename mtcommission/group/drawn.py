"""What sheet and page draw circles and corners from: how both axes of the plane answer them."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.answers import filter_lag
from mtcommission.group.circle import AFTER, ToolResponse, reversal_course
from mtcommission.group.contours import Contours, turnings
from mtcommission.group.group import Group, GroupAxis, worst_deviation
from mtcommission.group.rules import Corner
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.shape import finite_or_none
from mtcommission.record.values import rounded

Array = NDArray[np.float64]

DECIMALS, DIGITS = 9, 5
"""Of what is near 1, and of lengths: 1 nm on the largest circle."""

PAUSE = 1.5 * AFTER
"""Between two reversals where more than those of the circle test are looked at [s]."""

SINCE = AFTER * (np.arange(121) / 120) ** 1.5
"""When after a reversal the tool is looked at, close together where it moves most [s]."""

PLACES = 720
"""Of a circle that are drawn, beside those after each reversal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReversalEntry:
    """How friction throws the tool off behind a reversal; that hangs on v²/R alone."""

    acceleration: float  # v²/R [m/s²]
    outwards: list[float]  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnAxis:
    """An axis in some corners of the machine: the nominal one, and those that are ever worst."""

    delay: float  # of slow motion, wait included, filter apart [s]
    reverses: float  # by which it reverses later than it is told, by wait and filter [s]
    real: list[list[float]]  # of the response without filter and delay, by corner
    imaginary: list[list[float]]
    turned: list[list[list[float]]]
    """Position after a step of velocity of 1 m/s, by its start and by corner [s]."""
    lag: list[float]  # of slow motion, filter included, by corner of ``turned`` [s]
    reversals: list[ReversalEntry]  # by rising v²/R; empty without friction


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """Both axes of the plane."""

    omega: list[float]  # of the responses [rad/s]
    step: float  # of ``turned`` [s]
    starts: list[float]  # of its steps, within the first position cycle [s]
    since: list[float]  # a reversal [s]
    entry: float  # deviation per acceleration where a circle is entered from its tangent [s²]
    largest_step: float | None  # of the velocity of an axis, by its force [m/s]; None: any
    allowed: float  # what circles and corners may use of the tolerance [m]
    arc_acceleration: float  # on an arc that the control puts into a corner [m/s²]; 0: none is
    axes: list[DrawnAxis]


def drawn_part(group: Group, contours: Contours) -> Drawn:
    """Return what circles and corners of a group are drawn from."""
    turned, on_circles = turnings(group), _worst_on_circles(group)
    axes = []
    for k, (axis, response) in enumerate(zip(group.drawn, group.plane.responses, strict=True)):
        answers = np.round(response.leading[on_circles[k]], DECIMALS)
        axes.append(
            DrawnAxis(
                delay=response.delay + response.wait,
                reverses=response.wait + filter_lag(group.setpoint_filter),
                real=answers.real.tolist(),
                imaginary=answers.imag.tolist(),
                turned=np.round(turned[k].tool, DECIMALS).tolist(),
                lag=turned[k].lag.tolist(),
                reversals=_reversals(group, contours, axis),
            )
        )
    on_arc = group.rule.share * group.acceleration
    return Drawn(
        omega=group.plane.responses[0].omega.tolist(),
        step=turned[0].step,
        starts=list(turned[0].starts),
        since=SINCE.tolist(),
        allowed=group.allowed,
        entry=group.entry,
        largest_step=finite_or_none(min(axis.largest_step for axis in turned)),
        arc_acceleration=on_arc if group.rule.kind is Corner.ARC else 0.0,
        axes=axes,
    )


def _reversals(group: Group, contours: Contours, axis: GroupAxis) -> list[ReversalEntry]:
    """Those of the circle test, and two more up to the acceleration of the path."""
    drive, loop = axis.alone.machine.drive, axis.alone.tuned.loops[0]
    if not drive.has_friction:
        return []
    found = {one.feed**2 / one.radius: one.thrown_off[axis.name] for one in contours.circles}
    last = max(found)
    for a in (sqrt(last * group.acceleration), group.acceleration):
        if a > last:
            feed = a * PAUSE / pi
            found[a] = reversal_course(
                loop, drive, item=group.setpoint_filter, radius=feed**2 / a, feed=feed
            )
    t = loop.controller.velocity_cycle * np.arange(max(map(len, found.values())))
    return [
        ReversalEntry(
            acceleration=a,
            outwards=rounded(np.interp(SINCE, t[: len(off)], off), DIGITS).tolist(),
        )
        for a, off in sorted(found.items())
    ]


def _worst_on_circles(group: Group) -> tuple[list[int], list[int]]:
    """Corners of the first and of the second axis, the nominal one first."""
    first, second = group.plane.responses
    _, worst = worst_deviation(group.plane.responses, first.omega, group.setpoint_filter)
    pairs = {divmod(int(one), len(second.leading)) for one in worst}
    return sorted({0, *(i for i, _ in pairs)}), sorted({0, *(k for _, k in pairs)})


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


def trace_circle(part: Drawn, item: SetpointFilter | None, *, radius: float, feed: float) -> Trace:
    """Return how the nominal machine draws a circle, counterclockwise, its reversals included."""
    omega, since = feed / radius, np.array(part.since)
    reversals = [
        i * pi + quarter + omega * axis.reverses
        for axis, quarter in zip(part.axes, (0.0, 0.5 * pi), strict=True)
        for i in (0, 1)
    ]
    every = [np.arange(PLACES) * 2.0 * pi / PLACES, *(at + omega * since for at in reversals)]
    phase = np.unique(np.concatenate(every) % (2.0 * pi))
    path = [
        _follow(part, axis, item, phase - quarter, radius, feed)
        for axis, quarter in zip(part.axes, (0.0, 0.5 * pi), strict=True)
    ]
    return Trace(angle=np.arctan2(path[1], path[0]), deviation=np.hypot(*path) - radius)


def _follow(
    part: Drawn,
    axis: DrawnAxis,
    item: SetpointFilter | None,
    phase: Array,
    radius: float,
    feed: float,
) -> Array:
    """Position of an axis whose setpoint is radius times the cosine of the phase."""
    omega = feed / radius
    own = ToolResponse(
        omega=np.array(part.omega),
        leading=np.array(axis.real[:1]) + 1j * np.array(axis.imaginary[:1]),
        delay=axis.delay,
    )
    answer = own.at(np.array([omega]), item)[0, 0]
    position = radius * (answer * np.exp(1j * phase)).real
    if not axis.reversals:
        return np.asarray(position)
    # From one reversal to the next; friction throws the tool off to the side it comes from.
    halves, since = np.divmod(phase - omega * axis.reverses, pi)
    off = np.interp(since / omega, part.since, throw_off(axis, feed**2 / radius))
    return np.asarray(position + np.where(halves % 2 == 0, off, -off))


def throw_off(axis: DrawnAxis, acceleration: float) -> Array:
    """Return how far friction throws an axis off behind a reversal at some v²/R [m].

    Between two that were computed by the logarithm of v²/R; beyond them as at the last.
    """
    known = np.log([one.acceleration for one in axis.reversals])
    each = np.array([one.outwards for one in axis.reversals])
    x = np.log(acceleration)
    return np.array([np.interp(x, known, column) for column in each.T])
