"""What is typed in: the rows of the export, old beside new; and what is signed for."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from mtcommission.errors import ComputationError, InputError
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.messages.quantities import THIN_SPACE, pretty_unit
from mtcommission.record.schema.record import Record
from mtcommission.sheet.model import Block, Column, Form, Headline, Paragraph, Table, Tone
from mtcommission.sheet.values import say_filter
from mtcommission.sheet.verdict_part import acceleration, headline, jerk

if TYPE_CHECKING:
    from mtcommission.export.layout import Entry
    from mtcommission.export.write import Export

ELSEWHERE_MARK = ">"
"""Stands, as in the export's text, before what is set in the drive, or must be so."""

MULTIPLE = re.compile(r"\d+[.0]\d|0\.1")
"""A unit that begins with a number: what is typed counts so many."""

WHOLE = 0.99
"""Share of the recommended acceleration that is all of it, but for rounding."""

NUMBER = re.compile(r"-?\d+(\.\d+)?")


def type_in(record: Record) -> Export | Message:
    """Return the export for the record's own control, or why there is none."""
    from mtcommission.export.write import export_own

    try:
        return export_own(record)
    except InputError as error:
        return error.faults[0].message
    except ComputationError as error:
        return error.message


def entries(record: Record, typed: Export | Message, words: Catalogue) -> tuple[Block, ...]:
    """Return every parameter to type in: its name in the control, old beside new, and meaning."""
    text = words.text
    if isinstance(typed, Message):
        return (Paragraph(text=text("entry-none", why=typed), tone=Tone.WARNING),)
    has_old = any(entry.old for entry in typed.entries)
    table = Table(
        caption=text("entry-caption", jerk=record.loop.jerk, mark=ELSEWHERE_MARK),
        columns=(
            Column(head=text("parameter"), width=3.15),
            *([Column(head=text("old-value"), width=0.95, is_number=True)] if has_old else []),
            Column(head=text("new-value"), width=1.45, is_number=True),
            Column(head=text("meaning"), width=4.3),
        ),
        rows=tuple(
            (
                _name(entry),
                *([_typed(entry.old, entry, words)] if has_old else []),
                _typed(entry.value, entry, words),
                _meaning(entry, words),
            )
            for entry in typed.entries
        ),
    )
    return (table,)


def _name(entry: Entry) -> str:
    row = entry.row
    if row.is_elsewhere:
        return f"{ELSEWHERE_MARK} {row.name}"
    return f"[{row.section}] {row.name}" if row.section else row.name


def _typed(value: str, entry: Entry, words: Catalogue) -> str:
    """A number with the language's decimal mark and its unit; a word or code as it is typed."""
    if not NUMBER.fullmatch(value):
        return value
    unit = pretty_unit({"us": "µs"}.get(entry.row.unit, entry.row.unit))
    times = f"×{THIN_SPACE}" if MULTIPLE.match(unit) else ""
    return words.format.with_unit(value, times + unit).replace(".", words.format.decimal_mark)


def _meaning(entry: Entry, words: Catalogue) -> str:
    said = words.say(entry.row.text) if entry.row.text else ""
    return said if entry.row.is_verified else f"{said} (?)".strip()


def headline_as_typed(record: Record, typed: Export | Message, words: Catalogue) -> Headline:
    """Return the verdict with what the export finds of its own numbers: it speaks as one."""
    told = headline(record, words)
    if isinstance(typed, Message):
        incomplete = words.text("verdict-incomplete")
        return replace(told, is_met=False, verdict=incomplete) if told.is_met else told
    is_missed = told.is_met and not typed.is_met
    added = (*([typed.judgement] if is_missed else []), *typed.doubts)
    said = [told.detail, *map(words.say, added)]
    shown, wanted = _acceleration(record, typed, words), acceleration(record, words)
    if shown != wanted:
        first, *others = told.values
        told = replace(told, values=(replace(first, value=shown), *others))
        said.insert(0, words.text("as-typed", acceleration=shown, wanted=wanted))
    told = replace(told, detail=" ".join(said))
    if not told.is_met or typed.meets_requirements:
        return told
    verdict = words.text("verdict-missed" if is_missed else "verdict-incomplete")
    return replace(told, is_met=typed.is_met, verdict=verdict)


def _acceleration(record: Record, typed: Export | Message, words: Catalogue) -> str:
    """What is typed where that is less than what was recommended, rounding apart."""
    run = record.limits.recommended.acceleration
    if isinstance(typed, Message) or typed.limits.acceleration >= WHOLE * run:
        return acceleration(record, words)
    return words.format.axis(typed.limits.acceleration, "m/s^2")


def signature(record: Record, typed: Export | Message, words: Catalogue) -> tuple[Block, ...]:
    """Return the values that are signed for, and the lines to sign on."""
    text = words.text
    values = text(
        "signed-values",
        machine=record.machine.name,
        axis_name=record.machine.axis,
        acceleration=_acceleration(record, typed, words),
        jerk=jerk(record, words),
        filter=say_filter(record.limits.recommended.setpoint_filter, words),
    )
    return (
        Paragraph(text=values),
        Form(fields=tuple(text(f"signature-field-{i}") for i in range(1, 5))),
    )
