"""Columns of a time record -> channels in SI: by name, by unit, by what the user says.

Never guessed in silence: what a name or a unit leaves open becomes one error that shows what was
found and how to say it, and what they decide alone becomes a remark.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from mtcommission.errors import Fault, InputError, Refused
from mtcommission.identify.formats.contents import Column, TimeContents
from mtcommission.identify.formats.heads import words_of
from mtcommission.identify.formats.plain import SAMPLE_TIME, find_columns
from mtcommission.identify.given import Given
from mtcommission.identify.meaning.checks import find_clipping, find_unit_slip
from mtcommission.identify.meaning.clock import EvenClock, even_clock
from mtcommission.identify.meaning.units import read_signal_unit
from mtcommission.identify.measurement import Channel, Sensor, Signal, Source, TimeRecord
from mtcommission.messages.message import Message
from mtcommission.units.quantities import TIME, parse_quantity

FOLLOWING_ERROR = "following_error"
_INPUTS = (Signal.FORCE, Signal.TORQUE, Signal.CURRENT)
_OUTPUTS = (Signal.POSITION, Signal.VELOCITY, Signal.ACCELERATION)

_OWN = {
    "x_ref": (Signal.REFERENCE, None), "v_ref": (Signal.REFERENCE, None),
    "encoder": (Signal.POSITION, Sensor.ENCODER), "tcp": (Signal.POSITION, Sensor.TCP),
    "position": (Signal.POSITION, None), "velocity": (Signal.VELOCITY, None),
    "acceleration": (Signal.ACCELERATION, None), FOLLOWING_ERROR: (Signal.POSITION, Sensor.ENCODER),
    "motor_acceleration": (Signal.ACCELERATION, Sensor.ENCODER),
    "force": (Signal.FORCE, None), "torque": (Signal.TORQUE, None),
    "current": (Signal.CURRENT, None),
}  # fmt: skip
"""Our names of columns; see docs/identification.md."""

_AT_TCP = ("tcp", "tool", "load", "last", "spindle", "spindel", "werkzeug", "table", "tisch")
_AT_ENCODER = ("encoder", "motor", "geber", "drive", "antrieb")
_SETPOINTS = ("ref", "reference", "setpoint", "cmd", "command")
_EXCITATIONS = ("excitation", "disturbance", "anregung", "störung", "stoerung")
_GERMAN_SETPOINT = "soll"
_WORDS = {
    Signal.POSITION: ("position", "pos", "angle", "winkel", "lage", "weg", "displacement"),
    Signal.VELOCITY: ("velocity", "vel", "speed", "drehzahl", "geschwindigkeit"),
    Signal.ACCELERATION: ("acceleration", "accel", "acc", "beschleunigung"),
    Signal.FORCE: ("force", "kraft"),
    Signal.TORQUE: ("torque", "drehmoment"),
    Signal.CURRENT: ("current", "strom", "iq"),
}


@dataclass(frozen=True, slots=True)
class _Meaning:
    """What a column is, and its SI value per unit of the file."""

    signal: Signal
    sensor: Sensor | None
    rotary: bool | None
    scale: float
    is_setpoint: bool = False
    is_assumed: bool = False


def read_record(
    contents: TimeContents, source: Source, given: Given, remarks: Sequence[Message]
) -> TimeRecord:
    """Return a record in SI.

    Raise InputError with every fault: clock, columns that nobody knows, clipped signals.
    """
    where = source.file
    clock = even_clock(contents, _sample_time(given), where=where)
    if isinstance(clock, Fault):
        raise InputError([clock])
    meanings = _meanings(contents.columns, given, where=where)
    _require_known(contents.columns, meanings, given, where=where)
    channels, more = _channels(contents.columns, meanings, clock, given)
    faults = _faults(channels, clock.step, where=where)
    faults += [
        fault
        for column, meaning in zip(contents.columns, meanings, strict=True)
        if meaning is not None and meaning.signal is not Signal.REFERENCE
        if (fault := find_clipping(column.values, column.name, where=where))
    ]
    if faults:
        raise InputError(faults)
    resampled = (clock.remark,) if clock.remark else ()
    return TimeRecord(
        source=source,
        sample_time=clock.step,
        channels=channels,
        remarks=(*remarks, *resampled, *more),
    )


def _sample_time(given: Given) -> float:
    text = given.columns.get(SAMPLE_TIME, "")
    try:
        return parse_quantity(text, TIME) if text else 0.0
    except Refused as error:
        fault = Fault(where=f"--columns {SAMPLE_TIME}", message=error.message)
        raise InputError([fault]) from error


def _meanings(columns: Sequence[Column], given: Given, *, where: str) -> list[_Meaning | None]:
    """What each column is; None for one that nobody knows."""
    said = find_columns([column.name for column in columns], given.columns, _OWN)
    found: list[_Meaning | None] = []
    for place, column in enumerate(columns):
        own, unit = said.get(place, (column.name.casefold().replace(" ", "_"), None))
        if said and place not in said and own not in _OWN:
            found.append(None)  # who names columns names those that count
            continue
        found.append(_meaning(column, own, unit or column.unit, where=where))
    return found


def _meaning(column: Column, own: str, unit: str, *, where: str) -> _Meaning | None:
    measured = read_signal_unit(unit) if unit else None
    words = words_of(own)
    by_name = signals_in(words)
    if own in _OWN:
        signal, sensor = _OWN[own]
        if measured is None:
            return None if unit else _Meaning(signal, sensor, None, 1.0, is_assumed=True)
        if signal is Signal.REFERENCE:
            return _Meaning(signal, None, measured.rotary, measured.scale)
        if own not in ("encoder", "tcp") and not _same_kind(signal, measured.signal):
            raise _contradiction(column, unit, measured.signal, where=where)
        if measured.signal in _INPUTS and signal in _OUTPUTS:
            raise _contradiction(column, unit, measured.signal, where=where)
        sign = -1.0 if own == FOLLOWING_ERROR else 1.0
        return _Meaning(measured.signal, sensor, measured.rotary, sign * measured.scale)
    if measured is None:
        return None
    if by_name and not any(_same_kind(one, measured.signal) for one in by_name):
        raise _contradiction(column, unit, measured.signal, where=where)
    is_setpoint = says_setpoint(words)
    if _any(words, _EXCITATIONS) or (is_setpoint and measured.signal in _OUTPUTS):
        return _Meaning(Signal.REFERENCE, None, measured.rotary, measured.scale)
    sensor = column.sensor
    if sensor is None and measured.signal in _OUTPUTS:
        sensor = place_in(words)
    return _Meaning(measured.signal, sensor, measured.rotary, measured.scale, is_setpoint)


def place_in(words: Sequence[str]) -> Sensor | None:
    """Return where the words of a name say that it was measured; None if they do not.

    Examples
    --------
    >>> place_in(("motor", "speed"))
    <Sensor.ENCODER: 'encoder'>
    """
    at_encoder = Sensor.ENCODER if _any(words, _AT_ENCODER) else None
    return Sensor.TCP if _any(words, _AT_TCP) else at_encoder


def signals_in(words: Sequence[str]) -> list[Signal]:
    """Return the signals that the words of a name speak of."""
    return [signal for signal, known in _WORDS.items() if _any(words, known)]


def _any(words: Sequence[str], known: Iterable[str]) -> bool:
    return bool(set(words) & set(known))


def says_setpoint(words: Sequence[str]) -> bool:
    """Return whether the words of a name say that it is a setpoint."""
    return _any(words, _SETPOINTS) or any(_GERMAN_SETPOINT in word for word in words)


def _same_kind(one: Signal, other: Signal) -> bool:
    return one is other or (one in _INPUTS and other in _INPUTS)


def _contradiction(column: Column, unit: str, signal: Signal, *, where: str) -> InputError:
    message = Message(
        "identify-column-contradicts", name=column.name, unit=unit, signal=_word(signal)
    )
    return InputError([Fault(where=where, message=message)])


def _word(signal: Signal) -> Message:
    """Return what a signal is called."""
    return Message(f"identify-signal-{signal.value}")


def _require_known(
    columns: Sequence[Column], meanings: Sequence[_Meaning | None], given: Given, *, where: str
) -> None:
    """Raise one error that shows every column where what is known does not suffice."""
    known = [meaning for meaning in meanings if meaning is not None]
    unknown = [c for c, meaning in zip(columns, meanings, strict=True) if meaning is None]
    has_output = any(meaning.signal in _OUTPUTS for meaning in known)
    has_input = any(meaning.signal in _INPUTS for meaning in known)
    no_sensor = given.sensor is None and any(
        meaning.signal is Signal.ACCELERATION and meaning.sensor is None for meaning in known
    )
    is_silent = has_output and (has_input or not unknown or bool(given.columns)) and not no_sensor
    if is_silent:
        return
    missing = []
    if not has_output:
        missing.append(Message("identify-missing-output"))
    if not has_input and unknown and not given.columns:
        missing.append(Message("identify-missing-input"))
    if no_sensor:
        missing.append(Message("identify-missing-sensor"))
    found = tuple(
        _described(place, column, meaning)
        for place, (column, meaning) in enumerate(zip(columns, meanings, strict=True), start=1)
    )
    message = Message("identify-columns-unknown", found=found, missing=tuple(missing))
    raise InputError([Fault(where=where, message=message)])


def _described(place: int, column: Column, meaning: _Meaning | None) -> Message:
    what = _word(meaning.signal) if meaning else Message("identify-signal-unknown")
    return Message(
        "identify-column-found", place=place, name=column.name, unit=column.unit or "?", what=what
    )


def _channels(
    columns: Sequence[Column],
    meanings: Sequence[_Meaning | None],
    clock: EvenClock,
    given: Given,
) -> tuple[tuple[Channel, ...], list[Message]]:
    """Channels that are of use, the inputs first, and what was decided about them."""
    remarks: list[Message] = []
    known = [(c, m) for c, m in zip(columns, meanings, strict=True) if m is not None]
    ignored = tuple(c.name for c, m in zip(columns, meanings, strict=True) if m is None)
    if ignored:
        remarks.append(Message("identify-ignored", names=ignored))
    actual = {m.signal for _, m in known if not m.is_setpoint}
    kept = []
    for column, meaning in known:
        if meaning.is_setpoint and meaning.signal in _INPUTS:
            if actual & set(_INPUTS):
                continue  # the force that acts says more than the one that was asked for
            remarks.append(Message("identify-set-force", name=column.name))
        kept.append((column, meaning))
    assumed = tuple(c.name for c, m in kept if m.is_assumed)
    if assumed:
        remarks.append(Message("identify-si-assumed", names=assumed))
    channels = []
    for column, meaning in kept:
        sensor = meaning.sensor
        if sensor is None and meaning.signal in _OUTPUTS:
            sensor = given.sensor
            if sensor is None:
                sensor = Sensor.ENCODER
                remarks.append(Message("identify-sensor-assumed", name=column.name))
        channels.append(
            Channel(
                name=column.name,
                signal=meaning.signal,
                sensor=sensor,
                rotary=meaning.rotary,
                values=meaning.scale * clock.sample(column.values),
            )
        )
    channels.sort(key=lambda channel: channel.signal not in _INPUTS)
    outputs = [channel for channel in channels if channel.signal in _OUTPUTS]
    if given.sensor is not None and len(outputs) == 1:  # FILE@tcp goes before a column's name
        place = channels.index(outputs[0])
        channels[place] = replace(outputs[0], sensor=given.sensor)
    return tuple(channels), remarks


def _faults(channels: Sequence[Channel], step: float, *, where: str) -> list[Fault]:
    """Velocities and accelerations that are not the rate of what the same sensor shows."""
    pairs = (
        (one, other)
        for one in channels
        for other in channels
        if (one.signal, other.signal) in tuple(pairwise(_OUTPUTS))
        if one.sensor is other.sensor and one.rotary == other.rotary
    )
    slips = (
        find_unit_slip(one.values, other.values, step, name=other.name, where=where)
        for one, other in pairs
    )
    return [fault for fault in slips if fault]
