"""Options of the command line -> quantities and requests; every fault at once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

from mtcommission.errors import Fault, InputError
from mtcommission.limits.optima import (
    DAMPING_TIME_FACTOR,
    find_damping_optimum,
    find_time_optimum,
    require_force,
)
from mtcommission.loop.simulation_budget import require_few_cycles
from mtcommission.machine.machine import Machine, Move, Positioning, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import Bound, DampingOptimum, TimeOptimum
from mtcommission.optimal.transcription.discretisation import Scheme, TranscriptionSettings
from mtcommission.optimal.transcription.transcription import (
    transcribe_damping_optimal,
    transcribe_time_optimal,
)
from mtcommission.option_texts import read_bound, read_positive
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.units.quantities import (
    TIME,
)

MOST_INTERVALS = 20_000
"""Grid of a transcription that still fits into some GB."""

MOST_SIMULATED_CYCLES = 500_000
"""Velocity cycles of one simulation, all moves and corners together (empirical: about as long as
the run of a usual machine, and well below a GB)."""


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
    """

    kind: str
    method: str
    move: Move
    t_f: float | None
    bounds: tuple[Bound, ...]
    transcription: TranscriptionSettings


def with_force(machine: Machine, text: str) -> Machine:
    """Return the machine with another force limit.

    Parameters
    ----------
    machine
        From its profile.
    text
        Of ``--f-max``, e.g. ``2kN``.

    Returns
    -------
    Machine

    Raises
    ------
    InputError
        If the text is no positive force, or leaves nothing beside the static load.
    """
    dimension = machine.axis_units.force
    faults: list[Fault] = []
    force = read_positive("--f-max", text, dimension, faults)
    _raise(faults)
    if force <= abs(machine.drive.static_load):
        message = (
            f"got {force:g} {dimension.si}, must be above the static load "
            f"{abs(machine.drive.static_load):g} {dimension.si}"
        )
        raise InputError([Fault(where="--f-max", message=Message("verbatim", text=message))])
    return replace(machine, drive=replace(machine.drive, max_force=force))


def read_limits(machine: Machine, *, acceleration: str, jerk: str) -> MotionLimits:
    """Return limits from ``--acceleration`` and ``--jerk``.

    Raises
    ------
    InputError
        With a fault for each text that is no positive quantity.
    """
    faults: list[Fault] = []
    a = read_positive("--acceleration", acceleration, machine.axis_units.acceleration, faults)
    j = read_positive("--jerk", jerk, machine.axis_units.jerk, faults)
    _raise(faults)
    return MotionLimits(acceleration=a, jerk=j)


def require_short_moves(machine: Machine, limits: MotionLimits) -> None:
    """Raise MOVE_TOO_LONG if the moves take more velocity cycles than one simulation follows.

    Parameters
    ----------
    machine
        Nominal.
    limits
        Of ``--acceleration`` and ``--jerk``.

    Raises
    ------
    ComputationError
        With the count, before anything is computed.
    """
    require_few_cycles(
        machine,
        limits,
        most=MOST_SIMULATED_CYCLES,
        reason="asked for are",
        remedy="check the units of --acceleration and --jerk",
    )


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
) -> OptimalRequest:
    """Return what ``optimal`` is asked for.

    Parameters
    ----------
    machine, plant
        Nominal.
    kind, method, t_f, limits, velocity_step, distance, move, scheme, intervals
        Texts of the options; "" where one is not given.

    Returns
    -------
    OptimalRequest

    Raises
    ------
    InputError
        With every fault found.
    """
    faults: list[Fault] = []
    _one_of("--kind", kind, ("time", "damping"), faults)
    _one_of("--method", method, ("exact", "transcription"), faults)
    bounds = [read_bound(plant, text, faults) for text in limits]
    for name, count in Counter(text.partition("=")[0].strip() for text in limits).items():
        if count > 1:
            message = f"{name} is given {count} times; give each state or output once"
            faults.append(Fault(where="--limit", message=Message("verbatim", text=message)))
    final = read_positive("--t-f", t_f, TIME, faults) if t_f else None
    if kind == "time" and t_f:
        message = "goes with --kind damping; a time-optimal control finds its own final time"
        faults.append(Fault(where="--t-f", message=Message("verbatim", text=message)))
    schemes = {item.value: item for item in Scheme}
    _one_of("--scheme", scheme, tuple(schemes), faults)
    if not 2 <= intervals <= MOST_INTERVALS:
        message = f"got {intervals}, must be 2 to {MOST_INTERVALS}"
        faults.append(Fault(where="--intervals", message=Message("verbatim", text=message)))
    if kind == "damping" and limits and method == "exact":
        message = "bounds on a damping-optimal control need --method transcription"
        faults.append(Fault(where="--limit", message=Message("verbatim", text=message)))
    chosen = _move(
        machine, velocity_step=velocity_step, distance=distance, number=move, faults=faults
    )
    _raise(faults)
    return OptimalRequest(
        kind=kind,
        method=method,
        move=chosen,
        t_f=final,
        bounds=tuple(bounds),
        transcription=TranscriptionSettings(scheme=schemes[scheme], intervals=intervals),
    )


def solve(machine: Machine, plant: Plant, request: OptimalRequest) -> TimeOptimum | DampingOptimum:
    """Return the optimal control that was asked for.

    Parameters
    ----------
    machine, plant
        Nominal.
    request
        From ``read_optimal_request``.

    Returns
    -------
    TimeOptimum or DampingOptimum

    Raises
    ------
    ComputationError
        With a named outcome.
    """
    require_force(machine)
    force, move = machine.drive.motion_force, request.move
    exact = request.method == "exact"
    if request.kind == "time":
        if exact:
            return find_time_optimum(plant, move, force_limit=force, bounds=request.bounds)
        bounds = request.bounds
        if isinstance(move, Positioning) and isfinite(move.max_velocity):
            bounds += (Bound(name=plant.states[plant.velocity], value=move.max_velocity),)
        return transcribe_time_optimal(
            plant, move, force_limit=force, bounds=bounds, settings=request.transcription
        )
    least = find_time_optimum(plant, move, force_limit=force, bounds=()).t_f
    t_f = request.t_f or machine.damping_optimal.t_f or DAMPING_TIME_FACTOR * least
    solution = find_damping_optimum(machine, plant, move, t_f=t_f, least=least)
    if exact:
        return solution
    return transcribe_damping_optimal(
        plant,
        move,
        force_limit=force,
        t_f=t_f,
        weights=solution.weights,
        bounds=request.bounds,
        settings=request.transcription,
    )


def final_time_origin(machine: Machine, request: OptimalRequest) -> str:
    """Return what chose the final time of a damping-optimal control; empty for a time-optimal one.

    Parameters
    ----------
    machine
        Nominal.
    request
        From ``read_optimal_request``.

    Returns
    -------
    str
    """
    if request.kind == "time":
        return ""
    if request.t_f:
        return "that of --t-f"
    if machine.damping_optimal.t_f:
        return "that of the profile (damping_optimal.t_f)"
    return f"{DAMPING_TIME_FACTOR:g} times t_f,min: neither --t-f nor the profile gives one"


def _move(
    machine: Machine, *, velocity_step: str, distance: str, number: int, faults: list[Fault]
) -> Move:
    axis = machine.axis_units
    if velocity_step and distance:
        message = "cannot go with --velocity-step; give one of them"
        faults.append(Fault(where="--distance", message=Message("verbatim", text=message)))
    if velocity_step:
        return VelocityStep(
            velocity_step=read_positive("--velocity-step", velocity_step, axis.velocity, faults)
        )
    if distance:
        return Positioning(distance=read_positive("--distance", distance, axis.length, faults))
    if not 1 <= number <= len(machine.moves):
        message = f"got {number}, the profile has moves 1 to {len(machine.moves)}"
        faults.append(Fault(where="--move", message=Message("verbatim", text=message)))
        return machine.moves[0]
    return machine.moves[number - 1]


def _one_of(where: str, text: str, allowed: tuple[str, ...], faults: list[Fault]) -> None:
    if text not in allowed:
        message = f"got {text!r}, must be {' or '.join(allowed)}"
        faults.append(Fault(where=where, message=Message("verbatim", text=message)))


def _raise(faults: list[Fault]) -> None:
    if faults:
        raise InputError(faults)
