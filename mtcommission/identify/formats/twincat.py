"""TwinCAT Scope, exported as CSV.

A block of heads for each channel (Name, SampleTime[ms], Unit, ...), then columns of times [ms] and
values; the channels of one sample time may share a column of times, whose heads are the names of
the fields. Tab, comma, semicolon or blank; decimal sign of the locale; perhaps EOF at the end.
Source: Beckhoff, TE13xx TwinCAT 3 Scope View, Export to csv; and the measurement in the tests.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mtcommission.identify.formats.contents import Column, FileContents, TimeContents, refuse
from mtcommission.identify.formats.table import LAST_LINE
from mtcommission.identify.measurement import Array
from mtcommission.messages.message import Message

STEP = "SampleTime[ms]"
HEAD_LINES = 60
TICK = 1e-7
"""Time stamps count 100 ns from the year 1601 where the full ones are exported."""

_FULL_STAMP = 10**15
_NO_UNIT = frozenset({"", "(none)", "none"})


@dataclass(slots=True)
class _Clock:
    """A column of times, and the channels that share it."""

    place: int
    channels: list[int] = field(default_factory=list)


def is_twincat(lines: Sequence[str]) -> bool:
    """Return whether some lines are an export of TwinCAT Scope."""
    return any(STEP in line for line in lines[:HEAD_LINES])


def read_twincat(lines: Sequence[str], *, where: str) -> FileContents:
    """Return the channels of an export, those of one clock as one record.

    Raise InputError where its heads or numbers cannot be read.
    """
    steps = next(place for place, line in enumerate(lines) if STEP in line)
    after = lines[steps].split(STEP, 1)[1]
    separator = after[:1] or "\t"
    separator = separator if separator in "\t,;" else " "
    stamps = [cell.strip() == STEP for cell in lines[steps].split(separator)]
    rows = (line.split(separator) for line in lines[:HEAD_LINES])
    heads = {cells[0].strip(): cells for cells in rows if len(cells) == len(stamps)}
    if "Name" not in heads:
        raise refuse(where, "identify-twincat-heads", line=steps + 1, wanted=len(stamps))
    names, units = heads["Name"], heads.get("Unit", [""] * len(stamps))
    start = _first_row(lines, separator, steps, len(stamps))
    if start < 0:
        raise refuse(where, "identify-no-table", lines=len(lines), first=lines[0].strip()[:60])
    cells = _cells(lines[start:], separator, len(stamps), where=where, first_line=start + 1)
    items: list[TimeContents] = []
    for clock in _clocks(stamps):
        filled = [row for row, line in enumerate(cells) if line[clock.place]]
        if not clock.channels or not filled:
            continue
        lines_of = np.asarray([start + 1 + row for row in filled], dtype=np.int64)
        times = _times([cells[r][clock.place] for r in filled], lines_of, clock.place, where=where)
        columns = tuple(
            Column(
                name=names[place].strip(),
                unit=_unit(units[place]),
                values=_values([cells[r][place] for r in filled], lines_of, place, where=where),
            )
            for place in clock.channels
        )
        same = next(
            (i for i, one in enumerate(items) if np.array_equal(_clock_of(one), times)), None
        )
        if same is not None:  # a column of times for each channel
            items[same] = replace(items[same], columns=(*items[same].columns, *columns))
            continue
        label = columns[0].name
        items.append(TimeContents(label=label, clock=times, columns=columns, lines=lines_of))
    if not items:
        raise refuse(where, "identify-no-table", lines=len(lines), first=lines[0].strip()[:60])
    if len(items) == 1:
        items = [replace(items[0], label="")]
    remarks = []
    if any(cell.strip() not in ("1", "ScaleFactor") for cell in heads.get("ScaleFactor", [])):
        remarks.append(Message("identify-twincat-scaled"))
    return FileContents(
        format=Message("identify-format-twincat"), items=tuple(items), remarks=tuple(remarks)
    )


def _clock_of(record: TimeContents) -> Array:
    return record.clock if record.clock is not None else np.zeros(0)


def _clocks(stamps: Sequence[bool]) -> list[_Clock]:
    clocks: list[_Clock] = []
    for place, is_clock in enumerate(stamps):
        if is_clock:
            clocks.append(_Clock(place))
        elif clocks:
            clocks[-1].channels.append(place)
    return clocks


def _first_row(lines: Sequence[str], separator: str, steps: int, width: int) -> int:
    for place in range(steps + 1, len(lines)):
        cells = lines[place].split(separator)
        if len(cells) == width and np.isfinite([_number(cell) for cell in cells[:2]]).all():
            return place
    return -1


def _number(cell: str) -> float:
    """The number in a cell; nan where there is none."""
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return np.nan


def _cells(
    lines: Sequence[str], separator: str, width: int, *, where: str, first_line: int
) -> list[list[str]]:
    rows = []
    for number, line in enumerate(lines):
        if not line.strip() or line.strip().casefold() == LAST_LINE:
            break
        cells = [cell.strip() for cell in line.split(separator)]
        if len(cells) > width:
            at = first_line + number
            raise refuse(where, "identify-row-length", line=at, got=len(cells), wanted=width)
        rows.append(cells + [""] * (width - len(cells)))  # slower channels end earlier
    return rows


def _values(
    cells: Sequence[str],
    lines: np.ndarray[tuple[int], np.dtype[np.int64]],
    place: int,
    *,
    where: str,
) -> Array:
    values = np.asarray([_number(cell) for cell in cells])
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        kind = "identify-no-number" if np.isnan(values[row]) else "identify-not-finite"
        line, got = int(lines[row]), cells[row][:40]
        raise refuse(where, kind, line=line, column=place + 1, got=got)
    return values


def _times(
    cells: Sequence[str],
    lines: np.ndarray[tuple[int], np.dtype[np.int64]],
    place: int,
    *,
    where: str,
) -> Array:
    """Times from the first [s]; full stamps are subtracted as integers, a double would round."""
    if (
        cells
        and all(cell.isdigit() for cell in (cells[0], cells[-1]))
        and int(cells[0]) > _FULL_STAMP
        and all(cell.isdigit() for cell in cells)
    ):
        first = int(cells[0])
        return np.asarray([int(cell) - first for cell in cells], dtype=np.float64) * TICK
    return 1e-3 * _values(cells, lines, place, where=where)


def _unit(cell: str) -> str:
    """The sign of a unit, without the quantity in parentheses behind it."""
    plain = cell.strip()
    return "" if plain.casefold() in _NO_UNIT else re.sub(r"\s*\(.*\)$", "", plain)
