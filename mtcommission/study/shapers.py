"""Input shapers and the jerk filter, on a setpoint with trapezoidal velocity, for comparison.

A shaper splits the setpoint into a few scaled and delayed copies whose vibrations of one mode
cancel. The jerk filter is a moving average over one period of that mode. Both run through the
same loop, corners and judgement as the recommendation, each with the acceleration that suits it
best.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import exp, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.reserve import keep_reserve
from mtcommission.loop.batch.response import simulate_batched
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.variations import as_variations
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, PlantMode, dominant_mode
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT, MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import Plan, Setpoint, plan_setpoint
from mtcommission.verdict.evaluate import Candidate, evaluate_moves, simulate_planned

Array = NDArray[np.float64]

ACCELERATIONS = 16
"""Accelerations tried for each shaper, from a tenth of F_max/m upwards, logarithmic."""

LEAST_ACCELERATION = 0.1
"""The least of them, as a share of F_max/m [-]."""

EI_TOLERANCE = 0.05
"""Vibration that the EI shaper tolerates at its design frequency [-] (the usual 5 %)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaper:
    """A sequence of impulses, normed to 1.

    Parameters
    ----------
    name
        Usual abbreviation.
    source
        Who says so.
    times
        Delays of the copies, the first one 0 [s].
    amplitudes
        Their shares; the sum is 1.
    """

    name: str
    source: Message
    times: tuple[float, ...]
    amplitudes: tuple[float, ...]


def design_shapers(mode: PlantMode) -> tuple[Shaper, ...]:
    """Return the usual input shapers for one mode.

    Parameters
    ----------
    mode
        The mode to be kept at rest.

    Returns
    -------
    tuple of Shaper
        ZV, MZV, ZVD, EI, by rising duration.

    Source: Singer & Seering 1990 (ZV, ZVD); Singhose, Seering & Singer 1994 (EI), its
    amplitudes with the damping correction of Klipper's documentation, as MZV.

    Examples
    --------
    >>> slow = PlantMode(name="m", natural_frequency=2 * pi * 50.0, damping_ratio=0.0,
    ...     tcp_gain=1.0, measured_gain=0.0, scale=1.0, deflection=2, rate=3)
    >>> [(s.name, round(1e3 * s.times[-1], 3)) for s in design_shapers(slow)]
    [('ZV', 10.0), ('MZV', 15.0), ('ZVD', 20.0), ('EI', 20.0)]
    """
    f, zeta = mode.frequency_hz, mode.damping_ratio
    root = sqrt(1.0 - zeta**2)
    T_d = 2.0 * pi / (mode.natural_frequency * root)
    K, K_m = exp(-zeta * pi / root), exp(-0.75 * zeta * pi / root)
    V, edge = EI_TOLERANCE, 1.0 - 1.0 / sqrt(2.0)
    return (
        zero_vibration(1, frequency_hz=f, damping_ratio=zeta),
        _normed(
            "MZV",
            Message("source-klipper"),
            (0.0, 0.375 * T_d, 0.75 * T_d),
            (edge, (sqrt(2.0) - 1.0) * K_m, edge * K_m**2),
        ),
        zero_vibration(2, frequency_hz=f, damping_ratio=zeta),
        _normed(
            "EI",
            Message("source-singhose"),
            (0.0, T_d / 2, T_d),
            (0.25 * (1 + V), 0.5 * (1 - V) * K, 0.25 * (1 + V) * K**2),
        ),
    )


def zero_vibration(order: int, *, frequency_hz: float, damping_ratio: float) -> Shaper:
    """Return ZV, or ZVD, whose residual vibration has no slope over the frequency, either.

    Parameters
    ----------
    order
        1: ZV, 2: ZVD, which is ZV twice.
    frequency_hz, damping_ratio
        Natural frequency [Hz] and damping ratio [-] of the mode, below 1.

    Returns
    -------
    Shaper

    Source: Singer & Seering 1990: ZV = [1, K]/(1+K) at 0, T_d/2.

    Examples
    --------
    >>> zvd = zero_vibration(2, frequency_hz=50.0, damping_ratio=0.0)
    >>> zvd.name, zvd.times, zvd.amplitudes
    ('ZVD', (0.0, 0.01, 0.02), (0.25, 0.5, 0.25))
    """
    root = sqrt(1.0 - damping_ratio**2)
    K, half_period = exp(-damping_ratio * pi / root), 0.5 / (frequency_hz * root)
    source = Message("source-singer")
    if order == 1:
        return _normed("ZV", source, (0.0, half_period), (1.0, K))
    return _normed("ZVD", source, (0.0, half_period, 2.0 * half_period), (1.0, 2.0 * K, K**2))


def _normed(
    name: str, source: Message, times: tuple[float, ...], amplitudes: tuple[float, ...]
) -> Shaper:
    total = sum(amplitudes)
    return Shaper(
        name=name, source=source, times=times, amplitudes=tuple(a / total for a in amplitudes)
    )


def shape_setpoint(setpoint: Setpoint, shaper: Shaper) -> Setpoint:
    """Return the setpoint behind a shaper: the sum of its delayed, scaled copies.

    Parameters
    ----------
    setpoint
        Any setpoint.
    shaper
        Impulses.

    Returns
    -------
    Setpoint
        Later by the shaper's duration; ``limits`` and segments are those before it.
    """
    times = np.add.outer(np.array(shaper.times), setpoint.knot_times).ravel()
    order = np.argsort(times, kind="stable")
    shaped = [
        np.outer(shaper.amplitudes, steps).ravel()[order]
        for steps in (setpoint.jerk_steps, setpoint.snap_steps)
    ]
    for array in shaped:
        array.setflags(write=False)
    knots = times[order]
    knots.setflags(write=False)
    return replace(setpoint, knot_times=knots, jerk_steps=shaped[0], snap_steps=shaped[1])


def compare_shapers(machine: Machine, plant: Plant, tuned: TunedLoop) -> tuple[Candidate, ...]:
    """Return shapers and the jerk filter through the same loop and judgement.

    All are designed for the dominant mode of the nominal plant; each gets the acceleration, of
    ``ACCELERATIONS`` tried, that settles soonest within all requirements (if none does, within
    force and peaks; if none does, F_max/m).

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.

    Returns
    -------
    tuple of Candidate
        The jerk in ``limits`` is a/T for the filter of length T, and stands for "no limit"
        with the shapers.
    """
    mode = dominant_mode(plant)
    period = 1.0 / mode.frequency_hz
    candidates = [
        _best_candidate(
            machine,
            plant,
            tuned,
            name=Message(
                "shaper-for-mode", shaper=shaper.name, mode=mode.name, frequency=mode.frequency_hz
            ),
            source=shaper.source,
            plan_with=partial(_shaped_by, machine, shaper),
            jerk_time=machine.control.position_cycle,
        )
        for shaper in design_shapers(mode)
    ]
    candidates.append(
        _best_candidate(
            machine,
            plant,
            tuned,
            name=Message("moving-average-for-mode", mode=mode.name, frequency=mode.frequency_hz),
            source=Message("source-jerk-filter"),
            plan_with=partial(_filtered, period),
            jerk_time=period,
        )
    )
    return tuple(candidates)


def _shaped_by(machine: Machine, shaper: Shaper, acceleration: float) -> Plan:
    limits = without_jerk_limit(machine, acceleration)
    return lambda move: shape_setpoint(plan_setpoint(move, limits), shaper)


def _filtered(time: float, acceleration: float) -> Plan:
    trapezoid = MotionLimits(acceleration=acceleration, jerk=acceleration / NO_JERK_LIMIT)
    return partial(plan_setpoint, limits=trapezoid, moving_average=time)


def _best_candidate(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    *,
    name: Message,
    source: Message,
    plan_with: Callable[[float], Plan],
    jerk_time: float,
) -> Candidate:
    """The acceleration that settles soonest and meets all; else soonest within force and peaks.

    The reserve is kept, as by the recommendation. If none keeps force and peaks, F_max/m, which
    saturates.
    """
    strict = keep_reserve(machine)
    largest = strict.drive.motion_force / moving_mass(machine)
    places, band = as_variations(tuned.corners), strict.requirements.tcp_deviation
    ranked: list[tuple[bool, float, float]] = []
    soonest = inf
    for a in largest * np.geomspace(1.0, LEAST_ACCELERATION, ACCELERATIONS):
        plan = plan_with(float(a))
        if max(plan(move).duration for move in machine.moves) > soonest:
            break
        found = simulate_batched(strict, plant, tuned, plan, variations=places)
        # What saturates settles otherwise than it seems here, and takes long to simulate.
        if np.all(found.usage <= 1.0):
            is_outside = bool(np.any(found.residual_deviation > band))
            ranked.append((is_outside, float(found.settling_time.max()), float(a)))
            soonest = min([item[1] for item in ranked if not item[0]], default=inf)
    outside: list[Candidate] = []
    for is_outside, _, a in sorted(ranked) or [(True, inf, largest)]:
        if is_outside and outside:
            break
        moves = simulate_planned(machine, tuned, plan_with(a))
        shaped = evaluate_moves(machine, plant, tuned, moves, name=name, source=source)
        candidate = replace(shaped, limits=MotionLimits(acceleration=a, jerk=a / jerk_time))
        if evaluate_moves(strict, plant, tuned, moves).assessment.is_met:
            return candidate
        outside.append(candidate)
    return min(outside, key=lambda item: item.settling_time)
