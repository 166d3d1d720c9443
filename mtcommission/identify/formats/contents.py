"""What a file holds, before anybody has said what its columns mean."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message, Value
from mtcommission.identify.measurement import AllDirections, Array, ComplexArray, Given, Sensor

Lines = NDArray[np.int64]

NO_LINES: Lines = np.zeros(0, dtype=np.int64)
"""Of a file without lines."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Column:
    """A series of numbers with the name and unit that the file gives it, "" where it has none."""

    name: str
    unit: str
    values: Array  # Shape (n,), in that unit
    sensor: Sensor | None = None  # Where it was seen, if the format fixes it


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimeContents:
    """Columns over time."""

    label: str = ""  # Which record of the file it is; "" for the only one
    clock: Array | None = None  # Times of the samples, shape (n,) [s]; None where the file has none
    sample_time: float = 0.0  # Step where ``clock`` is None [s]; 0 where the file states none
    columns: tuple[Column, ...]  # All but the clock
    lines: Lines = field(default_factory=lambda: NO_LINES)  # Of each sample, shape (n,) or empty


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResponseContents:
    """A complex response by frequency."""

    label: str = ""  # Which response of the file it is; "" for the only one
    frequency_hz: Array  # Shape (n_lines,)
    values: ComplexArray  # Shape (n_lines,), in the unit of the file
    unit: str = ""  # Output per input, e.g. ``"rad/s/A"``; "" where the file has none
    scale: float | None = None  # SI value of one unit of the file; None: the unit tells
    rotary: bool | None = None  # Whether angles and torques are meant; None: the unit tells
    said: Given = field(default_factory=Given)  # What the format tells of input, output, sensor
    # coherence, averages, resolution_hz: As in ``FrequencyResponse``.
    coherence: Array | None = None
    averages: float | None = None
    resolution_hz: float | None = None
    lines: Lines = field(default_factory=lambda: NO_LINES)  # Of each value, (n_lines,) or empty


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpectrumContents:
    """Power of an acceleration by frequency."""

    label: str  # Which spectrum of the file it is
    frequency_hz: Array  # Shape (n_lines,)
    density: Array  # Shape (n_lines,), in the unit of the file
    resolution_hz: float | None  # As in ``Spectrum``
    lines: Lines  # Line of each value in the file, shape (n_lines,)
    all_directions: AllDirections  # As in ``Spectrum``


Item = TimeContents | ResponseContents | SpectrumContents


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FileContents:
    """A file, read."""

    format: Message  # Its name, to be shown
    items: tuple[Item, ...]  # What it holds, at least one
    measured_on: str = ""  # ISO date; "" where the file has none
    state: str = ""  # State of the machine that the file names; "" where it names none
    said: Given = field(default_factory=Given)  # What its comments say of input, output, sensor
    remarks: tuple[Message, ...] = ()  # What was left out, and what the file says that matters


def refuse(
    where: str, kind: str, /, *, line: int = 0, key: str = "", **values: Value
) -> InputError:
    """Return the error of a file that cannot be used, to be raised."""
    return InputError([Fault(where=where, line=line, key=key, message=Message(kind, **values))])


def broken(kind: str, /, *, line: int = 0, **values: Value) -> InputError:
    """Return the error of a file whose name the caller knows: he reads it ``within``."""
    return InputError([Fault(where="", line=line, message=Message(kind, **values))])


@contextmanager
def within(where: str) -> Iterator[None]:
    """Give a file's name to the faults that are found in it."""
    try:
        yield
    except InputError as error:
        faults = [replace(one, where=one.where or where) for one in error.faults]
        raise InputError(faults) from error
