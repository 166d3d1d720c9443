"""The commissioning sheet: record -> neutral document -> HTML, PDF, terminal.

content.py      record -> document: four pages and an appendix (``*_part.py``)
model.py        what a document consists of
values.py       values that have a word where there is no number
html.py         document -> one offline page (page.html, page.css, page.js)
what_if_part.py what a page lets one try (what_if.html, .css, .js); engine.js runs the loop
figures.py      plots -> SVG for print (legend.py, axes.py, canvas.py, placement.py)
pdf.py          document -> PDF (sheet.typ)
terminal.py     record -> summary in 80 columns
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mtcommission.errors import Fault, InputError
from mtcommission.messages.languages import LANGUAGES
from mtcommission.messages.message import Message
from mtcommission.record.schema.machine import MachineEntry
from mtcommission.record.schema.record import Profile, Record
from mtcommission.record.schema.what_if import WhatIfPart
from mtcommission.record.verified import Verified
from mtcommission.sheet.entry_part import type_in

if TYPE_CHECKING:
    from mtcommission.export.write import Export
    from mtcommission.sheet.terminal import Summary

__all__ = ["print_answers", "print_html", "print_pdf", "remark_on_print", "summarise", "type_in"]


def print_html(
    record: Record,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
    typed: Export | Message | None = None,
) -> str:
    """Return the sheet as one HTML file that works offline.

    Parameters
    ----------
    record
        A whole commissioning.
    language
        Code of a language, e.g. "en".
    before
        An earlier record of the axis; then the sheet tells what changed.
    verified
        What ``verify`` found; then the sheet shows it beside what was calculated.
    typed
        ``type_in`` of the record, where page and PDF are to share it.

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    """
    from mtcommission.messages.catalogue import Catalogue
    from mtcommission.sheet.content import compose
    from mtcommission.sheet.html import set_html
    from mtcommission.sheet.what_if_part import what_if

    _require(language)
    document = compose(record, language, before=before, verified=verified, typed=typed)
    part, panel = record.what_if, None
    if part is not None:
        axis = record.machine
        words = Catalogue(language, rotary=axis.motion == "rotary", follows=axis.follows)
        panel = what_if(part, words, profile=record.profile.name)
    return set_html(document, decimal_mark=LANGUAGES[language], panel=panel)


def print_answers(
    part: WhatIfPart,
    machine: MachineEntry,
    profile: Profile,
    *,
    created: str,
    language: str = "en",
) -> str:
    """Return a page that answers for other limits, moves and machines, and shows nothing else.

    Parameters
    ----------
    part
        Loop, machine and requirements.
    machine, profile
        What the axis is called, and the profile it comes from.
    created
        Date and time, ISO 8601.
    language
        Code of a language, e.g. "en".

    Raises
    ------
    InputError
        If there is no such language.
    """
    from mtcommission.messages.catalogue import Catalogue
    from mtcommission.sheet.html import set_html
    from mtcommission.sheet.model import HASH_DIGITS, Document
    from mtcommission.sheet.what_if_part import what_if

    _require(language)
    words = Catalogue(language, rotary=machine.motion == "rotary", follows=machine.follows)
    text = words.text
    document = Document(
        language=language,
        title=text("what-if-title"),
        machine=machine.name,
        axis=f"{text('axis')} {machine.axis}",
        identity=text("identity", name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        created=created,
        disclaimer=text("disclaimer"),
        contents_heading=text("contents"),
        skip_link=text("what-if-skip"),
        script_note="",
        page_word=text("page"),
        sections=(),
    )
    panel = what_if(part, words, profile=profile.name)
    return set_html(document, decimal_mark=LANGUAGES[language], panel=panel)


def print_pdf(
    record: Record,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
    typed: Export | Message | None = None,
    appendix: bool = False,
) -> bytes:
    """Return the sheet as PDF, A4; the same record always gives the same bytes.

    Four pages that one hands over, and one more for what changed. What does not fit on its page
    takes another rather than smaller letters.

    Parameters
    ----------
    record
        A whole commissioning.
    language
        Code of a language, e.g. "en".
    before
        An earlier record of the axis; then the sheet tells what changed.
    verified
        What ``verify`` found; then the sheet shows it beside what was calculated.
    typed
        ``type_in`` of the record, where page and PDF are to share it.
    appendix
        Whether the evidence is printed behind them, as the page always shows it.

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
    return set_pdf(document, decimal_mark=LANGUAGES[language])


def remark_on_print(record: Record) -> tuple[Message, ...]:
    """Return what a PDF of a record cannot show: characters of names that its font lacks."""
    from mtcommission.sheet.pdf import find_boxes

    machine, modes = record.machine, [mode.name for mode in record.plant.modes]
    boxes = find_boxes([machine.name, machine.axis, machine.source, record.profile.name, *modes])
    return (Message("print-boxes", characters=boxes),) if boxes else ()


def summarise(record: Record, *, language: str = "en") -> Summary:
    """Return the summary for the terminal, to be printed by rich.

    Parameters
    ----------
    record
        A whole commissioning.
    language
        Code of a language, e.g. "en".

    Raises
    ------
    InputError
        If there is no such language.
    """
    from mtcommission.sheet.terminal import Summary

    _require(language)
    return Summary(record=record, language=language)


def _require(language: str) -> None:
    if language not in LANGUAGES:
        message = Message("option-no-language", got=language, allowed=tuple(LANGUAGES))
        raise InputError([Fault(where="--language", message=message)])
