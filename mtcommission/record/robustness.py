"""How the limits of a record fare where machine or limits differ a little."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from mtcommission.record.shape import finite_or_none, of
from mtcommission.record.values import Words
from mtcommission.study.robustness import MonteCarlo

SHARES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)
"""Quantiles in the record, least and largest included."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantile:
    """What so many of the drawn machines do not exceed; None: not settled."""

    share: float  # 0: the least, 1: the largest
    settling_time: float | None
    residual_deviation: float | None


def _quantiles(drawn: MonteCarlo) -> list[Quantile]:
    both = np.sort(np.column_stack([drawn.settling_time, drawn.residual_deviation]), axis=0)
    found = []
    for share in SHARES:
        # The least value that so many do not exceed: that of a machine, no mean of two.
        settling, residual = both[max(ceil(share * len(both)), 1) - 1]
        found.append(
            Quantile(
                share=share,
                settling_time=finite_or_none(settling),
                residual_deviation=finite_or_none(residual),
            )
        )
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class MonteCarloEntry:
    """The recommended limits on machines drawn uniformly from the stated spread."""

    samples: int = of("settling_time", by=len)
    seed: int
    share_met: float  # of samples that keep every requirement [-]
    share_in_band: float  # of those that keep the band [-]
    quantiles: list[Quantile] = of(_quantiles)


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

    monte_carlo: MonteCarloEntry | None  # None: neither spread nor range of payload is stated
    frequency_error: FrequencyErrorEntry
    damping_error: DampingErrorEntry = of("damping_range")
    warnings: list[Words]  # on what unstated knowledge the verdict hangs
