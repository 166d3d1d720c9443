"""What following a machine's moves costs, counted before anything is computed.

Every simulation of the loop steps through its velocity cycles, so the work grows with the length
of the moves over the cycle. It is counted in cycles and not in seconds: the same profile ends the
same way on every computer.
"""

from __future__ import annotations

from collections.abc import Sequence

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.machine.variations import corners
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits

MOST_CYCLES = 600_000
"""Velocity cycles followed at most, all moves and corners together: their time series are shown
(empirical: some hundred megabytes and a minute for a whole run)."""

SHIPPED_CYCLES = 26_000
"""What the shipped profiles take at most."""

DEAR_CYCLES = 2 * SHIPPED_CYCLES
"""From here on a run says beforehand that it will take long."""

MOST_SLOW_CYCLES = 2_000_000
"""The same with the slowest limits that are judged."""


def longest_affordable(machine: Machine) -> float:
    """Return how long every move may take if all are to be judged [s].

    Parameters
    ----------
    machine
        Nominal.

    Returns
    -------
    float
        No limits with which a move takes longer are looked for.
    """
    moves = len(machine.moves) * len(corners(machine))
    return MOST_SLOW_CYCLES * machine.control.velocity_cycle / moves


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
    return _cycles(machine, [least_motion_time(move, a) for move in machine.moves])


def remark_on_cost(machine: Machine) -> tuple[Message, ...]:
    """Return what makes a run dear, before anything is computed; empty for most machines.

    Parameters
    ----------
    machine
        Nominal.
    """
    cycles = count_cycles(machine) if machine.drive.motion_force > 0.0 else 0.0
    if not DEAR_CYCLES < cycles <= MOST_CYCLES:
        return ()  # cheap, or refused at once
    remark = Message(
        "budget-dear",
        moves=len(machine.moves),
        corners=len(corners(machine)),
        cycles=cycles,
        cycle=machine.control.velocity_cycle,
        ratio=cycles / SHIPPED_CYCLES,
    )
    return (remark,)


def _cycles(machine: Machine, times: Sequence[float]) -> float:
    """Return the velocity cycles of moves of these durations [s], in all corners."""
    return sum(times) / machine.control.velocity_cycle * len(corners(machine))


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
    raise ComputationError(
        Outcome.MOVE_TOO_LONG,
        Message(
            "budget-full-force",
            move=slowest + 1,
            time=times[slowest],
            force=machine.drive.motion_force,
            mass=moving_mass(machine),
            corners=len(corners(machine)),
            cycles=cycles,
            cycle=machine.control.velocity_cycle,
            most=MOST_CYCLES,
        ),
    )


def require_affordable_limits(machine: Machine, limits: MotionLimits) -> None:
    """Raise MOVE_TOO_LONG if the moves take more velocity cycles with these limits than followed.

    A band far below what the loop leaves asks for a jerk so low that no move ever ends.

    Parameters
    ----------
    machine
        Nominal.
    limits
        The slowest that will be judged.
    """
    require_few_cycles(
        machine,
        limits,
        most=MOST_SLOW_CYCLES,
        reason=Message("budget-rule-asks", band=machine.requirements.tcp_deviation),
        remedy=Message("budget-check-band"),
    )


def require_few_cycles(
    machine: Machine, limits: MotionLimits, *, most: int, reason: Message, remedy: Message
) -> None:
    """Raise MOVE_TOO_LONG if all moves with these limits take more velocity cycles than allowed.

    Parameters
    ----------
    machine
        Nominal.
    limits
        Acceleration and jerk.
    most
        Velocity cycles that are followed, all moves and corners together.
    reason, remedy
        Who asks for these limits, and what to check, for the message.

    Raises
    ------
    ComputationError
        With the count, before anything is computed.
    """
    times = [
        least_motion_time(move, limits.acceleration) + limits.jerk_time for move in machine.moves
    ]
    cycles = _cycles(machine, times)
    if cycles <= most:
        return
    detail = Message(
        "budget-limits",
        reason=reason,
        acceleration=limits.acceleration,
        jerk_time=limits.jerk_time,
        time=max(times),
        corners=len(corners(machine)),
        cycles=cycles,
        cycle=machine.control.velocity_cycle,
        most=most,
        remedy=remedy,
    )
    raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
