"""What was measured, in SI: frequency responses, spectra, free vibrations, time records.

Readers and estimators make these, the fit takes them; nothing here knows a file format.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.messages.message import Message

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

LEAST_COHERENCE = 1e-4
"""Below it a line says nothing; keeps its standard error finite."""


class Input(StrEnum):
    """What excites the axis; current times its constant is a force."""

    FORCE = "force"
    ACCELERATION = "acceleration"


class Output(StrEnum):
    """What a sensor shows; the value is the name on the command line."""

    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"

    @property
    def derivative(self) -> int:
        """Power of s by which it differs from the position."""
        return (Output.POSITION, Output.VELOCITY, Output.ACCELERATION).index(self)


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
    format: Message  # Message that names the format
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
    # input, output, sensor: What was applied and seen, and where.
    input: Input
    output: Output
    sensor: Sensor
    rotary: bool  # Whether lengths are angles [rad], forces torques [N m]
    remarks: tuple[Message, ...] = ()  # How it was estimated, what was assumed and what is doubtful

    @property
    def standard_error(self) -> Array | None:
        """Standard error of real and of imaginary part, |H| √((1 - γ²)/(2 n γ²)), shape (n_lines,).

        None where coherence or averages are not known.

        Source: Bendat, Piersol, Random Data, 4th ed., eq. (9.90), for small errors.
        """
        if self.coherence is None or self.averages is None:
            return None
        gamma2 = np.clip(self.coherence, LEAST_COHERENCE, 1.0)
        error: Array = np.abs(self.values) * np.sqrt((1.0 - gamma2) / (2 * self.averages * gamma2))
        return error


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
    # resolution_hz, averages: As in ``FrequencyResponse``.
    resolution_hz: float | None
    averages: float | None
    # output, sensor, rotary: What was seen, and where.
    output: Output
    sensor: Sensor
    rotary: bool
    remarks: tuple[Message, ...] = ()  # How it was estimated, what was assumed and what is doubtful
    # For Klipper's own criterion; None where it is not Klipper's measurement.
    all_directions: AllDirections | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeMode:
    """One vibration that dies away."""

    # frequency_hz, frequency_sigma_hz: Natural frequency and its standard error [Hz].
    frequency_hz: float
    frequency_sigma_hz: float
    # damping_ratio, damping_sigma: ζ and its standard error [-].
    damping_ratio: float
    damping_sigma: float
    amplitude: float  # At the start of the free vibration [SI of the sensor's output]


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeVibration:
    """What rings after a step or the end of a move: frequencies and damping, no mass, no gain."""

    source: Source  # File and label
    # output, sensor, rotary: What was seen, and where.
    output: Output
    sensor: Sensor
    rotary: bool
    modes: tuple[FreeMode, ...]  # Found, the largest amplitude first
    remarks: tuple[Message, ...] = ()  # How they were found and what is doubtful

    @property
    def estimates(self) -> list[MeasuredMode]:
        """The modes by frequency."""
        return [
            MeasuredMode(
                frequency_hz=Estimate(value=mode.frequency_hz, sigma=mode.frequency_sigma_hz),
                damping_ratio=Estimate(value=mode.damping_ratio, sigma=mode.damping_sigma),
            )
            for mode in sorted(self.modes, key=lambda mode: mode.frequency_hz)
        ]


Finding = FrequencyResponse | Spectrum | FreeVibration


class Signal(StrEnum):
    """What a column of a time record holds."""

    FORCE = "force"
    TORQUE = "torque"
    CURRENT = "current"
    REFERENCE = "reference"
    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"


FORCES = (Signal.FORCE, Signal.TORQUE, Signal.CURRENT)
MOTIONS = (Signal.POSITION, Signal.VELOCITY, Signal.ACCELERATION)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Channel:
    """One column of a time record."""

    name: str  # In the file
    signal: Signal  # What it is
    sensor: Sensor | None  # Where it was seen; None for what no sensor shows (force, reference)
    rotary: bool | None  # Whether lengths are angles; None where the unit does not tell
    values: Array  # Shape (n_samples,) [SI]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimeRecord:
    """Signals over time, evenly sampled."""

    source: Source  # File and label
    sample_time: float  # Step of the clock [s]
    channels: tuple[Channel, ...]  # Of equal length
    remarks: tuple[Message, ...] = ()  # What was done to it (resampled) and what is doubtful

    @property
    def size(self) -> int:
        """Number of samples."""
        return int(self.channels[0].values.size)

    @property
    def t(self) -> Array:
        """Times from 0, shape (n_samples,) [s]."""
        return self.sample_time * np.arange(self.size, dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """Everything that some files say about an axis."""

    # responses, spectra, vibrations: By file, in the order given.
    responses: tuple[FrequencyResponse, ...]
    spectra: tuple[Spectrum, ...]
    vibrations: tuple[FreeVibration, ...]
    # Time records from which some of them come, to be simulated again.
    records: tuple[TimeRecord, ...]

    @property
    def measurements(self) -> tuple[Finding, ...]:
        """Everything that was measured, in the order of the files within each kind."""
        return (*self.responses, *self.spectra, *self.vibrations)
