"""``group.json``: built from a group, and read back; every number is SI."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from pathlib import Path

from mtcommission.control_kinds.kind import SHAPERS
from mtcommission.group.contours import Circle, follow_contours
from mtcommission.group.corner import CornerSpeed
from mtcommission.group.drawn import Drawn, drawn_part
from mtcommission.group.group import Group, GroupAxis
from mtcommission.group.rules import value_of
from mtcommission.group.verdict import GroupCheck, judge_group
from mtcommission.limits.judge import describe_place
from mtcommission.messages.message import Message
from mtcommission.record.files import LARGEST_FILE, fault, find_checksum, load_json
from mtcommission.record.limits import (
    ModeLimitsEntry,
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
from mtcommission.record.record import Tool, this_tool
from mtcommission.record.shape import WRONG, entry_of, find_faults, of, to_entry, to_plain
from mtcommission.record.values import SetpointFilterEntry, Words

SCHEMA = 1

NOT_OF_A_GROUP = ("assumption-exact-rest", "assumption-calculated")
"""Assumptions about optima, which a group has none of, and what every page says."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisLimits:
    """The limits of an axis in the group."""

    recommended: RecommendedEntry
    today: TodayEntry | None  # what the control holds now; None: not stated

    @property
    def modes(self) -> list[ModeLimitsEntry]:
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
    wait: float  # by which its setpoint is held back [s]
    peak_bound: float = of("peak_bound")  # no reversal throws the tool off further [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class PathEntry:
    """Limits along the path."""

    acceleration: float
    jerk: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedforwardTogether:
    """What an axis' feed-forward is told."""

    delay: float  # from setpoint to tool, wait included, filter apart [s]
    mass: float


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleEntry:
    """A circle, worst over every corner of both axes."""

    radius: float
    feed: float
    radius_deviation: float
    form_deviation: float
    quadrant_peak: dict[str, float]
    corner: dict[str, Message]  # by axis


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedEntry:
    """The largest feed of circles of some radius, and what forbids more."""

    radius: float
    feed: float
    bound_by: Message
    axis: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AngleEntry:
    """How fast a corner is passed within the tolerance."""

    angle_deg: float
    speed: float
    arc_radius: float = of("arc.radius")
    deviation_without_slowing: float = of("deviation")


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleEntry:
    """How the control slows down at corners, and what it is told for that."""

    kind: str
    name: str  # of its parameter
    value: float  # step of velocity or speed at 90 degrees [m/s], or tolerance [m]
    source: str
    is_verified: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialEntry:
    """A setpoint filter that was looked at."""

    filter: SetpointFilterEntry | None = of("setpoint_filter")
    settling_time: float | None
    axes_acceleration: float
    path_acceleration: float = of("acceleration")


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckEntry:
    """One requirement of the group."""

    name: str
    label: Message
    value: float | None
    limit: float
    reserve: float
    unit: str
    met: bool
    where: Message


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupAssessment:
    """The verdict."""

    met: bool
    checks: list[CheckEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupRecord:
    """Axes that move together, as ``group.json`` holds them."""

    schema: int
    checksum: str  # SHA-256 of all the rest
    tool: Tool
    created: str
    axes: list[AxisEntry]
    plane: list[str]
    filter: SetpointFilterEntry | None
    delay: float  # of every axis, from setpoint to tool, filter apart [s]
    feedforward: dict[str, FeedforwardTogether]
    path: PathEntry
    circle: list[CircleEntry]
    feed_over_radius: list[FeedEntry]
    speed_over_angle: list[AngleEntry]
    corner_rule: RuleEntry
    filters: list[TrialEntry]  # that were compared, the one in use first
    tolerance: float
    feed: float
    assessment: GroupAssessment
    assumptions: list[Words]
    warnings: list[Words]
    drawn: Drawn

    def axis(self, name: str) -> AxisEntry:
        """Return the axis of a name."""
        return next(axis for axis in self.axes if axis.name == name)


def build_group_record(group: Group, *, created: str) -> GroupRecord:
    """Return the record of axes that move together; ``created``: ISO 8601."""
    task = group.task
    contours = follow_contours(group)
    checks = judge_group(group, contours)
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
        filter=entry_of(SetpointFilterEntry, group.setpoint_filter)
        if group.setpoint_filter
        else None,
        delay=max(axis.delay for axis in group.axes),
        feedforward={
            axis.name: FeedforwardTogether(
                delay=axis.delay, mass=axis.alone.tuned.controller.feedforward_mass
            )
            for axis in group.axes
        },
        path=PathEntry(acceleration=group.acceleration, jerk=group.jerk),
        circle=[_circle_entry(group, circle) for circle in contours.circles],
        feed_over_radius=[entry_of(FeedEntry, one) for one in contours.feeds],
        speed_over_angle=[_angle_entry(one) for one in contours.corners],
        corner_rule=entry_of(
            RuleEntry,
            group.rule,
            kind=group.rule.kind.value,
            value=value_of(group.rule, contours.corners),
        ),
        filters=[entry_of(TrialEntry, trial) for trial in group.trials],
        tolerance=task.tolerance,
        feed=task.feed,
        assessment=GroupAssessment(
            met=all(check.is_met for check in checks), checks=[_check_entry(one) for one in checks]
        ),
        assumptions=_assumptions(group),
        warnings=_warnings(group, circle_kept=checks[0].is_met),
        drawn=drawn_part(group, contours),
    )
    return replace(record, checksum=find_checksum(to_plain(record)))


def _axis_entry(axis: GroupAxis, profile: Profile) -> AxisEntry:
    found, machine = axis.alone.found, axis.alone.machine
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
        loop=loop_part(machine, found.plant, found.loop, found.tuned, {}),
        assessment=entry_of(AssessmentPart, axis.choice.candidate.assessment),
        wait=axis.wait * axis.alone.poles.dt,
        peak_bound=axis.peak_bound,
    )


def _circle_entry(group: Group, circle: Circle) -> CircleEntry:
    corners = zip(group.drawn, circle.corner, strict=True)
    return entry_of(
        CircleEntry,
        circle,
        corner={axis.name: describe_place(1, corner, 1) for axis, corner in corners},
    )


def _angle_entry(found: CornerSpeed) -> AngleEntry:
    return entry_of(AngleEntry, found, angle_deg=found.angle * 180.0 / pi)


def _check_entry(check: GroupCheck) -> CheckEntry:
    return entry_of(CheckEntry, check)


def _assumptions(group: Group) -> list[Words]:
    """What the computation assumes of any of the axes, each once."""
    found = [item for axis in group.axes for item in list_assumptions(axis.alone.machine)]
    return [
        item
        for i, item in enumerate(found)
        if item not in found[:i] and item.kind not in NOT_OF_A_GROUP
    ]


def _warnings(group: Group, *, circle_kept: bool) -> list[Words]:
    """What the verdict does not show."""
    found = list[Words]()
    delays = [axis.delay for axis in group.axes]
    apart = max(delays) - min(delays)
    if apart > 1e-9:
        found.append(Message("group-delays-apart", apart=apart, feed=group.task.feed))
    drives = [axis.alone.machine.drive for axis in group.drawn]
    if not any(drive.has_friction or drive.follows for drive in drives):
        found.append(Message("group-no-friction"))
    if not group.rule.is_verified:
        found.append(Message("group-rule-not-verified"))
    if not circle_kept:
        found.append(Message("group-circles-not-kept"))
    item = group.setpoint_filter
    if item is not None and item.kind in SHAPERS:
        found.append(Message("group-one-shaper"))
    return found


def load_group(path: Path) -> GroupRecord:
    """Return what a ``group.json`` holds.

    Raises
    ------
    InputError
        If the file is none of this schema, or not as it was written; says what is wrong.
    """
    data = load_json(path, most=LARGEST_FILE)
    if not is_group(data):
        raise fault(path, Message("group-not-a-group"))
    if data["schema"] != SCHEMA:
        given = repr(data["schema"])
        raise fault(path, Message("record-of-other-schema", given=given, read=SCHEMA), "schema")
    if data.get("checksum") != find_checksum(data):
        raise fault(path, Message("record-edited"), "checksum")
    try:
        return to_entry(data, GroupRecord)
    except WRONG as error:
        raise fault(path, next(find_faults(error))) from error


def names_group(path: Path) -> bool:
    """Return whether a file is the record of a group."""
    return is_group(load_json(path, most=LARGEST_FILE))


def is_group(data: object) -> bool:
    """Return whether JSON is that of a group, not of one axis."""
    return isinstance(data, dict) and {"schema", "axes", "path"} <= data.keys()
