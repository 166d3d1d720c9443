"""The comment above an export: what it was written from, what it does, and what to mind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from math import inf, isfinite

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Control, Typed
from mtcommission.controls.row import Row, Setting
from mtcommission.controls.wording import name_mode, show_value, to_ascii
from mtcommission.export.catalogue import name_control
from mtcommission.export.held import Held
from mtcommission.export.subject import Subject
from mtcommission.limits.judge import Candidate
from mtcommission.loop.tuning.tuned import TuningSettings, describe_margins, has_margins
from mtcommission.record.limits import ModeLimitsEntry
from mtcommission.record.machine import ACCEPTED_DEFAULT, Profile
from mtcommission.record.read_back import AxisRecord
from mtcommission.record.record import Record, Tool
from mtcommission.record.shape import Words

WIDTH = 96
"""Columns of the header's sentences."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """What the text holds and does."""

    held: Held  # the loop that it makes
    verdict: Candidate  # of the recommendation
    left_out: tuple[ModeLimitsEntry, ...]  # machining modes whose band no limits meet
    lost_margins: Message | None  # where they are poor and those of the record were not
    is_met: bool  # whether all requirements are kept in every corner, and the record's margins


def compose_header(
    record: Record,
    subject: Subject,
    control: Control,
    judged: Judged,
    rows: Sequence[Row],
    words: Catalogue,
) -> list[Message]:
    """Return the sentences above the parameters."""
    machine = record.machine
    return [
        Message(
            "export-title",
            name=machine.name,
            axis_name=machine.axis,
            control=name_control(control.key),
        ),
        say_source(record.tool, record.created, [record.profile]),
        *lost_letters(machine.name, machine.axis, record.profile.name),
        Message("export-hash", hash=record.profile.sha256),
        Message("export-verify"),
        *say_axis(subject, control, judged),
        *say_notes(subject, control, judged, rows),
        *say_doubts([subject], [judged], record.warnings, rows, words),
    ]


def say_source(tool: Tool, created: str, profiles: Sequence[Profile]) -> Message:
    """Return what the text was computed from."""
    names = ", ".join(profile.name for profile in profiles)
    return Message(
        "export-computed", created=created, tool=f"{tool.name} {tool.version}", profile=names
    )


def say_axis(subject: Subject, control: Control, judged: Judged) -> list[Message]:
    """Return what the text does to the axis, and what it lacks."""
    verdict, *without = say_judgement(subject, control, judged)
    return [
        verdict,
        _corners(subject),
        *_left_out(subject, judged.verdict),
        *without,
        *say_ceiling(subject, judged),
    ]


def say_notes(
    subject: Subject, control: Control, judged: Judged, rows: Sequence[Row]
) -> list[Message]:
    """Return what there is to mind with this control."""
    typed = Typed(
        values=judged.held.values,
        acceleration=judged.held.limits().acceleration,
        is_met=judged.verdict.assessment.is_met,
    )
    return [
        Message("export-safe-side"),
        *_shaft(subject, rows),
        *map(Message, control.notes),
        *control.notes_of(subject.axis, typed),
    ]


def say_doubts(
    subjects: Sequence[Subject],
    judged: Sequence[Judged],
    warnings: Sequence[Words],
    rows: Sequence[Row],
    words: Catalogue,
) -> list[Message]:
    """Return the warnings of the record, those of the text's loops, and what is not certain."""
    warned = {words.say(warning) for warning in warnings}
    found = dict.fromkeys(one for each in judged for one in each.held.tuned.warnings)
    own = [warning for warning in found if words.say(warning) not in warned]
    sentences = [Message("export-warning", warning=warning) for warning in warnings]
    sentences += [Message("export-warning-here", warning=warning) for warning in own]
    data = [item for subject in subjects for item in subject.record.data]
    unmeasured = dict.fromkeys(item.key for item in data if item.source == ACCEPTED_DEFAULT)
    if unmeasured:
        sentences.append(Message("export-not-measured", keys=tuple(unmeasured)))
    if not all(row.is_verified for row in rows):
        sentences.append(Message("export-doubt"))
    return sentences


ROUNDED_MARGINS = TuningSettings(gain_margin_db=5.7, phase_margin_deg=29.0, sensitivity_peak=2.1)
"""What rounding to the digits of a control may leave of the margins."""


def find_lost_margins(record: AxisRecord, held: Held) -> Message | None:
    """Return the margins of the text's loop where they are poor and the record's were not."""
    worst = record.loop.worst_corner
    had = (
        worst is not None
        and (worst.gain_margin_db or inf) >= ROUNDED_MARGINS.gain_margin_db
        and (worst.phase_margin_deg or inf) >= ROUNDED_MARGINS.phase_margin_deg
        and worst.sensitivity_peak <= ROUNDED_MARGINS.sensitivity_peak
    )
    analyses = held.tuned.analyses
    if not had or all(has_margins(one, settings=ROUNDED_MARGINS) for one in analyses):
        return None
    return Message("export-margins-lost", margins=describe_margins(analyses))


def say_judgement(subject: Subject, control: Control, judged: Judged) -> tuple[Message, ...]:
    """Return the verdict on the text, then each machining mode that is not to be used, and why."""
    without = [
        Message("export-mode-left-out", why=_explain(subject, mode)) for mode in judged.left_out
    ]
    return (_verdict(subject, control, judged), *without)


def say_ceiling(subject: Subject, judged: Judged) -> list[Message]:
    """Return why less acceleration is written than the axis would take, where that is so."""
    ceiling = subject.kind.largest_acceleration
    if subject.limits.acceleration <= ceiling:
        return []
    before, after = subject.settling_time, judged.verdict.settling_time
    return [
        Message(
            "export-ceiling",
            wanted=1e3 * subject.limits.acceleration,
            ceiling=1e3 * ceiling,
            why=Message("ceiling-source", kind=subject.kind.key),
            before=show_value(before, "s", in_degrees=False),
            after=show_value(after, "s", in_degrees=False),
        )
    ]


def lost_letters(*names: str) -> tuple[Message, ...]:
    """Return that a name has letters that plain text for a control cannot hold."""
    lost = any(to_ascii(name).count("?") > name.count("?") for name in names)
    return (Message("export-lost-letters"),) if lost else ()


def _verdict(subject: Subject, control: Control, judged: Judged) -> Message:
    def show(value: float, unit: str) -> Message:
        return show_value(value, unit, in_degrees=control.in_degrees and subject.is_rotary)

    verdict = judged.verdict
    said = Message(
        "export-judged",
        corners=len(judged.held.tuned.corners),
        settling=show(verdict.settling_time, "s"),
        residual=show(verdict.residual_deviation, subject.length),
    )
    missed = [
        Message(
            "export-missed",
            name=check.requirement.message,
            value=show(check.value, check.unit),
            limit=show(check.limit, check.unit),
        )
        for check in verdict.assessment.checks
        if not check.is_met
    ]
    missed += [judged.lost_margins] if judged.lost_margins else []
    without = [Message("export-mode-missed", mode=name_mode(mode.name)) for mode in judged.left_out]
    if not missed and not without:
        return Message("export-all-met", judged=said)
    told = reduce(
        lambda first, then: Message("record-both", first=first, then=then), missed + without
    )
    return Message(
        "export-not-all-met" if missed else "export-incomplete", judged=said, missed=told
    )


def _corners(subject: Subject) -> Message:
    needs = subject.machine.requirements
    low, high = needs.payload
    return Message(
        "export-corners",
        frequency=needs.frequency_spread,
        damping=needs.damping_spread,
        payload="yes" if high > 0.0 else "no",
        low=low,
        high=high,
    )


def _left_out(subject: Subject, verdict: Candidate) -> list[Message]:
    """What the record's loop uses and this control lacks, and what that costs."""
    if not subject.left_out:
        return []
    before, after = subject.settling_time, verdict.settling_time
    cost = "grows" if isfinite(before) and isfinite(after) else "unknown"
    return [
        Message(
            "export-left-out",
            features=tuple(Message("export-feature", what=what) for what in subject.left_out),
            before=show_value(before, "s", in_degrees=False),
            after=show_value(after, "s", in_degrees=False),
            change=after / before - 1.0 if cost == "grows" else 0.0,
            cost=cost,
            kind=subject.kind.key,
        )
    ]


def _shaft(subject: Subject, rows: Sequence[Row]) -> list[Message]:
    """Where the values of the drive count."""
    if subject.machine.drive.follows:
        return [Message("export-no-loop")]
    if subject.shaft is None:
        return [Message("export-no-shaft")]
    own = (Setting.VELOCITY_GAIN, Setting.FORCE_FEEDFORWARD)
    at_shaft = any(row.setting in own and row.scale != 1.0 for row in rows)
    return [Message("export-shaft", travel=subject.shaft)] if at_shaft else []


def _explain(subject: Subject, mode: ModeLimitsEntry) -> Message:
    """Why a machining mode is left out, with its band and the one that could be met."""
    band, attainable = (
        None if value is None else show_value(value, subject.length, in_degrees=True)
        for value in (mode.band, mode.attainable)
    )
    name = name_mode(mode.name)
    if mode.meets_requirements:
        return Message("export-mode-fails", mode=name, band=band)
    if attainable:
        return Message("export-no-limits-but", mode=name, band=band, attainable=attainable)
    return Message("export-no-limits-within", mode=name, band=band)
