"""The comment above an export: what it was written from, what it does, and what to mind."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from math import isfinite

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Control, Typed
from mtcommission.controls.row import Row, Setting
from mtcommission.controls.wording import name_control, show_value, to_ascii
from mtcommission.export.held import Judged
from mtcommission.export.subject import Subject
from mtcommission.limits.judge import Candidate
from mtcommission.loop.tuning.gains import believed_mass
from mtcommission.record.machine import ACCEPTED_DEFAULT, Profile
from mtcommission.record.record import Record, Tool
from mtcommission.record.shape import Words
from mtcommission.study.attainable import ModeLimits

SAME = 1e-6
"""Relative difference below which a mass of the feed-forward is the one that tuning takes."""


def compose_header(
    record: Record,
    subject: Subject,
    control: Control,
    judged: Judged,
    rows: Sequence[Row],
    words: Catalogue,
) -> Iterator[Message]:
    """Yield the sentences above the parameters."""
    machine, profile = record.machine, record.profile
    name = name_control(control.key)
    yield Message("export-title", name=machine.name, axis_name=machine.axis, control=name)
    yield from say_origin(record.tool, record.created, [profile], machine.name, machine.axis)
    yield from say_axis(subject, judged)
    yield from say_notes(subject, control, judged, rows)
    yield from say_doubts([subject], [judged], record.warnings, rows, words)


def say_origin(
    tool: Tool, created: str, profiles: Sequence[Profile], *names: str
) -> Iterator[Message]:
    """Yield what a text was computed from, and whether letters of its names were lost."""
    files, by = [profile.name for profile in profiles], f"{tool.name} {tool.version}"
    yield Message("export-computed", created=created, tool=by, profile=", ".join(files))
    if any(to_ascii(name).count("?") > name.count("?") for name in (*names, *files)):
        yield Message("export-lost-letters")
    for profile in profiles:
        yield Message("export-hash", hash=profile.sha256)
    yield Message("export-verify")


def say_axis(subject: Subject, judged: Judged) -> Iterator[Message]:
    """Yield what the text does to the axis, and what it lacks."""
    yield say_verdict(judged)
    needs = subject.machine.requirements
    (low, high), mass = needs.payload, subject.controller.feedforward_mass
    is_middle = abs(mass / believed_mass(subject.machine) - 1.0) < SAME
    yield Message(
        "export-corners",
        frequency=needs.frequency_spread,
        damping=needs.damping_spread,
        payload="no" if high <= 0.0 else "middle" if is_middle else "yes",
        low=low,
        high=high,
    )
    if subject.left_out:
        yield _left_out(subject, judged.verdict)
    yield from say_modes_left_out(subject, judged)
    yield from say_ceiling(subject, judged)


def say_verdict(judged: Judged) -> Message:
    """Return what the text does, and which requirements that misses."""
    verdict = judged.verdict
    said = Message(
        "export-judged",
        corners=len(judged.held.tuned.corners),
        settling=show_value(verdict.settling_time, "s"),
        residual=show_value(verdict.residual_deviation, judged.held.machine.axis_units.length.si),
    )
    missed = [
        Message(
            "export-missed",
            name=check.requirement.message,
            value=show_value(check.value, check.unit),
            limit=show_value(check.limit, check.unit),
        )
        for check in verdict.assessment.checks
        if not check.is_met
    ]
    missed += [judged.lost_margins] if judged.lost_margins else []
    without = [
        Message("export-mode-missed", mode=Message(f"machining-{mode.name}"))
        for mode in judged.left_out
    ]
    if not missed and not without:
        return Message("export-all-met", judged=said)
    told = reduce(
        lambda first, then: Message("record-both", first=first, then=then), missed + without
    )
    return Message(
        "export-not-all-met" if missed else "export-incomplete", judged=said, missed=told
    )


def _left_out(subject: Subject, verdict: Candidate) -> Message:
    """What the record's loop uses and this control lacks, and what that costs."""
    before, after = subject.settling_time, verdict.settling_time
    cost = "grows" if isfinite(before) and isfinite(after) else "unknown"
    return Message(
        "export-left-out",
        features=tuple(Message("export-feature", what=what) for what in subject.left_out),
        before=show_value(before, "s"),
        after=show_value(after, "s"),
        change=after / before - 1.0 if cost == "grows" else 0.0,
        cost=cost,
        kind=subject.kind.key,
    )


def say_modes_left_out(subject: Subject, judged: Judged) -> Iterator[Message]:
    """Yield each machining mode that is not to be used, and why."""
    for mode in judged.left_out:
        yield Message("export-mode-left-out", why=_explain(subject, mode))


def _explain(subject: Subject, mode: ModeLimits) -> Message:
    """Why a machining mode is left out, with its band and the one that could be met."""
    band, attainable = (
        None if value is None else show_value(value, subject.length)
        for value in (mode.band, mode.attainable)
    )
    name = Message(f"machining-{mode.name}")
    if mode.meets_requirements:
        return Message("export-mode-fails", mode=name, band=band)
    if attainable:
        return Message("export-no-limits-but", mode=name, band=band, attainable=attainable)
    return Message("export-no-limits-within", mode=name, band=band)


def say_ceiling(subject: Subject, judged: Judged) -> Iterator[Message]:
    """Yield why less acceleration is written than the axis would take, where that is so."""
    ceiling, wanted = subject.kind.largest_acceleration, subject.limits.acceleration
    if wanted > ceiling:
        yield Message(
            "export-ceiling",
            wanted=1e3 * wanted,
            ceiling=1e3 * ceiling,
            why=Message("ceiling-source", kind=subject.kind.key),
            before=show_value(subject.settling_time, "s"),
            after=show_value(judged.verdict.settling_time, "s"),
        )


def say_notes(
    subject: Subject, control: Control, judged: Judged, rows: Sequence[Row]
) -> Iterator[Message]:
    """Yield what there is to mind with this control."""
    typed = Typed(
        values=judged.held.values,
        acceleration=judged.held.limits().acceleration,
        is_met=judged.verdict.assessment.is_met,
    )
    at_shaft = (Setting.VELOCITY_GAIN, Setting.FORCE_FEEDFORWARD)
    yield Message("export-safe-side")
    if subject.machine.drive.follows:
        yield Message("export-no-loop")
    elif subject.shaft is None:
        yield Message("export-no-shaft")
    elif any(row.setting in at_shaft and row.scale != 1.0 for row in rows):
        yield Message("export-shaft", travel=subject.shaft)
    yield from map(Message, control.notes)
    yield from control.notes_of(subject.axis, typed)


def say_doubts(
    subjects: Sequence[Subject],
    judged: Sequence[Judged],
    warnings: Sequence[Words],
    rows: Sequence[Row],
    words: Catalogue,
) -> Iterator[Message]:
    """Yield the warnings of the record, those of the text's loops, and what is not certain."""
    for warning in warnings:
        yield Message("export-warning", warning=warning)
    warned = {words.say(warning) for warning in warnings}
    for own in dict.fromkeys(one for each in judged for one in each.held.tuned.warnings):
        if words.say(own) not in warned:
            yield Message("export-warning-here", warning=own)
    data = [item for subject in subjects for item in subject.record.data]
    unmeasured = dict.fromkeys(item.key for item in data if item.source == ACCEPTED_DEFAULT)
    if unmeasured:
        yield Message("export-not-measured", keys=tuple(unmeasured))
    if not all(row.is_verified for row in rows):
        yield Message("export-doubt")
