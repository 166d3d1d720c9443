"""What was measured: in SI, and before that as files hold it, in their own names and units.

Readers and estimators make these, the fit takes them; nothing here knows a file format.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import StrEnum
from math import pi
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message, Value
from mtcommission.machine.identified import MeasuredMode
from mtcommission.machine.machine import Machine, Motion

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

LEAST_COHERENCE = 1e-4
"""Below it a line says nothing; keeps its standard error finite."""


class Signal(StrEnum):
    """What is measured, and what excites the axis; the value is the name on the command line."""

    FORCE = "force"
    TORQUE = "torque"
    CURRENT = "current"
    REFERENCE = "reference"
    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"

    @property
    def derivative(self) -> int:
        """Power of s by which a motion differs from the position."""
        return MOTIONS.index(self)


FORCES = (Signal.FORCE, Signal.TORQUE, Signal.CURRENT)
MOTIONS = (Signal.POSITION, Signal.VELOCITY, Signal.ACCELERATION)


class Sensor(StrEnum):
    """Where a sensor sits."""

    ENCODER = "encoder"
    TCP = "tcp"


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Where a measurement comes from."""

    file: str  # Name as it was given
    sha256: str  # Of the file's bytes, 64 hexadecimal digits
    # Which of the file's measurements it is, in the file's words; "" where it has one.
    label: str = ""
    # Whether it is what Klipper's resonance test recorded: its script takes the spectrum of it all.
    is_klipper_raw: bool = False
    measured_on: str = ""  # Date in the file, ISO 8601; "" where it has none
    # State of the machine that the file names (position, payload, level); "" where it names none.
    state: str = ""

    @property
    def name(self) -> str:
        """File and label, to be shown."""
        return f"{self.file} [{self.label}]" if self.label else self.file


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyResponse:
    """Output per input of one sensor, line by line."""

    source: Source  # File and label
    frequency_hz: Array  # Shape (n_lines,), increasing, positive [Hz]
    values: ComplexArray  # Shape (n_lines,), complex [SI of output / SI of input]
    coherence: Array | None  # Shape (n_lines,), above 0 to 1; None where it is not known
    # Independent averages that the coherence belongs to; None where they are not known.
    averages: float | None
    # Width of the window's main lobe, in which a narrower mode is smeared [Hz]; 0 for periodic
    # excitation without leakage, None where the file does not say.
    resolution_hz: float | None
    input: Signal  # A force, or an acceleration; current times its constant is a force
    output: Signal  # A motion
    sensor: Sensor
    rotary: bool  # Whether lengths are angles [rad], forces torques [N m]
    remarks: tuple[Message, ...] = ()  # How it was estimated, what was assumed and what is doubtful

    @property
    def relative_error(self) -> Array | None:
        """Standard error of real and of imaginary part by |H|, √((1 - γ²)/(2 n γ²)), (n_lines,).

        n = 1 where the averages are not known; None where the coherence is not.

        Source: Bendat, Piersol, Random Data, 4th ed., eq. (9.90), for small errors.
        """
        if self.coherence is None:
            return None
        gamma2 = np.clip(self.coherence, LEAST_COHERENCE, 1.0)
        return np.sqrt((1.0 - gamma2) / (2.0 * (self.averages or 1.0) * gamma2))

    def say(self, *remarks: Message) -> FrequencyResponse:
        """Return it with further remarks."""
        return replace(self, remarks=(*self.remarks, *remarks))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AllDirections:
    """Power of all directions of an accelerometer together, which Klipper judges."""

    # frequency_hz, density: Shape (n_lines,), with the line at 0 Hz [Hz; its scale means nothing].
    frequency_hz: Array
    density: Array
    is_divided: bool  # Whether it is divided by frequency already


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spectrum:
    """Power of a signal by frequency: no phase, no force."""

    source: Source  # File and label
    frequency_hz: Array  # Shape (n_lines,), increasing, positive [Hz]
    density: Array  # Shape (n_lines,), power per Hz; its scale means nothing
    resolution_hz: float | None  # As in ``FrequencyResponse``
    sensor: Sensor
    rotary: bool  # Whether lengths are angles
    remarks: tuple[Message, ...] = ()  # How it was estimated, what was assumed and what is doubtful
    # For Klipper's own criterion; None where it is not Klipper's measurement.
    all_directions: AllDirections | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeVibration:
    """What rings after a step or the end of a move: frequencies and damping, no mass, no gain."""

    source: Source  # File and label
    sensor: Sensor
    rotary: bool  # Whether lengths are angles
    modes: tuple[MeasuredMode, ...]  # By frequency, without gains
    remarks: tuple[Message, ...] = ()  # How they were found and what is doubtful


Finding = FrequencyResponse | Spectrum | FreeVibration


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Channel:
    """One column of a time record, evenly sampled."""

    name: str  # In the file
    signal: Signal  # What it is
    sensor: Sensor | None  # Where it was seen; None for what no sensor shows (force, reference)
    rotary: bool | None  # Whether lengths are angles; None where the unit does not tell
    start: float  # Time of the first sample [s]
    step: float  # Of the clock [s]
    values: Array  # Shape (n_samples,) [SI]
    error: float = 0.0  # What interpolation to an even clock may have added [SI]

    @property
    def t(self) -> Array:
        """Times of the samples, shape (n_samples,) [s]."""
        return self.start + self.step * np.arange(self.values.size, dtype=np.float64)

    def between(self, begin: float, end: float) -> tuple[Array, Array]:
        """Return times and values from a time up to another one."""
        t, slack = self.t, 1e-6 * self.step
        inside = slice(*np.searchsorted(t, [begin - slack, end + slack]).tolist())
        return t[inside], self.values[inside]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimeRecord:
    """Signals over time, evenly sampled."""

    source: Source  # File and label
    channels: tuple[Channel, ...]  # Of one clock and equal length, forces first; currents as these
    remarks: tuple[Message, ...] = ()  # What was done to it (resampled) and what is doubtful

    @property
    def sample_time(self) -> float:
        """Step of the clock [s]."""
        return self.channels[0].step

    @property
    def size(self) -> int:
        """Number of samples."""
        return int(self.channels[0].values.size)

    @property
    def force(self) -> Channel | None:
        """The force, torque or current that acts; None where none was recorded."""
        return next((one for one in self.channels if one.signal in FORCES), None)

    @property
    def reference(self) -> Array | None:
        """Setpoint of a motion, or an excitation; None where none was recorded."""
        found = (one.values for one in self.channels if one.signal is Signal.REFERENCE)
        return next(found, None)

    def source_of(self, channel: Channel) -> Source:
        """Return where one of its channels comes from."""
        label = " ".join(part for part in (self.source.label, channel.name) if part)
        return replace(self.source, label=label)


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """Everything that some files say about an axis, in the order given."""

    findings: tuple[Finding, ...]
    records: tuple[TimeRecord, ...] = ()  # Some of them come from these, to be simulated again

    @property
    def responses(self) -> tuple[FrequencyResponse, ...]:
        """Those with a force, or the motor's acceleration, as input."""
        return tuple(one for one in self.findings if isinstance(one, FrequencyResponse))


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

    items: tuple[Item, ...]  # What it holds, at least one
    is_klipper_raw: bool = False  # accelerations of Klipper's resonance test
    measured_on: str = ""  # ISO date; "" where the file has none
    state: str = ""  # State of the machine that the file names; "" where it names none
    said: Given = field(default_factory=Given)  # What its comments say of input, output, sensor
    remarks: tuple[Message, ...] = ()  # What was left out, and what the file says that matters


def refuse(where: str, kind: str, /, **values: Value) -> InputError:
    """Return the error of a file that cannot be used, to be raised."""
    return InputError.at(where, Message(kind, **values))


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
