"""What somebody meant who typed a unit that is none."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import get_close_matches

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
    """Return what a unit is worth that is not taken, e.g. the pound; "" if it is none of them.

    Examples
    --------
    >>> find_worth("lb"), find_worth("kg")
    ('1 lb = 0.45359237 kg', '')
    """
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
