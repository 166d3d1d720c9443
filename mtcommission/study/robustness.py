"""The same limits elsewhere: on machines that differ a little, in other sizes, with friction.

The ranges of frequency and damping tell how far the machine may change until it must be measured
and commissioned again.

Sizes tell whether a rule, or listed sizes alone, suffice for small moves. A velocity step below
a²/j ends before a is reached. Its ramps are then shorter than a/j, so a ramp that was made to
cancel a vibration no longer does; a larger move keeps the ramps but not the time between them. A
setpoint filter cancels the vibration whatever the move: its zeros stand in the filter.

Friction, where it is stated, may break what the linear search and its verdict promise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress
from math import inf, isfinite, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message, join_by_and
from mtcommission.limits.bench import build_bench
from mtcommission.limits.judge import MoveResult
from mtcommission.limits.requirements import read_requirement, requirements_of
from mtcommission.loop.model.assembly import build_loop
from mtcommission.loop.poles import find_poles
from mtcommission.loop.respond import extremes, free_motion, lay_grid, set_in_motion
from mtcommission.loop.simulate import simulate_rubbing
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Corner, Machine, corners, vary
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_within
from mtcommission.setpoint.smaller_moves import plan_sizes, size_of
from mtcommission.study.settings import STUDY

Array = NDArray[np.float64]

ROUNDING = 1e-9
"""Of a frequency error [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedResponse:
    """What limits do on many machines."""

    settling_time: Array  # slowest move, shape (n_samples,) [s]; inf: not within the horizon
    residual_deviation: Array  # worst move, the nominal encoder noise included, (n_samples,) [m]
    values: Array  # of each requirement, likewise, shape (n_samples, n_requirements) [own units]
    is_missed: NDArray[np.bool_]  # likewise


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptRange:
    """Between which common factors every requirement is kept in every corner.

    The ends of the unbroken range about 1 [-]; both None if not even at 1. Beyond the first and
    last factor nothing was looked at.
    """

    factor: tuple[float, ...]  # of frequencies or damping ratios, over those of the profile, rising
    settling_time: tuple[float | None, ...]  # worst over moves and corners [s]; None: not settled
    residual_deviation: tuple[float | None, ...]  # likewise [m]
    kept_from: float | None
    kept_to: float | None
    lost_below: tuple[str, ...]  # names of what is missed at the next factor below, and above
    lost_above: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Robustness:
    """How limits fare where the machine differs a little, and on what the verdict hangs."""

    frequency_error: KeptRange
    damping_error: KeptRange
    warnings: tuple[Message, ...]


def examine_robustness(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> Robustness:
    """Return how limits fare where the machine differs a little."""
    error = find_frequency_error(machine, tuned, limits)
    return Robustness(
        frequency_error=error,
        damping_error=find_damping_range(machine, tuned, limits),
        warnings=warn_of_narrow_range(machine, error),
    )


def find_frequency_error(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> KeptRange:
    """Return what the same limits do where all eigenfrequencies are off by a common factor."""
    needs, count = machine.requirements, STUDY.frequency_points
    reach = max(STUDY.frequency_range, min(2.0 * needs.frequency_spread, 0.5))
    factor = 1.0 + reach * np.linspace(-1.0, 1.0, 2 * count + 1)
    known = replace(machine, requirements=replace(needs, frequency_spread=0.0))
    return _find_range(known, tuned, limits, factor, of="frequency_factor")


def find_damping_range(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> KeptRange:
    """Return the same where all damping ratios are."""
    known = replace(machine, requirements=replace(machine.requirements, damping_spread=0.0))
    factor = np.linspace(STUDY.least_damping, STUDY.most_damping, STUDY.damping_points)
    return _find_range(known, tuned, limits, factor, of="damping_factor")


def _find_range(
    known: Machine, tuned: TunedLoop, limits: MotionLimits, factor: Array, *, of: str
) -> KeptRange:
    """Every corner of a machine, the spread of one quantity apart, at every factor on that."""
    places, requirements = corners(known), requirements_of(known)
    each = [replace(place, **{of: one}) for one in factor.tolist() for place in places]
    found = respond_varied(known, tuned, limits, each)

    def by_factor(values: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(values.reshape(len(factor), len(places), -1).max(axis=1))

    missed = by_factor(found.is_missed)
    low, high = _stretch_about(np.logical_not(missed.any(axis=1)), len(factor) // 2)

    def curve(values: Array) -> tuple[float | None, ...]:
        return tuple(one if isfinite(one) else None for one in by_factor(values)[:, 0].tolist())

    def lost(at: int) -> tuple[str, ...]:
        is_inside = low <= high and 0 <= at < len(factor)
        return tuple(item.key for item in compress(requirements, missed[at])) if is_inside else ()

    return KeptRange(
        factor=tuple(factor.tolist()),
        settling_time=curve(found.settling_time),
        residual_deviation=curve(found.residual_deviation),
        kept_from=float(factor[low]) if low <= high else None,
        kept_to=float(factor[high]) if low <= high else None,
        lost_below=lost(low - 1),
        lost_above=lost(high + 1),
    )


def _stretch_about(kept: NDArray[np.bool_], own: int) -> tuple[int, int]:
    """First and last index of the unbroken stretch about a place; first > last: none."""
    broken = np.flatnonzero(~kept)
    low = int(np.max(broken[broken <= own], initial=-1)) + 1
    return low, int(np.min(broken[broken >= own], initial=len(kept))) - 1


def warn_of_narrow_range(machine: Machine, error: KeptRange) -> tuple[Message, ...]:
    """Return a warning where the requirements hang on frequencies nobody knows so exactly.

    Limits that cancel a vibration are as exact as its frequency. Where no spread is stated they may
    be kept at the stated frequency alone, and the verdict would not show it. Empty where a spread
    is stated, where 2 % of error to either side are borne, or where the verdict says so.
    """
    if error.kept_from is None or error.kept_to is None:
        return ()
    low, high = error.kept_from - 1.0, error.kept_to - 1.0
    is_narrow = max(low, -high) > -STUDY.known_frequency + ROUNDING
    if machine.requirements.frequency_spread > 0.0 or not is_narrow:
        return ()
    ends = [
        Message("frequency-end-at-least" if end == tried - 1.0 else "frequency-end", error=end)
        for end, tried in zip((low, high), (error.factor[0], error.factor[-1]), strict=True)
    ]
    lost = [
        Message(f"missed-where-{side}", requirement=read_requirement(key).message)
        for side, keys in (("lower", error.lost_below), ("higher", error.lost_above))
        for key in keys
    ]
    least = STUDY.known_frequency
    named = {"low": ends[0], "high": ends[1], "lost": join_by_and(lost)}
    return (Message("frequency-spread-not-stated", **named, least=least),)


def respond_varied(
    machine: Machine, tuned: TunedLoop, limits: MotionLimits, places: Sequence[Corner]
) -> VariedResponse:
    """Return what limits do to the listed moves on varied machines under the same controller."""
    requirements, plan = requirements_of(machine), plan_within(machine, limits)
    band = machine.requirements.tcp_deviation
    bench = build_bench(machine, tuned)
    settling, residual = np.zeros((2, len(places)))
    values = np.zeros((len(places), len(requirements)))
    for start in range(0, len(places), STUDY.together):
        part = slice(start, start + STUDY.together)
        plants = [build_plant(vary(machine, place)) for place in places[part]]
        loops = tuple(build_loop(each, tuned.controller, model=tuned.plant) for each in plants)
        poles = find_poles.__wrapped__(loops)
        grid = lay_grid(poles, STUDY.samples)
        for place, move in enumerate(machine.moves):
            own = plan(move).steps
            motions = set_in_motion(poles, own)
            free = free_motion(motions, grid)
            time = free.settling(band)[0]
            settling[part] = np.maximum(settling[part], time)
            residual[part] = np.maximum(residual[part], free.residual[0])
            found = dict.fromkeys(bench.asked.settling, time)
            for requirement, signal in bench.asked.after:
                found[requirement] = free_motion(motions, grid, signal=signal).residual[0]
            for swings in bench.asked.during:
                _, parts = swings.where_to_look(bench.poles)
                judged = set_in_motion(poles, plan(swings.moves[place]).steps)
                peaks = extremes(judged, grid, swings.rows, parts=parts, less=swings.less)[0]
                found.update(zip(swings.requirements, peaks.T, strict=True))
            for requirement, mean in bench.asked.means:
                found[requirement] = mean.exact(machine, poles, move, own, STUDY.mean_cycles)
            noisy = [one.with_noise(found[one], bench.noise) for one in requirements]
            values[part] = np.maximum(values[part], np.column_stack(noisy))
    return VariedResponse(
        settling_time=settling,
        residual_deviation=residual + bench.noise.tool,
        values=values,
        is_missed=values > [item.bound(machine) for item in requirements],
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveSizes:
    """Some limits on one move in many sizes."""

    name: Message  # who gives them
    limits: MotionLimits  # with the setpoint filter in use
    move: Move  # the profile's
    size: Array  # velocity step or distance, rising, shape (n,) [m/s or m]
    residual_deviation: Array  # worst over the corners, shape (n,) [m]
    full_from: float  # size from which a is reached at all; inf: ``max_velocity`` forbids it
    kept_from: float  # ends of the unbroken range about the profile's own size in which the band
    kept_to: float  # is kept [m/s or m]; both nan if not at that size


def compare_move_sizes(
    machine: Machine, tuned: TunedLoop, named: dict[str, MotionLimits | None]
) -> tuple[MoveSizes, ...]:
    """Return what limits by their names, where there are any, do with smaller and larger moves."""
    own = machine.control.setpoint_filter
    return tuple(
        _judge_sizes(
            machine,
            tuned,
            Message(kind),
            replace(limits, setpoint_filter=limits.setpoint_filter or own),
            move,
        )
        for kind, limits in named.items()
        if limits is not None
        for move in machine.moves
    )


def full_size(limits: MotionLimits, move: Move) -> float:
    """Return the size from which a move reaches the acceleration [m/s or m].

    v = a (t_j + T) for a velocity step, L = v (2 t_j + T) for a move from rest to rest, with
    t_j = a/j and the length T of the setpoint filter.
    """
    time = limits.setpoint_filter.duration if limits.setpoint_filter else 0.0
    velocity = limits.acceleration * (limits.jerk_time + time)
    if isinstance(move, VelocityStep):
        return velocity
    return velocity * (2.0 * limits.jerk_time + time) if velocity <= move.max_velocity else inf


def _judge_sizes(
    machine: Machine, tuned: TunedLoop, name: Message, limits: MotionLimits, move: Move
) -> MoveSizes:
    shares = np.geomspace(STUDY.smallest, STUDY.largest, STUDY.sizes)
    own = int(np.argmin(np.abs(shares - 1.0)))
    shares[own] = 1.0
    size, band = size_of(move) * shares, machine.requirements.tcp_deviation
    poles = find_poles(tuned.loops)
    motions = set_in_motion(poles, plan_sizes(move, size, limits))
    free = free_motion(motions, lay_grid(poles, STUDY.size_samples))
    residual = free.residual.max(axis=1)
    low, high = _stretch_about(residual <= band, own)
    return MoveSizes(
        name=name,
        limits=limits,
        move=move,
        size=size,
        residual_deviation=residual,
        full_from=full_size(limits, move),
        kept_from=float(size[low]) if low <= high else nan,
        kept_to=float(size[high]) if low <= high else nan,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionEffect:
    """One move with the recommended limits and friction, worst over the corners."""

    number: int  # of the move, from 1
    settling_time: float  # [s]; inf: not settled while it was followed
    without_friction: float  # [s]
    residual_deviation: float  # [m]
    max_force: float  # set force, friction included [N]
    is_kept: bool  # band, settling time and force


def examine_friction(
    machine: Machine, tuned: TunedLoop, moves: Sequence[MoveResult]
) -> tuple[FrictionEffect, ...]:
    """Return what friction does to each move with the recommended limits; nothing if unstated."""
    if not machine.drive.has_friction:
        return ()
    needs, drive, effects = machine.requirements, machine.drive, []
    for number, result in enumerate(moves, start=1):
        rubbed = simulate_rubbing(
            tuned.loops,
            result.setpoint,
            drive=drive,
            band=needs.tcp_deviation,
            followed=STUDY.followed,
        )
        settling = max(one.settling_time for one in rubbed)
        # As far as it was followed, also where the axis sticks outside the band.
        left = [np.abs(one.deviation[one.t >= one.t_end]).max() for one in rubbed]
        residual = float(max(left))
        force = max(one.max_force for one in rubbed)
        kept = residual <= needs.tcp_deviation and settling <= needs.max_settling_time
        effects.append(
            FrictionEffect(
                number=number,
                settling_time=settling,
                without_friction=max(one.settling_time for one in result.responses),
                residual_deviation=residual,
                max_force=force,
                is_kept=kept and force < drive.usable_force,
            )
        )
    return tuple(effects)
