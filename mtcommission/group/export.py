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
from mtcommission.control_kinds.kinds import CONTROLS, GENERIC, KINDS
from mtcommission.control_kinds.row import Key, Row, Setting, Values
from mtcommission.control_kinds.syntax import LIST, Entry, Layout
from mtcommission.control_kinds.wording import show_value, to_ascii
from mtcommission.errors import Fault, InputError
from mtcommission.export.catalogue import find_control_key, name_control
from mtcommission.export.header import (
    lost_letters,
    say_axis,
    say_doubts,
    say_notes,
    say_source,
)
from mtcommission.export.held import Held, hold
from mtcommission.export.subject import Subject, build_subject
from mtcommission.export.write import (
    fill_in,
    judge_text,
    read_text,
    words_for,
    write_body,
    write_head,
)
from mtcommission.group.corner import speeds_at_once, speeds_on_arcs, turn
from mtcommission.group.held import HeldAxis, find_deviations, hold_axis
from mtcommission.group.record import GroupRecord
from mtcommission.group.rules import Corner, rule_of, value_of
from mtcommission.loop.disturbance import encoder_noise
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.values import Words

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

PLACES = {
    Setting.WAIT: (Setting.WAIT,),
    Setting.PATH_ACCELERATION: (Setting.PATH_ACCELERATION, Setting.PATH_ACCELERATION_CEILING),
    Setting.PATH_JERK: (Setting.PATH_JERK, Setting.PATH_JERK_CEILING),
    Setting.CORNER_STEP: (*AT_CORNERS.values(), Setting.CONTOUR_TOLERANCE),
}
"""Settings each of which a control must have one of, to hold that value of the group."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleOfText:
    """A circle as the text draws it, worst corners, beside that of the record [m, m/s]."""

    radius: float
    feed: float
    radius_deviation: float
    form_deviation: float
    recorded: tuple[float, float]  # radius and form deviation

    @property
    def largest(self) -> float:
        """How far the tool is from the circle."""
        return abs(self.radius_deviation) + 0.5 * self.form_deviation

    @property
    def is_same(self) -> bool:
        """Whether both are the record's."""
        pairs = zip((self.radius_deviation, self.form_deviation), self.recorded, strict=True)
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
    together = target.names_axes or as_list
    if together:
        parts = _share([_tell_apart(part, target) for part in parts], target)
    lines = (_write_together if together else _write_apart)(layout, parts, words)
    *own, path = _read(layout, parts, "\n".join(lines), words, together=together)
    judged = [
        judge_text(subject, _with_path(values, path))
        for subject, values in zip(subjects, own, strict=True)
    ]
    drawn = [
        _as_drawn(axis.name, one.held)
        for axis, one in zip(record.axes, judged, strict=True)
        if axis.name in record.plane
    ]
    circles = tuple(_draw_circles(record, drawn))
    rows = [row for part in parts for row in part.rows]
    said = [
        *_say_first(record, target, circles),
        *(
            Message("group-export-of", name=axis.name, said=sentence)
            for axis, subject, one in zip(record.axes, subjects, judged, strict=True)
            for sentence in say_axis(subject, target, one)
        ),
        *_say_without_place(record, target, rows),
        *_say_notes(
            {
                axis.name: say_notes(subject, target, one, part.rows)
                for axis, subject, one, part in zip(
                    record.axes, subjects, judged, parts, strict=False
                )
            }
        ),
        *say_doubts(subjects, judged, list(_warn(record, target)), rows, words),
    ]
    head = write_head(layout, said, words)
    return GroupExport(
        header=head.sentences,
        circles=circles,
        meets_requirements=all(one.is_met and not one.left_out for one in judged)
        and all(one.largest <= record.tolerance for one in circles),
        text="\n".join([*head.lines, "", *lines]) + "\n",
    )


def fill_in_group(record: GroupRecord, target: Control, subjects: Sequence[Subject]) -> list[Part]:
    """Return every axis with what is typed in for it, the path last."""
    own = [fill_in(subject, target)[0] for subject in subjects]
    held = [
        hold(subject, {entry.row.key: entry.row.decode(entry.value) for entry in entries})
        for subject, entries in zip(subjects, own, strict=True)
    ]
    told = _tell(record, target, held)
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


def _tell(record: GroupRecord, target: Control, held: Sequence[Held]) -> dict[Key, float | str]:
    """What the path is told [SI]; nothing for corners where the rule has no value."""
    limits = [one.limits() for one in held]
    best = [axis.limits.recommended for axis in record.axes]
    path, accelerations = record.path, [one.acceleration for one in limits]
    told = {
        # Where no acceleration keeps circles, a warning says so: an axis must move all the same.
        Setting.PATH_ACCELERATION: min(path.acceleration or inf, *accelerations),
        Setting.PATH_JERK: min(path.jerk, *(one.jerk for one in limits)),
        Setting.PATH_ACCELERATION_CEILING: _ceiling(
            path.acceleration, [one.acceleration for one in best], accelerations
        ),
        Setting.PATH_JERK_CEILING: _ceiling(
            path.jerk, [one.jerk for one in best], [one.jerk for one in limits]
        ),
        Setting.CONTOUR_TOLERANCE: record.tolerance,
        AT_CORNERS[rule_of(target.key).kind]: _at_corners(record, target, held),
    }
    return {(setting, ""): value for setting, value in told.items() if 0.0 < value < inf}


def _ceiling(path: float, axes: Sequence[float], typed: Sequence[float]) -> float:
    """A limit along the path of a control that keeps those of the axes, too."""
    return path if 0.0 < path < min(axes) * (1.0 - 1e-9) else UNBOUND * max(typed)


def _at_corners(record: GroupRecord, target: Control, held: Sequence[Held]) -> float:
    """What the control's rule is told: the record's, or for another control found anew."""
    if record.axes[0].loop.kind == target.key:
        return record.corner_rule.value
    rule = rule_of(target.key)
    axes = [
        _as_drawn(axis.name, one)
        for axis, one in zip(record.axes, held, strict=True)
        if axis.name in record.plane
    ]
    reserve = min(one.machine.requirements.reserve.band for one in held)
    noise = sum(
        max(
            encoder_noise(loop, resolution=axis.machine.drive.encoder_resolution).tool
            for loop in axis.tuned.loops
        )
        for axis in axes
    )
    tolerance, feed = max(reserve * record.tolerance - noise, 0.0), record.feed
    first, second = (turn(one.answers) for one in axes)
    if rule.kind is not Corner.ARC:
        return value_of(
            rule, tuple(speeds_at_once((first, second), tolerance=tolerance, feed=feed))
        )
    acceleration = rule.share * record.path.acceleration
    speeds = speeds_on_arcs(
        (first, second), tolerance=tolerance, feed=feed, acceleration=acceleration
    )
    return value_of(rule, tuple(speeds))


def _tell_apart(part: Part, target: Control) -> Part:
    """A part whose rows can stand beside those of other axes."""
    if not part.name:
        return part
    entries = []
    for entry in part.entries:
        row = entry.row
        if row.is_elsewhere:
            row = replace(row, name=f"{to_ascii(part.name)}: {row.name}")
        elif not target.names_axes:
            row = replace(row, section=f"{to_ascii(part.name)} {row.section}".strip())
        entries.append(replace(entry, row=row))
    return replace(part, entries=tuple(entries))


def _share(parts: Sequence[Part], target: Control) -> list[Part]:
    """Parts in which what the control has but once is the same: the smallest of a number."""
    places: dict[tuple[str, str], dict[str, Entry]] = {}
    for part in parts:
        for entry in part.entries:
            place = entry.row.section, entry.row.name
            places.setdefault(place, {}).setdefault(part.name, entry)
    once = {}
    for place, by_axis in places.items():
        if len(by_axis) > 1:
            entries = list(by_axis.values())
            if entries[0].row.setting not in ONE_FOR_ALL:
                message = Message(
                    "group-export-same-name", names=tuple(by_axis), control=name_control(target.key)
                )
                raise InputError([Fault(where="--control", message=message)])
            alike = len({entry.value for entry in entries}) == 1
            once[place] = entries[0] if alike else min(entries, key=lambda e: Decimal(e.value))
    return [
        replace(
            part,
            entries=tuple(once.get((e.row.section, e.row.name), e) for e in part.entries),
        )
        for part in parts
    ]


def _write_together(layout: Layout, parts: Sequence[Part], words: Catalogue) -> list[str]:
    """One body; sections that begin alike stand together."""
    every = (entry for part in parts for entry in part.entries)
    entries = list({(one.row.section, one.row.name): one for one in every}.values())
    if layout is LIST:
        return write_body(layout, entries, words)
    first = [entry.row.section.partition("/")[0] for entry in entries]
    order = sorted(range(len(entries)), key=lambda i: first.index(first[i]))
    return write_body(layout, [entries[i] for i in order], words)


def _heading(layout: Layout, part: Part, words: Catalogue) -> str:
    name = words.text("group-part-axis", name=part.name) if part.name else ""
    return layout.comment(f"==== {to_ascii(name or words.text('group-part-path'))} ====")


def _write_apart(layout: Layout, parts: Sequence[Part], words: Catalogue) -> list[str]:
    """A body for each part under its heading."""
    lines: list[str] = []
    for part in parts:
        if part.entries:
            own = write_body(layout, part.entries, words)
            lines += [*([""] if lines else []), _heading(layout, part, words), *own]
    return lines


def _read(
    layout: Layout, parts: Sequence[Part], text: str, words: Catalogue, *, together: bool
) -> list[dict[Key, float | str]]:
    """What a text says to each part."""
    if together:
        every = [row for part in parts for row in part.rows]
        return [read_text(layout, part.rows, text, beside=every) for part in parts]
    found = []
    for part in parts:
        _, _, behind = text.partition(_heading(layout, part, words))
        own, _, _ = behind.partition(layout.comment("===="))
        found.append(read_text(layout, part.rows, own) if part.entries else {})
    return found


def _with_path(values: Values, path: Values) -> dict[Key, float | str]:
    """Settings of an axis; a control without limits of the axis gives it those of the path."""
    given = dict(values)
    if not {(Setting.ACCELERATION, ""), (Setting.RISE_TIME, "")} & given.keys():
        given[Setting.ACCELERATION, ""] = path[Setting.PATH_ACCELERATION, ""]
    return given


def _as_drawn(name: str, held: Held) -> HeldAxis:
    wait = held.values.get((Setting.WAIT, ""), 0.0)
    item = held.limits().setpoint_filter
    return hold_axis(name, held.machine, held.tuned, item, float(wait))


def _draw_circles(record: GroupRecord, axes: Sequence[HeldAxis]) -> Iterator[CircleOfText]:
    """The record's circle at two feeds, as the text draws it."""
    by_name = {axis.name: axis for axis in axes}
    for circle in record.circle:
        if not any(isclose(circle.feed, feed) for feed in (SLOW, record.feed)):
            continue
        omega = np.array([circle.feed / circle.radius])
        every = find_deviations([by_name[name] for name in record.plane], omega)
        worst = int(every.largest[:, 0].argmax())
        yield CircleOfText(
            radius=circle.radius,
            feed=circle.feed,
            radius_deviation=circle.radius * float(every.radius[worst, 0]),
            form_deviation=circle.radius * float(every.form[worst, 0]),
            recorded=(circle.radius_deviation, circle.form_deviation),
        )


def _say_first(
    record: GroupRecord, target: Control, circles: Sequence[CircleOfText]
) -> Iterator[Message]:
    """What the text is, and what circles it draws."""
    axes, profiles = record.axes, [axis.profile for axis in record.axes]
    name = axes[0].machine.name
    yield Message(
        "group-export-title",
        name=name,
        axes=tuple(axis.name for axis in axes),
        control=name_control(target.key),
    )
    yield say_source(record.tool, record.created, profiles)
    yield from lost_letters(
        name, *(axis.name for axis in axes), *(profile.name for profile in profiles)
    )
    for profile in profiles:
        yield Message("export-hash", hash=profile.sha256)
    yield Message("export-verify")
    for one in circles:
        found = (one.radius_deviation, one.form_deviation)
        texts = [show_value(value, "m", in_degrees=False) for value in (*found, *one.recorded)]
        yield Message(
            "group-export-circle" if one.is_same else "group-export-other-circle",
            radius=1e3 * one.radius,
            feed=60.0 * one.feed,
            **dict(zip(("deviation", "form", "planned", "planned_form"), texts, strict=True)),
        )


def _say_notes(by_axis: Mapping[str, Sequence[Message]]) -> Iterator[Message]:
    """What there is to mind: once where it is true of every axis."""
    every = dict.fromkeys(note for notes in by_axis.values() for note in notes)
    for note in every:
        if note.kind in OF_ONE_AXIS:
            continue
        own = [name for name, notes in by_axis.items() if note in notes]
        if len(own) == len(by_axis):
            yield note
        else:
            yield from (Message("group-export-of", name=name, said=note) for name in own)


def _warn(record: GroupRecord, target: Control) -> Iterator[Words]:
    """The record's warnings; that about the rule at corners is the target's."""
    doubt = Message("group-rule-not-verified")
    yield from (warning for warning in record.warnings if warning != doubt)
    if not rule_of(target.key).is_verified:
        yield doubt


def _say_without_place(
    record: GroupRecord, target: Control, rows: Sequence[Row]
) -> Iterator[Message]:
    """Which values of the group the text does not hold."""
    held = {row.setting for row in rows}
    lacking = [setting for setting, places in PLACES.items() if not held & set(places)]
    if not any(axis.wait for axis in record.axes) and Setting.WAIT in lacking:
        lacking.remove(Setting.WAIT)
    if not KINDS[record.axes[0].loop.kind].has_jerk_limit and Setting.PATH_JERK in lacking:
        lacking.remove(Setting.PATH_JERK)
    corner = AT_CORNERS[rule_of(target.key).kind]
    known = {row.setting for row in (*target.axis_in_group, *target.group)}
    if Setting.CORNER_STEP in lacking and corner in known:
        lacking.remove(Setting.CORNER_STEP)
        yield Message("group-export-no-rounding")
    if lacking:
        yield Message(
            "group-export-without-place",
            values=tuple(
                Message(
                    f"{setting.value[2]}-without-place",
                    waits=tuple(
                        Message("group-wait-of", name=axis.name, wait=axis.wait)
                        for axis in record.axes
                    ),
                    acceleration=record.path.acceleration,
                    jerk=record.path.jerk,
                )
                for setting in lacking
            ),
        )
