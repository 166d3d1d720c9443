"""Robustness of the recommendation -> its entry in the record."""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Machine
from mtcommission.record.schema.robustness import (
    DampingErrorEntry,
    DistributionEntry,
    FrequencyErrorEntry,
    HistogramEntry,
    MonteCarloEntry,
    Quantile,
    RobustnessPart,
    SampleEntry,
)
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.study.robustness import DAMPING_FACTORS, MonteCarlo, Robustness

Array = NDArray[np.float64]

SHARES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)
"""Quantiles in the record, least and largest included."""

BINS = 24
"""Of a histogram, over all samples that settle."""

ALIKE = 1e-9
"""Relative difference below which samples are the same: a setpoint that leaves the band nowhere
settles at its end on every machine."""


def robustness_part(machine: Machine, robustness: Robustness) -> RobustnessPart:
    """Return all about robustness.

    Parameters
    ----------
    machine
        Nominal; its units count.
    robustness
        Of the recommended limits.
    """
    drawn = robustness.monte_carlo
    return RobustnessPart(
        monte_carlo=None if drawn is None else _monte_carlo_entry(machine, drawn),
        frequency_error=entry_of(FrequencyErrorEntry, robustness.frequency_error),
        damping_error=entry_of(
            DampingErrorEntry, robustness.damping_range, factor=DAMPING_FACTORS.tolist()
        ),
        warnings=list(robustness.warnings),
    )


def _monte_carlo_entry(machine: Machine, drawn: MonteCarlo) -> MonteCarloEntry:
    length = machine.axis_units.length.si
    return entry_of(
        MonteCarloEntry,
        drawn,
        samples=len(drawn.settling_time),
        settling_time=_distribution(drawn.settling_time, "s"),
        residual_deviation=_distribution(drawn.residual_deviation, length),
        worst=_sample_entry(drawn, drawn.worst),
        slowest=_sample_entry(drawn, drawn.slowest),
    )


def _distribution(values: Array, unit: str) -> DistributionEntry:
    ordered = np.sort(values)
    settled = ordered[np.isfinite(ordered)]
    return DistributionEntry(
        unit=unit,
        quantiles=[
            # The least value that so many samples do not exceed: a sample, no mean of two.
            Quantile(
                share=share,
                value=finite_or_none(float(ordered[max(ceil(share * len(ordered)), 1) - 1])),
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


def _sample_entry(drawn: MonteCarlo, index: int) -> SampleEntry:
    return entry_of(
        SampleEntry,
        drawn.variations.corner(index),
        settling_time=float(drawn.settling_time[index]),
        residual_deviation=float(drawn.residual_deviation[index]),
    )
