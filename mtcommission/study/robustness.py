"""The recommended limits on machines that differ a little: rows of one varied judge.

Drawn machines tell how many of a series keep the requirements; the ranges of frequency and damping
tell how far the machine may change until it must be measured and commissioned again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import Variations, as_variations, corners, draw_variations
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant
from mtcommission.requirements.requirement import Requirement
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import RobustnessSettings
from mtcommission.study.varied import VariedResponse, respond_varied

Array = NDArray[np.float64]

DAMPING_FACTORS = np.linspace(0.3, 1.7, 15)
"""Looked at: what is measured of damping on one day may be off by half on another."""

KNOWN_FREQUENCY = 0.02
"""Error of an eigenfrequency that must be reckoned with even where it was measured [-]
(empirical: resolution of the measurement, temperature, position on the axis)."""

ALIKE = 1e-9
"""Rounding of a frequency error [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MonteCarlo:
    """Distribution of settling time and residual deviation over the stated spread."""

    variations: Variations  # the machines drawn
    settling_time: Array  # of the slowest move, shape (n_samples,) [s]; inf: not settled
    residual_deviation: Array  # of the worst move, shape (n_samples,) [m]
    share_met: float  # of samples that keep all requirements [-]
    share_in_band: float  # the band alone [-]
    seed: int

    @property
    def worst(self) -> int:
        """The sample with the largest residual deviation."""
        return int(np.argmax(self.residual_deviation))

    @property
    def slowest(self) -> int:
        """The sample with the longest settling time."""
        return int(np.argmax(self.settling_time))


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptRange:
    """Between which common factors every requirement is kept in every corner.

    The ends of the unbroken range about 1 [-]; both nan if not even at 1. Beyond the first and last
    factor nothing was looked at.
    """

    kept_from: float
    kept_to: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyError(KeptRange):
    """What the same limits do where all eigenfrequencies are off by a common factor."""

    factor: Array  # frequencies over those of the profile, rising, shape (n,) [-]
    settling_time: Array  # worst over moves, payload and damping, shape (n,) [s]
    residual_deviation: Array  # likewise [m]
    lost_below: tuple[Requirement, ...]  # missed at the next factor below the range, and above
    lost_above: tuple[Requirement, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Robustness:
    """All views, and what they warn of."""

    monte_carlo: MonteCarlo | None  # None: no spread and no range of payload, nothing to draw
    frequency_error: FrequencyError
    damping_range: KeptRange
    warnings: tuple[Message, ...]


def examine_robustness(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    settings: RobustnessSettings,
) -> Robustness:
    """Return how limits fare where the machine differs a little."""
    drawn = None
    if len(corners(machine)) > 1:
        drawn = run_monte_carlo(
            machine, plant, tuned, limits, samples=settings.samples, seed=settings.seed
        )
    error = find_frequency_error(machine, plant, tuned, limits, settings=settings)
    return Robustness(
        monte_carlo=drawn,
        frequency_error=error,
        damping_range=find_damping_range(machine, plant, tuned, limits),
        warnings=warn_of_narrow_range(machine, error),
    )


def run_monte_carlo(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    samples: int = 10_000,
    seed: int = 0,
) -> MonteCarlo:
    """Return what limits do on machines drawn uniformly and independently from the stated spread.

    The controller is the same on every sample.
    """
    variations = draw_variations(machine, samples=samples, seed=seed)
    found = respond_varied(machine, plant, tuned, limits, variations=variations)
    band = machine.requirements.tcp_deviation
    return MonteCarlo(
        variations=variations,
        settling_time=found.settling_time,
        residual_deviation=found.residual_deviation,
        share_met=float(np.mean(found.meets(machine))),
        share_in_band=float(np.mean(found.residual_deviation <= band)),
        seed=seed,
    )


def find_frequency_error(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    settings: RobustnessSettings,
) -> FrequencyError:
    """Return settling time and residual deviation over a common error of all frequencies."""
    needs = machine.requirements
    reach = max(settings.frequency_range, min(2.0 * needs.frequency_spread, 0.5))
    middle = settings.frequency_points
    factor = 1.0 + reach * np.linspace(-1.0, 1.0, 2 * middle + 1)
    known = replace(machine, requirements=replace(needs, frequency_spread=0.0))
    found, each = _respond_over(known, plant, tuned, limits, factor, of="frequency_factor")
    low, high = _stretch_about(np.all(found.meets(machine).reshape(-1, each), axis=1))
    is_kept = low <= high
    below = slice(max(low - 1, 0) * each, low * each)
    above = slice((high + 1) * each, (high + 2) * each)
    return FrequencyError(
        factor=factor,
        settling_time=found.settling_time.reshape(-1, each).max(axis=1),
        residual_deviation=found.residual_deviation.reshape(-1, each).max(axis=1),
        kept_from=float(factor[low]) if is_kept else np.nan,
        kept_to=float(factor[high]) if is_kept else np.nan,
        lost_below=found.missed(machine, below) if is_kept else (),
        lost_above=found.missed(machine, above) if is_kept else (),
    )


def find_damping_range(
    machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits
) -> KeptRange:
    """Return between which common factors on all damping ratios every requirement is kept."""
    known = replace(machine, requirements=replace(machine.requirements, damping_spread=0.0))
    factor = DAMPING_FACTORS
    found, each = _respond_over(known, plant, tuned, limits, factor, of="damping_factor")
    low, high = _stretch_about(np.all(found.meets(machine).reshape(-1, each), axis=1))
    if low > high:
        return KeptRange(kept_from=np.nan, kept_to=np.nan)
    return KeptRange(kept_from=float(factor[low]), kept_to=float(factor[high]))


def _respond_over(
    known: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    factor: Array,
    *,
    of: Literal["frequency_factor", "damping_factor"],
) -> tuple[VariedResponse, int]:
    """Every corner of a machine at every factor, and how many corners there are."""
    places = as_variations(corners(known))
    each = len(places.payload)
    variations = Variations(
        payload=np.tile(places.payload, len(factor)),
        frequency_factor=np.tile(places.frequency_factor, len(factor)),
        damping_factor=np.tile(places.damping_factor, len(factor)),
    )
    variations = replace(variations, **{of: np.repeat(factor, each)})
    return respond_varied(known, plant, tuned, limits, variations=variations), each


def _stretch_about(kept: NDArray[np.bool_]) -> tuple[int, int]:
    """First and last index of the unbroken stretch about the middle; first > last: none."""
    middle = len(kept) // 2
    if not kept[middle]:
        return middle + 1, middle
    broken = np.flatnonzero(~kept)
    low = int(np.max(broken[broken < middle], initial=-1)) + 1
    return low, int(np.min(broken[broken > middle], initial=len(kept))) - 1


def warn_of_narrow_range(machine: Machine, error: FrequencyError) -> tuple[Message, ...]:
    """Return a warning where the requirements hang on frequencies nobody knows so exactly.

    Limits that cancel a vibration are as exact as its frequency. Where no spread is stated they may
    be kept at the stated frequency alone, and the verdict would not show it. Empty where a spread
    is stated, where 2 % of error to either side are borne, or where the verdict says so.
    """
    low, high = error.kept_from - 1.0, error.kept_to - 1.0
    is_narrow = max(low, -high) > -KNOWN_FREQUENCY + ALIKE
    if machine.requirements.frequency_spread > 0.0 or not is_narrow:
        return ()
    ends = [
        Message("frequency-end-at-least" if end == tried else "frequency-end", error=end)
        for end, tried in zip((low, high), error.factor[[0, -1]] - 1.0, strict=True)
    ]
    lost = [
        Message(kind, requirement=requirement.message)
        for kind, requirements in (
            ("missed-where-lower", error.lost_below),
            ("missed-where-higher", error.lost_above),
        )
        for requirement in requirements
    ]
    return (
        Message(
            "frequency-spread-not-stated",
            low=ends[0],
            high=ends[1],
            lost=join_by_and(lost),
            least=KNOWN_FREQUENCY,
        ),
    )
