"""Robustness of the recommendation -> its entry in the record."""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Machine
from mtcommission.record.schema.robustness import (
    DampingErrorEntry,
    DistributionEntry,
    HistogramEntry,
    MonteCarloEntry,
    Quantile,
    RobustnessPart,
    SampleEntry,
)
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.study.robustness import MonteCarlo, Robustness

Array = NDArray[np.float64]

SHARES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)
"""Quantiles in the record, least and largest included."""

BINS = 24
"""Of a histogram, over all samples that settle."""

ALIKE = 1e-9
"""Relative difference below which samples are the same: a setpoint that leaves the band nowhere
settles at its end on every machine."""


def robustness_part(machine: Machine, robustness: Robustness) -> RobustnessPart:
    """Return how the recommended limits fare where machine or limits differ a little."""
    drawn = robustness.monte_carlo
    return entry_of(
        RobustnessPart,
        robustness,
        monte_carlo=drawn and _monte_carlo_entry(drawn, machine.axis_units.length.si),
        damping_error=entry_of(DampingErrorEntry, robustness.damping_range),
    )


def _monte_carlo_entry(drawn: MonteCarlo, length: str) -> MonteCarloEntry:
    def sample(index: int) -> SampleEntry:
        return entry_of(
            SampleEntry,
            drawn.variations[index],
            settling_time=drawn.settling_time[index],
            residual_deviation=drawn.residual_deviation[index],
        )

    return entry_of(
        MonteCarloEntry,
        drawn,
        samples=len(drawn.settling_time),
        settling_time=_distribution(drawn.settling_time, "s"),
        residual_deviation=_distribution(drawn.residual_deviation, length),
        worst=sample(drawn.worst),
        slowest=sample(drawn.slowest),
    )


def _distribution(values: Array, unit: str) -> DistributionEntry:
    ordered = np.sort(values)
    settled = ordered[np.isfinite(ordered)]
    return DistributionEntry(
        unit=unit,
        quantiles=[
            # The least value that so many samples do not exceed: a sample, no mean of two.
            Quantile(
                share=share, value=finite_or_none(ordered[max(ceil(share * len(ordered)), 1) - 1])
            )
            for share in SHARES
        ],
        histogram=_histogram(settled),
        not_settled=len(ordered) - len(settled),
    )


def _histogram(ordered: Array) -> HistogramEntry:
    """Of rising values; one bin without width where all are alike."""
    if not ordered.size:
        return HistogramEntry(edges=[], counts=[])
    low, high = float(ordered[0]), float(ordered[-1])
    if high - low <= ALIKE * high:
        return HistogramEntry(edges=[low, high], counts=[len(ordered)])
    counts, edges = np.histogram(ordered, bins=BINS)
    return HistogramEntry(edges=edges.tolist(), counts=counts.tolist())
