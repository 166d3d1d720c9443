"""The record's exact shape, as the project's interface states it.

All numbers are SI without suffix unless the key says otherwise (``_hz``, ``_db``, ``_deg``). JSON
knows no infinity: a settling time that was not reached, or a limit that was not set, is null.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from mtcommission.messages.message import Message
from mtcommission.record.rules import Place, filled, long
from mtcommission.record.schema.comparisons import ComparisonEntry
from mtcommission.record.schema.identified import IdentifiedPart
from mtcommission.record.schema.limits import LimitsPart
from mtcommission.record.schema.loop import LoopPart
from mtcommission.record.schema.machine import Datum, MachineEntry, PlantEntry
from mtcommission.record.schema.moves import AssessmentPart, MoveEntry
from mtcommission.record.schema.optima import OptimaEntry
from mtcommission.record.schema.robustness import RobustnessPart
from mtcommission.record.schema.values import Words
from mtcommission.record.schema.what_if import WhatIfPart

SCHEMA = 6

FORCE_LIMITS = ("drive.max_force", "drive.max_acceleration")
"""Key of the datum that bounds F_set, of an axis with a drive and of a motor that follows."""


def _has_force_limit(at: Place) -> Iterator[Message]:
    bounds = [datum.value for datum in at.value if datum.key in FORCE_LIMITS]
    if not any(not isinstance(bound, str) and bound > 0.0 for bound in bounds):
        yield Message("record-names-missing", key=at.key, names=" / ".join(FORCE_LIMITS))


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """Program and version, and the versions of the libraries that computed."""

    name: str
    version: str
    libraries: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """The machine profile as read."""

    name: str
    sha256: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """A whole commissioning."""

    schema: int
    checksum: str  # SHA-256 of all the rest
    tool: Tool
    created: str
    profile: Profile
    machine: MachineEntry
    data: Annotated[list[Datum], filled, _has_force_limit]
    settings: dict[str, float | str]
    assumptions: list[Words]
    warnings: list[Words]
    plant: PlantEntry
    optima: Annotated[list[OptimaEntry], long("moves")]
    limits: LimitsPart
    loop: LoopPart
    moves: Annotated[list[MoveEntry], filled]
    comparisons: Annotated[list[ComparisonEntry], long("moves")]
    robustness: RobustnessPart
    assessment: AssessmentPart
    identified: IdentifiedPart | None = None
    what_if: WhatIfPart | None = None  # None: no loop was closed
