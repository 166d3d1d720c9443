"""TwinCAT Scope, exported as CSV.

A block of heads for each channel (Name, SampleTime[ms], Unit, ...), then columns of times [ms] and
values; the channels of one sample time may share a column of times, whose heads are the names of
the fields. Tab, comma, semicolon or blank; decimal sign of the locale; perhaps EOF at the end.
Source: Beckhoff, TE13xx TwinCAT 3 Scope View, Export to csv; and the measurement in the tests.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.identify.formats.contents import Column, FileContents, TimeContents, refuse
from mtcommission.identify.formats.table import LAST_LINE
from mtcommission.identify.measurement import Array

STEP = "SampleTime[ms]"
HEAD_LINES = 60
TICK = 1e-7
"""Time stamps count 100 ns from the year 1601 where the full ones are exported."""

_FULL_STAMP = 10**15
_NO_UNIT = frozenset({"", "(none)", "none"})


def is_twincat(lines: Sequence[str]) -> bool:
    """Return whether some lines are an export of TwinCAT Scope."""
    return any(STEP in line for line in lines[:HEAD_LINES])


def read_twincat(lines: Sequence[str], *, where: str) -> FileContents:
    """Return the channels of an export, those of one clock as one record."""
    steps = next(place for place, line in enumerate(lines) if STEP in line)
    separator = lines[steps].split(STEP, 1)[1][:1] or "\t"
    separator = separator if separator in "\t,;" else " "
    is_clock = [cell.strip() == STEP for cell in lines[steps].split(separator)]
    rows = (line.split(separator) for line in lines[:HEAD_LINES])
    heads = {cells[0].strip(): cells for cells in rows if len(cells) == len(is_clock)}
    if "Name" not in heads:
        raise refuse(where, "identify-twincat-heads", line=steps + 1, wanted=len(is_clock))
    names, units = heads["Name"], heads.get("Unit", [""] * len(is_clock))
    cells = _read_cells(lines, separator, steps + 1, len(is_clock), where=where)
    items: list[TimeContents] = []
    clocks = [place for place, one in enumerate(is_clock) if one]
    for clock, behind in zip(clocks, [*clocks[1:], len(is_clock)], strict=True):
        column_of = partial(_Cells, cells, [at for at, row in cells.items() if row[clock]])
        own = column_of(clock)
        if behind == clock + 1 or not own.lines:
            continue
        times = own.times(where=where)
        columns = tuple(
            Column(
                name=names[place].strip(),
                unit=_unit(units[place]),
                values=column_of(place).values(where=where),
            )
            for place in range(clock + 1, behind)
        )
        same = [k for k, one in enumerate(items) if np.array_equal(one.clock, times)]  # type: ignore[arg-type]
        if same:  # a column of times for each channel
            other = items[same[0]]
            items[same[0]] = replace(other, columns=(*other.columns, *columns))
            continue
        at = np.asarray(own.lines, dtype=np.int64)
        items.append(TimeContents(label=columns[0].name, clock=times, columns=columns, lines=at))
    if not items:
        raise refuse(where, "identify-no-table", lines=len(lines), first=lines[0].strip()[:60])
    if len(items) == 1:
        items = [replace(items[0], label="")]
    factors = {cell.strip() for cell in heads.get("ScaleFactor", [])} - {"1", "ScaleFactor"}
    return FileContents(
        format=Message("identify-format-twincat"),
        items=tuple(items),
        remarks=(Message("identify-twincat-scaled"),) if factors else (),
    )


def _read_cells(
    lines: Sequence[str], separator: str, start: int, width: int, *, where: str
) -> dict[int, list[str]]:
    """The cells of each row of numbers, by its line."""
    found: dict[int, list[str]] = {}
    for at, line in enumerate(lines[start:], start=start + 1):
        cells = [cell.strip() for cell in line.split(separator)]
        if not found:
            if len(cells) == width and np.isfinite(list(map(_number, cells[:2]))).all():
                found[at] = cells
            continue
        if not line.strip() or line.strip().casefold() == LAST_LINE:
            break
        if len(cells) > width:
            raise refuse(where, "identify-row-length", line=at, got=len(cells), wanted=width)
        found[at] = cells + [""] * (width - len(cells))  # slower channels end earlier
    if not found:
        raise refuse(where, "identify-no-table", lines=len(lines), first=lines[0].strip()[:60])
    return found


def _number(cell: str) -> float:
    """The number in a cell; nan where there is none."""
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return np.nan


@dataclass(frozen=True, slots=True)
class _Cells:
    """A column in the rows in which its clock stands."""

    rows: dict[int, list[str]]
    lines: list[int]
    place: int

    @property
    def texts(self) -> list[str]:
        return [self.rows[at][self.place] for at in self.lines]

    def values(self, *, where: str) -> Array:
        values = np.asarray([_number(cell) for cell in self.texts])
        if not np.isfinite(values).all():
            row = int(np.argmin(np.isfinite(values)))
            kind = "identify-no-number" if np.isnan(values[row]) else "identify-not-finite"
            got = self.texts[row][:40]
            raise refuse(where, kind, line=self.lines[row], column=self.place + 1, got=got)
        return values

    def times(self, *, where: str) -> Array:
        """Times from the first [s]; full stamps are subtracted as integers, a double rounds."""
        stamps = [int(cell) for cell in self.texts if cell.isdecimal()]
        if len(stamps) < len(self.lines) or stamps[0] <= _FULL_STAMP:
            return 1e-3 * self.values(where=where)
        return np.asarray([one - stamps[0] for one in stamps], dtype=np.float64) * TICK


def _unit(cell: str) -> str:
    """The sign of a unit, without the quantity in parentheses behind it."""
    plain = cell.strip()
    return "" if plain.casefold() in _NO_UNIT else re.sub(r"\s*\(.*\)$", "", plain)
