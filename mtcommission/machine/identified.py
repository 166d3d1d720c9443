"""What was measured on an axis, as its profile states it: estimates and where they come from."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A value and its standard error, in the same unit."""

    value: float
    sigma: float  # standard error of this measurement; what differs between machines is not in it

    @property
    def relative(self) -> float:
        """Standard error by value [-]."""
        return abs(self.sigma / self.value) if self.value else inf


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredMode:
    """A mode as it was measured."""

    name: str = ""  # as the profile calls it; "" where it has no name yet
    frequency_hz: Estimate  # f [Hz]
    damping_ratio: Estimate  # ζ [-]
    measured_gain: Estimate | None = None
    """Share at the encoder [1/kg]; None where no sensor with a force tells."""
    tcp_gain: Estimate | None = None  # share at the tool [1/kg]; likewise


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredFile:
    """A file that was read."""

    name: str  # as it was given, with its label where a file holds several measurements
    sensor: str  # "encoder" or "tcp"
    sha256: str  # of its bytes, 64 hexadecimal digits


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaperProposal:
    """A shaper as Klipper's calibrate_shaper would set it."""

    shaper: str  # kind of setpoint filter
    frequency_hz: float
    vibration: float  # share of the measured power that it leaves, by that script's measure [-]
    smoothing: float  # by how much it rounds a corner at 5 m/s², by the same measure [m]
    max_acceleration: float  # at which that is 0.12 mm [m/s²]
    is_recommended: bool = False  # whether the script would recommend this one


MOST_MISFIT = 10.0
"""Weighted rms of the residuals by the noise beyond which a model does not describe a response."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Identification:
    """What was measured when the profile was written; values may have been changed since."""

    date: str  # day, ISO 8601
    files: tuple[MeasuredFile, ...]  # from which it comes
    band_hz: tuple[float, float] | None  # lowest and highest fitted line [Hz]; None: nothing fitted
    misfit: float | None  # weighted rms of the residuals by the noise [-]; None: not known
    moving_mass: Estimate | None  # [kg]; None where nothing tells, like the two below
    delay: Estimate | None  # [s]
    lag: Estimate | None  # [s]
    modes: tuple[MeasuredMode, ...]  # by frequency
    evidence: str  # name of the file beside the profile with points and advice; "" for none
    checksum: str  # of that file's content
    proposals: tuple[ShaperProposal, ...] = ()
    """What Klipper's calibrate_shaper would choose from the same files; empty: it could not."""
