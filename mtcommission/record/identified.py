"""What was measured on the axis of a record: from its profile and the file beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.machine.identified import (
    Estimate,
    Identification,
    MeasuredFile,
    MeasuredMode,
    ShaperProposal,
    ToolSensor,
)
from mtcommission.machine.machine import Machine, Motion
from mtcommission.record.shape import (
    WrongFormError,
    entry_of,
    find_checksum,
    load_json,
    to_entry,
)

APART = ("files", "sensor", "profile")
"""Keys of the file beside a profile that say the same once more; the profile names its checksum."""

GONE = ("formats",)
"""Keys that earlier versions wrote and nobody reads."""


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
    frequency_hz: list[float]
    magnitude: list[float]
    error: list[float] | None = None  # standard error of real and imaginary part
    phase_deg: list[float] | None = None
    coherence: list[float] | None = None
    missed: list[float] | None = None  # distance of point and curve in that error
    curve_hz: list[float]
    curve_magnitude: list[float]
    curve_phase_deg: list[float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordCheckEntry:
    """Share of a record's power in the band that the identified model explains."""

    record: str
    explained: float
    held_back: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedPart:
    """What was measured on the axis.

    ``states``, ``responses``, ``checks`` and ``warnings`` come from the file beside
    the profile; without it they are empty, and the warnings say so.
    """

    created: str
    rotary: bool
    base_excited: bool
    sources: list[MeasuredFile]
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
    tool_sensor: ToolSensor | None = None
    proposals: list[ShaperProposal] = field(default_factory=list)


def evidence_checksum(entry: Mapping[str, Any]) -> str:
    """Return what a profile says of the JSON of ``identify``: the checksum of all but itself."""
    return find_checksum({key: value for key, value in entry.items() if key not in APART})


def read_evidence(machine: Machine, folder: Path | None) -> IdentifiedPart | None:
    """Return what was measured on an axis; None where its numbers come from elsewhere.

    ``folder``: where the profile stands, and the file with points and advice beside it. Where that
    is missing or is another one, the profile alone tells, with a warning.
    """
    said = machine.identified
    if said is None:
        return None
    if not said.evidence or folder is None:
        return _from_profile(machine, said, Message("identified-without-evidence"))
    missing = Message("identified-evidence-missing", file=said.evidence)
    try:
        data = load_json(folder / said.evidence)
    except InputError:
        return _from_profile(machine, said, missing)
    if not isinstance(data, dict) or evidence_checksum(data) != said.checksum:
        other = Message("identified-evidence-differs", file=said.evidence)
        return _from_profile(machine, said, other)
    try:
        kept = {key: value for key, value in data.items() if key not in (*APART, *GONE)}
        return _renamed(to_entry(kept, IdentifiedPart), said)
    except WrongFormError:
        return _from_profile(machine, said, missing)


def _renamed(part: IdentifiedPart, said: Identification) -> IdentifiedPart:
    """The modes by the names of the profile."""
    names = {old.name: new.name for old, new in zip(part.modes, said.modes, strict=False)}

    def rename(modes: list[MeasuredMode]) -> list[MeasuredMode]:
        return [replace(mode, name=names.get(mode.name, mode.name)) for mode in modes]

    states = [replace(state, modes=rename(state.modes)) for state in part.states]
    return replace(part, modes=rename(part.modes), states=states)


def _from_profile(machine: Machine, said: Identification, warning: Message) -> IdentifiedPart:
    needs = machine.requirements
    spread = SpreadEntry(frequency=needs.frequency_spread, damping=needs.damping_spread, because=[])
    return entry_of(
        IdentifiedPart,
        said,
        created=said.date,
        rotary=machine.motion is Motion.ROTARY,
        base_excited=False,
        sources=said.files,
        states=[],
        spread=spread,
        checks=[],
        warnings=[warning],
        responses=[],
        tool_sensor=None,
    )
