"""The commissioning sheet: record -> neutral document -> HTML, PDF, terminal.

content.py      record -> document: four pages and an appendix (``*_part.py``)
model.py        what a document consists of
values.py       values that have a word where there is no number
html.py         document -> one offline page (page.html, page.css, page.js)
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
from mtcommission.record.schema import Record
from mtcommission.record.verified import Verified
from mtcommission.sheet.content import compose

if TYPE_CHECKING:
    from mtcommission.sheet.terminal import Summary

__all__ = ["print_html", "print_pdf", "summarise"]


def print_html(
    record: Record,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
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

    Returns
    -------
    str

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    """
    from mtcommission.sheet.html import set_html

    _require(language)
    document = compose(record, language, before=before, verified=verified)
    return set_html(document, decimal_mark=LANGUAGES[language])


def print_pdf(
    record: Record,
    *,
    language: str = "en",
    before: Record | None = None,
    verified: Verified | None = None,
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
    appendix
        Whether the evidence is printed behind them, as the page always shows it.

    Returns
    -------
    bytes

    Raises
    ------
    InputError
        If there is no such language, or if the two records cannot be compared.
    ComputationError
        PRINTING_FAILED with the compiler's message.
    """
    from mtcommission.sheet.pdf import set_pdf

    _require(language)
    document = compose(record, language, before=before, verified=verified)
    if not appendix:
        document = replace(document, sections=document.pages)
    return set_pdf(document, decimal_mark=LANGUAGES[language])


def summarise(record: Record, *, language: str = "en") -> Summary:
    """Return the summary for the terminal, to be printed by rich.

    Parameters
    ----------
    record
        A whole commissioning.
    language
        Code of a language, e.g. "en".

    Returns
    -------
    Summary

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
