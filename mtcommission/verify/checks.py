"""Verdicts: holds, does not hold, cannot tell; each with its uncertainty and the reason."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from math import isfinite

from mtcommission.messages.message import Message
from mtcommission.requirements.register import read_requirement


class Verdict(Enum):
    """What can be said of a promise; the values are those of the JSON."""

    HOLDS = "holds"
    FAILS = "does not hold"
    UNKNOWN = "cannot tell"


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One promise against what was measured."""

    key: str  # What it is, as in JSON, e.g. ``"residual deviation"``.
    move: int = 0  # Number of the record's move from 1; 0: of no single move
    mode: str = ""  # Name of the mode; "" for none
    unit: str  # SI unit of all values
    # predicted, low, high: Nominal, and least and largest over the corners; None: nothing was
    # predicted.
    predicted: float | None
    low: float | None
    high: float | None
    # What is required; None where the prediction itself is what was promised.
    limit: float | None = None
    # measured, uncertainty: None: not measured.
    measured: float | None
    uncertainty: float | None
    # verdict, reason: And why.
    verdict: Verdict
    reason: Message
    # Whether it is a requirement: the whole verdict is "cannot tell" where this one is.
    decides: bool = False

    @property
    def name(self) -> str:
        """Name in JSON."""
        parts = [f"move {self.move}"] if self.move else []
        return ": ".join([*parts, *([self.mode] if self.mode else []), self.key])


def what_of(check: Check) -> Message:
    """Return what was checked, of whichever move."""
    what = Message(f"verify-{check.key.lower().replace(' ', '-')}")
    if check.key != "peak deviation":  # of the tool; else "peak" begins a bound on a state
        with suppress(ValueError):
            what = read_requirement(check.key).message
    return Message("of-mode", name=what, mode=check.mode) if check.mode else what


def at_most(
    measured: float, uncertainty: float, limit: float, *, slack: float | None = None
) -> Verdict:
    """Return whether a value is at most a limit.

    Examples
    --------
    >>> [at_most(4.0, u, 5.0).value for u in (0.5, 2.0)], at_most(8.0, 2.0, 5.0).value
    (['holds', 'cannot tell'], 'does not hold')
    """
    if measured + (uncertainty if slack is None else slack) <= limit:
        return Verdict.HOLDS
    return Verdict.FAILS if measured - uncertainty > limit else Verdict.UNKNOWN


def within(measured: float, uncertainty: float, low: float, high: float) -> Verdict:
    """Return whether a value lies between two others."""
    if low <= measured - uncertainty and measured + uncertainty <= high:
        return Verdict.HOLDS
    outside = measured + uncertainty < low or measured - uncertainty > high
    return Verdict.FAILS if outside else Verdict.UNKNOWN


def judge_all(checks: Sequence[Check]) -> Verdict:
    """Return the verdict over all checks.

    One that does not hold decides; then one that cannot be told, of those that decide.
    """
    if any(check.verdict is Verdict.FAILS for check in checks):
        return Verdict.FAILS
    deciding = [check for check in checks if check.decides]
    if not deciding or any(check.verdict is Verdict.UNKNOWN for check in deciding):
        return Verdict.UNKNOWN
    return Verdict.HOLDS


def worst(checks: Sequence[Check]) -> Check:
    """Return the one that speaks for several repetitions of a move.

    What failed once fails; what held and never failed holds, though another repetition was cut.
    """
    for verdict in (Verdict.FAILS, Verdict.HOLDS, Verdict.UNKNOWN):
        same = [check for check in checks if check.verdict is verdict]
        if same:
            return max(same, key=_share)
    raise AssertionError("a move was recorded at least once")


def _share(check: Check) -> float:
    bound = check.limit if check.limit is not None else check.high
    value = check.measured
    if value is None or not bound or not isfinite(value):
        return float("inf") if value is not None else -1.0
    return value / bound
