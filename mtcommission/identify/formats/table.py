"""Lines of text -> a table of numbers: separators, decimal marks and headers as they come.

Commas, semicolons, tabs or blanks; decimal point or comma; names, and perhaps units in a line of
their own, above the numbers.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mtcommission.identify.formats.contents import Lines, refuse
from mtcommission.identify.measurement import Array

COMMENT_MARKS = "#%!"
MOST_COLUMNS = 400
SAMPLE = 40
"""Lines from which separator and decimal mark are found."""

LAST_LINE = "eof"
_END_QUOTES = "\"' \t"
_BLANK_HEAD = re.compile(r"[^\s\[(]+(?:\s*(?:\[[^\]]*\]|\([^)]*\)))?")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?|[+-]?(?:nan|inf)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Dialect:
    """How numbers are written."""

    separator: str  # Between cells; "" for blanks
    decimal: str  # Point or comma


DIALECTS = (
    Dialect("\t", "."), Dialect("\t", ","), Dialect(";", "."), Dialect(";", ","),
    Dialect(",", "."), Dialect("", "."), Dialect("", ","), Dialect(",", ","),
)  # fmt: skip
"""Tried in this order; the last has its numbers in quotes."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Table:
    """Numbers with their heads."""

    # Name of each column with its unit, as in the file; "" where there is none.
    heads: tuple[str, ...]
    values: Array  # Shape (n_rows, n_columns), finite
    lines: Lines  # Line of each row in the file, shape (n_rows,)
    comments: tuple[str, ...]  # Lines before the numbers that are neither heads nor numbers
    breaks: tuple[int, ...]  # Rows before which a line stood that says that samples were lost
    cut_line: int  # Line of an incomplete last row, which was left out; 0 where it was whole


def split(line: str, dialect: Dialect) -> list[str]:
    """Return the cells of a line, without quotes; an empty last one is none.

    Examples
    --------
    >>> split('"t [s]"; F ;', Dialect(";", "."))
    ['t [s]', 'F']
    """
    if not dialect.separator:
        return line.split()
    quoted = '"' in line
    cells = next(csv.reader([line], delimiter=dialect.separator)) if quoted else None
    cells = cells if cells is not None else line.split(dialect.separator)
    cells = [cell.strip(_END_QUOTES) for cell in cells]
    return cells[:-1] if cells and not cells[-1] else cells


def number(cell: str, dialect: Dialect) -> float | None:
    """Return the number in a cell; None if it has none.

    Examples
    --------
    >>> number("-1,5E3", Dialect(";", ","))
    -1500.0
    """
    if dialect.decimal == ",":
        if "." in cell:
            return None
        cell = cell.replace(",", ".")
    if not _NUMBER.fullmatch(cell):
        return None
    return float(cell.lower().replace("d", "e"))


def find_dialect(lines: Sequence[str], *, where: str) -> Dialect:
    """Return how the numbers of some lines are written.

    Raise InputError where no two columns of numbers are there in any way.
    """
    filled = [line for line in lines if line.strip() and line.lstrip()[0] not in COMMENT_MARKS]
    sample = filled[-SAMPLE - 1 : -1] or filled  # the last may be cut
    if len(filled) > 2 * SAMPLE:
        middle = len(filled) // 2
        sample = filled[middle : middle + SAMPLE]
    best, most = None, 0
    for dialect in DIALECTS:
        good = 0
        for line in sample:
            cells = split(line, dialect)
            if len(cells) > 1 and all(number(cell, dialect) is not None for cell in cells):
                good += 1
        if good > most:
            best, most = dialect, good
    if best is None or most < (len(sample) + 1) // 2:
        raise refuse(where, "identify-no-table", lines=len(lines), first=_excerpt(filled))
    return best


def _excerpt(lines: Sequence[str]) -> str:
    shown = lines[0].strip()[:60] if lines else ""
    return "".join(letter if letter.isprintable() else "?" for letter in shown)


def read_table(lines: Sequence[str], *, where: str, first_line: int = 1) -> Table:
    """Return the table of numbers in some lines.

    Raise InputError with the line of what is no number, not finite or of another length.
    """
    dialect = find_dialect(lines, where=where)
    start = _first_row(lines, dialect)
    width = len(split(lines[start], dialect))
    if width > MOST_COLUMNS:
        message = "identify-too-many-columns"
        raise refuse(where, message, line=first_line + start, got=width, most=MOST_COLUMNS)
    kept, places, breaks = _data_lines(lines, start)
    cut_line = 0
    if len(kept) > 1 and _is_cut(kept[-1], dialect, width):
        cut_line = first_line + places[-1]
        kept, places = kept[:-1], places[:-1]
    at = first_line + np.asarray(places, dtype=np.int64)
    values = _numbers(kept, dialect, width, at, where=where)
    heads, comments = _heads(lines[:start], dialect, width)
    return Table(
        heads=heads,
        values=values,
        lines=at,
        comments=comments,
        breaks=tuple(breaks),
        cut_line=cut_line,
    )


def _first_row(lines: Sequence[str], dialect: Dialect) -> int:
    """The first line with two numbers or more and nothing else."""
    for place, line in enumerate(lines):
        cells = split(line, dialect)
        if len(cells) > 1 and all(number(cell, dialect) is not None for cell in cells):
            return place
    raise AssertionError("find_dialect has seen such a line")


def _data_lines(lines: Sequence[str], start: int) -> tuple[list[str], list[int], list[int]]:
    """Lines with numbers, their places, and the rows before which samples were lost."""
    kept: list[str] = []
    places: list[int] = []
    breaks: list[int] = []
    for place in range(start, len(lines)):
        line = lines[place].strip()
        if not line or line[0] in COMMENT_MARKS:
            continue
        if line.casefold() == LAST_LINE:
            break
        if line.casefold() == "overrun":
            breaks.append(len(kept))
            continue
        kept.append(line)
        places.append(place)
    return kept, places, breaks


def _is_cut(line: str, dialect: Dialect, width: int) -> bool:
    cells = split(line, dialect)
    return len(cells) < width or (
        len(cells) == width and any(number(cell, dialect) is None for cell in cells)
    )


def _numbers(kept: Sequence[str], dialect: Dialect, width: int, at: Lines, *, where: str) -> Array:
    text = list(kept)
    if dialect.decimal == ",":
        text = [line.replace(",", ".") if "." not in line else line for line in text]
    try:
        values = np.loadtxt(text, delimiter=dialect.separator or None, comments=None, ndmin=2)
    except ValueError:
        values = None
    if values is None or values.shape != (len(kept), width) or not np.isfinite(values).all():
        values = np.asarray(
            [
                _row(line, dialect, width, int(number_), where=where)
                for line, number_ in zip(kept, at, strict=True)
            ]
        )
    return values.astype(np.float64)


def _row(line: str, dialect: Dialect, width: int, at: int, *, where: str) -> list[float]:
    cells = split(line, dialect)
    if len(cells) != width:
        raise refuse(where, "identify-row-length", line=at, got=len(cells), wanted=width)
    row = []
    for place, cell in enumerate(cells, start=1):
        value = number(cell, dialect)
        if value is None:
            raise refuse(where, "identify-no-number", line=at, column=place, got=cell[:40])
        if not np.isfinite(value):
            raise refuse(where, "identify-not-finite", line=at, column=place, got=cell[:40])
        row.append(value)
    return row


def _heads(
    above: Sequence[str], dialect: Dialect, width: int
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Heads of the columns, with their units, and the other lines above the numbers."""
    filled = [line.strip() for line in above if line.strip()]
    plain = [line for line in filled if line[0] not in COMMENT_MARKS]
    if not plain and filled:  # names after a comment mark, as numpy writes them
        plain = [filled[-1].lstrip(COMMENT_MARKS).strip()]
    rows = [cells for line in plain[-2:] if (cells := _head_cells(line, dialect, width))]
    used = plain[-len(rows) :] if rows else []
    comments = tuple(line for line in filled if line.lstrip(COMMENT_MARKS).strip() not in used)
    if not rows:
        return ("",) * width, comments
    if len(rows) == 1 or any("[" in cell for cell in rows[0]):
        return tuple(rows[-1] if len(rows) == 1 else rows[0]), comments
    units = (cell.strip("[]() ") for cell in rows[1])
    return tuple(f"{n} [{u}]" if u else n for n, u in zip(rows[0], units, strict=True)), comments


def _head_cells(line: str, dialect: Dialect, width: int) -> list[str]:
    """The heads in a line, by the separator of the numbers or another; [] if they are too few."""
    for one in (dialect, *DIALECTS):
        cells = split(line, one) if one.separator else _BLANK_HEAD.findall(line)
        if len(cells) == width:
            return cells
    return []
