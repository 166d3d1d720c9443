"""[drive] of a profile: a force behind a loop, or a motor that follows its setpoint."""

from __future__ import annotations

from itertools import pairwise
from math import inf
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import (
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    model_validator,
)

from mtcommission.machine.mechanics import Misfit
from mtcommission.machine.ranges import (
    ACCELERATIONS,
    DAMPINGS,
    FORCES,
    FRICTIONS,
    GEARS,
    LAGS,
    LEADS,
    RESOLUTIONS,
    STATIC_LOADS,
    STEP_RATES,
    VELOCITIES,
)
from mtcommission.messages.message import Message
from mtcommission.profile.table import Table, optional, raise_all, required
from mtcommission.profile.values import (
    Read,
    context_of,
)
from mtcommission.units.axis_units import ROTARY

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
