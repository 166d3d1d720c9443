"""Legends of the plots for print, and the styles of lines and marks that they explain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.sheet.canvas import INK, SIZE, Canvas, corner_points, text_width

Array = NDArray[np.float64]

WIDTH, LEFT, RIGHT = 493.2, 46.0, 8.0
"""Width of a plot on the A4 page (174 mm, so that letters keep their size), and the room beside its
axes [pt]."""

ROW = 11.0
"""Height of a row [pt]."""

SAMPLE, SPACE = 24.0, 14.0
"""Length of the line in a legend, and the space behind an entry [pt]."""

BORDER_DASHES, CURSOR = (2.0, 2.0), 0.7
"""How a limit is drawn: dashes and width [pt]."""

LINES: tuple[tuple[str, tuple[float, ...], float], ...] = (
    ("#7f7f7f", (1.4, 1.4), 1.4),
    ("#c44e00", (5.0, 1.5), 1.0),
    ("#00795c", (4.0, 1.2, 1.0, 1.2), 1.0),
    ("#7a3e9d", (7.0, 1.2, 1.0, 1.2, 1.0, 1.2), 1.0),
    ("#0b4f9e", (), 1.2),
)
"""Colour, dashes and width by style; dashes tell the lines apart in a black-and-white print."""

STAR = corner_points(5, 6.5, inner=0.4)
SYMBOLS: tuple[tuple[str, Array], ...] = (
    ("#0b4f9e", STAR),
    ("#00795c", np.array([[-2.6, -2.6], [2.6, -2.6], [2.6, 2.6], [-2.6, 2.6]])),
    ("#c44e00", corner_points(8, 2.8)),
)
"""Colour and shape by style of a mark."""

CHOSEN = "#d00000"


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """An entry of a legend: a line's style, or a mark's style.

    Parameters
    ----------
    label
        Words.
    line, mark
        Style of a line or of a mark, or -1; both -1: a limit.
    color
        Of the mark; "" for its usual one.
    """

    label: str
    line: int = -1
    mark: int = -1
    color: str = ""


def draw_mark(canvas: Canvas, style: int, place: Array, *, color: str = "") -> None:
    """Draw a mark of a style about a place, shape (2,) [pt]; with a colour of its own, edged."""
    usual, shape = SYMBOLS[style]
    canvas.area(shape + place, color=color or usual, edge=INK if color else "none")


def legend_rows(entries: list[Entry]) -> list[list[Entry]]:
    """Return the rows of a legend, each with as many entries as fit.

    Examples
    --------
    >>> entries = [Entry(label="x" * 60, line=0), Entry(label="y" * 60, line=1)]
    >>> [len(row) for row in legend_rows(entries)]
    [1, 1]
    """
    room = WIDTH - LEFT - RIGHT + SPACE
    rows: list[list[Entry]] = []
    used = room + 1.0
    for entry in entries:
        width = _entry_width(entry)
        if used + width > room:
            rows.append([])
            used = 0.0
        rows[-1].append(entry)
        used += width
    return rows


def _entry_width(entry: Entry) -> float:
    return _sample_width(entry) + 4.0 + text_width(entry.label) + SPACE


def _sample_width(entry: Entry) -> float:
    return SAMPLE / 2 if entry.mark >= 0 else SAMPLE


def draw_legend(canvas: Canvas, rows: list[list[Entry]], *, right: float) -> None:
    """Draw the rows of a legend at the top of a plot, flush right."""
    for k, row in enumerate(rows):
        place = right - sum(map(_entry_width, row)) + SPACE
        for entry in row:
            draw_entry(canvas, entry, place, (k + 1) * ROW - 3.0)
            place += _entry_width(entry)


def draw_entry(canvas: Canvas, entry: Entry, left: float, base: float) -> None:
    """Draw an entry from its left end, on its base line [pt]."""
    middle, right = base - 0.36 * SIZE, left + _sample_width(entry)
    sample = np.array([[left, middle], [right, middle]])
    if entry.mark >= 0:
        place = np.array([(left + right) / 2, middle])
        draw_mark(canvas, entry.mark, place, color=entry.color)
    elif entry.line >= 0:
        color, dashes, width = LINES[entry.line]
        canvas.line(sample, color=color, dashes=dashes, width=width)
    else:
        canvas.line(sample, dashes=BORDER_DASHES, width=CURSOR)
    canvas.text(right + 4.0, base, entry.label)
