"""Record -> Export: rows are written, read back from their text, judged; then the header.

The sheet's first page shows the same rows.

Nothing but what stands in the text reaches the loop that is simulated for the header, so the
header cannot promise what the text does not hold.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from mtcommission.base.errors import ComputationError, InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import wrap_whole
from mtcommission.controls.control import Control, name_row
from mtcommission.controls.kinds import CONTROLS, GENERIC
from mtcommission.controls.row import Key, Row, unreadable
from mtcommission.controls.syntax import LIST, Entry, Layout, read_elsewhere
from mtcommission.controls.wording import to_ascii
from mtcommission.export.catalogue import find_control_key
from mtcommission.export.choose import fill_in
from mtcommission.export.header import (
    compose_header,
    say_ceiling,
    say_modes_left_out,
    say_verdict,
)
from mtcommission.export.held import judge_text
from mtcommission.export.subject import Subject, build_subject
from mtcommission.record.exported import Export
from mtcommission.record.record import Record

WIDTH = 96
"""Columns of the header's sentences."""


def export_own(record: Record) -> Export:
    """Return the limits and the loop of a record for the control that it was computed for.

    In neutral words where that control cannot name the axis; the doubts say so.

    Raises InputError if the loop is unstable as typed, or not the one that the profile gives.
    """
    own = CONTROLS[record.loop.kind]
    try:
        return _export(record, own)
    except InputError as refused:
        (fault, *_) = refused.faults
        try:
            found = _export(record, replace(CONTROLS[GENERIC.key], kind=own.kind))
        except InputError:
            raise refused from None
        reason = Message("export-neutral", why=fault.message)
        return replace(found, doubts=(reason, *found.doubts))


def type_in(record: Record) -> Export | Message:
    """Return the export for the record's own control, or why there is none."""
    try:
        return export_own(record)
    except InputError as error:
        return error.faults[0].message
    except ComputationError as error:
        return error.message


def export_record(
    record: Record, *, control: str, language: str = "en", as_list: bool = False
) -> Export:
    """Return the recommended limits and the loop of a record for a control.

    Raises InputError if there is no such control, it cannot take this axis, its loop is unstable,
    or not the one that the profile gives.
    """
    return _export(record, CONTROLS[find_control_key(control)], language, as_list=as_list)


def _export(
    record: Record, target: Control, language: str = "en", *, as_list: bool = False
) -> Export:
    subject = build_subject(record, target.kind)
    words, layout = words_for(subject, language), LIST if as_list else target.layout
    filled = fill_in(subject, target)
    entries = filled.entries
    lines, rows = write_body(layout, entries, words), [entry.row for entry in entries]
    values = read_text(layout, rows, "\n".join(lines), words)
    judged = judge_text(subject, values, filled.indices, known=filled.held)
    header = say_plainly(compose_header(record, subject, target, judged, rows, words), words)
    return Export(
        header=header,
        entries=entries,
        limits=judged.held.limits(),
        verdict=judged.verdict,
        is_met=judged.is_met,
        meets_requirements=judged.is_met and not judged.left_out,
        judgement=say_verdict(judged),
        doubts=(*say_modes_left_out(subject, judged), *say_ceiling(subject, judged)),
        text=compose_text(layout, header, lines),
    )


def words_for(subject: Subject, language: str) -> Catalogue:
    """Return the words for an axis of its kind."""
    follows = subject.machine.drive.follows
    return Catalogue(language, rotary=subject.is_rotary, follows=follows)


def say_plainly(said: Iterable[Message], words: Catalogue) -> tuple[str, ...]:
    """Return sentences in letters that every control reads."""
    return tuple(" ".join(to_ascii(words.say(line)).split()) for line in said)


def write_body(layout: Layout, entries: Sequence[Entry], words: Catalogue) -> list[str]:
    """Return the lines of a text without its header."""
    entries = [replace(one, row=_named(one.row, words)) for one in entries]
    if layout is LIST:
        return layout.write(entries, words)
    elsewhere = [entry for entry in entries if entry.row.is_elsewhere]
    lines = layout.write([entry for entry in entries if not entry.row.is_elsewhere], words)
    if elsewhere:
        heading = wrap_whole(to_ascii(words.text("export-set-elsewhere")), WIDTH)
        lines += ["", *map(layout.comment, heading), *layout.write_elsewhere(elsewhere, words)]
    return lines


def _named(row: Row, words: Catalogue) -> Row:
    return replace(row, name=to_ascii(name_row(row, words)))


def compose_text(layout: Layout, header: Iterable[str], body: Iterable[str]) -> str:
    """Return the file: its header as comments above the lines."""
    head = (layout.comment(line) for one in header for line in wrap_whole(one, WIDTH))
    return "\n".join([*head, "", *body]) + "\n"


def read_text(
    layout: Layout,
    rows: Sequence[Row],
    text: str,
    words: Catalogue,
    *,
    beside: Sequence[Row] = (),
) -> dict[Key, float | str]:
    """Return the settings that a text holds; ``beside``: rows that others read.

    Raises InputError if a row is missing, unknown, unreadable, or contradicts another.
    """
    rows = [_named(row, words) for row in rows]
    known = {
        (row.section, row.name): row for row in (*(_named(one, words) for one in beside), *rows)
    }
    found: set[tuple[str, str]] = set()
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
        found.add((row.section, row.name))
    for row in rows:
        if (row.section, row.name) not in found:
            raise unreadable(row.name)
    return values
