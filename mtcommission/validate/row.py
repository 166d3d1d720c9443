"""One line of the comparison with the paper, and how it is judged."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import isnan, nan


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

    place: str  # Where the paper prints it
    quantity: str  # What it is
    unit: str = ""  # SI unit; "" for a claim or a plain number
    # printed, corrected, ours: As text; ``corrected`` is "" where nothing had to be corrected.
    printed: str
    corrected: str = ""
    ours: str
    # printed_value, ours_value: As numbers in the unit; nan for a claim.
    printed_value: float = nan
    ours_value: float = nan
    difference: float = nan  # Ours less the printed (or corrected) value; nan for a claim
    tolerance: float = nan  # Largest |difference| that agrees; nan for a claim
    basis: str  # Where the tolerance comes from, or what a claim was tested by
    verdict: Verdict
    reason: str = ""  # Why paper and we differ, or what to know

    @property
    def is_claim(self) -> bool:
        """Whether the row is about a statement, not a number."""
        return isnan(self.tolerance)


def number(
    place: str,
    quantity: str,
    printed: float,
    ours: float,
    *,
    tolerance: float,
    basis: str,
    unit: str = "",
    corrected: float = nan,
    literal: float = nan,
    correction: str = "",
    reason: str = "",
) -> Row:
    """Return a comparison of two numbers; ``literal`` is ours where the print is taken literally.

    Examples
    --------
    >>> number("sec. 1", "t", 2.0, 1.01, corrected=1.0, tolerance=0.1, basis="b").verdict.value
    'agrees with the correction'
    """
    as_printed = ours if isnan(literal) else literal
    wanted = printed if isnan(corrected) else corrected
    verdict, difference, words = Verdict.AGREES, as_printed - printed, ""
    if not abs(difference) <= tolerance:
        is_repaired = not (isnan(corrected) and isnan(literal))
        difference = ours - wanted
        close = abs(difference) <= tolerance
        verdict = Verdict.CORRECTED if is_repaired and close else Verdict.OUT
        words = correction or ("" if isnan(corrected) else f"{corrected:.7g}")
    return Row(
        place=place,
        quantity=quantity,
        unit=unit,
        printed=f"{printed:.7g}",
        corrected=words,
        # Two digits where the printed number is 0: the rest is rounding.
        ours=f"{ours:.7g}" if wanted != 0.0 else f"{ours:.2g}",
        printed_value=printed,
        ours_value=ours,
        difference=difference,
        tolerance=tolerance,
        basis=basis,
        verdict=verdict,
        reason=reason,
    )


def claim(
    place: str,
    quantity: str,
    printed: str,
    ours: str,
    *,
    basis: str,
    holds: bool,
    refuted: bool = False,
    corrected: str = "",
    reason: str = "",
) -> Row:
    """Return a statement that ``holds`` (as ``corrected``, where that is given) or is ``refuted``.

    Examples
    --------
    >>> claim("sec. 1", "a", "p", "o", basis="b", holds=False).verdict.value
    'OUT OF TOLERANCE'
    """
    verdict = Verdict.DIFFERS if refuted else Verdict.OUT
    if holds:
        verdict = Verdict.CORRECTED if corrected else Verdict.AGREES
    return Row(
        place=place,
        quantity=quantity,
        printed=printed,
        corrected=corrected,
        ours=ours,
        basis=basis,
        verdict=verdict,
        reason=reason,
    )
