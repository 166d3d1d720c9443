"""Every smaller move of a listed one, close enough together: what limits must serve besides.

Smaller moves differ in one time only: how long the jerk acts where the acceleration is not reached,
how long the acceleration is held where the velocity is not, how long the axis cruises. Sizes whose
times lie one spacing apart follow each other as closely as their responses need it.
"""

from __future__ import annotations

from dataclasses import replace
from math import isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Move, VelocityStep
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
    move: Move, limits: MotionLimits, *, pointed_spacing: float, spacing: float, decayed: float
) -> Array:
    """Return sizes of a move from nearly nothing to its own, one spacing of time apart.

    Parameters
    ----------
    move
        The largest of its kind.
    limits
        Acceleration and jerk.
    pointed_spacing
        Between the ramps of two neighbours that do not reach the acceleration [s].
    spacing
        Between the times that set any other two neighbours apart [s].
    decayed
        Time in which the answer to a step of the jerk dies away [s]: what is held or cruised for
        longer is as good as for ever.

    Returns
    -------
    ndarray, shape (n_sizes,)
        Rising, the last one the move's own [m/s or m].

    Examples
    --------
    >>> step = VelocityStep(velocity_step=0.1)
    >>> limits = MotionLimits(acceleration=2.0, jerk=200.0)
    >>> sizes = lay_sizes(step, limits, pointed_spacing=0.01, spacing=0.01, decayed=1.0)
    >>> sizes.round(3).tolist()
    [0.02, 0.04, 0.06, 0.08, 0.1]
    """
    a, j, listed = limits.acceleration, limits.jerk, size_of(move)
    t_j = limits.jerk_time

    def times(start: float, stop: float, spacing: float = spacing) -> Array:
        stop = min(stop, start + decayed)
        return np.linspace(start, stop, max(int(np.ceil((stop - start) / spacing)), 1) + 1)

    if isinstance(move, VelocityStep):
        pointed = times(0.0, min(t_j, sqrt(listed / j)), pointed_spacing)
        sizes = [j * pointed**2]
        if listed / a > t_j:
            sizes.append(a * times(t_j, listed / a))
    else:
        fastest = move.max_velocity
        longest = min(t_j, (0.5 * listed / j) ** (1.0 / 3.0), _root(fastest / j))
        pointed = times(0.0, longest, pointed_spacing)
        sizes = [2.0 * j * pointed**3]
        held = 0.5 * (sqrt(t_j**2 + 4.0 * listed / a) - t_j)
        held = min(held, fastest / a)
        if held > t_j:
            T = times(t_j, held)
            sizes.append(a * T * (T + t_j))
        if isfinite(fastest):
            ramp = fastest / a + t_j if fastest > a * t_j else 2.0 * sqrt(fastest / j)
            if listed > fastest * ramp:
                sizes.append(fastest * times(ramp, listed / fastest))
    found = np.unique(np.concatenate([*sizes, [listed]]))
    return np.asarray(found[(found >= SMALLEST * listed) & (found <= listed)])


def _root(value: float) -> float:
    return sqrt(value) if isfinite(value) else np.inf


def plan_sizes(move: Move, sizes: Array, limits: MotionLimits) -> JerkSteps:
    """Return the setpoints of a move in some sizes, behind the setpoint filter of the limits."""
    a, j = np.full_like(sizes, limits.acceleration), np.full_like(sizes, limits.jerk)
    steps = jerk_steps(move, acceleration=a, jerk=j, size=sizes)
    return filter_steps(steps, limits.setpoint_filter)
