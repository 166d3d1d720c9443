"""The same limits on thousands of machines at once: settling, residual, use of the bounds.

The loops of all samples advance together, driven by the same setpoint (``varied_motion``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.batch.varied_loops import build_loops
from mtcommission.loop.batch.varied_motion import bounded_signals, follow, shares_of_bounds
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import RESIDUAL_DEVIATION, SETTLING_TIME, Requirement
from mtcommission.machine.variations import Variations
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Setpoint, plan_setpoint

Array = NDArray[np.float64]

CHUNK = 1000
"""Samples advanced at once: keeps their matrices in the cache (measured)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedResponse:
    """What limits do on many machines.

    Parameters
    ----------
    settling_time
        Slowest move, shape (n_samples,) [s]; inf where it has not decayed within the horizon.
    residual_deviation
        Worst move, shape (n_samples,) [m]; inf like the settling time.
    shares
        Share of every bound that is used, worst move, shape (n_samples, n_bounds) [-]. Above 1
        the force would saturate, and the motion differs.
    bounds
        Requirements that these come from: set force, peaks, RMS force.
    """

    settling_time: Array
    residual_deviation: Array
    shares: Array
    bounds: tuple[Requirement, ...]

    @property
    def usage(self) -> Array:
        """Largest share of any bound, shape (n_samples,) [-]."""
        return np.asarray(self.shares.max(axis=1))

    def meets(self, machine: Machine) -> NDArray[np.bool_]:
        """Return which samples keep all requirements, shape (n_samples,)."""
        needs = machine.requirements
        kept = (self.residual_deviation <= needs.tcp_deviation) & (self.usage <= 1.0)
        return np.asarray(kept & (self.settling_time <= needs.max_settling_time))

    def missed(self, machine: Machine, samples: slice) -> tuple[Requirement, ...]:
        """Return the requirements that any of some samples misses."""
        needs = machine.requirements
        found = [
            (RESIDUAL_DEVIATION, self.residual_deviation > needs.tcp_deviation),
            (SETTLING_TIME, self.settling_time > needs.max_settling_time),
            *zip(self.bounds, (self.shares > 1.0).T, strict=True),
        ]
        return tuple(name for name, is_missed in found if is_missed[samples].any())


def respond_to_variations(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    variations: Variations,
) -> VariedResponse:
    """Return settling time and residual deviation of the same limits on many machines.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the force is not saturated here.
    limits
        Acceleration and jerk.
    variations
        The machines.

    Returns
    -------
    VariedResponse
    """
    time = machine.control.moving_average_time
    setpoints = [plan_setpoint(move, limits, moving_average=time) for move in machine.moves]
    return follow_setpoints(machine, plant, tuned, setpoints, variations=variations)


def follow_setpoints(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    setpoints: Sequence[Setpoint],
    *,
    variations: Variations,
) -> VariedResponse:
    """Return what given setpoints do on many machines, worst over the setpoints.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the force is not saturated here.
    setpoints
        One for each move, filters included.
    variations
        The machines.

    Returns
    -------
    VariedResponse
    """
    found = follow_each(machine, plant, tuned, setpoints, variations=variations)
    return VariedResponse(
        settling_time=np.max([item.settling_time for item in found], axis=0),
        residual_deviation=np.max([item.residual_deviation for item in found], axis=0),
        shares=np.max([item.shares for item in found], axis=0),
        bounds=found[0].bounds,
    )


def follow_each(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    setpoints: Sequence[Setpoint],
    *,
    variations: Variations,
) -> tuple[VariedResponse, ...]:
    """Return what each of many setpoints does on many machines.

    Parameters
    ----------
    machine, plant, tuned
        See ``follow_setpoints``.
    setpoints
        Filters included.
    variations
        The machines.

    Returns
    -------
    tuple of VariedResponse
        In the order of the setpoints.
    """
    count, loop = len(variations.payload), tuned.loops[0]
    signals = bounded_signals(machine, plant, loop)
    found = [
        VariedResponse(
            settling_time=np.zeros(count),
            residual_deviation=np.zeros(count),
            shares=np.zeros((count, len(signals.names))),
            bounds=signals.names,
        )
        for _ in setpoints
    ]
    for start in range(0, count, CHUNK):
        part = slice(start, start + CHUNK)
        lifted = build_loops(
            machine, plant, tuned, variations=variations, part=part, signals=signals.rows
        )
        for response, setpoint in zip(found, setpoints, strict=True):
            motion = follow(machine, plant, loop, lifted, signals, setpoint)
            response.settling_time[part] = motion.settling
            response.residual_deviation[part] = motion.residual
            response.shares[part] = shares_of_bounds(motion, signals, setpoint)
    return tuple(found)
