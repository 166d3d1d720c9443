"""The commissioning sheet: record -> neutral document -> HTML, PDF.

content.py    record -> document: four pages and an appendix
              (verdict, basis, responses, loop, measurements; limits, identified, appendix,
              differences)
document.py   what a document consists of
tables.py     the printing kit: a table is quantities and items
plots.py      curves in SI -> plots; figures.py draws them for print
diagram.py    the loop as a drawing (structure.svg)
html.py       document -> one offline page (page.html, page.css, page.js)
what_if.py    what a page lets one try (what_if.html, .css, .js); engine.js runs the loop
pdf.py        document -> PDF (sheet.typ)
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.message import Message

if TYPE_CHECKING:
    from mtcommission.export.write import Export
    from mtcommission.record.loop import WhatIfPart
    from mtcommission.record.machine import MachineEntry, Profile
    from mtcommission.record.read_back import Verified
    from mtcommission.record.record import Record

__all__ = ["print_answers", "print_html", "print_pdf", "remark_on_print"]


def print_html(
    record: Record,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
    typed: Export | Message | None = None,
) -> str:
    """Return the sheet as one HTML file that works offline.

    ``before``: an earlier record of the axis, to tell what changed; ``verified``: what ``verify``
    found; ``typed``: ``type_in`` of the record, where page and PDF are to share it.

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    """
    from mtcommission.sheet.content import compose
    from mtcommission.sheet.html import set_html
    from mtcommission.sheet.tables import words_for
    from mtcommission.sheet.what_if import what_if

    _require(language)
    document = compose(record, language, before=before, verified=verified, typed=typed)
    part, words = record.what_if, words_for(record.machine, language)
    panel = what_if(part, words, profile=record.profile.name) if part else None
    return set_html(document, panel=panel)


def print_answers(
    part: WhatIfPart,
    machine: MachineEntry,
    profile: Profile,
    *,
    created: str,
    language: str = "en",
) -> str:
    """Return the interactive page alone: other limits, moves and machines can be tried.

    Raises
    ------
    InputError
        If there is no such language.
    """
    from mtcommission.sheet.document import HASH_DIGITS, document
    from mtcommission.sheet.html import set_html
    from mtcommission.sheet.tables import words_for
    from mtcommission.sheet.what_if import what_if

    _require(language)
    words = words_for(machine, language)
    text = words.text
    page = document(
        words,
        skip="what-if-skip",
        title=text("what-if-title"),
        machine=machine.name,
        axis=f"{text('axis')} {machine.axis}",
        identity=text("identity", name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        created=created,
        disclaimer=text("disclaimer"),
        sections=(),
    )
    panel = what_if(part, words, profile=profile.name)
    return set_html(page, panel=panel)


def print_pdf(
    record: Record,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
    typed: Export | Message | None = None,
    appendix: bool = False,
) -> bytes:
    """Return the sheet as PDF, A4: four pages, and one for what changed; always the same bytes.

    What does not fit on its page takes another rather than smaller letters. With ``appendix`` the
    evidence is printed behind them; the other arguments are those of ``print_html``.

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    ComputationError
        PRINTING_FAILED with the compiler's message.
    """
    from mtcommission.sheet.content import compose
    from mtcommission.sheet.pdf import set_pdf

    _require(language)
    document = compose(record, language, before=before, verified=verified, typed=typed)
    if not appendix:
        document = replace(document, sections=document.pages)
    return set_pdf(document)


def remark_on_print(record: Record) -> tuple[Message, ...]:
    """Return what a PDF of a record cannot show: characters of names that its font lacks."""
    from mtcommission.sheet.pdf import find_boxes

    machine, modes = record.machine, [mode.name for mode in record.plant.modes]
    boxes = find_boxes([machine.name, machine.axis, machine.source, record.profile.name, *modes])
    return (Message("print-boxes", characters=boxes),) if boxes else ()


def _require(language: str) -> None:
    if language not in LANGUAGES:
        message = Message("option-no-language", got=language, allowed=tuple(LANGUAGES))
        raise InputError([Fault(where="--language", message=message)])
