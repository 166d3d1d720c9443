"""What was measured on an axis, as its profile states it: estimates and where they come from."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A value and its standard error, in the same unit.

    Parameters
    ----------
    value
        Best estimate.
    sigma
        Standard error of this measurement; what differs between machines is not in it.
    """

    value: float
    sigma: float

    @property
    def relative(self) -> float:
        """Standard error by value [-]."""
        return abs(self.sigma / self.value) if self.value else inf


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredMode:
    """A mode as it was measured.

    Parameters
    ----------
    name
        As the profile calls it; "" where it has no name yet.
    frequency_hz, damping_ratio
        f [Hz] and ζ [-].
    measured_gain, tcp_gain
        Share at encoder and tool [1/kg]; None where no sensor with a force tells.
    """

    name: str = ""
    frequency_hz: Estimate
    damping_ratio: Estimate
    measured_gain: Estimate | None = None
    tcp_gain: Estimate | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredFile:
    """A file that was read.

    Parameters
    ----------
    name
        As it was given, with its label where a file holds several measurements.
    sensor
        "encoder" or "tcp".
    sha256
        Of its bytes, 64 hexadecimal digits.
    """

    name: str
    sensor: str
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaperProposal:
    """A shaper as Klipper's calibrate_shaper would set it.

    Parameters
    ----------
    shaper
        Kind of setpoint filter.
    frequency_hz
        [Hz].
    vibration
        Share of the measured power that it leaves, by that script's measure [-].
    smoothing
        By how much it rounds a corner at 5 m/s^2, by the same measure [m].
    max_acceleration
        At which that is 0.12 mm [m/s^2].
    is_recommended
        Whether the script would recommend this one.
    """

    shaper: str
    frequency_hz: float
    vibration: float
    smoothing: float
    max_acceleration: float
    is_recommended: bool = False


MOST_MISFIT = 10.0
"""Weighted rms of the residuals by the noise beyond which a model does not describe a response."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Identification:
    """What was measured when the profile was written; values may have been changed since.

    Parameters
    ----------
    date
        Day, ISO 8601.
    files
        From which it comes.
    band_hz
        Lowest and highest line that was fitted [Hz]; None where nothing was fitted.
    misfit
        Weighted rms of the residuals by the noise [-]; None where it is not known.
    moving_mass, delay, lag
        [kg, s, s]; None where nothing tells.
    modes
        By frequency.
    evidence
        Name of the file beside the profile with points and advice; "" for none.
    checksum
        Of that file's content.
    proposals
        What Klipper's calibrate_shaper would choose from the same files; empty where it could not.
    """

    date: str
    files: tuple[MeasuredFile, ...]
    band_hz: tuple[float, float] | None
    misfit: float | None
    moving_mass: Estimate | None
    delay: Estimate | None
    lag: Estimate | None
    modes: tuple[MeasuredMode, ...]
    evidence: str
    checksum: str
    proposals: tuple[ShaperProposal, ...] = ()
