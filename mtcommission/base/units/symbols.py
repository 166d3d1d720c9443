"""Units as people write them: "kN s/m" -> what it measures and its exact size.

A unit is read as a product of symbols, so the list stays short and "kN s/m", "kN·s/m",
"kN*s/m" and "kNs/m" are one unit. Factors are exact fractions and powers of π.
"""

from __future__ import annotations

import re
from collections import deque
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import pi
from typing import NamedTuple

from mtcommission.base.errors import Refused
from mtcommission.base.messages.message import Message

LONGEST_TEXT = 80
"""Characters of a quantity; keeps hostile input from costing time."""

LONGEST_WORD = 8
"""Letters of symbols written without a gap, as in "kNms"."""

TOKEN = re.compile(
    r"(?P<power>\s*(?:\^|\*\*)\s*-?[0-9]|(?<=[A-Za-z°)])-?[2-9])"
    r"|\s*(?:(?P<one>1000|1)(?=\s*/)|(?P<word>[A-Za-zµ°%]+)|(?P<mark>[*/()]))"
)
SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


class Token(NamedTuple):
    """A piece of a unit: a power, the number 1 or 1000, a word, or a mark."""

    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as factor x π^pi_power x m^a kg^b s^c rad^d."""

    exponents: tuple[int, int, int, int]
    """(a, b, c, d). The radian is counted so that an angle is never taken for a length."""
    factor: Fraction = Fraction(1)  # exact SI value of one such unit, without π
    pi_power: int = 0

    @property
    def si_value(self) -> float:
        """Value of one such unit in SI."""
        return float(self.factor) * pi**self.pi_power

    def __mul__(self, other: Unit) -> Unit:
        m, kg, s, rad = (a + b for a, b in zip(self.exponents, other.exponents, strict=True))
        return Unit((m, kg, s, rad), self.factor * other.factor, self.pi_power + other.pi_power)

    def __pow__(self, power: int) -> Unit:
        m, kg, s, rad = (power * a for a in self.exponents)
        return Unit((m, kg, s, rad), self.factor**power, power * self.pi_power)


ONE = Unit((0, 0, 0, 0))
_METRE, _GRAM = Unit((1, 0, 0, 0)), Unit((0, 1, 0, 0), Fraction(1, 1000))
_SECOND, _RADIAN = Unit((0, 0, 1, 0)), Unit((0, 0, 0, 1))
_NEWTON = Unit((1, 1, -2, 0))
_PREFIXES = {"n": -9, "u": -6, "µ": -6, "m": -3, "c": -2, "k": 3, "M": 6, "G": 9}


def _symbols() -> dict[str, Unit]:
    def scaled(unit: Unit, factor: Fraction, pi_power: int = 0) -> Unit:
        return Unit(unit.exponents, unit.factor * factor, pi_power)

    minute = scaled(_SECOND, Fraction(60))
    turn = scaled(_RADIAN, Fraction(2), 1)
    table = {
        "t": scaled(_GRAM, Fraction(10**6)),
        "min": minute,
        "rev": turn,
        "rpm": turn * minute**-1,
        "deg": scaled(_RADIAN, Fraction(1, 180), 1),
        "°": scaled(_RADIAN, Fraction(1, 180), 1),
        "arcmin": scaled(_RADIAN, Fraction(1, 180 * 60), 1),
        "arcsec": scaled(_RADIAN, Fraction(1, 180 * 3600), 1),
        "%": scaled(ONE, Fraction(1, 100)),
        "percent": scaled(ONE, Fraction(1, 100)),
    }
    # Each symbol with the prefixes in use, so that a slip such as "Mm" is not taken as a unit.
    for symbol, unit, prefixes in (
        ("m", _METRE, "nuµmc"),
        ("g", _GRAM, "mk"),
        ("s", _SECOND, "nuµm"),
        ("N", _NEWTON, "mkMG"),
        ("rad", _RADIAN, "nuµm"),
        ("Hz", _SECOND**-1, "mk"),
    ):
        table[symbol] = unit
        for prefix in prefixes:
            table[prefix + symbol] = scaled(unit, Fraction(10) ** _PREFIXES[prefix])
    return table


SYMBOLS = _symbols()
"""The units that may be combined; both micro signs are read as µ."""


def read_unit(text: str) -> tuple[Unit, ...]:
    """Return what a unit text can mean, the likeliest first.

    Symbols written without a gap may be read in more than one way: "Nms" is N m s or N ms.
    Products associate to the left, as in pint: "N/m s" is (N/m) s.

    ``text`` is empty for a plain number.

    Raises ValueError if a symbol is unknown or the text is not a product of powers of units.

    Examples
    --------
    >>> [unit.si_value for unit in read_unit("N/um")]
    [1000000.0]
    >>> len(read_unit("Nms/rad"))
    2
    """
    if len(text) > LONGEST_TEXT:
        raise Refused(Message("unit-unreadable", unit=f"{text[:LONGEST_TEXT]}…"))
    plain = text.replace("μ", "µ").replace("per cent", "%").replace("×", "*")
    plain = re.sub("[·⋅]", "*", plain)
    plain = re.sub("[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+", lambda m: "^" + m[0].translate(SUPERSCRIPTS), plain).strip()
    if not plain:
        return (ONE,)
    tokens = _tokens("1" + plain if plain.startswith("/") else plain, text)
    units = _product(tokens, text)
    if tokens:
        raise Refused(Message("unit-unreadable", unit=text))
    return units


def _tokens(plain: str, text: str) -> deque[Token]:
    tokens: deque[Token] = deque()
    place = 0
    while place < len(plain):
        match = TOKEN.match(plain, place)
        if match is None or match.lastgroup is None:
            raise Refused(Message("unit-unreadable", unit=text))
        tokens.append(Token(match.lastgroup, match[match.lastgroup]))
        place = match.end()
    return tokens


def _product(tokens: deque[Token], text: str) -> tuple[Unit, ...]:
    """Take a product off the tokens, up to a closing parenthesis."""
    units = _factor(tokens, text)
    while tokens and tokens[0].text != ")":
        mark = tokens.popleft().text if tokens[0].text in ("*", "/") else "*"
        factors = _factor(tokens, text)
        sign = -1 if mark == "/" else 1
        # A dict, not a list: equal meanings would double with every word.
        units = tuple(dict.fromkeys(a * b**sign for a, b in product(units, factors)))
    return units


def _factor(tokens: deque[Token], text: str) -> tuple[Unit, ...]:
    """Take one unit, number or parenthesis with its power off the tokens."""
    if not tokens:
        raise Refused(Message("unit-unreadable", unit=text))
    head = tokens.popleft()
    if head.text == "(":
        units = _product(tokens, text)
        if not tokens:
            raise Refused(Message("unit-unreadable", unit=text))
        tokens.popleft()
        return _raised(units, _power(tokens))
    if head.kind == "one":
        units = (Unit(ONE.exponents, Fraction(int(head.text))),)
        return _raised(units, _power(tokens))
    if head.kind == "word":
        return _word(head.text, _power(tokens))
    raise Refused(Message("unit-unreadable", unit=text))


def _power(tokens: deque[Token]) -> int:
    if tokens and tokens[0].kind == "power":
        return int(tokens.popleft().text.strip(" \t^*"))
    return 1


def _raised(units: tuple[Unit, ...], power: int) -> tuple[Unit, ...]:
    return tuple(unit**power for unit in units)


def _word(word: str, power: int) -> tuple[Unit, ...]:
    """Return the meanings of a word; a power belongs to its last symbol: kgm^2 is kg m^2."""
    if word in SYMBOLS:
        return (SYMBOLS[word] ** power,)
    splits = _splits(word) if len(word) <= LONGEST_WORD else []
    if not splits:
        raise Refused(Message("unit-unknown", unit=word))
    meanings = []
    for *first, last in splits:
        unit = SYMBOLS[last] ** power
        for symbol in first:
            unit = unit * SYMBOLS[symbol]
        meanings.append(unit)
    return tuple(dict.fromkeys(meanings))


def _splits(word: str) -> list[tuple[str, ...]]:
    """Return the ways to read a word as symbols side by side, short symbols first."""
    if not word:
        return [()]
    return [
        (word[:size], *rest)
        for size in range(1, len(word) + 1)
        if word[:size] in SYMBOLS
        for rest in _splits(word[size:])
    ]
