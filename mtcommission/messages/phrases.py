"""Sentences of the record in another language, found by their pattern.

The record is written once, in English; a language states pairs of patterns. ``{1}`` takes a
number, ``{name}`` a name that stays as it is, ``{-rest}`` a phrase that is translated in turn.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from typing import Any

PLACE = re.compile(r"\{(-?)(\w+)\}")
NUMBER = r"[+-]?(?:\d+\.?\d*(?:e[+-]?\d+)?|inf|nan)"

SIGNS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern), sign)
    for pattern, sign in (
        (r"(?<=\d) u(?=m\b|rad\b)", " µ"),
        (r"(?<=[a-z])\^2\b", "²"),
        (r"(?<=[a-z])\^3\b", "³"),
        (r"(?<=\d) arcsec\b", "″"),
        (r"(?<=\d) deg\b", "°"),
        (r"<=", "≤"),
        (r">=", "≥"),
        (r" x (?=\d)|(?<=\)) x ", " × "),
        (r"(?<![\w-])-(?=\d)", "−"),
        (r"\b(v_|)phi\b", r"\1φ"),
        (r"\bomega(?=_|\b)", "ω"),
        (r"\beps\b", "ε"),
        (r"\bT_sigma\b", "T_σ"),
    )
)
"""What one types, as a pattern, and what one prints; names of machines and keys have none."""

NAMED = re.compile(
    r"(\{\w+\}"
    r"|\b(?:[Mm]ode|Eigenform|periods? of|Perioden? von) \w+(?:, \w+)*"
    r"|\(\w+, [\d.,×⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+ Hz\))"
)
"""A place to be filled in, or the name of a mode where a sentence speaks of it."""

POWER = re.compile(r"(?<=\d)e([+-]?\d+)\b")
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

Phrases = Sequence[tuple[str, str]]


def translate(text: str, phrases: Phrases, *, decimal_mark: str) -> str | None:
    """Return a text in another language; None where no pattern fits.

    Parameters
    ----------
    text
        One or more sentences.
    phrases
        Pairs of patterns; the first that fits is taken.
    decimal_mark
        For the numbers in the text.

    Returns
    -------
    str or None

    Examples
    --------
    >>> phrases = [("force", "Kraft"), ("{-a} at {1} s", "{a} nach {1} s")]
    >>> translate("force at 0.5 s", phrases, decimal_mark=",")
    'Kraft nach 0,5 s'
    >>> translate("moment at 0.5 s", phrases, decimal_mark=",") is None
    True
    """
    for source, target in phrases:
        match = _pattern(source).fullmatch(text)
        if match is None:
            continue
        filled = _fill(match, source, phrases, decimal_mark)
        if filled is not None:
            return _put(target, filled)
    return _sentence_by_sentence(text, phrases, decimal_mark)


def say(text: str, words: Any) -> str:
    """Interim: a sentence of the record in the language of a catalogue."""
    from mtcommission.messages.phrases_de import PHRASES, ROTARY_DE, ROTARY_EN

    german = words.language == "de"
    found = translate(text, PHRASES, decimal_mark=",") if german else None
    rotary = (ROTARY_DE if german else ROTARY_EN) if words.rotary else ()
    return replace_words(polish(found or text), rotary)


def polish(text: str) -> str:
    """Return a sentence of the record with the signs that print has and a keyboard has not.

    Examples
    --------
    >>> polish("2 to 50 um, v_phi <= 5 rad/s^2, frequencies x 0.95")
    '2 to 50 µm, v_φ ≤ 5 rad/s², frequencies × 0.95'
    >>> polish("it leaves 1.4e+04 urad")
    'it leaves 1.4×10⁴ µrad'
    """
    for pattern, sign in SIGNS:
        text = pattern.sub(sign, text)
    return POWER.sub(lambda power: f"×10{str(int(power[1])).translate(SUPERSCRIPTS)}", text)


def replace_words(text: str, words: Phrases) -> str:
    r"""Return a text with some of its words replaced, in their order; each is a pattern.

    Places to be filled in keep their names, and so do the modes of a profile.

    Examples
    --------
    >>> replace_words("Set force {force}", [(r"\bforce\b", "torque")])
    'Set torque {force}'
    >>> replace_words("no force damps mode force", [(r"\bforce\b", "torque")])
    'no torque damps mode force'
    """
    parts = NAMED.split(text)
    for pattern, other in words:
        parts[::2] = [re.sub(pattern, other, part) for part in parts[::2]]
    return "".join(parts)


def _put(target: str, values: dict[str, str]) -> str:
    return PLACE.sub(lambda place: values[place[2]], target)


def _fill(
    match: re.Match[str], source: str, phrases: Phrases, decimal_mark: str
) -> dict[str, str] | None:
    """Return what stands in each place; None where a phrase inside is not known."""
    values = {}
    for is_phrase, name in PLACE.findall(source):
        found: str | None = match[f"_{name}"]
        if is_phrase:
            found = translate(match[f"_{name}"], phrases, decimal_mark=decimal_mark)
        elif name.isdigit():
            found = match[f"_{name}"].replace(".", decimal_mark)
        if found is None:
            return None
        values[name] = found
    return values


def _sentence_by_sentence(text: str, phrases: Phrases, decimal_mark: str) -> str | None:
    first, gap, rest = text.partition(". ")
    if not gap:
        return None
    parts = [translate(part, phrases, decimal_mark=decimal_mark) for part in (first + ".", rest)]
    known = [part for part in parts if part is not None]
    return " ".join(known) if len(known) == len(parts) else None


@cache
def _pattern(source: str) -> re.Pattern[str]:
    found, end = "", 0
    for place in PLACE.finditer(source):
        name = place[2]
        found += re.escape(source[end : place.start()])
        found += f"(?P<_{name}>{NUMBER if name.isdigit() else '.+?'})"
        end = place.end()
    return re.compile(found + re.escape(source[end:]))
