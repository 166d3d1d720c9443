"""Optima -> starting points and bounds for the acceleration and jerk limits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.optimal.control import Trajectory
from mtcommission.setpoint.motion_limits import MotionLimits

Array = NDArray[np.float64]


def condense(
    move: Move, trajectory: Trajectory, *, velocity: int, shortest_ramp: float = 0.0
) -> MotionLimits:
    """Return the jerk-limited profile of the same duration that is closest to an optimum.

    Closest means the least integral of the squared difference of the rigid velocities: the
    profile then covers the same ground at the same times. Profiles of duration t_f form a
    family in the jerk time t_j alone, since t_f = v/a + t_j for a change of velocity v (twice
    that for a move from rest to rest, plus the cruise at max_velocity).

    ``velocity``: column of the rigid velocity; ``shortest_ramp``: least jerk time [s]. Many optima
    are closest to a profile without any jerk limit; a control cannot send a ramp shorter than its
    position cycle. What comes out is a bound and starting point, no recommendation: the optimum's
    vibration is not in it.
    """
    t, v = trajectory.t, trajectory.states[:, velocity]
    t_f = float(t[-1])
    if isinstance(move, VelocityStep):
        peak, rise = move.velocity_step, t_f
    else:
        peak = min(move.max_velocity, 2.0 * move.distance / t_f)
        rise = t_f - move.distance / peak

    def profile(ramp: float) -> tuple[MotionLimits, float]:
        acceleration = peak / (rise - ramp)
        ends = np.cumsum([ramp, rise - 2.0 * ramp, ramp])
        up = _ramp(t, ends, acceleration, ramp)
        down = (
            0.0
            if isinstance(move, VelocityStep)
            else _ramp(t - (t_f - rise), ends, acceleration, ramp)
        )
        error = float(np.trapezoid((up - down - v) ** 2, t))
        return MotionLimits(acceleration=acceleration, jerk=acceleration / ramp), error

    best = minimize_scalar(
        lambda ramp: profile(ramp)[1],
        bounds=(min(max(1e-3 * rise, shortest_ramp), 0.499 * rise), 0.5 * rise),
        method="bounded",
        options={"xatol": 1e-4 * rise},
    )
    return profile(float(best.x))[0]


def _ramp(t: Array, ends: Array, acceleration: float, ramp: float) -> Array:
    """Velocity of one S-shaped change that begins at t = 0, for any t."""
    jerk = acceleration / ramp
    knots = np.concatenate([[0.0], ends])
    age = np.maximum(t[:, None] - knots, 0.0)
    return np.asarray((age**2 / 2.0) @ (jerk * np.array([1.0, -1.0, -1.0, 1.0])))
