"""The same limits on many machines at once: settling, residual, use of the bounds."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.bench import build_bench
from mtcommission.loop.model.assembly import build_loop
from mtcommission.loop.respond import (
    LoopPoles,
    extremes,
    find_poles,
    free_motion,
    lay_grid,
    set_in_motion,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import (
    CONTOUR_DEVIATION,
    RESIDUAL_DEVIATION,
    RMS_FORCE,
    SET_FORCE,
    SETTLING_TIME,
    Requirement,
    peak_of,
    slow_to_feed,
)
from mtcommission.machine.variations import Variations, vary
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import knots_of, plan_within
from mtcommission.verdict.every_size import rms_forces

Array = NDArray[np.float64]

TOGETHER = 64
"""Machines whose loops are looked at at once: keeps their tables in the cache."""

SAMPLES, RMS_CYCLES = 24, 400
"""Samples of free motion to a period, and position cycles summed for an RMS force."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedResponse:
    """What limits do on many machines, the nominal encoder noise included."""

    settling_time: Array  # slowest move, shape (n_samples,) [s]; inf: not within the horizon
    residual_deviation: Array  # worst move, shape (n_samples,) [m]
    shares: Array  # of every bound, worst move, shape (n_samples, n_bounds) [-]
    bounds: tuple[Requirement, ...]  # what these are of: set force, peaks, contour, RMS force

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


def respond_varied(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    variations: Variations,
) -> VariedResponse:
    """Return what limits do to the listed moves on varied machines under the same controller."""
    count, needs, drive = len(variations.payload), machine.requirements, machine.drive
    bench = build_bench(machine, plant, tuned)
    names = [SET_FORCE, *(peak_of(peak.name) for peak in needs.peaks)]
    names += [CONTOUR_DEVIATION] * isfinite(needs.contour_deviation)
    names += [RMS_FORCE] * isfinite(drive.continuous_force)
    settling, residual = np.zeros(count), np.zeros(count)
    shares = np.zeros((count, len(names)))
    plan, noise = plan_within(machine, limits), needs.tcp_deviation - bench.band
    for start in range(0, count, TOGETHER):
        part = slice(start, min(start + TOGETHER, count))
        poles = find_varied_poles(machine, plant, tuned, variations, part)
        for move in machine.moves:
            setpoint = plan(move)
            own = knots_of(setpoint)
            motions, grid = set_in_motion(poles, own), lay_grid(poles, SAMPLES)
            free = free_motion(motions, grid)
            settling[part] = np.maximum(settling[part], free.settling(bench.band)[0])
            residual[part] = np.maximum(residual[part], free.residual[0] + noise)
            parts = bench.leading[1]
            peaks = extremes(motions, grid, bench.signals, parts=parts, with_deviation=False).peaks
            columns = list((peaks[0] / bench.bounds).T)
            if isfinite(needs.contour_deviation):
                slower = plan(slow_to_feed(move, needs.contour_feed))
                deviation = extremes(
                    set_in_motion(poles, knots_of(slower)),
                    grid,
                    bench.signals[:0],
                    parts=parts,
                    with_deviation=True,
                ).deviation
                columns.append(deviation[0] / bench.contour)
            if isfinite(drive.continuous_force):
                force = rms_forces(
                    poles, own, move.dwell, static_load=drive.static_load, most=RMS_CYCLES
                )
                columns.append(force / drive.continuous_force)
            shares[part] = np.maximum(shares[part], np.array(columns).T)
    return VariedResponse(
        settling_time=settling,
        residual_deviation=residual,
        shares=shares,
        bounds=tuple(names),
    )


def find_varied_poles(
    machine: Machine, plant: Plant, tuned: TunedLoop, variations: Variations, part: slice
) -> LoopPoles:
    """Return the controller of a loop on some varied machines, by its poles."""
    places = [variations.corner(i) for i in range(part.start, part.stop)]
    plants = [build_plant(vary(machine, place)) for place in places]
    loops = [build_loop(each, tuned.controller, model=plant) for each in plants]
    return find_poles.__wrapped__(tuple(loops))
