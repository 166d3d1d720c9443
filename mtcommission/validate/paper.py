"""What the paper prints, misprints included, and how one line beside it is judged.

Source: B. Christiansen, H. Maurer, O. Zirn, Optimal Control of Machine Tool Manipulators.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from math import isnan, nan

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, Value

# Numbers on which more than one row stands; the others stand in their rows.
FORCE_LIMIT = 2e3
"""F_max of secs. 5.1, 5.2 and 6 [N]."""
LARGEST_FORCE = 4e3
"""Upper limit of F_max "for mechanical reasons", Table 1 [N]."""
VELOCITY_STEP = 0.1
"""v_s(t_f), eq. (3) [m/s]."""
SWITCHING_TIMES = (0.009337, 0.009668, 0.036552, 0.037653, 0.041942)
"""t_1 ... t_5, eq. (12) [s]."""
T_F = 0.043505
"""t_f, eq. (12) [s]."""
ADJOINT = (-11.87902, 0.0, 14.75425, 0.05508, -0.23018, 0.01149, -1.2503e-6)
"""λ(0), sec. 5.1, in the order of the states."""
TIME_ACCURACY = 1e-4
"""The text calls switching times "correct up to 3-4 decimals", sec. 5 [s]."""
RATE_BOUND = 0.005
"""c_φ, sec. 5.2 [rad/s]."""
BOUNDED_T_F = 0.0522
"""t_f under that bound, sec. 5.2, and t_f of sec. 6 [s]."""

SURE_GAP = 1e-9
"""Relative gap below which an optimum counts as proved, and refutes a claim [-]."""


class Verdict(Enum):
    """How a printed number or claim stands beside ours.

    A row is out of tolerance where the paper and we differ and nothing explains it: then either
    the program or this comparison is wrong.
    """

    AGREES = "agrees"
    CORRECTED = "corrected"
    DIFFERS = "differs"
    OUT = "out"


@dataclass(frozen=True, slots=True)
class Number:
    """A number as the paper prints it."""

    key: str  # of its texts: what it is, what its tolerance comes from, the reason of a difference
    place: str  # section and equation
    printed: float
    unit: str = ""  # SI; "" for a plain number
    correct: float | str | Message = ""
    """What it must be, or the right name of what it is; "" where it is no misprint."""

    def beside(self, ours: float, tolerance: float, **values: Value) -> Row:
        """Return it beside ours, which may differ by ``tolerance`` from what the print must be.

        ``values``: of which the texts speak.

        Examples
        --------
        >>> Number("increase", "5.2", 2.0, correct=1.0).beside(1.01, 0.1).verdict.value
        'corrected'
        """
        difference = ours - (self.correct if isinstance(self.correct, float) else self.printed)
        verdict = Verdict.OUT
        if abs(difference) <= tolerance:
            verdict = Verdict.AGREES if self.correct == "" else Verdict.CORRECTED
        return Row(
            source=self,
            verdict=verdict,
            values=values,
            ours=float(ours),
            difference=float(difference),
            tolerance=float(tolerance),
        )


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement or formula as the paper prints it."""

    key: str  # of its texts: what it is, ours, what it was judged by, the reason of a difference
    place: str  # section and equation
    printed: str
    correct: str | Message = ""  # what it must read; "" where it is no misprint

    def judged(self, *, holds: bool, refuted: bool = False, **values: Value) -> Row:
        """Return it with ours: it ``holds`` (as corrected, where it is a misprint), or is refuted.

        Examples
        --------
        >>> Claim("order", "5.2", "order 2").judged(holds=False, order=3).verdict.value
        'out'
        """
        verdict = Verdict.DIFFERS if refuted else Verdict.OUT
        if holds:
            verdict = Verdict.CORRECTED if self.correct else Verdict.AGREES
        return Row(source=self, verdict=verdict, values=values)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A number or claim beside ours; numbers in the unit of the print, nan for a claim."""

    source: Number | Claim
    verdict: Verdict
    values: Mapping[str, Value]  # of which its texts speak
    ours: float = nan
    difference: float = nan  # ours less the printed (or corrected) value
    tolerance: float = nan  # largest |difference| that agrees


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
    tolerance: str  # "" for a claim
    verdict: str

    @property
    def name(self) -> str:
        """What is compared, with its unit."""
        return f"{self.quantity} [{self.unit}]" if self.unit else self.quantity


def tell(row: Row, words: Catalogue) -> Told:
    """Return a row in the words of a catalogue."""
    source = row.source

    def say(part: str) -> str:
        kind = f"paper-{source.key}{part}"
        return words.text(kind, **row.values) if words.has(kind) else ""

    def show(value: float | str | Message, digits: int = 7) -> str:
        if isinstance(value, Message | str):
            return words.say(value)
        return words.format.plain(value, digits, "g")

    return Told(
        place=words.text("paper-place", at=source.place),
        quantity=say(""),
        unit=source.unit if isinstance(source, Number) else "",
        printed=show(source.printed),
        corrected=show(source.correct),
        # Two digits where the printed number is 0: the rest is rounding.
        ours=say(".ours") or show(row.ours, 7 if source.printed else 2),
        basis=say(".basis"),
        reason=say(".reason"),
        tolerance="" if isnan(row.tolerance) else show(row.tolerance, 2),
        verdict=words.text(f"validate-is-{row.verdict.value}"),
    )


def sides(told: Told, words: Catalogue) -> list[str]:
    """Return what the paper prints, what is correct and what we find, a sentence each."""
    basis = f"± {told.tolerance}: {told.basis}" if told.tolerance else told.basis
    found = {"paper": told.printed, "correct": told.corrected, "ours": f"{told.ours} ({basis})"}
    return [
        words.text("validate-told", what=what, value=value)
        for what, value in found.items()
        if value
    ]
