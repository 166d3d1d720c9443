"""The map of settling times over acceleration and jerk time, to be printed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.bench import build_bench
from mtcommission.loop.respond import free_motion, lay_grid, set_in_motion
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, largest_acceleration
from mtcommission.machine.plant.plant import longest_period
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import filter_steps, jerk_steps

Array = NDArray[np.float64]

POINTS, USAGE_POINTS = 40, 7
"""Points of the map in each direction, and of the use of force, which is smooth."""

AROUND = 5.0
"""How far the map reaches beyond the chosen jerk time, and below the chosen acceleration [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Landscape:
    """Worst over the listed moves and corners; inf where not settled in the horizon."""

    acceleration: Array  # [m/s²], shape (n,)
    jerk_time: Array  # [s], shape (n,)
    settling_time: Array  # [s], shape (n, n)
    residual_deviation: Array  # [m], shape (n, n)
    usage: Array  # largest share of force, peaks and RMS force, shape (n, n) [-]


def chart_landscape(machine: Machine, tuned: TunedLoop, chosen: MotionLimits) -> Landscape:
    """Return the map about the limits that were chosen, behind their setpoint filter."""
    listed = replace(machine.requirements, every_size=False)
    bench = build_bench(replace(machine, requirements=listed), tuned)
    largest = max(largest_acceleration(machine), 1.05 * chosen.acceleration)
    a = np.geomspace(min(0.05 * largest, chosen.acceleration / AROUND), largest, POINTS)
    longest = max(1.5 * longest_period(tuned.plant), AROUND * chosen.jerk_time)
    shortest = min(chosen.jerk_time / AROUND, 0.2 * longest)
    t_j = np.geomspace(shortest, longest, POINTS)
    a_all, t_all = (axis.ravel() for axis in np.meshgrid(a, t_j, indexing="ij"))
    settling, residual = np.zeros((2, a_all.size))
    poles, item = bench.poles, chosen.setpoint_filter or machine.control.setpoint_filter
    grid, band = lay_grid(poles, 12), machine.requirements.tcp_deviation
    for move in machine.moves:
        steps = filter_steps(jerk_steps(move, acceleration=a_all, jerk=a_all / t_all), item)
        for start in range(0, a_all.size, 400):
            part = slice(start, start + 400)
            found = free_motion(set_in_motion(poles, steps.only(part)), grid)
            settling[part] = np.maximum(settling[part], found.settling(band).max(axis=1))
            residual[part] = np.maximum(residual[part], found.residual.max(axis=1))
    coarse = np.linspace(0, POINTS - 1, USAGE_POINTS).round().astype(int)
    use, ramps = bench.use(item), t_j[coarse].tolist()
    forces = np.array([use.of_means(a[coarse], t) for t in ramps]).T
    usage = np.array([[use.of_rest(x, t) for t in ramps] for x in a[coarse].tolist()])
    usage = np.maximum(usage, forces)
    spread = np.arange(POINTS)
    usage = np.array([np.interp(spread, coarse, row) for row in usage])
    usage = np.array([np.interp(spread, coarse, column) for column in usage.T]).T
    shape = (POINTS, POINTS)
    return Landscape(
        acceleration=a,
        jerk_time=t_j,
        settling_time=settling.reshape(shape),
        residual_deviation=residual.reshape(shape),
        usage=usage,
    )
