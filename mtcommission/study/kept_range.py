"""How far frequencies or damping may be off until a requirement is missed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import (
    Variations,
    as_variations,
    corners,
)
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant
from mtcommission.requirements.requirement import Requirement
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import RobustnessSettings
from mtcommission.study.varied import respond_varied

Array = NDArray[np.float64]


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


DAMPING_FACTORS = np.linspace(0.3, 1.7, 15)
"""Looked at: what is measured of damping on one day may be off by half on another."""


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
    """
    needs = machine.requirements
    known = replace(machine, requirements=replace(needs, frequency_spread=0.0))
    reach = max(settings.frequency_range, min(2.0 * needs.frequency_spread, 0.5))
    middle = settings.frequency_points
    factor = 1.0 + reach * np.linspace(-1.0, 1.0, 2 * middle + 1)
    each = _repeat(known, len(factor))
    shape = (len(factor), len(each.payload) // len(factor))
    variations = replace(each, frequency_factor=np.repeat(factor, shape[1]))
    found = respond_varied(machine, plant, tuned, limits, variations=variations)
    kept = np.all(found.meets(machine).reshape(shape), axis=1)
    low, high = _stretch_about(kept, middle)
    below = slice((low - 1) * shape[1], low * shape[1]) if low > 0 else slice(0)
    above = slice((high + 1) * shape[1], (high + 2) * shape[1])
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
    """
    known = replace(machine, requirements=replace(machine.requirements, damping_spread=0.0))
    count = len(DAMPING_FACTORS)
    each = _repeat(known, count)
    variations = replace(
        each, damping_factor=np.repeat(DAMPING_FACTORS, len(each.payload) // count)
    )
    found = respond_varied(machine, plant, tuned, limits, variations=variations)
    kept, middle = np.all(found.meets(machine).reshape(count, -1), axis=1), count // 2
    low, high = _stretch_about(kept, middle)
    return DampingRange(
        kept_from=float(DAMPING_FACTORS[low]) if kept[middle] else np.nan,
        kept_to=float(DAMPING_FACTORS[high]) if kept[middle] else np.nan,
    )


def _repeat(machine: Machine, count: int) -> Variations:
    """The corners of a machine, all of them so many times."""
    each = as_variations(corners(machine))
    return Variations(
        payload=np.tile(each.payload, count),
        frequency_factor=np.tile(each.frequency_factor, count),
        damping_factor=np.tile(each.damping_factor, count),
    )


def _stretch_about(kept: NDArray[np.bool_], middle: int) -> tuple[int, int]:
    """First and last index of the unbroken stretch of kept points about the middle."""
    before, after = kept[:middle][::-1], kept[middle + 1 :]
    down = int(np.argmin(before)) if not before.all() else len(before)
    up = int(np.argmin(after)) if not after.all() else len(after)
    return middle - down, middle + up
