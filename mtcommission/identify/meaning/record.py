"""Columns over time -> a record in SI.

Never guessed in silence: what a name or a unit leaves open becomes one error that shows what was
found and how to say it, and what they decide alone becomes a remark.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from mtcommission.errors import Fault, InputError
from mtcommission.identify.formats.contents import Column, TimeContents
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
from mtcommission.messages.message import Message

Known = list[tuple[Column, Meaning]]


def read_record(
    contents: TimeContents, source: Source, given: Given, remarks: Sequence[Message]
) -> TimeRecord:
    """Return a record in SI.

    Raise InputError with every fault: clock, columns that nobody knows, clipped signals.
    """
    where, columns = source.file, contents.columns
    clock = read_clock(contents, given.columns, where=where)
    clock.require_even(where=where)
    meanings = [
        one if one and _tells(one, given) else None
        for one in read_columns(columns, given.columns, where=where)
    ]
    known = [(c, m) for c, m in zip(columns, meanings, strict=True) if m]
    _require_known(columns, meanings, given, where=where)
    channels, said = _channels(known, clock, given)
    faults = _unit_slips(channels, clock.step, where=where)
    clipped = (
        find_clipping(column.values, column.name, where=where)
        for column, meaning in known
        if not _is_reference(meaning)
    )
    faults += [fault for fault in clipped if fault]
    if faults:
        raise InputError(faults)
    if ignored := tuple(c.name for c, m in zip(columns, meanings, strict=True) if m is None):
        said.insert(0, Message("identify-ignored", names=ignored))
    return TimeRecord(
        source=source,
        sample_time=clock.step,
        channels=channels,
        remarks=(*remarks, *clock.remarks, *said),
    )


def _tells(meaning: Meaning, given: Given) -> bool:
    """Words alone tell no unit; and who names columns names those that count."""
    names = set(given.columns) - {"t", "sample_time"}
    return meaning.is_ours or not (meaning.is_assumed or names)


def _is_reference(meaning: Meaning) -> bool:
    is_set = meaning.course is Course.SETPOINT and meaning.signal in MOTIONS
    return is_set or meaning.course is Course.EXCITATION


def _signal(meaning: Meaning) -> Signal:
    return Signal.REFERENCE if _is_reference(meaning) else meaning.signal


def _require_known(
    columns: Sequence[Column], meanings: Sequence[Meaning | None], given: Given, *, where: str
) -> None:
    """Raise one error that shows every column where what is known does not suffice."""
    signals = [_signal(meaning) for meaning in meanings if meaning]
    has_output = any(one in MOTIONS for one in signals)
    has_input = any(one in FORCES for one in signals) or None not in meanings
    no_sensor = given.sensor is None and any(
        _signal(meaning) is Signal.ACCELERATION and meaning.sensor is None
        for meaning in meanings
        if meaning
    )
    missing = []
    if not has_output:
        missing.append(Message("identify-missing-output"))
    if not has_input and not given.columns:
        missing.append(Message("identify-missing-input"))
    if no_sensor:
        missing.append(Message("identify-missing-sensor"))
    if not missing:
        return
    found = tuple(
        Message(
            "identify-column-found",
            place=place,
            name=column.name,
            unit=column.unit or "?",
            what=Message(f"identify-signal-{_signal(meaning) if meaning else 'unknown'}"),
        )
        for place, (column, meaning) in enumerate(zip(columns, meanings, strict=True), start=1)
    )
    message = Message("identify-columns-unknown", found=found, missing=tuple(missing))
    raise InputError([Fault(where=where, message=message)])


def _channels(
    known: Known, clock: Clock, given: Given
) -> tuple[tuple[Channel, ...], list[Message]]:
    """Channels that are of use, the inputs first, and what was decided about them."""
    forces = [(c, m) for c, m in known if _signal(m) in FORCES]
    acts = any(m.course is Course.ACTUAL for _, m in forces)
    remarks = [
        Message("identify-set-force", name=c.name)
        for c, m in forces
        if not acts and m.course is Course.SETPOINT
    ]
    if acts:  # the force that acts says more than the one that was asked for
        known = [pair for pair in known if pair not in forces or pair[1].course is Course.ACTUAL]
    if assumed := tuple(c.name for c, m in known if m.is_assumed):
        remarks.append(Message("identify-si-assumed", names=assumed))
    # FILE@tcp goes before a column's name.
    is_alone = sum(_signal(m) in MOTIONS for _, m in known) == 1
    channels = []
    for column, meaning in known:
        signal, sensor = _signal(meaning), meaning.sensor
        if signal in MOTIONS:
            sensor = (given.sensor if is_alone or sensor is None else None) or sensor
            if sensor is None:
                sensor = Sensor.ENCODER
                remarks.append(Message("identify-sensor-assumed", name=column.name))
        sign = -1.0 if meaning.course is Course.ERROR else 1.0
        values, _ = clock.sample(column.values)
        channels.append(
            Channel(
                name=column.name,
                signal=signal,
                sensor=sensor,
                rotary=meaning.rotary,
                values=sign * meaning.scale * values,
            )
        )
    channels.sort(key=lambda channel: channel.signal not in FORCES)
    return tuple(channels), remarks


def _unit_slips(channels: Sequence[Channel], step: float, *, where: str) -> list[Fault]:
    """Velocities and accelerations that are not the rate of what the same sensor shows."""
    slips = (
        find_unit_slip(one.values, other.values, step, name=other.name, where=where)
        for one in channels
        for other in channels
        if (one.signal, other.signal) in tuple(pairwise(MOTIONS))
        if one.sensor is other.sensor and one.rotary == other.rotary
    )
    return [fault for fault in slips if fault]
