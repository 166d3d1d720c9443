"""A whole commissioning as ``record.json`` holds it: built, and read back.

All numbers are SI without suffix unless the key says otherwise (``_hz``, ``_db``, ``_deg``). JSON
knows no infinity: a settling time that was not reached, or a limit that was not set, is null.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from math import isinf
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from mtcommission.base import __version__
from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import STEERING, Message
from mtcommission.loop.model.assembly import CrossCheck
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.checks import check_plausibility
from mtcommission.record.identified import IdentifiedPart, read_evidence
from mtcommission.record.limits import LimitsPart, limits_part
from mtcommission.record.loop import LoopPart, WhatIfPart, loop_part, what_if_part
from mtcommission.record.machine import (
    Datum,
    MachineEntry,
    PlantEntry,
    Profile,
    list_assumptions,
    list_data,
)
from mtcommission.record.moves import AssessmentPart, MoveEntry, move_entry
from mtcommission.record.optima import OptimaEntry, optima_entry
from mtcommission.record.shape import (
    Words,
    WrongFormError,
    entry_of,
    fault,
    find_checksum,
    load_json,
    to_entry,
    to_plain,
)
from mtcommission.study.robustness import Robustness
from mtcommission.study.settings import PRINTED

if TYPE_CHECKING:
    from mtcommission.commission.commission import Commissioning

Sealed = TypeVar("Sealed")

SCHEMA = 11

FORCE_LIMITS = ("drive.max_force", "drive.max_acceleration")
"""Key of the datum that bounds F_set, of an axis with a drive and of a motor that follows."""

LIBRARIES = ("casadi", "highspy", "ruckig", "control", "numpy", "scipy")
"""Those that computed."""

LAYOUT = {ord(letter): None for letter in "\n\r\t"}
"""Stand in the profile's text."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """Program and version, and the versions of the libraries that computed."""

    name: str
    version: str
    libraries: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """A whole commissioning."""

    schema: int
    checksum: str  # SHA-256 of all the rest
    tool: Tool
    created: str
    profile: Profile
    machine: MachineEntry
    data: list[Datum]
    settings: dict[str, float | str]
    assumptions: list[Words]
    warnings: list[Words]
    plant: PlantEntry
    optima: list[OptimaEntry]
    limits: LimitsPart
    loop: LoopPart
    moves: list[MoveEntry]
    robustness: Robustness
    assessment: AssessmentPart
    identified: IdentifiedPart | None = None
    what_if: WhatIfPart | None = None  # None: no loop was closed


def record_run(found: Commissioning, *, created: str) -> Record:
    """Return the record of a machine that was read from its profile; ``created``: ISO 8601.

    Raises
    ------
    InputError
        If the machine came from no profile, whose text a record holds.
    """
    source, machine = found.profile, found.machine
    if source is None:
        raise InputError([Fault(where=machine.name, message=Message("record-without-profile"))])
    return build_record(
        found,
        profile=entry_of(Profile, source),
        created=created,
        warnings=check_plausibility(machine),
        identified=read_evidence(machine, source.path.parent),
    )


def this_tool() -> Tool:
    """Return this program and the libraries that compute, with their versions."""
    libraries = {name: version(name) for name in LIBRARIES}
    return Tool(name="mtcommission", version=__version__, libraries=libraries)


def build_record(
    found: Commissioning,
    *,
    profile: Profile,
    created: str,
    warnings: Sequence[Words],
    identified: IdentifiedPart | None = None,
) -> Record:
    """Return the record of a commissioning.

    ``warnings``: physical ones about the profile, to which those about loop and robustness are
    added; ``identified``: what was measured on the axis.
    """
    machine, plant, tuned, moves = found.machine, found.plant, found.tuned, found.moves
    robustness, limits, freed = found.robustness, limits_part(found), found.tool_sensor
    if identified and freed:
        identified = replace(identified, tool_sensor=freed)
    record = Record(
        schema=SCHEMA,
        checksum="",
        tool=this_tool(),
        created=created,
        profile=profile,
        machine=entry_of(MachineEntry, machine),
        data=list_data(machine, plant, profile.text),
        settings=_settings(),
        assumptions=[*list_assumptions(machine), *_friction(found, is_kept=True)],
        warnings=[
            *warnings,
            *limits.warnings,
            *tuned.warnings,
            *robustness.warnings,
            *_friction(found, is_kept=False),
        ],
        plant=entry_of(PlantEntry, plant),
        optima=[
            optima_entry(plant, item, within)
            for item, within in zip(found.optima, found.within_band, strict=True)
        ],
        limits=limits,
        loop=loop_part(
            machine, plant, found.loop, found.disturbed, cross_check=_cross_check(tuned)
        ),
        moves=[move_entry(plant, tuned, result) for result in moves],
        robustness=robustness,
        assessment=entry_of(AssessmentPart, found.assessment),
        identified=identified,
        what_if=what_if_part(machine, plant, tuned, found.choice.limits, found.today),
    )
    return replace(record, checksum=find_checksum(to_plain(record)))


def _cross_check(tuned: TunedLoop) -> CrossCheck | None:
    if tuned.controller.follows:
        return None
    from mtcommission.loop.model.diagram import check_by_blocks  # python-control: 0.3 s

    return check_by_blocks(tuned.loops[0], tuned.responses[0].frequency_hz)


def _friction(found: Commissioning, *, is_kept: bool) -> list[Message]:
    """What the stated friction does to moves that keep their requirements, or do not."""
    drive = found.machine.drive
    return [
        Message(
            "friction-kept" if is_kept else "friction-broken",
            move=one.number,
            coulomb=drive.coulomb_friction,
            viscous=drive.viscous_friction,
            settling="" if isinf(one.settling_time) else one.settling_time,
            without="" if isinf(one.without_friction) else one.without_friction,
            residual=one.residual_deviation,
            force=one.max_force,
        )
        for one in found.friction
        if one.is_kept is is_kept
    ]


def _settings() -> dict[str, float | str]:
    return {
        f"{group}.{name}": value if isinstance(value, int | float) else ", ".join(map(str, value))
        for group, values in PRINTED.items()
        for name, value in values.items()
    }


def load_record(path: Path) -> Record:
    """Return a record from the ``record.json`` of a run.

    Raises
    ------
    InputError
        If the file is no record of this schema, or not as it was written; says what is wrong.
    """
    return load_sealed(path, Record, schema=SCHEMA)


def load_sealed(path: Path, form: type[Sealed], *, schema: int) -> Sealed:
    """Return what a file holds that was sealed by its checksum.

    Raises
    ------
    InputError
        If the file is of another form or schema, or not as it was written; says what is wrong.
    """
    data = load_json(path)
    if any(STEERING.search(text.translate(LAYOUT)) for text in _texts(data)):
        raise fault(path, Message("record-steers"))
    missing = sorted({"schema", "checksum"} - (data.keys() if isinstance(data, dict) else set()))
    if missing:
        raise fault(path, Message("record-lacks-keys", keys=", ".join(missing)))
    if data["schema"] != schema:
        given = json.dumps(data["schema"])
        raise fault(path, Message("record-of-other-schema", given=given, read=schema), "schema")
    if data["checksum"] != find_checksum(data):
        raise fault(path, Message("record-edited"), "checksum")
    try:
        return to_entry(data, form)
    except WrongFormError as error:
        raise fault(path, Message("record-of-other-version")) from error


def _texts(data: object) -> Iterator[str]:
    if isinstance(data, str):
        yield data
    elif isinstance(data, dict):
        yield from data
        yield from _texts(list(data.values()))
    elif isinstance(data, list):
        for inner in data:
            yield from _texts(inner)
