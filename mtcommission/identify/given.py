"""What the user says about measured files where they do not say it themselves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from mtcommission.identify.measurement import Output, Sensor

INPUTS = ("force", "torque", "current", "acceleration")
"""Words of ``--input``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """Options of the command line, and what a profile says of the axis."""

    # ``--sensor``; None where it is not given. ``FILE@tcp`` goes before it.
    sensor: Sensor | None = None
    input: str = ""  # ``--input``, one of ``INPUTS``; "" where it is not given
    # ``--constant``: force or torque per ampere or per unit of the file [SI]; None where it is not
    # given.
    constant: float | None = None
    output: Output | None = None  # ``--output``; None where it is not given
    # ``--columns NAME=COLUMN``: our names to those of the file, with a unit in brackets where the
    # file has none; ``sample_time`` is a time.
    columns: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    rotary: bool | None = None  # Kind of the axis by its profile; None where no profile is given
    # Angle of the motor per travel of the axis by its profile [rad/m]; 0 where it is not known.
    motor_turn: float = 0.0
