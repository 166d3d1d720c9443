"""How the recommended limits fare where the machine or the values entered differ a little.

Three views: thousands of machines drawn from the stated spread, all frequencies off by a common
error, and small changes of each limit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import Jerk
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import (
    Variations,
    as_variations,
    corners,
    draw_variations,
    scale_variations,
)
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.kept_range import (
    DampingRange,
    FrequencyError,
    find_damping_range,
    find_frequency_error,
    warn_of_narrow_range,
)
from mtcommission.study.settings import RobustnessSettings
from mtcommission.study.varied import VariedResponse, respond_varied

Array = NDArray[np.float64]


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
    """
    monte_carlo = None
    if len(corners(machine)) > 1:
        monte_carlo = run_monte_carlo(
            machine,
            plant,
            tuned,
            limits,
            samples=settings.samples,
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
        Acceleration, jerk and the setpoint filter.

    Returns
    -------
    tuple of Sensitivity
        10 % more and less jerk (where it can be set) and acceleration, behind the same filter; all
        frequencies, in every corner, 1 % higher and lower; 10 % less damping.
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
    base = respond_varied(machine, plant, tuned, limits, variations=places)
    return tuple(
        _compare(
            machine,
            Message(kind, change=change),
            base,
            respond_varied(machine, plant, tuned, varied, variations=variations),
        )
        for kind, change, varied, variations in cases
    )


def _compare(
    machine: Machine, change: Message, base: VariedResponse, found: VariedResponse
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
