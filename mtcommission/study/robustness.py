"""How the recommended limits fare where the machine or the values entered differ a little.

Three views: thousands of machines drawn from the stated spread, all frequencies off by a common
error, and small changes of each limit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import Jerk
from mtcommission.loop.batch.response import BatchedResponse, simulate_limits_batched
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import Requirement
from mtcommission.machine.variations import (
    Variations,
    as_variations,
    corners,
    draw_variations,
    scale_variations,
)
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import jerk_steps

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustnessSettings:
    """How closely to look.

    Parameters
    ----------
    samples
        Machines drawn from the stated spread (1000: half a second, and a share to within one
        or two per cent; a study may take 10 000).
    seed
        Of the generator.
    sample_cycles
        Position cycles of all samples together: on slow moves fewer machines are drawn, so that
        the time that it takes stays bounded; 100 at least.
    frequency_range
        Least range of the frequency error looked at, to either side [-]; the stated spread,
        doubled, where that is more.
    frequency_points
        To either side.
    """

    samples: int = 1000
    seed: int = 0
    sample_cycles: int = 1_000_000
    frequency_range: float = 0.1
    frequency_points: int = 40


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MonteCarlo:
    """Distribution of settling time and residual deviation over the stated spread.

    Parameters
    ----------
    variations
        The machines drawn.
    settling_time, residual_deviation
        Of the slowest move and the worst move, shape (n_samples,) [s, m]; inf: not settled.
    share_met, share_in_band
        Share of samples that keep all requirements, and the band alone [-].
    seed
        Of the generator.
    """

    variations: Variations
    settling_time: Array
    residual_deviation: Array
    share_met: float
    share_in_band: float
    seed: int

    @property
    def worst(self) -> int:
        """The sample with the largest residual deviation."""
        return int(np.argmax(self.residual_deviation))

    @property
    def slowest(self) -> int:
        """The sample with the longest settling time."""
        return int(np.argmax(self.settling_time))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyError:
    """What the same limits do where all eigenfrequencies are off by a common factor.

    Parameters
    ----------
    factor
        Frequencies over those of the profile, rising, shape (n,) [-].
    settling_time, residual_deviation
        Worst over moves and over the ends of payload and damping, shape (n,) [s, m].
    kept_from, kept_to
        Ends of the range about 1 within which every requirement is kept at all points [-];
        both nan if not even at 1.
    lost_below, lost_above
        Requirements missed at the next point beyond either end; empty where that was not looked
        at, or where there is no range.
    """

    factor: Array
    settling_time: Array
    residual_deviation: Array
    kept_from: float
    kept_to: float
    lost_below: tuple[Requirement, ...]
    lost_above: tuple[Requirement, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingRange:
    """Between which common factors on all damping ratios every requirement is kept.

    Parameters
    ----------
    kept_from, kept_to
        Ends of the unbroken range about 1, worst over the ends of payload and frequency [-]; both
        nan if not even at 1. At the ends of ``DAMPING_FACTORS`` nothing further was looked at.
    """

    kept_from: float
    kept_to: float


DAMPING_FACTORS = np.linspace(0.3, 1.7, 29)
"""Looked at: what is measured of damping on one day may be off by half on another."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """What a small change costs, worst over moves and corners.

    Parameters
    ----------
    change
        What was changed.
    settling_time, residual_deviation
        After the change [s, m].
    settling_change, residual_change
        Relative to the unchanged ones [-]; inf or nan where a response does not settle.
    is_met
        Whether every requirement still holds.
    """

    change: Message
    settling_time: float
    residual_deviation: float
    settling_change: float
    residual_change: float
    is_met: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Robustness:
    """All three views, and what they warn of.

    Parameters
    ----------
    monte_carlo
        None where the profile states no spread and no range of payload: nothing to draw.
    frequency_error, damping_range, sensitivities
        See the classes.
    warnings
        Empty where the requirements bear what must be reckoned with.
    """

    monte_carlo: MonteCarlo | None
    frequency_error: FrequencyError
    damping_range: DampingRange
    sensitivities: tuple[Sensitivity, ...]
    warnings: tuple[Message, ...]


def examine_robustness(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    settings: RobustnessSettings,
) -> Robustness:
    """Return how limits fare where machine or limits differ a little.

    Parameters
    ----------
    machine, plant, tuned
        The nominal machine, its plant and its loop.
    limits
        Acceleration and jerk.
    settings
        How closely to look.

    Returns
    -------
    Robustness
    """
    monte_carlo = None
    if len(corners(machine)) > 1:
        monte_carlo = run_monte_carlo(
            machine,
            plant,
            tuned,
            limits,
            samples=_affordable(machine, limits, settings),
            seed=settings.seed,
        )
    error = find_frequency_error(machine, plant, tuned, limits, settings=settings)
    return Robustness(
        monte_carlo=monte_carlo,
        frequency_error=error,
        damping_range=find_damping_range(machine, plant, tuned, limits),
        sensitivities=find_sensitivities(machine, plant, tuned, limits),
        warnings=warn_of_narrow_range(machine, error),
    )


KNOWN_FREQUENCY = 0.02
"""Error of an eigenfrequency that must be reckoned with even where it was measured [-]
(empirical: resolution of the measurement, temperature, position on the axis)."""

ALIKE = 1e-9
"""Rounding of a frequency error [-]."""


def warn_of_narrow_range(machine: Machine, error: FrequencyError) -> tuple[Message, ...]:
    """Return a warning where the requirements hang on frequencies nobody knows so exactly.

    Limits that cancel a vibration are as exact as its frequency. Where no spread is stated they
    may be kept at the stated frequency alone, and the verdict would not show it.

    Parameters
    ----------
    machine
        Nominal; its stated spread counts.
    error
        Between which frequency errors every requirement is kept.

    Returns
    -------
    tuple of Message
        Empty where a spread is stated, where at least 2 % of error to either side are borne, or
        where not even the stated frequencies keep the requirements: the verdict says so.
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


FEWEST_SAMPLES = 100
"""However slow the moves (a share is then known to within some five per cent)."""


def _affordable(machine: Machine, limits: MotionLimits, settings: RobustnessSettings) -> int:
    """How many machines are drawn, by the length of the moves."""
    a, j = np.array([limits.acceleration]), np.array([limits.jerk])
    ends = [jerk_steps(move, acceleration=a, jerk=j).duration[0] for move in machine.moves]
    cycles = float(np.sum(ends)) / machine.control.position_cycle
    return max(min(settings.samples, int(settings.sample_cycles / cycles)), FEWEST_SAMPLES)


def run_monte_carlo(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    samples: int = 10_000,
    seed: int = 0,
) -> MonteCarlo:
    """Return settling time and residual deviation over the stated spread.

    Payload, frequency factor and damping factor are drawn uniformly and independently from
    their stated ranges.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the controller is the same on every sample.
    limits
        Acceleration and jerk.
    samples
        How many machines.
    seed
        Of the generator.

    Returns
    -------
    MonteCarlo
    """
    variations = draw_variations(machine, samples=samples, seed=seed)
    found = simulate_limits_batched(machine, plant, tuned, limits, variations=variations)
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
    """Return settling time and residual deviation over a common error of all frequencies.

    Parameters
    ----------
    machine, plant, tuned
        The nominal machine, its plant and its loop.
    limits
        Acceleration and jerk.
    settings
        Range and number of points.

    Returns
    -------
    FrequencyError
    """
    needs = machine.requirements
    known = replace(machine, requirements=replace(needs, frequency_spread=0.0))
    places = corners(known)
    reach = max(settings.frequency_range, min(2.0 * needs.frequency_spread, 0.5))
    middle = settings.frequency_points
    factor = 1.0 + reach * np.linspace(-1.0, 1.0, 2 * middle + 1)
    each = as_variations(places)
    variations = Variations(
        payload=np.tile(each.payload, len(factor)),
        frequency_factor=np.repeat(factor, len(places)),
        damping_factor=np.tile(each.damping_factor, len(factor)),
    )
    found = simulate_limits_batched(machine, plant, tuned, limits, variations=variations)
    shape = (len(factor), len(places))
    kept = np.all(found.meets(machine).reshape(shape), axis=1)
    low, high = _stretch_about(kept, middle)
    below = slice((low - 1) * len(places), low * len(places)) if low > 0 else slice(0)
    above = slice((high + 1) * len(places), (high + 2) * len(places))
    return FrequencyError(
        factor=factor,
        settling_time=found.settling_time.reshape(shape).max(axis=1),
        residual_deviation=found.residual_deviation.reshape(shape).max(axis=1),
        kept_from=float(factor[low]) if kept[middle] else np.nan,
        kept_to=float(factor[high]) if kept[middle] else np.nan,
        lost_below=found.missed(machine, below) if kept[middle] else (),
        lost_above=found.missed(machine, above) if kept[middle] else (),
    )


def find_damping_range(
    machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits
) -> DampingRange:
    """Return between which common factors on all damping ratios every requirement is kept.

    Parameters
    ----------
    machine, plant, tuned
        The nominal machine, its plant and its loop.
    limits
        Acceleration and jerk.

    Returns
    -------
    DampingRange
    """
    known = replace(machine, requirements=replace(machine.requirements, damping_spread=0.0))
    each, count = as_variations(corners(known)), len(DAMPING_FACTORS)
    variations = Variations(
        payload=np.tile(each.payload, count),
        frequency_factor=np.tile(each.frequency_factor, count),
        damping_factor=np.repeat(DAMPING_FACTORS, len(each.payload)),
    )
    found = simulate_limits_batched(machine, plant, tuned, limits, variations=variations)
    kept, middle = np.all(found.meets(machine).reshape(count, -1), axis=1), count // 2
    low, high = _stretch_about(kept, middle)
    return DampingRange(
        kept_from=float(DAMPING_FACTORS[low]) if kept[middle] else np.nan,
        kept_to=float(DAMPING_FACTORS[high]) if kept[middle] else np.nan,
    )


def _stretch_about(kept: NDArray[np.bool_], middle: int) -> tuple[int, int]:
    """First and last index of the unbroken stretch of kept points about the middle."""
    before, after = kept[:middle][::-1], kept[middle + 1 :]
    down = int(np.argmin(before)) if not before.all() else len(before)
    up = int(np.argmin(after)) if not after.all() else len(after)
    return middle - down, middle + up


def find_sensitivities(
    machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits
) -> tuple[Sensitivity, ...]:
    """Return what small changes of limits and machine cost, in all corners.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop.
    limits
        Acceleration and jerk.

    Returns
    -------
    tuple of Sensitivity
        10 % more and less jerk, where it is limited, and acceleration, behind the same filter;
        all frequencies, in every corner, 1 % higher
        and lower; 10 % less damping.
    """
    places = as_variations(corners(machine))
    a, j = limits.acceleration, limits.jerk
    jerks = [
        ("change-jerk", 0.1, replace(limits, jerk=1.1 * j), places),
        ("change-jerk", -0.1, replace(limits, jerk=0.9 * j), places),
    ]
    cases = [
        *([] if machine.control.kind.jerk is Jerk.NONE else jerks),
        ("change-acceleration", 0.1, replace(limits, acceleration=1.1 * a), places),
        ("change-acceleration", -0.1, replace(limits, acceleration=0.9 * a), places),
        ("change-frequencies", 0.01, limits, scale_variations(places, frequency=1.01)),
        ("change-frequencies", -0.01, limits, scale_variations(places, frequency=0.99)),
        ("change-damping", -0.1, limits, scale_variations(places, damping=0.9)),
    ]
    base = simulate_limits_batched(machine, plant, tuned, limits, variations=places)
    return tuple(
        _compare(
            machine,
            Message(kind, change=change),
            base,
            simulate_limits_batched(machine, plant, tuned, varied, variations=variations),
        )
        for kind, change, varied, variations in cases
    )


def _compare(
    machine: Machine, change: Message, base: BatchedResponse, found: BatchedResponse
) -> Sensitivity:
    settling = float(found.settling_time.max())
    residual = float(found.residual_deviation.max())
    return Sensitivity(
        change=change,
        settling_time=settling,
        residual_deviation=residual,
        settling_change=settling / float(base.settling_time.max()) - 1.0,
        residual_change=residual / float(base.residual_deviation.max()) - 1.0,
        is_met=bool(found.meets(machine).all()),
    )
