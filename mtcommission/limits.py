"""Optima -> starting points and bounds for the acceleration and jerk limits."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionLimits:
    """What the engineer types into the control.

    Parameters
    ----------
    acceleration
        a [m/s²].
    jerk
        j [m/s³].
    """

    acceleration: float
    jerk: float

    @property
    def jerk_time(self) -> float:
        """Time t_j = a/j of one acceleration ramp [s]."""
        return self.acceleration / self.jerk
