"""What was measured on an axis, for the record: from its profile and the file beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from mtcommission.errors import InputError
from mtcommission.machine.identified import Identification, MeasuredMode
from mtcommission.machine.machine import Machine, Motion
from mtcommission.messages.message import Message
from mtcommission.record.files import LARGEST_FILE, find_checksum, load_json
from mtcommission.record.schema.identified import IdentifiedPart, SpreadEntry
from mtcommission.record.shape import WRONG, entry_of, to_entry

APART = ("files", "sensor", "profile")
"""Keys of the file beside a profile that say the same once more; the profile names its checksum."""


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
        data = load_json(folder / said.evidence, most=LARGEST_FILE)
    except InputError:
        return _from_profile(machine, said, missing)
    if not isinstance(data, dict) or evidence_checksum(data) != said.checksum:
        other = Message("identified-evidence-differs", file=said.evidence)
        return _from_profile(machine, said, other)
    try:
        kept = {key: value for key, value in data.items() if key not in APART}
        return _renamed(to_entry(kept, IdentifiedPart), said)
    except WRONG:
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
        formats={},
        states=[],
        spread=spread,
        checks=[],
        warnings=[warning],
        responses=[],
        tool_sensor=None,
    )
