"""What circles, corners and lines do with what a group of axes is told, and the verdict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Corner
from mtcommission.group.contours import (
    CornerSpeed,
    line_deviation,
    speeds_at_once,
    speeds_on_arcs,
    turnings,
    worst_circle,
)
from mtcommission.group.follow import Circles, Follower, filter_response
from mtcommission.group.group import LEAST_RADIUS, Group, GroupAxis, circle_deviation, largest_radii
from mtcommission.limits.judge import LAST_DIGIT, describe_place
from mtcommission.limits.requirements import CONTOUR_DEVIATION, SETTLING_TIME
from mtcommission.machine.moves import largest_velocity
from mtcommission.record.moves import Check
from mtcommission.record.shape import finite_or_none

PEAK = "quadrant peak"
"""What a check of reversals is called, before its axis."""

RADII = (LEAST_RADIUS, 2e-3, 5e-3, 10e-3, 20e-3, 50e-3, 100e-3, 150e-3)
"""Of the circles over which the feed is listed [m]; the last three are a ballbar's."""

FEEDS = (1.0 / 60.0, 3.0 / 60.0, 6.0 / 60.0)
"""Feeds of the circle test [m/s]."""

TESTED_RADIUS = 50e-3
"""Of the circle test where none is asked for [m]: the shortest usual ballbar."""

GRID = np.geomspace(1e-4, 1.0, 400)
"""Feeds that are looked at, as shares of the largest that acceleration and jerk allow."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Circle:
    """A circle, worst over every corner of both axes."""

    radius: float
    feed: float
    radius_deviation: float  # of the mean radius, negative: too small
    form_deviation: float  # largest less smallest radius
    quadrant_peak: dict[str, float]
    """How far friction throws the tool off at most where an axis reverses; empty without any."""
    corner: dict[str, Message]  # by axis

    @property
    def largest(self) -> float:
        """How far the tool is off at most, friction apart [m]."""
        return abs(self.radius_deviation) + 0.5 * self.form_deviation


@dataclass(frozen=True, slots=True, kw_only=True)
class LargestFeed:
    """The largest feed of a circle, and what forbids more."""

    feed: float
    bound_by: Message
    axis: str  # "" where no single one does


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedOverRadius(LargestFeed):
    """That of circles of some radius."""

    radius: float
    without_peaks: LargestFeed | None
    """What would hold without peaks at reversal; None where these do not bind."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupCheck(Check):
    """One requirement of a group against the worst that was found."""

    label: Message


def circle_test(group: Group) -> list[Circle]:
    """Return the circles of a circle test, slowest first."""
    radius = group.task.radius or TESTED_RADIUS
    return draw_circles(group, tuple((radius, feed) for feed in sorted({*FEEDS, group.task.feed})))


def draw_circles(group: Group, circles: Circles) -> list[Circle]:
    """Return how circles come out, in the worst corners."""
    off, worst = worst_circle(group.pair, np.array([feed / radius for radius, feed in circles]))
    first, second = group.drawn
    peaks = {
        axis.name: np.abs(axis.follower.reversals(circles)).max(axis=(1, 2))
        for axis in group.drawn
        if axis.machine.drive.has_friction
    }
    return [
        Circle(
            radius=radius,
            feed=feed,
            radius_deviation=radius * float(off.radius[k]),
            form_deviation=radius * float(off.form[k]),
            quadrant_peak={name: float(peak[k]) for name, peak in peaks.items()},
            corner={
                axis.name: describe_place(1, axis.follower.tuned.corners[place], 1)
                for axis, place in zip(
                    (first, second),
                    divmod(int(worst[k]), len(second.follower.tuned.corners)),
                    strict=True,
                )
            },
        )
        for k, (radius, feed) in enumerate(circles)
    ]


def feeds_over_radius(group: Group, circles: Sequence[Circle]) -> list[FeedOverRadius]:
    """Return the largest feed of circles over their radius; ``circles``: of the circle test."""
    radii = {*RADII, group.task.radius or TESTED_RADIUS}
    peaks = {axis.name: _without_peak(group, axis.follower, circles) for axis in group.drawn}
    found = []
    for radius in sorted(radii):
        best = _largest_feed(group, radius, peaks)
        binds = best.bound_by == Message("group-bound-friction")
        found.append(
            FeedOverRadius(
                radius=radius,
                feed=best.feed,
                bound_by=best.bound_by,
                axis=best.axis,
                without_peaks=_largest_feed(group, radius, {}) if binds else None,
            )
        )
    return found


def _without_peak(group: Group, axis: Follower, circles: Sequence[Circle]) -> float:
    """The acceleration of circles up to which reversals of an axis keep the tolerance [m/s²].

    0 where those of the slowest circle do not, inf where all do.
    """
    drawn = tuple((one.radius, one.feed) for one in circles)
    reversals = axis.thrown(drawn, group.path.on_circles[0])
    peaks = [float(np.abs(off).max()) for off in reversals.values()]
    too_large = [k for k, peak in enumerate(peaks) if peak > group.task.tolerance]
    if not too_large:
        return inf
    if (k := too_large[0]) == 0:
        return 0.0
    between = np.log(list(reversals)[k - 1 : k + 1])
    return float(np.exp(np.interp(group.task.tolerance, peaks[k - 1 : k + 1], between)))


def _largest_feed(group: Group, radius: float, peaks: Mapping[str, float]) -> LargestFeed:
    """The largest feed of circles of some radius [m]; ``peaks``: what friction allows [m/s²]."""
    names = [axis.name for axis in group.drawn]
    a, j = group.path.on_circles

    def whose(kind: str, limit: float, limits: tuple[float, float]) -> tuple[str, str]:
        if limit < min(limits):
            return f"path-{kind}", ""
        return kind, names[int(np.argmin(limits))]

    ends = {
        whose("acceleration", a, group.path.accelerations): sqrt(a * radius),
        whose("jerk", j, group.path.jerks): float(np.cbrt(j * radius**2)),
        ("velocity", ""): min(
            max(map(largest_velocity, axis.machine.moves)) for axis in group.drawn
        ),
        **{("friction", name): sqrt(largest * radius) for name, largest in peaks.items()},
    }
    (kind, axis), top = min(ends.items(), key=lambda end: end[1])
    feeds, feed = top * GRID, top
    steady = entry = np.zeros(0)
    if top > 0.0:
        steady, entry = (
            radius * one for one in circle_deviation(group.pair, group.entries, feeds / radius)
        )
    off = np.maximum(steady, entry)
    too_much = np.flatnonzero(off > group.allowed)
    if len(too_much):
        k = int(too_much[0])
        kind, axis = ("entry", "")
        if steady[k] >= entry[k]:
            kind, axis = _largest_effect(group, float(feeds[k]) / radius)
        # The deviation grows with the square of the feed.
        feed = float(feeds[k - 1] * sqrt(group.allowed / off[k - 1])) if k else 0.0
    return LargestFeed(feed=feed, bound_by=Message(f"group-bound-{kind}"), axis=axis)


def _largest_effect(group: Group, omega: float) -> tuple[str, str]:
    """What throws the tool off a circle most, and of which axis; "" where of none alone."""
    names, at = [axis.name for axis in group.drawn], np.array([omega])
    behind = float(np.abs(filter_response(group.setpoint_filter, at))[0])
    delays = [axis.delay for axis in group.pair]
    loops = [float(np.abs(np.abs(axis.response(at)) / behind - 1.0).max()) for axis in group.pair]
    effects = {
        ("filter", ""): 1.0 - behind,
        ("delay", names[int(np.argmax(delays))]): 0.5 * float(np.ptp(delays)) * omega,
        ("loop", names[int(np.argmax(loops))]): max(loops),
    }
    return max(effects, key=lambda effect: effects[effect])


def corner_speeds(group: Group) -> tuple[CornerSpeed, ...]:
    """Return how fast corners are passed within the tolerance, by the rule of the control."""
    axes, rule = turnings(group.pair), group.control.corner
    tolerance, feed = group.allowed, group.task.feed
    if rule.kind is Corner.ARC:
        acceleration = rule.share * group.path.on_circles[0]
        return speeds_on_arcs(axes, tolerance=tolerance, feed=feed, acceleration=acceleration)
    return speeds_at_once(axes, tolerance=tolerance, feed=feed)


# The verdict


def judge_group(group: Group, circles: list[Circle]) -> list[GroupCheck]:
    """Return every requirement of a group: contour first, then each axis' own."""
    checks = [_judge_circles(group), _judge_lines(group), *_judge_reversals(group, circles)]
    return checks + [check for axis in group.axes for check in _own(axis)]


def _check(
    name: str,
    label: Message,
    value: float,
    limit: float,
    reserve: float,
    where: Message,
    unit: str = "m",
) -> GroupCheck:
    return GroupCheck(
        name=name,
        label=label,
        value=finite_or_none(value),
        limit=limit,
        reserve=reserve,
        unit=unit,
        met=value <= limit * (1.0 + LAST_DIGIT),
        where=where,
    )


def _judge_circles(group: Group) -> GroupCheck:
    """Every circle that path limits and feed permit; with a radius asked for, that at the feed."""
    task, (a, _) = group.task, group.path.on_circles
    if task.radius is not None:
        omega, radii = np.array([task.feed / task.radius]), np.array([task.radius])
    else:
        omega = group.pair[0].omega
        radii = largest_radii(omega, feed=task.feed, acceleration=a)
    off = np.maximum(*circle_deviation(group.pair, group.entries, omega)) * radii
    worst = int(off.argmax())
    radius = float(radii[worst])
    where = Message("group-where-circle", radius=radius, feed=radius * float(omega[worst]))
    return _of_contour(group, "circle", float(off[worst]), where)


def _judge_lines(group: Group) -> GroupCheck:
    """Lines in every direction, with what the control keeps along them, up to the feed."""
    feed = group.task.feed
    off, slope = line_deviation(group.pair, feed=feed, limits=group.path)
    where = Message("group-where-line", feed=feed, slope=float(np.degrees(slope)))
    return _of_contour(group, "line", off, where)


def _of_contour(group: Group, name: str, off: float, where: Message) -> GroupCheck:
    label = Message(f"group-check-{name}")
    value = off + group.encoder_noise
    return _check(name, label, value, group.task.tolerance, group.reserve, where)


def _judge_reversals(group: Group, circles: list[Circle]) -> Iterator[GroupCheck]:
    """Peaks where an axis reverses at the feed, where friction is stated."""
    fastest = next(one for one in circles if one.feed == group.task.feed)
    where = Message("group-where-circle", radius=fastest.radius, feed=fastest.feed)
    for axis, peak in fastest.quadrant_peak.items():
        label = Message("group-check-peak", name=axis)
        yield _check(f"{PEAK} {axis}", label, peak, group.task.tolerance, 1.0, where)


def _own(axis: GroupAxis) -> Iterator[GroupCheck]:
    """The axis' own requirements, with the group's filter, and its wait where time counts.

    Where the path's limits make its moves slower, the worse of these and of its own limits.
    """
    found = axis.choice.candidate.assessment.checks
    if axis.slowed:
        pairs = zip(found, axis.slowed.assessment.checks, strict=True)
        found = tuple(max(pair, key=lambda check: check.value) for pair in pairs)
    for check in found:
        late = axis.follower.wait if check.requirement is SETTLING_TIME else 0.0
        yield _check(
            f"{check.name} {axis.name}",
            Message("group-check-along", name=axis.name)
            if check.requirement is CONTOUR_DEVIATION
            else Message("group-check-of", name=axis.name, requirement=check.requirement.message),
            check.value + late,
            check.limit,
            check.reserve,
            check.where,
            check.unit,
        )
