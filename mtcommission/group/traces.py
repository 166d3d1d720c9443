"""Recorded circles: two axes' positions, or a ballbar's radius over its angle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.identify.columns import read_signal_unit
from mtcommission.identify.formats.contents import Column, Lines, TimeContents, refuse
from mtcommission.identify.formats.recognise import read_contents, read_measured
from mtcommission.identify.formats.table import find_columns
from mtcommission.identify.measurement import Signal
from mtcommission.identify.record import read_clock

Array = NDArray[np.float64]

ANGLE, RADIUS = "angle", "radius"
"""Columns of a ballbar."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CircularTrace:
    """A recorded file."""

    file: str  # name as it was given
    sha256: str  # of its bytes
    columns: Mapping[str, str]  # what the file calls those that were used, by our names
    t: Array  # rising, shape (n,) [s]
    points: Array  # actual positions, shape (n, 2) [m]
    reference: Array | None  # the same of the setpoint; None: not recorded
    lines: Lines  # of each sample in the file, shape (n,) or empty
    remarks: tuple[Message, ...]

    def line(self, sample: int) -> int:
        """Return the line of a sample; 0 where the file has none."""
        return int(self.lines[sample]) if self.lines.size else 0


def read_circular(name: str, said: Mapping[str, str], plane: Sequence[str]) -> CircularTrace:
    """Return what a file holds of two axes, given their names; ``said``: ``--columns``.

    Raises
    ------
    InputError
        It has no clock, no circle's columns, or units of something else.
    """
    data = read_measured(name)
    contents = read_contents(data, said, where=name)
    first, second = (axis.casefold() for axis in plane)
    actual, reference, polar = (first, second), (f"{first}_ref", f"{second}_ref"), (ANGLE, RADIUS)
    items = [item for item in contents.items if isinstance(item, TimeContents) and item.columns]
    if not items:
        raise refuse(name, "verify-no-time-record")
    found = _find(items[0].columns, said, (*actual, *reference, *polar), where=name)
    whole = [pair for pair in (actual, reference, polar) if found.keys() >= set(pair)]
    if actual not in whole and polar not in whole:
        there = tuple(column.name for column in items[0].columns)
        raise refuse(name, "group-trace-columns", found=there, first=first, second=second)
    columns = {own: found[own] for pair in whole for own in pair}
    remarks = [*contents.remarks]
    values = {}
    for own, column in columns.items():
        values[own] = _scale(column, is_angle=own == ANGLE, where=name) * column.values
        if not column.unit:
            remarks.append(Message("verify-si-assumed", name=column.name))
    if actual not in whole:
        values[first] = values[RADIUS] * np.cos(values[ANGLE])
        values[second] = values[RADIUS] * np.sin(values[ANGLE])
    told = np.column_stack([values[own] for own in reference]) if reference in whole else None
    clock = read_clock(items[0], said, where=name)
    return CircularTrace(
        file=name,
        sha256=sha256(data).hexdigest(),
        columns={own: column.name for own, column in columns.items()},
        t=clock.times,
        points=np.column_stack([values[own] for own in actual]),
        reference=told,
        lines=clock.lines,
        remarks=tuple(dict.fromkeys(remarks)),
    )


def _find(
    columns: Sequence[Column], said: Mapping[str, str], known: Sequence[str], *, where: str
) -> dict[str, Column]:
    """The column of each of our names, with its unit; ``--columns`` comes first."""
    chosen = find_columns([column.name for column in columns], said, known)
    taken = {own for own, _ in chosen.values()}
    found: dict[str, Column] = {}
    for place, column in enumerate(columns):
        plain = column.name.casefold().replace(" ", "_")
        own, unit = chosen.get(place, ("" if plain in taken else plain, None))
        if own in found:
            names = (found[own].name, column.name)
            raise refuse(where, "verify-two-columns", role=own, names=names)
        if own in known:
            found[own] = replace(column, unit=unit or column.unit)
    return found


def _scale(column: Column, *, is_angle: bool, where: str) -> float:
    """SI value of one unit of the file."""
    if not column.unit and is_angle:
        raise refuse(where, "group-trace-angle-unit", name=column.name)
    if not column.unit:
        return 1.0
    measured = read_signal_unit(column.unit)
    if measured and measured.signal is Signal.POSITION and measured.rotary is is_angle:
        return measured.scale
    kind = "group-trace-no-angle" if is_angle else "group-trace-no-length"
    raise refuse(where, kind, name=column.name, unit=column.unit)
