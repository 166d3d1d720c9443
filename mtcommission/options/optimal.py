"""Options of ``optimal`` -> what is asked for, and its solution."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import inf, isfinite

from mtcommission.errors import Fault
from mtcommission.machine.machine import Machine, Move, Positioning, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import Bound, DampingOptimum, TimeOptimum
from mtcommission.optimal.transcription.settings import Scheme, TranscriptionSettings
from mtcommission.options.texts import raise_all, read_positive, require_move, require_one_of
from mtcommission.plant.plant import Plant, driven_at_once
from mtcommission.units.quantities import (
    ACCELERATION,
    ANGLE,
    ANGULAR_ACCELERATION,
    ANGULAR_VELOCITY,
    FORCE,
    LENGTH,
    MODAL_DEFLECTION,
    MODAL_RATE,
    ROTARY_MODAL_DEFLECTION,
    ROTARY_MODAL_RATE,
    TIME,
    TORQUE,
    VELOCITY,
)

BY_UNIT = {
    "m": LENGTH,
    "m/s": VELOCITY,
    "m/s^2": ACCELERATION,
    "rad": ANGLE,
    "rad/s": ANGULAR_VELOCITY,
    "rad/s^2": ANGULAR_ACCELERATION,
    "N": FORCE,
    "N m": TORQUE,
    "N s^2": MODAL_DEFLECTION,
    "N s": MODAL_RATE,
    "N m s^2": ROTARY_MODAL_DEFLECTION,
    "N m s": ROTARY_MODAL_RATE,
}

MOST_INTERVALS = 20_000
"""Grid of a transcription that still fits into some GB."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimalRequest:
    """What ``optimal`` is asked for.

    Parameters
    ----------
    kind
        ``"time"`` or ``"damping"``.
    method
        ``"exact"`` or ``"transcription"``.
    move
        The profile's, or from the options.
    t_f
        Final time of the damping-optimal control [s]; None: the default of the profile.
    bounds
        From ``--limit``.
    transcription
        Grid of the direct transcription.
    jerk
        Largest jerk of a motor that follows [m/s³]; inf: not limited.
    """

    kind: str
    method: str
    move: Move
    t_f: float | None
    bounds: tuple[Bound, ...]
    transcription: TranscriptionSettings
    jerk: float = inf


def read_optimal_request(
    machine: Machine,
    plant: Plant,
    *,
    kind: str,
    method: str,
    t_f: str,
    limits: Sequence[str],
    velocity_step: str,
    distance: str,
    move: int,
    scheme: str,
    intervals: int,
    jerk: str = "",
) -> OptimalRequest:
    """Return what ``optimal`` is asked for.

    Parameters
    ----------
    machine, plant
        Nominal.
    kind, method, t_f, limits, velocity_step, distance, move, scheme, intervals, jerk
        Texts of the options; "" where one is not given.

    Raises
    ------
    InputError
        With every fault found.
    """
    faults: list[Fault] = []
    require_one_of("--kind", kind, ("time", "damping"), faults)
    require_one_of("--method", method, ("exact", "transcription"), faults)
    bounds = [read_bound(plant, text, faults) for text in limits]
    for name, count in Counter(text.partition("=")[0].strip() for text in limits).items():
        if count > 1:
            message = Message("option-given-twice", name=name, count=count)
            faults.append(Fault(where="--limit", message=message))
    final = read_positive("--t-f", t_f, TIME, faults) if t_f else None
    most = read_positive("--jerk", jerk, machine.axis_units.jerk, faults) if jerk else inf
    if jerk and not (kind == "time" and method == "exact" and machine.drive.follows):
        faults.append(Fault(where="--jerk", message=Message("option-jerk-of-what-follows")))
    if isfinite(most) and machine.drive.follows:
        faults += _all_but_jumps(machine, plant, most, bounds)
    if kind == "time" and t_f:
        faults.append(Fault(where="--t-f", message=Message("option-final-time-is-found")))
    schemes = {item.value: item for item in Scheme}
    require_one_of("--scheme", scheme, tuple(schemes), faults)
    if not 2 <= intervals <= MOST_INTERVALS:
        message = Message("option-between", got=intervals, least=2, most=MOST_INTERVALS)
        faults.append(Fault(where="--intervals", message=message))
    if kind == "damping" and limits and method == "exact":
        faults.append(Fault(where="--limit", message=Message("option-bounds-need-transcription")))
    chosen = _move(
        machine, velocity_step=velocity_step, distance=distance, number=move, faults=faults
    )
    raise_all(faults)
    return OptimalRequest(
        kind=kind,
        method=method,
        move=chosen,
        t_f=final,
        bounds=tuple(bounds),
        transcription=TranscriptionSettings(scheme=schemes[scheme], intervals=intervals),
        jerk=most,
    )


def _all_but_jumps(
    machine: Machine, plant: Plant, jerk: float, bounds: Sequence[Bound]
) -> list[Fault]:
    """Return the fault of a jerk with which the acceleration reaches its limit all but at once."""
    from mtcommission.optimal.at_once import least_limit
    from mtcommission.optimal.bounded.jerk_limited import SHORTEST_RAMP

    ramp = least_limit(plant, machine.drive.motion_force, bounds) / jerk
    if ramp * plant.fastest_rate >= SHORTEST_RAMP:
        return []
    message = Message("option-jerk-all-but-jumps", jerk=jerk, unit=plant.jerk_unit, ramp=ramp)
    return [Fault(where="--jerk", message=message)]


def solve(machine: Machine, plant: Plant, request: OptimalRequest) -> TimeOptimum | DampingOptimum:
    """Return the optimal control that was asked for.

    Parameters
    ----------
    machine, plant
        Nominal.
    request
        From ``read_optimal_request``.

    Raises
    ------
    ComputationError
        With a named outcome.
    """
    from mtcommission.limits.optima import (
        DAMPING_TIME_FACTOR,
        find_damping_optimum,
        find_time_optimum,
    )
    from mtcommission.machine.rigid_body import require_force
    from mtcommission.optimal.at_once import (
        damping_optimum_on,
        least_limit,
        on_states,
        time_optimum_on,
    )

    require_force(machine)
    force, move = machine.drive.motion_force, request.move
    limit = least_limit(plant, force, request.bounds)
    exact = request.method == "exact"
    if isfinite(request.jerk):
        from mtcommission.optimal.bounded.jerk_limited import solve_jerk_limited

        bounds = on_states(plant, request.bounds)
        return solve_jerk_limited(
            plant, move, force_limit=limit, jerk_limit=request.jerk, bounds=bounds
        )
    if request.kind == "time":
        if exact:
            return find_time_optimum(plant, move, force_limit=force, bounds=request.bounds)
        bounds = on_states(plant, request.bounds)
        if isinstance(move, Positioning) and isfinite(move.max_velocity):
            bounds += (Bound(name=plant.states[plant.velocity], value=move.max_velocity),)
        from mtcommission.optimal.transcription.transcription import transcribe_time_optimal

        gridded = transcribe_time_optimal(
            driven_at_once(plant),
            move,
            force_limit=limit,
            bounds=bounds,
            settings=request.transcription,
        )
        return time_optimum_on(plant, gridded)
    least = find_time_optimum(plant, move, force_limit=force, bounds=()).t_f
    t_f = request.t_f or machine.damping_optimal.t_f or DAMPING_TIME_FACTOR * least
    solution = find_damping_optimum(machine, plant, move, t_f=t_f, least=least)
    if exact:
        return solution
    from mtcommission.optimal.transcription.transcription import transcribe_damping_optimal

    on_grid = transcribe_damping_optimal(
        driven_at_once(plant),
        move,
        force_limit=limit,
        t_f=t_f,
        weights=solution.weights,
        bounds=on_states(plant, request.bounds),
        settings=request.transcription,
    )
    return damping_optimum_on(plant, on_grid)


def final_time_origin(machine: Machine, request: OptimalRequest) -> Message | None:
    """Return what chose the final time of a damping-optimal control; None for a time-optimal one.

    Parameters
    ----------
    machine
        Nominal.
    request
        From ``read_optimal_request``.
    """
    if request.kind == "time":
        return None
    if request.t_f:
        return Message("terminal-final-time-of-option")
    if machine.damping_optimal.t_f:
        return Message("terminal-final-time-of-profile")
    from mtcommission.limits.optima import DAMPING_TIME_FACTOR

    return Message("terminal-final-time-by-default", factor=DAMPING_TIME_FACTOR)


def read_bound(plant: Plant, text: str, faults: list[Fault]) -> Bound:
    """Return what ``--limit NAME=VALUE`` asks for, or any bound after noting a fault.

    Parameters
    ----------
    plant
        Its signals may be bounded.
    text
        Name and value.
    faults
        Gets what is wrong with it.
    """
    name, separator, value = text.partition("=")
    name = name.strip()
    if not separator:
        message = Message("option-no-bound", got=repr(text))
        faults.append(Fault(where="--limit", message=message))
    elif name not in plant.signals:
        close = get_close_matches(name, plant.signals, n=1)
        hint = Message("option-did-you-mean", name=close[0]) if close else None
        message = Message("option-no-signal", got=repr(name), hint=hint, names=plant.signals)
        faults.append(Fault(where="--limit", message=message))
    else:
        dimension = BY_UNIT[plant.signal_units[plant.signals.index(name)]]
        found = read_positive(f"--limit {name}", value, dimension, faults)
        return Bound(name=name, value=found)
    return Bound(name=name, value=1.0)


def _move(
    machine: Machine, *, velocity_step: str, distance: str, number: int, faults: list[Fault]
) -> Move:
    axis = machine.axis_units
    if velocity_step and distance:
        faults.append(Fault(where="--distance", message=Message("option-step-or-distance")))
    if velocity_step:
        return VelocityStep(
            velocity_step=read_positive("--velocity-step", velocity_step, axis.velocity, faults)
        )
    if distance:
        return Positioning(distance=read_positive("--distance", distance, axis.length, faults))
    require_move(machine, number, faults)
    return machine.moves[number - 1 if number <= len(machine.moves) else 0]
