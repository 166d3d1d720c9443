"""The record's exact shape, as the project's interface states it.

All numbers are SI without suffix unless the key says otherwise (``_hz``, ``_db``, ``_deg``).
JSON knows no infinity: a settling time that was not reached, or a limit that was not set, is
null.
"""

from __future__ import annotations

from dataclasses import dataclass

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
    """A whole commissioning; ``checksum`` is the SHA-256 of all the rest.

    ``what_if`` is null where no loop was closed.
    """

    schema: int
    checksum: str
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
    comparisons: list[ComparisonEntry]
    robustness: RobustnessPart
    assessment: AssessmentPart
    identified: IdentifiedPart | None = None
    what_if: WhatIfPart | None = None
