"""How the limits of a record fare where machine or limits differ a little."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.record.schema.values import Words


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantile:
    """The least value that so many of the samples do not exceed; null: not settled."""

    share: float
    value: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class HistogramEntry:
    """Samples between ``edges[i]`` and ``edges[i + 1]``: ``counts[i]``.

    One bin without width where all samples are alike; empty where none settles.
    """

    edges: list[float]
    counts: list[int]


@dataclass(frozen=True, slots=True, kw_only=True)
class DistributionEntry:
    """One quantity over the samples, in ``unit``.

    ``quantiles`` are over all samples (share 0: the least, 1: the largest), the histogram over
    those that settle; ``not_settled`` counts the others.
    """

    unit: str
    quantiles: list[Quantile]
    histogram: HistogramEntry
    not_settled: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleEntry:
    """One machine that was drawn [kg, -, -], and what the limits do on it [s, m]."""

    payload: float
    frequency_factor: float
    damping_factor: float
    settling_time: float | None
    residual_deviation: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class MonteCarloEntry:
    """The recommended limits on machines drawn from the stated spread.

    Payload, frequency factor and damping factor are drawn uniformly and independently.
    ``share_met``: of samples that keep every requirement (band, settling time, force, peaks,
    RMS force); ``share_in_band``: the band alone [-]. ``worst`` has the largest residual
    deviation, ``slowest`` the longest settling time; worst over the moves each.
    """

    samples: int
    seed: int
    share_met: float
    share_in_band: float
    settling_time: DistributionEntry
    residual_deviation: DistributionEntry
    worst: SampleEntry
    slowest: SampleEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyErrorEntry:
    """The recommended limits where all eigenfrequencies are off by a common factor [-].

    Settling time [s] and residual deviation [m], worst over moves and over the ends of payload
    and damping. Every requirement is kept from ``kept_from`` to ``kept_to`` (both null if not
    even at factor 1); an end that is the first or last ``factor`` may lie further out.
    """

    factor: list[float]
    settling_time: list[float | None]
    residual_deviation: list[float | None]
    kept_from: float | None
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingErrorEntry:
    """The recommended limits where all damping ratios are off by a common factor [-].

    ``factor``: those looked at; ``kept_from`` and ``kept_to`` as for the frequencies.
    """

    factor: list[float]
    kept_from: float | None
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessPart:
    """How the recommended limits fare where machine or limits differ a little.

    ``monte_carlo`` is null where the profile states neither spread nor a range of payload.
    ``warnings`` say on what unstated knowledge the verdict hangs; they are part of the record's
    warnings, too.
    """

    monte_carlo: MonteCarloEntry | None
    frequency_error: FrequencyErrorEntry
    damping_error: DampingErrorEntry
    warnings: list[Words]
