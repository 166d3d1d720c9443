"""How the limits of a record fare where machine or limits differ a little."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from typing import Annotated

import numpy as np

from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.record.rules import Place, above_zero, long
from mtcommission.record.shape import entry_of, finite_or_none, of
from mtcommission.record.values import Array, InCorner, Words
from mtcommission.study.robustness import MonteCarlo, Robustness

SHARES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)
"""Quantiles in the record, least and largest included."""

BINS = 24
"""Of a histogram, over all samples that settle."""

ALIKE = 1e-9
"""Relative difference below which samples are the same: a setpoint that leaves the band nowhere
settles at its end on every machine."""


def _between_edges(at: Place) -> Iterator[Message]:
    if len(at.value) != max(len(at.entry.edges) - 1, 0):
        counts = f"{len(at.value)}, {len(at.entry.edges)} - 1"
        yield Message("record-lengths-differ", key=at.key, counts=counts)


def _as_many(at: Place) -> Iterator[Message]:
    counts = {len(one.quantiles) for one in (at.entry.settling_time, at.value)}
    if len(counts) > 1:
        shown = ", ".join(map(str, sorted(counts)))
        yield Message("record-lengths-differ", key=f"{at.key}.quantiles", counts=shown)


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantile:
    """The least value that so many of the samples do not exceed; None: not settled."""

    share: float
    value: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class HistogramEntry:
    """Samples between ``edges[i]`` and ``edges[i + 1]``: ``counts[i]``.

    One bin without width where all samples are alike; empty where none settles.
    """

    edges: list[float]
    counts: Annotated[list[int], _between_edges]


@dataclass(frozen=True, slots=True, kw_only=True)
class DistributionEntry:
    """One quantity over the samples, in ``unit``."""

    unit: str
    quantiles: list[Quantile]  # over all samples; share 0: the least, 1: the largest
    histogram: HistogramEntry  # of those that settle
    not_settled: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleEntry(InCorner):
    """One machine that was drawn, and what the limits do on it."""

    settling_time: float | None
    residual_deviation: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class MonteCarloEntry:
    """The recommended limits on machines drawn uniformly from the stated spread."""

    samples: int
    seed: int
    share_met: float  # of samples that keep every requirement [-]
    share_in_band: float  # of those that keep the band [-]
    settling_time: DistributionEntry
    residual_deviation: Annotated[DistributionEntry, _as_many]
    worst: SampleEntry  # with the largest residual deviation of all moves
    slowest: SampleEntry  # with the longest settling time


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyErrorEntry:
    """The limits where all eigenfrequencies are off by a factor, worst over moves and corners.

    An end of the kept range that is the first or last ``factor`` may lie further out.
    """

    factor: Annotated[list[float], above_zero]
    settling_time: Annotated[list[float | None], long("factor")]
    residual_deviation: Annotated[list[float | None], long("factor")]
    kept_from: float | None  # every requirement is kept from here; None: not even at 1
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingErrorEntry:
    """The limits where all damping ratios are off by a factor; ends as for the frequencies."""

    factor: list[float]
    kept_from: float | None
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessPart:
    """How the recommended limits fare where machine or limits differ a little."""

    monte_carlo: MonteCarloEntry | None  # None: neither spread nor range of payload is stated
    frequency_error: FrequencyErrorEntry
    damping_error: DampingErrorEntry = of("damping_range")
    warnings: list[Words]  # on what unstated knowledge the verdict hangs


def robustness_part(machine: Machine, robustness: Robustness) -> RobustnessPart:
    """Return how the recommended limits fare where machine or limits differ a little."""
    drawn = robustness.monte_carlo
    return entry_of(
        RobustnessPart,
        robustness,
        monte_carlo=drawn and _monte_carlo_entry(drawn, machine.axis_units.length.si),
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
