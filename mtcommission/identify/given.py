"""What is said about measured files: by the user, by a profile, by the files themselves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import pi
from types import MappingProxyType

from mtcommission.identify.measurement import (
    Sensor,
    Signal,
)
from mtcommission.machine.machine import Machine, Motion

INPUTS = ("force", "torque", "current", "acceleration")
"""Words of ``--input``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """Options of the command line, and what a profile says of the axis; None or "": not given."""

    sensor: Sensor | None = None  # ``--sensor``; ``FILE@tcp`` goes before it
    input: str = ""  # ``--input``, one of ``INPUTS``
    constant: float | None = None  # Force or torque per ampere, or per unit of the file [SI]
    output: Signal | None = None  # ``--output``
    # ``--columns NAME=COLUMN``: our names to those of the file, with a unit in brackets where the
    # file has none; ``sample_time`` is a time.
    columns: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    rotary: bool | None = None  # Kind of the axis by its profile
    motor_turn: float = 0.0  # Angle of the motor per travel of the axis [rad/m]; 0: not known

    def on(self, machine: Machine) -> Given:
        """Return it with what a machine's profile says of the axis."""
        drive, rotary = machine.drive, machine.motion is Motion.ROTARY
        turn = 2.0 * pi * drive.gear / drive.lead if drive.lead and not rotary else 0.0
        return replace(self, rotary=rotary, motor_turn=turn)

    def over(self, other: Given) -> Given:
        """Return it with what only the other one says of input, output and sensor."""
        return replace(
            self,
            sensor=self.sensor or other.sensor,
            input=self.input or other.input,
            output=self.output or other.output,
            constant=other.constant if self.constant is None else self.constant,
            motor_turn=self.motor_turn or other.motor_turn,
        )
