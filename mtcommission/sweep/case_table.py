"""A CSV table of cases -> what varies; as spreadsheets save it, headed like ``rows.csv``."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.files import read_bytes
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import NUMBER
from mtcommission.sweep.plan import FORCE_KEY, MOST_VALUES, Axis

LARGEST_TABLE = 30_000_000
"""Bytes; as many cases as a sweep takes, with thirty characters each: half a gigabyte as cells."""
MOST_COLUMNS = 200
"""More than the keys of a profile with eight modes that make sense to vary together."""

HEAD = re.compile(r"(.*\S)\s+\[([^\]]*)\]")
"""A key, and its unit behind a blank; ``moves[1].distance`` has none."""


def load_cases(path: Path) -> Axis:
    """Return the cases of a CSV file (UTF-8); raise InputError with every fault found in it."""
    where = str(path)
    data = read_bytes(path, folder=Message("file-is-folder"), most=LARGEST_TABLE + 1)
    if len(data) > LARGEST_TABLE:
        raise _fault(where, Message("sweep-table-too-large", most=LARGEST_TABLE))
    try:
        return read_cases(data.decode("utf-8-sig"), where=where)
    except UnicodeDecodeError as error:
        raise _fault(where, Message("sweep-no-text")) from error


def read_cases(text: str, *, where: str) -> Axis:
    r"""Return the cases of a CSV table: a header of keys, then one case a line.

    Columns are parted by commas, semicolons or tabs, as the header shows; ``f_max`` stands for
    ``drive.max_force``. A unit stands behind each value, or once in the header. Raises InputError
    with every faulty line.

    Examples
    --------
    >>> read_cases("f_max,plant.slider_mass [kg]\n2 kN,700\n", where="cases.csv").rows
    (('2 kN', '700 kg'),)
    """
    table = _cells(text, where)
    if len(table) < 2 or not all(table[0][1]):
        raise _fault(where, Message("sweep-table-without-cases"), line=1)
    if len(table) - 1 > MOST_VALUES:
        message = Message("sweep-table-too-long", count=len(table) - 1, most=MOST_VALUES)
        raise _fault(where, message)
    if len(table[0][1]) > MOST_COLUMNS:
        message = Message("sweep-table-too-wide", count=len(table[0][1]), most=MOST_COLUMNS)
        raise _fault(where, message, line=table[0][0])
    heads = [_split_head(head) for head in table[0][1]]
    faults = [
        Fault(where=where, line=line, message=wrong)
        for line, cells in table[1:]
        if (wrong := _wrong_with(cells, heads))
    ]
    if faults:
        raise InputError(faults)
    units = [unit for _, unit in heads]
    return Axis(
        keys=tuple(FORCE_KEY if key == "f_max" else key for key, _ in heads),
        rows=tuple(tuple(map(_join_unit, cells, units)) for _, cells in table[1:]),
        lines=tuple(line for line, _ in table[1:]),
        where=where,
    )


def _cells(text: str, where: str) -> list[tuple[int, list[str]]]:
    """Number and cells of each line that has any."""
    head = text.lstrip().partition("\n")[0]
    # No key holds one of these, so the header tells what parts the columns.
    separator = next((mark for mark in ";\t" if mark in head), ",")
    reader = csv.reader(io.StringIO(text), delimiter=separator)
    try:
        lines = [(reader.line_num, [cell.strip() for cell in line]) for line in reader]
    except csv.Error as error:
        raise _fault(
            where, Message("sweep-no-csv", reason=str(error)), line=reader.line_num
        ) from error
    return [(number, cells) for number, cells in lines if any(cells)]


def _split_head(head: str) -> tuple[str, str]:
    """Key and unit of a heading."""
    match = HEAD.fullmatch(head)
    return (match[1], match[2].strip()) if match else (head, "")


def _wrong_with(cells: list[str], heads: list[tuple[str, str]]) -> Message | None:
    """What is wrong with a line; None if nothing is."""
    if len(cells) != len(heads):
        return Message("sweep-count-of-cells", wanted=len(heads), got=len(cells))
    for cell, (key, unit) in zip(cells, heads, strict=True):
        if not cell:
            return Message("sweep-empty-cell", key=key)
        if unit and NUMBER.match(cell) and not NUMBER.fullmatch(cell):
            return Message("sweep-two-units", key=key, got=cell, unit=unit)
    return None


def _join_unit(cell: str, unit: str) -> str:
    return f"{cell} {unit}" if unit and NUMBER.fullmatch(cell) else cell


def _fault(where: str, message: Message, *, line: int = 0) -> InputError:
    return InputError([Fault(where=where, line=line, message=message)])
