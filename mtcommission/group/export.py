"""Record of a group -> one text for a control: every axis and the path, read back and simulated.

Rows of an axis are those of its own export, with the group's filter and limits. Where names tell
the axis, all stand together as the control has them; else there is a part of the text for each.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from math import inf, isclose

import numpy as np

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Control, Corner, name_row
from mtcommission.controls.kinds import CONTROLS, GENERIC
from mtcommission.controls.row import (
    AT_CORNERS,
    PATH_ACCELERATION,
    PATH_JERK,
    WAIT,
    Key,
    Row,
    Setting,
    Values,
)
from mtcommission.controls.syntax import LIST, Entry, Layout, type_in
from mtcommission.controls.wording import name_control, show_value, to_ascii
from mtcommission.export.catalogue import find_control_key
from mtcommission.export.choose import fill_in
from mtcommission.export.header import (
    say_axis,
    say_doubts,
    say_notes,
    say_origin,
    say_verdict,
)
from mtcommission.export.held import Held, Judged, judge_text, read_limits
from mtcommission.export.subject import Subject, build_subject
from mtcommission.export.write import (
    compose_text,
    read_text,
    say_plainly,
    words_for,
    write_body,
)
from mtcommission.group.contours import Pair, PathLimits, line_deviation, worst_circle
from mtcommission.group.follow import follow
from mtcommission.group.group import tell
from mtcommission.group.judged import Circle
from mtcommission.group.record import GroupRecord

SLOW = 1.0 / 60.0
"""The first feed at which the text's circle is drawn [m/s]; the other is the group's."""

SAME, SAME_SHARE = 0.1e-6, 0.01
"""By how much a circle of the text may differ from the record's [m], or as a share of it."""

JUST = 1.0 + 1e-6
"""Times the record's acceleration of circles that is the same."""

ONE_FOR_ALL = (Setting.FIXED, Setting.POSITION_CYCLE, Setting.VELOCITY_CYCLE)
"""What the control has but once, whichever axis asks for it."""

OF_ONE_AXIS = (
    "klipper-corner-bound",
    "marlin-corner-bound",
    "marlin-step-bound",
    "grblhal-corners",
)
"""Notes on values that a group has otherwise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleOfText:
    """A circle, worst corners, as the text draws it beside that of the record."""

    planned: Circle
    drawn: Circle

    @property
    def is_same(self) -> bool:
        """Whether both are the record's."""
        one, other = self.drawn, self.planned
        pairs = (
            (one.radius_deviation, other.radius_deviation),
            (one.form_deviation, other.form_deviation),
        )
        return all(abs(a - b) <= max(SAME, SAME_SHARE * abs(b)) for a, b in pairs)


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupExport:
    """A group in a control's own words."""

    header: tuple[str, ...]  # sentences above the parameters
    circles: tuple[CircleOfText, ...]
    line: float  # how far the tool leaves lines at most, with what the text holds [m]
    meets_requirements: bool  # of each axis, circles and lines, by what the text holds
    missed: tuple[Message, ...]  # what the header says is missed, absent or otherwise
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
    words, layout = words_for(subjects[0], language), LIST if as_list else target.layout
    parts = fill_in_group(record, target, subjects)
    if target.names_axes and not as_list:
        lines, (*own, path) = _write_together(layout, parts, words, target)
    else:
        lines, (*own, path) = _write_apart(layout, parts, words)
    alone = [
        judge_text(subject, _with_path(values, path))
        for subject, values in zip(subjects, own, strict=True)
    ]
    held = {axis.name: one.held for axis, one in zip(record.axes, alone, strict=True)}
    drawn = [held[name] for name in record.plane]
    pair, limits = _read_pair(drawn), _read_path(drawn, path)
    judged = [_slow_down(one, limits) for one in alone]
    circles = tuple(_draw_circles(record, pair))
    line, _ = line_deviation(pair, feed=record.feed, limits=limits)
    rows = [row for part in parts for row in part.rows]
    title, names = record.axes[0].machine.name, tuple(axis.name for axis in record.axes)
    profiles = [axis.profile for axis in record.axes]
    contours = [*((_say_circle(one), not one.is_same) for one in circles)]
    contours.append((_say_line(line, record), line > record.tolerance))
    not_met, gaps = tuple(_say_verdict(record)), tuple(_say_gaps(record, rows))
    # That the rule at corners was not read is of no matter where the text holds no value for it.
    doubt, holds_corner = Message("group-rule-not-verified"), _hold(rows, AT_CORNERS)
    warnings = [one for one in record.warnings if holds_corner or one != doubt]
    said = [
        Message("group-export-title", name=title, axes=names, control=name_control(target.key)),
        *say_origin(record.tool, record.created, profiles, title, *names),
        *(message for message, _ in contours),
        *not_met,
        *_say_axes(record, target, subjects, judged, parts),
        *gaps,
        *say_doubts(subjects, alone, warnings, rows, words),
    ]
    header = say_plainly(said, words)
    off = max(line, *(one.drawn.largest for one in circles))
    is_gentle = limits.on_circles[0] <= JUST * record.limits.on_circles[0]
    are_met = all(one.is_met and not one.left_out for one in judged)
    missed = [message for message, is_off in contours if is_off]
    return GroupExport(
        header=header,
        circles=circles,
        line=line,
        meets_requirements=are_met and off <= record.tolerance and is_gentle,
        missed=(*missed, *not_met, *_say_missed(record, judged), *gaps),
        text=compose_text(layout, header, lines),
    )


# What is typed in


def fill_in_group(record: GroupRecord, target: Control, subjects: Sequence[Subject]) -> list[Part]:
    """Return every axis with what is typed in for it, the path last."""
    own = [fill_in(subject, target).entries for subject in subjects]
    told = _tell(record, target, subjects, own)
    of_path = {(row.section, row.name) for row in target.group}
    parts = []
    for axis, entries in zip(record.axes, own, strict=True):
        kept = [one for one in entries if (one.row.section, one.row.name) not in of_path]
        more = type_in(target.axis_in_group, {**told, WAIT: axis.wait})
        parts.append(Part(name=axis.name, entries=(*kept, *more)))
    return [*parts, Part(name="", entries=tuple(type_in(target.group, told)))]


def _tell(
    record: GroupRecord,
    target: Control,
    subjects: Sequence[Subject],
    typed: Sequence[Sequence[Entry]],
) -> dict[Key, float]:
    """What the path is told [SI]; nothing for corners where the rule has no value."""
    limits = []
    for subject, entries in zip(subjects, typed, strict=True):
        values = {one.row.key: one.row.decode(one.value) for one in entries}
        cycle = subject.controller.position_cycle
        limits.append(read_limits({(Setting.POSITION_CYCLE, ""): cycle, **values}))
    is_own = record.axes[0].loop.kind == target.key
    corner = record.corner_rule.value if is_own else 0.0
    told = {AT_CORNERS: record.tolerance if target.corner.kind is Corner.OWN else corner}
    for key in (PATH_ACCELERATION, PATH_JERK):
        in_record = getattr(record.path, key[1])
        # A ceiling is what the record holds, whatever rounding does to the axes below it.
        is_ceiling = is_own and in_record and key[1] in target.axes_hold
        axes = [getattr(one, key[1]) for one in limits]
        told[key] = in_record if is_ceiling else tell(target, key, in_record or inf, axes)
    return {key: value for key, value in told.items() if 0.0 < value < inf}


# The text, and what it says


def _write_together(
    layout: Layout, parts: Sequence[Part], words: Catalogue, target: Control
) -> tuple[list[str], list[dict[Key, float | str]]]:
    """One body in which names tell the axis, and what it says to each part."""
    parts = [_name_remarks(part, words) for part in parts]
    lines = write_body(layout, _merge(parts, target), words)
    text, every = "\n".join(lines), [row for part in parts for row in part.rows]
    return lines, [read_text(layout, part.rows, text, words, beside=every) for part in parts]


def _name_remarks(part: Part, words: Catalogue) -> Part:
    """A part whose remarks name the axis."""
    entries = (
        replace(
            one, row=replace(one.row, name=to_ascii(f"{part.name}: {name_row(one.row, words)}"))
        )
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
                raise InputError.at("--control", message)
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
        found.append(read_text(layout, part.rows, "\n".join(body), words))
    return lines, found


# What the text does


def _with_path(values: Values, path: Values) -> dict[Key, float | str]:
    """Settings of an axis; a control without limits of the axis gives it those of the path."""
    given = dict(values)
    if not {(Setting.ACCELERATION, ""), (Setting.RISE_TIME, "")} & given.keys():
        given[Setting.ACCELERATION, ""] = path[PATH_ACCELERATION]
    return given


def _read_pair(drawn: Sequence[Held]) -> Pair:
    """The axes that draw circles, as the text makes them."""
    first, second = (
        follow(
            one.machine, one.tuned, one.limits().setpoint_filter, float(one.values.get(WAIT, 0.0))
        )
        for one in drawn
    )
    return first, second


def _read_path(drawn: Sequence[Held], path: Values) -> PathLimits:
    first, second = (one.limits() for one in drawn)
    return PathLimits(
        acceleration=float(path.get(PATH_ACCELERATION, inf)),
        jerk=float(path.get(PATH_JERK, inf)),
        accelerations=(first.acceleration, second.acceleration),
        jerks=(first.jerk, second.jerk),
    )


def _slow_down(found: Judged, path: PathLimits) -> Judged:
    """An axis of the text with the moves that the path's limits leave."""
    held = found.held
    limits = path.within(held.limits())
    if limits == held.limits():
        return found
    verdict = held.judge(limits)
    return replace(found, verdict=verdict, is_met=found.is_met and verdict.assessment.is_met)


def _draw_circles(record: GroupRecord, pair: Pair) -> Iterator[CircleOfText]:
    """The record's circle at two feeds, as the text draws it."""
    for circle in record.circle:
        if any(isclose(circle.feed, feed) for feed in (SLOW, record.feed)):
            off, _ = worst_circle(pair, np.array([circle.feed / circle.radius]))
            drawn = replace(
                circle,
                radius_deviation=circle.radius * float(off.radius[0]),
                form_deviation=circle.radius * float(off.form[0]),
            )
            yield CircleOfText(planned=circle, drawn=drawn)


def _hold(rows: Sequence[Row], key: Key) -> bool:
    return any(row.key == key for row in rows)


# The sentences above the parameters


def _say_circle(one: CircleOfText) -> Message:
    def show(value: float) -> Message:
        return show_value(value, "m")

    drawn, planned = one.drawn, one.planned
    return Message(
        "group-export-circle" if one.is_same else "group-export-other-circle",
        radius=1e3 * planned.radius,
        feed=60.0 * planned.feed,
        deviation=show(drawn.radius_deviation),
        form=show(drawn.form_deviation),
        planned=show(planned.radius_deviation),
        planned_form=show(planned.form_deviation),
    )


def _say_line(line: float, record: GroupRecord) -> Message:
    deviation = show_value(line, "m")
    return Message("group-export-line", feed=60.0 * record.feed, deviation=deviation)


def _say_verdict(record: GroupRecord) -> Iterator[Message]:
    """That the group misses a requirement, whatever its axes keep."""
    missed = tuple(check.label for check in record.assessment.checks if not check.met)
    if missed:
        yield Message("group-export-not-met", checks=missed)


def _say_axes(
    record: GroupRecord,
    target: Control,
    subjects: Sequence[Subject],
    judged: Sequence[Judged],
    parts: Sequence[Part],
) -> Iterator[Message]:
    """What the text does to each axis; what there is to mind once where it is true of all."""
    notes: dict[Message, list[str]] = {}
    for axis, subject, found, part in zip(record.axes, subjects, judged, parts, strict=False):
        for sentence in say_axis(subject, found):
            yield Message("group-export-of", name=axis.name, said=sentence)
        for note in say_notes(subject, target, found, part.rows):
            if note.kind not in OF_ONE_AXIS:
                notes.setdefault(note, []).append(axis.name)
    for note, names in notes.items():
        is_common = len(names) == len(record.axes)
        yield note if is_common else Message("group-export-of", name=tuple(names), said=note)


def _say_missed(record: GroupRecord, judged: Sequence[Judged]) -> Iterator[Message]:
    """The verdict on each axis that the text does not serve."""
    for axis, found in zip(record.axes, judged, strict=True):
        if not found.is_met or found.left_out:
            yield Message("group-export-of", name=axis.name, said=say_verdict(found))


def _say_gaps(record: GroupRecord, rows: Sequence[Row]) -> Iterator[Message]:
    """What has no place, without which the group does not do what was judged."""
    lacking, limits = list[Message](), record.limits
    waits = tuple(
        Message("group-wait-of", name=axis.name, wait=axis.wait)
        for axis in record.axes
        if axis.wait
    )
    if waits and not _hold(rows, WAIT):
        lacking.append(Message("group-wait-without-place", waits=waits))
    for key, told, axes in (
        (PATH_ACCELERATION, limits.acceleration, limits.accelerations),
        (PATH_JERK, limits.jerk, limits.jerks),
    ):
        # A circle takes no more than the lesser axis; lines are simulated from the text.
        if told < min(axes) and not _hold(rows, key):
            lacking.append(Message(f"group-{key[1]}-without-place", value=told))
    if lacking:
        yield Message("group-export-without-place", values=tuple(lacking))
    if not _hold(rows, AT_CORNERS):
        yield Message("group-export-no-corner")
