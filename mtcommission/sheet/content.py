"""Record -> four pages and an appendix, as a neutral document -> HTML, PDF."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.record.read_back import Verified
from mtcommission.record.record import Record
from mtcommission.sheet.appendix import (
    certificates,
    machine_data,
    requirements,
    robustness,
    versions,
)
from mtcommission.sheet.document import Block, Document, Section
from mtcommission.sheet.html import set_html
from mtcommission.sheet.identified import identified
from mtcommission.sheet.limits import limits_by_mode, rule, rules
from mtcommission.sheet.loop import loop_details, third_page
from mtcommission.sheet.measurements import differences, fourth_page
from mtcommission.sheet.responses import motions, move_sizes, second_page
from mtcommission.sheet.tables import document_of, words_for
from mtcommission.sheet.verdict import first_page
from mtcommission.sheet.what_if import what_if

if TYPE_CHECKING:
    from mtcommission.record.exported import Export


APPENDIX: Mapping[str, Callable[[Record, Catalogue], Iterable[Block]]] = MappingProxyType(
    {
        "limits": limits_by_mode,
        "machine": machine_data,
        "identified": identified,
        "requirements": requirements,
        "motions": motions,
        "sizes": move_sizes,
        "robustness": robustness,
        "loop-details": loop_details,
        "rules": rules,
        "rule": rule,
        "certificates": certificates,
        "versions": versions,
    }
)
"""The evidence behind the pages: key and blocks of each section."""


def compose(
    record: Record,
    typed: Export | Message,
    language: str = "en",
    *,
    before: Record | None = None,
    verified: Verified | None = None,
) -> Document:
    """Return the sheet of a record and of its export for its own control, or why there is none.

    ``before`` is an earlier record of the axis, to tell what changed since; ``verified`` what
    ``verify`` found.

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    """
    words = words_for(record.machine, language)
    pages: dict[str, Iterable[Block]] = {
        "verdict": first_page(record, typed, words),
        "responses": second_page(record, words),
        "robustness" if record.machine.follows else "loop": third_page(record, words),
        "measurements": fourth_page(record, typed, words, verified),
    }
    if before is not None:
        pages["differences"] = differences(before, record, words)
    appendix = {key: evidence(record, words) for key, evidence in APPENDIX.items()}
    sections = [
        Section(
            key=key,
            heading=words.text(f"{key}-heading"),
            blocks=tuple(blocks),
            is_appendix=parts is appendix,
        )
        for parts in (pages, appendix)
        for key, blocks in parts.items()
    ]
    return document_of(
        words,
        record.machine,
        record.profile,
        title=words.text("title"),
        created=record.created,
        sections=tuple(section for section in sections if section.blocks),
    )


def print_html(
    record: Record,
    typed: Export | Message,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
) -> str:
    """Return the sheet as one HTML file that works offline; the arguments are ``compose``'s.

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    """
    document = compose(record, typed, language, before=before, verified=verified)
    part, words = record.what_if, words_for(record.machine, language)
    panel = what_if(part, words, profile=record.profile.name) if part else None
    return set_html(document, panel=panel)


def print_pdf(
    record: Record,
    typed: Export | Message,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
    appendix: bool = False,
) -> bytes:
    """Return the sheet as PDF, A4: four pages, and one for what changed; always the same bytes.

    What does not fit on its page takes another rather than smaller letters. With ``appendix`` the
    evidence is printed behind them; the other arguments are those of ``compose``.

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    ComputationError
        PRINTING_FAILED with the compiler's message.
    """
    from mtcommission.sheet.pdf import set_pdf  # the typesetter takes a while to load

    document = compose(record, typed, language, before=before, verified=verified)
    if not appendix:
        document = replace(document, sections=document.pages)
    return set_pdf(document)


def remark_on_print(record: Record) -> tuple[Message, ...]:
    """Return what a PDF of a record cannot show: characters of names that its font lacks."""
    from mtcommission.sheet.pdf import find_boxes

    machine, modes = record.machine, [mode.name for mode in record.plant.modes]
    boxes = find_boxes([machine.name, machine.axis, machine.source, record.profile.name, *modes])
    return (Message("print-boxes", characters=boxes),) if boxes else ()
