"""The same limits on many machines at once: settling, residual, use of the bounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.bench import build_bench
from mtcommission.loop.extremes import extremes
from mtcommission.loop.free_motion import free_motion, lay_grid
from mtcommission.loop.model.assembly import build_loop
from mtcommission.loop.motions import set_in_motion
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import Variations, vary
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.requirements.register import requirements_of
from mtcommission.requirements.requirement import Requirement
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import knots_of, plan_within

Array = NDArray[np.float64]

TOGETHER = 64
"""Machines whose loops are looked at at once: keeps their tables in the cache."""

SAMPLES, MEAN_CYCLES = 24, 400
"""Samples of free motion to a period, and position cycles summed for a mean."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedResponse:
    """What limits do on many machines, the nominal encoder noise included."""

    settling_time: Array  # slowest move, shape (n_samples,) [s]; inf: not within the horizon
    residual_deviation: Array  # worst move, shape (n_samples,) [m]
    values: Array  # of each requirement, worst move, shape (n_samples, n_requirements) [own units]
    requirements: tuple[Requirement, ...]

    def shares(self, machine: Machine) -> Array:
        """Return the shares of each bound, shape (n_samples, n_requirements) [-]."""
        return np.asarray(self.values / [item.bound(machine) for item in self.requirements])

    def meets(self, machine: Machine) -> NDArray[np.bool_]:
        """Return which samples keep all requirements, shape (n_samples,)."""
        return np.asarray((self.shares(machine) <= 1.0).all(axis=1))

    def missed(self, machine: Machine, samples: slice) -> tuple[Requirement, ...]:
        """Return the requirements that any of some samples misses."""
        is_missed = self.shares(machine)[samples] > 1.0
        each = zip(self.requirements, is_missed.T, strict=True)
        return tuple(requirement for requirement, own in each if own.any())


def respond_varied(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    variations: Variations,
) -> VariedResponse:
    """Return what limits do to the listed moves on varied machines under the same controller."""
    count, requirements = len(variations.payload), requirements_of(machine)
    bench, plan = build_bench(machine, plant, tuned), plan_within(machine, limits)
    asked, settling, residual = bench.asked, np.zeros(count), np.zeros(count)
    worst = {item: np.zeros(count) for item in requirements}
    for start in range(0, count, TOGETHER):
        part = slice(start, min(start + TOGETHER, count))
        poles = find_varied_poles(machine, plant, tuned, variations, part)
        grid = lay_grid(poles, SAMPLES)
        for place, move in enumerate(machine.moves):
            own = knots_of(plan(move))
            motions = set_in_motion(poles, own)
            free = free_motion(motions, grid)
            time, left = free.settling(bench.band)[0], free.residual[0]
            settling[part] = np.maximum(settling[part], time)
            residual[part] = np.maximum(residual[part], left)
            found = dict.fromkeys(asked.settling, time)
            for requirement, signal in asked.after:
                left = free_motion(motions, grid, signal=signal).residual[0]
                found[requirement] = requirement.with_noise(left, bench.noise)
            for swings in asked.during:
                _, parts = bench.where_to_look(swings)
                judged = set_in_motion(poles, knots_of(plan(swings.moves[place])))
                peaks = extremes(judged, grid, swings.rows, parts=parts, less=swings.less)[0]
                for requirement, column in zip(swings.requirements, peaks.T, strict=True):
                    found[requirement] = requirement.with_noise(column, bench.noise)
            for requirement, mean in asked.means:
                values = mean.exact(machine, poles, move, own, MEAN_CYCLES)
                found[requirement] = requirement.with_noise(values, bench.noise)
            for requirement, values in found.items():
                worst[requirement][part] = np.maximum(worst[requirement][part], values)
    return VariedResponse(
        settling_time=settling,
        residual_deviation=residual + bench.noise.tool,
        values=np.column_stack([worst[item] for item in requirements]),
        requirements=requirements,
    )


def find_varied_poles(
    machine: Machine, plant: Plant, tuned: TunedLoop, variations: Variations, part: slice
) -> LoopPoles:
    """Return the controller of a loop on some varied machines, by its poles."""
    places = [variations.corner(i) for i in range(part.start, part.stop)]
    plants = [build_plant(vary(machine, place)) for place in places]
    loops = [build_loop(each, tuned.controller, model=plant) for each in plants]
    return find_poles.__wrapped__(tuple(loops))
