"""[drive]: the motor as the axis feels it, a servo or one that follows its setpoint."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import ROTARY, AxisUnits
from mtcommission.machine import readers as of
from mtcommission.machine.keys import ELSEWHERE, ByKind, Misfit, Table, keyed
from mtcommission.machine.mechanics import SOURCE
from mtcommission.machine.moves import Move, largest_velocity
from mtcommission.machine.readers import Array, as_typed


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """[drive]: the motor as the axis feels it.

    A position source follows its setpoint whatever force that takes. What drives the plant is
    then its acceleration: that stands for every force here, in m/s², and the moving mass is 1.
    """

    follows: bool = False  # whether the motor follows its setpoint, without a loop to tune
    force_lag: float = keyed(of.LAGS, "Time constant of the force loop, T.", "2.5 ms")
    """[s]; 0 of a position source."""
    max_force: float = keyed(of.FORCES, "Largest force, F_max.", "2 kN")
    max_velocity: float = inf  # of a position source, by step rate or torque [m/s]; inf: none
    force_velocity: float | None = None
    """Velocity at which ``max_force`` was read off the motor's curve [m/s]; None: it was stated."""
    continuous_force: float = keyed(
        of.FORCES, "Thermal (RMS) limit over move and dwell.", "1 kN", default=inf
    )
    static_load: float = keyed(
        of.STATIC_LOADS,
        "Weight or process force; its amount is not available for motion.",
        "0 N",
        default=0.0,
    )
    coulomb_friction: float = keyed(
        of.FRICTIONS,
        "Friction that any motion must overcome; not available for motion.",
        "0 N",
        default=0.0,
    )
    viscous_friction: float = keyed(
        of.DAMPINGS,
        "Friction per velocity, on the line of the drive.",
        "0 N s/m",
        default=0.0,
    )
    lead: float | None = keyed(
        of.LEADS,
        "Travel of a linear axis per turn of screw or pinion; left out: linear motor, or unknown.",
        "10 mm",
        default=None,
    )
    gear: float = keyed(
        of.GEARS,
        "Turns of the motor per turn of screw, pinion or rotary axis.",
        "1",
        default=1.0,
    )
    encoder_resolution: float = keyed(
        of.RESOLUTIONS,
        "Smallest step of the measured position.",
        "0.1 um",
        default=0.0,
    )  # 0: not stated

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
            most, got = as_typed(stated.get("max_force"), self.max_force, unit), self.static_load
            yield "static_load", Message("static-load-takes-all", got=got, unit=unit, most=most)
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

    velocity: float = keyed(of.VELOCITIES, "Of the axis.", "0.2 m/s")
    acceleration: float = keyed(
        of.ACCELERATIONS, "That the motor follows at this velocity.", "8 m/s^2"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionSource:
    """[drive] with a motor that follows its setpoint."""

    max_acceleration: float = keyed(
        of.ACCELERATIONS, "Largest acceleration that the motor follows.", "10 m/s^2"
    )
    max_velocity: float = keyed(
        of.VELOCITIES, "Largest velocity that the motor follows.", "0.5 m/s", default=inf
    )
    acceleration_curve: tuple[CurvePoint, ...] = keyed(
        Array(Table(CurvePoint), 2, 1000),
        "Acceleration that the torque leaves at rising velocities, straight between them; none "
        "beyond the last.",
        default=(),
    )
    step_rate: float = keyed(
        of.STEP_RATES, "Steps per second that the control sends at most.", "100 kHz", default=inf
    )
    step_length: float = keyed(
        of.RESOLUTIONS, "Travel per (micro)step: 1 mm by the steps per mm.", "12.5 um", default=inf
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
            follows=True,
            force_lag=0.0,
            max_force=left,
            max_velocity=limit,
            force_velocity=fastest if curve else None,
        )


DRIVES = ByKind(
    lambda _: {"servo": Drive, SOURCE: PositionSource}, "How the motor moves the axis.", "servo"
)

ELSEWHERE[Drive], ELSEWHERE[PositionSource] = (PositionSource, SOURCE), (Drive, "servo")
