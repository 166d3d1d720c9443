"""Where better limits can lie: between what the drive can do and what is too slow anyway.

No response settles before its setpoint has ended and the delay τ has passed. So once some limits
are known to settle at T with every requirement met, all limits whose slowest setpoint takes longer
than T - τ are out, whatever the loop does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf, log

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.search.bench import motion_time, reached_accelerations
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.setpoint.motion_limits import MotionLimits

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Region:
    """A box of limits, and how long their setpoints may take.

    Parameters
    ----------
    least_acceleration, largest_acceleration
        [m/s²].
    shortest_jerk_time, longest_jerk_time
        [s].
    longest_motion
        t_e of the slowest move [s]; inf where nothing is known.
    """

    least_acceleration: float
    largest_acceleration: float
    shortest_jerk_time: float
    longest_jerk_time: float
    longest_motion: float = inf


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Limits to look at.

    Parameters
    ----------
    acceleration, jerk_time
        Shape (n_limits,) [m/s², s].
    ratio_acceleration, ratio_jerk_time
        Of neighbours [-].
    """

    acceleration: Array
    jerk_time: Array
    ratio_acceleration: float
    ratio_jerk_time: float


def widest_region(
    machine: Machine, plant: Plant, settings: SearchSettings, starts: Sequence[MotionLimits] = ()
) -> Region:
    """Return where to search if nothing is known, wide enough to hold some limits.

    Parameters
    ----------
    machine, plant
        Nominal.
    settings
        Its ends.
    starts
        Limits to hold with room around them.

    Returns
    -------
    Region
    """
    a_max = machine.drive.motion_force / moving_mass(machine)
    slow = max(
        settings.longest_jerk_time * min(longest_period(plant), 1.0), settings.slow_jerk_time
    )
    return Region(
        least_acceleration=min(
            settings.least_acceleration * a_max,
            *(ROOM_BELOW * item.acceleration for item in starts),
            a_max,
        ),
        largest_acceleration=a_max,
        shortest_jerk_time=settings.least_jerk_time,
        longest_jerk_time=max(slow, *(item.jerk_time / ROOM_BELOW for item in starts), slow),
    )


ROOM_BELOW = 0.7
"""Acceleration searched below the lowest start, as a share of it; jerk times likewise above."""

AXIS = 400
"""Points at which the ends of a narrowed region are looked for: 1 to 2 % apart."""


def narrow_region(region: Region, machine: Machine, *, longest_motion: float) -> Region:
    """Return the box about all limits whose setpoints are short enough.

    Parameters
    ----------
    region
        Its largest acceleration and shortest jerk time stay.
    machine
        Whose moves.
    longest_motion
        t_e of the slowest move, filter included [s].

    Returns
    -------
    Region
    """
    a_max, t_min = region.largest_acceleration, region.shortest_jerk_time
    # t_e falls with a and rises with t_j, so the corner (a_max, t_min) sees the furthest.
    a = np.geomspace(LEAST_SHARE * a_max, a_max, AXIS)
    t = np.geomspace(t_min, max(2.0 * longest_motion, 2.0 * t_min), AXIS)
    low = np.searchsorted(-motion_time(machine, a, np.full(AXIS, t_min)), -longest_motion)
    high = np.searchsorted(motion_time(machine, np.full(AXIS, a_max), t), longest_motion)
    return Region(
        least_acceleration=float(a[max(min(int(low), AXIS - 1) - 1, 0)]),
        largest_acceleration=a_max,
        shortest_jerk_time=t_min,
        longest_jerk_time=float(t[min(int(high), AXIS - 1)]),
        longest_motion=longest_motion,
    )


LEAST_SHARE = 1e-3
"""Of F_max/m: below it no search goes."""

LEAST_POINTS = 8
"""Points of a grid in each direction however narrow it is."""


def lay_grid(region: Region, machine: Machine, *, widest: Region, points: int) -> Grid:
    """Return the limits of a region's grid, without those that are slow or repeat others.

    Where no move reaches a, only the jerk counts: such limits are kept up to one cell beyond
    the border, below which the same motions are. The quickest limits are always there.

    Parameters
    ----------
    region
        Where.
    machine
        Whose moves.
    widest
        Region that ``points`` is meant for.
    points
        In each direction over the widest region.

    Returns
    -------
    Grid
    """
    a = _axis(
        region.least_acceleration,
        region.largest_acceleration,
        points / log(widest.largest_acceleration / widest.least_acceleration),
    )
    t = _axis(
        region.shortest_jerk_time,
        region.longest_jerk_time,
        points / log(widest.longest_jerk_time / widest.shortest_jerk_time),
    )
    ratio = float(a[1] / a[0])
    a_grid, t_grid = (axis.ravel() for axis in np.meshgrid(a, t, indexing="ij"))
    time = motion_time(machine, a_grid, t_grid)
    kept = time <= region.longest_motion
    kept &= a_grid <= ratio * reached_accelerations(machine, a_grid, t_grid)
    # A move shorter than the shortest ramps reaches none of these; its jerk counts all the same.
    kept[np.argmin(time)] = True
    return Grid(
        acceleration=a_grid[kept],
        jerk_time=t_grid[kept],
        ratio_acceleration=ratio,
        ratio_jerk_time=float(t[1] / t[0]),
    )


def _axis(low: float, high: float, density: float) -> Array:
    return np.geomspace(low, high, max(LEAST_POINTS, ceil(density * log(high / low)) + 1))
