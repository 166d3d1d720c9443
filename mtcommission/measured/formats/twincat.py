"""TwinCAT Scope, exported as CSV.

A block of heads for each channel (Name, SampleTime[ms], Unit, ...), then columns of times [ms] and
values; the channels of one sample time may share a column of times, whose heads are the names of
the fields. Tab, comma, semicolon or blank; decimal sign of the locale; perhaps EOF at the end.
Source: Beckhoff, TE13xx TwinCAT 3 Scope View, Export to csv; and the measurement in the tests.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.measured.formats.table import LAST_LINE
from mtcommission.measured.measurement import Array, Column, FileContents, TimeContents, broken

STEP = "SampleTime[ms]"
HEAD_LINES = 60
TICK = 1e-7
"""Time stamps count 100 ns from the year 1601 where the full ones are exported."""
Rows = dict[int, list[str]]
"""Cells of rows by their lines in the file."""
_FULL_STAMP = 10**15
_NO_UNIT = frozenset({"", "(none)", "none"})


def is_twincat(lines: Sequence[str]) -> bool:
    """Return whether some lines are an export of TwinCAT Scope."""
    return any(STEP in line for line in lines[:HEAD_LINES])


def read_twincat(lines: Sequence[str]) -> FileContents:
    """Return the channels of an export, those of one clock as one record."""
    steps = next(place for place, line in enumerate(lines) if STEP in line)
    separator = lines[steps].split(STEP, 1)[1][:1] or "\t"
    separator = separator if separator in "\t,;" else " "
    is_clock = [cell.strip() == STEP for cell in lines[steps].split(separator)]
    above = (line.split(separator) for line in lines[:HEAD_LINES])
    heads = {cells[0].strip(): cells for cells in above if len(cells) == len(is_clock)}
    if "Name" not in heads:
        raise broken("identify-twincat-heads", line=steps + 1, wanted=len(is_clock))
    names, units = heads["Name"], heads.get("Unit", [""] * len(is_clock))
    rows = _read_rows(lines, separator, steps + 1, len(is_clock))
    items: list[TimeContents] = []
    clocks = [place for place, one in enumerate(is_clock) if one]
    for clock, behind in zip(clocks, [*clocks[1:], len(is_clock)], strict=True):
        own = {at: row for at, row in rows.items() if row[clock]}
        if behind == clock + 1 or not own:
            continue
        times = _times(own, clock)
        columns = tuple(
            Column(name=names[k].strip(), unit=_unit(units[k]), values=_values(own, k))
            for k in range(clock + 1, behind)
        )
        same = [k for k, one in enumerate(items) if np.array_equal(one.clock, times)]  # type: ignore[arg-type]
        if same:  # a column of times for each channel
            other = items[same[0]]
            items[same[0]] = replace(other, columns=(*other.columns, *columns))
            continue
        at = np.asarray(list(own), dtype=np.int64)
        items.append(TimeContents(label=columns[0].name, clock=times, columns=columns, lines=at))
    if not items:
        raise broken("identify-no-table", lines=len(lines), first=lines[0].strip()[:60])
    if len(items) == 1:
        items = [replace(items[0], label="")]
    factors = {cell.strip() for cell in heads.get("ScaleFactor", [])} - {"1", "ScaleFactor"}
    return FileContents(
        items=tuple(items),
        remarks=(Message("identify-twincat-scaled"),) if factors else (),
    )


def _read_rows(lines: Sequence[str], separator: str, start: int, width: int) -> Rows:
    found: Rows = {}
    for at, line in enumerate(lines[start:], start=start + 1):
        cells = [cell.strip() for cell in line.split(separator)]
        if not found:
            if len(cells) == width and np.isfinite(list(map(_number, cells[:2]))).all():
                found[at] = cells
            continue
        if not line.strip() or line.strip().casefold() == LAST_LINE:
            break
        if len(cells) > width:
            raise broken("identify-row-length", line=at, got=len(cells), wanted=width)
        found[at] = cells + [""] * (width - len(cells))  # slower channels end earlier
    if not found:
        raise broken("identify-no-table", lines=len(lines), first=lines[0].strip()[:60])
    return found


def _number(cell: str) -> float:
    """The number in a cell; nan where there is none."""
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return np.nan


def _values(rows: Rows, place: int) -> Array:
    values = np.asarray([_number(row[place]) for row in rows.values()])
    for (line, row), value in zip(rows.items(), values.tolist(), strict=True):
        if not np.isfinite(value):
            kind = "identify-no-number" if np.isnan(value) else "identify-not-finite"
            raise broken(kind, line=line, column=place + 1, got=row[place][:40])
    return values


def _times(rows: Rows, place: int) -> Array:
    """Times from the first [s]; full stamps are subtracted as integers, a double rounds."""
    stamps = [int(row[place]) for row in rows.values() if row[place].isdecimal()]
    if len(stamps) < len(rows) or stamps[0] <= _FULL_STAMP:
        return 1e-3 * _values(rows, place)
    return np.asarray([one - stamps[0] for one in stamps], dtype=np.float64) * TICK


def _unit(cell: str) -> str:
    """The sign of a unit, without the quantity in parentheses behind it."""
    plain = cell.strip()
    return "" if plain.casefold() in _NO_UNIT else re.sub(r"\s*\(.*\)$", "", plain)
