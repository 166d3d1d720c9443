"""What circles and corners do with what a group of axes is told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.circle import filter_response, reversal_course
from mtcommission.group.corner import CornerSpeed, Turning, speeds_at_once, speeds_on_arcs, turn
from mtcommission.group.group import Group, worst_deviation
from mtcommission.group.rules import Corner
from mtcommission.machine.moves import largest_velocity
from mtcommission.machine.variations import Corner as MachineCorner
from mtcommission.messages.message import Message

Array = NDArray[np.float64]

RADII = (1e-3, 2e-3, 5e-3, 10e-3, 20e-3, 50e-3, 100e-3, 150e-3)
"""Of the circles over which the feed is listed [m]; the last three are a ballbar's."""

FEEDS = (1.0 / 60.0, 3.0 / 60.0, 6.0 / 60.0)
"""Feeds of the circle test [m/s]."""

TESTED_RADIUS = 50e-3
"""Of the circle test where none is asked for [m]: the shortest usual ballbar."""

GRID = np.geomspace(1e-4, 1.0, 400)
"""Feeds that are looked at, as shares of the largest that acceleration and jerk allow."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Circle:
    """A circle, worst over every corner of both axes."""

    radius: float  # [m]
    feed: float  # [m/s]
    radius_deviation: float  # of the mean radius, negative: too small [m]
    form_deviation: float  # largest less smallest radius [m]
    thrown_off: dict[str, Array]  # by axis, behind its reversal [m]; empty without friction
    corner: tuple[MachineCorner, MachineCorner]

    @property
    def quadrant_peak(self) -> dict[str, float]:
        """How far friction throws the tool off at most where an axis reverses, by axis [m]."""
        return {name: float(np.abs(off).max()) for name, off in self.thrown_off.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedOverRadius:
    """The largest feed of circles of some radius, and what forbids more."""

    radius: float  # [m]
    feed: float  # [m/s]
    bound_by: Message
    axis: str  # "" where no single one does


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contours:
    """Circles and corners of a group."""

    circles: tuple[Circle, ...]
    feeds: tuple[FeedOverRadius, ...]
    corners: tuple[CornerSpeed, ...]


def follow_contours(group: Group) -> Contours:
    """Return what circles and corners do: the circle test's, and the feed over radius and angle."""
    radius = group.task.radius or TESTED_RADIUS
    feeds = sorted({*FEEDS, group.task.feed})
    return Contours(
        circles=tuple(draw_circle(group, radius, feed) for feed in feeds),
        feeds=tuple(largest_feed(group, one) for one in sorted({*RADII, radius})),
        corners=tuple(_corner_speeds(group)),
    )


def draw_circle(group: Group, radius: float, feed: float) -> Circle:
    """Return how a circle of some radius [m] at a feed [m/s] comes out, in the worst corners."""
    item = group.setpoint_filter
    off, worst = worst_deviation(group.plane.responses, np.array([feed / radius]), item)
    first, second = group.drawn
    i, k = divmod(int(worst[0]), len(second.alone.tuned.corners))
    thrown_off = {
        axis.name: reversal_course(
            axis.alone.tuned.loops[0],
            axis.alone.machine.drive,
            item=item,
            radius=radius,
            feed=feed,
        )
        for axis in group.drawn
        if axis.alone.machine.drive.has_friction
    }
    return Circle(
        radius=radius,
        feed=feed,
        radius_deviation=radius * float(off.radius[0]),
        form_deviation=radius * float(off.form[0]),
        thrown_off=thrown_off,
        corner=(first.alone.tuned.corners[i], second.alone.tuned.corners[k]),
    )


def largest_feed(group: Group, radius: float) -> FeedOverRadius:
    """Return the largest feed of circles of some radius [m], and what forbids more."""
    limits = {axis.name: axis.choice.limits for axis in group.drawn}
    slow = min(limits, key=lambda name: limits[name].acceleration)
    gentle = min(limits, key=lambda name: limits[name].jerk)
    moves = [max(map(largest_velocity, axis.alone.machine.moves)) for axis in group.drawn]
    ends = {
        ("acceleration", slow): sqrt(limits[slow].acceleration * radius),
        ("jerk", gentle): float(np.cbrt(limits[gentle].jerk * radius**2)),
        ("velocity", ""): min(moves),
    }
    (kind, axis), top = min(ends.items(), key=lambda end: end[1])
    feeds = top * GRID
    steady = (
        radius
        * worst_deviation(group.plane.responses, feeds / radius, group.setpoint_filter)[0].largest
    )
    off = np.maximum(steady, group.entry * feeds**2 / radius)
    too_much, feed = np.flatnonzero(off > group.allowed), top
    if len(too_much):
        k = int(too_much[0])
        kind, axis = _largest_effect(group, radius, float(feeds[k]), bool(steady[k] < off[k]))
        # The deviation grows with the square of the feed.
        feed = float(feeds[k - 1] * sqrt(group.allowed / off[k - 1])) if k else 0.0
    return FeedOverRadius(
        radius=radius, feed=feed, bound_by=Message(f"group-bound-{kind}"), axis=axis
    )


def _largest_effect(group: Group, radius: float, feed: float, is_entry: bool) -> tuple[str, str]:
    """What throws the tool off a circle most, and of which axis; "" where of none alone."""
    names = [axis.name for axis in group.drawn]
    if is_entry:
        return "entry", names[int(np.argmax([axis.entry() for axis in group.answers]))]
    omega, responses = np.array([feed / radius]), group.plane.responses
    behind = float(np.abs(filter_response(group.setpoint_filter, omega))[0])
    delays = [one.delay + one.wait for one in responses]
    loops = [float(np.abs(np.abs(one.at(omega, None)) - 1.0).max()) for one in responses]
    effects = {
        ("filter", ""): 1.0 - behind,
        ("delay", names[int(np.argmax(delays))]): 0.5 * float(np.ptp(delays) * omega[0]),
        ("loop", names[int(np.argmax(loops))]): max(loops),
    }
    return max(effects, key=lambda effect: effects[effect])


def _corner_speeds(group: Group) -> Iterator[CornerSpeed]:
    axes = turnings(group)
    tolerance, feed = group.allowed, group.task.feed
    if group.rule.kind is Corner.ARC:
        acceleration = group.rule.share * group.acceleration
        return speeds_on_arcs(axes, tolerance=tolerance, feed=feed, acceleration=acceleration)
    return speeds_at_once(axes, tolerance=tolerance, feed=feed)


def turnings(group: Group) -> tuple[Turning, Turning]:
    """Return how the two axes of the plane answer a step of velocity."""
    first, second = (
        turn(answers, axis.alone.machine.drive.motion_force)
        for answers, axis in zip(group.answers, group.drawn, strict=True)
    )
    return first, second
