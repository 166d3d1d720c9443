"""Record -> the neutral document that all printers show."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.schema.record import Record
from mtcommission.record.verified import Verified
from mtcommission.sheet.basis_part import basis_rows, data_rows, holds_rows
from mtcommission.sheet.comparison_part import comparisons
from mtcommission.sheet.difference_part import differences
from mtcommission.sheet.entry_part import entries, headline_as_typed, signature, type_in
from mtcommission.sheet.evidence_part import certificates, versions
from mtcommission.sheet.identified_part import identified
from mtcommission.sheet.limits_part import (
    attainable_table,
    landscape,
    machining_modes,
    rules,
)
from mtcommission.sheet.loop_part import loop_blocks, loop_details
from mtcommission.sheet.machine_part import machine_data, requirements
from mtcommission.sheet.measure_part import measurement_blocks
from mtcommission.sheet.model import (
    HASH_DIGITS,
    Column,
    Document,
    Paragraph,
    Section,
    Subheading,
    Table,
    Tone,
)
from mtcommission.sheet.motion_part import motions
from mtcommission.sheet.responses_part import response_blocks
from mtcommission.sheet.robustness_part import held_range, robustness
from mtcommission.sheet.rule_part import rule
from mtcommission.sheet.sizes_part import move_sizes
from mtcommission.sheet.verdict_part import (
    checks_table,
    judged_during,
    warnings_told,
)

if TYPE_CHECKING:
    from mtcommission.export.write import Export


def compose(
    record: Record,
    language: str = "en",
    *,
    before: Record | None = None,
    verified: Verified | None = None,
    typed: Export | Message | None = None,
) -> Document:
    """Return the sheet of a record.

    Parameters
    ----------
    record
        A whole commissioning.
    language
        Code, e.g. "en".
    before
        An earlier record of the axis, to tell what changed since.
    verified
        What ``verify`` found about this record.
    typed
        Its ``type_in``, where that is known already.

    Raises
    ------
    InputError
        If the two records cannot be compared.
    """
    axis = record.machine
    words = Catalogue(language, rotary=axis.motion == "rotary", follows=axis.follows)
    text = words.text
    profile = record.profile
    typed = type_in(record) if typed is None else typed
    changes = () if before is None else (differences(before, record, words),)
    return Document(
        language=language,
        title=text("title"),
        machine=record.machine.name,
        axis=f"{text('axis')} {record.machine.axis}",
        identity=text("identity", name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        created=record.created,
        disclaimer=text("disclaimer"),
        contents_heading=text("contents"),
        skip_link=text("skip"),
        script_note=text("script-note"),
        page_word=text("page"),
        sections=(
            _values(record, typed, words),
            _responses(record, words),
            _loop(record, words),
            _measurements(record, typed, words, verified),
            *changes,
            *_appendix(record, words),
        ),
        appendix_heading=text("appendix"),
    )


def _values(record: Record, typed: Export | Message, words: Catalogue) -> Section:
    """Page 1: verdict, what to enter, for what it holds, on what it rests."""
    text = words.text

    def told(caption: str, rows: tuple[tuple[str, str], ...]) -> Table:
        columns = Column(head=text("basis")), Column(head=text("value"), width=5.0)
        return Table(caption=text(caption), columns=columns, rows=rows)

    return Section(
        key="verdict",
        heading=text("verdict-heading"),
        blocks=(
            headline_as_typed(record, typed, words),
            *warnings_told(record, words),
            *entries(record, typed, words),
            checks_table(record.assessment.checks, words),
            Paragraph(text=judged_during(record, words), tone=Tone.NOTE),
            told("holds-caption", holds_rows(record, words)),
            told("basis-caption", (*basis_rows(record, words), *data_rows(record, words))),
        ),
    )


def _responses(record: Record, words: Catalogue) -> Section:
    """Page 2: what setpoint, tool and force do; over sizes; the optimum; what would bring more."""
    heading = words.text("responses-heading")
    return Section(key="responses", heading=heading, blocks=response_blocks(record, words))


def _loop(record: Record, words: Catalogue) -> Section:
    """Page 3: frequency response with margins, filters and measured points; stiffness.

    Where the motor follows there is no loop: what counts is how far the frequency may be off.
    """
    if record.machine.follows:
        heading = words.text("robustness-heading")
        blocks = (*loop_blocks(record, words), *held_range(record, words))
        return Section(key="robustness", heading=heading, blocks=blocks)
    heading = words.text("loop-heading")
    return Section(key="loop", heading=heading, blocks=loop_blocks(record, words))


def _measurements(
    record: Record, typed: Export | Message, words: Catalogue, verified: Verified | None
) -> Section:
    """Page 4: what to measure at the machine, with fields; signature."""
    text = words.text
    blocks = (
        *measurement_blocks(record, words, verified),
        Subheading(text=text("signature-heading")),
        *signature(record, typed, words),
    )
    return Section(key="measurements", heading=text("measure-heading"), blocks=blocks)


def _appendix(record: Record, words: Catalogue) -> tuple[Section, ...]:
    """Return the evidence: data, assumptions, studies, certificates, settings, profile."""
    text = words.text
    return (
        Section(
            key="limits",
            heading=text("limits-heading"),
            blocks=(machining_modes(record, words), *attainable_table(record, words)),
            is_appendix=True,
        ),
        machine_data(record, words),
        *identified(record, words),
        requirements(record, words),
        motions(record, words),
        *move_sizes(record, words),
        robustness(record, words),
        loop_details(record, words),
        rules(record, words),
        rule(record, words),
        landscape(record, words),
        comparisons(record, words),
        certificates(record, words),
        versions(record, words),
    )
