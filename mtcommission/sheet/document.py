"""What a sheet consists of: one neutral document that every printer shows.

The printers know these types and no others, so HTML and PDF cannot tell different things.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

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
    """A paragraph of plain text; never markup."""

    text: str
    tone: Tone = Tone.PLAIN


def note(text: str) -> Paragraph:
    """Return a remark in small letters."""
    return Paragraph(text=text, tone=Tone.NOTE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Bullets:
    """A list of sentences."""

    items: tuple[str, ...]
    tone: Tone = Tone.PLAIN


@dataclass(frozen=True, slots=True, kw_only=True)
class Subheading:
    """A heading inside a section."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BigValue:
    """A value to enter, printed so large that it is read from a metre."""

    label: str
    value: str
    aside: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Headline:
    """The verdict and the values to enter."""

    is_met: bool
    verdict: str
    detail: str
    values: tuple[BigValue, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Formula:
    """A formula in the field's signs, and words behind it; "_" begins an index, e.g. "T_p"."""

    text: str
    aside: str = ""


Cell = str | Formula


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column: its heading, its share of the width, and whether numbers stand flush right."""

    head: str
    width: float = 1.0
    is_number: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table; ``strong_rows`` are stressed, a form has cells to fill in by hand."""

    caption: str  # "": the heading above says it
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    strong_rows: tuple[int, ...] = ()
    is_form: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Preformatted:
    """Text to be shown as it is, in fixed width."""

    caption: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Form:
    """Lines to be filled in by hand, one label for each."""

    fields: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Line:
    """A curve; the same style is the same line style and colour in every panel."""

    label: str
    x: Array  # in the units of the axes, shape (n,)
    y: Array
    style: int
    is_stepped: bool = False  # whether the value holds until the next sample


@dataclass(frozen=True, slots=True, kw_only=True)
class Border:
    """A horizontal line at a limit."""

    label: str
    y: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Panel:
    """Curves and limits over one pair of axes."""

    y_label: str
    lines: tuple[Line, ...]
    borders: tuple[Border, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinePlot:
    """Panels below each other with one x axis; plots with the same link zoom together."""

    key: str  # unique in the document
    caption: str
    alt: str  # what it shows, for those who cannot see it
    x_label: str
    x_is_log: bool
    link: str
    panels: tuple[Panel, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagram:
    """A drawing as SVG."""

    key: str
    caption: str
    alt: str
    svg: str


Block: TypeAlias = (
    Paragraph
    | Bullets
    | Subheading
    | Headline
    | Table
    | Formula
    | Preformatted
    | Form
    | Diagram
    | LinePlot
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A part of the sheet; a page of its own, or evidence that print has only in the appendix."""

    key: str
    heading: str
    blocks: tuple[Block, ...]
    is_appendix: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Document:
    """A sheet, ready to be printed: whose it is, and its sections."""

    language: str
    title: str
    machine: str
    axis: str
    identity: str  # short line for each page: profile and its hash
    created: str  # ISO 8601
    disclaimer: str
    sections: tuple[Section, ...]

    @property
    def pages(self) -> tuple[Section, ...]:
        """The sections that one hands over, a page each."""
        return tuple(section for section in self.sections if not section.is_appendix)
