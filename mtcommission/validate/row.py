"""One line of the comparison with the paper, and how it is judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from math import isnan, nan
from types import MappingProxyType

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, Value
from mtcommission.validate.printed import CLAIMS, NUMBERS

NOTHING: Mapping[str, Value] = MappingProxyType({})
"""What most rows have to say beside their numbers."""


class Verdict(Enum):
    """How a printed number or claim stands beside ours.

    A row is out of tolerance where the paper and we differ and nothing explains it: then either
    the program or this comparison is wrong.
    """

    AGREES = "agrees"
    CORRECTED = "agrees with the correction"
    DIFFERS = "differs, with reason"
    OUT = "OUT OF TOLERANCE"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One number or claim."""

    place: str  # section and equation of the paper that print it
    key: str  # of its texts: what it is, ours, what it was judged by, the reason of a difference
    values: Mapping[str, Value]  # of which they speak
    unit: str = ""  # SI unit; "" for a claim or a plain number
    # printed, corrected, ours: As text; "" where nothing had to be corrected, and where our side
    # of a claim is among the texts.
    printed: str
    corrected: str | Message = ""
    ours: str = ""
    # printed_value, ours_value: As numbers in the unit; nan for a claim.
    printed_value: float = nan
    ours_value: float = nan
    difference: float = nan  # Ours less the printed (or corrected) value; nan for a claim
    tolerance: float = nan  # Largest |difference| that agrees; nan for a claim
    verdict: Verdict

    @property
    def is_claim(self) -> bool:
        """Whether the row is about a statement, not a number."""
        return isnan(self.tolerance)


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """A row in the words and numbers of a language; claims of the paper stay as printed."""

    place: str
    quantity: str  # what it is
    unit: str
    printed: str
    corrected: str
    ours: str
    basis: str  # where the tolerance comes from, or what a claim was tested by
    reason: str  # why paper and we differ, or what to know; "" where there is nothing to say


def tell(row: Row, words: Catalogue) -> Told:
    """Return a row in the words of a catalogue."""

    def say(part: str) -> str:
        kind = f"paper-{row.key}{part}"
        return words.text(kind, **row.values) if words.has(kind) else ""

    def figure(text: str) -> str:
        return text if row.is_claim else text.replace(".", words.format.decimal_mark)

    return Told(
        place=words.text("paper-place", at=row.place),
        quantity=say(""),
        unit=row.unit,
        printed=figure(row.printed),
        corrected=figure(words.say(row.corrected)),
        ours=figure(row.ours) or say(".ours"),
        basis=say(".basis"),
        reason=say(".reason"),
    )


def number(
    key: str,
    printed: float,
    ours: float,
    tolerance: float,
    values: Mapping[str, Value] = NOTHING,
    *,
    unit: str = "",
    corrected: float = nan,
    literal: float = nan,
) -> Row:
    """Return a comparison of two numbers; ``literal`` is ours where the print is taken literally.

    What then is right is a text of the row, "correct".

    Examples
    --------
    >>> number("increase", 2.0, 1.01, 0.1, corrected=1.0).verdict.value
    'agrees with the correction'
    """
    wanted = printed if isnan(corrected) else corrected
    difference, verdict = (ours if isnan(literal) else literal) - printed, Verdict.AGREES
    told: Message | str = ""
    if not abs(difference) <= tolerance:
        difference = ours - wanted
        is_repaired = not (isnan(corrected) and isnan(literal)) and abs(difference) <= tolerance
        verdict = Verdict.CORRECTED if is_repaired else Verdict.OUT
        if not isnan(corrected):
            told = f"{corrected:.7g}"
        elif not isnan(literal):
            told = Message(f"paper-{key}.correct")
    return Row(
        place=NUMBERS[key],
        key=key,
        values=values,
        unit=unit,
        printed=f"{printed:.7g}",
        corrected=told,
        # Two digits where the printed number is 0: the rest is rounding.
        ours=f"{ours:.7g}" if wanted != 0.0 else f"{ours:.2g}",
        printed_value=printed,
        ours_value=ours,
        difference=difference,
        tolerance=tolerance,
        verdict=verdict,
    )


def claim(
    key: str, values: Mapping[str, Value] = NOTHING, *, holds: bool, refuted: bool = False
) -> Row:
    """Return a statement that ``holds`` (as corrected, where that is printed) or is ``refuted``.

    Examples
    --------
    >>> claim("order", {"order": 3}, holds=False).verdict.value
    'OUT OF TOLERANCE'
    """
    printed = CLAIMS[key]
    verdict = Verdict.DIFFERS if refuted else Verdict.OUT
    if holds:
        verdict = Verdict.CORRECTED if printed.corrected else Verdict.AGREES
    return Row(
        place=printed.place,
        key=key,
        values=values,
        printed=printed.text,
        corrected=printed.corrected,
        verdict=verdict,
    )
