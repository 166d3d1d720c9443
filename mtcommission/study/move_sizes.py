"""From which step on limits hold: the same limits on smaller and larger moves.

A velocity step below a²/j ends before a is reached. Its ramps are then shorter than a/j, so a
ramp that was made to cancel a vibration no longer does; a larger move keeps the ramps but not
the time between them. A moving average of one period cancels the vibration whatever the move:
its zeros stand in the filter, not in the setpoint. What it leaves of other modes and of the servo
decides the acceleration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.batch.response import simulate_limits_batched
from mtcommission.loop.batch.settling import settle
from mtcommission.loop.batch.tables import ResponseTables, build_tables, sketch_tables
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep, moving_mass
from mtcommission.machine.variations import as_variations
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT, MotionLimits
from mtcommission.setpoint.setpoint import JerkSteps, jerk_steps, moving_average_steps
from mtcommission.verdict.evaluate import evaluate

Array = NDArray[np.float64]

SMALLEST, LARGEST = 0.01, 3.0
"""Sizes looked at, as shares of the profile's move [-] (design choice)."""

SIZES = 96
"""Between them, logarithmic: neighbours differ by 6 %, their ramps by 3 %."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointWay:
    """Limits, perhaps behind a moving average, as the control takes them.

    Parameters
    ----------
    name
        Who gives them.
    limits
        Acceleration and jerk.
    moving_average
        Length of the control's setpoint filter [s]; 0 = none.
    """

    name: Message
    limits: MotionLimits
    moving_average: float


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
        each = [_steps(way, move, shares) for move in machine.moves]
        longest = max(float(steps.duration.max()) for steps in each)
        tables = [
            build_tables(loop, longest=longest, filtered=way.moving_average > 0.0)
            for loop in tuned.loops
        ]
        for move, steps in zip(machine.moves, each, strict=True):
            band = machine.requirements.tcp_deviation
            found.append(_judge_sizes(way, move, shares, steps, tables, band=band))
    return tuple(found)


def compare_move_sizes(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    recommended: MotionLimits,
    by_rule: MotionLimits,
) -> tuple[MoveSizes, ...]:
    """Return what recommendation, rule and setpoint filter do on smaller and larger moves.

    Parameters
    ----------
    machine, plant, tuned
        The nominal machine, its plant, and its loop in every corner.
    recommended, by_rule
        Limits of the search and of the commissioning rule.

    Returns
    -------
    tuple of MoveSizes
        The filter only where it cures all smaller moves.
    """
    own = machine.control.moving_average_time
    cure = find_size_filter(machine, plant, tuned)
    ways = [
        SetpointWay(name=Message(kind), limits=limits, moving_average=own)
        for kind, limits in (("way-recommended", recommended), ("commissioning-rule", by_rule))
    ]
    return vary_move_sizes(machine, tuned, [*ways, cure] if cure else ways)


def resize(move: Move, share: float) -> Move:
    """Return the same move with its velocity step or distance times a share [-]."""
    if isinstance(move, VelocityStep):
        return replace(move, velocity_step=share * move.velocity_step)
    return replace(move, distance=share * move.distance)


def full_size(way: SetpointWay, move: Move) -> float:
    """Return the size from which a move reaches the acceleration [m/s or m].

    v = a (t_j + T) for a velocity step, L = v (2 t_j + T) for a move from rest to rest, with
    t_j = a/j and the length T of the moving average.

    Parameters
    ----------
    way
        Limits and filter.
    move
        Its kind counts, and its ``max_velocity``.

    Returns
    -------
    float

    Examples
    --------
    >>> limits = MotionLimits(acceleration=2.0, jerk=100.0)
    >>> way = SetpointWay(name=Message("x"), limits=limits, moving_average=0.0)
    >>> full_size(way, VelocityStep(velocity_step=0.1))  # a²/j [m/s]
    0.04
    """
    ramp = way.limits.jerk_time
    velocity = way.limits.acceleration * (ramp + way.moving_average)
    if isinstance(move, VelocityStep):
        return velocity
    return velocity * (2.0 * ramp + way.moving_average) if velocity <= move.max_velocity else inf


def _steps(way: SetpointWay, move: Move, shares: Array) -> JerkSteps:
    a, j = np.array([way.limits.acceleration]), np.array([way.limits.jerk])
    return _in_all_sizes(move, shares, acceleration=a, jerk=j, moving_average=way.moving_average)


def _in_all_sizes(
    move: Move, shares: Array, *, acceleration: Array, jerk: Array, moving_average: float
) -> JerkSteps:
    """Setpoints of all limits in the first size, then in the next; filtered where T > 0."""
    each = [
        jerk_steps(resize(move, float(share)), acceleration=acceleration, jerk=jerk)
        for share in shares
    ]
    steps = JerkSteps(
        times=np.vstack([item.times for item in each]),
        steps=np.vstack([item.steps for item in each]),
    )
    return moving_average_steps(steps, time=moving_average) if moving_average else steps


def _judge_sizes(
    way: SetpointWay,
    move: Move,
    shares: Array,
    steps: JerkSteps,
    tables: Sequence[ResponseTables],
    *,
    band: float,
) -> MoveSizes:
    corners = [settle(table, steps, band=band) for table in tables]
    residual = np.max([item.residual_deviation for item in corners], axis=0)
    own = int(np.flatnonzero(shares == 1.0)[0])
    full = move.velocity_step if isinstance(move, VelocityStep) else move.distance
    size = full * shares
    kept = residual <= band
    broken = np.flatnonzero(~kept)
    low = int(np.max(broken[broken < own], initial=-1)) + 1
    high = int(np.min(broken[broken > own], initial=len(size))) - 1
    return MoveSizes(
        way=way,
        move=move,
        size=size,
        settling_time=np.max([item.settling_time for item in corners], axis=0),
        residual_deviation=residual,
        full_from=full_size(way, move),
        kept_from=float(size[low]) if kept[own] else nan,
        kept_to=float(size[high]) if kept[own] else nan,
    )


ACCELERATIONS = 16
"""Tried for each period, from a tenth of F_max/m upwards, logarithmic: what takes ten times as
long is no cure (design choice)."""

LEAST_ACCELERATION = 0.1
"""The least of them, as a share of F_max/m [-]."""

FEWER_SIZES = 24
"""Of each move, from ``SMALLEST`` up to the profile's own, logarithmic."""


def find_size_filter(machine: Machine, plant: Plant, tuned: TunedLoop) -> SetpointWay | None:
    """Return the moving average and acceleration that serve all smaller moves, too.

    Of the periods of all modes and of the accelerations tried, the pair that lets the
    profile's moves settle soonest while the band is kept on every smaller move.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.

    Returns
    -------
    SetpointWay or None
        Without a jerk limit; None if no pair meets all requirements.
    """
    largest = machine.drive.motion_force / moving_mass(machine)
    accelerations = largest * np.geomspace(1.0, LEAST_ACCELERATION, ACCELERATIONS)
    shares = np.geomspace(1.0, SMALLEST, FEWER_SIZES)
    places = as_variations(tuned.corners)
    candidates = []
    for mode in plant.modes:
        period = 1.0 / mode.frequency_hz
        settling, is_kept = _settle_in_all_sizes(machine, tuned, accelerations, shares, period)
        candidates += [
            (float(settling[i]), period, float(accelerations[i])) for i in np.flatnonzero(is_kept)
        ]
    for _, period, a in sorted(candidates):
        limits = MotionLimits(acceleration=a, jerk=a / NO_JERK_LIMIT)
        filtered = replace(machine, control=replace(machine.control, moving_average_time=period))
        found = simulate_limits_batched(filtered, plant, tuned, limits, variations=places)
        # What saturates takes long to simulate: only what seems good is judged in full.
        if not np.all(found.meets(filtered)):
            continue
        if evaluate(filtered, plant, tuned, limits).assessment.is_met:
            return SetpointWay(
                name=Message("way-moving-average"), limits=limits, moving_average=period
            )
    return None


def _settle_in_all_sizes(
    machine: Machine, tuned: TunedLoop, accelerations: Array, shares: Array, period: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Settling time at the profile's own size, and whether the band is kept at every size."""
    band = machine.requirements.tcp_deviation
    settling = np.zeros(len(accelerations))
    is_kept = np.ones(len(accelerations), dtype=np.bool_)
    jerks = accelerations / NO_JERK_LIMIT
    moves = [
        _in_all_sizes(move, shares, acceleration=accelerations, jerk=jerks, moving_average=period)
        for move in machine.moves
    ]
    longest = max(float(steps.duration.max()) for steps in moves)
    for loop in tuned.loops:
        tables = build_tables(loop, longest=longest, filtered=True)
        rough = sketch_tables(tables, loop.plant)
        for steps in moves:
            found = settle(rough, steps, band=band)
            shape = (len(shares), len(accelerations))
            settling = np.maximum(settling, found.settling_time.reshape(shape)[0])
            is_kept &= np.all(found.residual_deviation.reshape(shape) <= band, axis=0)
    return settling, is_kept
