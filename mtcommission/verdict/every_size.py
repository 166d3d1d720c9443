"""Limits on every smaller move of each listed one: the worst of all sizes, with a bound for all.

Limits are typed in once and then serve every move of every program. Sizes of a move follow each
other by one free time T, so their responses are smooth in it: between two sizes a spacing h apart
no deviation exceeds the larger of theirs by more than K h²/8, where K bounds the second derivative
by T. K follows from the answer of the loop to one step of the jerk, in every corner; h is laid so
that what is left is nothing to speak of, and stands in the result.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache, partial
from math import ceil, inf, isfinite, log2, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.quantisation import SIGMAS, encoder_noise
from mtcommission.loop.batch.echoes import Echoes, behind_filter, less_delayed, listen
from mtcommission.loop.batch.extremes import find_extremes
from mtcommission.loop.batch.settling import settle
from mtcommission.loop.batch.tables import (
    ResponseTables,
    build_tables,
    search_horizon,
    sketch_tables,
)
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, Move, Positioning
from mtcommission.machine.requirement import (
    CONTOUR_DEVIATION,
    RESIDUAL_DEVIATION,
    RMS_FORCE,
    SET_FORCE,
    Requirement,
    peak_of,
    slow_to_feed,
)
from mtcommission.machine.variations import Corner
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.smaller_moves import lay_sizes, plan_sizes, size_of

Array = NDArray[np.float64]

ECHO_SPACING = 0.25e-3
"""Of the samples of the answers to a jerk step, from which the curvature follows [s]."""

UNPROVED = 0.005
"""Share of the band by which a size between two that were looked at may exceed both [-]."""

FINEST_SPACING = 0.125e-3
"""Least spacing of sizes [s]: below it the phase within a velocity cycle decides."""

SAMPLES = 48
"""Samples per period of free motion: the peak of a swing is missed by 0.2 % at most."""

FORCED_SIZES = 24
"""Sizes of each move at which force, peaks, contour and RMS force are simulated, logarithmic."""

LEAST_FORCED = 0.01
"""The least of them, as a share of the listed one [-]."""

KEPT_BYTES = 150_000_000
"""Tables of loops that are kept for the next limits, all together [bytes]."""

LONGEST_TAIL = 0.2
"""Period of a mode that still counts for how long they are looked at after the setpoint [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeCheck:
    """The worst of all sizes for one requirement.

    Parameters
    ----------
    requirement
        What is required.
    value
        Worst over all sizes, moves and corners [own unit].
    bound
        What no size exceeds, sizes between those looked at included; nan where only sizes were
        looked at.
    move
        Number of the move, from 1.
    size
        Velocity step or distance of the worst [m/s or m].
    corner
        Of the worst.
    """

    requirement: Requirement
    value: float
    bound: float
    move: int
    size: float
    corner: Corner


def judge_every_size(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    only_if_kept: bool = False,
) -> tuple[SizeCheck, ...]:
    """Return the worst of all smaller moves, the listed ones included, for each requirement.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant, its loop in every corner.
    limits
        Acceleration, jerk and the setpoint filter.
    only_if_kept
        Whether the rest is looked at only if no size may leave the band; else the residual
        deviation alone is returned.

    Returns
    -------
    tuple of SizeCheck
        Residual deviation, contour deviation and RMS force where they are bounded, peaks, set
        force; encoder noise included. Whoever wants a settling time asks the listed moves.
    """
    resolution = machine.drive.encoder_resolution
    noises = [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]
    noise = max(item.tool for item in noises)
    checks: list[SizeCheck] = []
    for number, move in enumerate(machine.moves, start=1):
        residual = _worst_residual(machine, tuned, limits, move, number)
        checks.append(replace(residual, value=residual.value + noise, bound=residual.bound + noise))
    band = machine.requirements.tcp_deviation
    if not only_if_kept or all(check.bound <= band for check in checks):
        for number, move in enumerate(machine.moves, start=1):
            checks += _worst_extremes(machine, plant, tuned, limits, move, number)
    order = list(dict.fromkeys(item.requirement for item in checks))
    return tuple(
        max((item for item in checks if item.requirement == name), key=lambda item: item.value)
        for name in order
    )


def _worst_residual(
    machine: Machine, tuned: TunedLoop, limits: MotionLimits, move: Move, number: int
) -> SizeCheck:
    band = machine.requirements.tcp_deviation
    curve = bound_curvature(tuned, limits, move)
    left = 8.0 * UNPROVED * band
    pointed, held = (
        max(sqrt(left / K), FINEST_SPACING) if K else inf for K in (curve.pointed, curve.held)
    )
    decayed = max(search_horizon(loop.lifted) for loop in tuned.loops)
    sizes = lay_sizes(
        move, limits, pointed_spacing=pointed, spacing=min(held, decayed), decayed=decayed
    )
    steps = plan_sizes(move, sizes, limits)
    worst = SizeCheck(
        requirement=RESIDUAL_DEVIATION,
        value=0.0,
        bound=0.0,
        move=number,
        size=size_of(move),
        corner=tuned.corners[0],
    )
    for loop, corner in zip(tuned.loops, tuned.corners, strict=True):
        tables = _tables(loop, _rounded_up(float(steps.duration.max())), steps.order)
        residual = settle(tables, steps, band=band).residual_deviation
        place = int(np.argmax(residual))
        if residual[place] > worst.value:
            worst = replace(
                worst, value=float(residual[place]), size=float(sizes[place]), corner=corner
            )
    between = max(
        K * spacing**2 / 8.0 for K, spacing in ((curve.pointed, pointed), (curve.held, held)) if K
    )
    return replace(worst, bound=worst.value + between)


def _tables(loop: SampledLoop, longest: float, order: int) -> ResponseTables:
    """The tables of one loop, once for all limits that are judged on it."""
    key = (loop, longest, order)
    found = _kept.pop(key, None)
    if found is None:
        tables = build_tables(loop, longest=longest, order=order)
        found = sketch_tables(tables, loop.plant, samples=SAMPLES)
    _kept[key] = found  # those asked for last come last, and go last
    while len(_kept) > 1 and sum(item.nbytes for item in _kept.values()) > KEPT_BYTES:
        del _kept[next(iter(_kept))]
    return found


_kept: dict[tuple[SampledLoop, float, int], ResponseTables] = {}


def _rounded_up(duration: float) -> float:
    """The next power of sqrt(2) [s]: tables for somewhat longer moves serve shorter ones, too."""
    return float(2.0 ** (ceil(2.0 * log2(duration)) / 2.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Curvature:
    """Largest second derivatives of the deviation by the time that sets two sizes apart.

    Parameters
    ----------
    pointed
        By the length of a ramp that does not reach the acceleration [m/s²].
    held
        By the time for which acceleration or velocity are held [m/s²].
    """

    pointed: float
    held: float


def bound_curvature(tuned: TunedLoop, limits: MotionLimits, move: Move) -> Curvature:
    """Return bounds on how a residual bends between two sizes of a move, in every corner.

    Parameters
    ----------
    tuned
        The loop in every corner.
    limits
        Acceleration, jerk and the setpoint filter.
    move
        Velocity step or positioning.

    Returns
    -------
    Curvature

    Notes
    -----
    With the echo y of a jerk step, B = (1 - D^t_j) y, and D^t a delay by t, the residuals are

    - (1 - D^t)² y, bent by -2 y''(s - t) + 4 y''(s - 2t), and (1 - D^T) B, bent by -B''(s - T), of
      a velocity step that does not, and does, reach its acceleration;
    - (1 - 2 D^t + 2 D^3t - D^4t) y, bent by at most 2 + 18 + 16 times y'', of positioning that does
      not; (1 - D^(T + t_j)) (1 - D^T) B of one that does, bent by 1 + 1 + 4 times B''; and a change
      to max_velocity less the same later, bent by one or two of its second derivatives, which are
      2 B'' at most.

    A residual is judged from τ after its last step, so y'' counts from there on, and B'' from t_j
    later.
    """
    heard = _hear(tuned)
    dt, item = heard.dt, limits.setpoint_filter
    y = behind_filter(heard.deviation, item, dt=dt)
    k = max(round(limits.jerk_time / dt), 1)
    wait = int((heard.delay + (item.duration if item else 0.0)) / dt)
    weights = (36.0, 6.0) if isinstance(move, Positioning) else (6.0, 1.0)
    bent = [
        float(np.abs(np.diff(rows, 2, axis=1)[:, begin:]).max(initial=0.0)) / dt**2
        for rows, begin in ((y, wait), (less_delayed(y, k), wait + k))
    ]
    return Curvature(
        pointed=limits.jerk * weights[0] * bent[0], held=limits.jerk * weights[1] * bent[1]
    )


@lru_cache(maxsize=2)
def _hear(tuned: TunedLoop) -> Echoes:
    """The echoes of the deviation, once for all moves and limits on a loop."""
    nothing: Array = np.zeros([0, len(tuned.loops[0].outputs)])
    return listen(tuned.loops, signals=nothing, spacing=ECHO_SPACING)


def _worst_extremes(
    machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits, move: Move, number: int
) -> list[SizeCheck]:
    """Force, peaks, contour and RMS force in some sizes, from a hundredth to the listed one."""
    needs, drive, n = machine.requirements, machine.drive, plant.order
    sizes = size_of(move) * np.geomspace(LEAST_FORCED, 1.0, FORCED_SIZES)
    steps = plan_sizes(move, sizes, limits)
    slower = slow_to_feed(move, needs.contour_feed)
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])  # tcp, encoder, force, then the states
    signals = np.array([np.eye(n + 3)[2], *(outputs @ plant.row(p.name) for p in needs.peaks)])
    names = [SET_FORCE, *(peak_of(peak.name) for peak in needs.peaks)]
    is_limited, follows = isfinite(drive.continuous_force), isfinite(needs.contour_deviation)
    names += [CONTOUR_DEVIATION] * follows + [RMS_FORCE] * is_limited
    worst: dict[Requirement, SizeCheck] = {}
    for loop, corner in zip(tuned.loops, tuned.corners, strict=True):
        noise = encoder_noise(loop, resolution=drive.encoder_resolution)
        run = partial(
            find_extremes,
            loop,
            signals=signals,
            tail=loop.controller.reference_delay + 1.5 * min(longest_period(plant), LONGEST_TAIL),
            static_load=drive.static_load,
        )
        found = run(steps, dwell=move.dwell if is_limited else None, with_deviation=follows)
        columns = [found.peaks[:, 0] + noise.force, *found.peaks[:, 1:].T]
        if follows:
            path = found
            if slower != move:
                shares = sizes / sizes[-1] * size_of(slower)
                path = run(plan_sizes(slower, shares, limits), dwell=None, with_deviation=True)
            columns.append(path.deviation + noise.tool)
        if is_limited:
            columns.append(np.hypot(found.rms_force, noise.force / SIGMAS))
        for name, values in zip(names, columns, strict=True):
            place = int(np.argmax(values))
            check = SizeCheck(
                requirement=name,
                value=float(values[place]),
                bound=nan,
                move=number,
                size=float(sizes[place]),
                corner=corner,
            )
            if name not in worst or check.value > worst[name].value:
                worst[name] = check
    return list(worst.values())
