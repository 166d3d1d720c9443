"""A machine axis as its data sheet tells it: frozen, SI, without files or solvers.

On a rotary axis inertia stands for mass, torque for force and rad for m; the equations
are the same, so the field names stay those of the linear axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from itertools import product
from math import ceil, inf, isfinite
from typing import Any

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import (
    LINEAR,
    LINEAR_SOURCE,
    ROTARY,
    ROTARY_SOURCE,
    AxisUnits,
)
from mtcommission.controls.kind import PositionLoop
from mtcommission.machine.control import MOST_CYCLES_LATE, Control, Today
from mtcommission.machine.drive import DRIVES, Drive, PositionSource
from mtcommission.machine.identified import Identification
from mtcommission.machine.keys import EMPTY, Misfit, Table, keyed
from mtcommission.machine.mechanics import HELD, PLANTS, MachineState, Mechanics, States
from mtcommission.machine.moves import Move, MoveReader, Positioning, VelocityStep, largest_velocity
from mtcommission.machine.readers import (
    TIMES,
    Array,
    Flag,
    PerSignal,
    Reading,
    Signals,
    SignalValue,
    Text,
    Word,
    word_of,
)
from mtcommission.machine.requirements import Requirements
from mtcommission.machine.setpoint_filter import list_misfits

MOST_MOVES = 50
MOST_STATES = 8
MOST_ASSUMED = 300


class Motion(Enum):
    """What the axis does: its units follow from it."""

    LINEAR = "linear"
    ROTARY = "rotary"


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingOptimal:
    """[damping_optimal]: settings of the damping-optimal control."""

    t_f: float | None = keyed(TIMES, "Final time.", "52.2 ms", default=None)
    """[s]; None: that of the constrained optimum where there are peaks, else 1.2 x t_f,min."""
    weights: tuple[SignalValue, ...] = keyed(
        Word(
            {"balanced": ()},
            Signals(PerSignal.WEIGHT, ("balanced",)),
        ),
        "Weights c_i of the squared states.",
        "balanced",
        default=(),
    )


DECIDES = {
    "drive": ("static_load",),
    "requirements": ("frequency_spread", "damping_spread", "reserve"),
    "control": ("kind", "position_loop", "position_cycle", "velocity_cycle"),
}
"""Keys whose defaults decide about limits; left out, they are assumptions, as is each dwell."""

ABOUT = "machine"
"""Table of a profile with the fields that say what the axis is called."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine profile for mtcommission; quantities are SI numbers or texts with a unit."""

    name: str = keyed(Text(), "Name of the machine.", "Machining centre", table=ABOUT)
    axis: str = keyed(Text(), "Name of the axis.", "X", table=ABOUT)
    source: str = keyed(
        Text(400), "Where the numbers come from.", "data sheet 12/2024", table=ABOUT
    )
    motion: Motion = keyed(
        word_of(Motion),
        "A rotary axis takes inertia for mass, torque for force and rad for m.",
        "linear",
        default=Motion.LINEAR,
        table=ABOUT,
    )
    illustrative: bool = keyed(
        Flag(),
        "Whether the numbers are plausible ones, not those of a real machine.",
        "false",
        default=False,
        table=ABOUT,
    )
    assumed: tuple[str, ...] = keyed(
        Array(Text(), 0, MOST_ASSUMED),
        "Keys whose values are defaults that were accepted, not measured.",
        '["drive.force_lag", "plant.modes[1].damping_ratio"]',
        default=(),
        table=ABOUT,
    )
    """With those that nobody stated and that decide about limits, spelt as in messages."""
    mechanics: Mechanics = keyed(PLANTS, "The mechanics.", key="plant")
    drive: Drive = keyed(DRIVES, "The motor as the axis feels it.")
    moves: tuple[Move, ...] = keyed(
        Array(MoveReader(), 1, MOST_MOVES), "One or more; the limits must serve all of them."
    )
    requirements: Requirements = keyed(Table(Requirements), "What the axis must achieve.")
    damping_optimal: DampingOptimal = keyed(
        Table(DampingOptimal), "The damping-optimal control.", default=DampingOptimal()
    )
    control: Control = keyed(Table(Control), "The cascade.", default=Control(), left_out=EMPTY)
    states: tuple[MachineState, ...] = keyed(
        Array(States(), 0, MOST_STATES),
        "States in which the machine was measured; limits must serve each of them.",
        key="machine_states",
        default=(),
    )
    today: Today | None = keyed(
        Table(Today), "What the control holds now, to see before and after.", default=None
    )
    identified: Identification | None = keyed(
        Table(Identification), "What was measured; identify writes it.", default=None
    )

    def mechanics_in(self, state: str) -> Mechanics:
        """Return the mechanics in a state, by its name; "": as [plant] states them."""
        own = (one.mechanics for one in self.states if one.name == state)
        return next(own, self.mechanics)

    def is_assumed(self, key: str) -> bool:
        """Return whether a key, or a table that holds it, is one of ``assumed``."""
        return any(key == one or key.startswith((f"{one}.", f"{one}[")) for one in self.assumed)

    @property
    def axis_units(self) -> AxisUnits:
        """What masses, forces and lengths are on this axis."""
        if self.drive.follows:
            return ROTARY_SOURCE if self.motion is Motion.ROTARY else LINEAR_SOURCE
        return ROTARY if self.motion is Motion.ROTARY else LINEAR

    @classmethod
    def complete(
        cls, values: dict[str, Any], stated: Mapping[str, Any], reading: Reading
    ) -> dict[str, Any]:
        """Return the values with the drive for the moves, and with what was not stated."""
        control, drive = values["control"], values["drive"]
        if isinstance(drive, PositionSource):
            _refuse_needless(values, stated, reading)
            moves = values["moves"]
            values["drive"] = drive = drive.drive(moves)
            values["moves"] = tuple(
                replace(move, max_velocity=min(move.max_velocity, drive.max_velocity))
                if isinstance(move, Positioning)
                else move
                for move in moves
            )
            cycle = control.position_cycle
            if control.kind.follows_steps and "position_cycle" not in stated.get("control", ()):
                cycle = 2.0 * control.velocity_cycle  # steps leave at any instant
            values["control"] = replace(
                control, position_loop=PositionLoop.DRIVE, position_cycle=cycle
            )
        left_out = {
            f"{table}.{key}": stated.get(table, {}) for table in DECIDES for key in DECIDES[table]
        }
        if drive.follows:
            del left_out["drive.static_load"]
        if drive.follows or len(control.kind.position_loops) == 1:
            del left_out["control.position_loop"]  # nothing to choose
        if isfinite(drive.continuous_force):
            left_out |= {f"moves[{n}].dwell": one for n, one in enumerate(stated["moves"], start=1)}
        silent = [key for key, one in left_out.items() if key.rpartition(".")[2] not in one]
        return {**values, "assumed": (*values["assumed"], *silent)}

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterator[Misfit]:
        """Yield what does not fit together between the tables."""
        names = [state.name for state in self.states]
        for place, name in enumerate(names):
            if name in names[:place]:
                yield f"machine_states.{place}.name", Message("named-twice", name=name)
        spread = self.requirements.damping_spread
        most_damped = max(mode.damping_ratio for mode in self.mechanics.modes)
        largest = most_damped * (1.0 + spread)
        if largest >= 1.0:
            allowed = (ceil(100.0 * (1.0 / most_damped - 1.0)) - 1) / 100.0
            message = Message(
                "damping-spread-beyond-one", got=spread, largest=largest, allowed=allowed
            )
            yield "requirements.damping_spread", message
        yield from self._waits_long()
        today, control = self.today, self.control
        if today and today.jerk and not control.kind.has_jerk_limit:
            what = Message("has-jerk")
            yield "today.jerk", Message("control-lacks", control=control.kind.key, what=what)
        if today:
            for key, message in list_misfits(
                today.setpoint_filter, control.kind, position_cycle=control.position_cycle
            ):
                yield f"today.setpoint_filter.{key}", message

    def _waits_long(self) -> Iterator[Misfit]:
        """What makes the setpoint wait for more position cycles than a control keeps."""
        control, cycle = self.control, self.control.position_cycle
        delays = {"drive.force_lag": self.drive.force_lag}
        for place, item in enumerate(control.force_filters):
            delays[f"control.force_filters.{place}.frequency"] = item.delay
        if control.reference_delay is not None:
            delays = {"control.reference_delay": control.reference_delay}
        delay, most = sum(delays.values()), MOST_CYCLES_LATE
        if delay > most * cycle:
            longest = max(delays, key=lambda key: delays[key])
            cycles = delay / cycle
            message = Message("waits-long", delay=delay, cycles=cycles, cycle=cycle, most=most)
            yield longest, message


WITHOUT_LOOP = {
    "control": ("kind", "setpoint_filter", "position_cycle", "velocity_cycle"),
    "today": ("acceleration", "jerk", "setpoint_filter"),
}
"""Keys that mean something where the motor follows its setpoint; all others belong to a loop."""

ACCELERATION = "F"
"""What the states call the acceleration of a motor that follows."""


def _refuse_needless(values: dict[str, Any], stated: Mapping[str, Any], reading: Reading) -> None:
    """Refuse what means nothing, or too much, where the motor follows its setpoint."""
    if type(values["mechanics"]) not in HELD.values():
        reading.refuse(("plant", "kind"), Message("motor-held-needs-modes"))
    for table, keys in WITHOUT_LOOP.items():
        for key in stated.get(table, ()):
            if key not in keys:
                reading.refuse((table, key), Message("no-loop-to-set"))
    if any(weight.name == ACCELERATION for weight in values["damping_optimal"].weights):
        weight = ("damping_optimal", "weights", ACCELERATION)
        reading.refuse(weight, Message("acceleration-weighed"))
    for key in ("payload", "payload_radius"):
        if key in stated["requirements"]:
            reading.refuse(("requirements", key), Message("payload-of-position-source"))
    limit, unit = values["drive"].velocity_limit, reading.axis.velocity.si
    for place, move in enumerate(values["moves"]):
        key = "velocity_step" if isinstance(move, VelocityStep) else "max_velocity"
        velocity = largest_velocity(move)
        if limit < velocity < inf:
            message = Message("move-beyond-motor", got=velocity, limit=limit, unit=unit)
            reading.refuse(("moves", place, key), message)


def moving_mass(machine: Machine) -> float:
    """Return the rigid mass that the drive accelerates [kg]."""
    return machine.mechanics.moving_mass


def heaviest_mass(machine: Machine) -> float:
    """Return the same with the largest payload [kg]."""
    return moving_mass(machine) + max(machine.requirements.payload)


def practical_ceiling(machine: Machine) -> float:
    """Return what the control's kind is given at most, assumed [m/s²]; inf: no such bound."""
    is_linear = machine.motion is Motion.LINEAR
    return machine.control.kind.largest_acceleration if is_linear else inf


def largest_acceleration(machine: Machine) -> float:
    """Return the largest acceleration that is looked at: by force, and by practical ceiling."""
    return min(machine.drive.motion_force / moving_mass(machine), practical_ceiling(machine))


def mid_payload(machine: Machine) -> float:
    """Return the middle of the payload range [kg]."""
    return 0.5 * sum(machine.requirements.payload)


def require_force(machine: Machine) -> None:
    """Raise NO_FORCE_LEFT if the static load takes all of the force."""
    drive = machine.drive
    if drive.motion_force <= 0.0:
        detail = Message("static-load-of-force", load=drive.static_load, force=drive.max_force)
        raise ComputationError(Outcome.NO_FORCE_LEFT, detail)


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """One variation of the machine in which the requirements must hold."""

    payload: float = 0.0  # [kg]
    frequency_factor: float = 1.0  # on all eigenfrequencies [-]
    damping_factor: float = 1.0  # on all damping ratios [-]
    state: str = ""  # name of the measured state; "": as [plant] states the machine


NOMINAL = Corner()
"""The machine exactly as the profile states it: no payload, no spread."""


def vary(machine: Machine, corner: Corner) -> Machine:
    """Return the nominal machine as it is in a corner: with mechanics changed, all else the same.

    Payload adds to the moving mass (and to the rotary inertia if ``payload_radius`` is given);
    the frequency factor s acts through stiffness with damping ratios fixed: k s², d s.

    Source: the project's definition of corners.
    """
    mechanics = machine.mechanics_in(corner.state).vary(
        payload=corner.payload,
        payload_radius=machine.requirements.payload_radius,
        frequency=corner.frequency_factor,
        damping=corner.damping_factor,
    )
    return replace(machine, mechanics=mechanics)


def corners(machine: Machine) -> tuple[Corner, ...]:
    """Return the nominal machine and every combination of the ends of the stated ranges.

    First the nominal one, then payload ends x frequency ends x damping ends, none twice: of the
    machine as [plant] states it, then of each measured state. Its requirements hold the ranges.
    """
    needs = machine.requirements

    def ends(spread: float) -> tuple[float, ...]:
        return (1.0 - spread, 1.0 + spread) if spread else (1.0,)

    combinations = product(
        ("", *(state.name for state in machine.states)),
        dict.fromkeys(needs.payload),
        ends(needs.frequency_spread),
        ends(needs.damping_spread),
    )
    outer = [
        Corner(payload=payload, frequency_factor=frequency, damping_factor=damping, state=state)
        for state, payload, frequency, damping in combinations
    ]
    return tuple(dict.fromkeys([NOMINAL, *outer]))
