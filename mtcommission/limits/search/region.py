"""Where better limits can lie: between what the drive can do and what is too slow anyway.

No response settles before its setpoint has ended and the delay τ has passed. So once some limits
are known to settle at T with every requirement met, all limits whose slowest setpoint takes longer
than T - τ are out, whatever the loop does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, inf, log

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.search.bench import motion_time, reached_accelerations
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit

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
    largest_jerk
        [m/s³].
    """

    least_acceleration: float
    largest_acceleration: float
    shortest_jerk_time: float
    longest_jerk_time: float
    longest_motion: float = inf
    largest_jerk: float = inf

    @property
    def has_one_jerk_time(self) -> bool:
        """Whether the control has no jerk limit: every ramp then takes one position cycle."""
        return self.shortest_jerk_time == self.longest_jerk_time

    def holds(self, acceleration: Array, jerk_time: Array) -> NDArray[np.bool_]:
        """Return which limits of the box keep the largest jerk, but for rounding."""
        return np.asarray(acceleration <= ALIKE * self.largest_jerk * jerk_time)

    def nearest(self, limits: MotionLimits, *, share: float = 1.0) -> MotionLimits:
        """Return the nearest limits within, with a share of the acceleration."""
        low, high = self.least_acceleration, self.largest_acceleration
        a = min(max(share * min(limits.acceleration, high), low), high)
        t = min(max(limits.jerk_time, self.shortest_jerk_time), self.longest_jerk_time)
        a = min(a, self.largest_jerk * t)
        return MotionLimits(acceleration=a, jerk=a / t)


ALIKE = 1.0 + 1e-9
"""Rounding of a limit."""


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
    machine: Machine,
    plant: Plant,
    settings: SearchSettings,
    starts: Sequence[MotionLimits] = (),
    *,
    largest_jerk: float = inf,
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
    largest_jerk
        [m/s³].

    Returns
    -------
    Region
        With all ramps of one position cycle where the control has no jerk limit.
    """
    a_max = machine.drive.motion_force / moving_mass(machine)
    slow = max(
        settings.longest_jerk_time * min(longest_period(plant), 1.0), settings.slow_jerk_time
    )
    least = settings.least_acceleration * a_max
    if machine.control.kind.has_jerk_limit:
        shortest = settings.least_jerk_time
        longest = max(slow, *(item.jerk_time / ROOM_BELOW for item in starts), slow)
    else:
        # Nothing but less acceleration calms such a machine.
        shortest = longest = without_jerk_limit(machine, a_max).jerk_time
        least *= JERKLESS
    return Region(
        least_acceleration=min(
            least,
            *(ROOM_BELOW * item.acceleration for item in starts),
            a_max,
        ),
        largest_acceleration=a_max,
        shortest_jerk_time=shortest,
        longest_jerk_time=longest,
        largest_jerk=largest_jerk,
    )


ROOM_BELOW = 0.7
"""Acceleration searched below the lowest start, as a share of it; jerk times likewise above."""

JERKLESS = 0.1
"""How much lower the acceleration is searched where the control has no jerk limit [-]."""

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
    """
    a_max, t_min = region.largest_acceleration, region.shortest_jerk_time
    # t_e falls with a and rises with t_j, so the corner (a_max, t_min) sees the furthest.
    a = np.geomspace(LEAST_SHARE * a_max, a_max, AXIS)
    t = np.geomspace(t_min, max(2.0 * longest_motion, 2.0 * t_min), AXIS)
    low = np.searchsorted(-motion_time(machine, a, np.full(AXIS, t_min)), -longest_motion)
    high = np.searchsorted(motion_time(machine, np.full(AXIS, a_max), t), longest_motion)
    return replace(
        region,
        least_acceleration=float(a[max(min(int(low), AXIS - 1) - 1, 0)]),
        longest_jerk_time=(
            t_min if region.has_one_jerk_time else float(t[min(int(high), AXIS - 1)])
        ),
        longest_motion=longest_motion,
    )


def longest_motion(machine: Machine, region: Region) -> float:
    """Return t_e of the slowest move with the gentlest limits of a region [s]."""
    a, t = np.array([region.least_acceleration]), np.array([region.longest_jerk_time])
    return float(motion_time(machine, a, t)[0])


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
    """
    a = _axis(
        region.least_acceleration,
        region.largest_acceleration,
        points / log(widest.largest_acceleration / widest.least_acceleration),
    )
    t = (
        _axis(
            region.shortest_jerk_time,
            region.longest_jerk_time,
            points / log(widest.longest_jerk_time / widest.shortest_jerk_time),
        )
        if not region.has_one_jerk_time
        else np.array([region.shortest_jerk_time])
    )
    ratio = float(a[1] / a[0])
    a_grid, t_grid = (axis.ravel() for axis in np.meshgrid(a, t, indexing="ij"))
    time = motion_time(machine, a_grid, t_grid)
    kept = time <= region.longest_motion
    kept &= a_grid <= ratio * reached_accelerations(machine, a_grid, t_grid)
    allowed = region.holds(a_grid, t_grid)
    kept &= allowed
    # A move shorter than the shortest ramps reaches none of these; its jerk counts all the same.
    kept[np.argmin(np.where(allowed, time, inf))] = True
    return Grid(
        acceleration=a_grid[kept],
        jerk_time=t_grid[kept],
        ratio_acceleration=ratio,
        ratio_jerk_time=float(t[1] / t[0]) if len(t) > 1 else 1.0,
    )


def _axis(low: float, high: float, density: float) -> Array:
    return np.geomspace(low, high, max(LEAST_POINTS, ceil(density * log(high / low)) + 1))
