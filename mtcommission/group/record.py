"""``group.json``: built from a group, and read back; every number is SI."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf, isfinite
from pathlib import Path

from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import SHAPERS
from mtcommission.group.contours import CornerSpeed, Pair, PathLimits, tell_corner
from mtcommission.group.follow import Circles, follow
from mtcommission.group.group import BY_CONTOUR, Group, GroupAxis
from mtcommission.group.judged import (
    Circle,
    FeedOverRadius,
    GroupCheck,
    circle_test,
    corner_speeds,
    feeds_over_radius,
    judge_group,
)
from mtcommission.group.task import Task
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.limits import (
    RecommendedEntry,
    TodayEntry,
    recommended_entry,
    today_entry,
)
from mtcommission.record.loop import LoopPart, loop_part
from mtcommission.record.machine import (
    Datum,
    MachineEntry,
    PlantEntry,
    Profile,
    list_assumptions,
    list_data,
)
from mtcommission.record.moves import AssessmentPart
from mtcommission.record.read_back import close_as_held, read_held
from mtcommission.record.record import Tool, load_sealed, this_tool
from mtcommission.record.shape import Words, entry_of, find_checksum, finite_or_none, to_plain
from mtcommission.study.attainable import ModeLimits
from mtcommission.study.loops import disturb

SCHEMA = 4

APART = 1e-6
"""Difference of delays that is named [s]: 0.1 µm at 6 m/min."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisLimits:
    """The limits of an axis in the group."""

    recommended: RecommendedEntry
    today: TodayEntry | None  # what the control holds now; None: not stated

    @property
    def modes(self) -> list[ModeLimits]:
        """Limits by machining mode: a group has none."""
        return []


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisEntry:
    """An axis of a group: from ``profile`` on, all that a second program needs."""

    name: str
    machine: MachineEntry
    profile: Profile
    data: list[Datum]
    plant: PlantEntry
    limits: AxisLimits
    loop: LoopPart
    assessment: AssessmentPart  # of its own moves
    settling_time: float | None  # with the limits of the path, too, wait apart; None: it does not
    wait: float  # by which its setpoint is held back [s]
    peak_bound: float  # no reversal throws the tool off further [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class PathEntry:
    """Limits that the control is told for the path, as typed; None: none, those of the axes hold.

    Of a control that keeps those of the axes, too, they bound only what lies below these.
    """

    acceleration: float | None
    jerk: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedforwardTogether:
    """What an axis' feed-forward is told."""

    delay: float  # from setpoint to tool, wait included, filter apart [s]
    mass: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleEntry:
    """How the control slows down at corners, and what it is told for that."""

    kind: str
    name: str  # of its parameter, "(?)" where that was not read; "": it has none
    value: float  # of that [SI]; 0: none keeps the tolerance
    is_verified: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupAssessment:
    """The verdict."""

    met: bool
    checks: list[GroupCheck]


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupRecord:
    """Axes that move together, as ``group.json`` holds them."""

    schema: int
    checksum: str  # SHA-256 of all the rest
    tool: Tool
    created: str
    axes: list[AxisEntry]
    plane: list[str]
    filter: SetpointFilter | None
    delay: float  # of every axis, from setpoint to tool, filter apart [s]
    feedforward: dict[str, FeedforwardTogether]
    path: PathEntry
    circle: list[Circle]
    feed_over_radius: list[FeedOverRadius]
    speed_over_angle: list[CornerSpeed]
    corner_rule: RuleEntry
    filter_reason: Words  # why that filter
    tolerance: float
    allowed: float  # of that for circles and corners
    feed: float
    assessment: GroupAssessment
    assumptions: list[Words]
    warnings: list[Words]

    @property
    def circles(self) -> Circles:
        """Radius and feed of those of the circle test."""
        return tuple((one.radius, one.feed) for one in self.circle)

    def axis(self, name: str) -> AxisEntry:
        """Return the axis of a name."""
        return next(axis for axis in self.axes if axis.name == name)

    @property
    def drawn(self) -> tuple[AxisEntry, AxisEntry]:
        """The two axes of the plane."""
        first, second = map(self.axis, self.plane)
        return first, second

    @property
    def limits(self) -> PathLimits:
        """What the control keeps along the path."""
        best = [axis.limits.recommended for axis in self.drawn]
        return PathLimits(
            acceleration=self.path.acceleration or inf,
            jerk=self.path.jerk or inf,
            accelerations=(best[0].acceleration, best[1].acceleration),
            jerks=(best[0].jerk, best[1].jerk),
        )


def build_group_record(group: Group, *, created: str) -> GroupRecord:
    """Return the record of axes that move together; ``created``: ISO 8601."""
    task, path, control = group.task, group.path, group.control
    circles, corners = circle_test(group), corner_speeds(group)
    checks, delays = judge_group(group, circles), _delays(group)
    told = tell_corner(
        control.corner,
        corners,
        tolerance=task.tolerance,
        accelerations=path.accelerations,
    )
    record = GroupRecord(
        schema=SCHEMA,
        checksum="",
        tool=this_tool(),
        created=created,
        axes=[
            _axis_entry(axis, entry_of(Profile, source))
            for axis, source in zip(group.axes, task.sources, strict=True)
        ],
        plane=[axis.name for axis in group.drawn],
        filter=group.setpoint_filter,
        delay=max(delays.values()),
        feedforward={
            axis.name: FeedforwardTogether(
                delay=delays[axis.name], mass=axis.found.tuned.controller.feedforward_mass
            )
            for axis in group.axes
        },
        path=entry_of(PathEntry, path),
        circle=circles,
        feed_over_radius=feeds_over_radius(group, circles),
        speed_over_angle=list(corners),
        corner_rule=entry_of(RuleEntry, control.corner, name=control.corner_name, value=told),
        filter_reason=group.filter_reason,
        tolerance=task.tolerance,
        allowed=group.allowed,
        feed=task.feed,
        assessment=GroupAssessment(met=all(check.met for check in checks), checks=checks),
        assumptions=_assumptions(group),
        warnings=list(_warn(group, checks)),
    )
    return replace(record, checksum=find_checksum(to_plain(record)))


def _delays(group: Group) -> dict[str, float]:
    # What is below a tenth of a nanosecond is rounding.
    return {axis.name: round(axis.follower.delay, 10) + 0.0 for axis in group.axes}


def _axis_entry(axis: GroupAxis, profile: Profile) -> AxisEntry:
    found, machine = axis.found, axis.machine
    return AxisEntry(
        name=axis.name,
        machine=entry_of(MachineEntry, machine),
        profile=profile,
        data=list_data(machine, found.plant, profile.text),
        plant=entry_of(PlantEntry, found.plant),
        limits=AxisLimits(
            recommended=recommended_entry(RecommendedEntry, machine, axis.choice),
            today=today_entry(machine, found.today) if found.today else None,
        ),
        loop=loop_part(machine, found.plant, found.loop, disturb(found.loop)),
        assessment=entry_of(AssessmentPart, axis.choice.candidate.assessment),
        settling_time=finite_or_none(axis.in_effect.settling_time),
        wait=axis.follower.wait,
        peak_bound=axis.follower.peak_bound(),
    )


def _assumptions(group: Group) -> list[Words]:
    """What the computation assumes of any of the axes, each once."""
    found = [item for axis in group.axes for item in list_assumptions(axis.machine)]
    cycle = group.axes[0].follower.poles.dt
    if any(abs((axis.follower.wait / cycle + 0.5) % 1.0 - 0.5) > 1e-6 for axis in group.axes):
        found.append(Message("group-wait-in-parts"))
    if any(axis.slowed for axis in group.axes):
        found.append(Message("group-path-slows"))
    drives = [axis.machine.drive for axis in group.axes]
    if any(drive.has_friction for drive in drives):
        is_viscous = any(drive.viscous_friction for drive in drives)
        found.append(Message("group-path-friction", viscous="yes" if is_viscous else "no"))
    return list(dict.fromkeys(found))


def _warn(group: Group, checks: list[GroupCheck]) -> Iterator[Words]:
    """What the verdict does not show, and what to do where it is not met."""
    delays, control = _delays(group), group.control
    apart = max(delays.values()) - min(delays.values())
    yield from _other_contours(group.task)
    if group.task.radius is not None:
        yield Message("group-one-circle", radius=group.task.radius)
    if len(group.axes) > len(group.drawn):
        first, second = (axis.name for axis in group.drawn)
        yield Message("group-one-plane", first=first, second=second)
    if apart > APART:
        slowest = max(delays, key=lambda name: delays[name])
        yield Message("group-delays-apart", apart=apart, feed=group.task.feed, slowest=slowest)
    drives = [axis.machine.drive for axis in group.drawn]
    if not any(drive.has_friction or drive.follows for drive in drives):
        yield Message("group-no-friction")
    if not control.corner.is_verified:
        yield Message("group-rule-not-verified")
    circle, line, *_ = checks
    if not (circle.met and line.met):
        yield Message("group-contour-not-kept")
    if any(axis.choice.why == BY_CONTOUR for axis in group.axes):
        yield Message("group-path-without-place")
    item = group.setpoint_filter
    if item is not None and item.kind in SHAPERS:
        yield Message("group-one-shaper")


def _other_contours(task: Task) -> Iterator[Message]:
    """What axes keep along their own moves where it is not what contours are judged by."""
    others = tuple(
        Message(
            "group-contour-of",
            name=machine.axis,
            tolerance=machine.requirements.contour_deviation,
        )
        for machine in task.machines
        if isfinite(machine.requirements.contour_deviation)
        and machine.requirements.contour_deviation != task.tolerance
    )
    if others:
        yield Message("group-other-contours", tolerance=task.tolerance, of=others)


def read_pair(record: GroupRecord) -> Pair:
    """Return how the two axes that draw circles follow contours, as the record was made."""
    first, second = (
        follow(machine, close_as_held(machine), record.filter, axis.wait)
        for axis, machine in ((one, read_held(one)) for one in record.drawn)
    )
    return first, second


def load_group(path: Path) -> GroupRecord:
    """Return what a ``group.json`` holds.

    Raises
    ------
    InputError
        If the file is none of this schema, or not as it was written; says what is wrong.
    """
    return load_sealed(path, GroupRecord, schema=SCHEMA)
