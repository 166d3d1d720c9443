"""How long a move may last: its motion is looked at, stepped and written cycle by cycle."""

from __future__ import annotations

from math import inf

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import least_motion_time

MOST_CYCLES = 500_000
"""Velocity cycles of one move at most: a minute at 125 us, which no axis takes (empirical)."""


def longest_move(machine: Machine) -> float:
    """Return how long a move may last [s]."""
    return MOST_CYCLES * machine.control.velocity_cycle


def require_short(duration: float, *, velocity_cycle: float) -> None:
    """Raise MOVE_TOO_LONG if a move lasts for more velocity cycles than are followed."""
    cycles, most, cycle = duration / velocity_cycle, MOST_CYCLES, velocity_cycle
    if cycles > most:
        kind = "move-of-many-cycles"
        detail = Message(kind, time=duration, cycles=cycles, cycle=cycle, most=most)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)


def require_short_moves(machine: Machine, *, acceleration: float = inf) -> None:
    """Raise MOVE_TOO_LONG if a rigid axis needs too long for a move, before anything is computed.

    With the force left for motion, if there is any, and no more than an acceleration [m/s²].
    """
    a = min(acceleration, machine.drive.motion_force / moving_mass(machine))
    if a <= 0.0:
        return
    slowest = max(least_motion_time(move, a) for move in machine.moves)
    require_short(slowest, velocity_cycle=machine.control.velocity_cycle)
