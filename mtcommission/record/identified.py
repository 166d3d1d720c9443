"""What was measured on an axis, for the record: from its profile and the file beside it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from cattrs import BaseValidationError

from mtcommission.errors import InputError
from mtcommission.files import read_bytes
from mtcommission.machine.identified import Identification, MeasuredMode
from mtcommission.machine.machine import Machine, Motion
from mtcommission.messages.message import Message
from mtcommission.record.files import find_checksum
from mtcommission.record.schema.identified import IdentifiedPart, SpreadEntry
from mtcommission.record.shape import WrongFormError, to_entry

APART = ("files", "sensor", "profile")
"""Keys of the file beside a profile that say the same once more; the profile names its checksum."""
LARGEST = 20_000_000
"""Bytes of such a file; one has some hundred thousand."""


def evidence_checksum(entry: Mapping[str, Any]) -> str:
    """Return what a profile says of the file beside it: the checksum of all that it holds itself.

    Parameters
    ----------
    entry
        JSON of ``identify``.
    """
    return find_checksum({key: value for key, value in entry.items() if key not in APART})


def read_evidence(machine: Machine, folder: Path | None) -> IdentifiedPart | None:
    """Return what was measured on an axis; None where its numbers come from elsewhere.

    Parameters
    ----------
    machine
        From its profile.
    folder
        Where the profile stands, and the file with points and advice beside it; None: not known.

    Returns
    -------
    IdentifiedPart or None
        From the profile alone where that file is missing or is another one; a warning says so.
    """
    said = machine.identified
    if said is None:
        return None
    if not said.evidence or folder is None:
        return _from_profile(machine, said, Message("identified-without-evidence"))
    try:
        missing = Message("identified-evidence-missing", file=said.evidence)
        data = json.loads(read_bytes(folder / said.evidence, folder=missing, most=LARGEST))
    except (InputError, ValueError, RecursionError):
        return _from_profile(machine, said, missing)
    other = Message("identified-evidence-differs", file=said.evidence)
    if not isinstance(data, dict) or evidence_checksum(data) != said.checksum:
        return _from_profile(machine, said, other)
    try:
        kept = {key: value for key, value in data.items() if key not in APART}
        return _renamed(to_entry(kept, IdentifiedPart), said)
    except (WrongFormError, BaseValidationError):
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
    return IdentifiedPart(
        created=said.date,
        rotary=machine.motion is Motion.ROTARY,
        base_excited=False,
        sources=list(said.files),
        formats={},
        band_hz=list(said.band_hz) if said.band_hz else None,
        moving_mass=said.moving_mass,
        delay=said.delay,
        lag=said.lag,
        modes=list(said.modes),
        states=[],
        spread=SpreadEntry(
            frequency=needs.frequency_spread, damping=needs.damping_spread, because=[]
        ),
        misfit=said.misfit,
        proposals=list(said.proposals),
        checks=[],
        warnings=[warning],
        responses=[],
    )
