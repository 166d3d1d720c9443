"""What a sheet consists of: one neutral document that every printer shows.

The printers know these types and no others, so HTML and PDF cannot tell different things.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

from mtcommission.sheet.plot_model import Diagram, Plot

HASH_DIGITS = 12
"""Digits of the profile's hash on each page; the whole hash stands once under "Versions"."""


class Tone(Enum):
    """How a paragraph is meant."""

    PLAIN = "plain"
    NOTE = "note"
    WARNING = "warning"
    CODE = "code"


@dataclass(frozen=True, slots=True, kw_only=True)
class Paragraph:
    """A paragraph of text.

    Parameters
    ----------
    text
        Plain text; never markup.
    tone
        How it is meant.
    """

    text: str
    tone: Tone = Tone.PLAIN


@dataclass(frozen=True, slots=True, kw_only=True)
class Bullets:
    """A list of sentences.

    Parameters
    ----------
    items
        Plain texts.
    tone
        How they are meant.
    """

    items: tuple[str, ...]
    tone: Tone = Tone.PLAIN


@dataclass(frozen=True, slots=True, kw_only=True)
class Subheading:
    """A heading inside a section.

    Parameters
    ----------
    text
        Plain text.
    """

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BigValue:
    """A value to enter, printed so large that it is read from a metre.

    Parameters
    ----------
    label, value, aside
        E.g. "Acceleration", "2.4 m/s²", "a".
    """

    label: str
    value: str
    aside: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Headline:
    """The verdict and the values to enter.

    Parameters
    ----------
    is_met
        Whether all requirements are met.
    verdict, detail
        In words.
    values
        What to enter.
    """

    is_met: bool
    verdict: str
    detail: str
    values: tuple[BigValue, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column of a table.

    Parameters
    ----------
    head
        Its heading.
    width
        Share of the width; relative to the other columns.
    is_number
        Whether its cells are numbers (set flush right).
    """

    head: str
    width: float = 1.0
    is_number: bool = False


def name_and_numbers(name: str, heads: Iterable[str], *, width: float) -> tuple[Column, ...]:
    """Return a column of names and, behind it, columns of numbers.

    Parameters
    ----------
    name, width
        Of the first column.
    heads
        Of the others.

    Examples
    --------
    >>> [column.is_number for column in name_and_numbers("rule", ["a", "j"], width=1.4)]
    [False, True, True]
    """
    return (
        Column(head=name, width=width),
        *(Column(head=head, is_number=True) for head in heads),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Formula:
    """A formula in the field's signs, and words behind it; "_" begins an index, e.g. "T_p"."""

    text: str
    aside: str = ""


Cell = str | Formula


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table.

    Parameters
    ----------
    caption
        What it shows.
    columns
        Headings.
    rows
        Texts and formulas, as many as columns.
    strong_rows
        Indices of rows to stress.
    is_form
        Whether there are cells to fill in by hand, which need room.
    """

    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    strong_rows: tuple[int, ...] = ()
    is_form: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Preformatted:
    """Text to be shown as it is, in fixed width.

    Parameters
    ----------
    caption, text
        What it is, and the text.
    """

    caption: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Form:
    """Lines to be filled in by hand.

    Parameters
    ----------
    fields
        One label for each line.
    """

    fields: tuple[str, ...]


Block = (
    Paragraph
    | Bullets
    | Subheading
    | Headline
    | Table
    | Formula
    | Preformatted
    | Form
    | Diagram
    | Plot
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A part of the sheet.

    Parameters
    ----------
    key
        Identifier, unique in the document.
    heading
        Its heading.
    blocks
        What it shows, in order.
    is_appendix
        Whether it is evidence that print leaves out unless it is asked for; any other section is
        a page of its own.
    """

    key: str
    heading: str
    blocks: tuple[Block, ...]
    is_appendix: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Document:
    """A sheet, ready to be printed.

    Parameters
    ----------
    language
        Code, e.g. "en".
    title, machine, axis
        Whose sheet it is.
    identity
        Short line for each page: profile and its hash.
    created
        When the record was made (ISO 8601).
    disclaimer
        What the sheet is not.
    contents_heading, skip_link, script_note, page_word, appendix_heading
        Words of the printers' own.
    sections
        In order, those of the appendix last.
    """

    language: str
    title: str
    machine: str
    axis: str
    identity: str
    created: str
    disclaimer: str
    contents_heading: str
    skip_link: str
    script_note: str
    page_word: str
    sections: tuple[Section, ...]
    appendix_heading: str = ""

    @property
    def pages(self) -> tuple[Section, ...]:
        """The sections that one hands over, a page each."""
        return tuple(section for section in self.sections if not section.is_appendix)
