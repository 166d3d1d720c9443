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
    """A series of numbers with the name and unit that the file gives it.

    Parameters
    ----------
    name, unit
        As they stand there; "" where there is none.
    values
        Shape (n,), in that unit.
    sensor
        Where it was seen, if the format fixes it.
    """

    name: str
    unit: str
    values: Array
    sensor: Sensor | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimeContents:
    """Columns over time.

    Parameters
    ----------
    label
        Which record of the file it is; "" for the only one.
    clock
        Times of the samples, shape (n,) [s]; None where the file has none.
    sample_time
        Step of the clock [s] where ``clock`` is None; 0 where the file states none.
    columns
        All but the clock.
    lines
        Line of each sample in the file, shape (n,) or empty.
    """

    label: str = ""
    clock: Array | None = None
    sample_time: float = 0.0
    columns: tuple[Column, ...]
    lines: Lines


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResponseContents:
    """A complex response by frequency.

    Parameters
    ----------
    label
        Which response of the file it is; "" for the only one.
    frequency_hz, values
        Shape (n_lines,) [Hz; unit of the file].
    unit
        Output per input, e.g. ``"rad/s/A"``; "" where the file has none.
    scale
        SI value of one unit of the file, if the format fixes it; else the unit tells.
    input, output, sensor
        If the format tells, else "" or None; input as on the command line.
    rotary
        Whether angles and torques are meant; None where only the unit tells.
    motor_turn
        Angle of the motor per travel of a linear axis [rad/m]; 0 where the file has none.
    coherence, averages, resolution_hz
        As in ``FrequencyResponse``.
    lines
        Line of each value in the file, shape (n_lines,) or empty.
    """

    label: str = ""
    frequency_hz: Array
    values: ComplexArray
    unit: str = ""
    scale: float | None = None
    input: str = ""
    output: Output | None = None
    sensor: Sensor | None = None
    rotary: bool | None = None
    motor_turn: float = 0.0
    coherence: Array | None = None
    averages: float | None = None
    resolution_hz: float | None = None
    lines: Lines


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpectrumContents:
    """Power of an acceleration by frequency.

    Parameters
    ----------
    label
        Which spectrum of the file it is.
    frequency_hz, density
        Shape (n_lines,) [Hz; unit of the file].
    resolution_hz
        As in ``Spectrum``.
    lines
        Line of each value in the file, shape (n_lines,).
    all_directions
        As in ``Spectrum``.
    """

    label: str
    frequency_hz: Array
    density: Array
    resolution_hz: float | None
    lines: Lines
    all_directions: AllDirections | None = None


Item = TimeContents | ResponseContents | SpectrumContents


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FileContents:
    """A file, read.

    Parameters
    ----------
    format
        Its name, to be shown.
    items
        What it holds, at least one.
    measured_on
        ISO date; "" where the file has none.
    state
        State of the machine that the file names; "" where it names none.
    said
        What the file says where the command line may say it: sensor, input, output, constant.
    remarks
        What was left out, and what the file says that matters.
    """

    format: Message
    items: tuple[Item, ...]
    measured_on: str = ""
    state: str = ""
    said: tuple[tuple[str, str], ...] = ()
    remarks: tuple[Message, ...] = ()


def refuse(
    where: str, kind: str, /, *, line: int = 0, key: str = "", **values: Value
) -> InputError:
    """Return the error of a file that cannot be used, to be raised."""
    return InputError([Fault(where=where, line=line, key=key, message=Message(kind, **values))])
