"""Quantities with units: "44.41 N/um" -> 44.41e6, if a stiffness is wanted.

"52.2 ms" is the same number as 0.0522, to the last bit.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import isfinite, pi
from textwrap import wrap

from mtcommission.units.advice import find_worth, list_candidates
from mtcommission.units.symbols import LONGEST_TEXT, ONE, SYMBOLS, Unit, read_unit

LARGEST = 10**300
"""Beyond it a number is as good as infinite."""

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
DIGITS = re.compile(r"[+-]?[0-9.,]*[0-9]")
_INSIDE = re.compile(
    r"(?<=[0-9]) (?=[A-Za-z%µ(])(?!to |and )|(?<=[kMG]N) (?=[ms])|(?<=[0-9] N) (?=[ms])"
    r"|(?<=kg) (?=m)"
)
"""Blanks between a number and its unit, or inside a unit."""


@dataclass(frozen=True, slots=True)
class Dimension:
    """A kind of quantity: what a unit must measure.

    Parameters
    ----------
    name
        With its article, for messages: "a mass".
    si
        The SI unit, for messages.
    forms
        Units that count as 1 of this quantity. The first is the SI unit; further ones admit
        what is written by custom, e.g. N m beside N m/rad.
    usual
        Units to propose, with their preposition.
    """

    name: str
    si: str
    forms: tuple[Unit, ...]
    usual: str

    def per(self, other: Dimension) -> Dimension:
        """Return the quantity "this per other", e.g. a force per velocity."""
        forms = tuple(a * b**-1 for a, b in product(self.forms, other.forms))
        si = f"{self.si}/({other.si})"
        return Dimension(f"{self.name} per {other.name.split(' ', 1)[1]}", si, forms, f"in {si}")

    def squared(self) -> Dimension:
        """Return the square of the quantity."""
        forms = tuple(unit**2 for unit in self.forms)
        return Dimension(f"{self.name} squared", f"({self.si})^2", forms, f"in ({self.si})^2")


def parse_quantity(text: str, dimension: Dimension, *, decimal_comma: bool = False) -> float:
    """Return the SI value of a number with a unit; a bare number is SI already.

    Parameters
    ----------
    text
        E.g. ``"44.41 N/um"``.
    dimension
        What it must be.
    decimal_comma
        Whether ``"2,5 ms"`` is read as 2.5 ms instead of refused.

    Returns
    -------
    float
        The double nearest to the exact value; finite.

    Raises
    ------
    ValueError
        With a message that says what was got and what to write.

    Examples
    --------
    >>> parse_quantity("44.41 N/um", STIFFNESS)
    44410000.0
    >>> parse_quantity("20 deg", LENGTH)
    Traceback (most recent call last):
    ...
    ValueError: got "20 deg", which is an angle; must be a length, in m, mm, um or nm
    """
    text = text.replace("\t", " ")
    shown = _shorten(text)
    if not text.isprintable():
        raise ValueError(f'got "{shown}" with control characters; remove them')
    if len(text) > LONGEST_TEXT:
        raise ValueError(f'got "{shown}"; a quantity has at most {LONGEST_TEXT} characters')
    number, unit = _split_number(text, shown, dimension, decimal_comma=decimal_comma)
    try:
        meanings = read_unit(unit)
    except ValueError as error:
        advice = _advise(unit, dimension)
        raise ValueError(f'got "{shown}": {error}{advice}; {_expected(dimension)}') from error
    if not unit:
        return _value(number, ONE, shown)
    for meaning, form in product(meanings, dimension.forms):
        if meaning.exponents == form.exponents:
            return _value(number, meaning * form**-1, shown)
    hint = "; g is the gram here, write 9.81 m/s^2" if unit == "g" else ""
    name = _name(meanings[0])
    advice = _advise(unit, dimension) if name.startswith("a quantity in") else ""
    raise ValueError(f'got "{shown}", which is {name}{advice}; {_expected(dimension)}{hint}')


def _advise(unit: str, dimension: Dimension) -> str:
    """Return what the unit is worth, or which one may have been meant that fits here."""
    worth = find_worth(unit)
    if worth:
        return f" ({worth})"
    usual = re.split(", | or ", dimension.usual.removeprefix("in "))
    for candidate in list_candidates(unit, usual, tuple(SYMBOLS)):
        if _fits(candidate, dimension):
            return f' (did you mean "{candidate}"?)'
    return ""


def _fits(unit: str, dimension: Dimension) -> bool:
    try:
        meanings = read_unit(unit)
    except ValueError:
        return False
    exponents = {form.exponents for form in dimension.forms}
    return any(meaning.exponents in exponents for meaning in meanings)


def _split_number(
    text: str, shown: str, dimension: Dimension, *, decimal_comma: bool
) -> tuple[str, str]:
    """Return number and unit of a quantity as texts."""
    plain = text.strip().replace("\N{MINUS SIGN}", "-")
    digits = DIGITS.match(plain)
    if digits is not None and "," in digits[0]:
        plain = digits[0].replace(",", ".") + plain[digits.end() :]
        if plain.count(".", 0, digits.end()) > 1:
            raise ValueError(f'got "{shown}"; write the number without thousands separators')
        if not decimal_comma:
            raise ValueError(f'got "{shown}" with a comma; write it with a point: "{plain}"')
    match = NUMBER.match(plain)
    if match is not None:
        return match[0], plain[match.end() :].strip()
    if re.match(r"[+-]?(nan|inf)", plain, re.IGNORECASE):
        raise ValueError(f'got "{shown}", must be a finite number; {_expected(dimension)}')
    raise ValueError(f'got "{shown}", which does not begin with a number; {_expected(dimension)}')


def _value(number: str, unit: Unit, shown: str) -> float:
    rough = float(number)
    if not isfinite(rough):
        raise ValueError(f'got "{shown}", must be a finite number')
    # Also keeps "0e999999999" from being spelt out as a fraction.
    if rough == 0.0:
        return 0.0
    exact = Fraction(number) * unit.factor
    if abs(exact) > LARGEST:
        raise ValueError(f'got "{shown}", must be a finite number')
    return float(exact) * pi**unit.pi_power


def convert_to(value: float, unit: str) -> float:
    """Return an SI value in another unit, for output.

    Parameters
    ----------
    value
        SI.
    unit
        Wanted unit, e.g. ``"mm/s^2"``.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If the unit is unknown.

    Examples
    --------
    >>> convert_to(2.5, "mm/s^2")
    2500.0
    """
    return value / read_unit(unit)[0].si_value


def wrap_whole(text: str, width: int, *, indent: str = "") -> list[str]:
    """Return the lines of a text; none ends between a number and its unit.

    Parameters
    ----------
    text
        One paragraph.
    width
        Most characters of a line.
    indent
        What every line but the first begins with.

    Returns
    -------
    list of str

    Examples
    --------
    >>> wrap_whole("so soft as 8 N s/m", 16)
    ['so soft as', '8 N s/m']
    """
    whole = _INSIDE.sub("\N{NO-BREAK SPACE}", text)
    lines = wrap(whole, width, subsequent_indent=indent)
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in lines]


def _shorten(text: str) -> str:
    printable = "".join(letter if letter.isprintable() else "?" for letter in text)
    return printable if len(printable) <= LONGEST_TEXT else printable[: LONGEST_TEXT - 3] + "..."


def _expected(dimension: Dimension) -> str:
    return f"must be {dimension.name}, {dimension.usual}"


def _name(unit: Unit) -> str:
    for dimension in DIMENSIONS:
        if unit.exponents == dimension.forms[0].exponents:
            return dimension.name
    parts = zip(("m", "kg", "s", "rad"), unit.exponents, strict=True)
    symbols = [symbol if power == 1 else f"{symbol}^{power}" for symbol, power in parts if power]
    return "a quantity in " + " ".join(symbols)


def _dimension(name: str, si: str, usual: str, *custom: Unit) -> Dimension:
    return Dimension(name, si, (read_unit(si)[0], *custom), usual)


# The radian counts, but custom drops it wherever no length could be meant instead.
MASS = _dimension("a mass", "kg", "in kg, g or t")
LENGTH = _dimension("a length", "m", "in m, mm, um or nm")
ANGLE = _dimension("an angle", "rad", "in rad, mrad, deg, arcsec or rev")
TIME = _dimension("a time", "s", "in s, ms, us or min")
FREQUENCY = _dimension(
    "a frequency", "Hz", "in Hz, kHz or 1/min", Unit((0, 0, -1, 1), Fraction(2), 1)
)
FORCE = _dimension("a force", "N", "in N, kN or MN")
TORQUE = _dimension("a torque", "N m", "in N m or kN m")
INERTIA = _dimension("a moment of inertia", "kg m^2", "in kg m^2, kg cm^2 or kg mm^2")
VELOCITY = _dimension("a velocity", "m/s", "in m/s, mm/s, m/min or mm/min")
ANGULAR_VELOCITY = _dimension("an angular velocity", "rad/s", "in rad/s, deg/s or rev/min")
ACCELERATION = _dimension("an acceleration", "m/s^2", "in m/s^2 or mm/s^2")
ANGULAR_ACCELERATION = _dimension("an angular acceleration", "rad/s^2", "in rad/s^2 or deg/s^2")
JERK = _dimension("a jerk", "m/s^3", "in m/s^3 or mm/s^3")
ANGULAR_JERK = _dimension("an angular jerk", "rad/s^3", "in rad/s^3 or deg/s^3")
STIFFNESS = _dimension("a stiffness", "N/m", "in N/m, N/mm, N/um or kN/mm")
DAMPING = _dimension("a damping constant", "N s/m", "in N s/m or kN s/m")
ROTARY_STIFFNESS = _dimension("a rotary stiffness", "N m/rad", "in N m/rad", Unit((2, 1, -2, 0)))
ROTARY_DAMPING = _dimension(
    "a rotary damping constant", "N m s/rad", "in N m s/rad", Unit((2, 1, -1, 0))
)
GAIN = _dimension("a position gain", "1/s", "in 1/s or (m/min)/mm")
PER_MASS = _dimension("a gain per mass", "1/kg", "in 1/kg")
PER_INERTIA = _dimension("a gain per inertia", "1/(kg m^2)", "in 1/(kg m^2)", Unit((-2, -1, 0, 1)))
MODAL_DEFLECTION = _dimension("a modal deflection", "N s^2", "in N s^2")
MODAL_RATE = _dimension("a modal rate", "N s", "in N s")
ROTARY_MODAL_DEFLECTION = _dimension("a rotary modal deflection", "N m s^2", "in N m s^2")
ROTARY_MODAL_RATE = _dimension("a rotary modal rate", "N m s", "in N m s")
RATIO = _dimension("a ratio", "", "without a unit or in %")

DIMENSIONS = (
    MASS, LENGTH, ANGLE, TIME, FREQUENCY, FORCE, TORQUE, INERTIA, VELOCITY, ANGULAR_VELOCITY,
    ACCELERATION, ANGULAR_ACCELERATION, JERK, ANGULAR_JERK, STIFFNESS, DAMPING,
    ROTARY_STIFFNESS, ROTARY_DAMPING, PER_MASS, PER_INERTIA, RATIO,
)  # fmt: skip
"""All dimensions with a name of their own; a gain is a frequency by its exponents."""
