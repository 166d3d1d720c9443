"""Options of the command line, and a table of cases -> plan; every fault at once, before any work.

The table is a CSV file as spreadsheets save it, headed like ``rows.csv``.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.files import read_bytes
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import NUMBER
from mtcommission.commission.options import Options
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import parse_profile, read_key, read_profile_text
from mtcommission.sweep.plan import (
    FORCE_KEY,
    MOST_VALUES,
    PEAKS_KEY,
    Axis,
    Plan,
    Quantity,
    read_axis,
    read_range,
    unit_of,
    vary_profile,
)

LARGEST_TABLE = 30_000_000
"""Bytes; as many cases as a sweep takes, with thirty characters each: half a gigabyte as cells."""
MOST_COLUMNS = 200
"""More than the keys of a profile with eight modes that make sense to vary together."""

HEAD = re.compile(r"(.*\S)\s+\[([^\]]*)\]")
"""A key, and its unit behind a blank; ``moves[1].distance`` has none."""

ACCELERATION_KEY = "drive.max_acceleration"
"""What --f-max varies where the motor follows its setpoint."""
MOST_CASES = 64
"""In which a refused value is tried: some 10 ms each."""


def read_plan(
    profile: Path,
    *,
    f_max: str = "",
    vary: Sequence[str] = (),
    limits: Sequence[str] = (),
    cases: Path | None = None,
    is_paired: bool = False,
    quantity: str = "optimal",
    move: int = 1,
    created: str = "",
) -> Plan:
    """Return what ``sweep`` is asked for; F_max runs fastest, so that neighbours help each other.

    ``limits`` have a value or a range; they and ``move`` go with ``optimal`` only.

    Raises InputError with every fault found.
    """
    options = Options()
    text = read_profile_text(profile)
    machine = parse_profile(text, where=str(profile))
    plant = build_plant(machine)
    varied = [limit for limit in limits if ":" in limit or "," in limit]
    bounds = tuple(options.bound(plant, limit) for limit in limits if limit not in varied)
    readers: list[Callable[[], Axis]] = []
    if cases is not None:
        readers.append(partial(load_cases, cases))
    readers += [partial(read_axis, item, where="--vary") for item in vary]
    readers += [partial(read_axis, PEAKS_KEY + item, where="--limit") for item in varied]
    if f_max:
        key = ACCELERATION_KEY if machine.drive.follows else FORCE_KEY
        where = "--f-max"
        readers.append(lambda: Axis(keys=(key,), rows=read_range(f_max, where=where), where=where))
    axes = []
    for read in readers:
        try:
            axes.append(read())
        except InputError as error:
            options.faults += error.faults
    options.word("--quantity", quantity, [item.value for item in Quantity])
    if quantity in (Quantity.LIMITS.value, Quantity.RUN.value):
        message = Message("sweep-taken-from-profile", quantity=quantity)
        for name, is_given in (("--limit", bool(limits)), ("--move", move != 1)):
            if is_given:
                options.refuse(name, message)
    options.move(machine, move)
    options.close()
    plan = Plan(
        profile_text=text,
        where=profile.name,
        axes=tuple(axes),
        is_paired=is_paired,
        quantity=Quantity(quantity),
        move=move,
        bounds=bounds,
        created=created,
    )
    check_plan(plan)
    faults = [fault for axis in plan.axes for fault in _wrong_values(plan, axis)]
    if faults:
        raise InputError(faults)
    return plan


def check_plan(plan: Plan) -> None:
    """Raise InputError where axes share a key, or are paired and of different length."""
    twice = sorted({key for key in plan.keys if plan.keys.count(key) > 1})
    faults = [
        Fault(where="--vary", key=key, message=Message("sweep-varies-twice")) for key in twice
    ]
    if plan.is_paired and len({len(axis.rows) for axis in plan.axes}) > 1:
        got = tuple(f"{axis.keys[0]} {len(axis.rows)}" for axis in plan.axes)
        faults.append(Fault(where="--paired", message=Message("sweep-unequal-lengths", got=got)))
    if faults:
        raise InputError(faults)
    vary_profile(plan.profile_text, plan.settings(0), where=plan.where)


def _wrong_values(plan: Plan, axis: Axis) -> Iterator[Fault]:
    """Faults of keys and values that the profile's reader refuses.

    Of numbers with the same unit the ends speak for all between, since what a profile allows of
    one key is an interval. A value that is only wrong together with others, e.g. a static load
    above the least of the forces that vary, is a row of its own.
    """
    for column, key in enumerate(axis.keys):
        for rows in _ends([row[column] for row in axis.rows]):
            refusals = ((row, _refusals(plan, axis, row, key)) for row in rows)
            row, refused = next((item for item in refusals if item[1]), (0, []))
            line = axis.lines[row] if axis.lines else 0
            for fault in refused:
                yield Fault(where=axis.where, line=line, key=key, message=fault.message)


def _ends(texts: Sequence[str]) -> list[list[int]]:
    """Places of the least and the largest number of each unit, and of every word."""
    by_unit: dict[str, list[int]] = {}
    for place, text in enumerate(texts):
        by_unit.setdefault(unit_of(text), []).append(place)
    found = []
    for group in by_unit.values():
        numbers = [
            (float(match[0]), place) for place in group if (match := NUMBER.match(texts[place]))
        ]
        found.append([min(numbers)[1], max(numbers)[1]] if numbers else group[:1])
    return found


def _refusals(plan: Plan, axis: Axis, row: int, key: str) -> list[Fault]:
    """What the profile's reader says against a value of a key, whatever the other keys are.

    Tried are nothing else that varies, and the other keys as cases of the whole plan have them.
    """
    text = dict(zip(axis.keys, axis.rows[row], strict=True))[key]
    path = f"{read_key(key)}."
    cases = np.linspace(0, plan.count - 1, MOST_CASES).astype(int).tolist()
    refused: list[Fault] = []
    for others in ((), *map(plan.settings, dict.fromkeys(cases))):
        settings = (*((one, value) for one, value in others if one != key), (key, text))
        try:
            varied = vary_profile(plan.profile_text, settings, where=plan.where)
            parse_profile(varied, where=plan.where)
            return []
        except InputError as error:
            of_key = [one for one in error.faults if one.key and path.startswith(f"{one.key}.")]
        if not of_key:
            return []
        refused = refused or of_key
    return refused


# A table of cases


def load_cases(path: Path) -> Axis:
    """Return the cases of a CSV file (UTF-8); raise InputError with every fault found in it."""
    where = str(path)
    data = read_bytes(path, folder=Message("file-is-folder"), most=LARGEST_TABLE + 1)
    if len(data) > LARGEST_TABLE:
        raise InputError.at(where, Message("sweep-table-too-large", most=LARGEST_TABLE))
    try:
        return read_cases(data.decode("utf-8-sig"), where=where)
    except UnicodeDecodeError as error:
        raise InputError.at(where, Message("sweep-no-text")) from error


def read_cases(text: str, *, where: str) -> Axis:
    r"""Return the cases of a CSV table: a header of keys, then one case a line.

    Columns are parted by commas, semicolons or tabs, as the header shows; ``f_max`` stands for
    ``drive.max_force``. A unit stands behind each value, or once in the header. Raises InputError
    with every faulty line.
    """
    table = _cells(text, where)
    if len(table) < 2 or not all(table[0][1]):
        raise InputError.at(where, Message("sweep-table-without-cases"), line=1)
    if len(table) - 1 > MOST_VALUES:
        message = Message("sweep-table-too-long", count=len(table) - 1, most=MOST_VALUES)
        raise InputError.at(where, message)
    if len(table[0][1]) > MOST_COLUMNS:
        message = Message("sweep-table-too-wide", count=len(table[0][1]), most=MOST_COLUMNS)
        raise InputError.at(where, message, line=table[0][0])
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
        raise InputError.at(
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
