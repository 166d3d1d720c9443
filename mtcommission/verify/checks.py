"""Verdicts: holds, does not hold, cannot tell; each with its uncertainty and the reason."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import Enum
from math import inf, isfinite

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements import read_requirement


class Verdict(Enum):
    """What can be said of a promise; the values are those of the JSON."""

    HOLDS = "holds"
    FAILS = "does not hold"
    UNKNOWN = "cannot tell"


class Part(Enum):
    """What a promise is about; the values are those of the JSON."""

    MOVE = "move"
    CIRCLE = "circle"


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One promise against what was measured [SI]."""

    key: str  # what it is, as in JSON, e.g. ``"residual deviation"``
    part: Part = Part.MOVE
    move: int = 0  # number of the record's move, or of the circle, from 1; 0: of no single move
    mode: str = ""  # of a circle: the axis, or both
    unit: str = ""  # of all values
    predicted: float | None = None  # nominal; None: nothing was predicted
    low: float | None = None  # least and largest over the corners
    high: float | None = None
    limit: float | None = None  # what is required; None: the prediction is what was promised
    measured: float | None = None
    uncertainty: float | None = None
    verdict: Verdict = Verdict.UNKNOWN
    reason: Message
    decides: bool = False  # whether the whole verdict is "cannot tell" where this one is

    @property
    def name(self) -> str:
        """Name in JSON."""
        parts = [f"{self.part.value} {self.move}"] if self.move else []
        return ": ".join([*parts, *([self.mode] if self.mode else []), self.key])

    @property
    def fails(self) -> bool:
        """Whether it does not hold."""
        return self.verdict is Verdict.FAILS

    def unknown(self, reason: Message) -> Check:
        """Return it as one that cannot be told."""
        return replace(self, verdict=Verdict.UNKNOWN, reason=reason)

    def doubted(self, reason: Message) -> Check:
        """Return it as one that cannot be told, unless that is so already."""
        return self if self.verdict is Verdict.UNKNOWN else self.unknown(reason)


KEPT = {
    Verdict.HOLDS: Message("verify-kept"),
    Verdict.FAILS: Message("verify-missed"),
    Verdict.UNKNOWN: Message("verify-within-noise"),
}
"""Reasons where nothing but the numbers decides."""


def judged(
    key: str,
    unit: str,
    verdict: Verdict,
    *,
    predicted: Iterable[float],
    seen: tuple[float, float],
    limit: float = inf,
    decides: bool = True,
    part: Part = Part.MOVE,
    move: int = 0,
    mode: str = "",
) -> Check:
    """Return what was measured beside its prediction in every corner, the nominal machine first.

    ``seen``: value and uncertainty; ``limit``: what is required, inf where nothing is.
    """

    def known(value: float) -> float | None:
        return float(value) if isfinite(value) else None

    values = list(predicted)
    return Check(
        key=key,
        part=part,
        move=move,
        mode=mode,
        unit=unit,
        predicted=known(values[0]),
        low=known(min(values)),
        high=known(max(values)),
        limit=known(limit),
        measured=known(seen[0]),
        uncertainty=known(seen[1]),
        verdict=verdict,
        reason=KEPT[verdict],
        decides=decides,
    )


def what_of(check: Check) -> Message:
    """Return what was checked, of whichever move or circle."""
    if check.part is Part.CIRCLE:
        return Message(f"group-circle-{check.key.replace(' ', '-')}", name=check.mode)
    what = Message(f"verify-{check.key.lower().replace(' ', '-')}")
    if check.key != "peak deviation":  # of the tool; else "peak" begins a bound on a state
        with suppress(ValueError):
            what = read_requirement(check.key).message
    return Message("of-mode", name=what, mode=check.mode) if check.mode else what


def judge(least: float, most: float, low: float, high: float) -> Verdict:
    """Return whether a value that lies between two others keeps its bounds.

    Examples
    --------
    >>> [judge(4.0 - u, 4.0 + u, 0.0, 5.0).value for u in (0.5, 2.0)]
    ['holds', 'cannot tell']
    >>> judge(6.0, 10.0, 0.0, 5.0).value
    'does not hold'
    """
    if low <= least and most <= high:
        return Verdict.HOLDS
    return Verdict.FAILS if least > high or most < low else Verdict.UNKNOWN


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
    order = (Verdict.UNKNOWN, Verdict.HOLDS, Verdict.FAILS)
    return max(checks, key=lambda check: (order.index(check.verdict), _share(check)))


def _share(check: Check) -> float:
    """Of the bound, by what was measured; -1: nothing was."""
    bound, value = check.limit if check.limit is not None else check.high, check.measured
    if value is None:
        return -1.0
    return value / bound if bound and isfinite(value) else inf
