"""What a column is: by our names, by its words and unit, or as ``--columns`` says.

For ``identify`` and ``verify`` alike; what is done with a column that stays unknown is theirs.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto

from mtcommission.base.errors import Refused
from mtcommission.base.messages.message import Message
from mtcommission.base.units.symbols import Unit, read_unit
from mtcommission.measured.formats.table import find_columns, words_of
from mtcommission.measured.measurement import (
    FORCES,
    MOTIONS,
    Column,
    Sensor,
    Signal,
    broken,
    within,
)


class Course(Enum):
    """Which course of a signal a column holds."""

    ACTUAL = auto()
    SETPOINT = auto()
    ERROR = auto()  # setpoint less actual value
    EXCITATION = auto()  # added on purpose


@dataclass(frozen=True, slots=True, kw_only=True)
class Meaning:
    """What a column is."""

    signal: Signal
    course: Course = Course.ACTUAL
    sensor: Sensor | None = None  # where it was seen; None where neither name nor format tells
    rotary: bool | None = None  # whether lengths are angles; None where the unit does not tell
    scale: float = 1.0  # SI value of one unit of the file
    is_ours: bool = False  # whether one of our names tells, in the file or by ``--columns``
    is_said: bool = False  # whether ``--columns`` does
    is_assumed: bool = False  # whether there is no unit, and SI is meant

    @property
    def seen(self) -> Signal:
        """What identification makes of it: an excitation or a motion's setpoint is a reference."""
        is_set = self.course is Course.SETPOINT and self.signal in MOTIONS
        return Signal.REFERENCE if is_set or self.course is Course.EXCITATION else self.signal


_SET, _ENCODER, _TCP = Course.SETPOINT, Sensor.ENCODER, Sensor.TCP
OWN = {
    "x_ref": Meaning(signal=Signal.POSITION, course=_SET),
    "v_ref": Meaning(signal=Signal.VELOCITY, course=_SET),
    "encoder": Meaning(signal=Signal.POSITION, sensor=_ENCODER),
    "tcp": Meaning(signal=Signal.POSITION, sensor=_TCP),
    "position": Meaning(signal=Signal.POSITION),
    "velocity": Meaning(signal=Signal.VELOCITY),
    "acceleration": Meaning(signal=Signal.ACCELERATION),
    "following_error": Meaning(signal=Signal.POSITION, course=Course.ERROR, sensor=_ENCODER),
    "motor_acceleration": Meaning(signal=Signal.ACCELERATION, sensor=_ENCODER),
    "force": Meaning(signal=Signal.FORCE),
    "torque": Meaning(signal=Signal.TORQUE),
    "current": Meaning(signal=Signal.CURRENT),
}
"""Our names of columns; see docs/identification.md."""
_ANY_MOTION = ("encoder", "tcp")
"""What is seen there may be a rate, too, as its unit tells."""
_WORDS = {
    Signal.POSITION: ("position", "pos", "angle", "winkel", "lage", "weg", "displacement"),
    Signal.VELOCITY: ("velocity", "vel", "speed", "drehzahl", "geschwindigkeit"),
    Signal.ACCELERATION: ("acceleration", "accel", "acc", "beschleunigung"),
    Signal.FORCE: ("force", "kraft"),
    Signal.TORQUE: ("torque", "drehmoment"),
    Signal.CURRENT: ("current", "strom", "iq"),
}
_AT_TCP = ("tcp", "tool", "load", "last", "spindle", "spindel", "werkzeug", "table", "tisch")
_AT_ENCODER = ("encoder", "motor", "geber", "drive", "antrieb")
_SETPOINTS = ("ref", "reference", "setpoint", "cmd", "command")
_EXCITATIONS = ("excitation", "disturbance", "anregung", "störung", "stoerung")
_ERRORS = ({"following", "error"}, {"position", "error"}, {"pos", "error"}, {"lag", "error"},
           {"pos", "err"}, {"position", "diff"}, {"tracking", "error"}, {"ferror"}, {"f", "error"},
           {"schleppabstand"}, {"schleppfehler"}, {"lagedifferenz"}, {"regeldifferenz"},
           {"nachlauffehler"})  # fmt: skip


def read_columns(
    columns: Sequence[Column], said: Mapping[str, str], *, where: str
) -> list[Meaning | None]:
    """Return what each column is; None for one that neither name nor unit tells."""
    named = find_columns([column.name for column in columns], said, OWN)
    found = []
    for place, column in enumerate(columns):
        own, unit = named.get(place, (column.name.casefold().replace(" ", "_"), None))
        meaning = _of_own if own in OWN else _of_words
        with within(where):
            one = meaning(column, own, unit or column.unit)
        found.append(replace(one, is_said=True) if one and place in named else one)
    return found


def _of_own(column: Column, own: str, unit: str) -> Meaning | None:
    stated = replace(OWN[own], is_ours=True)
    if not unit:
        return replace(stated, is_assumed=True)
    measured = read_signal_unit(unit)
    if measured is None:
        return None
    found = replace(stated, signal=measured.signal, rotary=measured.rotary, scale=measured.scale)
    if stated.course is Course.SETPOINT:
        is_motion = measured.signal in MOTIONS
        return found if is_motion else replace(found, course=Course.EXCITATION)
    kin = MOTIONS if own in _ANY_MOTION else _kin(stated.signal)
    _require(measured.signal in kin, column, unit, measured.signal)
    return found


def _of_words(column: Column, own: str, unit: str) -> Meaning | None:
    words = words_of(own)
    by_name = [signal for signal, known in _WORDS.items() if _any(words, known)]
    measured = read_signal_unit(unit) if unit else None
    if measured is None:
        if unit or len(by_name) != 1:
            return None
        found = Meaning(signal=by_name[0], is_assumed=True)
    else:
        found = measured
        fits = not by_name or any(found.signal in _kin(one) for one in by_name)
        _require(fits, column, unit, found.signal)
    if _any(words, _EXCITATIONS):
        return replace(found, course=Course.EXCITATION)
    if found.signal is Signal.POSITION and any(error <= set(words) for error in _ERRORS):
        return replace(found, course=Course.ERROR, sensor=Sensor.ENCODER)
    if _any(words, _SETPOINTS) or any("soll" in word for word in words):
        return replace(found, course=Course.SETPOINT)
    if found.signal in MOTIONS:
        return replace(found, sensor=column.sensor or place_in(words))
    return found


def _kin(signal: Signal) -> Collection[Signal]:
    return FORCES if signal in FORCES else (signal,)


def _require(fits: bool, column: Column, unit: str, signal: Signal) -> None:
    if not fits:
        said = Message(f"identify-signal-{signal.value}")
        raise broken("identify-column-contradicts", name=column.name, unit=unit, signal=said)


def place_in(words: Sequence[str]) -> Sensor | None:
    """Return where the words of a name say that it was measured; None if they do not."""
    at_encoder = Sensor.ENCODER if _any(words, _AT_ENCODER) else None
    return Sensor.TCP if _any(words, _AT_TCP) else at_encoder


def _any(words: Sequence[str], known: Collection[str]) -> bool:
    return bool(set(words) & set(known))


GRAVITY = 9.80665
"""Standard gravity [m/s^2]. Source: CGPM 1901."""
_TURNS_PER_MINUTE = re.compile(r"(?<![\w/])(?:1/min|min\^?-1|min⁻¹|[UuR]/min)(?!\w)")
_CURRENT = re.compile(r"(?<![A-Za-z])([mk]?)A(?:_?(?:rms|eff|pk))?(?![A-Za-z])")
_GRAVITIES = re.compile(r"(?<![A-Za-z])(m?)g(?:_?n)?(?![A-Za-z])")

Exponents = tuple[int, int, int, int]
"""Of m, kg, s and rad."""
_FORCE, _TORQUE = (1, 1, -2, 0), (2, 1, -2, 0)
_RATES: dict[Exponents, tuple[Signal, bool]] = {
    (1 - rotary, 0, -signal.derivative, int(rotary)): (signal, rotary)
    for signal in MOTIONS
    for rotary in (False, True)
}
"""What each unit of a motion measures, and whether its lengths are angles."""
_SIGNALS = {_FORCE: (Signal.FORCE, False), _TORQUE: (Signal.TORQUE, True), **_RATES}


@dataclass(frozen=True, slots=True)
class ResponseUnit:
    """What output per input measures."""

    output: Signal
    input: str  # As on the command line
    rotary: bool  # Whether its lengths are angles
    scale: float  # SI value of one such unit; amperes stay amperes


def read_signal_unit(text: str) -> Meaning | None:
    """Return what the unit of a signal measures; None if nothing that is of use here.

    Examples
    --------
    >>> (found := read_signal_unit("mm/s")).signal, found.rotary, found.scale
    (<Signal.VELOCITY: 'velocity'>, False, 0.001)
    >>> read_signal_unit("mg").scale
    0.00980665
    """
    plain = _TURNS_PER_MINUTE.sub("rpm", text.strip())
    if match := _CURRENT.fullmatch(plain):
        return Meaning(signal=Signal.CURRENT, scale={"": 1.0, "m": 1e-3, "k": 1e3}[match[1]])
    if match := _GRAVITIES.fullmatch(plain):
        scale = GRAVITY * (1e-3 if match[1] else 1.0)
        return Meaning(signal=Signal.ACCELERATION, rotary=False, scale=scale)
    for unit in _meanings(plain):
        if unit.exponents in _SIGNALS:
            signal, rotary = _SIGNALS[unit.exponents]
            return Meaning(signal=signal, rotary=rotary, scale=unit.si_value)
    return None


def read_response_unit(text: str) -> ResponseUnit | None:
    """Return what the unit of a response measures; None if it does not tell.

    Examples
    --------
    >>> read_response_unit("rad/s/A")
    ResponseUnit(output=<Signal.VELOCITY: 'velocity'>, input='current', rotary=True, scale=1.0)
    >>> read_response_unit("um/N").scale
    1e-06
    >>> read_response_unit("s/kg").output
    <Signal.VELOCITY: 'velocity'>
    """
    plain = _TURNS_PER_MINUTE.sub("rpm", text.strip())
    per_current = bool(_CURRENT.search(plain))
    plain = _CURRENT.sub(r"\1N", plain)  # a unit that the reader knows, in the ampere's place
    factor = 1.0
    if "kg" not in plain and _GRAVITIES.search(plain):
        plain, factor = _GRAVITIES.sub(r"(\1m/s^2)", plain), GRAVITY
    per = {_FORCE: "current"} if per_current else {_FORCE: "force", _TORQUE: "torque"}
    for unit in _meanings(plain):
        for rate, (signal, rotary) in _RATES.items():
            force = _FORCE if per_current or not rotary else _TORQUE
            exponents = tuple(a - b for a, b in zip(rate, force, strict=True))
            without_radian = (*exponents[:3], 0)
            if unit.exponents == exponents or (rotary and unit.exponents == without_radian):
                return ResponseUnit(signal, per[force], rotary, unit.si_value * factor)
    return None


def _meanings(text: str) -> tuple[Unit, ...]:
    try:
        return read_unit(text) if text else ()
    except Refused:
        return ()
