"""Record -> Export: rows are written, read back from their text, judged; then the header.

The sheet's first page shows the same rows.

Nothing but what stands in the text reaches the loop that is simulated for the header, so the
header cannot promise what the text does not hold.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import wrap_whole
from mtcommission.controls.control import Control, complete
from mtcommission.controls.kinds import CONTROLS, GENERIC
from mtcommission.controls.row import Key, Row, Setting, Values, unreadable
from mtcommission.controls.syntax import LIST, Entry, Layout, read_elsewhere
from mtcommission.controls.wording import to_ascii
from mtcommission.export.catalogue import find_control_key
from mtcommission.export.choose import Chosen, choose_limits, take
from mtcommission.export.header import (
    WIDTH,
    Judged,
    compose_header,
    find_lost_margins,
    say_ceiling,
    say_judgement,
)
from mtcommission.export.held import (
    NOT_OF_A_SETPOINT,
    Held,
    hold,
    loop_of,
    today_of,
    without_loop,
    write_filter,
)
from mtcommission.export.subject import Subject, build_subject, for_mode
from mtcommission.limits.judge import Candidate
from mtcommission.record.limits import ModeLimitsEntry
from mtcommission.record.record import Record
from mtcommission.setpoint.motion_limits import MotionLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """Limits and loop in a control's own words."""

    control: str
    header: tuple[str, ...]  # sentences above the parameters
    entries: tuple[Entry, ...]  # every row, those that are only remarks last
    limits: MotionLimits  # what the control makes of the typed numbers
    verdict: Candidate  # of the simulation of what the text holds
    is_met: bool  # whether it keeps all requirements in every corner, and the record's margins
    meets_requirements: bool  # whether, moreover, no machining mode had to be left out
    judgement: Message  # what the header says of that
    doubts: tuple[Message, ...]  # what it says of modes left out, a ceiling, and neutral words
    text: str  # the file


def export_own(record: Record) -> Export:
    """Return the limits and the loop of a record for the control that it was computed for.

    In neutral words where that control cannot name the axis; the doubts say so.

    Raises
    ------
    InputError
        If the loop is unstable as typed, or the record does not belong to its own profile.
    """
    own = CONTROLS[record.loop.kind]
    try:
        return _export(record, own)
    except InputError as refused:
        (fault, *_) = refused.faults
        try:
            neutral = replace(CONTROLS[GENERIC.key], kind=own.kind)
            found = _export(record, neutral)
        except InputError:
            raise refused from None
        reason = Message("export-neutral", why=fault.message)
        return replace(found, doubts=(reason, *found.doubts))


def export_record(
    record: Record, *, control: str, language: str = "en", as_list: bool = False
) -> Export:
    """Return the recommended limits and the loop of a record for a control.

    Raises
    ------
    InputError
        If there is no such control, it cannot take this axis, its loop is unstable, or the record
        does not belong to its own profile.
    """
    return _export(record, CONTROLS[find_control_key(control)], language, as_list=as_list)


def _export(
    record: Record, target: Control, language: str = "en", *, as_list: bool = False
) -> Export:
    subject = build_subject(record, target.kind)
    words = words_for([subject], language)
    layout = LIST if as_list else target.layout
    entries, indices = fill_in(subject, target)
    lines = write_body(layout, entries, words)
    written = tuple(entry.row for entry in entries)
    judged = judge_text(subject, read_text(layout, written, "\n".join(lines)), indices)
    head = write_head(
        layout, compose_header(record, subject, target, judged, written, words), words
    )
    judgement, *without = say_judgement(subject, target, judged)
    without += say_ceiling(subject, judged)
    return Export(
        control=target.key,
        header=head.sentences,
        entries=entries,
        limits=judged.held.limits(),
        verdict=judged.verdict,
        is_met=judged.is_met,
        meets_requirements=judged.is_met and not judged.left_out,
        judgement=judgement,
        doubts=tuple(without),
        text="\n".join([*head.lines, "", *lines]) + "\n",
    )


def words_for(subjects: Sequence[Subject], language: str) -> Catalogue:
    """Return the words for axes of one kind."""
    subject = subjects[0]
    follows = subject.machine.drive.follows
    return Catalogue(language, rotary=subject.is_rotary, follows=follows)


def fill_in(subject: Subject, target: Control) -> tuple[tuple[Entry, ...], set[str]]:
    """Return every row with what is typed in, and the machining modes that the control has."""
    loop = loop_of(subject)
    own = list(target.rows(subject.axis, loop))
    if subject.machine.drive.follows:
        loop = without_loop(loop)
        own = [row for row in own if row.setting not in NOT_OF_A_SETPOINT]
    rows = complete(own, loop, subject.machine.axis_units)
    return _choose(subject, target, rows, loop), {row.index for row in rows}


def judge_text(subject: Subject, values: Values, indices: Collection[str] = ()) -> Judged:
    """Return what the settings that a text holds do to its axis.

    ``indices``: of the control's machining modes.

    Raises
    ------
    InputError
        If a setting is missing, contradicts another, or the loop is unstable.
    """
    record, held = subject.record, hold(subject, values)
    kept = [mode for mode in record.limits.modes if _holds(held.values, mode.name)]
    verdict = held.judge(held.machine, held.limits())
    by_mode = [held.judge(for_mode(held.machine, mode), held.limits(mode.name)) for mode in kept]
    lost = find_lost_margins(record, held)
    met = all(found.assessment.is_met for found in (verdict, *by_mode))
    return Judged(
        held=held,
        verdict=verdict,
        left_out=tuple(
            mode for mode in record.limits.modes if mode not in kept and mode.name in indices
        ),
        lost_margins=lost,
        is_met=met and not lost,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Head:
    """The comment above a text."""

    sentences: tuple[str, ...]
    lines: list[str]


def write_head(layout: Layout, said: Iterable[Message], words: Catalogue) -> Head:
    """Return sentences as a comment, in letters that every control reads."""
    sentences = tuple(" ".join(to_ascii(words.say(line)).split()) for line in said)
    lines = [layout.comment(line) for one in sentences for line in wrap_whole(one, WIDTH)]
    return Head(sentences=sentences, lines=lines)


def read_text(
    layout: Layout, rows: Sequence[Row], text: str, *, beside: Sequence[Row] = ()
) -> dict[Key, float | str]:
    """Return the settings that a text holds; ``beside``: rows that others read.

    Raises
    ------
    InputError
        If a row is missing, unknown, unreadable, or contradicts another.
    """
    known = {(row.section, row.name): row for row in (*beside, *rows)}
    found: dict[str, Row] = {}
    values: dict[Key, float | str] = {}
    for section, name, typed in (*layout.read(text), *read_elsewhere(text)):
        row = known.get((section, name)) or known.get(("", name))
        if row is None:
            raise unreadable(name)
        if row not in rows:
            continue
        value = row.decode(typed)
        if values.setdefault(row.key, value) != value:
            raise unreadable(f"{name} {typed}")
        found[f"{row.section}/{name}"] = row
    for row in rows:
        if f"{row.section}/{row.name}" not in found:
            raise unreadable(row.name)
    return values


def _choose(
    subject: Subject, target: Control, rows: Sequence[Row], loop: Values
) -> tuple[Entry, ...]:
    """Every row with what is typed in, those that are only remarks last."""
    held = hold(subject, take((row for row in rows if row.key in loop), loop))
    values = dict(loop)
    for mode in (None, *subject.record.limits.modes):
        chosen = _choose_limits(subject, target, held, rows, mode)
        values |= chosen.values if chosen else {}
    old = today_of(subject, subject.fastest)
    entries = []
    for row in rows:
        if row.setting is Setting.FIXED:
            entries.append(Entry(row=row, value=row.encode("set")))
        elif row.key in values:
            before = old.get(row.key)
            known = before is not None and row.takes(before)
            entries.append(
                Entry(
                    row=row,
                    value=row.encode(values[row.key]),
                    old=row.encode(before) if known and before is not None else "",
                )
            )
    return tuple(sorted(entries, key=lambda entry: entry.row.is_elsewhere))


def _choose_limits(
    subject: Subject, target: Control, held: Held, rows: Sequence[Row], mode: ModeLimitsEntry | None
) -> Chosen | None:
    """The limits of a machining mode, or of the recommendation; None where the mode has none."""
    if mode is None:
        shared = {Setting.SHAPER, Setting.SHAPER_FREQUENCY, Setting.SHAPER_DAMPING, Setting.RAPID}
        own = [row for row in rows if row.key not in held.values and row.index == ""]
        own = [row for row in own if row.setting in LIMITS | shared]
        proposed = () if subject.setpoint_filter else subject.shapers(target.shapers)
        return choose_limits(subject, held, own, shapers=[write_filter(one) for one in proposed])
    own = [row for row in rows if row.setting in LIMITS and row.index == mode.name]
    if not own or not mode.meets_requirements:
        return None
    found = choose_limits(subject, held, own, mode=mode)
    return found if found.verdict.assessment.is_met else None


LIMITS = {Setting.ACCELERATION, Setting.RISE_TIME, Setting.JERK, Setting.JERK_TIME}
"""Settings that are chosen anew for each machining mode."""


def _holds(values: Values, mode: str) -> bool:
    return any(setting in LIMITS and index == mode for setting, index in values)


def write_body(layout: Layout, entries: Sequence[Entry], words: Catalogue) -> list[str]:
    """Return the lines of a text without its header."""
    if layout is LIST:
        return layout.write(entries, words)
    elsewhere = [entry for entry in entries if entry.row.is_elsewhere]
    lines = layout.write([entry for entry in entries if not entry.row.is_elsewhere], words)
    if elsewhere:
        heading = wrap_whole(to_ascii(words.text("export-set-elsewhere")), WIDTH)
        lines += ["", *map(layout.comment, heading), *layout.write_elsewhere(elsewhere, words)]
    return lines
