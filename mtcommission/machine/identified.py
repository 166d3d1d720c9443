"""What was measured on an axis, as [identified] of its profile states it for the sheet to print.

[plant] may be changed by hand beside it, and the sheet tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from mtcommission.controls.kind import SHAPERS
from mtcommission.machine import readers as of
from mtcommission.machine.keys import REQUIRED, Table, keyed
from mtcommission.machine.readers import IDENTIFIER, Array, AxisRange, Flag, Text, word_of

LONGEST_FILE = 400
"""Characters of a file's name."""

MOST_FILES = 200

MOST_MISFIT = 10.0
"""Weighted rms of the residuals by the noise beyond which a model does not describe a response."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A value and its standard error, in the same unit."""

    value: float
    sigma: float  # standard error of this measurement; what differs between machines is not in it

    @property
    def relative(self) -> float:
        """Standard error by value [-]."""
        return abs(self.sigma / self.value) if self.value else inf


def _pair(allowed: AxisRange) -> Array:
    """A value and its standard error."""
    return Array(allowed, 2, 2, lambda pair: Estimate(value=pair[0], sigma=pair[1]))


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredMode:
    """A mode as it was measured: [[identified.modes]], pairs of value and standard error."""

    name: str = keyed(IDENTIFIER, "Name of the mode.", "mode1", default="", left_out=REQUIRED)
    frequency_hz: Estimate = keyed(
        _pair(of.MEASURED_FREQUENCIES), "Eigenfrequency.", '["40 Hz", "0.05 Hz"]', key="frequency"
    )  # f [Hz]
    damping_ratio: Estimate = keyed(_pair(of.RATIOS), "Damping ratio.", "[0.03, 0.001]")  # ζ [-]
    measured_gain: Estimate | None = keyed(
        _pair(of.MODE_GAINS), "At the encoder.", '["1e-3 1/kg", "1e-5 1/kg"]', default=None
    )  # [1/kg]; None where no sensor with a force tells, like the next
    tcp_gain: Estimate | None = keyed(
        _pair(of.MODE_GAINS), "At the tool.", '["2e-3 1/kg", "2e-5 1/kg"]', default=None
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredFile:
    """A file that was read: [[identified.files]]."""

    name: str = keyed(Text(LONGEST_FILE), "File that was read.", "x.csv")
    sensor: str = keyed(word_of(("encoder", "tcp")), "Where its sensor sat.", "encoder")
    sha256: str = keyed(Text(64), "Of its bytes.", "64 hexadecimal digits")


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaperProposal:
    """What Klipper's calibrate_shaper would set: [[identified.calibrate_shaper]]."""

    shaper: str = keyed(word_of(SHAPERS), "Shaper.", "mzv")
    frequency_hz: float = keyed(of.FREQUENCIES, "Its frequency.", "45.2 Hz", key="frequency")
    vibration: float = keyed(of.SPREADS, "Share of the power it leaves.", "0.02")  # by its measure
    smoothing: float = keyed(
        of.BANDS, "How it rounds corners.", "0.1 mm"
    )  # at 5 m/s², likewise [m]
    max_acceleration: float = keyed(
        of.ACCELERATIONS, "At which it rounds them by 0.12 mm.", "11.7 m/s^2"
    )
    is_recommended: bool = keyed(
        Flag(), "Whether the script recommends it.", "true", key="recommended", default=False,
        left_out=REQUIRED
    )  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Identification:
    """[identified]: what was measured; pairs are value and standard error."""

    date: str = keyed(Text(10), "Day of the identification.", "2026-11-22")
    band_hz: tuple[float, float] | None = keyed(
        Array(of.MEASURED_FREQUENCIES, 2, 2),
        "Lines that were fitted.",
        '["2 Hz", "300 Hz"]',
        key="band",
        default=None,
    )
    misfit: float | None = keyed(
        of.SPREADS, "Weighted rms of the residuals by the noise.", "1.0", default=None
    )
    moving_mass: Estimate | None = keyed(
        _pair(of.MEASURED_MASSES), "Rigid mass.", '["800 kg", "2 kg"]', default=None
    )
    delay: Estimate | None = keyed(
        _pair(of.MEASURED_TIMES), "From set force to sensor.", '["0.4 ms", "2 us"]', default=None
    )
    lag: Estimate | None = keyed(
        _pair(of.MEASURED_TIMES), "First-order lag beside it.", '["0.6 ms", "5 us"]', default=None
    )
    evidence: str = keyed(
        Text(LONGEST_FILE),
        "File beside the profile with measured points and advice.",
        "machine.identified.json",
        default="",
    )
    checksum: str = keyed(Text(64), "Of that file's content.", "64 hexadecimal digits", default="")
    files: tuple[MeasuredFile, ...] = keyed(
        Array(Table(MeasuredFile), 0, MOST_FILES), "What was read.", default=()
    )
    modes: tuple[MeasuredMode, ...] = keyed(
        Array(Table(MeasuredMode), 0, MOST_FILES), "As measured.", default=()
    )
    proposals: tuple[ShaperProposal, ...] = keyed(
        Array(Table(ShaperProposal), 0, 8),
        "What Klipper's script would choose from the same files.",
        key="calibrate_shaper",
        default=(),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolSensor:
    """What measuring at the tool could free at most."""

    modes: tuple[str, ...]  # those whose share at the tool was assumed
    settling_time: float | None  # with the recommended limits [s]; None: not all are met
    least: float | None  # with limits for a tool at rest there [s]; None: not even then
