"""The optimal controls of a record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from mtcommission.record.rules import named, one_of
from mtcommission.record.schema.values import (
    BySignal,
    Move,
    Positive,
    Series,
    Words,
    signals_of,
)


def _signals(record: Any) -> list[str]:
    return ["F_set", *signals_of(record)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcEntry:
    """An arc of an optimal control."""

    t_start: float
    t_end: float
    control: str


@dataclass(frozen=True, slots=True, kw_only=True)
class TouchPointEntry:
    """Where a limit is touched for a moment."""

    t: float
    limit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ProofEntry:
    """What proves a least time; None: not known."""

    t_f_lower_bound: float | None
    relative_gap: float | None
    adjoint_initial: dict[str, float]
    switching_slopes: list[float]
    switching_law_holds: bool
    terminal_jacobian_rank: int | None
    terminal_jacobian_condition: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LawEntry:
    """How well a damping-optimal control keeps its law."""

    adjoint_initial: dict[str, float]
    law_residual: float


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimumEntry:
    """An optimal control as ``optimal --json`` prints it, with its motion for the plots."""

    kind: Annotated[str, one_of("time", "damping")]
    method: str
    f_max: Positive
    move: Move
    limits: dict[str, float]
    t_f: Positive
    arcs: list[ArcEntry]
    switching_times: list[float]
    touch_points: list[TouchPointEntry]
    peaks: BySignal
    terminal_error: dict[str, float]
    cost: float | None
    cost_terms: dict[str, float]
    weights: dict[str, float]
    certificate: ProofEntry | LawEntry
    series: Annotated[Series, named(_signals)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceSegment:
    """A set force and how long it acts."""

    duration: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BandEntry:
    """The fastest control to a state from which the free motion keeps the tool within the band."""

    t_f: Positive
    lower_bound: float  # proved
    gap: float  # between that and t_f, relative to t_f
    band: Positive
    offset: float  # from where the tool comes to rest to the reference
    segments: list[ForceSegment]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustEntry:
    """The fastest force found after which all ``machines`` of the spread keep the band."""

    t_f: Positive
    band: Positive
    offset: float
    machines: int
    peak: float  # largest deviation afterwards, over those machines
    segments: list[ForceSegment]


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimaEntry:
    """The optima of one move; ``remarks`` say why one was not found."""

    move: Move
    time: OptimumEntry
    constrained: OptimumEntry | None  # None: the profile bounds no peaks
    damping: OptimumEntry | None
    band: BandEntry | None
    robust: RobustEntry | None  # None where there is no spread, too
    remarks: list[Words]
