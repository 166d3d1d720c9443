"""One line of the comparison with the paper, and how it is judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from math import isnan, nan

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message, Value


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
    place: str,
    key: str,
    printed: float,
    ours: float,
    *,
    tolerance: float,
    unit: str = "",
    corrected: float = nan,
    literal: float = nan,
    correction: Message | str = "",
    **values: Value,
) -> Row:
    """Return a comparison of two numbers; ``literal`` is ours where the print is taken literally.

    Examples
    --------
    >>> number("1", "increase", 2.0, 1.01, corrected=1.0, tolerance=0.1).verdict.value
    'agrees with the correction'
    """
    as_printed = ours if isnan(literal) else literal
    wanted = printed if isnan(corrected) else corrected
    verdict, difference = Verdict.AGREES, as_printed - printed
    repaired: Message | str = ""
    if not abs(difference) <= tolerance:
        is_repaired = not (isnan(corrected) and isnan(literal))
        difference = ours - wanted
        close = abs(difference) <= tolerance
        verdict = Verdict.CORRECTED if is_repaired and close else Verdict.OUT
        repaired = correction or ("" if isnan(corrected) else f"{corrected:.7g}")
    return Row(
        place=place,
        key=key,
        values=values,
        unit=unit,
        printed=f"{printed:.7g}",
        corrected=repaired,
        # Two digits where the printed number is 0: the rest is rounding.
        ours=f"{ours:.7g}" if wanted != 0.0 else f"{ours:.2g}",
        printed_value=printed,
        ours_value=ours,
        difference=difference,
        tolerance=tolerance,
        verdict=verdict,
    )


def claim(
    place: str,
    key: str,
    printed: str,
    *,
    holds: bool,
    refuted: bool = False,
    corrected: Message | str = "",
    **values: Value,
) -> Row:
    """Return a statement that ``holds`` (as ``corrected``, where that is given) or is ``refuted``.

    Examples
    --------
    >>> claim("1", "order", "order 2", holds=False, order=3).verdict.value
    'OUT OF TOLERANCE'
    """
    verdict = Verdict.DIFFERS if refuted else Verdict.OUT
    if holds:
        verdict = Verdict.CORRECTED if corrected else Verdict.AGREES
    return Row(
        place=place,
        key=key,
        values=values,
        printed=printed,
        corrected=corrected,
        verdict=verdict,
    )
