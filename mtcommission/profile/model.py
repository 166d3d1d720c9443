"""The keys of a profile: what each means, what is allowed, and what must fit together.

The classes mirror the TOML tables one to one. A key that may be left out is None here; what
that means is decided where the Machine is built.
"""

from __future__ import annotations

from math import ceil
from typing import Annotated, Literal, Self

from pydantic import (
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from mtcommission.control_kinds.kinds import KINDS
from mtcommission.machine.machine import Requirements
from mtcommission.machine.mechanics import Misfit
from mtcommission.machine.ranges import (
    ARMS,
    BANDS,
    DISTANCES,
    DWELLS,
    LOADS,
    SHARES,
    SPREADS,
    TIMES,
    VELOCITIES,
)
from mtcommission.messages.message import Message
from mtcommission.profile.control_tables import ControlTable, TodayTable, cycle_of
from mtcommission.profile.drive_tables import AnyDrive, PositionSourceTable
from mtcommission.profile.filter_tables import (
    list_misfits,
)
from mtcommission.profile.identified_tables import IdentifiedTable
from mtcommission.profile.plant_tables import MOTOR_HELD, PLANT_TABLES, AnyKind, PlantTable
from mtcommission.profile.table import Table, keyed_table, optional, raise_all, required
from mtcommission.profile.values import (
    Faults,
    Name,
    PerSignal,
    Read,
    SignalTable,
    context_of,
    describe,
)
from mtcommission.units.axis_units import AxisUnits

MOST_MOVES = 50
MOST_ASSUMED = 300
LARGEST_FREQUENCY_SPREAD = 0.5


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


BOUNDS = keyed_table("BoundsTable", Requirements)
"""Those keys of [requirements] that the machine takes as they are, each declared there."""


class RequirementsTable(BOUNDS):  # type: ignore[misc, valid-type]
    """[requirements]."""

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
