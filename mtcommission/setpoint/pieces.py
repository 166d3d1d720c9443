"""Setpoints as polynomials between their knots, sampled at any time.

From the last knot before it and not from all steps so far: summed from its beginning, a position
behind two averages loses six digits within ten seconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

INSTANT = 1e-9
"""Times closer than this are one instant [s]: whether a sample that falls on a knot sees the
jerk before or after it must not hang on the last bit of a sum."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pieces:
    """Some setpoints, piece by piece."""

    knots: Array  # in rising order, shape (n_knots, n_setpoints) [s]
    values: Array
    """Position and its derivatives just after each knot, before the first at first: at rest; shape
    (n_knots + 1, order + 1, n_setpoints)."""

    def sample(
        self, t: Array, *, derivatives: int, setpoint: NDArray[np.int64] | None = None
    ) -> Array:
        """Return position and its first derivatives, shape (derivatives, *t.shape).

        ``t``: each setpoint's own times, shape (..., n_setpoints) [s], or those of the setpoints
        that are named; at a knot the values are those after it. Derivatives above the order are
        zero.
        """
        own = np.arange(t.shape[-1]) if setpoint is None else setpoint
        piece = np.zeros(t.shape, dtype=np.intp)
        for knot in self.knots:
            piece += t >= knot[own] - INSTANT
        age = t - self.knots[np.maximum(piece - 1, 0), own]
        values = [self.values[piece, k, own] for k in range(self.values.shape[1])]
        result = np.zeros((derivatives, *t.shape))
        for k in range(min(derivatives, len(values))):
            result[k] = taylor(values[k:], age)
        return result


def cut(times: Array, steps: Array, *, order: int) -> Pieces:
    """Return the pieces of setpoints whose highest derivative steps.

    ``times`` [s], in any order, and ``steps`` have the shape (n_setpoints, n_steps); ``order`` is
    that of the derivative that steps: 3 the jerk. After the last step the setpoints are at rest or
    coast, whatever rounding leaves.
    """
    rising = np.argsort(times, axis=1, kind="stable")
    knots = np.take_along_axis(times, rising, axis=1).T
    sizes = np.take_along_axis(steps, rising, axis=1).T
    values = np.zeros((len(knots) + 1, order + 1, knots.shape[1]))
    gaps = np.diff(knots, axis=0, prepend=knots[:1])
    for i, size in enumerate(sizes):
        later, before = values[i + 1], values[i]
        later[:] = before
        grown = np.ones_like(size)
        for k in range(1, order + 1):
            grown = grown * gaps[i] / k
            later[:-k] += before[k:] * grown
        later[order] += size
    values[-1, 2:] = 0.0
    return Pieces(knots=knots, values=values)


def taylor(derivatives: Array | list[Array], age: Array) -> Array:
    """Return a quantity ``age`` [s] later from it and its derivatives, each of that shape."""
    total = np.zeros_like(age)
    for k in range(len(derivatives) - 1, 0, -1):
        total = (total + derivatives[k]) * age / k
    return np.asarray(derivatives[0] + total)
