"""Record -> Export: the verb, the header that every export carries, and the parameter list."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from io import StringIO

from mtcommission.export.catalogue import find_control_key, name_control
from mtcommission.export.control import Block, Control, say_meaning
from mtcommission.export.gains import round_gains
from mtcommission.export.modes import Values, type_modes
from mtcommission.export.numeric import NUMERIC_CONTROLS
from mtcommission.export.open_source import OPEN_CONTROLS
from mtcommission.export.plc import PLC_CONTROLS
from mtcommission.export.rounding import type_limits
from mtcommission.export.subject import Subject, build_subject, with_gains
from mtcommission.export.wording import name_mode, show_value, to_ascii
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.data import ACCEPTED_DEFAULT
from mtcommission.record.schema import Record
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.units.quantities import wrap_whole

CONTROLS: Mapping[str, Control] = {
    control.key: control for control in (*NUMERIC_CONTROLS, *PLC_CONTROLS, *OPEN_CONTROLS)
}

WIDTH = 96
"""Columns of the header's sentences."""

COLUMNS = (
    "section", "parameter", "unit", "old_value", "new_value", "entered", "verified", "meaning",
    "name_and_unit",
)  # fmt: skip
"""Of the parameter list; three of them are left empty for the engineer."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """Limits in a control's own words.

    Parameters
    ----------
    control
        Which control.
    header
        Sentences that stand above the parameters.
    blocks
        The recommendation first, then alternatives.
    limits
        What the control makes of the typed numbers [SI].
    meets_requirements
        Whether exactly these numbers meet all requirements in every corner, and none had to be
        left out.
    text
        The file.
    words
        The language that it speaks.
    """

    control: str
    header: tuple[str, ...]
    blocks: tuple[Block, ...]
    limits: MotionLimits
    meets_requirements: bool
    text: str
    words: Catalogue


def export_record(record: Record, *, control: str, language: str = "en") -> Export:
    """Return the recommended limits of a record for a control.

    Parameters
    ----------
    record
        Of a run.
    control
        One of ``control_keys()``.
    language
        Of header, remarks and notes.

    Returns
    -------
    Export

    Raises
    ------
    InputError
        If there is no such control, it cannot take this axis, or the record does not belong to
        its own profile.
    """
    target = CONTROLS[find_control_key(control)]
    subject = build_subject(record)
    if target.gains.position:
        subject = with_gains(subject, round_gains(subject, target.gains))
    coding = target.coding(subject)
    values = Values(
        recommended=type_limits(subject, coding),
        modes=type_modes(subject, coding) if target.has_modes else (),
    )
    blocks = (
        Block(title=None, entries=target.describe(subject, values)),
        *target.alternatives(subject, values),
    )
    words = Catalogue(language, rotary=subject.is_rotary)
    header = tuple(_one_line(words.say(line)) for line in _header(subject, target, values, words))
    return Export(
        control=target.key,
        header=header,
        blocks=blocks,
        limits=values.recommended.limits,
        meets_requirements=values.meets_requirements,
        text=_write(target, header, blocks, words),
        words=words,
    )


def parameter_list(export: Export) -> str:
    """Return an export as CSV with room for old value, entered and verified.

    Parameters
    ----------
    export
        From ``export_record``.

    Returns
    -------
    str
        Header lines begin with ``#``; then one row for each parameter.
    """
    stream = StringIO()
    for sentence in export.header:
        stream.write(f"# {sentence}\n")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for block in export.blocks:
        for entry in block.entries:
            title = export.words.say(block.title) if block.title else ""
            section = " / ".join(part for part in (title, entry.section) if part)
            doubt = export.words.text("export-verified" if entry.is_verified else "export-doubted")
            writer.writerow(
                (
                    section,
                    entry.name,
                    entry.unit,
                    "",
                    entry.value,
                    "",
                    "",
                    say_meaning(entry, export.words),
                    doubt,
                )
            )
    return stream.getvalue()


def _header(subject: Subject, control: Control, values: Values, words: Catalogue) -> list[Message]:
    record = subject.record
    machine, profile, tool = record.machine, record.profile, record.tool
    sentences = [
        Message(
            "export-title",
            name=machine.name,
            axis_name=machine.axis,
            control=name_control(control.key),
        ),
        Message(
            "export-computed",
            created=record.created,
            tool=f"{tool.name} {tool.version}",
            profile=profile.name,
        ),
        Message("export-hash", hash=profile.sha256),
        Message("export-verify"),
        _verdict(subject, control, values),
        Message("export-safe-side"),
        *control.notes(subject, values),
    ]
    average = subject.machine.control.moving_average_time
    if average > 0.0:
        sentences.append(Message("export-moving-average", time=average))
    sentences += _doubts(record, words)
    sentences.append(Message("export-doubt"))
    return sentences


def _doubts(record: Record, words: Catalogue) -> list[Message]:
    """What the run warned of, and the data that nobody measured."""
    found = [
        Message("export-warning", warning=to_ascii(words.say(warning)))
        for warning in record.warnings
    ]
    unmeasured = tuple(item.key for item in record.data if item.source == ACCEPTED_DEFAULT)
    if unmeasured:
        found.append(Message("export-not-measured", keys=unmeasured))
    return found


def _verdict(subject: Subject, control: Control, values: Values) -> Message:
    def show(value: float, unit: str) -> str | Message:
        return show_value(value, unit, in_degrees=control.in_degrees and subject.is_rotary)

    verdict = values.recommended.verdict
    judged = Message(
        "export-judged",
        gains="none" if not control.gains.position else "all" if control.gains.velocity else "Kv",
        corners=len(subject.tuned.corners),
        settling=show(verdict.settling_time, "s"),
        residual=show(verdict.residual_deviation, subject.length),
        recommended=show(subject.settling_time, "s"),
    )
    missed = [
        Message(
            "export-missed",
            name=check.name,
            value=show(check.value, check.unit),
            limit=show(check.limit, check.unit),
        )
        for check in verdict.assessment.checks
        if not check.is_met
    ]
    missed += [Message("export-mode-missed", mode=name_mode(mode.name)) for mode in values.left_out]
    if not missed:
        return Message("export-all-met", judged=judged)
    told = reduce(lambda first, then: Message("record-both", first=first, then=then), missed)
    return Message("export-not-all-met", judged=judged, missed=told)


def _one_line(text: str) -> str:
    """User's texts stay in their comment: no line break gets through."""
    return " ".join(text.split())


def _write(
    control: Control, header: tuple[str, ...], blocks: tuple[Block, ...], words: Catalogue
) -> str:
    lines = [control.comment(line) for sentence in header for line in wrap_whole(sentence, WIDTH)]
    for block in blocks:
        lines.append("")
        if not block.title:
            lines += control.layout(block.entries, words)
            continue
        inside = [
            words.say(block.title).upper(),
            *(line for note in block.notes for line in wrap_whole(words.say(note), WIDTH)),
        ]
        lines += [control.comment(line) for line in inside]
        if block.entries:
            # An alternative must not act by accident when the file is read in as it stands.
            lines += [control.comment(line) for line in control.layout(block.entries, words)]
    return "\n".join(lines) + "\n"
