"""Every number that is shown gets its engineering unit and its digits here, and only here."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10, pi
from typing import TYPE_CHECKING

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
        if self.follows:
            unit = {"N": "m/s^2", "kg": "", "1/kg": ""}.get(unit, unit)
        unit = motion_unit(unit, rotary=self.rotary)
        return self.quantity(value, unit, missing=missing, digits=digits)

    def feed(self, value: float, *, digits: int = 3) -> str:
        """Return a velocity along a path as it is programmed, from m/s.

        Examples
        --------
        >>> Formatter().feed(0.1).split(THIN_SPACE)
        ['6', 'm/min']
        """
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
        if -4 < exponent < 6:
            decimals = max(0, digits - 1 - exponent)
            text = f"{abs(value):.{decimals}f}"
        else:
            mantissa, _, power = f"{abs(value):.{digits - 1}e}".partition("e")
            text = mantissa
        if "." in text:
            text = text.rstrip("0").rstrip(".")
        if not -4 < exponent < 6:
            text = f"{text}×10{str(int(power)).translate(SUPERSCRIPTS)}"
        return ("−" if value < 0.0 else "") + text.replace(".", self.decimal_mark)

    def plain(self, value: float, digits: int, style: str) -> str:
        """Return a number as Python's format prints it, with the language's decimal mark.

        Examples
        --------
        >>> Formatter(decimal_mark=",").plain(1.25, 1, "e")
        '1,2e+00'
        """
        return f"{value:.{digits}{style}}".replace(".", self.decimal_mark)

    def percent(self, fraction: float, *, digits: int = 3) -> str:
        """Return a fraction in per cent."""
        return self.with_unit(self.number(100.0 * fraction, digits=digits), "%")

    def percent_if_known(self, fraction: float | None, *, digits: int = 3) -> str:
        """Return a fraction in per cent; None is a dash."""
        return "–" if fraction is None else self.percent(fraction, digits=digits)

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
    """Return a unit as printed.

    Examples
    --------
    >>> pretty_unit("kg m^2"), pretty_unit("1/(kg)"), pretty_unit("-")
    ('kg·m²', '1/kg', '')
    """
    text = re.sub(r"\^(-?\d)", lambda match: match[1].translate(SUPERSCRIPTS), unit.strip())
    text = re.sub(r"\((\w+)\)", r"\1", text)
    return "" if text == "-" else text.replace(" ", "·")


def symbol(name: str) -> str:
    """Return a state or output as printed.

    Examples
    --------
    >>> symbol("v_phi"), symbol("v_base")
    ('v_φ', 'v_base')
    """
    return name.removesuffix("phi") + "φ" if name in ("phi", "v_phi") else name


def tick_text(value: float, decimal_mark: str) -> str:
    """Return the number at a tick of a plot.

    Examples
    --------
    >>> [tick_text(x, ",") for x in (-0.25, 1000.0, 0.1 + 0.2, 2e-7)]
    ['−0,25', '1000', '0,3', '2×10⁻⁷']
    """
    digits, _, power = f"{value:.6g}".partition("e")
    if power:
        digits += f"×10{str(int(power)).translate(SUPERSCRIPTS)}"
    return digits.replace("-", "−").replace(".", decimal_mark)


def motion_unit(unit: str, *, rotary: bool) -> str:
    """Return the unit of the axis's own motion: m becomes rad on a rotary axis, N becomes N m.

    Examples
    --------
    >>> motion_unit("m/s^2", rotary=True), motion_unit("kg", rotary=True)
    ('rad/s^2', 'kg m^2')
    """
    swap = {
        "m": "rad",
        "N": "N m",
        "kg": "kg m^2",
        "N s/m": "N m s/rad",
        "N/m": "N m/rad",
        "1/kg": "1/(kg m^2)",
    }
    if not rotary:
        return unit
    return swap.get(unit, re.sub(r"^m/", "rad/", unit))
