"""Columns over time -> a record in SI.

Never guessed in silence: what a name or a unit leaves open becomes one error that shows what was
found and how to say it, and what they decide alone becomes a remark.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.formats.contents import Column, TimeContents, refuse
from mtcommission.identify.given import Given
from mtcommission.identify.meaning.checks import find_clipping, find_unit_slip
from mtcommission.identify.meaning.clock import Clock, read_clock
from mtcommission.identify.meaning.columns import Course, Meaning, read_columns
from mtcommission.identify.measurement import (
    FORCES,
    MOTIONS,
    Channel,
    Sensor,
    Signal,
    Source,
    TimeRecord,
)

Known = list[tuple[Column, Meaning]]


def read_record(
    contents: TimeContents, source: Source, given: Given, remarks: Sequence[Message]
) -> TimeRecord:
    """Return a record in SI."""
    where, columns = source.file, contents.columns
    clock = read_clock(contents, given.columns, where=where)
    clock.require_even(where=where)
    # Words alone tell no unit; and who names columns names those that count.
    names_all = bool(set(given.columns) - {"t", "sample_time"})
    meanings = [
        one if one and (one.is_ours or not (one.is_assumed or names_all)) else None
        for one in read_columns(columns, given.columns, where=where)
    ]
    _require_known(columns, meanings, given, where=where)
    known = [(c, m) for c, m in zip(columns, meanings, strict=True) if m]
    channels, said = _channels(known, clock, given)
    slips = (
        find_unit_slip(one.values, other.values, clock.step, name=other.name)
        for one in channels
        for other in channels
        if (one.signal, other.signal) in tuple(pairwise(MOTIONS))
        if one.sensor is other.sensor and one.rotary == other.rotary
    )
    clipped = (find_clipping(c.values, c.name) for c, m in known if m.seen is not Signal.REFERENCE)
    if faults := [Fault(where=where, message=one) for one in (*slips, *clipped) if one]:
        raise InputError(faults)
    if ignored := tuple(c.name for c, m in zip(columns, meanings, strict=True) if m is None):
        said.insert(0, Message("identify-ignored", names=ignored))
    remarks = (*remarks, *clock.remarks, *said)
    return TimeRecord(source=source, sample_time=clock.step, channels=channels, remarks=remarks)


def _require_known(
    columns: Sequence[Column], meanings: Sequence[Meaning | None], given: Given, *, where: str
) -> None:
    """Raise one error that shows every column where what is known does not suffice."""
    known = [meaning for meaning in meanings if meaning]
    signals = {meaning.seen for meaning in known}
    has_input = bool(signals & set(FORCES)) or None not in meanings
    has_place = all(m.sensor for m in known if m.seen is Signal.ACCELERATION)
    missing = {
        "identify-missing-output": not signals & set(MOTIONS),
        "identify-missing-input": not has_input and not given.columns,
        "identify-missing-sensor": given.sensor is None and not has_place,
    }
    if not any(missing.values()):
        return
    found = tuple(
        Message(
            "identify-column-found",
            place=place,
            name=column.name,
            unit=column.unit or "?",
            what=Message(f"identify-signal-{meaning.seen if meaning else 'unknown'}"),
        )
        for place, (column, meaning) in enumerate(zip(columns, meanings, strict=True), start=1)
    )
    asked = tuple(Message(kind) for kind, lacks in missing.items() if lacks)
    raise refuse(where, "identify-columns-unknown", found=found, missing=asked)


def _channels(
    known: Known, clock: Clock, given: Given
) -> tuple[tuple[Channel, ...], list[Message]]:
    """Channels that are of use, the inputs first, and what was decided about them."""
    forces = [pair for pair in known if pair[1].seen in FORCES]
    acting = [pair for pair in forces if pair[1].course is Course.ACTUAL]
    remarks = []
    if acting:  # the force that acts says more than the one that was asked for
        known = [pair for pair in known if pair not in forces or pair in acting]
    else:
        remarks = [
            Message("identify-set-force", name=column.name)
            for column, meaning in forces
            if meaning.course is Course.SETPOINT
        ]
    if assumed := tuple(c.name for c, m in known if m.is_assumed):
        remarks.append(Message("identify-si-assumed", names=assumed))
    # FILE@tcp goes before a column's name.
    is_alone = sum(m.seen in MOTIONS for _, m in known) == 1
    channels = []
    for column, meaning in known:
        sensor = meaning.sensor
        if meaning.seen in MOTIONS:
            sensor = (given.sensor if is_alone or sensor is None else None) or sensor
            if sensor is None:
                sensor = Sensor.ENCODER
                remarks.append(Message("identify-sensor-assumed", name=column.name))
        sign = -1.0 if meaning.course is Course.ERROR else 1.0
        values, _ = clock.sample(column.values)
        channels.append(
            Channel(
                name=column.name,
                signal=meaning.seen,
                sensor=sensor,
                rotary=meaning.rotary,
                values=sign * meaning.scale * values,
            )
        )
    channels.sort(key=lambda channel: channel.signal not in FORCES)
    return tuple(channels), remarks
