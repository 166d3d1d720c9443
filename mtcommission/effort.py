"""What following a machine's moves costs, counted before anything is computed.

Every simulation of the loop steps through its velocity cycles, so the work grows with the length
of the moves over the cycle. It is counted in cycles and not in seconds: the same profile ends the
same way on every computer.
"""

from __future__ import annotations

from mtcommission.corners import corners
from mtcommission.errors import ComputationError, Outcome
from mtcommission.limits import MotionLimits
from mtcommission.machine import Machine, Motion, Move, Positioning, moving_mass
from mtcommission.rules import peak_velocity

MOST_CYCLES = 100_000
"""Velocity cycles followed at most, all moves and corners together (empirical: a minute for a
whole run; the shipped profiles take up to 16 000)."""

MOST_SLOW_CYCLES = 300_000
"""The same with the slowest limits that are judged, those of the commissioning rule."""


def least_motion_time(move: Move, acceleration: float) -> float:
    """Return how long a rigid axis needs for a move at this acceleration, without jerk limit [s].

    Parameters
    ----------
    move
        Velocity step or positioning.
    acceleration
        [m/s²], > 0.

    Returns
    -------
    float
        v/a, and for positioning L/v on top, with the largest velocity v that is reached.

    Examples
    --------
    >>> from mtcommission.machine import VelocityStep
    >>> least_motion_time(VelocityStep(velocity_step=0.1), 2.0)
    0.05
    """
    velocity = peak_velocity(move, acceleration)
    cruise = move.distance / velocity if isinstance(move, Positioning) else 0.0
    return velocity / acceleration + cruise


def count_cycles(machine: Machine) -> float:
    """Return the velocity cycles that the quickest conceivable moves take, in all corners.

    Parameters
    ----------
    machine
        Nominal, with some force left for motion.

    Returns
    -------
    float
    """
    a = machine.drive.motion_force / moving_mass(machine)
    time = sum(least_motion_time(move, a) for move in machine.moves)
    return time / machine.control.velocity_cycle * len(corners(machine))


def require_affordable(machine: Machine) -> None:
    """Raise MOVE_TOO_LONG if the moves take more velocity cycles than are followed.

    Parameters
    ----------
    machine
        Nominal, with some force left for motion.
    """
    cycles = count_cycles(machine)
    if cycles <= MOST_CYCLES:
        return
    a = machine.drive.motion_force / moving_mass(machine)
    times = [least_motion_time(move, a) for move in machine.moves]
    slowest = max(range(len(times)), key=lambda i: times[i])
    force, mass = ("N", "kg") if machine.motion is Motion.LINEAR else ("N m", "kg m^2")
    count = f"{cycles:.0f}" if cycles < 1e9 else f"{cycles:.3g}"
    raise ComputationError(
        Outcome.MOVE_TOO_LONG,
        f"move {slowest + 1} takes at least {times[slowest]:.3g} s with "
        f"{machine.drive.motion_force:.4g} {force} on {moving_mass(machine):.4g} {mass}; in "
        f"{len(corners(machine))} corner(s) all moves together are {count} velocity cycles of "
        f"{1e6 * machine.control.velocity_cycle:.4g} us, followed are {MOST_CYCLES} at most",
    )


def require_affordable_limits(machine: Machine, limits: MotionLimits) -> None:
    """Raise MOVE_TOO_LONG if the moves take more velocity cycles with these limits than followed.

    A band far below what the loop leaves asks for a jerk so low that no move ever ends.

    Parameters
    ----------
    machine
        Nominal.
    limits
        The slowest that will be judged: what the commissioning rule asks for.
    """
    times = [
        least_motion_time(move, limits.acceleration) + limits.jerk_time for move in machine.moves
    ]
    count = len(corners(machine))
    cycles = sum(times) / machine.control.velocity_cycle * count
    if cycles <= MOST_SLOW_CYCLES:
        return
    length = "m" if machine.motion is Motion.LINEAR else "rad"
    raise ComputationError(
        Outcome.MOVE_TOO_LONG,
        f"to keep a band of {machine.requirements.tcp_deviation:.3g} {length} the commissioning "
        f"rule asks for {limits.acceleration:.3g} {length}/s^2 and a ramp of "
        f"{limits.jerk_time:.3g} s, with which a move takes {max(times):.3g} s; in {count} "
        f"corner(s) all moves together are {cycles:.3g} velocity cycles, followed are "
        f"{MOST_SLOW_CYCLES} at most; check the unit of tcp_deviation",
    )
