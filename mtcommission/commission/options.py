"""Texts of the command line's options -> quantities and requests; every fault at once.

What solves a request is loaded when it is asked: a sweep reads its options here, too.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import TYPE_CHECKING

from mtcommission.base.errors import Fault, InputError, Refused
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import (
    DIMENSIONS,
    RATIO,
    TIME,
    Dimension,
    parse_quantity,
)
from mtcommission.controls.kind import FIR, MOVING_AVERAGE, TWO_AVERAGES
from mtcommission.machine.machine import Corner, Machine
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, driven_at_once
from mtcommission.machine.readers import Reading, propose
from mtcommission.machine.setpoint_filter import HELD_FILTER, KEYS, SetpointFilter, list_misfits
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.smaller_moves import resize

if TYPE_CHECKING:  # the optima load slowly, and most commands need none
    from mtcommission.machine.readers import SignalValue
    from mtcommission.optimal.control import AnyOptimum
    from mtcommission.optimal.transcription_settings import TranscriptionSettings

BY_UNIT = {dimension.si: dimension for dimension in DIMENSIONS}
"""What a signal of the plant measures, by its unit."""

MOST_INTERVALS = 20_000
"""Grid of a transcription that still fits into some GB."""

LARGEST_FREQUENCY_ERROR = 0.5
"""Either way [-]; beyond, it is another machine."""

LARGEST_PAYLOAD = 1e6
"""[kg]; more than any machine moves."""

FILTER_FORMS = {MOVING_AVERAGE: "8ms", TWO_AVERAGES: f"{TWO_AVERAGES}:8ms:4ms"}
"""How ``--filter`` takes averages; a shaper takes a frequency and a damping ratio."""

SIZES = {"every": True, "listed": False}
"""Words of ``--for``, and whether they ask for every smaller move."""


class Options:
    """Reads the texts of a call's options; as a context it raises all that is wrong at its end."""

    def __init__(self) -> None:
        self.faults: list[Fault] = []

    def __enter__(self) -> Options:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            self.close()

    def close(self) -> None:
        """Raise all that was noted, if anything was."""
        if self.faults:
            raise InputError(self.faults)

    def refuse(self, option: str, message: Message) -> None:
        """Note what is wrong with an option."""
        self.faults.append(Fault(where=option, message=message))

    def quantity(
        self, option: str, text: str, unit: Dimension, ends: tuple[float, float] = (-inf, inf)
    ) -> float:
        """Return a quantity between two ends [SI]; 0 for "", or after noting a fault."""
        value = self._parse(option, text, unit) if text else 0.0
        if value is not None and text and not ends[0] <= value <= ends[1]:
            message = Message("option-between", got=text.strip(), least=ends[0], most=ends[1])
            self.refuse(option, message)
            return 0.0
        return value or 0.0

    def positive(self, option: str, text: str, unit: Dimension) -> float:
        """Return a positive quantity [SI], or 1 after noting a fault."""
        value = self._parse(option, text, unit)
        if value is not None and value <= 0.0:
            message = Message("option-not-positive", got=text.strip(), unit=unit.si)
            self.refuse(option, message)
        return 1.0 if value is None or value <= 0.0 else value

    def _parse(self, option: str, text: str, unit: Dimension) -> float | None:
        try:
            return parse_quantity(text, unit)
        except Refused as error:
            self.refuse(option, error.message)
            return None

    def word(self, option: str, text: str, allowed: Sequence[str]) -> None:
        """Note a fault where an option has none of the words that it takes."""
        if text not in allowed:
            named = tuple(filter(None, allowed))
            words = Message("either", first=named[:-1], last=named[-1])
            self.refuse(option, Message("got-other-word", got=repr(text), words=words, hint=None))

    def move(self, machine: Machine, number: int) -> None:
        """Note a fault where the profile has no move of this number, counted from 1."""
        count = len(machine.moves)
        if not 1 <= number <= count:
            self.refuse("--move", Message("option-no-such-move", got=number, count=count))

    def bound(self, plant: Plant, text: str) -> SignalValue:
        """Return what ``--limit NAME=VALUE`` asks for, or any bound after noting a fault."""
        from mtcommission.machine.readers import SignalValue

        name, separator, value = text.partition("=")
        name = name.strip()
        if not separator:
            self.refuse("--limit", Message("option-form", got=text, form="NAME=VALUE"))
        elif name not in plant.signals:
            hint = propose(name, plant.signals)
            self.refuse("--limit", Message("option-no-signal", got=repr(name), hint=hint))
        else:
            unit = BY_UNIT[plant.signal_units[plant.signals.index(name)]]
            return SignalValue(name=name, value=self.positive(f"--limit {name}", value, unit))
        return SignalValue(name=name, value=1.0)


# --f-max, --for


def with_options(machine: Machine, *, f_max: str = "", sizes: str = "") -> Machine:
    """Return the machine with the force limit of ``--f-max`` and the sizes of move of ``--for``.

    Raises
    ------
    InputError
        A text is no such quantity or word, or the force leaves nothing beside the static load.
    """
    drive, needs, unit = machine.drive, machine.requirements, machine.axis_units.force
    with Options() as options:
        if sizes:
            options.word("--for", sizes, list(SIZES))
            needs = replace(needs, every_size=SIZES.get(sizes, True))
        if f_max:
            force, taken = options.positive("--f-max", f_max, unit), drive.max_force
            taken -= drive.motion_force
            if not options.faults and force <= taken:
                message = Message(
                    "option-force-below-static-load", force=force, load=taken, unit=unit.si
                )
                options.refuse("--f-max", message)
            drive = replace(drive, max_force=force)
    return replace(machine, drive=drive, requirements=needs)


# optimal


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimalRequest:
    """What ``optimal`` is asked for."""

    kind: str  # time or damping
    method: str  # exact or transcription
    move: Move  # the profile's, or from the options
    t_f: float | None  # final time of a damping-optimal control [s]; None: that of the profile
    bounds: tuple[SignalValue, ...]
    transcription: TranscriptionSettings
    jerk: float  # largest jerk of an open-loop axis [m/s³]; inf: not limited


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
    """Return what ``optimal`` is asked for; raise InputError with every fault found."""
    from mtcommission.optimal.transcription_settings import Scheme, TranscriptionSettings

    schemes, axis = {item.value: item for item in Scheme}, machine.axis_units
    chosen = machine.moves[move - 1 if 1 <= move <= len(machine.moves) else 0]
    with Options() as options:
        options.word("--kind", kind, ("time", "damping"))
        options.word("--method", method, ("exact", "transcription"))
        bounds = tuple(options.bound(plant, text) for text in limits)
        for name, count in Counter(text.partition("=")[0].strip() for text in limits).items():
            if count > 1:
                options.refuse("--limit", Message("option-given-twice", name=name, count=count))
        final = options.positive("--t-f", t_f, TIME) if t_f else None
        most = options.positive("--jerk", jerk, axis.jerk) if jerk else inf
        if jerk and not (kind == "time" and method == "exact" and machine.drive.follows):
            options.refuse("--jerk", Message("option-jerk-of-what-follows"))
        if isfinite(most) and machine.drive.follows:
            _refuse_all_but_jumps(machine, plant, most, bounds, options)
        if kind == "time" and t_f:
            options.refuse("--t-f", Message("option-final-time-is-found"))
        options.word("--scheme", scheme, tuple(schemes))
        if not 2 <= intervals <= MOST_INTERVALS:
            message = Message("option-between", got=intervals, least=2, most=MOST_INTERVALS)
            options.refuse("--intervals", message)
        if kind == "damping" and limits and method == "exact":
            options.refuse("--limit", Message("option-bounds-need-transcription"))
        if velocity_step and distance:
            options.refuse("--distance", Message("option-step-or-distance"))
        if velocity_step:
            velocity = options.positive("--velocity-step", velocity_step, axis.velocity)
            chosen = VelocityStep(velocity_step=velocity)
        elif distance:
            length = options.positive("--distance", distance, axis.length)
            chosen = Positioning(distance=length)
        else:
            options.move(machine, move)
    return OptimalRequest(
        kind=kind,
        method=method,
        move=chosen,
        t_f=final,
        bounds=bounds,
        transcription=TranscriptionSettings(scheme=schemes[scheme], intervals=intervals),
        jerk=most,
    )


def _refuse_all_but_jumps(
    machine: Machine, plant: Plant, jerk: float, bounds: Sequence[SignalValue], options: Options
) -> None:
    """Note the fault of a jerk with which the acceleration reaches its limit all but at once."""
    from mtcommission.optimal.bounded import SHORTEST_RAMP
    from mtcommission.optimal.open_loop import least_limit

    ramp = least_limit(plant, machine.drive.motion_force, bounds) / jerk
    if ramp * plant.fastest_rate < SHORTEST_RAMP:
        message = Message("option-jerk-all-but-jumps", jerk=jerk, unit=plant.jerk_unit, ramp=ramp)
        options.refuse("--jerk", message)


def solve(machine: Machine, plant: Plant, request: OptimalRequest) -> AnyOptimum:
    """Return the optimal control that was asked for.

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
    from mtcommission.machine.machine import require_force
    from mtcommission.machine.readers import SignalValue
    from mtcommission.optimal.open_loop import least_limit, on_states, optimum_on

    require_force(machine)
    force, move = machine.drive.motion_force, request.move
    limit = least_limit(plant, force, request.bounds)
    bounds, is_exact = on_states(plant, request.bounds), request.method == "exact"
    if isfinite(request.jerk):
        from mtcommission.optimal.open_loop import solve_jerk_limited

        return solve_jerk_limited(
            plant, move, force_limit=limit, jerk_limit=request.jerk, bounds=bounds
        )
    if request.kind == "time" and is_exact:
        return find_time_optimum(plant, move, force_limit=force, bounds=request.bounds)
    if request.kind == "time":
        from mtcommission.optimal.transcription import transcribe_time_optimal

        if isinstance(move, Positioning) and isfinite(move.max_velocity):
            bounds += (SignalValue(name=plant.states[plant.velocity], value=move.max_velocity),)
        gridded = transcribe_time_optimal(
            driven_at_once(plant),
            move,
            force_limit=limit,
            bounds=bounds,
            settings=request.transcription,
        )
        return optimum_on(plant, gridded)
    least = find_time_optimum(plant, move, force_limit=force, bounds=()).t_f
    t_f = request.t_f or machine.damping_optimal.t_f or DAMPING_TIME_FACTOR * least
    solution = find_damping_optimum(machine, plant, move, t_f=t_f, least=least)
    if is_exact:
        return solution
    from mtcommission.optimal.transcription import transcribe_damping_optimal

    on_grid = transcribe_damping_optimal(
        driven_at_once(plant),
        move,
        force_limit=limit,
        t_f=t_f,
        weights=solution.weights,
        bounds=bounds,
        settings=request.transcription,
    )
    return optimum_on(plant, on_grid)


def final_time_origin(machine: Machine, request: OptimalRequest) -> Message | None:
    """Return what chose the final time of a damping-optimal control; else None."""
    from mtcommission.limits.optima import DAMPING_TIME_FACTOR

    if request.kind == "time":
        return None
    if request.t_f:
        return Message("terminal-final-time-of-option")
    if machine.damping_optimal.t_f:
        return Message("terminal-final-time-of-profile")
    return Message("terminal-final-time-by-default", factor=DAMPING_TIME_FACTOR)


# simulate


def read_limits(machine: Machine, *, acceleration: str, jerk: str) -> MotionLimits:
    """Return limits from ``--acceleration`` and ``--jerk``; "" where the control limits no jerk."""
    axis, has_jerk = machine.axis_units, machine.control.kind.has_jerk_limit
    with Options() as options:
        a = options.positive("--acceleration", acceleration, axis.acceleration)
        if not jerk and has_jerk:
            options.refuse("--jerk", Message("option-jerk-needed"))
        j = options.positive("--jerk", jerk, axis.jerk) if jerk else 1.0
    return MotionLimits(acceleration=a, jerk=j) if jerk else without_jerk_limit(machine, a)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """What ``simulate`` runs in place of what the profile states; the loop stays the profile's."""

    machine: Machine  # with the moves and the setpoint filter to be simulated
    place: Corner | None  # a machine to be looked at beside the corners


def read_tried(
    machine: Machine, *, setpoint_filter: str, move: int | None, size: str, payload: str, error: str
) -> Tried:
    """Return what the options of ``simulate`` change; "" and None change nothing.

    ``setpoint_filter`` is ``none``, or kind and numbers: ``moving_average:20ms``,
    ``zvd:40Hz:0.05``; ``move`` the only one to be simulated, ``size`` its velocity step or
    distance; ``payload`` and ``error`` of its frequencies are those of one machine more.
    """
    control, moves, axis = machine.control, machine.moves, machine.axis_units
    ends = (-LARGEST_FREQUENCY_ERROR, LARGEST_FREQUENCY_ERROR)
    with Options() as options:
        if setpoint_filter:
            item = _read_filter(machine, setpoint_filter, options)
            control = replace(control, setpoint_filter=item, seeks_setpoint_filter=False)
        if move is not None:
            options.move(machine, move)
        first = 1 if move is None else move
        if (move is not None or size) and 1 <= first <= len(moves):
            moves = (moves[first - 1],)
        if size:
            unit = axis.velocity if isinstance(moves[0], VelocityStep) else axis.length
            moves = (resize(moves[0], options.positive("--size", size, unit)),)
        carried = options.quantity("--payload", payload, axis.mass, (0.0, LARGEST_PAYLOAD))
        off = options.quantity("--frequency-error", error, RATIO, ends)
    return Tried(
        machine=replace(machine, control=control, moves=moves),
        place=Corner(payload=carried, frequency_factor=1.0 + off) if carried or off else None,
    )


def _read_filter(machine: Machine, text: str, options: Options) -> SetpointFilter | None:
    """A filter as the profile states one; None for "none", or after noting a fault."""
    where, control, (name, *numbers) = "--filter", machine.control, text.strip().split(":")
    if name == "none" and not numbers:
        return None
    if name[:1].isdigit() and not numbers:
        name, numbers = MOVING_AVERAGE, [name]
    if not control.kind.find_filter(name) or len(numbers) != len(KEYS[name]) or name == FIR:
        kinds = [choice.kind for choice in control.kind.setpoint_filters if choice.kind != FIR]
        forms = ("none", *(FILTER_FORMS.get(kind, f"{kind}:45Hz:0.02") for kind in kinds))
        options.refuse(where, Message("option-one-of", got=text.strip(), allowed=forms))
        return None
    reading = Reading(axis=machine.axis_units, states={}, outputs={}, follows=machine.drive.follows)
    stated = {"kind": name, **dict(zip(KEYS[name], numbers, strict=True))}
    item: SetpointFilter | None = HELD_FILTER.read(stated, (where,), reading)
    for _, message in reading.faults:
        options.refuse(where, message)
    for _, message in list_misfits(item, control.kind, position_cycle=control.position_cycle):
        options.refuse(where, message)
    return item
