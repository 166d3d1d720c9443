"""What was measured on the axis of a record."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from mtcommission.machine.identified import Estimate, MeasuredFile, MeasuredMode, ShaperProposal
from mtcommission.messages.message import Message
from mtcommission.record.rules import above_zero


@dataclass(frozen=True, slots=True, kw_only=True)
class SpreadEntry:
    """What the corners must hold [-], and why; ``because`` is empty where only a profile tells."""

    frequency: float
    damping: float
    because: list[Message]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredStateEntry:
    """One state of the machine: position, payload or level; its modes have the axis' names."""

    name: str
    moving_mass: Estimate | None
    modes: list[MeasuredMode]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredResponseEntry:
    """Measured points of a response or of a spectrum, and the curve that was fitted.

    A spectrum has no error and no phase, and its scale means nothing.
    """

    name: str
    unit: str  # of magnitude and error
    misfit: float | None
    frequency_hz: Annotated[list[float], above_zero]
    magnitude: list[float]
    error: list[float] | None  # standard error of real and imaginary part
    phase_deg: list[float] | None
    coherence: list[float] | None
    missed: list[float] | None  # distance of point and curve in that error
    curve_hz: Annotated[list[float], above_zero]
    curve_magnitude: list[float]
    curve_phase_deg: list[float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordCheckEntry:
    """Share of a record's power in the band that the identified model explains."""

    record: str
    explained: float
    held_back: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolSensorEntry:
    """What a sensor at the tool could free: the settling time where the modes stand still there."""

    modes: list[str]  # whose share at the tool was assumed
    settling_time: float | None
    least: float | None  # None: no limits meet the requirements even then


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedPart:
    """What was measured on the axis.

    ``formats``, ``states``, ``responses``, ``checks`` and ``warnings`` come from the file beside
    the profile; without it they are empty, and the warnings say so.
    """

    created: str
    rotary: bool
    base_excited: bool
    sources: list[MeasuredFile]
    formats: dict[str, Message]  # by name of a source
    band_hz: list[float] | None
    moving_mass: Estimate | None
    delay: Estimate | None
    lag: Estimate | None
    modes: list[MeasuredMode]
    states: list[MeasuredStateEntry]
    spread: SpreadEntry
    misfit: float | None
    checks: list[RecordCheckEntry]
    warnings: list[Message]
    responses: list[MeasuredResponseEntry]
    tool_sensor: ToolSensorEntry | None = None
    proposals: list[ShaperProposal] = field(default_factory=list)
