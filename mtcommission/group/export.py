"""Record of a group -> one text for a control: every axis and the path, read back and simulated.

Rows of an axis are those of its own export, with the group's filter and limits. Where names tell
the axis, all stand together as the control has them; else there is a part of the text for each.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from math import inf, isclose

import numpy as np

from mtcommission.control_kinds.control import Control
from mtcommission.control_kinds.kinds import CONTROLS, GENERIC
from mtcommission.control_kinds.row import Key, Row, Setting, Values
from mtcommission.control_kinds.syntax import LIST, Entry, Layout
from mtcommission.control_kinds.wording import show_value, to_ascii
from mtcommission.errors import Fault, InputError
from mtcommission.export.catalogue import find_control_key, name_control
from mtcommission.export.header import (
    Judged,
    lost_letters,
    say_axis,
    say_doubts,
    say_notes,
    say_source,
)
from mtcommission.export.held import read_limits
from mtcommission.export.subject import Subject, build_subject
from mtcommission.export.write import (
    fill_in,
    judge_text,
    read_text,
    words_for,
    write_body,
    write_head,
)
from mtcommission.group.held import find_circle, hold_axis
from mtcommission.group.record import CircleEntry, GroupRecord
from mtcommission.group.rules import Corner, rule_of
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message

SLOW = 1.0 / 60.0
"""The first feed at which the text's circle is drawn [m/s]; the other is the group's."""

SAME, SAME_SHARE = 0.1e-6, 0.01
"""By how much a circle of the text may differ from the record's [m], or as a share of it."""

UNBOUND = 1.75
"""Times the largest value of an axis, with which a limit along the path bounds no direction: more
than sqrt(3). Source: HEIDENHAIN MANUALplus 620 Technical Manual, p. 834."""

ONE_FOR_ALL = (Setting.FIXED, Setting.POSITION_CYCLE, Setting.VELOCITY_CYCLE)
"""What the control has but once, whichever axis asks for it."""

OF_ONE_AXIS = ("klipper-corner-bound",)
"""Notes on values that a group has otherwise."""

AT_CORNERS = {
    Corner.STEP: Setting.CORNER_STEP,
    Corner.JUNCTION: Setting.CORNER_SPEED,
    Corner.ARC: Setting.CORNER_TOLERANCE,
}

CORNER = {*AT_CORNERS.values(), Setting.CONTOUR_TOLERANCE}
"""Settings with one of which a control knows what corners may take."""

PLACES = {
    Setting.WAIT: {Setting.WAIT},
    Setting.PATH_ACCELERATION: {Setting.PATH_ACCELERATION, Setting.PATH_ACCELERATION_CEILING},
    Setting.PATH_JERK: {Setting.PATH_JERK, Setting.PATH_JERK_CEILING},
}
"""Settings each of which a control must have one of, to hold that value of the group."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleOfText:
    """A circle as the text draws it, worst corners, beside that of the record."""

    planned: CircleEntry
    radius_deviation: float  # [m]
    form_deviation: float  # [m]

    @property
    def is_same(self) -> bool:
        """Whether both are the record's."""
        found = (self.radius_deviation, self.form_deviation)
        planned = (self.planned.radius_deviation, self.planned.form_deviation)
        pairs = zip(found, planned, strict=True)
        return all(abs(a - b) <= max(SAME, SAME_SHARE * abs(b)) for a, b in pairs)


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupExport:
    """A group in a control's own words."""

    header: tuple[str, ...]  # sentences above the parameters
    circles: tuple[CircleOfText, ...]
    meets_requirements: bool  # each axis its own, and circles the tolerance, by what the text holds
    text: str  # the file


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Part:
    """What stands in the text for an axis, or for the path."""

    name: str  # of the axis; "" for the path
    entries: tuple[Entry, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """What the control calls it."""
        return tuple(entry.row for entry in self.entries)


def type_in_group(record: GroupRecord) -> list[Part]:
    """Return what is typed into the control that the group was computed for, the path last.

    In neutral words where it cannot name an axis.

    Raises
    ------
    InputError
        If a loop does not belong to its profile.
    """
    own = CONTROLS[record.axes[0].loop.kind]
    subjects = [build_subject(axis, own.kind) for axis in record.axes]
    try:
        return fill_in_group(record, own, subjects)
    except InputError:
        neutral = replace(CONTROLS[GENERIC.key], kind=own.kind)
        return fill_in_group(record, neutral, subjects)


def export_group(
    record: GroupRecord, *, control: str, language: str = "en", as_list: bool = False
) -> GroupExport:
    """Return axes and path of a group for a control.

    Raises
    ------
    InputError
        If there is no such control, it cannot tell these axes apart, or a loop of it is unstable.
    """
    target = CONTROLS[find_control_key(control)]
    subjects = [build_subject(axis, target.kind) for axis in record.axes]
    words, layout = words_for(subjects, language), LIST if as_list else target.layout
    parts = fill_in_group(record, target, subjects)
    if target.names_axes and not as_list:
        lines, (*own, path) = _write_together(layout, parts, words, target)
    else:
        lines, (*own, path) = _write_apart(layout, parts, words)
    judged = [
        judge_text(subject, _with_path(values, path))
        for subject, values in zip(subjects, own, strict=True)
    ]
    circles = tuple(_draw_circles(record, judged))
    said = _say(record, target, subjects, judged, parts, circles, words)
    head = write_head(layout, said, words)
    return GroupExport(
        header=head.sentences,
        circles=circles,
        meets_requirements=all(one.is_met and not one.left_out for one in judged)
        and all(
            abs(one.radius_deviation) + 0.5 * one.form_deviation <= record.tolerance
            for one in circles
        ),
        text="\n".join([*head.lines, "", *lines]) + "\n",
    )


def fill_in_group(record: GroupRecord, target: Control, subjects: Sequence[Subject]) -> list[Part]:
    """Return every axis with what is typed in for it, the path last."""
    own = [fill_in(subject, target)[0] for subject in subjects]
    told = _tell(record, target, subjects, own)
    of_path = {(row.section, row.name) for row in target.group}
    parts = []
    for axis, entries in zip(record.axes, own, strict=True):
        kept = [one for one in entries if (one.row.section, one.row.name) not in of_path]
        more = _entries(target.axis_in_group, {**told, (Setting.WAIT, ""): axis.wait})
        parts.append(Part(name=axis.name, entries=(*kept, *more)))
    return [*parts, Part(name="", entries=tuple(_entries(target.group, told)))]


def _entries(rows: Iterable[Row], values: Values) -> Iterator[Entry]:
    for row in rows:
        if row.setting is Setting.FIXED:
            yield Entry(row=row, value=row.encode("set"))
        elif row.key in values:
            yield Entry(row=row, value=row.encode(values[row.key]))


def _tell(
    record: GroupRecord,
    target: Control,
    subjects: Sequence[Subject],
    typed: Sequence[Sequence[Entry]],
) -> dict[Key, float | str]:
    """What the path is told [SI]; nothing for corners where the rule has no value."""
    limits = []
    for subject, entries in zip(subjects, typed, strict=True):
        values = {one.row.key: one.row.decode(one.value) for one in entries}
        cycle = subject.controller.position_cycle
        limits.append(read_limits({(Setting.POSITION_CYCLE, ""): cycle, **values}))
    best = [axis.limits.recommended for axis in record.axes]
    path, accelerations = record.path, [one.acceleration for one in limits]
    jerks = [one.jerk for one in limits]
    told = {
        # Where no acceleration keeps circles, a warning says so: an axis must move all the same.
        Setting.PATH_ACCELERATION: min(path.acceleration or inf, *accelerations),
        Setting.PATH_JERK: min(path.jerk, *jerks),
        Setting.PATH_ACCELERATION_CEILING: _ceiling(
            path.acceleration, [one.acceleration for one in best], accelerations
        ),
        Setting.PATH_JERK_CEILING: _ceiling(path.jerk, [one.jerk for one in best], jerks),
        Setting.CONTOUR_TOLERANCE: record.tolerance,
    }
    # The record's value at corners belongs to the rule of its own control.
    if record.axes[0].loop.kind == target.kind.key:
        told[AT_CORNERS[rule_of(target.kind.key).kind]] = record.corner_rule.value
    return {(setting, ""): value for setting, value in told.items() if 0.0 < value < inf}


def _ceiling(path: float, axes: Sequence[float], typed: Sequence[float]) -> float:
    """A limit along the path of a control that keeps those of the axes, too."""
    return path if 0.0 < path < min(axes) * (1.0 - 1e-9) else UNBOUND * max(typed)


def _write_together(
    layout: Layout, parts: Sequence[Part], words: Catalogue, target: Control
) -> tuple[list[str], list[dict[Key, float | str]]]:
    """One body in which names tell the axis, and what it says to each part."""
    parts = [_name_remarks(part) for part in parts]
    lines = write_body(layout, _merge(parts, target), words)
    text, every = "\n".join(lines), [row for part in parts for row in part.rows]
    return lines, [read_text(layout, part.rows, text, beside=every) for part in parts]


def _name_remarks(part: Part) -> Part:
    """A part whose remarks name the axis."""
    entries = (
        replace(one, row=replace(one.row, name=f"{to_ascii(part.name)}: {one.row.name}"))
        if part.name and one.row.is_elsewhere
        else one
        for one in part.entries
    )
    return replace(part, entries=tuple(entries))


def _merge(parts: Sequence[Part], target: Control) -> list[Entry]:
    """Entries of all parts, sections that begin alike together.

    What the control has but once gets the smallest of its values.
    """
    merged: dict[tuple[str, str], tuple[str, Entry]] = {}
    for part in parts:
        for entry in part.entries:
            place = entry.row.section, entry.row.name
            name, first = merged.setdefault(place, (part.name, entry))
            if name == part.name:
                continue
            if entry.row.setting not in ONE_FOR_ALL:
                control, names = name_control(target.key), (name, part.name)
                message = Message("group-export-same-name", names=names, control=control)
                raise InputError([Fault(where="--control", message=message)])
            if first.value != entry.value:
                least = min(first, entry, key=lambda one: Decimal(one.value))
                merged[place] = name, least
    entries = [entry for _, entry in merged.values()]
    first_of = [one.row.section.partition("/")[0] for one in entries]
    return sorted(entries, key=lambda one: first_of.index(one.row.section.partition("/")[0]))


def _write_apart(
    layout: Layout, parts: Sequence[Part], words: Catalogue
) -> tuple[list[str], list[dict[Key, float | str]]]:
    """A body for each part under its heading, and what it says."""
    lines: list[str] = []
    found = []
    for part in parts:
        body = write_body(layout, part.entries, words) if part.entries else []
        if body:
            axis = words.text("group-part-axis", name=part.name)
            name = to_ascii(axis if part.name else words.text("group-part-path"))
            lines += [*([""] if lines else []), layout.comment(f"==== {name} ===="), *body]
        found.append(read_text(layout, part.rows, "\n".join(body)))
    return lines, found


def _with_path(values: Values, path: Values) -> dict[Key, float | str]:
    """Settings of an axis; a control without limits of the axis gives it those of the path."""
    given = dict(values)
    if not {(Setting.ACCELERATION, ""), (Setting.RISE_TIME, "")} & given.keys():
        given[Setting.ACCELERATION, ""] = path[Setting.PATH_ACCELERATION, ""]
    return given


def _draw_circles(record: GroupRecord, judged: Sequence[Judged]) -> Iterator[CircleOfText]:
    """The record's circle at two feeds, as the text draws it."""
    axes = {
        axis.name: hold_axis(
            one.held.machine,
            one.held.tuned,
            one.held.limits().setpoint_filter,
            float(one.held.values.get((Setting.WAIT, ""), 0.0)),
        )
        for axis, one in zip(record.axes, judged, strict=True)
        if axis.name in record.plane
    }
    first, second = (axes[name] for name in record.plane)
    for circle in record.circle:
        if any(isclose(circle.feed, feed) for feed in (SLOW, record.feed)):
            size, E = find_circle(first, second, radius=circle.radius, feed=circle.feed)
            worst = int((np.abs(size) + np.abs(E)).argmax())
            yield CircleOfText(
                planned=circle,
                radius_deviation=float(size[worst]),
                form_deviation=2.0 * float(np.abs(E[worst])),
            )


def _say(
    record: GroupRecord,
    target: Control,
    subjects: Sequence[Subject],
    judged: Sequence[Judged],
    parts: Sequence[Part],
    circles: Sequence[CircleOfText],
    words: Catalogue,
) -> Iterator[Message]:
    """The sentences above the parameters."""
    names, profiles = [axis.name for axis in record.axes], [axis.profile for axis in record.axes]
    title, control = record.axes[0].machine.name, name_control(target.key)
    yield Message("group-export-title", name=title, axes=tuple(names), control=control)
    yield say_source(record.tool, record.created, profiles)
    yield from lost_letters(title, *names, *(profile.name for profile in profiles))
    for profile in profiles:
        yield Message("export-hash", hash=profile.sha256)
    yield Message("export-verify")
    for one in circles:
        plan = one.planned
        values = {
            "deviation": one.radius_deviation,
            "form": one.form_deviation,
            "planned": plan.radius_deviation,
            "planned_form": plan.form_deviation,
        }
        yield Message(
            "group-export-circle" if one.is_same else "group-export-other-circle",
            radius=1e3 * plan.radius,
            feed=60.0 * plan.feed,
            **{key: show_value(value, "m", in_degrees=False) for key, value in values.items()},
        )
    notes = {}
    for name, subject, found, part in zip(names, subjects, judged, parts, strict=False):
        for sentence in say_axis(subject, target, found):
            yield Message("group-export-of", name=name, said=sentence)
        notes[name] = say_notes(subject, target, found, part.rows)
    rows = [row for part in parts for row in part.rows]
    yield from _say_without_place(record, {row.setting for row in rows})
    yield from _say_notes(notes)
    # That the rule at corners was not read is of no matter where the text holds no value for it.
    doubt = Message("group-rule-not-verified")
    holds_corner = any(row.setting in CORNER for row in rows)
    warnings = [one for one in record.warnings if holds_corner or one != doubt]
    yield from say_doubts(subjects, judged, warnings, rows, words)


def _say_notes(by_axis: Mapping[str, Sequence[Message]]) -> Iterator[Message]:
    """What there is to mind: once where it is true of every axis."""
    for note in dict.fromkeys(note for notes in by_axis.values() for note in notes):
        if note.kind not in OF_ONE_AXIS:
            own = tuple(name for name, notes in by_axis.items() if note in notes)
            is_common = len(own) == len(by_axis)
            yield note if is_common else Message("group-export-of", name=own, said=note)


def _say_without_place(record: GroupRecord, held: set[Setting]) -> Iterator[Message]:
    """Which values of the group the text does not hold."""
    waits = tuple(
        Message("group-wait-of", name=axis.name, wait=axis.wait)
        for axis in record.axes
        if axis.wait
    )
    lacking = [setting for setting, places in PLACES.items() if not held & places]
    if not waits and Setting.WAIT in lacking:
        lacking.remove(Setting.WAIT)
    if record.axes[0].loop.jerk == "none" and Setting.PATH_JERK in lacking:
        lacking.remove(Setting.PATH_JERK)
    if lacking:
        path = {"acceleration": record.path.acceleration, "jerk": record.path.jerk}
        values = tuple(
            Message(f"{setting.value[2]}-without-place", waits=waits, **path) for setting in lacking
        )
        yield Message("group-export-without-place", values=values)
    if not held & CORNER:
        yield Message("group-export-no-corner")
