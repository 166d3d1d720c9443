"""Quantities with units: "44.41 N/um" -> 44.41e6, if a stiffness is wanted.

"52.2 ms" is the same number as 0.0522, to the last bit.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from fractions import Fraction
from itertools import product
from math import isfinite, pi
from textwrap import wrap

from mtcommission.base.errors import Refused
from mtcommission.base.messages.message import Message
from mtcommission.base.units.symbols import LONGEST_TEXT, ONE, SYMBOLS, Unit, read_unit

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
    """A kind of quantity: what a unit must measure."""

    si: str  # the SI unit, for messages; "": a ratio
    forms: tuple[Unit, ...]
    """Units that count as 1 of this quantity. The first is the SI unit; further ones admit what is
    written by custom, e.g. N m beside N m/rad."""
    usual: tuple[str, ...]  # units to propose

    @property
    def expected(self) -> Message:
        """In which units it must be, e.g. in kg, g or t."""
        *first, last = self.usual
        units = Message("either", first=", ".join(first), last=last) if first else last
        return Message("quantity-expected" if self.si else "ratio-expected", units=units)

    def per(self, other: Dimension) -> Dimension:
        """Return the quantity "this per other", e.g. a force per velocity."""
        forms = tuple(a * b**-1 for a, b in product(self.forms, other.forms))
        si = f"{self.si}/({other.si})"
        return Dimension(si, forms, (si,))

    def squared(self) -> Dimension:
        """Return the square of the quantity."""
        forms = tuple(unit**2 for unit in self.forms)
        si = f"({self.si})^2"
        return Dimension(si, forms, (si,))


def parse_quantity(text: str, dimension: Dimension, *, decimal_comma: bool = False) -> float:
    """Return the SI value of a number with a unit, to the last bit; a bare number is SI already.

    ``decimal_comma``: whether ``"2,5 ms"`` is read as 2.5 ms instead of refused.

    Raises Refused with a message that says what was got and what to write.

    Examples
    --------
    >>> parse_quantity("44.41 N/um", STIFFNESS)
    44410000.0
    >>> parse_quantity("20 s", FORCE)
    Traceback (most recent call last):
    ...
    mtcommission.base.errors.Refused: got "20 s"; must be in N, kN or MN
    """
    text = text.replace("\t", " ")
    shown = _shorten(text)
    if not text.isprintable():
        raise Refused(Message("text-with-control-characters"))
    if len(text) > LONGEST_TEXT:
        raise Refused(Message("quantity-too-long", got=shown, most=LONGEST_TEXT))
    number, unit = _split_number(text, shown, dimension, decimal_comma=decimal_comma)
    try:
        meanings = read_unit(unit)
    except Refused as error:
        raise Refused(
            Message(
                "quantity-without-unit",
                got=shown,
                why=error.message,
                advice=_advise(unit, dimension),
                expected=dimension.expected,
            )
        ) from error
    if not unit:
        return _value(number, ONE, shown)
    for meaning, form in product(meanings, dimension.forms):
        if meaning.exponents == form.exponents:
            return _value(number, meaning * form**-1, shown)
    gram = Message("g-is-the-gram") if unit == "g" else None
    advice = gram or _advise(unit, dimension)
    raise Refused(
        Message("quantity-in-other", got=shown, advice=advice, expected=dimension.expected)
    )


def _advise(unit: str, dimension: Dimension) -> Message | None:
    """Return what the unit is worth, or which one may have been meant that fits here."""
    worth = find_worth(unit)
    if worth:
        return Message("unit-worth", worth=worth)
    for candidate in list_candidates(unit, dimension.usual, tuple(SYMBOLS)):
        if _fits(candidate, dimension):
            return Message("unit-meant", unit=candidate)
    return None


def _fits(unit: str, dimension: Dimension) -> bool:
    try:
        meanings = read_unit(unit)
    except Refused:
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
            raise Refused(Message("number-with-separators", got=shown))
        if not decimal_comma:
            raise Refused(Message("number-with-comma", got=shown, wanted=plain))
    match = NUMBER.match(plain)
    if match is not None:
        return match[0], plain[match.end() :].strip()
    if re.match(r"[+-]?(nan|inf)", plain, re.IGNORECASE):
        raise Refused(Message("got-infinite", got=f'"{shown}"'))
    raise Refused(Message("quantity-without-number", got=shown, expected=dimension.expected))


def _value(number: str, unit: Unit, shown: str) -> float:
    rough = float(number)
    if not isfinite(rough):
        raise Refused(Message("got-infinite", got=f'"{shown}"'))
    # Also keeps "0e999999999" from being spelt out as a fraction.
    if rough == 0.0:
        return 0.0
    exact = Fraction(number) * unit.factor
    if abs(exact) > LARGEST:
        raise Refused(Message("got-infinite", got=f'"{shown}"'))
    return float(exact) * pi**unit.pi_power


def convert_to(value: float, unit: str) -> float:
    """Return an SI value in another unit, for output; raise ValueError if the unit is unknown.

    Examples
    --------
    >>> convert_to(2.5, "mm/s^2")
    2500.0
    """
    return value / read_unit(unit)[0].si_value


def wrap_whole(text: str, width: int, *, indent: str = "") -> list[str]:
    """Return the lines of a paragraph; none ends between a number and its unit.

    ``indent``: what every line but the first begins with.

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


def _dimension(usual: str, *custom: Unit) -> Dimension:
    """A dimension by its usual units, the first of which is the SI unit."""
    units = tuple(usual.split(", "))
    return Dimension(units[0], (read_unit(units[0])[0], *custom), units)


# The radian counts, but custom drops it wherever no length could be meant instead.
MASS = _dimension("kg, g, t")
LENGTH = _dimension("m, mm, um, nm")
ANGLE = _dimension("rad, mrad, deg, arcsec, rev")
TIME = _dimension("s, ms, us, min")
FREQUENCY = _dimension("Hz, kHz, 1/min", Unit((0, 0, -1, 1), Fraction(2), 1))
FORCE = _dimension("N, kN, MN")
TORQUE = _dimension("N m, kN m")
INERTIA = _dimension("kg m^2, kg cm^2, kg mm^2")
VELOCITY = _dimension("m/s, mm/s, m/min, mm/min")
ANGULAR_VELOCITY = _dimension("rad/s, deg/s, rev/min")
ACCELERATION = _dimension("m/s^2, mm/s^2")
ANGULAR_ACCELERATION = _dimension("rad/s^2, deg/s^2")
JERK = _dimension("m/s^3, mm/s^3")
ANGULAR_JERK = _dimension("rad/s^3, deg/s^3")
STIFFNESS = _dimension("N/m, N/mm, N/um, kN/mm")
DAMPING = _dimension("N s/m, kN s/m")
ROTARY_STIFFNESS = _dimension("N m/rad", Unit((2, 1, -2, 0)))
ROTARY_DAMPING = _dimension("N m s/rad", Unit((2, 1, -1, 0)))
GAIN = _dimension("1/s, (m/min)/mm")
PER_MASS = _dimension("1/kg")
PER_INERTIA = _dimension("1/(kg m^2)", Unit((-2, -1, 0, 1)))
MODAL_DEFLECTION = _dimension("N s^2")
MODAL_RATE = _dimension("N s")
ROTARY_MODAL_DEFLECTION = _dimension("N m s^2")
ROTARY_MODAL_RATE = _dimension("N m s")
RATIO = Dimension("", (ONE,), ("%",))

DIMENSIONS = (
    MASS, LENGTH, ANGLE, TIME, FREQUENCY, FORCE, TORQUE, INERTIA, VELOCITY, ANGULAR_VELOCITY,
    ACCELERATION, ANGULAR_ACCELERATION, JERK, ANGULAR_JERK, STIFFNESS, DAMPING,
    ROTARY_STIFFNESS, ROTARY_DAMPING, PER_MASS, PER_INERTIA, RATIO, MODAL_DEFLECTION, MODAL_RATE,
    ROTARY_MODAL_DEFLECTION, ROTARY_MODAL_RATE,
)  # fmt: skip
"""All that a signal may be; a gain is a frequency by its exponents."""


# What somebody meant who typed a unit that is none


MEANT = {
    "kgs": "kg", "kilo": "kg", "kilos": "kg", "kilogram": "kg", "kilograms": "kg", "to": "t",
    "tons": "t", "tonne": "t", "tonnes": "t", "gram": "g", "grams": "g",
    "meter": "m", "meters": "m", "metre": "m", "metres": "m", "micron": "um", "microns": "um",
    "mu": "um", "mic": "um", "my": "um", "millimeter": "mm", "millimeters": "mm",
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "usec": "us",
    "mins": "min", "minute": "min", "minutes": "min", "mn": "min",
    "newton": "N", "newtons": "N", "kilonewton": "kN", "hertz": "Hz", "hz": "Hz",
    "u": "rev", "r": "rev", "turn": "rev", "turns": "rev", "umdr": "rev", "revs": "rev",
    "grad": "deg", "degree": "deg", "degrees": "deg", "degs": "deg", "radian": "rad",
    "radians": "rad", "mil": "mm",
}  # fmt: skip
"""Words by what people write for them, in lower case."""

FOREIGN = {
    "lb": "1 lb = 0.45359237 kg", "lbs": "1 lb = 0.45359237 kg", "lbf": "1 lbf = 4.4482216 N",
    "oz": "1 oz = 0.028349523 kg", "in": "1 in = 25.4 mm", "inch": "1 in = 25.4 mm",
    "inches": "1 in = 25.4 mm", "ft": "1 ft = 0.3048 m", "feet": "1 ft = 0.3048 m",
    "kp": "1 kp = 9.80665 N", "kgf": "1 kgf = 9.80665 N", "ipm": "1 ipm = 25.4 mm/min",
    "psi": "1 psi = 6894.757 N/m^2", "ps": "1 PS = 735.49875 N m/s", "hp": "1 hp = 745.7 N m/s",
    "thou": "1 thou = 25.4 um", "h": "1 h = 3600 s", "hr": "1 h = 3600 s",
}  # fmt: skip
"""Units that are not taken, with what they are worth: a wrong factor must not slip in silently."""

WORD = re.compile(r"[A-Za-zµμ]+")


def find_worth(unit: str) -> str:
    """Return what a unit is worth that is not taken, e.g. the pound; "" if it is none of them."""
    words = (word.lower() for word in WORD.findall(unit))
    return next((FOREIGN[word] for word in words if word in FOREIGN), "")


def list_candidates(unit: str, usual: Sequence[str], symbols: Sequence[str]) -> tuple[str, ...]:
    """Return what may have been meant by a unit, the likeliest first, never the unit itself.

    ``usual``: units that would fit here; ``symbols``: every symbol that is known.

    Examples
    --------
    >>> list_candidates("m/mn", ["m/s", "m/min"], ["m", "s", "min", "mN"])
    ('m/min', 'm/mN')
    """
    found = [
        WORD.sub(lambda match: _meant(match[0], symbols), unit),
        WORD.sub(lambda match: _in_other_capitals(match[0], symbols), unit),
        *get_close_matches(unit, usual, n=1, cutoff=0.6),
        *get_close_matches(unit, symbols, n=1, cutoff=0.6),
    ]
    return tuple(dict.fromkeys(one for one in found if one != unit))


def _meant(word: str, symbols: Sequence[str]) -> str:
    return word if word in symbols else MEANT.get(word.lower(), word)


def _in_other_capitals(word: str, symbols: Sequence[str]) -> str:
    same = [symbol for symbol in symbols if symbol.lower() == word.lower()]
    return word if word in symbols or not same else same[0]


# What masses, forces and lengths are on an axis


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisUnits:
    """The quantities of one kind of axis, named as on the linear one."""

    mass: Dimension  # what is moved
    force: Dimension  # what moves it
    length: Dimension
    velocity: Dimension
    acceleration: Dimension
    jerk: Dimension
    stiffness: Dimension  # of a spring in the drive train
    damping: Dimension  # likewise; the velocity gain Kp is one, too
    gain: Dimension  # share of a mode in a position, per mass
    modal_deflection: Dimension  # state q of q'' + 2 ζ ω q' + ω² q = F
    modal_rate: Dimension  # its rate


_PAIRS = {
    "mass": (MASS, INERTIA),
    "force": (FORCE, TORQUE),
    "length": (LENGTH, ANGLE),
    "velocity": (VELOCITY, ANGULAR_VELOCITY),
    "acceleration": (ACCELERATION, ANGULAR_ACCELERATION),
    "jerk": (JERK, ANGULAR_JERK),
    "stiffness": (STIFFNESS, ROTARY_STIFFNESS),
    "damping": (DAMPING, ROTARY_DAMPING),
    "gain": (PER_MASS, PER_INERTIA),
    "modal_deflection": (MODAL_DEFLECTION, ROTARY_MODAL_DEFLECTION),
    "modal_rate": (MODAL_RATE, ROTARY_MODAL_RATE),
}
LINEAR, ROTARY = (AxisUnits(**{name: pair[i] for name, pair in _PAIRS.items()}) for i in (0, 1))


def of_position_source(axis: AxisUnits) -> AxisUnits:
    """Return what the same axis measures where the motor follows its setpoint.

    The plant is then driven by the acceleration of the motor: that stands for the force, on a
    mass of 1, and the modes deflect by q'' + 2 ζ ω q' + ω² q = -x_ref'' as lengths.
    """
    return replace(
        axis,
        mass=RATIO,
        force=axis.acceleration,
        gain=RATIO,
        modal_deflection=axis.length,
        modal_rate=axis.velocity,
    )


LINEAR_SOURCE, ROTARY_SOURCE = of_position_source(LINEAR), of_position_source(ROTARY)
