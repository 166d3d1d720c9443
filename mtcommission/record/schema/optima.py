"""The optimal controls of a record."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.record.schema.values import Series, Words


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
    """What proves a least time; null: not known."""

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
    """An optimal control as `optimal --json` prints it, with its motion for the plots."""

    kind: str
    method: str
    f_max: float
    move: dict[str, float]
    limits: dict[str, float]
    t_f: float
    arcs: list[ArcEntry]
    switching_times: list[float]
    touch_points: list[TouchPointEntry]
    peaks: dict[str, float]
    terminal_error: dict[str, float]
    cost: float | None
    cost_terms: dict[str, float]
    weights: dict[str, float]
    certificate: ProofEntry | LawEntry
    series: Series


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceSegment:
    """A set force and how long it acts [N or N m, s]."""

    duration: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BandEntry:
    """The fastest control to a state from which the free motion keeps the tool within the band.

    ``lower_bound`` is proved, ``gap`` is what lies between it and ``t_f``, relative to ``t_f``.
    The reference lies ``offset`` beyond the place at which the tool comes to rest [m or rad].
    """

    t_f: float
    lower_bound: float
    gap: float
    band: float
    offset: float
    segments: list[ForceSegment]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustEntry:
    """The fastest force found after which all ``machines`` of the spread keep the band.

    ``peak`` is the largest deviation afterwards, over those machines [m or rad].
    """

    t_f: float
    band: float
    offset: float
    machines: int
    peak: float
    segments: list[ForceSegment]


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimaEntry:
    """The optima of one move; ``constrained`` is null where the profile bounds no peaks.

    ``band`` is null where it was not found, ``robust`` where there is no spread, too; then
    ``remarks`` say why.
    """

    move: dict[str, float]
    time: OptimumEntry
    constrained: OptimumEntry | None
    damping: OptimumEntry | None
    band: BandEntry | None
    robust: RobustEntry | None
    remarks: list[Words]
