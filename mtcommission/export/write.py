"""Record -> Export: the verb, the header that every export carries, and the parameter list."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from io import StringIO

from mtcommission.export.catalogue import CONTROL_TITLES, find_control_key
from mtcommission.export.control import DOUBT, UNVERIFIED, Block, Control
from mtcommission.export.gains import round_gains
from mtcommission.export.modes import Values, type_modes
from mtcommission.export.numeric import NUMERIC_CONTROLS
from mtcommission.export.open_source import OPEN_CONTROLS
from mtcommission.export.plc import PLC_CONTROLS
from mtcommission.export.rounding import type_limits
from mtcommission.export.subject import Subject, build_subject, with_gains
from mtcommission.export.wording import show_value
from mtcommission.messages.catalogue import Catalogue
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
    """

    control: str
    header: tuple[str, ...]
    blocks: tuple[Block, ...]
    limits: MotionLimits
    meets_requirements: bool
    text: str


def export_record(record: Record, *, control: str) -> Export:
    """Return the recommended limits of a record for a control.

    Parameters
    ----------
    record
        Of a run.
    control
        One of ``control_keys()``.

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
        Block(title="", entries=target.describe(subject, values)),
        *target.alternatives(subject, values),
    )
    header = _header(subject, target, values)
    return Export(
        control=target.key,
        header=header,
        blocks=blocks,
        limits=values.recommended.limits,
        meets_requirements=values.meets_requirements,
        text=_write(target, header, blocks),
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
            section = " / ".join(part for part in (block.title, entry.section) if part)
            doubt = "read in the maker's text" if entry.is_verified else f"{DOUBT} {UNVERIFIED}"
            writer.writerow(
                (section, entry.name, entry.unit, "", entry.value, "", "", entry.meaning, doubt)
            )
    return stream.getvalue()


def _header(subject: Subject, control: Control, values: Values) -> tuple[str, ...]:
    record = subject.record
    profile = record.profile
    sentences = [
        f"{record.machine.name}, axis {record.machine.axis}: limits for "
        f"{CONTROL_TITLES[control.key]}",
        f"Computed {record.created} by {record.tool.name} {record.tool.version} "
        f"from {profile.name}",
        f"Profile SHA-256 {profile.sha256}",
        "VERIFY BEFORE USE. Calculated, not measured: not an acceptance test (ISO 230). Enter by "
        "hand, note the old values, try at reduced override.",
        _verdict(subject, control, values),
        "Each limit is rounded to the safe side. Units stand beside the values.",
        *control.notes(subject, values),
    ]
    average = subject.machine.control.moving_average_time
    if average > 0.0:
        sentences.append(
            f"These limits go with a moving-average setpoint filter of {1e3 * average:.4g} ms in "
            "the control (the profile's setpoint_filter); without it they are not valid."
        )
    sentences += _doubts(record, Catalogue(rotary=subject.is_rotary))
    sentences.append(f"{DOUBT} means: name or unit not verified, {UNVERIFIED}.")
    return tuple(_one_line(sentence) for sentence in sentences)


def _doubts(record: Record, words: Catalogue) -> list[str]:
    """What the run warned of, and the data that nobody measured."""
    found = [f"WARNING: {words.say(warning)}" for warning in record.warnings]
    unmeasured = [item.key for item in record.data if item.source == ACCEPTED_DEFAULT]
    if unmeasured:
        found.append(f"Default accepted, not measured: {', '.join(unmeasured)}.")
    return found


def _verdict(subject: Subject, control: Control, values: Values) -> str:
    def show(value: float, unit: str) -> str:
        return show_value(value, unit, in_degrees=control.in_degrees and subject.is_rotary)

    verdict = values.recommended.verdict
    count = len(subject.tuned.corners)
    place = "the nominal machine" if count == 1 else f"{count} corners"
    gains = " and these gains" if control.gains.velocity else " and this Kv"
    judged = (
        f"Simulated with exactly these limits{gains if control.gains.position else ''} in {place}: "
        f"settling time {show(verdict.settling_time, 's')}, residual deviation "
        f"{show(verdict.residual_deviation, subject.length)} (recommended limits: "
        f"{show(subject.settling_time, 's')})"
    )
    missed = [
        f"{check.name} {show(check.value, check.unit)}, allowed {show(check.limit, check.unit)}"
        for check in verdict.assessment.checks
        if not check.is_met
    ]
    missed += [f"no limits for machining mode {mode.name}" for mode in values.left_out]
    if not missed:
        return f"{judged}; all requirements met."
    return f"{judged}; REQUIREMENTS NOT MET: {'; '.join(missed)}."


def _one_line(text: str) -> str:
    """User's texts stay in their comment: no line break gets through."""
    return " ".join(text.split())


def _write(control: Control, header: tuple[str, ...], blocks: tuple[Block, ...]) -> str:
    lines = [control.comment(line) for sentence in header for line in wrap_whole(sentence, WIDTH)]
    for block in blocks:
        lines.append("")
        if not block.title:
            lines += control.layout(block.entries)
            continue
        inside = [
            block.title.upper(),
            *(line for note in block.notes for line in wrap_whole(note, WIDTH)),
        ]
        lines += [control.comment(line) for line in inside]
        if block.entries:
            # An alternative must not act by accident when the file is read in as it stands.
            lines += [control.comment(line) for line in control.layout(block.entries)]
    return "\n".join(lines) + "\n"
