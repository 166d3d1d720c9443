"""Moves of a rigid axis: the least that any control needs, without jerk limit and vibration."""

from __future__ import annotations

from math import sqrt

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, VelocityStep


def peak_velocity(move: Move, acceleration: float) -> float:
    """Return the largest velocity [m/s] of a move under an acceleration limit [m/s²], > 0, alone.

    Examples
    --------
    >>> from mtcommission.machine.moves import Positioning
    >>> peak_velocity(Positioning(distance=0.5, max_velocity=2.0), 2.0)
    1.0
    """
    if isinstance(move, VelocityStep):
        return move.velocity_step
    return min(move.max_velocity, sqrt(acceleration * move.distance))


def least_motion_time(move: Move, acceleration: float) -> float:
    """Return how long a rigid axis needs for a move at this acceleration, without jerk limit [s].

    It is v/a, and for positioning L/v on top, with the largest velocity v that is reached;
    ``acceleration``: a [m/s²], > 0.

    Examples
    --------
    >>> least_motion_time(VelocityStep(velocity_step=0.1), 2.0)
    0.05
    """
    velocity = peak_velocity(move, acceleration)
    cruise = 0.0 if isinstance(move, VelocityStep) else move.distance / velocity
    return velocity / acceleration + cruise


def require_force(machine: Machine) -> None:
    """Raise NO_FORCE_LEFT if the static load takes all of the force."""
    drive = machine.drive
    if drive.motion_force <= 0.0:
        detail = Message("static-load-of-force", load=drive.static_load, force=drive.max_force)
        raise ComputationError(Outcome.NO_FORCE_LEFT, detail)
