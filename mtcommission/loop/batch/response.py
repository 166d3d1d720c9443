"""The same limits on thousands of machines at once: settling, residual, use of the bounds.

The loops of all samples advance together, driven by the same setpoint (``run``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.batch.loops import discretise_variations
from mtcommission.loop.batch.run import bounded_signals, run_batch, shares_of_bounds
from mtcommission.loop.model.assembly import lift_on_plants
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import (
    RESIDUAL_DEVIATION,
    SETTLING_TIME,
    Requirement,
    slow_to_feed,
)
from mtcommission.machine.variations import Variations
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Plan, plan_within

Array = NDArray[np.float64]

CHUNK = 1000
"""Samples advanced at once: keeps their matrices in the cache (measured)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BatchedResponse:
    """What limits do on many machines, the nominal encoder noise included.

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
        Requirements that these come from: set force, peaks, contour, RMS force.
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


def simulate_limits_batched(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    variations: Variations,
) -> BatchedResponse:
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
    BatchedResponse
    """
    plan = plan_within(machine, limits)
    return simulate_batched(machine, plant, tuned, plan, variations=variations)


def simulate_batched(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    plan: Plan,
    *,
    variations: Variations,
) -> BatchedResponse:
    """Return what planned setpoints do on many machines, worst over the moves.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the force is not saturated here.
    plan
        Setpoint of a move, filters included.
    variations
        The machines.

    Returns
    -------
    BatchedResponse
    """
    count, loop = len(variations.payload), tuned.loops[0]
    signals = bounded_signals(machine, plant, loop)
    settling, residual = np.zeros(count), np.zeros(count)
    shares = np.zeros((count, len(signals.names)))
    for start in range(0, count, CHUNK):
        part = slice(start, start + CHUNK)
        A, B = discretise_variations(
            machine, plant, loop.controller.velocity_cycle, variations=variations, part=part
        )
        rows = lift_on_plants(loop, A, B, signals=signals.rows)
        for move in machine.moves:
            setpoint, slower = plan(move), slow_to_feed(move, machine.requirements.contour_feed)
            run = run_batch(machine, loop, rows, signals, setpoint)
            if isfinite(signals.contour) and slower != move:
                path = run_batch(machine, loop, rows, signals, plan(slower))
                run = replace(run, contour=path.contour)
            used = shares_of_bounds(run, signals, setpoint)
            settling[part] = np.maximum(settling[part], run.settling)
            residual[part] = np.maximum(residual[part], run.residual)
            shares[part] = np.maximum(shares[part], used)
    return BatchedResponse(
        settling_time=settling,
        residual_deviation=residual + signals.tool_noise,
        shares=shares,
        bounds=signals.names,
    )
