"""What the engineer types into the control: limits of acceleration and jerk."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter

NO_JERK_LIMIT = 1e-6
"""Jerk time that stands for "no jerk limit" ahead of a setpoint filter [s]: far below every
sampling cycle."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionLimits:
    """What the engineer types into the control."""

    acceleration: float  # a [m/s²]
    jerk: float  # j [m/s³]
    setpoint_filter: SetpointFilter | None = None  # None: the one that the control has already

    @property
    def jerk_time(self) -> float:
        """Time t_j = a/j of one acceleration ramp [s]."""
        return self.acceleration / self.jerk


def without_jerk_limit(machine: Machine, acceleration: float) -> MotionLimits:
    """Return an acceleration [m/s²] without a jerk limit as a control sends it.

    A control sees its setpoint once in a position cycle, so the acceleration is there after one
    cycle; a faster ramp would hand the feed-forward a jerk that no control ever computes.
    """
    return MotionLimits(
        acceleration=acceleration, jerk=acceleration / machine.control.position_cycle
    )
