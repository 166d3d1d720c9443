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
    """Options of the command line, and what a profile says of the axis.

    Parameters
    ----------
    sensor
        ``--sensor``; None where it is not given. ``FILE@tcp`` goes before it.
    input
        ``--input``, one of ``INPUTS``; "" where it is not given.
    constant
        ``--constant``: force or torque per ampere or per unit of the file [SI]; None where it is
        not given.
    output
        ``--output``; None where it is not given.
    columns
        ``--columns NAME=COLUMN``: our names to those of the file, with a unit in brackets where
        the file has none; ``sample_time`` is a time.
    rotary
        Kind of the axis by its profile; None where no profile is given.
    motor_turn
        Angle of the motor per travel of the axis by its profile [rad/m]; 0 where it is not known.
    """

    sensor: Sensor | None = None
    input: str = ""
    constant: float | None = None
    output: Output | None = None
    columns: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    rotary: bool | None = None
    motor_turn: float = 0.0
