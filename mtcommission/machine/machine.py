"""A machine axis as its data sheet tells it: frozen, SI, without files or solvers.

On a rotary axis inertia stands for mass, torque for force and rad for m; the equations
are the same, so the field names stay those of the linear axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import pairwise
from math import ceil, inf, isfinite
from typing import Any

import numpy as np

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.machine.control import Control, Today
from mtcommission.machine.identified import Identification
from mtcommission.machine.keys import (
    ELSEWHERE,
    EMPTY,
    Misfit,
    Table,
    keyed,
    read_table,
    table_schema,
)
from mtcommission.machine.mechanics import HELD, SOURCE, MachineState, Mechanics, Plants, States
from mtcommission.machine.ranges import (
    ACCELERATIONS,
    ARMS,
    BANDS,
    DAMPINGS,
    DISTANCES,
    DWELLS,
    FORCES,
    FRICTIONS,
    GEARS,
    LAGS,
    LEADS,
    LOADS,
    RESOLUTIONS,
    SHARES,
    SPREADS,
    STATIC_LOADS,
    STEP_RATES,
    TIMES,
    VELOCITIES,
)
from mtcommission.machine.readers import (
    Array,
    Flag,
    KeyPath,
    PerSignal,
    Reading,
    Signals,
    Text,
    Word,
    WordOr,
    describe,
    one_of,
    word_of,
)
from mtcommission.machine.setpoint_filter import list_misfits
from mtcommission.messages.message import Message
from mtcommission.units.axis_units import LINEAR, LINEAR_SOURCE, ROTARY, ROTARY_SOURCE, AxisUnits

MOST_MOVES = 50
MOST_STATES = 8
MOST_ASSUMED = 300
LARGEST_FREQUENCY_SPREAD = 0.5

MODE_BANDS = {"surface": 0.4, "accuracy": 1.0, "speed": 4.0}
"""Default bands of the machining modes in units of tcp_deviation (interface)."""


class Motion(Enum):
    """What the axis does: its units follow from it."""

    LINEAR = "linear"
    ROTARY = "rotary"


class DriveKind(Enum):
    """How the motor moves the axis."""

    SERVO = "servo"
    POSITION_SOURCE = "position_source"


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """[drive]: the motor as the axis feels it.

    A position source follows its setpoint whatever force that takes. What drives the plant is
    then its acceleration: that stands for every force here, in m/s², and the moving mass is 1.
    """

    kind: DriveKind = DriveKind.SERVO  # a force behind a loop, or an open-loop axis
    force_lag: float = keyed(LAGS, "Time constant of the force loop, T.", "2.5 ms")
    """[s]; 0 of a position source."""
    max_force: float = keyed(FORCES, "Largest force, F_max.", "2 kN")
    max_velocity: float = inf  # of a position source, by step rate or torque [m/s]; inf: none
    force_velocity: float | None = None
    """Velocity at which ``max_force`` was read off the motor's curve [m/s]; None: it was stated."""
    continuous_force: float = keyed(
        FORCES, "Thermal (RMS) limit over move and dwell.", "1 kN", default=inf
    )
    static_load: float = keyed(
        STATIC_LOADS,
        "Weight or process force; its amount is not available for motion.",
        "0 N",
        default=0.0,
    )
    coulomb_friction: float = keyed(
        FRICTIONS,
        "Friction that any motion must overcome; not available for motion.",
        "0 N",
        default=0.0,
        is_listed=False,
    )
    viscous_friction: float = keyed(
        DAMPINGS,
        "Friction per velocity, on the line of the drive.",
        "0 N s/m",
        default=0.0,
        is_listed=False,
    )
    lead: float | None = keyed(
        LEADS,
        "Travel of a linear axis per turn of screw or pinion; left out: linear motor, or unknown.",
        "10 mm",
        default=None,
    )
    gear: float = keyed(
        GEARS,
        "Turns of the motor per turn of screw, pinion or rotary axis.",
        "1",
        default=1.0,
        is_listed=False,
    )
    encoder_resolution: float = keyed(
        RESOLUTIONS,
        "Smallest step of the measured position.",
        "0.1 um",
        default=0.0,
        is_listed=False,
    )  # 0: not stated

    @property
    def follows(self) -> bool:
        """Whether the motor follows its setpoint: a position source, without a loop to tune."""
        return self.kind is DriveKind.POSITION_SOURCE

    @property
    def motion_force(self) -> float:
        """Force left for motion, max_force - |static_load| - coulomb_friction [N]."""
        return self.usable_force - self.coulomb_friction

    @property
    def usable_force(self) -> float:
        """Force left for motion and friction, max_force - |static_load| [N]."""
        return self.max_force - abs(self.static_load)

    @property
    def has_friction(self) -> bool:
        """Whether any friction was stated."""
        return self.coulomb_friction > 0.0 or self.viscous_friction > 0.0

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterator[Misfit]:
        """Yield what leaves no force for motion, and what belongs to the other kind of axis."""
        load, unit = abs(self.static_load), axis.force.si
        if self.usable_force <= 0.0:
            message = Message(
                "static-load-takes-all", got=self.static_load, max_force=self.max_force, unit=unit
            )
            yield "static_load", message
        elif self.motion_force <= 0.0:
            left = self.max_force - load
            message = Message("friction-takes-all", got=self.coulomb_friction, left=left, unit=unit)
            yield "coulomb_friction", message
        if axis is ROTARY and self.lead is not None:
            yield "lead", Message("lead-of-rotary-axis")
        if axis is not ROTARY and self.lead is None and "gear" in stated:
            yield "gear", Message("gear-without-lead")


@dataclass(frozen=True, slots=True, kw_only=True)
class CurvePoint:
    """What the torque of a motor leaves at one velocity."""

    velocity: float = keyed(VELOCITIES, "Of the axis.", "0.2 m/s")
    acceleration: float = keyed(
        ACCELERATIONS, "That the motor follows at this velocity.", "8 m/s^2"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionSource:
    """[drive] with a motor that follows its setpoint."""

    max_acceleration: float = keyed(
        ACCELERATIONS, "Largest acceleration that the motor follows.", "10 m/s^2"
    )
    max_velocity: float = keyed(
        VELOCITIES, "Largest velocity that the motor follows.", "0.5 m/s", default=inf
    )
    acceleration_curve: tuple[CurvePoint, ...] = keyed(
        Array(Table(CurvePoint), 2, 1000),
        "Acceleration that the torque leaves at rising velocities, straight between them; none "
        "beyond the last.",
        default=(),
    )
    step_rate: float = keyed(
        STEP_RATES, "Steps per second that the control sends at most.", "100 kHz", default=inf
    )
    step_length: float = keyed(
        RESOLUTIONS, "Travel per (micro)step: 1 mm by the steps per mm.", "12.5 um", default=inf
    )

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterator[Misfit]:
        """Yield keys that say nothing alone, and a curve that does not rise."""
        for key, other in (("step_rate", "step_length"), ("step_length", "step_rate")):
            if key in stated and other not in stated:
                yield key, Message("key-without-other", other=other)
        points = pairwise(self.acceleration_curve)
        if any(after.velocity <= before.velocity for before, after in points):
            yield "acceleration_curve", Message("curve-does-not-rise")

    @property
    def velocity_limit(self) -> float:
        """Largest velocity of the motor, of all that is stated [m/s]; inf: none is."""
        last = self.acceleration_curve[-1].velocity if self.acceleration_curve else inf
        return min(self.max_velocity, last, self.step_rate * self.step_length)

    def drive(self, moves: Sequence[Move]) -> Drive:
        """Return the drive for these moves, with the least acceleration up to their velocity.

        One acceleration is typed in for all velocities: what is left at the largest counts.
        """
        curve, limit = self.acceleration_curve, self.velocity_limit
        fastest = max(min(largest_velocity(move), limit) for move in moves)
        left = self.max_acceleration
        if curve:
            known, values = zip(*((one.velocity, one.acceleration) for one in curve), strict=True)
            reached = (one.acceleration for one in curve if one.velocity <= fastest)
            left = min(left, float(np.interp(fastest, known, values)), *reached)
        return Drive(
            kind=DriveKind.POSITION_SOURCE,
            force_lag=0.0,
            max_force=left,
            max_velocity=limit,
            force_velocity=fastest if curve else None,
        )


class _Drives:
    """Reader of [drive], whose ``kind`` tells the dataclass."""

    kinds: Mapping[str, type[Any]] = {"servo": Drive, SOURCE: PositionSource}

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return a Drive or a PositionSource."""
        given = value.get("kind", "servo") if isinstance(value, dict) else "servo"
        if not isinstance(given, str) or given not in self.kinds:
            words = one_of(tuple(self.kinds))
            message = Message("got-other-word", got=describe(given), words=words)
            reading.refuse((*place, "kind"), message)
            return None
        return read_table(self.kinds[given], value, place, reading, beside=("kind",))

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: a table of either kind."""
        for name, kind in self.kinds.items():
            own = {"description": "How the motor moves the axis.", "const": name}
            tables[kind.__name__] = table_schema(kind, tables, before={"kind": own})
        tables["Drive"]["required"].remove("kind")
        return {"anyOf": [{"$ref": f"#/$defs/{kind.__name__}"} for kind in self.kinds.values()]}


ELSEWHERE[Drive], ELSEWHERE[PositionSource] = (PositionSource, SOURCE), (Drive, "servo")


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityStep:
    """An element of [[moves]]: accelerate from rest to a velocity; the end position is free."""

    velocity_step: float = keyed(
        VELOCITIES, "Accelerate from rest to this velocity; the end position is free.", "0.1 m/s"
    )
    dwell: float = keyed(DWELLS, "Rest after the move.", "0 s", default=0.0)  # for the RMS force


@dataclass(frozen=True, slots=True, kw_only=True)
class Positioning:
    """An element of [[moves]]: move from rest to rest."""

    distance: float = keyed(DISTANCES, "Move over this distance from rest to rest.", "20 mm")
    max_velocity: float = keyed(
        VELOCITIES, "Velocity limit of a move over a distance.", "0.5 m/s", default=inf
    )
    dwell: float = keyed(DWELLS, "Rest after the move.", "0 s", default=0.0)  # for the RMS force


Move = VelocityStep | Positioning


def largest_velocity(move: Move) -> float:
    """Return the velocity that a move reaches at most, as stated [m/s]; inf: it states none."""
    return move.velocity_step if isinstance(move, VelocityStep) else move.max_velocity


class _Moves:
    """Reader of one move: a step of the velocity, or a distance."""

    kinds: Mapping[str, type[Any]] = {"velocity_step": VelocityStep, "distance": Positioning}
    keys = (*kinds, "max_velocity")

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return the move."""
        given = [key for key in self.kinds if key in value] if isinstance(value, dict) else []
        kind = self.kinds[given[-1]] if given else Positioning
        if not isinstance(value, dict) or len(given) == 1:
            if isinstance(value, dict) and kind is VelocityStep and "max_velocity" in value:
                message = Message("max-velocity-without-distance")
                reading.refuse((*place, "max_velocity"), message)
            return read_table(kind, value, place, reading, beside=self.keys)
        before = len(reading.faults)
        if given:
            VELOCITIES.read(value["velocity_step"], (*place, "velocity_step"), reading)
        known = {key: one for key, one in value.items() if key != "velocity_step"}
        read_table(kind, {"distance": 1.0, **known}, place, reading, beside=self.keys)
        if len(reading.faults) == before:
            message = Message(f"move-with-{'both' if given else 'neither'}")
            reading.refuse(place, message)
        return None

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: either form."""
        return {"anyOf": [Table(kind).schema(tables) for kind in self.kinds.values()]}


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """A bound on a state or output over the whole closed-loop response."""

    name: str  # state or output of the plant, e.g. ``v_phi``
    bound: float  # largest allowed magnitude, in the SI unit of that signal


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """[requirements.modes]: allowed residual deviation (the band) in each machining mode [m]."""

    surface: float = keyed(BANDS, "Band for finishing.", "2 um", left_out=None)
    accuracy: float = keyed(BANDS, "Band for contours.", "5 um", left_out=None)
    speed: float = keyed(BANDS, "Band for roughing.", "20 um", left_out=None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reserve:
    """Share of what is allowed that recommendations may use; given limits may use all of it."""

    band: float = keyed(
        SHARES, "Share of band, contour and peaks that recommendations may use.", "0.8", default=0.8
    )
    force: float = keyed(
        SHARES,
        "Share of set force and RMS force that recommendations may use.",
        "0.95",
        default=0.95,
    )


NO_RESERVE = Reserve(band=1.0, force=1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirements:
    """[requirements]: what the axis must achieve, in every corner; inf: not asked for."""

    tcp_deviation: float = keyed(
        BANDS, "Half width of the band about the delayed setpoint.", "5 um"
    )
    max_settling_time: float = keyed(TIMES, "Longest settling time.", "0.2 s", default=inf)
    contour_deviation: float = keyed(
        BANDS,
        "Allowed deviation from the delayed setpoint during the whole move.",
        "20 um",
        default=inf,
    )
    contour_feed: float = keyed(
        VELOCITIES,
        "Largest velocity at which the contour must be kept; left out: that of each move.",
        "2 m/min",
        default=inf,
    )
    reserve: Reserve = keyed(
        Table(Reserve),
        "Share of what is allowed that recommendations may use; 1 must be said.",
        default=NO_RESERVE,
        left_out=EMPTY,
    )
    frequency_spread: float = keyed(
        SPREADS,
        "Relative uncertainty of all eigenfrequencies; none must be said.",
        "5 %",
        default=0.0,
        left_out=0.05,
    )
    damping_spread: float = keyed(
        SPREADS,
        "Relative uncertainty of all damping ratios; none must be said.",
        "30 %",
        default=0.0,
        left_out=0.3,
    )
    every_size: bool = keyed(
        Word({"every": True, "listed": False}),
        "Whether limits hold for every smaller move, too, or for the listed sizes only.",
        "every",
        key="move_sizes",
        default=False,
        left_out=True,
    )
    payload: tuple[float, float] = keyed(
        Array(LOADS, 2, 2), "Least and largest payload.", '["0 kg", "100 kg"]', default=(0.0, 0.0)
    )
    payload_radius: float = keyed(
        ARMS,
        "Radius of gyration of the payload about the rotary joint.",
        "0.3 m",
        default=0.0,
        is_listed=False,
    )  # 0 leaves the inertia alone
    peaks: tuple[Peak, ...] = keyed(
        Signals(PerSignal.BOUND, lambda name, bound: Peak(name=name, bound=bound)),
        "Bounds on states or outputs during the whole response.",
        '{ v_phi = "5 mrad/s" }',
        default=(),
    )
    modes: Modes = keyed(
        Table(Modes), "Band of each machining mode.", left_out=EMPTY, is_listed=False
    )

    @classmethod
    def complete(
        cls, values: dict[str, Any], stated: Mapping[str, Any], reading: Reading
    ) -> dict[str, Any]:
        """Return the values with the bands that were left out."""
        given = values["modes"]
        bands = {
            mode: getattr(given, mode) or share * values["tcp_deviation"]
            for mode, share in MODE_BANDS.items()
        }
        return {**values, "modes": Modes(**bands)}

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterator[Misfit]:
        """Yield spreads that are too large, and what does not fit together."""
        if self.frequency_spread > LARGEST_FREQUENCY_SPREAD:
            message = Message("frequency-spread-large", got=self.frequency_spread)
            yield "frequency_spread", message
        if self.damping_spread >= 1.0:
            yield "damping_spread", Message("damping-spread-large", got=self.damping_spread)
        if isfinite(self.contour_feed) and not isfinite(self.contour_deviation):
            yield "contour_feed", Message("contour-feed-without-deviation")
        low, high = self.payload
        if low > high:
            message = Message("payload-reversed", low=low, high=high, unit=axis.mass.si)
            yield "payload", message
        if self.payload_radius < 0.0:
            got = f"{self.payload_radius:g}"
            yield "payload_radius", Message("must-be-at-least", got=got, bound=0.0, unit="")


@dataclass(frozen=True, slots=True, kw_only=True)
class Weight:
    """Weight of one squared state in the damping functional, eq. (5)."""

    state: str
    value: float  # c_i [N² per squared unit of the state]


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingOptimal:
    """[damping_optimal]: settings of the damping-optimal control."""

    t_f: float | None = keyed(TIMES, "Final time.", "52.2 ms", default=None)
    """[s]; None: that of the constrained optimum where there are peaks, else 1.2 x t_f,min."""
    weights: tuple[Weight, ...] = keyed(
        WordOr(
            {"balanced": ()},
            Signals(
                PerSignal.WEIGHT,
                lambda state, value: Weight(state=state, value=value),
                ("balanced",),
            ),
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
    mechanics: Mechanics = keyed(Plants(), "The mechanics.", key="plant")
    drive: Drive = keyed(_Drives(), "The motor as the axis feels it.")
    moves: tuple[Move, ...] = keyed(
        Array(_Moves(), 1, MOST_MOVES), "One or more; the limits must serve all of them."
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
                yield f"machine_states.{place}.name", Message("state-named-twice", name=name)
        spread = self.requirements.damping_spread
        most_damped = max(mode.damping_ratio for mode in self.mechanics.modes)
        largest = most_damped * (1.0 + spread)
        if largest >= 1.0:
            allowed = (ceil(100.0 * (1.0 / most_damped - 1.0)) - 1) / 100.0
            message = Message(
                "damping-spread-beyond-one", got=spread, largest=largest, allowed=allowed
            )
            yield "requirements.damping_spread", message
        today, control = self.today, self.control
        if today and today.jerk and not control.kind.has_jerk_limit:
            yield "today.jerk", Message("control-without-jerk-limit", control=control.kind.key)
        if today:
            for key, message in list_misfits(
                today.setpoint_filter, control.kind, position_cycle=control.position_cycle
            ):
                yield f"today.setpoint_filter.{key}", message


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
    if any(weight.state == ACCELERATION for weight in values["damping_optimal"].weights):
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
