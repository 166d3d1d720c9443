"""Sentences and values in the letters that every control reads."""

from __future__ import annotations

import re
from itertools import pairwise
from math import isfinite
from unicodedata import combining, normalize

from mtcommission.base.messages.message import Message
from mtcommission.base.messages.quantities import SUPERSCRIPTS, THIN_SPACE

LETTERS = str.maketrans(
    {"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss", "°": " deg"}
    | {"µ": "u", "×": "x", "·": " ", "−": "-", "–": "-", "„": '"', "“": '"', "≤": "<=", "≥": ">="}
    | {"ω": "omega", "ζ": "zeta", "φ": "phi", "τ": "tau", "σ": "sigma", "π": "pi", "″": " arcsec"}
    | {THIN_SPACE: " "}
)
"""Signs of our sentences in the letters that every control reads."""

CAPITAL = re.compile("[ÄÖÜ](?=[A-ZÄÖÜ])|(?<=[A-ZÄÖÜ])[ÄÖÜ]")
"""A capital among capitals."""

_RAISED = {chr(raised): chr(plain) for plain, raised in SUPERSCRIPTS.items()}


def show_value(value: float, unit: str) -> Message:
    """Return an SI value with a unit that people read; in words where there is none."""
    if not isfinite(value):
        return Message("not-settled")
    return Message("value-of-unit", value=value, unit=unit)


def name_control(key: str) -> Message:
    """Return maker and products of a control by its key."""
    return Message(f"control-{key}")


def to_ascii(text: str) -> str:
    """Return a sentence in letters that every control reads.

    Examples
    --------
    >>> to_ascii("5 µm/s², 2×10⁻⁵ N·m für die Säule")
    '5 um/s^2, 2x10^-5 N m fuer die Saeule'
    >>> to_ascii("vérifié à la main")
    'verifie a la main'
    >>> to_ascii("UNVOLLSTÄNDIG, Übergang")
    'UNVOLLSTAENDIG, Uebergang'
    """
    signs = [
        ("^" if sign in _RAISED and (before not in _RAISED) else "") + _RAISED.get(sign, sign)
        for before, sign in pairwise(f" {text}")
    ]
    capitals = CAPITAL.sub(lambda one: LETTERS[ord(one[0])].upper(), "".join(signs))
    plain = normalize("NFKD", capitals.translate(LETTERS))  # é is e and its accent
    letters = "".join(sign for sign in plain if not combining(sign))
    return letters.encode("ascii", "replace").decode()
