"""Recorded circles: two axes' positions, or a ballbar's radius over its angle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.formats.contents import Column, Lines, TimeContents, refuse
from mtcommission.identify.formats.heads import find_columns
from mtcommission.identify.formats.recognise import read_contents
from mtcommission.identify.formats.text import read_measured
from mtcommission.identify.meaning.clock import read_clock
from mtcommission.identify.meaning.units import read_signal_unit
from mtcommission.identify.measurement import Signal
from mtcommission.messages.message import Message

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
    actual = [axis.casefold() for axis in plane]
    pairs = (actual, [f"{axis}_ref" for axis in actual], [ANGLE, RADIUS])
    known = [own for pair in pairs for own in pair]
    items = [item for item in contents.items if isinstance(item, TimeContents) and item.columns]
    if not items:
        raise refuse(name, "verify-no-time-record")
    found: dict[str, tuple[Column, str]] = {}
    for column, own, unit in _named(items[0].columns, said, known):
        if own in found:
            names = (found[own][0].name, column.name)
            raise refuse(name, "verify-two-columns", role=own, names=names)
        found[own] = (column, unit)
    whole = [pair for pair in pairs if all(own in found for own in pair)]
    if pairs[0] not in whole and pairs[2] not in whole:
        there = tuple(column.name for column in items[0].columns)
        raise refuse(name, "group-trace-columns", found=there, first=actual[0], second=actual[1])
    used = [own for pair in whole for own in pair]
    remarks = [*contents.remarks]
    values = {}
    for own in used:
        column, unit = found[own]
        if not unit:
            if own == ANGLE:
                raise refuse(name, "group-trace-angle-unit", name=column.name)
            remarks.append(Message("verify-si-assumed", name=column.name))
        values[own] = _scale(column, unit, is_angle=own == ANGLE, where=name) * column.values
    clock = read_clock(items[0], said, where=name)
    first, second = (values.get(own) for own in pairs[0])
    if first is None or second is None:
        angle, radius = values[ANGLE], values[RADIUS]
        first, second = radius * np.cos(angle), radius * np.sin(angle)
    has_setpoint = pairs[1] in whole
    return CircularTrace(
        file=name,
        sha256=sha256(data).hexdigest(),
        columns={own: found[own][0].name for own in used},
        t=clock.times,
        points=np.column_stack([first, second]),
        reference=np.column_stack([values[own] for own in pairs[1]]) if has_setpoint else None,
        lines=clock.lines,
        remarks=tuple(dict.fromkeys(remarks)),
    )


def _named(
    columns: Sequence[Column], said: Mapping[str, str], known: Sequence[str]
) -> list[tuple[Column, str, str]]:
    """Each column of one of our names, that name, and its unit; ``--columns`` comes first."""
    chosen = find_columns([column.name for column in columns], said, known)
    taken = {own for own, _ in chosen.values()}
    found = []
    for place, column in enumerate(columns):
        plain = column.name.casefold().replace(" ", "_")
        own, unit = chosen.get(place, ("" if plain in taken else plain, None))
        if own in known:
            found.append((column, own, unit or column.unit))
    return found


def _scale(column: Column, unit: str, *, is_angle: bool, where: str) -> float:
    """SI value of one unit of the file."""
    if not unit:
        return 1.0
    measured = read_signal_unit(unit)
    if (
        measured is None
        or measured.signal is not Signal.POSITION
        or measured.rotary is not is_angle
    ):
        kind = "group-trace-no-angle" if is_angle else "group-trace-no-length"
        raise refuse(where, kind, name=column.name, unit=unit)
    return measured.scale
