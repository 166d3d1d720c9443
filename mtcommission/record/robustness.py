"""How the limits of a record fare where machine or limits differ a little."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.record.shape import of
from mtcommission.record.values import Words


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingErrorEntry:
    """The limits where all damping ratios are off by a factor, worst over moves and corners.

    An end of the kept range that is the first or last ``factor`` may lie further out.
    """

    factor: list[float]
    kept_from: float | None  # every requirement is kept from here; None: not even at 1
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyErrorEntry(DampingErrorEntry):
    """The same where all eigenfrequencies are off by a factor."""

    settling_time: list[float | None]
    residual_deviation: list[float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessPart:
    """How the recommended limits fare where machine or limits differ a little."""

    frequency_error: FrequencyErrorEntry
    damping_error: DampingErrorEntry = of("damping_range")
    warnings: list[Words]  # on what unstated knowledge the verdict hangs
