"""Every number that is shown gets its engineering unit and its digits here, and only here."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10, pi
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

THIN_SPACE = "\N{NARROW NO-BREAK SPACE}"
DIGITS = 4
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
FINEST = 5e-5
"""Change or overshoot below which it is nothing: half of 0.01 %."""


@dataclass(frozen=True, slots=True)
class Scale:
    """An engineering unit: value in it = SI value / ``size``."""

    size: float
    unit: str  # as printed
    least: float = 1.0  # value in this unit from which it is used


_LADDERS: dict[str, tuple[Scale, ...]] = {
    "m": (Scale(1.0, "m", 0.5), Scale(1e-3, "mm"), Scale(1e-6, "µm", 0.1), Scale(1e-9, "nm")),
    "m/s": (Scale(1.0, "m/s", 0.01), Scale(1e-3, "mm/s", 0.1), Scale(1e-6, "µm/s")),
    "m/s^2": (Scale(1.0, "m/s²", 0.01), Scale(1e-3, "mm/s²")),
    "m/s^3": (Scale(1.0, "m/s³"),),
    "s": (Scale(1.0, "s"), Scale(1e-3, "ms"), Scale(1e-6, "µs")),
    "N": (Scale(1e3, "kN"), Scale(1.0, "N"), Scale(1e-3, "mN")),
    "N m": (Scale(1e3, "kN·m"), Scale(1.0, "N·m"), Scale(1e-3, "mN·m")),
    "N/m": (Scale(1e6, "N/µm"), Scale(1e3, "N/mm"), Scale(1.0, "N/m")),
    "N s/m": (Scale(1e3, "kN·s/m"), Scale(1.0, "N·s/m")),
    "N m/rad": (Scale(1e6, "MN·m/rad"), Scale(1e3, "kN·m/rad"), Scale(1.0, "N·m/rad")),
    "N m s/rad": (Scale(1e3, "kN·m·s/rad"), Scale(1.0, "N·m·s/rad")),
    "N^2 s": (Scale(1e6, "kN²·s", 0.1), Scale(1.0, "N²·s")),
    "N^2 m^2 s": (Scale(1e6, "kN²·m²·s", 0.1), Scale(1.0, "N²·m²·s")),
    "Hz": (Scale(1e3, "kHz"), Scale(1.0, "Hz")),
    "m/N": (Scale(1e-6, "µm/N"), Scale(1e-9, "µm/kN")),
    "rad/(N m)": (Scale(1e-3, "mrad/(N·m)"), Scale(1e-6, "µrad/(N·m)")),
    "rad": (Scale(1.0, "rad"), Scale(1e-3, "mrad"), Scale(1e-6, "µrad")),
    "rad/s": (Scale(1.0, "rad/s"), Scale(1e-3, "mrad/s"), Scale(1e-6, "µrad/s")),
}
"""Units by SI unit, largest first; a value takes the first that it fills."""

SMALLEST = 0.1e-9
"""Lengths below that are not told apart: an atom's radius [m]."""

_CUT = frozenset({"m/s^2", "m/s^3", "rad/s^2", "rad/s^3"})
"""Found by the search to three digits of SI, never stated in a profile: integers are cut, too."""

_DEGREE, _ARCSEC = pi / 180.0, pi / 180.0 / 3600.0
_ROTARY_LADDERS: dict[str, tuple[Scale, ...]] = {
    "rad": (Scale(_DEGREE, "°", 0.1), Scale(_ARCSEC, "″")),
    "rad/s": (Scale(_DEGREE, "°/s", 0.1), Scale(_ARCSEC, "″/s")),
    "rad/s^2": (Scale(_DEGREE, "°/s²"),),
    "rad/s^3": (Scale(_DEGREE, "°/s³"),),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Formatter:
    """Prints SI values for one axis in one language."""

    rotary: bool = False  # whether angles are the axis' coordinate (degrees) or a tilt (mrad)
    decimal_mark: str = "."  # of the language
    follows: bool = False  # whether an open-loop axis: acceleration stands for every force

    def quantity(
        self, value: float | None, unit: str, *, missing: str = "–", digits: int = DIGITS
    ) -> str:
        """Return a value with its engineering unit, e.g. ``"105.6 ms"``.

        The value is SI, its unit as the record spells it, e.g. ``"m/s^2"``, or "" for a plain
        number; ``missing`` is printed for None, and integers are never cut to ``digits``.

        Examples
        --------
        >>> linear = Formatter()
        >>> linear.quantity(4.5826e-6, "m").split(THIN_SPACE)
        ['4.583', 'µm']
        >>> Formatter(rotary=True).quantity(1810.0, "rad/s^3")
        '103700°/s³'
        >>> linear.quantity(2.4e-12, "m").replace(THIN_SPACE, " ")
        '< 0.1 nm'
        """
        if value is None or not isfinite(value):
            return missing
        if unit == "m" and 0.0 < abs(value) < SMALLEST:
            return f"< {self.with_unit(self.number(SMALLEST / 1e-9), 'nm')}"
        scale = self.scale(abs(value), unit)
        shown = value / scale.size
        if unit in _CUT:
            shown = float(f"{shown:.{DIGITS}g}")
        return self.with_unit(self.number(shown, digits=digits), scale.unit)

    def axis(
        self, value: float | None, unit: str, *, missing: str = "–", digits: int = DIGITS
    ) -> str:
        """Return a value of the axis's own motion by the unit it has on a linear axis."""
        unit = motion_unit(unit, rotary=self.rotary, follows=self.follows)
        return self.quantity(value, unit, missing=missing, digits=digits)

    def feed(self, value: float, *, digits: int = 3) -> str:
        """Return a velocity along a path as it is programmed, from m/s."""
        return self.with_unit(self.number(60.0 * value, digits=digits), "m/min")

    def with_unit(self, number: str, unit: str) -> str:
        """Return number and unit with a thin space; degrees follow without one."""
        gap = "" if unit[:1] in ("", "°", "″") else THIN_SPACE
        return f"{number}{gap}{unit}"

    def scale(self, magnitude: float, unit: str) -> Scale:
        """Return the engineering unit for a magnitude [SI]."""
        ladder = self._ladder(unit)
        if ladder is None:
            return Scale(1.0, pretty_unit(unit))
        if magnitude == 0.0:
            return min(ladder, key=lambda step: abs(log10(step.size)))
        for step in ladder:
            # Half a digit of tolerance, so that 0.99999 ms and 1.0 ms share a unit.
            if magnitude / step.size >= step.least * (1.0 - 0.5 * 10.0**-DIGITS):
                return step
        return ladder[-1]

    def scale_for(self, series: Sequence[Array], unit: str) -> Scale:
        """Return one engineering unit for all of some series, for the axis of a plot."""
        largest = max((float(abs(part).max()) for part in series if part.size), default=0.0)
        return self.scale(largest, unit)

    def number(self, value: float, *, digits: int = DIGITS) -> str:
        """Return a number with significant digits; powers of ten beyond 1e6 and below 1e-3.

        Integers below 1e6 are never cut.

        Examples
        --------
        >>> f = Formatter()
        >>> [f.number(x) for x in (0.0, -2.5, 123456.0, 1.8858e15, 1e-10)]
        ['0', '−2.5', '123456', '1.886×10¹⁵', '1×10⁻¹⁰']
        """
        if value == 0.0:
            return "0"
        exponent = floor(log10(abs(value)))
        form = f".{max(0, digits - 1 - exponent)}f" if -4 < exponent < 6 else f".{digits - 1}e"
        mantissa, mark, power = f"{abs(value):{form}}".partition("e")
        if "." in mantissa:
            mantissa = mantissa.rstrip("0").rstrip(".")
        text = raise_power(f"{mantissa}{mark}{power}").replace(".", self.decimal_mark)
        return f"−{text}" if value < 0.0 else text

    def plain(self, value: float, digits: int, style: str) -> str:
        """Return a number as Python's format prints it, with the language's decimal mark."""
        return f"{value:.{digits}{style}}".replace(".", self.decimal_mark)

    def percent(self, fraction: float | None, *, digits: int = 3) -> str:
        """Return a fraction in per cent; None is a dash."""
        if fraction is None:
            return "–"
        return self.with_unit(self.number(100.0 * fraction, digits=digits), "%")

    def signed_percent(self, fraction: float) -> str:
        """Return a change in per cent with its sign; below 0.005 % it is none.

        Examples
        --------
        >>> Formatter().signed_percent(-1e-7).split(THIN_SPACE)
        ['0', '%']
        >>> Formatter().signed_percent(0.25).split(THIN_SPACE)
        ['+25', '%']
        """
        shown = 0.0 if abs(fraction) < FINEST else fraction
        return ("+" if shown > 0.0 else "") + self.percent(shown)

    def _ladder(self, unit: str) -> tuple[Scale, ...] | None:
        if self.rotary and unit in _ROTARY_LADDERS:
            return _ROTARY_LADDERS[unit]
        return _LADDERS.get(unit)


def pretty_unit(unit: str) -> str:
    """Return a unit as printed."""
    text = re.sub(r"\^(-?\d)", lambda match: match[1].translate(SUPERSCRIPTS), unit.strip())
    text = re.sub(r"\((\w+)\)", r"\1", text)
    return "" if text == "-" else text.replace(" ", "·")


def symbol(name: str) -> str:
    """Return a state or output as printed."""
    return name.removesuffix("phi") + "φ" if name in ("phi", "v_phi") else name


def tick_text(value: float, decimal_mark: str) -> str:
    """Return the number at a tick of a plot."""
    return raise_power(f"{value:.6g}").replace("-", "−").replace(".", decimal_mark)


def raise_power(number: str) -> str:
    """Return a number of Python's as printed: 1e-06 is 1×10⁻⁶."""
    digits, _, power = number.partition("e")
    return f"{digits}×10{str(int(power)).translate(SUPERSCRIPTS)}" if power else digits


def motion_unit(unit: str, *, rotary: bool, follows: bool = False) -> str:
    """Return the unit of the axis's own motion, by what it is on a linear axis with a force."""
    both = FOLLOWED if follows else UNITS
    known = {UNITS[name][0]: pair[rotary] for name, pair in both.items()}
    return known.get(unit, unit)


# What the texts call to print a number, e.g. ``{ LENGTH($band) }``


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
        return raise_power(plain(value, digits, unit))

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
        "SHARE": lambda value, digits=3: form.percent(_number(value), digits=int(digits)),
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
