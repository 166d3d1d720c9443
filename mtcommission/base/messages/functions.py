"""What the texts call to print a number, e.g. ``{ LENGTH($band) }``.

A function named after a quantity knows its unit, on a linear axis and on a rotary one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from mtcommission.base.messages.quantities import DIGITS, SUPERSCRIPTS, Formatter, symbol

UNITS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "LENGTH": ("m", "rad"),
        "VELOCITY": ("m/s", "rad/s"),
        "ACCELERATION": ("m/s^2", "rad/s^2"),
        "JERK": ("m/s^3", "rad/s^3"),
        "FORCE": ("N", "N m"),
        "MASS": ("kg", "kg m^2"),
        "STIFFNESS": ("N/m", "N m/rad"),
        "DAMPING": ("N s/m", "N m s/rad"),
        "COMPLIANCE": ("m/N", "rad/(N m)"),
        "GAIN": ("1/kg", "1/(kg m^2)"),
        "TIME": ("s", "s"),
        "FREQUENCY": ("Hz", "Hz"),
        "RATE": ("1/s", "1/s"),
        "DECIBEL": ("dB", "dB"),
        "DEGREE": ("°", "°"),
    }
)
"""Functions of the texts for quantities: SI unit on a linear axis and on a rotary one."""

FOLLOWED: Mapping[str, tuple[str, str]] = {
    **UNITS,
    "FORCE": UNITS["ACCELERATION"],
    "MASS": ("", ""),
    "GAIN": ("", ""),
    "COMPLIANCE": ("s^2", "s^2"),
}
"""The same where the motor follows its setpoint, and its acceleration stands for every force."""

PER_SI: Mapping[str, float] = MappingProxyType(
    {"": 1.0, "%": 100.0, "ms": 1e3, "us": 1e6, "ns": 1e9, "kN": 1e-3, "mrad": 1e3, "urad": 1e6}
)
"""Units in which a text may ask for a plain number, and how many make one of SI."""


def functions_of(form: Formatter) -> dict[str, Callable[..., Any]]:
    """Return the functions that texts may call, by name; the formatter knows axis and language.

    ``QUANTITY($x, "m/s")``
        A value with its engineering unit, from an SI unit that is the same for every axis.
    ``NUMBER($x, digits: 3)``, ``PLAIN($x, digits: 6, unit: "ms", style: "f")``
        A number as print has it, 1×10⁶, and as one types it, 1e+06.
    ``ROUND($x, digits: 3, unit: "ms")``, ``SI($x, "LENGTH")``
        The same with powers of ten as printed; with its SI unit.
    ``SHARE($x)``, ``PERCENT($x)``, ``CHANGE($x)``
        A share in per cent with three digits, in whole per cent, and a change with its sign.
    ``FEED($x)``
        A velocity along a path, in m/min.
    ``SYMBOL($name)``
        A state or output, with Greek letters.

    Examples
    --------
    >>> functions_of(Formatter(rotary=True))["SI"](2.5, "FORCE")
    '2.5 N m'
    """
    units = FOLLOWED if form.follows else UNITS

    def plain(value: object, digits: object = DIGITS, unit: str = "", style: object = "g") -> str:
        return form.plain(PER_SI[unit] * (_number(value) or 0.0), int(str(digits)), str(style))

    def rounded(value: object, digits: object = DIGITS, unit: str = "") -> str:
        number, _, power = plain(value, digits, unit).partition("e")
        return f"{number}×10{str(int(power)).translate(SUPERSCRIPTS)}" if power else number

    def quantity(unit: str) -> Callable[..., str]:
        return lambda value, digits=DIGITS: form.quantity(_number(value), unit, digits=int(digits))

    return {name: quantity(both[form.rotary]) for name, both in units.items()} | {
        "QUANTITY": lambda value, unit: form.quantity(_number(value), str(unit)),
        "NUMBER": lambda value, digits=DIGITS: form.number(
            _number(value) or 0.0, digits=int(digits)
        ),
        "PLAIN": plain,
        "ROUND": rounded,
        "SI": lambda value, quantity, digits=DIGITS: (
            f"{rounded(value, digits)} {_printed(units[str(quantity)][form.rotary])}"
        ),
        "SHARE": lambda value, digits=3: form.percent_if_known(_number(value), digits=int(digits)),
        "PERCENT": lambda value: form.with_unit(f"{100.0 * (_number(value) or 0.0):.0f}", "%"),
        "CHANGE": lambda value: form.signed_percent(_number(value) or 0.0),
        "FEED": lambda value: form.feed(_number(value) or 0.0),
        "SYMBOL": lambda name: symbol(str(name)),
    }


def _printed(unit: str) -> str:
    return re.sub(r"\^(-?\d)", lambda power: power[1].translate(SUPERSCRIPTS), unit)


def _number(value: object) -> float | None:
    """A number as Fluent hands it over; an empty text stands for one that is not known."""
    return None if value == "" else float(value)  # type: ignore[arg-type]
