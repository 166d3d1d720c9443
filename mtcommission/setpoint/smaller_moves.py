"""Every smaller move of a listed one, close enough together: what limits must serve besides.

Smaller moves differ in one time only: how long the jerk acts where the acceleration is not reached,
how long the acceleration is held where the velocity is not, how long the axis cruises. Sizes whose
times lie one spacing apart follow each other as closely as their responses need it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil, floor, isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps, jerk_steps

Array = NDArray[np.float64]

SMALLEST = 1e-3
"""Of the sizes looked at, as a share of the listed one [-]: what is left of a move falls with its
size below that of the shortest ramp."""


def size_of(move: Move) -> float:
    """Return the velocity step [m/s] or the distance [m] of a move."""
    return move.velocity_step if isinstance(move, VelocityStep) else move.distance


def resize(move: Move, size: float) -> Move:
    """Return the same move with another velocity step [m/s] or distance [m]."""
    if isinstance(move, VelocityStep):
        return replace(move, velocity_step=size)
    return replace(move, distance=size)


def lay_sizes(
    move: Move,
    limits: MotionLimits,
    *,
    pointed_spacing: float,
    spacing: float,
    decayed: float,
    cycle: float = 0.0,
) -> Array:
    """Return sizes of a move from nearly nothing to its own, one spacing of time apart, (n,).

    Rising, the last one the move's own [m/s or m]. ``pointed_spacing``: between the ramps of two
    neighbours that do not reach the acceleration; ``spacing``: between the times that set any other
    two apart; ``decayed``: time in which the answer to a step of the jerk dies away: what is held
    or cruised for longer is as good as for ever [s]. ``cycle``: where stated, sizes on either side
    of each at which a step of the setpoint passes a sample of it are added [s].
    """
    a, j, t_j, listed = limits.acceleration, limits.jerk, limits.jerk_time, size_of(move)
    found: list[Array] = [np.array([listed])]

    def lay(start: float, stop: float, spacing: float, size: Callable[[Array], Array]) -> None:
        stop = min(stop, start + decayed)
        times = np.linspace(start, stop, max(int(np.ceil((stop - start) / spacing)), 1) + 1)
        if cycle and stop > start:
            ends = size(np.array([max(start, 1e-3 * stop), stop]))
            steps = plan_sizes(move, ends, limits).times
            times = np.append(times, _passing(steps, max(start, 1e-3 * stop), stop, cycle))
        found.append(size(times))

    if isinstance(move, VelocityStep):
        lay(0.0, min(t_j, sqrt(listed / j)), pointed_spacing, lambda t: j * t**2)
        if listed / a > t_j:
            lay(t_j, listed / a, spacing, lambda T: a * T)
    else:
        fastest = move.max_velocity
        longest = min(t_j, (0.5 * listed / j) ** (1.0 / 3.0), sqrt(fastest / j))
        lay(0.0, longest, pointed_spacing, lambda t: 2.0 * j * t**3)
        held = 0.5 * (sqrt(t_j**2 + 4.0 * listed / a) - t_j)
        held = min(held, fastest / a)
        if held > t_j:
            lay(t_j, held, spacing, lambda T: a * T * (T + t_j))
        if isfinite(fastest):
            ramp = fastest / a + t_j if fastest > a * t_j else 2.0 * sqrt(fastest / j)
            if listed > fastest * ramp:
                lay(ramp, listed / fastest, spacing, lambda T: fastest * T)
    sizes = np.unique(np.concatenate(found))
    return np.asarray(sizes[(sizes > 0.0) & (sizes <= listed)])


BESIDE = 2e-8
"""Distance from a free time at which a step passes a sample, on either side [s]."""


def _passing(times: Array, start: float, stop: float, cycle: float) -> Array:
    """Free times just before and after a step of the setpoint passes a sample.

    ``times``: of the steps at ``start`` and at ``stop``, between which they move in proportion.
    """
    found = []
    for begin, end in times.T:
        rate = (end - begin) / (stop - start)
        if rate > 1e-9:
            n = np.arange(ceil(begin / cycle), floor(end / cycle) + 1)
            found.append(start + (n * cycle - begin) / rate)
    at = np.concatenate(found) if found else np.zeros(0)
    both = np.concatenate([at - BESIDE, at + BESIDE])
    return np.asarray(both[(both > start) & (both < stop)])


def plan_sizes(move: Move, sizes: Array, limits: MotionLimits) -> JerkSteps:
    """Return the setpoints of a move in some sizes, behind the setpoint filter of the limits."""
    a, j = np.full_like(sizes, limits.acceleration), np.full_like(sizes, limits.jerk)
    steps = jerk_steps(move, acceleration=a, jerk=j, size=sizes)
    return filter_steps(steps, limits.setpoint_filter)
