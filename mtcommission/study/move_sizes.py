"""From which size on limits hold: whether a rule, or listed sizes alone, suffice for small moves.

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

from mtcommission.loop.free_motion import free_motion, lay_grid
from mtcommission.loop.motions import set_in_motion
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits
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
    """Limits, perhaps with a setpoint filter, as the control takes them."""

    name: Message  # who gives them
    limits: MotionLimits

    @property
    def filter_time(self) -> float:
        """By how much the setpoint filter lengthens each setpoint [s]; 0 = none."""
        item = self.limits.setpoint_filter
        return item.duration if item else 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveSizes:
    """One way of moving, on one move in many sizes."""

    way: SetpointWay
    move: Move  # the profile's
    size: Array  # velocity step or distance, rising, shape (n,) [m/s or m]
    settling_time: Array  # worst over the corners, shape (n,) [s]
    residual_deviation: Array  # likewise [m]
    full_from: float  # size from which a is reached at all; inf: ``max_velocity`` forbids it
    kept_from: float  # ends of the unbroken range about the profile's own size in which the band
    kept_to: float  # is kept [m/s or m]; both nan if not at that size


def vary_move_sizes(
    machine: Machine, tuned: TunedLoop, ways: Sequence[SetpointWay]
) -> tuple[MoveSizes, ...]:
    """Return what each way does with each move, smaller and larger than the profile's."""
    shares = np.geomspace(SMALLEST, LARGEST, SIZES)
    shares[int(np.argmin(np.abs(shares - 1.0)))] = 1.0
    poles, band = find_poles(tuned.loops), machine.requirements.tcp_deviation
    return tuple(
        _judge_sizes(way, move, shares, poles, band=band) for way in ways for move in machine.moves
    )


def compare_move_sizes(
    machine: Machine,
    tuned: TunedLoop,
    recommended: MotionLimits,
    listed: MotionLimits | None,
    by_rule: MotionLimits,
) -> tuple[MoveSizes, ...]:
    """Return what recommendation, limits for the listed sizes alone, and rule do in every size."""
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
    way: SetpointWay, move: Move, shares: Array, poles: LoopPoles, *, band: float
) -> MoveSizes:
    size = size_of(move) * shares
    steps = plan_sizes(move, size, way.limits)
    free = free_motion(set_in_motion(poles, steps), lay_grid(poles, SAMPLES))
    residual = free.residual.max(axis=1)
    own = int(np.flatnonzero(shares == 1.0)[0])
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
