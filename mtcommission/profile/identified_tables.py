"""[identified] of a profile: what was measured, with standard errors, for the sheet to print.

It states what the measurement said; [plant] may be changed by hand beside it, and the sheet tells.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from mtcommission.control_kinds.kind import SHAPERS
from mtcommission.machine.identified import (
    Estimate,
    Identification,
    MeasuredFile,
    MeasuredMode,
    ShaperProposal,
)
from mtcommission.machine.ranges import (
    ACCELERATIONS,
    BANDS,
    FREQUENCIES,
    MEASURED_FREQUENCIES,
    MEASURED_MASSES,
    MEASURED_TIMES,
    MODE_GAINS,
    RATIOS,
    SPREADS,
)
from mtcommission.profile.table import Table, optional, required
from mtcommission.profile.values import Name, Read

_PAIR = Field(min_length=2, max_length=2)
Masses = Annotated[list[Annotated[float, Read(MEASURED_MASSES)]], _PAIR]
Times = Annotated[list[Annotated[float, Read(MEASURED_TIMES)]], _PAIR]
Frequencies = Annotated[list[Annotated[float, Read(MEASURED_FREQUENCIES)]], _PAIR]
Ratios = Annotated[list[Annotated[float, Read(RATIOS)]], _PAIR]
Gains = Annotated[list[Annotated[float, Read(MODE_GAINS)]], _PAIR]
Hash = Annotated[str, Name(longest=64)]

ShaperName: Any = Literal[SHAPERS]

LONGEST_FILE = 400
"""Characters of a file's name."""
MOST_FILES = 200


class MeasuredFileTable(Table):
    """[[identified.files]]."""

    name: Annotated[str, Name(longest=LONGEST_FILE)] = required("File that was read.", '"x.csv"')
    sensor: Literal["encoder", "tcp"] = required("Where its sensor sat.", '"encoder"')
    sha256: Hash = required("Of its bytes.", '"64 hexadecimal digits"')


class MeasuredModeTable(Table):
    """[[identified.modes]]; pairs of value and standard error."""

    name: Annotated[str, Name(is_identifier=True)] = required("Name of the mode.", '"mode1"')
    frequency: Frequencies = required("Eigenfrequency.", '["40 Hz", "0.05 Hz"]')
    damping_ratio: Ratios = required("Damping ratio.", "[0.03, 0.001]")
    measured_gain: Gains | None = optional("At the encoder.", '["1e-3 1/kg", "1e-5 1/kg"]')
    tcp_gain: Gains | None = optional("At the tool.", '["2e-3 1/kg", "2e-5 1/kg"]')


class ShaperProposalTable(Table):
    """[[identified.calibrate_shaper]]: what Klipper's script would choose."""

    shaper: ShaperName = required("Shaper.", '"mzv"')
    frequency: Annotated[float, Read(FREQUENCIES)] = required("Its frequency.", '"45.2 Hz"')
    vibration: Annotated[float, Read(SPREADS)] = required("Share of the power it leaves.", "0.02")
    smoothing: Annotated[float, Read(BANDS)] = required("How it rounds corners.", '"0.1 mm"')
    max_acceleration: Annotated[float, Read(ACCELERATIONS)] = required(
        "At which it rounds them by 0.12 mm.", '"11.7 m/s^2"'
    )
    recommended: bool = required("Whether the script recommends it.", "true")

    def build(self) -> ShaperProposal:
        """Return the proposal, in SI."""
        return ShaperProposal(
            shaper=self.shaper,
            frequency_hz=self.frequency,
            vibration=self.vibration,
            smoothing=self.smoothing,
            max_acceleration=self.max_acceleration,
            is_recommended=self.recommended,
        )


class IdentifiedTable(Table):
    """[identified]: what was measured; pairs are value and standard error."""

    date: Annotated[str, Name(longest=10)] = required("Day of the identification.", '"2026-11-22"')
    band: Frequencies | None = optional("Lines that were fitted.", '["2 Hz", "300 Hz"]')
    misfit: Annotated[float | None, Read(SPREADS)] = optional(
        "Weighted rms of the residuals by the noise.", "1.0"
    )
    moving_mass: Masses | None = optional("Rigid mass.", '["800 kg", "2 kg"]')
    delay: Times | None = optional("From set force to sensor.", '["0.4 ms", "2 us"]')
    lag: Times | None = optional("First-order lag beside it.", '["0.6 ms", "5 us"]')
    evidence: Annotated[str, Name(longest=LONGEST_FILE)] | None = optional(
        "File beside the profile with measured points and advice.", '"machine.identified.json"'
    )
    checksum: Hash | None = optional("Of that file's content.", '"64 hexadecimal digits"')
    files: Annotated[list[MeasuredFileTable], Field(max_length=MOST_FILES)] = optional(
        "What was read.", "", []
    )
    modes: Annotated[list[MeasuredModeTable], Field(max_length=MOST_FILES)] = optional(
        "As measured.", "", []
    )
    calibrate_shaper: Annotated[list[ShaperProposalTable], Field(max_length=8)] = optional(
        "What Klipper's script would choose from the same files.", "", []
    )

    def build(self) -> Identification:
        """Return what was measured, in SI."""
        return Identification(
            date=self.date,
            files=tuple(
                MeasuredFile(name=one.name, sensor=one.sensor, sha256=one.sha256)
                for one in self.files
            ),
            band_hz=(self.band[0], self.band[1]) if self.band else None,
            misfit=self.misfit,
            moving_mass=_estimate(self.moving_mass),
            delay=_estimate(self.delay),
            lag=_estimate(self.lag),
            modes=tuple(
                MeasuredMode(
                    name=mode.name,
                    frequency_hz=_known(mode.frequency),
                    damping_ratio=_known(mode.damping_ratio),
                    measured_gain=_estimate(mode.measured_gain),
                    tcp_gain=_estimate(mode.tcp_gain),
                )
                for mode in self.modes
            ),
            evidence=self.evidence or "",
            checksum=self.checksum or "",
            proposals=tuple(one.build() for one in self.calibrate_shaper),
        )


def _known(pair: list[float]) -> Estimate:
    return Estimate(value=pair[0], sigma=pair[1])


def _estimate(pair: list[float] | None) -> Estimate | None:
    return _known(pair) if pair else None
