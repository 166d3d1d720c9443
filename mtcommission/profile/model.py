"""The keys of a profile: what each means, what is allowed, and what must fit together.

The classes mirror the TOML tables one to one. A key that may be left out is None here; what
that means is decided where the Machine is built.
"""

from __future__ import annotations

from itertools import pairwise
from math import ceil, inf
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)

from mtcommission.control_kinds.kind import ControlKind, PositionLoop
from mtcommission.control_kinds.kinds import GENERIC, KINDS
from mtcommission.machine.mechanics import Misfit
from mtcommission.machine.ranges import (
    ACCELERATIONS,
    ARMS,
    BANDS,
    CYCLES,
    DAMPINGS,
    DELAYS,
    DISTANCES,
    DWELLS,
    FEEDFORWARDS,
    FORCES,
    FREQUENCIES,
    FRICTIONS,
    GEARS,
    JERKS,
    LAGS,
    LEADS,
    LOADS,
    MASSES,
    POSITION_GAINS,
    RESOLUTIONS,
    SHARES,
    SPREADS,
    STATIC_LOADS,
    STEP_RATES,
    TIMES,
    VELOCITIES,
    VELOCITY_GAINS,
)
from mtcommission.messages.message import Message
from mtcommission.profile.filter_tables import (
    ChosenFilter,
    ForceFilterTable,
    HeldFilter,
    list_misfits,
    read_force_filters,
)
from mtcommission.profile.identified_tables import IdentifiedTable
from mtcommission.profile.plant_tables import MOTOR_HELD, PLANT_TABLES, AnyKind, PlantTable
from mtcommission.profile.table import Table, optional, raise_all, required
from mtcommission.profile.values import (
    Faults,
    Name,
    PerSignal,
    Read,
    SignalTable,
    context_of,
    describe,
    one_of,
)
from mtcommission.units.axis_units import ROTARY, AxisUnits

FEEDFORWARDS_OF_KINDS = ("velocity_feedforward", "acceleration_feedforward", "jerk_feedforward")
"""Keys of [control], and fields of the kinds of control."""

MOST_MOVES = 50
MOST_ASSUMED = 300
LARGEST_FREQUENCY_SPREAD = 0.5
Kind: Any = Literal[tuple(KINDS)]
"""Key of a kind of control."""
WHOLE_MULTIPLE = 1e-9
"""Relative distance from a whole number of velocity cycles."""


class MachineTable(Table):
    """[machine]."""

    name: Annotated[str, Name()] = required("Name of the machine.", '"Machining centre"')
    axis: Annotated[str, Name()] = required("Name of the axis.", '"X"')
    source: Annotated[str, Name(longest=400)] = required(
        "Where the numbers come from.", '"data sheet 12/2024"'
    )
    motion: Literal["linear", "rotary"] = optional(
        "A rotary axis takes inertia for mass, torque for force and rad for m.",
        '"linear"',
        "linear",
    )
    illustrative: bool = optional(
        "Whether the numbers are plausible ones, not those of a real machine.", "false", False
    )
    assumed: Annotated[list[Annotated[str, Name()]], Field(max_length=MOST_ASSUMED)] = optional(
        "Keys whose values are defaults that were accepted, not measured.",
        '["drive.force_lag", "plant.modes[1].damping_ratio"]',
        [],
    )


SERVO, POSITION_SOURCE = "servo", "position_source"
"""Words of drive.kind."""


class DriveTable(Table):
    """[drive] with a force behind a loop."""

    kind: Literal["servo"] = optional("How the motor moves the axis.", '"servo"', SERVO)
    force_lag: Annotated[float, Read(LAGS)] = required(
        "Time constant of the force loop, T.", '"2.5 ms"'
    )
    max_force: Annotated[float, Read(FORCES)] = required("Largest force, F_max.", '"2 kN"')
    continuous_force: Annotated[float | None, Read(FORCES)] = optional(
        "Thermal (RMS) limit over move and dwell.", '"1 kN"'
    )
    static_load: Annotated[float, Read(STATIC_LOADS)] = optional(
        "Weight or process force; its amount is not available for motion.", '"0 N"', 0.0
    )
    coulomb_friction: Annotated[float, Read(FRICTIONS)] = optional(
        "Friction that any motion must overcome; not available for motion.", '"0 N"', 0.0
    )
    viscous_friction: Annotated[float, Read(DAMPINGS)] = optional(
        "Friction per velocity, on the line of the drive.", '"0 N s/m"', 0.0
    )
    lead: Annotated[float | None, Read(LEADS)] = optional(
        "Travel of a linear axis per turn of screw or pinion; left out: linear motor, or unknown.",
        '"10 mm"',
    )
    gear: Annotated[float, Read(GEARS)] = optional(
        "Turns of the motor per turn of screw, pinion or rotary axis.", "1", 1.0
    )
    encoder_resolution: Annotated[float | None, Read(RESOLUTIONS)] = optional(
        "Smallest step of the measured position.", '"0.1 um"'
    )

    @model_validator(mode="after")
    def _check(self, info: ValidationInfo) -> Self:
        faults: list[Misfit] = []
        axis = context_of(info).axis
        taken = abs(self.static_load) + self.coulomb_friction
        if abs(self.static_load) < self.max_force <= taken:
            message = Message(
                "friction-takes-all",
                got=self.coulomb_friction,
                left=self.max_force - abs(self.static_load),
                unit=axis.force.si,
            )
            faults.append(("coulomb_friction", message))
        if abs(self.static_load) >= self.max_force:
            message = Message(
                "static-load-takes-all",
                got=self.static_load,
                max_force=self.max_force,
                unit=axis.force.si,
            )
            faults.append(("static_load", message))
        if axis is ROTARY and self.lead is not None:
            faults.append(("lead", Message("lead-of-rotary-axis")))
        if axis is not ROTARY and self.lead is None and "gear" in self.model_fields_set:
            faults.append(("gear", Message("gear-without-lead")))
        raise_all(faults)
        return self


class CurvePoint(Table):
    """What the torque of a motor leaves at one velocity."""

    velocity: Annotated[float, Read(VELOCITIES)] = required("Of the axis.", '"0.2 m/s"')
    acceleration: Annotated[float, Read(ACCELERATIONS)] = required(
        "That the motor follows at this velocity.", '"8 m/s^2"'
    )


class PositionSourceTable(Table):
    """[drive] with a motor that follows its setpoint."""

    kind: Literal["position_source"] = required(
        "How the motor moves the axis.", '"position_source"'
    )
    max_acceleration: Annotated[float, Read(ACCELERATIONS)] = required(
        "Largest acceleration that the motor follows.", '"10 m/s^2"'
    )
    max_velocity: Annotated[float | None, Read(VELOCITIES)] = optional(
        "Largest velocity that the motor follows.", '"0.5 m/s"'
    )
    acceleration_curve: list[CurvePoint] | None = Field(
        None,
        description="Acceleration that the torque leaves at rising velocities, straight between "
        "them; none beyond the last.",
        min_length=2,
    )
    step_rate: Annotated[float | None, Read(STEP_RATES)] = optional(
        "Steps per second that the control sends at most.", '"100 kHz"'
    )
    step_length: Annotated[float | None, Read(RESOLUTIONS)] = optional(
        "Travel per (micro)step: 1 mm by the steps per mm.", '"12.5 um"'
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        faults: list[Misfit] = []
        for key, other in (("step_rate", "step_length"), ("step_length", "step_rate")):
            if getattr(self, key) is not None and getattr(self, other) is None:
                faults.append((key, Message("key-without-other", other=other)))
        velocities = [point.velocity for point in self.acceleration_curve or ()]
        if any(after <= before for before, after in pairwise(velocities)):
            faults.append(("acceleration_curve", Message("curve-does-not-rise")))
        raise_all(faults)
        return self

    def acceleration_up_to(self, velocity: float) -> float:
        """Return the least acceleration that the motor follows up to a velocity [m/s²]."""
        if not self.acceleration_curve:
            return self.max_acceleration
        known = [point.velocity for point in self.acceleration_curve]
        left = [point.acceleration for point in self.acceleration_curve]
        reached = [a for v, a in zip(known, left, strict=True) if v <= velocity]
        return min(self.max_acceleration, float(np.interp(velocity, known, left)), *reached)

    @property
    def velocity_limit(self) -> float:
        """Largest velocity of the motor, of all that is stated [m/s]; inf: none is."""
        stated = inf if self.max_velocity is None else self.max_velocity
        if self.acceleration_curve:
            stated = min(stated, self.acceleration_curve[-1].velocity)
        if self.step_rate is None or self.step_length is None:
            return stated
        return min(stated, self.step_rate * self.step_length)


def _kind_of_drive(table: object) -> str:
    """Tag of [drive], from data that may still be wrong."""
    kind = table.get("kind", SERVO) if isinstance(table, dict) else SERVO
    return kind if isinstance(kind, str) else ""


AnyDrive = Annotated[
    Annotated[DriveTable, Tag(SERVO)] | Annotated[PositionSourceTable, Tag(POSITION_SOURCE)],
    Discriminator(_kind_of_drive),
]


class MoveTable(Table):
    """[[moves]]."""

    velocity_step: Annotated[float | None, Read(VELOCITIES)] = optional(
        "Accelerate from rest to this velocity; the end position is free.", '"0.1 m/s"'
    )
    distance: Annotated[float | None, Read(DISTANCES)] = optional(
        "Move over this distance from rest to rest.", '"20 mm"'
    )
    max_velocity: Annotated[float | None, Read(VELOCITIES)] = optional(
        "Velocity limit of a move over a distance.", '"0.5 m/s"'
    )
    dwell: Annotated[float, Read(DWELLS)] = optional("Rest after the move.", '"0 s"', 0.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.velocity_step is None) == (self.distance is None):
            kind = "move-with-neither" if self.distance is None else "move-with-both"
            raise Faults([("", Message(kind))])
        if self.max_velocity is not None and self.distance is None:
            raise Faults([("max_velocity", Message("max-velocity-without-distance"))])
        return self


class ModeBands(Table):
    """[requirements.modes]."""

    surface: Annotated[float | None, Read(BANDS)] = optional("Band for finishing.", '"2 um"')
    accuracy: Annotated[float | None, Read(BANDS)] = optional("Band for contours.", '"5 um"')
    speed: Annotated[float | None, Read(BANDS)] = optional("Band for roughing.", '"20 um"')


class ReserveTable(Table):
    """reserve of [requirements]."""

    band: Annotated[float, Read(SHARES)] = optional(
        "Share of band, contour and peaks that recommendations may use.", "0.8", 0.8
    )
    force: Annotated[float, Read(SHARES)] = optional(
        "Share of set force and RMS force that recommendations may use.", "0.95", 0.95
    )


class RequirementsTable(Table):
    """[requirements]."""

    tcp_deviation: Annotated[float, Read(BANDS)] = required(
        "Half width of the band about the delayed setpoint.", '"5 um"'
    )
    max_settling_time: Annotated[float | None, Read(TIMES)] = optional(
        "Longest settling time.", '"0.2 s"'
    )
    contour_deviation: Annotated[float | None, Read(BANDS)] = optional(
        "Allowed deviation from the delayed setpoint during the whole move.", '"20 um"'
    )
    contour_feed: Annotated[float | None, Read(VELOCITIES)] = optional(
        "Largest velocity at which the contour must be kept; left out: that of each move.",
        '"2 m/min"',
    )
    reserve: ReserveTable = Field(
        default_factory=ReserveTable,
        description="Share of what is allowed that recommendations may use; 1 must be said.",
    )
    frequency_spread: Annotated[float, Read(SPREADS)] = optional(
        "Relative uncertainty of all eigenfrequencies; none must be said.", '"5 %"', 0.05
    )
    damping_spread: Annotated[float, Read(SPREADS)] = optional(
        "Relative uncertainty of all damping ratios; none must be said.", '"30 %"', 0.3
    )
    move_sizes: Literal["every", "listed"] = optional(
        "Whether limits hold for every smaller move, too, or for the listed sizes only.",
        '"every"',
        "every",
    )
    payload: list[Annotated[float, Read(LOADS)]] | None = Field(
        None,
        description="Least and largest payload.",
        examples=['["0 kg", "100 kg"]'],
        min_length=2,
        max_length=2,
    )
    payload_radius: Annotated[float, Read(ARMS)] = optional(
        "Radius of gyration of the payload about the rotary joint.", '"0.3 m"', 0.0
    )
    peaks: Annotated[dict[str, float], SignalTable(PerSignal.BOUND)] = optional(
        "Bounds on states or outputs during the whole response.", '{ v_phi = "5 mrad/s" }', {}
    )
    modes: ModeBands = Field(default_factory=ModeBands, description="Band of each machining mode.")

    @model_validator(mode="after")
    def _check(self, info: ValidationInfo) -> Self:
        faults: list[Misfit] = []
        if self.frequency_spread > LARGEST_FREQUENCY_SPREAD:
            message = Message("frequency-spread-large", got=self.frequency_spread)
            faults.append(("frequency_spread", message))
        if self.damping_spread >= 1.0:
            message = Message("damping-spread-large", got=self.damping_spread)
            faults.append(("damping_spread", message))
        if self.contour_feed is not None and self.contour_deviation is None:
            faults.append(("contour_feed", Message("contour-feed-without-deviation")))
        if self.payload is not None and self.payload[0] > self.payload[1]:
            (low, high), unit = self.payload, context_of(info).axis.mass.si
            faults.append(("payload", Message("payload-reversed", low=low, high=high, unit=unit)))
        if self.payload_radius < 0.0:
            got = f"{self.payload_radius:g}"
            message = Message("must-be-at-least", got=got, bound=0.0, unit="")
            faults.append(("payload_radius", message))
        raise_all(faults)
        return self


class DampingOptimalTable(Table):
    """[damping_optimal]."""

    t_f: Annotated[float | None, Read(TIMES)] = optional("Final time.", '"52.2 ms"')
    weights: Annotated[str | dict[str, float], SignalTable(PerSignal.WEIGHT, ("balanced",))] = (
        optional("Weights c_i of the squared states.", '"balanced"', "balanced")
    )


class TodayTable(Table):
    """[today]: what the control holds now."""

    acceleration: Annotated[float, Read(ACCELERATIONS)] = required(
        "Limit of the acceleration that is in the control now.", '"2 m/s^2"'
    )
    jerk: Annotated[float | None, Read(JERKS)] = optional("Limit of the jerk.", '"40 m/s^3"')
    position_gain: Annotated[float | None, Read(POSITION_GAINS)] = optional("Kv.", '"60 1/s"')
    velocity_gain: Annotated[float | None, Read(VELOCITY_GAINS)] = optional("Kp.", '"200 kN s/m"')
    integral_time: Annotated[float | None, Read(TIMES)] = optional("Tn.", '"20 ms"')
    setpoint_filter: HeldFilter = optional(
        'Filter behind the setpoint generator, or "none".', '"none"'
    )


class ControlTable(Table):
    """[control]; what is left out is tuned."""

    kind: Kind = optional("Which control: what it lacks is not used.", '"generic"', GENERIC.key)
    position_loop: Literal["control", "interpolated", "drive"] | None = optional(
        "Where the position loop closes; left out: as the kind of control does.", '"control"'
    )
    position_gain: Annotated[float | None, Read(POSITION_GAINS)] = optional("Kv.", '"60 1/s"')
    velocity_gain: Annotated[float | None, Read(VELOCITY_GAINS)] = optional("Kp.", '"200 kN s/m"')
    integral_time: Annotated[float | None, Read(TIMES)] = optional("Tn.", '"20 ms"')
    reference_model_time: Annotated[float, Read(DELAYS)] = optional(
        "Time constant of the reference model in the integral branch; 0 = none.", '"5 ms"', 0.0
    )
    velocity_feedforward: Annotated[float | None, Read(FEEDFORWARDS)] = optional(
        "Weight; left out: 1 where the control has it.", "1.0"
    )
    acceleration_feedforward: Annotated[float | None, Read(FEEDFORWARDS)] = optional(
        "Weight, times feedforward_mass; left out: 1 where the control has it.", "1.0"
    )
    jerk_feedforward: Annotated[float, Read(FEEDFORWARDS)] = optional(
        "Weight, times feedforward_mass and force_lag.", "0.0", 0.0
    )
    feedforward_mass: Annotated[float | None, Read(MASSES)] = optional(
        "Mass of the feed-forward; default: moving mass at mid payload.", '"800 kg"'
    )
    reference_delay: Annotated[float | None, Read(DELAYS)] = optional(
        "Delay of the reference path, or auto.", '"auto"'
    )
    position_cycle: Annotated[float | None, Read(CYCLES)] = optional(
        "Position controller cycle; left out: what is usual for the kind of control.", '"2 ms"'
    )
    velocity_cycle: Annotated[float | None, Read(CYCLES)] = optional(
        "Velocity controller cycle; left out: what is usual for the kind of control.", '"125 us"'
    )
    tcp_sensor: Literal["none", "position"] = optional(
        "Second encoder near the tool.", '"none"', "none"
    )
    state_feedback: Annotated[
        str | dict[str, float], SignalTable(PerSignal.GAIN, ("auto", "off"))
    ] = optional(
        "Active damping of the dominant mode: auto, off, or gains by state.", '"off"', "off"
    )
    setpoint_filter: ChosenFilter = optional(
        'Filter behind the setpoint generator, "none", or "auto": chosen with the limits.',
        '"auto"',
    )
    force_filters: Annotated[
        Annotated[list[ForceFilterTable], Field(max_length=8)] | None,
        BeforeValidator(read_force_filters),
    ] = Field(
        default_factory=list,
        description='Filters in the set-force path; "auto": those that let Kp rise.',
    )
    minimum_bandwidth: Annotated[float | None, Read(FREQUENCIES)] = optional(
        "What tuning must at least reach, closed velocity loop, -3 dB.", '"15 Hz"'
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        kind = KINDS[self.kind]
        faults = _list_lacking(self, kind)
        position = cycle_of(self)
        faults += list_misfits(
            "setpoint_filter", self.setpoint_filter, kind, position_cycle=position
        )
        velocity = self.velocity_cycle or kind.velocity_cycle
        if closes_in(self) is PositionLoop.DRIVE and self.reference_delay is not None:
            least = 2.0 * position
            if self.reference_delay < least:
                message = Message("delay-below-drive", got=self.reference_delay, least=least)
                faults.append(("reference_delay", message))
        ratio = position / velocity
        if round(ratio) < 1 or abs(ratio - round(ratio)) > WHOLE_MULTIPLE * ratio:
            message = Message(
                "cycle-no-multiple", got=position, ratio=ratio, velocity_cycle=velocity
            )
            faults.append(("position_cycle", message))
        raise_all(faults)
        return self


def closes_in(control: ControlTable) -> PositionLoop:
    """Return where the position loop closes, as stated or as the kind of control does."""
    loop = control.position_loop
    return PositionLoop(loop) if loop else KINDS[control.kind].position_loops[0]


def cycle_of(control: ControlTable) -> float:
    """Return the position cycle, as stated or as usual for the kind of control [s]."""
    return control.position_cycle or KINDS[control.kind].position_cycle


def _list_lacking(control: ControlTable, kind: ControlKind) -> list[Misfit]:
    """What a profile asks of a kind of control that it does not have."""
    key, faults = kind.key, list[Misfit]()
    if closes_in(control) not in kind.position_loops:
        got = describe(control.position_loop)
        there = one_of([loop.value for loop in kind.position_loops])
        message = Message("control-closes-elsewhere", got=got, control=key, has=there)
        faults.append(("position_loop", message))
    for name in FEEDFORWARDS_OF_KINDS:
        weight = getattr(control, name)
        if weight and not getattr(kind, name):
            has = ", ".join(one for one in FEEDFORWARDS_OF_KINDS if getattr(kind, one))
            got = describe(weight)
            message = Message("control-without-feedforward", got=got, control=key, has=has)
            faults.append((name, message))
    if control.reference_delay and not kind.reference_delay:
        message = Message("control-without-delay", got=control.reference_delay, control=key)
        faults.append(("reference_delay", message))
    if control.state_feedback != "off" and not kind.state_feedback:
        message = Message("control-without-state-feedback", control=key)
        faults.append(("state_feedback", message))
    if control.tcp_sensor != "none" and not kind.state_feedback:
        faults.append(("tcp_sensor", Message("control-without-observer", control=key)))
    filters = control.force_filters or ()
    if len(filters) > kind.force_filters:
        message = Message(
            "control-with-fewer-filters",
            got=len(filters),
            control=key,
            most=kind.force_filters,
        )
        faults.append(("force_filters", message))
    if control.force_filters is None and kind.force_filters == 0:
        faults.append(("force_filters", Message("control-without-force-filters", control=key)))
    return faults


class ProfileTable(Table):
    """A machine profile for mtcommission; quantities are SI numbers or texts with a unit."""

    schema_version: Literal[1] = Field(
        alias="schema", description="Version of the format.", examples=["1"]
    )
    machine: MachineTable = Field(description="What the sheet calls the axis.")
    plant: Annotated[PlantTable, AnyKind()] = Field(description="The mechanics.")
    drive: AnyDrive = Field(description="The motor as the axis feels it.")
    moves: list[MoveTable] = Field(
        description="One or more; the limits must serve all of them.",
        min_length=1,
        max_length=MOST_MOVES,
    )
    requirements: RequirementsTable = Field(description="What the axis must achieve.")
    damping_optimal: DampingOptimalTable = Field(
        default_factory=DampingOptimalTable, description="The damping-optimal control."
    )
    control: ControlTable = Field(default_factory=ControlTable, description="The cascade.")
    today: TodayTable | None = optional("What the control holds now, to see before and after.", "")
    identified: IdentifiedTable | None = optional("What was measured; identify writes it.", "")

    @field_validator("schema_version", mode="before")
    @classmethod
    def _is_no_boolean(cls, value: object) -> object:
        if isinstance(value, bool):  # True == 1 in Python
            raise Faults([("", Message("schema-not-one", got=describe(value)))])
        return value

    @model_validator(mode="after")
    def _check(self, info: ValidationInfo) -> Self:
        faults: list[Misfit] = []
        spread = self.requirements.damping_spread
        most_damped = max(mode.damping_ratio for mode in self.plant.build().modes)
        largest = most_damped * (1.0 + spread)
        if largest >= 1.0:
            allowed = (ceil(100.0 * (1.0 / most_damped - 1.0)) - 1) / 100.0
            message = Message(
                "damping-spread-beyond-one", got=spread, largest=largest, allowed=allowed
            )
            faults.append(("requirements.damping_spread", message))
        if isinstance(self.drive, PositionSourceTable):
            faults += _list_needless(self, self.drive, context_of(info).axis)
        kind = KINDS[self.control.kind]
        if self.today and self.today.jerk and not kind.has_jerk_limit:
            message = Message("control-without-jerk-limit", control=kind.key)
            faults.append(("today.jerk", message))
        if self.today:
            faults += list_misfits(
                "today.setpoint_filter",
                self.today.setpoint_filter,
                kind,
                position_cycle=cycle_of(self.control),
            )
        raise_all(faults)
        return self


NEEDLESS_CONTROL = (
    "position_loop",
    "position_gain",
    "velocity_gain",
    "integral_time",
    "reference_model_time",
    "velocity_feedforward",
    "acceleration_feedforward",
    "jerk_feedforward",
    "feedforward_mass",
    "reference_delay",
    "tcp_sensor",
    "state_feedback",
    "force_filters",
    "minimum_bandwidth",
)
"""Keys of [control] that belong to a loop."""

NEEDLESS_TODAY = ("position_gain", "velocity_gain", "integral_time")

ACCELERATION = "F"
"""What the states call the acceleration of a motor that follows."""


def _list_needless(
    profile: ProfileTable, drive: PositionSourceTable, axis: AxisUnits
) -> list[Misfit]:
    """What a profile states that means nothing, or too much, where the motor follows."""
    faults: list[Misfit] = []
    if not isinstance(profile.plant, PLANT_TABLES[MOTOR_HELD]):
        faults.append(("plant.kind", Message("motor-held-needs-modes")))
    for name, keys in (("control", NEEDLESS_CONTROL), ("today", NEEDLESS_TODAY)):
        stated = getattr(profile, name).model_fields_set if getattr(profile, name) else ()
        faults += [(f"{name}.{key}", Message("no-loop-to-set")) for key in keys if key in stated]
    weights = profile.damping_optimal.weights
    if isinstance(weights, dict) and ACCELERATION in weights:
        faults.append((f"damping_optimal.weights.{ACCELERATION}", Message("acceleration-weighed")))
    for key in ("payload", "payload_radius"):
        if key in profile.requirements.model_fields_set:
            faults.append((f"requirements.{key}", Message("payload-of-position-source")))
    limit = drive.velocity_limit
    for place, move in enumerate(profile.moves):
        for key in ("velocity_step", "max_velocity"):
            velocity = getattr(move, key)
            if velocity is not None and velocity > limit:
                unit = axis.velocity.si
                message = Message("move-beyond-motor", got=velocity, limit=limit, unit=unit)
                faults.append((f"moves.{place}.{key}", message))
    return faults
