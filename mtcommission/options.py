"""Options of the command line -> quantities and requests; every fault at once.

What solves a request is loaded when it is asked: a sweep reads its options here, too.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from math import inf, isfinite

from mtcommission.control_kinds.kind import FIR, MOVING_AVERAGE, TWO_AVERAGES
from mtcommission.errors import Fault, InputError, Refused
from mtcommission.machine.machine import Machine, Move, Positioning, VelocityStep
from mtcommission.machine.ranges import FILTER_TIMES, FREQUENCIES
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.machine.variations import Corner
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import Bound, DampingOptimum, TimeOptimum
from mtcommission.optimal.transcription.settings import Scheme, TranscriptionSettings
from mtcommission.plant.plant import Plant, driven_at_once
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.smaller_moves import resize
from mtcommission.units.quantities import (
    ACCELERATION,
    ANGLE,
    ANGULAR_ACCELERATION,
    ANGULAR_VELOCITY,
    FORCE,
    FREQUENCY,
    LENGTH,
    MODAL_DEFLECTION,
    MODAL_RATE,
    RATIO,
    ROTARY_MODAL_DEFLECTION,
    ROTARY_MODAL_RATE,
    TIME,
    TORQUE,
    VELOCITY,
    Dimension,
    parse_quantity,
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


SIZES = {"every": True, "listed": False}
"""Words of ``--for``, and whether they ask for every smaller move."""


def with_sizes(machine: Machine, text: str) -> Machine:
    """Return the machine with other sizes of move that its limits must serve.

    Parameters
    ----------
    machine
        From its profile.
    text
        Of ``--for``: ``every`` or ``listed``.

    Returns
    -------
    Machine

    Raises
    ------
    InputError
        If the text is neither.
    """
    faults: list[Fault] = []
    require_one_of("--for", text, list(SIZES), faults)
    _raise(faults)
    needs = replace(machine.requirements, every_size=SIZES[text])
    return replace(machine, requirements=needs)


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
    taken = machine.drive.max_force - machine.drive.motion_force
    if force <= taken:
        message = Message(
            "option-force-below-static-load",
            force=force,
            load=taken,
            unit=dimension.si,
        )
        raise InputError([Fault(where="--f-max", message=message)])
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """What ``simulate`` runs in place of what the profile states; the loop stays the profile's.

    Parameters
    ----------
    machine
        With the moves and the setpoint filter to be simulated.
    place
        A machine to be looked at beside the corners; None: none.
    """

    machine: Machine
    place: Corner | None


LARGEST_FREQUENCY_ERROR = 0.5
"""Either way [-]; beyond, it is another machine."""

LARGEST_PAYLOAD = 1e6
"""[kg]; more than any machine moves."""


def read_tried(
    machine: Machine, *, setpoint_filter: str, move: int, size: str, payload: str, error: str
) -> Tried:
    """Return what the options of ``simulate`` change; "" and 0 change nothing.

    Parameters
    ----------
    machine
        From its profile.
    setpoint_filter
        ``none``, or kind and numbers, e.g. ``moving_average:20ms`` or ``zvd:40Hz:0.05``.
    move
        Number of the only move to be simulated.
    size
        Its velocity step or distance.
    payload, error
        Of a machine to be looked at besides: its payload, and by how much its frequencies are off.

    Returns
    -------
    Tried

    Raises
    ------
    InputError
        With every fault.
    """
    faults: list[Fault] = []
    control, moves, axis = machine.control, machine.moves, machine.axis_units
    if setpoint_filter:
        item = _read_filter(machine, setpoint_filter, faults)
        control = replace(control, setpoint_filter=item, seeks_setpoint_filter=False)
    if not 0 <= move <= len(moves):
        message = Message("option-no-such-move", got=move, count=len(moves))
        faults.append(Fault(where="--move", message=message))
    elif move or size:
        moves = (moves[max(move - 1, 0)],)
    if size:
        unit = axis.velocity if isinstance(moves[0], VelocityStep) else axis.length
        moves = (resize(moves[0], read_positive("--size", size, unit, faults)),)
    carried = _read_within("--payload", payload, axis.mass, (0.0, LARGEST_PAYLOAD), faults)
    ends = (-LARGEST_FREQUENCY_ERROR, LARGEST_FREQUENCY_ERROR)
    off = _read_within("--frequency-error", error, RATIO, ends, faults)
    _raise(faults)
    return Tried(
        machine=replace(machine, control=control, moves=moves),
        place=Corner(payload=carried, frequency_factor=1.0 + off) if carried or off else None,
    )


def _read_filter(machine: Machine, text: str, faults: list[Fault]) -> SetpointFilter | None:
    """A filter that the control has, in its range; None for "none", or after noting a fault."""
    where, kind = "--filter", machine.control.kind
    name, *numbers = text.strip().split(":")
    if name == "none" and not numbers:
        return None
    choice = kind.find_filter(name)
    if choice is None:
        has = ", ".join(["none", *(item.kind for item in kind.setpoint_filters)])
        message = Message("control-without-filter", got=f'"{name}"', control=kind.key, has=has)
        faults.append(Fault(where=where, message=message))
        return None
    shortest, longest = choice.possible_times(machine.control.position_cycle)
    times = max(shortest, FILTER_TIMES.linear.low), min(longest, FILTER_TIMES.linear.high)
    highest = min(choice.most_frequency_hz, FREQUENCIES.linear.high)
    frequency = ("frequency", FREQUENCY, choice.least_frequency_hz, highest)
    damping = ("damping", RATIO, choice.least_damping, choice.most_damping)
    wanted = {MOVING_AVERAGE: [("time", TIME, *times)], TWO_AVERAGES: [("time", TIME, *times)] * 2}
    ranges = wanted.get(name, [frequency, damping])
    if len(numbers) != len(ranges) or name == FIR:
        faults.append(Fault(where=where, message=Message("option-filter-form", got=text.strip())))
        return None
    values = []
    for number, (key, unit, low, high) in zip(numbers, ranges, strict=True):
        value = _read_within(where, number, unit, (-inf, inf), faults)
        if not low <= value <= high:
            message = Message(
                f"control-filter-{key}", got=value, low=low, high=high, control=kind.key
            )
            faults.append(Fault(where=where, message=message))
        values.append(value)
    if ranges[0][0] == "time":
        return SetpointFilter(kind=name, time=values[0], second_time=sum(values[1:]))
    return SetpointFilter(kind=name, frequency_hz=values[0], damping_ratio=values[1])


def _read_within(
    where: str, text: str, unit: Dimension, ends: tuple[float, float], faults: list[Fault]
) -> float:
    """A quantity between two ends; 0 for "", or after noting a fault."""
    if not text:
        return 0.0
    try:
        value = parse_quantity(text, unit)
    except Refused as error:
        faults.append(Fault(where=where, message=error.message))
        return 0.0
    if not ends[0] <= value <= ends[1]:
        message = Message("option-between", got=text.strip(), least=ends[0], most=ends[1])
        faults.append(Fault(where=where, message=message))
        return 0.0
    return value


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
    from mtcommission.loop.simulation_budget import require_few_cycles

    require_few_cycles(
        machine,
        limits,
        most=MOST_SIMULATED_CYCLES,
        reason=Message("budget-asked-for"),
        remedy=Message("budget-check-options"),
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
    jerk: str = "",
) -> OptimalRequest:
    """Return what ``optimal`` is asked for.

    Parameters
    ----------
    machine, plant
        Nominal.
    kind, method, t_f, limits, velocity_step, distance, move, scheme, intervals, jerk
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
    _raise(faults)
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

    Returns
    -------
    TimeOptimum or DampingOptimum

    Raises
    ------
    ComputationError
        With a named outcome.
    """
    from mtcommission.limits.optima import (
        DAMPING_TIME_FACTOR,
        find_damping_optimum,
        find_time_optimum,
        require_force,
    )
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

    Returns
    -------
    Message or None
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

    Returns
    -------
    Bound
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


def read_positive(where: str, text: str, dimension: Dimension, faults: list[Fault]) -> float:
    """Return a positive quantity, or 1 after noting a fault.

    Parameters
    ----------
    where
        Option, for messages.
    text
        SI number, or number and unit.
    dimension
        Which units are allowed.
    faults
        Gets what is wrong with it.

    Returns
    -------
    float
        SI.
    """
    try:
        value = parse_quantity(text, dimension)
    except Refused as error:
        faults.append(Fault(where=where, message=error.message))
        return 1.0
    if value <= 0.0:
        message = Message("option-not-positive", got=text.strip(), unit=dimension.si)
        faults.append(Fault(where=where, message=message))
        return 1.0
    return value


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


def require_move(machine: Machine, number: int, faults: list[Fault]) -> None:
    """Note a fault where the profile has no move of this number, counted from 1."""
    count = len(machine.moves)
    if not 1 <= number <= count:
        message = Message("option-no-such-move", got=number, count=count)
        faults.append(Fault(where="--move", message=message))


def require_one_of(where: str, text: str, allowed: Sequence[str], faults: list[Fault]) -> None:
    """Note a fault where an option has none of the words that it takes."""
    if text not in allowed:
        words = Message("either", first=tuple(allowed[:-1]), last=allowed[-1])
        message = Message("option-one-of", got=repr(text), allowed=words)
        faults.append(Fault(where=where, message=message))


def _raise(faults: list[Fault]) -> None:
    if faults:
        raise InputError(faults)
