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
    unit: str  # SI unit; "" for a claim or a plain number
    # printed, corrected, ours: As text; ``corrected`` is "" where nothing had to be
    # corrected. Two digits of ours where the printed number is 0: the rest is rounding.
    printed: str
    corrected: str
    ours: str
    # printed_value, ours_value: As numbers in the unit; nan for a claim.
    printed_value: float
    ours_value: float
    difference: float  # Ours less the printed (or corrected) value; nan for a claim
    tolerance: float  # Largest |difference| that agrees; nan for a claim
    basis: str  # Where the tolerance comes from, or what a claim was tested by
    verdict: Verdict  # The judgement
    reason: str  # Why paper and we differ, or what to know; "" where there is nothing to say

    @property
    def is_claim(self) -> bool:
        """Whether the row is about a statement, not a number."""
        return isnan(self.tolerance)


def number_row(
    place: str,
    quantity: str,
    *,
    unit: str = "",
    printed: float,
    ours: float,
    tolerance: float,
    basis: str,
    corrected: float = nan,
    literal: float = nan,
    correction: str = "",
    reason: str = "",
) -> Row:
    """Return a comparison of two numbers.

    Examples
    --------
    >>> number_row("sec. 1", "t", printed=1.0, ours=1.01, tolerance=0.1, basis="b").verdict.value
    'agrees'
    >>> row = number_row("sec. 1", "t", printed=2.0, corrected=1.0, ours=1.01, tolerance=0.1,
    ...     basis="b")
    >>> row.verdict.value, round(row.difference, 9)
    ('agrees with the correction', 0.01)
    """
    as_printed = ours if isnan(literal) else literal
    wanted = printed if isnan(corrected) else corrected
    if abs(as_printed - printed) <= tolerance:
        verdict, difference = Verdict.AGREES, as_printed - printed
    else:
        is_repaired = not (isnan(corrected) and isnan(literal))
        close = abs(ours - wanted) <= tolerance
        verdict = Verdict.CORRECTED if is_repaired and close else Verdict.OUT
        difference = ours - wanted
    words = correction or ("" if isnan(corrected) else f"{corrected:.7g}")
    return Row(
        place=place,
        quantity=quantity,
        unit=unit,
        printed=f"{printed:.7g}",
        corrected=words if verdict is not Verdict.AGREES else "",
        ours=f"{ours:.7g}" if wanted != 0.0 else f"{ours:.2g}",
        printed_value=printed,
        ours_value=ours,
        difference=difference,
        tolerance=tolerance,
        basis=basis,
        verdict=verdict,
        reason=reason,
    )


def claim_row(
    place: str,
    quantity: str,
    *,
    printed: str,
    ours: str,
    basis: str,
    verdict: Verdict,
    corrected: str = "",
    reason: str = "",
) -> Row:
    """Return a comparison of a statement with what we find.

    Examples
    --------
    >>> claim_row("sec. 1", "a", printed="p", ours="o", basis="b", verdict=Verdict.AGREES).is_claim
    True
    """
    return Row(
        place=place,
        quantity=quantity,
        unit="",
        printed=printed,
        corrected=corrected,
        ours=ours,
        printed_value=nan,
        ours_value=nan,
        difference=nan,
        tolerance=nan,
        basis=basis,
        verdict=verdict,
        reason=reason,
    )


def judge_claim(*, holds: bool, refuted: bool = False) -> Verdict:
    """Return the verdict on a statement.

    Examples
    --------
    >>> judge_claim(holds=False).value
    'OUT OF TOLERANCE'
    """
    if holds:
        return Verdict.AGREES
    return Verdict.DIFFERS if refuted else Verdict.OUT


def judge_formula(*, printed_error: float, corrected_error: float, tolerance: float) -> Verdict:
    """Return the verdict on a printed formula and its correction.

    Examples
    --------
    >>> judge_formula(printed_error=0.4, corrected_error=1e-12, tolerance=1e-9).value
    'agrees with the correction'
    """
    if printed_error <= tolerance:
        return Verdict.AGREES
    return Verdict.CORRECTED if corrected_error <= tolerance else Verdict.OUT
