"""Units of signals and of responses: which quantity, on which kind of axis, how much in SI.

Amperes and multiples of gravity are no units of a profile, so they are dealt with here.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from mtcommission.base.errors import Refused
from mtcommission.base.units.symbols import Unit, read_unit
from mtcommission.identify.measurement import (
    MOTIONS,
    Signal,
)

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
class SignalUnit:
    """What a unit measures."""

    signal: Signal  # A position, velocity, acceleration, force, torque or current
    rotary: bool | None  # Whether its lengths are angles; None for a current
    scale: float  # SI value of one such unit


@dataclass(frozen=True, slots=True)
class ResponseUnit:
    """What output per input measures."""

    output: Signal
    input: str  # As on the command line
    rotary: bool  # Whether its lengths are angles
    scale: float  # SI value of one such unit; amperes stay amperes


def read_signal_unit(text: str) -> SignalUnit | None:
    """Return what the unit of a signal measures; None if nothing that is of use here.

    Examples
    --------
    >>> read_signal_unit("mm/s")
    SignalUnit(signal=<Signal.VELOCITY: 'velocity'>, rotary=False, scale=0.001)
    >>> read_signal_unit("mg").scale
    0.00980665
    """
    plain = _TURNS_PER_MINUTE.sub("rpm", text.strip())
    if match := _CURRENT.fullmatch(plain):
        return SignalUnit(Signal.CURRENT, None, {"": 1.0, "m": 1e-3, "k": 1e3}[match[1]])
    if match := _GRAVITIES.fullmatch(plain):
        return SignalUnit(Signal.ACCELERATION, False, GRAVITY * (1e-3 if match[1] else 1.0))
    for unit in _meanings(plain):
        if unit.exponents in _SIGNALS:
            return SignalUnit(*_SIGNALS[unit.exponents], unit.si_value)
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
            exponents = _ratio(rate, force)
            without_radian = (*exponents[:3], 0)
            if unit.exponents == exponents or (rotary and unit.exponents == without_radian):
                return ResponseUnit(signal, per[force], rotary, unit.si_value * factor)
    return None


def _meanings(text: str) -> tuple[Unit, ...]:
    try:
        return read_unit(text) if text else ()
    except Refused:
        return ()


def _ratio(above: Exponents, below: Exponents) -> Exponents:
    m, kg, s, rad = (a - b for a, b in zip(above, below, strict=True))
    return m, kg, s, rad
