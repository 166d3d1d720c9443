"""What a file holds, before anybody has said what its columns mean."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import Fault, InputError
from mtcommission.identify.measurement import (
    AllDirections,
    Array,
    ComplexArray,
    Output,
    Sensor,
)
from mtcommission.messages.message import Message, Value

Lines = NDArray[np.int64]

NO_LINES: Lines = np.zeros(0, dtype=np.int64)
"""Of a file without lines."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Column:
    """A series of numbers with the name and unit that the file gives it."""

    # name, unit: As they stand there; "" where there is none.
    name: str
    unit: str
    values: Array  # Shape (n,), in that unit
    sensor: Sensor | None = None  # Where it was seen, if the format fixes it


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimeContents:
    """Columns over time."""

    label: str = ""  # Which record of the file it is; "" for the only one
    clock: Array | None = None  # Times of the samples, shape (n,) [s]; None where the file has none
    # Step of the clock [s] where ``clock`` is None; 0 where the file states none.
    sample_time: float = 0.0
    columns: tuple[Column, ...]  # All but the clock
    lines: Lines  # Line of each sample in the file, shape (n,) or empty


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResponseContents:
    """A complex response by frequency."""

    label: str = ""  # Which response of the file it is; "" for the only one
    # frequency_hz, values: Shape (n_lines,) [Hz; unit of the file].
    frequency_hz: Array
    values: ComplexArray
    unit: str = ""  # Output per input, e.g. ``"rad/s/A"``; "" where the file has none.
    # SI value of one unit of the file, if the format fixes it; else the unit tells.
    scale: float | None = None
    # input, output, sensor: If the format tells, else "" or None; input as on the command line.
    input: str = ""
    output: Output | None = None
    sensor: Sensor | None = None
    # Whether angles and torques are meant; None where only the unit tells.
    rotary: bool | None = None
    # Angle of the motor per travel of a linear axis [rad/m]; 0 where the file has none.
    motor_turn: float = 0.0
    # coherence, averages, resolution_hz: As in ``FrequencyResponse``.
    coherence: Array | None = None
    averages: float | None = None
    resolution_hz: float | None = None
    lines: Lines  # Line of each value in the file, shape (n_lines,) or empty


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpectrumContents:
    """Power of an acceleration by frequency."""

    label: str  # Which spectrum of the file it is
    # frequency_hz, density: Shape (n_lines,) [Hz; unit of the file].
    frequency_hz: Array
    density: Array
    resolution_hz: float | None  # As in ``Spectrum``
    lines: Lines  # Line of each value in the file, shape (n_lines,)
    all_directions: AllDirections | None = None  # As in ``Spectrum``


Item = TimeContents | ResponseContents | SpectrumContents


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FileContents:
    """A file, read."""

    format: Message  # Its name, to be shown
    items: tuple[Item, ...]  # What it holds, at least one
    measured_on: str = ""  # ISO date; "" where the file has none
    state: str = ""  # State of the machine that the file names; "" where it names none
    # What the file says where the command line may say it: sensor, input, output, constant.
    said: tuple[tuple[str, str], ...] = ()
    remarks: tuple[Message, ...] = ()  # What was left out, and what the file says that matters


def refuse(
    where: str, kind: str, /, *, line: int = 0, key: str = "", **values: Value
) -> InputError:
    """Return the error of a file that cannot be used, to be raised."""
    return InputError([Fault(where=where, line=line, key=key, message=Message(kind, **values))])
