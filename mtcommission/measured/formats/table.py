"""Lines of text -> a table of numbers: separators, decimal marks and headers as they come.

Commas, semicolons, tabs or blanks; decimal point or comma; names, and perhaps units in a line of
their own, above the numbers.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.measured.measurement import Array, Lines, broken, refuse

COMMENT_MARKS = "#%!"
MOST_COLUMNS = 400
SAMPLE = 40
"""Lines from which separator and decimal mark are found."""
LAST_LINE = "eof"
_END_QUOTES = "\"' \t"
_BLANK_HEAD = re.compile(r"[^\s\[(]+(?:\s*(?:\[[^\]]*\]|\([^)]*\)))?")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?|[+-]?(?:nan|inf)", re.IGNORECASE)
CLOCK = "t"
SAMPLE_TIME = "sample_time"

_IN_BRACKETS = re.compile(r"^(?P<name>[^\[]*)\[(?P<unit>.*)\]\s*$")
_IN_PARENTHESES = re.compile(r"^(?P<name>[^(]*)\((?P<unit>.*)\)\s*$")
_AFTER_SLASH = re.compile(r"^(?P<name>.*\S)\s+(?:/|in)\s+(?P<unit>\S.*)$")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")


class Head(NamedTuple):
    """What stands above a column; "" where there is no name or no unit."""

    name: str
    unit: str


def split_head(head: str) -> Head:
    """Return name and unit of a column's head."""
    for form in (_IN_BRACKETS, _IN_PARENTHESES, _AFTER_SLASH):
        if match := form.match(head.strip()):
            return Head(match["name"].strip(), match["unit"].strip())
    return Head(head.strip(), "")


def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name, in small letters."""
    spaced = _CAMEL.sub(" ", name)
    return tuple(re.findall(r"[a-zäöüßζγ²]+|[0-9]+", spaced.casefold()))


def find_column(names: Sequence[str], wanted: str) -> tuple[int, str | None]:
    """Return the place of a column that ``--columns`` names, and the unit that it gives it."""
    if wanted in names:
        return names.index(wanted), None
    name, unit = split_head(wanted)
    if name in names:
        return names.index(name), unit or None
    if name.isdigit() and 1 <= int(name) <= len(names):
        return int(name) - 1, unit or None
    found = tuple(f"{place}: {one or '?'}" for place, one in enumerate(names, start=1))
    raise refuse("--columns", "identify-not-there", got=wanted, found=found)


def find_columns(
    names: Sequence[str], said: Mapping[str, str], known: Collection[str]
) -> dict[int, tuple[str, str | None]]:
    """Return our name and the unit given for each column that ``--columns`` names, by its place."""
    found = {}
    for own, wanted in said.items():
        if own in (CLOCK, SAMPLE_TIME):
            continue
        if own not in known:
            raise refuse("--columns", "identify-no-such-name", got=own, names=tuple(known))
        place, unit = find_column(names, wanted)
        found[place] = (own, unit)
    return found


@dataclass(frozen=True, slots=True)
class Dialect:
    """How numbers are written."""

    separator: str  # Between cells; "" for blanks
    decimal: str  # Point or comma

    def split(self, line: str) -> list[str]:
        """Return the cells of a line, without quotes; an empty last one is none."""
        if not self.separator:
            return line.split()
        quoted = next(csv.reader([line], delimiter=self.separator)) if '"' in line else None
        cells = [cell.strip(_END_QUOTES) for cell in quoted or line.split(self.separator)]
        return cells[:-1] if cells and not cells[-1] else cells

    def number(self, cell: str) -> float | None:
        """Return the number in a cell; None if it has none."""
        if self.decimal == ",":
            if "." in cell:
                return None
            cell = cell.replace(",", ".")
        return float(cell.lower().replace("d", "e")) if _NUMBER.fullmatch(cell) else None

    def has_row(self, line: str) -> bool:
        """Return whether there are two numbers or more in a line, and nothing else."""
        cells = self.split(line)
        return len(cells) > 1 and all(self.number(cell) is not None for cell in cells)


DIALECTS = (
    Dialect("\t", "."), Dialect("\t", ","), Dialect(";", "."), Dialect(";", ","),
    Dialect(",", "."), Dialect("", "."), Dialect("", ","), Dialect(",", ","),
)  # fmt: skip
"""Tried in this order; the last has its numbers in quotes."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Table:
    """Numbers with their heads."""

    heads: tuple[Head, ...]  # Of each column
    values: Array  # Shape (n_rows, n_columns), finite
    lines: Lines  # Line of each row in the file, shape (n_rows,)
    comments: tuple[str, ...]  # Lines before the numbers that are neither heads nor numbers
    breaks: tuple[int, ...]  # Rows before which a line stood that says that samples were lost
    remarks: tuple[Message, ...]  # Whether an incomplete last row was left out


def read_table(lines: Sequence[str], *, first_line: int = 1, columns: int = 0) -> Table:
    """Return the table of numbers in some lines; ``columns``: how many it must have, 0 for any."""
    dialect = _find_dialect(lines)
    start = next(place for place, line in enumerate(lines) if dialect.has_row(line))
    width = len(dialect.split(lines[start]))
    if width > MOST_COLUMNS:
        line = first_line + start
        raise broken("identify-too-many-columns", line=line, got=width, most=MOST_COLUMNS)
    kept: dict[int, str] = {}
    breaks = []
    for at, text in enumerate(map(str.strip, lines[start:]), start=first_line + start):
        if text.casefold() == LAST_LINE:
            break
        if text.casefold() == "overrun":
            breaks.append(len(kept))
        elif text and text[0] not in COMMENT_MARKS:
            kept[at] = text
    remarks, last = [], max(kept)
    cells = dialect.split(kept[last])
    is_whole = len(cells) == width and dialect.has_row(kept[last])
    if len(kept) > 1 and not is_whole and len(cells) <= width:
        remarks = [Message("identify-cut", line=last)]
        del kept[last]
    values = _numbers(kept, dialect, width)
    if columns not in (0, width):
        line = next(iter(kept))
        raise broken("identify-row-length", line=line, got=width, wanted=columns)
    heads, comments = _heads(lines[:start], dialect, width)
    return Table(
        heads=heads,
        values=values,
        lines=np.asarray(list(kept), dtype=np.int64),
        comments=comments,
        breaks=tuple(breaks),
        remarks=tuple(remarks),
    )


def _find_dialect(lines: Sequence[str]) -> Dialect:
    """How the numbers of most lines in the middle are written."""
    filled = [line for line in lines if line.strip() and line.lstrip()[0] not in COMMENT_MARKS]
    sample = filled[-SAMPLE - 1 : -1] or filled  # the last may be cut
    if len(filled) > 2 * SAMPLE:
        sample = filled[len(filled) // 2 :][:SAMPLE]
    good = [sum(map(one.has_row, sample)) for one in DIALECTS]
    if max(good) < max((len(sample) + 1) // 2, 1):
        first = filled[0].strip()[:60] if filled else ""
        shown = "".join(letter if letter.isprintable() else "?" for letter in first)
        raise broken("identify-no-table", lines=len(lines), first=shown)
    return DIALECTS[good.index(max(good))]


def _numbers(kept: dict[int, str], dialect: Dialect, width: int) -> Array:
    text = list(kept.values())
    if dialect.decimal == ",":
        text = [line.replace(",", ".") if "." not in line else line for line in text]
    try:
        values = np.loadtxt(text, delimiter=dialect.separator or None, comments=None, ndmin=2)
        if values.shape == (len(kept), width) and np.isfinite(values).all():
            return values.astype(np.float64)
    except ValueError:
        pass  # line by line, which tells where
    rows = (_row(line, dialect, width, at) for at, line in kept.items())
    return np.asarray(list(rows), dtype=np.float64)


def _row(line: str, dialect: Dialect, width: int, at: int) -> list[float]:
    cells, row = dialect.split(line), list[float]()
    if len(cells) != width:
        raise broken("identify-row-length", line=at, got=len(cells), wanted=width)
    for place, cell in enumerate(cells, start=1):
        value = dialect.number(cell)
        if value is None or not np.isfinite(value):
            kind = "identify-no-number" if value is None else "identify-not-finite"
            raise broken(kind, line=at, column=place, got=cell[:40])
        row.append(value)
    return row


def _heads(
    above: Sequence[str], dialect: Dialect, width: int
) -> tuple[tuple[Head, ...], tuple[str, ...]]:
    """Heads of the columns, with their units, and the other lines above the numbers."""
    filled = [line.strip() for line in above if line.strip()]
    plain = [line for line in filled if line[0] not in COMMENT_MARKS]
    if not plain and filled:  # names after a comment mark, as numpy writes them
        plain = [filled[-1].lstrip(COMMENT_MARKS).strip()]
    rows = [cells for line in plain[-2:] if (cells := _head_cells(line, dialect, width))]
    used = plain[-len(rows) :] if rows else []
    comments = tuple(line for line in filled if line.lstrip(COMMENT_MARKS).strip() not in used)
    if not rows:
        return (Head("", ""),) * width, comments
    if len(rows) == 1 or any("[" in cell for cell in rows[0]):
        return tuple(map(split_head, rows[0])), comments
    units = [cell.strip("[]() ") for cell in rows[1]]
    pairs = zip(rows[0], units, strict=True)
    return tuple(Head(name, unit) if unit else split_head(name) for name, unit in pairs), comments


def _head_cells(line: str, dialect: Dialect, width: int) -> list[str]:
    """The heads in a line, by the separator of the numbers or another; [] if they are too few."""
    for one in (dialect, *DIALECTS):
        cells = one.split(line) if one.separator else _BLANK_HEAD.findall(line)
        if len(cells) == width:
            return cells
    return []
