"""Broken and half-broken profiles, as editors, people and disks make them of the shipped ones."""

from __future__ import annotations

import re

import numpy as np

from mtcommission.profile.shipped import read_shipped, shipped_names

JUNK = "\"'#[]{}=,.\n\\\t \0é€µΩ\ufeff\u202e😀-+eE0123456789abcxyz_%/^*()"
NUMBERS = (
    "0", "-1", "1e308", "1e-308", "1e999", "nan", "inf", "-inf", "0x10", "1_000", "9" * 5000,
    "true",
    "1979-05-27", '"1e9999 kg"', '"-0 kg"', '"1 kg kg kg"', '"٣ kg"', '"1/0 m"', '"m"', '""',
    "[]", "{}", '"1' + "(" * 60 + '"',
)  # fmt: skip
UNITS = ("kg", "t", "N", "kN", "um", "mm", "m", "rad", "deg", "rev/min", "s", "ms", "Hz", "N m",
         "%",
         "furlong", "N/um", "kg m^2", "m/s")  # fmt: skip

NUMBER_WITH_UNIT = r'(?<=")[-+0-9.e]+(?= )'

DECADES = 2.5
"""By how many powers of ten a value is moved at most: a slip of units is three."""


def shipped_texts() -> list[str]:
    """Texts of the shipped profiles, in a fixed order."""
    return [read_shipped(name).text for name in shipped_names()]


def dice_of(series: int, seed: int) -> np.random.Generator:
    """The dice of a case: the seed alone says what happens to it."""
    return np.random.default_rng([series, seed])


def mutated(text: str, dice: np.random.Generator) -> str:
    """Break a profile one to three times; never empty."""
    for _ in range(int(dice.integers(1, 4))):
        text = mutated_text(text, dice) or text
    return text


def mutated_text(text: str, dice: np.random.Generator) -> str:
    """Break a profile in one of the ways in which editors, people and disks break files."""
    lines = text.split("\n")
    at, line = int(dice.integers(len(text))), int(dice.integers(len(lines)))
    other = int(dice.integers(len(lines)))
    match int(dice.integers(11)):
        case 0:
            return text[:at]
        case 1:
            return text[:at] + text[at + int(dice.integers(1, 30)) :]
        case 2:
            return text[:at] + JUNK[int(dice.integers(len(JUNK)))] + text[at:]
        case 3:
            noise = "".join(JUNK[i] for i in dice.integers(0, len(JUNK), 40))
            return text[:at] + noise + text[at:]
        case 4:
            return "\n".join([*lines[:line], *lines[line + 1 :]])
        case 5:
            return "\n".join([*lines[: line + 1], lines[other], *lines[line + 1 :]])
        case 6:
            lines[line], lines[other] = lines[other], lines[line]
            return "\n".join(lines)
        case 7:
            number = NUMBERS[int(dice.integers(len(NUMBERS)))]
            return _replace_some(r"(?<== )[^#\n]+", number + " ", text, dice)
        case 8:
            unit = UNITS[int(dice.integers(len(UNITS)))]
            return _replace_some(r'(?<=\d )[A-Za-z][^"]*(?=")', unit, text, dice)
        case 9:
            scale = f"{10.0 ** float(dice.integers(-12, 13)):g}"
            return _replace_some(NUMBER_WITH_UNIT, scale, text, dice)
        case _:
            return _replace_some(r"^[a-z_]+(?= =)", "zzz", text, dice)


def mutated_values(text: str, dice: np.random.Generator) -> str:
    """Move one to three numbers by some powers of ten: what is left is mostly a valid profile."""
    places = list(re.finditer(NUMBER_WITH_UNIT, text))
    for place in sorted(
        dice.choice(len(places), int(dice.integers(1, 4)), replace=False), reverse=True
    ):
        found = places[int(place)]
        value = float(found[0]) * 10.0 ** float(dice.uniform(-DECADES, DECADES))
        text = f"{text[: found.start()]}{value:.4g}{text[found.end() :]}"
    return text


def _replace_some(pattern: str, new: str, text: str, dice: np.random.Generator) -> str:
    places = list(re.finditer(pattern, text, re.MULTILINE))
    for place in reversed(places):
        if dice.random() < 2.0 / len(places):
            text = text[: place.start()] + new + text[place.end() :]
    return text
