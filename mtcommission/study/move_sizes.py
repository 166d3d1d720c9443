"""From which step on limits hold: the same limits on smaller and larger moves.

A velocity step below a²/j ends before a is reached. Its ramps are then shorter than a/j, so a
ramp that was made to cancel a vibration no longer does; a larger move keeps the ramps but not
the time between them. A setpoint filter cancels the vibration whatever the move: its zeros stand in
the filter, not in the setpoint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.respond import LoopPoles, find_poles, free_motion, lay_grid, set_in_motion
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import JerkSteps
from mtcommission.setpoint.smaller_moves import plan_sizes, size_of

Array = NDArray[np.float64]

SMALLEST, LARGEST = 0.01, 3.0
"""Sizes looked at, as shares of the profile's move [-] (design choice)."""

SAMPLES = 48
"""Of free motion, to a period."""

SIZES = 96
"""Between them, logarithmic: neighbours differ by 6 %, their ramps by 3 %."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointWay:
    """Limits, perhaps with a setpoint filter, as the control takes them.

    Parameters
    ----------
    name
        Who gives them.
    limits
        Acceleration, jerk and filter.
    """

    name: Message
    limits: MotionLimits

    @property
    def filter_time(self) -> float:
        """By how much the setpoint filter lengthens each setpoint [s]; 0 = none."""
        item = self.limits.setpoint_filter
        return item.duration if item else 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveSizes:
    """One way of moving, on one move in many sizes.

    Parameters
    ----------
    way
        Limits and filter.
    move
        The profile's move.
    size
        Velocity step or distance, rising, shape (n,) [m/s or m].
    settling_time, residual_deviation
        Worst over the corners, shape (n,) [s, m].
    full_from
        Size from which the acceleration is reached at all [m/s or m]; inf if ``max_velocity``
        forbids it at any distance.
    kept_from, kept_to
        Ends of the unbroken range about the profile's own size in which the band is kept
        [m/s or m]; both nan if it is not kept at that size.
    """

    way: SetpointWay
    move: Move
    size: Array
    settling_time: Array
    residual_deviation: Array
    full_from: float
    kept_from: float
    kept_to: float


def vary_move_sizes(
    machine: Machine, tuned: TunedLoop, ways: Sequence[SetpointWay]
) -> tuple[MoveSizes, ...]:
    """Return what limits do on smaller and larger moves than the profile's.

    Parameters
    ----------
    machine
        Nominal; its moves and band count.
    tuned
        The loop in every corner.
    ways
        Limits and filters to be tried.

    Returns
    -------
    tuple of MoveSizes
        For each way, each move.
    """
    shares = np.geomspace(SMALLEST, LARGEST, SIZES)
    shares[int(np.argmin(np.abs(shares - 1.0)))] = 1.0
    found = []
    for way in ways:
        each = [plan_sizes(move, size_of(move) * shares, way.limits) for move in machine.moves]
        poles = find_poles(tuned.loops)
        for move, steps in zip(machine.moves, each, strict=True):
            band = machine.requirements.tcp_deviation
            found.append(_judge_sizes(way, move, shares, steps, poles, band=band))
    return tuple(found)


def compare_move_sizes(
    machine: Machine,
    tuned: TunedLoop,
    recommended: MotionLimits,
    listed: MotionLimits | None,
    by_rule: MotionLimits,
) -> tuple[MoveSizes, ...]:
    """Return what recommendation and rule do on smaller and larger moves.

    Parameters
    ----------
    machine, tuned
        The nominal machine, and its loop in every corner.
    recommended, listed, by_rule
        Limits of the search, those that serve the listed sizes alone (None: the same), and those
        of the commissioning rule.
    """
    own = machine.control.setpoint_filter
    named = {"way-recommended": recommended, "way-listed": listed, "commissioning-rule": by_rule}
    ways = [
        SetpointWay(
            name=Message(kind),
            limits=replace(limits, setpoint_filter=limits.setpoint_filter or own),
        )
        for kind, limits in named.items()
        if limits
    ]
    return vary_move_sizes(machine, tuned, ways)


def full_size(way: SetpointWay, move: Move) -> float:
    """Return the size from which a move reaches the acceleration [m/s or m].

    v = a (t_j + T) for a velocity step, L = v (2 t_j + T) for a move from rest to rest, with
    t_j = a/j and the length T of the setpoint filter.

    Parameters
    ----------
    way
        Limits and filter.
    move
        Its kind counts, and its ``max_velocity``.

    Examples
    --------
    >>> limits = MotionLimits(acceleration=2.0, jerk=100.0)
    >>> way = SetpointWay(name=Message("x"), limits=limits)
    >>> full_size(way, VelocityStep(velocity_step=0.1))  # a²/j [m/s]
    0.04
    """
    ramp = way.limits.jerk_time
    velocity = way.limits.acceleration * (ramp + way.filter_time)
    if isinstance(move, VelocityStep):
        return velocity
    return velocity * (2.0 * ramp + way.filter_time) if velocity <= move.max_velocity else inf


def _judge_sizes(
    way: SetpointWay,
    move: Move,
    shares: Array,
    steps: JerkSteps,
    poles: LoopPoles,
    *,
    band: float,
) -> MoveSizes:
    free = free_motion(set_in_motion(poles, steps), lay_grid(poles, SAMPLES))
    residual = free.residual.max(axis=1)
    own = int(np.flatnonzero(shares == 1.0)[0])
    size = size_of(move) * shares
    kept = residual <= band
    broken = np.flatnonzero(~kept)
    low = int(np.max(broken[broken < own], initial=-1)) + 1
    high = int(np.min(broken[broken > own], initial=len(size))) - 1
    return MoveSizes(
        way=way,
        move=move,
        size=size,
        settling_time=free.settling(band).max(axis=1),
        residual_deviation=residual,
        full_from=full_size(way, move),
        kept_from=float(size[low]) if kept[own] else nan,
        kept_to=float(size[high]) if kept[own] else nan,
    )
