"""The landscape of settling time over acceleration and jerk time, to be printed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.search.bench import build_bench, settle_gradually
from mtcommission.limits.search.explore import guess_usage
from mtcommission.limits.search.region import Region, longest_motion, widest_region
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.setpoint.motion_limits import MotionLimits

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Landscape:
    """Worst over moves and corners, at a first look.

    Parameters
    ----------
    acceleration, jerk_time
        Axes, shapes (n,), (n,) [m/s², s].
    settling_time, residual_deviation
        Shape (n, n) [s, m]; inf where not settled in the horizon.
    usage
        Share of the available force (and of bounded peaks and RMS force) that is used,
        interpolated from a coarse grid, shape (n, n) [-].
    """

    acceleration: Array
    jerk_time: Array
    settling_time: Array
    residual_deviation: Array
    usage: Array


def chart_landscape(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    chosen: MotionLimits,
    settings: SearchSettings,
    *,
    widest: Region | None = None,
) -> Landscape:
    """Return the landscape about the limits that were chosen, behind their setpoint filter.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    chosen
        Limits that lie inside.
    settings
        Points in each direction, logarithmic.
    widest
        Region that was searched; None: the widest about the chosen limits.
    """
    if chosen.setpoint_filter is not None:
        own = replace(machine.control, setpoint_filter=chosen.setpoint_filter)
        machine = replace(machine, control=own)
    region = widest or widest_region(machine, plant, settings, [chosen])
    longest = max(region.longest_jerk_time, CHOSEN_INSIDE * chosen.jerk_time)
    if region.has_one_jerk_time:
        # The picture shows what a jerk limit would do, too.
        longest = max(longest_period(plant), MAPPED * region.shortest_jerk_time)
    region = replace(region, longest_jerk_time=longest)
    bench = build_bench(machine, plant, tuned, longest=longest_motion(machine, region))
    guess = guess_usage(bench, region, widest=region, points=settings.coarse_grid)
    points = settings.landscape
    a = np.geomspace(region.least_acceleration, region.largest_acceleration, points)
    t = np.geomspace(region.shortest_jerk_time, region.longest_jerk_time, points)
    a_grid, t_grid = (axis.ravel() for axis in np.meshgrid(a, t, indexing="ij"))
    *_, (_, found) = settle_gradually(bench, bench.sketches, a_grid, t_grid)
    return Landscape(
        acceleration=a,
        jerk_time=t,
        settling_time=found.settling_time.reshape(points, points),
        residual_deviation=found.residual_deviation.reshape(points, points),
        usage=guess.at(a_grid, t_grid).reshape(points, points),
    )


CHOSEN_INSIDE = 1.3
"""Longest jerk time of the map over that of the chosen limits, at least."""

MAPPED = 10.0
"""Longest jerk time of the map over the position cycle, where the control has no jerk limit."""
