"""Limits on every smaller move of each listed one: the worst of all sizes, with a bound for all.

Limits are typed in once and then serve every move of every program. Sizes of a move follow each
other by one free time T (docs/every-size.md). Between two sizes h apart every step of the jerk
falls at its own phase of a position cycle, so the deviation is smooth in T but for kinks where a
step passes a sample; it exceeds the larger of its neighbours by no more than

    K h²/8 + κ h/4 + J

K: largest second derivative by T at any phase; κ: change of the slope by one more or one less
sample that sees the acceleration, summed over the steps that may pass one within h; J: the same of
the value, where the control feeds the jerk forward. All three are residuals of other inputs to the
same loop. Where J is not nothing, sizes on either side of each such place are looked at
instead. h is laid so that what is left is little; the sum stands in the result, and counts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, factorial, inf, isfinite, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.quantisation import SIGMAS, encoder_noise
from mtcommission.loop.respond import (
    LoopPoles,
    extremes,
    find_poles,
    free_motion,
    lay_grid,
    outputs_at,
    set_in_motion,
    where_signals_lead,
)
from mtcommission.loop.simulate import rms_force, window_shares
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, Move, Positioning, moving_mass
from mtcommission.machine.requirement import (
    CONTOUR_DEVIATION,
    RESIDUAL_DEVIATION,
    RMS_FORCE,
    SET_FORCE,
    Requirement,
    peak_of,
    slow_to_feed,
)
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.machine.variations import Corner
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import JerkSteps, filter_steps
from mtcommission.setpoint.smaller_moves import lay_sizes, plan_sizes, size_of

Array = NDArray[np.float64]

COARSE, UNPROVED = 0.25, 0.005
"""Share of the band by which a size between two that were looked at may exceed both [-]: at first,
and where that first look is near the band."""

LEFT = 1.3
"""Bands that, left at a first look, need no second one [-]."""

MOST_SIZES = 3000
"""Sizes of a move in each of its families; where more would be needed the bound is wider."""

SAMPLES = 48
"""Samples per period of free motion: the peak of a swing is missed by 0.2 % at most."""

PHASES = 8
"""Of a step within a position cycle, at which its second derivative is looked at."""

FORCED_SIZES = 24
"""Sizes of each move at which force, peaks, contour and RMS force are looked at, logarithmic."""

LEAST_FORCED = 0.01
"""The least of them, as a share of the listed one [-]."""

TOGETHER = 400
"""Sizes that are judged at once: keeps their free motion in the cache."""

LONGEST_SEEN = 2.0
"""Time after which what is held or cruised has been held for ever, where modes decay slowly [s]."""

RMS_CYCLES = 4000
"""Position cycles of a move that are summed for its RMS force, at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeCheck:
    """The worst of all sizes for one requirement."""

    requirement: Requirement
    value: float  # worst over all sizes, moves and corners [own unit]
    bound: float  # what no size exceeds; nan where only sizes were looked at
    move: int  # number of the move, from 1
    size: float  # velocity step or distance of the worst [m/s or m]
    corner: Corner  # of the worst


def judge_every_size(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    only_if_kept: bool = False,
) -> tuple[SizeCheck, ...]:
    """Return the worst of all smaller moves, the listed ones included, for each requirement.

    Residual deviation, contour deviation and RMS force where they are bounded, peaks, set force;
    encoder noise included. ``only_if_kept``: the rest is looked at only if no size may leave the
    band. Whoever wants a settling time asks the listed moves.
    """
    resolution, poles = machine.drive.encoder_resolution, find_poles(tuned.loops)
    noises = [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]
    noise = max(item.tool for item in noises)
    checks: list[SizeCheck] = []
    for number, move in enumerate(machine.moves, start=1):
        found = _worst_residual(machine, poles, tuned.corners, limits, move, number)
        checks.append(replace(found, value=found.value + noise, bound=found.bound + noise))
    band = machine.requirements.tcp_deviation
    if not only_if_kept or all(check.bound <= band for check in checks):
        for number, move in enumerate(machine.moves, start=1):
            checks += _worst_extremes(machine, plant, tuned, poles, limits, move, number)
    order = list(dict.fromkeys(item.requirement for item in checks))
    return tuple(
        max((item for item in checks if item.requirement == name), key=lambda item: item.value)
        for name in order
    )


def _worst_residual(
    machine: Machine,
    poles: LoopPoles,
    corners: tuple[Corner, ...],
    limits: MotionLimits,
    move: Move,
    number: int,
) -> SizeCheck:
    seen = LONGEST_SEEN
    rates = -poles.rates.real[np.abs(poles.factors) > 0.0]
    if len(rates):
        seen = min(float(np.log(1e3) / max(rates.min(), 1e-9)), LONGEST_SEEN)
    pointed, held = bound_between(poles, limits, move)
    both = pointed.jump > 0.0 and seen / poles.dt < MOST_SIZES
    if both:  # on either side of every place where a step passes a sample: then only K is left
        pointed, held = (replace(item, kink=0.0, jump=0.0) for item in (pointed, held))
    allowed = machine.requirements.tcp_deviation
    # Where much more than the band is left, it need not be known more closely than in proportion.
    for share in (COARSE, UNPROVED):
        least = (limits.jerk_time / MOST_SIZES, seen / MOST_SIZES)
        spacings = [
            item.spacing(share * allowed, least=h)
            for item, h in zip((pointed, held), least, strict=True)
        ]
        sizes = lay_sizes(
            move,
            limits,
            pointed_spacing=spacings[0],
            spacing=min(spacings[1], seen),
            decayed=seen,
            cycle=poles.dt if both else 0.0,
        )
        worst = _worst_of_sizes(poles, move, limits, sizes)
        if worst[0] > LEFT * allowed:
            break
        allowed = max(allowed, worst[0])
    value, place, corner = worst
    between = max(item.excess(h) for item, h in zip((pointed, held), spacings, strict=True))
    return SizeCheck(
        requirement=RESIDUAL_DEVIATION,
        value=value,
        bound=value + between,
        move=number,
        size=float(sizes[place]),
        corner=corners[corner],
    )


def _worst_of_sizes(
    poles: LoopPoles, move: Move, limits: MotionLimits, sizes: Array
) -> tuple[float, int, int]:
    """Largest residual [m], and its place among the sizes and corners."""
    steps = plan_sizes(move, sizes, limits)
    grid, worst = lay_grid(poles, SAMPLES), (-1.0, 0, 0)
    for start in range(0, len(sizes), TOGETHER):
        part = slice(start, start + TOGETHER)
        own = replace(steps, times=steps.times[part], steps=steps.steps[part])
        residual = free_motion(set_in_motion(poles, own), grid).residual
        row, column = divmod(int(residual.argmax()), residual.shape[1])
        worst = max(worst, (float(residual[row, column]), start + row, column))
    return worst


@dataclass(frozen=True, slots=True, kw_only=True)
class Between:
    """By what a residual between two sizes may exceed both."""

    bent: float  # K, second derivative by the free time [m/s²]
    kink: float  # κ of one step that passes a sample, by its weight and rate [m/s]
    jump: float  # J of all steps [m]
    cycle: float  # position cycle [s]
    passing: tuple[tuple[float, float], ...]  # weight and rate of each step that moves

    def excess(self, h: float) -> float:
        """Return the bound for sizes whose free times are ``h`` apart [m]."""
        crossings = sum(
            weight * rate * ceil(rate * h / self.cycle - 1e-9) for weight, rate in self.passing
        )
        return self.bent * h**2 / 8.0 + self.kink * crossings * h / 4.0 + self.jump

    def spacing(self, allowed: float, *, least: float) -> float:
        """Return the largest spacing whose excess, jumps apart, is allowed; at least some [s]."""
        slope = 0.25 * self.kink * sum(weight * rate for weight, rate in self.passing)
        if not self.bent and not slope:
            return inf
        h = 2.0 * allowed / (slope + sqrt(slope**2 + 0.5 * self.bent * allowed))
        return max(h, least)


POINTED_STEP, HELD_STEP = ((2.0, 1.0), (1.0, 2.0)), ((2.0, 1.0),)
POINTED_MOVE, HELD_MOVE = ((2.0, 1.0), (2.0, 3.0), (1.0, 4.0)), ((4.0, 1.0), (2.0, 2.0))
"""Weights of the steps of the jerk, and how fast they move with the free time: (1 - D^t)² y, (1 -
D^T) B, (1 - 2 D^t + 2 D^3t - D^4t) y, (1 - D^(T + t_j)) (1 - D^T) B; B = (1 - D^t_j) y has two."""


def bound_between(poles: LoopPoles, limits: MotionLimits, move: Move) -> tuple[Between, Between]:
    """Return what bounds sizes that do not reach the acceleration, and all others.

    Notes
    -----
    With the answer y to a jerk step and the families above, a residual is bent by at most
    Σ w r² |y''| over the steps that move. y'' is the answer to a step of the velocity, B'' the same
    less it t_j later, both behind the setpoint filter and from τ after the last step on. A step of
    the jerk that is seen by one sample more adds the answer to a pulse of the acceleration at one
    sample to the slope, and to a pulse of the jerk to the value; behind an average the slope
    changes by the latter, and the value not at all.
    """
    item, jerk = limits.setpoint_filter, limits.jerk
    averages = item.averages if item else ()
    accelerated, jerked = _pulses(poles)
    kink, jump = (jerk * accelerated, jerk * jerked)
    if averages:
        kink, jump = (2.0 * jerk / averages[0] * jerked, 0.0) if len(averages) == 1 else (0.0, 0.0)
    is_move = isinstance(move, Positioning)
    families = (POINTED_MOVE, HELD_MOVE) if is_move else (POINTED_STEP, HELD_STEP)
    found = []
    for passing, second in zip(families, (0.0, limits.jerk_time), strict=True):
        weight = sum(w * r**2 for w, r in passing) / (2.0 if second else 1.0)
        found.append(
            Between(
                bent=jerk * weight * _largest_bend(poles, item, second),
                kink=kink,
                jump=jump * sum(w for w, _ in passing),
                cycle=poles.dt,
                passing=passing,
            )
        )
    return found[0], found[1]


def _largest_bend(poles: LoopPoles, item: SetpointFilter | None, second: float) -> float:
    """Largest |y''|, or |B''| where a second step follows, at any phase and corner [m per m/s]."""
    phases = (np.arange(PHASES) / PHASES * poles.dt)[:, None]
    times = np.hstack([phases, phases + second]) if second else phases
    signs = np.array([1.0, -1.0] if second else [1.0])
    steps = JerkSteps(times=times, steps=np.tile(signs, (PHASES, 1)), order=1)
    motions = set_in_motion(poles, filter_steps(steps, item))
    return float(free_motion(motions, lay_grid(poles, SAMPLES)).residual.max())


def _pulses(poles: LoopPoles) -> tuple[float, float]:
    """Largest tool positions from τ on after 1 m/s² and 1 m/s³ at one sample [m]."""
    late = max(int(poles.delay / poles.dt) - 1, 0)
    largest = np.zeros(2)
    for loop in poles.loops:
        lifted, X = loop.lifted, loop.lifted.B[:, 2:]
        tool = lifted.C.reshape(poles.cycles, poles.outputs, -1)[:, 0]
        for m in range(2 * poles.forced):
            if m >= late:
                largest = np.maximum(largest, np.abs(tool @ X).max(axis=0))
            X = lifted.A @ X
    return float(largest[0]), float(largest[1])


def _worst_extremes(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    poles: LoopPoles,
    limits: MotionLimits,
    move: Move,
    number: int,
) -> list[SizeCheck]:
    """Force, peaks, contour and RMS force in some sizes, from a hundredth to the listed one."""
    needs, drive, n = machine.requirements, machine.drive, plant.order
    sizes = size_of(move) * np.geomspace(LEAST_FORCED, 1.0, FORCED_SIZES)
    steps, grid = plan_sizes(move, sizes, limits), lay_grid(poles, 12)
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])  # tcp, encoder, force, then the states
    signals = np.array([np.eye(n + 3)[2], *(outputs @ plant.row(p.name) for p in needs.peaks)])
    noises = [encoder_noise(loop, resolution=drive.encoder_resolution) for loop in tuned.loops]
    own, parts = where_signals_lead(poles, signals)
    found = extremes(
        set_in_motion(own, steps), lay_grid(own, 12), signals, parts=parts, with_deviation=False
    ).peaks.max(axis=1)
    names, checks = [SET_FORCE, *(peak_of(peak.name) for peak in needs.peaks)], []

    def check(name: Requirement, values: Array, place: int) -> SizeCheck:
        corner = int(values.argmax())
        return SizeCheck(
            requirement=name,
            value=float(values[corner]),
            bound=nan,
            move=number,
            size=float(sizes[place]),
            corner=tuned.corners[corner],
        )

    every = np.arange(poles.cycles)
    for k, name in enumerate(names):
        place = int(found[:, k].argmax())
        alone = set_in_motion(poles, _only(steps, place))
        peaks = extremes(alone, grid, signals[k : k + 1], parts=every, with_deviation=False).peaks
        extra = np.array([item.force for item in noises]) if name == SET_FORCE else 0.0
        checks.append(check(name, peaks[0, :, 0] + extra, place))
    if isfinite(needs.contour_deviation):
        slower = slow_to_feed(move, needs.contour_feed)
        path = plan_sizes(slower, sizes / sizes[-1] * size_of(slower), limits)
        deviation = extremes(
            set_in_motion(poles, path), grid, signals[:0], parts=every, with_deviation=True
        ).deviation + np.array([item.tool for item in noises])
        place = int(deviation.max(axis=1).argmax())
        checks.append(check(CONTOUR_DEVIATION, deviation[place], place))
    if isfinite(drive.continuous_force):
        place = int(rigid_rms(machine, move, steps).argmax())
        force = rms_forces(poles, _only(steps, place), move.dwell, static_load=drive.static_load)
        noise = np.array([item.force for item in noises]) / SIGMAS
        checks.append(check(RMS_FORCE, np.hypot(force, noise), place))
    return checks


def _only(steps: JerkSteps, place: int) -> JerkSteps:
    return replace(
        steps, times=steps.times[place : place + 1], steps=steps.steps[place : place + 1]
    )


def rms_forces(
    poles: LoopPoles, steps: JerkSteps, dwell: float, *, static_load: float, most: int = RMS_CYCLES
) -> Array:
    """Return the RMS motor force of one setpoint over [0, t_e + dwell] in every corner [N]."""
    window = float(steps.duration[0]) + dwell
    cycles = max(ceil(window / poles.dt), 1)
    n = np.unique(np.linspace(0, cycles, min(cycles, most) + 1).astype(np.int64))
    motor = np.eye(1, poles.outputs, poles.outputs - 1)  # the last of the plant's states
    force = outputs_at(set_in_motion(poles, steps), n[None], motor)[0, ..., 0]
    T_v = poles.velocity_cycle
    t = n[:, None] * poles.dt + T_v * np.arange(poles.cycles)
    share = window_shares(t, window, step=T_v) * np.gradient(n.astype(float))[:, None]
    return rms_force(
        (share * force).sum(axis=(1, 2)) * window / share.sum(),
        (share * force**2).sum(axis=(1, 2)) * window / share.sum(),
        window=window,
        static_load=static_load,
    )


def rigid_rms(machine: Machine, move: Move, steps: JerkSteps) -> Array:
    """Return the RMS force of the rigid axis, heaviest payload, shape (n_setpoints,) [N].

    The acceleration is a sum of steps w_i of its m-th integral, m = q - 1, that ends in rest, so by
    Parseval ∫ a² dt = (-1)^m / (2 (2m - 1)!) Σ_ij w_i w_j |t_i - t_j|^(2m - 1). Its mean is that of
    a velocity step, against which a static load counts.
    """
    m, t = steps.order - 1, steps.times
    gaps = np.abs(t[:, :, None] - t[:, None, :]) ** (2 * m - 1)
    both = np.einsum("si,sij,sj->s", steps.steps, gaps, steps.steps)
    square = np.maximum((-1) ** m / (2.0 * factorial(2 * m - 1)) * both, 0.0)
    age = steps.duration[:, None] - t
    velocity = np.sum(steps.steps * age**m, axis=1) / factorial(m)
    mass = moving_mass(machine) + max(machine.requirements.payload)
    return rms_force(
        mass * velocity,
        mass**2 * square,
        window=steps.duration + move.dwell,
        static_load=machine.drive.static_load,
    )
