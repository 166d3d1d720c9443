"""The setpoint some time ago, from its samples at the position cycle."""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.model.controller import Controller

Array = NDArray[np.float64]


def kept_samples(controller: Controller) -> int:
    """Return how many samples of the setpoint before the current one the control keeps."""
    oldest = controller.reference_delay
    if controller.position_loop is not PositionLoop.CONTROL:
        piece = controller.reference_age + controller.position_cycle
        in_drive = controller.position_loop is PositionLoop.DRIVE
        oldest = piece if in_drive else max(oldest, piece)
    return ceil(oldest / controller.position_cycle - 1e-9)


def delay_weights(delay: float, *, cycle: float, delays: int) -> Array:
    """Return the weights of setpoint samples that give the setpoint a delay [s] ago.

    Position by quintic Hermite interpolation (exact while the jerk is constant; a jerk step
    of Δj inside the cycle costs at most some Δj T³/400), the velocity by its derivative,
    acceleration and jerk linearly. Rows x, v, a, j; columns (x, v, a, j) of the current sample,
    then of those kept before it (``delays`` of them, at least delay/cycle), shape
    (4, 4 (delays + 1)).
    """
    back = ceil(delay / cycle - 1e-9)
    s = min(max(back - delay / cycle, 0.0), 1.0)
    weights = np.zeros((4, delays + 1, 4))
    if s == 0.0:
        weights[:, back, :] = np.eye(4)
        return weights.reshape(4, -1)
    powers = np.array([1.0, s, s**2, s**3, s**4, s**5])
    slopes = np.array([0.0, 1.0, 2 * s, 3 * s**2, 4 * s**3, 5 * s**4]) / cycle
    scale = np.array([1.0, cycle, cycle**2])
    for row, basis in ((0, powers), (1, slopes)):
        ends = basis @ _HERMITE
        weights[row, back, :3] = ends[:3] * scale
        weights[row, back - 1, :3] = ends[3:] * scale
    for row in (2, 3):
        weights[row, back, row] = 1.0 - s
        weights[row, back - 1, row] = s
    return weights.reshape(4, -1)


def motion_between(start: Array, end: Array, *, cycle: float) -> Array:
    """Return the motion over a position cycle that has position and velocity at both ends.

    ``start``, ``end``: x, v, a, j at the ends, shape (4, n); of these x and v count. Result:
    position and its derivatives at the start, of a cubic, shape (4, n); exact while the jerk is
    constant.
    """
    x, v = end[0] - start[0] - cycle * start[1], end[1] - start[1]
    acceleration = 6.0 * x / cycle**2 - 2.0 * v / cycle
    jerk = 6.0 * v / cycle**2 - 12.0 * x / cycle**3
    return np.array([start[0], start[1], acceleration, jerk])


# Coefficients of 1, s, ..., s^5 (rows) over x0, v0, a0, x1, v1, a1 (columns) on s in [0, 1].
_HERMITE = np.linalg.inv(
    np.array(
        [
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
            [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            [0.0, 0.0, 2.0, 6.0, 12.0, 20.0],
        ]
    )
)
