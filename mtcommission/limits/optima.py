"""The physical optima of a move: at rest, with a band, and the limits closest to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import ceil, floor, isfinite, log10

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Corner, Machine, moving_mass, vary
from mtcommission.machine.moves import Move, Positioning, VelocityStep, least_motion_time
from mtcommission.machine.plant.plant import Plant, build_plant, driven_at_once, longest_period
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.band import BandForce, find_band_optimum, find_robust_force
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.control import (
    TIGHT_GAP,
    DampingOptimum,
    TimeOptimum,
    Trajectory,
    excess_velocity,
    sample_trajectory,
)
from mtcommission.optimal.damping import balanced_weights, solve_damping_optimal
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.optimal.open_loop import least_limit, on_states, optimum_on
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.smaller_moves import size_of

Array = NDArray[np.float64]

DAMPING_TIME_FACTOR = 1.2
"""Default t_f of the damping-optimal control over t_f,min where no peaks are bounded
(the project's definition)."""

MANY_PERIODS, WORTHWHILE = 60.0, 0.01
"""Periods of the slowest mode from which on a program with a band takes minutes: there only if the
optimum at rest exceeds the rigid axis's by that share (empirical)."""

CHECKED = 81
"""Frequencies over the spread on which a robust force keeps the band (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Optima:
    """The physical optima of one move on the nominal machine."""

    move: Move
    time: TimeOptimum  # exact rest; under max_velocity where the move has one
    constrained: TimeOptimum | None  # the same under the profile's peaks; None: there are none
    damping: DampingOptimum | None  # None where its final time is too short (see ``remarks``)
    remarks: tuple[Message, ...]  # what was left out, and why


def find_optima(machine: Machine, plant: Plant, move: Move) -> Optima:
    """Return the physical optima of one move on the nominal machine."""
    force = machine.drive.motion_force
    time = find_time_optimum(plant, move, force_limit=force, bounds=())
    constrained = None
    remarks: list[Message] = []
    if time.certificate.relative_gap > TIGHT_GAP:
        proof = time.certificate
        remarks.append(
            Message("reference-not-exact", least=proof.t_f_lower_bound, below=proof.relative_gap)
        )
    bounds = machine.requirements.peaks
    if bounds:
        try:
            constrained = find_time_optimum(plant, move, force_limit=force, bounds=bounds)
        except ComputationError as error:
            remarks.append(Message("optimum-under-bounds-failed", error=error.message))
    if constrained and constrained.certificate.relative_gap > TIGHT_GAP:
        gap = constrained.certificate.relative_gap
        remarks.append(Message("optimum-not-exact", slower=gap))
    wanted = machine.damping_optimal
    t_f = wanted.t_f or (constrained.t_f if constrained else DAMPING_TIME_FACTOR * time.t_f)
    damping = None
    try:
        damping = find_damping_optimum(machine, plant, move, t_f=t_f, least=time.t_f)
    except ComputationError as error:
        remarks.append(Message("damping-optimum-failed", error=error.message))
    excess = excess_velocity(plant, damping) if damping else 0.0
    if excess:
        remarks.append(Message("damping-optimum-exceeds-velocity", times=1.0 + excess))
    return Optima(
        move=move,
        time=time,
        constrained=constrained,
        damping=damping,
        remarks=tuple(remarks),
    )


def find_time_optimum(
    plant: Plant, move: Move, *, force_limit: float, bounds: tuple[SignalValue, ...]
) -> TimeOptimum:
    """Return the time-optimal control, bounded or free, whichever the move and bounds ask for.

    ``plant``: nominal; ``force_limit``: force left for motion [N or N m]; ``bounds``: on states and
    outputs, besides the move's own max_velocity.

    Raises
    ------
    ComputationError
        The solve ended with a named outcome.
    """
    limit, kept = least_limit(plant, force_limit, bounds), on_states(plant, bounds)
    moved = driven_at_once(plant)
    if kept or (isinstance(move, Positioning) and isfinite(move.max_velocity)):
        found = solve_bounded_time_optimal(moved, move, force_limit=limit, bounds=kept)
    else:
        found = solve_time_optimal(moved, move, force_limit=limit)
    others = tuple(bound for bound in bounds if bound not in kept)
    return optimum_on(plant, replace(found, bounds=(*found.bounds, *others)))


def find_damping_optimum(
    machine: Machine, plant: Plant, move: Move, *, t_f: float, least: float
) -> DampingOptimum:
    """Return the damping-optimal control with the profile's weights, or balanced ones.

    Machine and plant are nominal; ``t_f``: final time [s]; ``least``: t_f,min of the same move [s].

    Raises
    ------
    ComputationError
        FINAL_TIME_TOO_SHORT if t_f < least, with t_f,min in the message.
    """
    if t_f < least:
        detail = Message("final-time-below-least", final=t_f, least=_rounded_up(least))
        raise ComputationError(Outcome.FINAL_TIME_TOO_SHORT, detail)
    force, moved = machine.drive.motion_force, driven_at_once(plant)
    weights = machine.damping_optimal.weights
    if not weights:
        reference = solve_time_optimal(moved, move, force_limit=force)
        weights = balanced_weights(moved, reference)
    found = solve_damping_optimal(moved, move, force_limit=force, t_f=t_f, weights=weights)
    return optimum_on(plant, found)


def condense_optima(
    machine: Machine, plant: Plant, optima: Sequence[Optima]
) -> tuple[tuple[Message, MotionLimits], ...]:
    """Return the jerk-limited profile closest to each optimum, with its name.

    Machine and plant are nominal; no ramp is shorter than the position cycle. ``optima``: one for
    each move.
    """
    cycle = machine.control.position_cycle
    found = []
    for number, item in enumerate(optima, start=1):
        solutions = {
            "closest-to-time-optimal": item.time,
            "closest-to-constrained": item.constrained,
            "closest-to-damping-optimal": item.damping,
        }
        for kind, solution in solutions.items():
            if solution is None:
                continue
            motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / 500)
            limits = condense(item.move, motion, velocity=plant.velocity, shortest_ramp=cycle)
            name = Message(kind)
            if len(optima) > 1:
                name = Message("with-move-number", name=name, number=number)
            found.append((name, limits))
    return tuple(found)


def condense(
    move: Move, trajectory: Trajectory, *, velocity: int, shortest_ramp: float = 0.0
) -> MotionLimits:
    """Return the jerk-limited profile of the same duration that is closest to an optimum.

    Closest means the least integral of the squared difference of the rigid velocities: the
    profile then covers the same ground at the same times. Profiles of duration t_f form a
    family in the jerk time t_j alone, since t_f = v/a + t_j for a change of velocity v (twice
    that for a move from rest to rest, plus the cruise at max_velocity).

    ``velocity``: column of the rigid velocity; ``shortest_ramp``: least jerk time [s]. Many optima
    are closest to a profile without any jerk limit; a control cannot send a ramp shorter than its
    position cycle. What comes out is a bound and starting point, no recommendation: the optimum's
    vibration is not in it.
    """
    t, v = trajectory.t, trajectory.states[:, velocity]
    t_f = float(t[-1])
    if isinstance(move, VelocityStep):
        peak, rise = move.velocity_step, t_f
    else:
        peak = min(move.max_velocity, 2.0 * move.distance / t_f)
        rise = t_f - move.distance / peak

    def profile(ramp: float) -> tuple[MotionLimits, float]:
        acceleration = peak / (rise - ramp)
        ends = np.cumsum([ramp, rise - 2.0 * ramp, ramp])
        up = _ramp(t, ends, acceleration, ramp)
        down = (
            0.0
            if isinstance(move, VelocityStep)
            else _ramp(t - (t_f - rise), ends, acceleration, ramp)
        )
        error = float(np.trapezoid((up - down - v) ** 2, t))
        return MotionLimits(acceleration=acceleration, jerk=acceleration / ramp), error

    best = minimize_scalar(
        lambda ramp: profile(ramp)[1],
        bounds=(min(max(1e-3 * rise, shortest_ramp), 0.499 * rise), 0.5 * rise),
        method="bounded",
        options={"xatol": 1e-4 * rise},
    )
    return profile(float(best.x))[0]


def _ramp(t: Array, ends: Array, acceleration: float, ramp: float) -> Array:
    """Velocity of one S-shaped change that begins at t = 0, for any t."""
    jerk = acceleration / ramp
    knots = np.concatenate([[0.0], ends])
    age = np.maximum(t[:, None] - knots, 0.0)
    return np.asarray((age**2 / 2.0) @ (jerk * np.array([1.0, -1.0, -1.0, 1.0])))


@dataclass(frozen=True, slots=True, kw_only=True)
class WithinBand:
    """The fastest controls of one move to a state from which the tool keeps the band by itself.

    The honest lower limit of a recommendation that is judged by a band.
    """

    optimum: BandForce | None = None  # on the nominal machine; None where it was not found
    robust: BandForce | None = None  # on all of the spread, without payload; None: no spread
    remarks: tuple[Message, ...] = ()  # what was left out, and why


def find_within_band(machine: Machine, optima: Optima) -> WithinBand:
    """Return the fastest controls of one move that leave the tool within the permitted deviation.

    ``tcp_deviation`` as stated is the band, without reserve.
    """
    plant, needs, move = build_plant(machine), machine.requirements, optima.move
    size, force, band = size_of(move), machine.drive.motion_force, needs.tcp_deviation
    if isinstance(move, Positioning) and size <= band:
        return WithinBand(remarks=(Message("band-wider-than-move", distance=size, band=band),))
    rigid = least_motion_time(move, force / moving_mass(machine))
    left = 1.0 - rigid / optima.time.t_f
    is_long = optima.time.t_f > MANY_PERIODS * longest_period(plant)
    if is_long and left < WORTHWHILE:
        return WithinBand(remarks=(Message("band-saves-nothing", rigid=rigid, share=left),))
    optimum, robust, failed = None, None, "band-optimum-failed"
    try:
        optimum = find_band_optimum(
            driven_at_once(plant),
            move,
            force_limit=force,
            band=band,
            at_rest=optima.time.t_f,
        )
        failed = "robust-force-failed"
        if needs.frequency_spread or needs.damping_spread:
            places = _over_spread(machine)
            robust = find_robust_force(
                [driven_at_once(build_plant(vary(machine, place))) for place in places],
                move,
                force_limit=force,
                band=band,
                guess=optimum.t_f,
            )
    except ComputationError as error:
        remark = Message(failed, error=error.message)
        return WithinBand(optimum=optimum, remarks=(remark,))
    return WithinBand(optimum=optimum, robust=robust)


def _over_spread(machine: Machine) -> list[Corner]:
    """Machines over the frequency spread, at both ends and the middle of damping, each once."""
    needs = machine.requirements
    frequency = np.linspace(-1.0, 1.0, CHECKED) * needs.frequency_spread
    damping = np.array([-1.0, 0.0, 1.0]) * needs.damping_spread
    pairs = product(dict.fromkeys(damping.tolist()), dict.fromkeys(frequency.tolist()))
    return [Corner(frequency_factor=1.0 + f, damping_factor=1.0 + d) for d, f in pairs]


def _rounded_up(value: float) -> float:
    """Return a time with nine digits that is not refused once more when it is typed in."""
    digit = 10.0 ** (floor(log10(value)) - 8)
    return ceil(value / digit) * digit
