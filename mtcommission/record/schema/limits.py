"""The limits of a record: recommended, today's, by rules, and what stands in their way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from mtcommission.messages.message import Message
from mtcommission.record.rules import above_zero, filled, found_in, long, one_of
from mtcommission.record.schema.values import (
    Move,
    NotNegative,
    Positive,
    PositiveOrNone,
    Positives,
    SetpointFilterEntry,
    Words,
)

Plane = Annotated[list[list[float | None]], long("acceleration", "jerk_time")]
PerSize = Annotated[list[float | None], long("size")]


def _checked(record: Any) -> list[str]:
    return [check.name for check in record.assessment.checks]


@dataclass(frozen=True, slots=True, kw_only=True)
class SizesEntry:
    """Between which sizes of a move all requirements were judged [m/s or m, as the move]."""

    smallest: float
    largest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstSizeEntry:
    """The worst of all sizes of move for one requirement."""

    requirement: Annotated[str, found_in(_checked)]
    value: float  # worst of the sizes that were looked at
    bound: float | None  # what no size between them exceeds either; None: not proved
    move: int  # its number, from 1
    size: float  # velocity step or distance of the worst


@dataclass(frozen=True, slots=True, kw_only=True)
class RecommendedEntry:
    """Limits for the control, what binds them, and where they were judged."""

    acceleration: Positive
    jerk: Positive
    jerk_time: Positive
    setpoint_filter: SetpointFilterEntry | None
    bound_by: Words
    settling_time: PositiveOrNone
    residual_deviation: NotNegative
    peak_deviation: float
    valid_for: Annotated[list[SizesEntry], long("/moves")]
    worst_sizes: list[WorstSizeEntry]  # empty where the listed sizes alone count


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsEntry(RecommendedEntry):
    """The same with the factors by which all frequencies or damping ratios may be off.

    None: the requirements are not even kept at those of the profile.
    """

    frequency_range: list[float] | None
    damping_range: list[float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TodayEntry:
    """The values now in the control, judged; all None where ``failure`` says why they cannot be."""

    acceleration: Positive
    jerk: float | None  # None: the control has no limit of the jerk
    jerk_time: Positive  # then the ramp that was simulated
    setpoint_filter: SetpointFilterEntry | None
    Kv: float
    Kp: float
    Tn: float
    stated: list[str]  # which of Kv, Kp and Tn are today's
    basis: Words  # the same as a sentence
    failure: Message | None
    bound_by: Message | None
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float | None
    meets_requirements: bool
    keeps_reserve: bool
    frequency_range: list[float] | None
    valid_for: list[SizesEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedLimits:
    """Limits and what they reach, worst over moves and corners."""

    acceleration: Positive
    jerk: Positive
    settling_time: PositiveOrNone
    residual_deviation: NotNegative
    peak_deviation: float
    meets_requirements: bool
    keeps_reserve: bool  # they need no more of what is allowed than recommendations may use


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedEntry(JudgedLimits):
    """Limits for the listed sizes alone: what it costs to serve every smaller move, too."""

    setpoint_filter: SetpointFilterEntry | None
    valid_for: list[SizesEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class Alternative(JudgedLimits):
    """Other limits, and why they are shown."""

    name: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleResult(Alternative):
    """A maker's or textbook's rule, in the same simulation."""

    source: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleFormulaEntry:
    """One formula of the rule in the field's signs, and where it holds."""

    text: str
    aside: Message | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStepEntry:
    """One line of the hand calculation."""

    name: Words
    formula: Words
    value: float | None
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleText:
    """The commissioning rule, in words and as a formula, with its range, applied here."""

    text: Words
    formula: list[RuleFormulaEntry]
    advice: Words
    valid_for: Words
    acceleration: Positive
    jerk: Positive
    jerk_time: Positive
    average: float
    chosen: Words
    bound_by: Words
    predicted_settling_time: float | None
    predicted_residual: float | None
    steps: list[RuleStepEntry]
    warnings: list[Words]


@dataclass(frozen=True, slots=True, kw_only=True)
class Landscape:
    """Worst case over (a, t_j): ``settling_time[i][k]`` at acceleration i, jerk time k."""

    acceleration: Annotated[list[float], filled, above_zero]
    jerk_time: Annotated[list[float], filled, above_zero]
    settling_time: Plane
    residual_deviation: Plane
    usage: Plane  # share of the limits of force, bounded peaks and RMS force [-]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeLimitsEntry:
    """Limits for one machining mode, from a band of its own; None where ``reason`` says why."""

    name: Annotated[str, one_of("surface", "accuracy", "speed")]
    band: float
    acceleration: float | None
    jerk: float | None
    jerk_time: float | None
    bound_by: Words
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float | None
    meets_requirements: bool
    reason: Words
    attainable: float | None  # the band that could be asked for instead


@dataclass(frozen=True, slots=True, kw_only=True)
class AttainableEntry:
    """A requirement that stands in the way: ``value`` could be met instead, by these limits."""

    requirement: str  # named as in the verdict's checks
    limit: float
    value: float
    unit: str
    acceleration: float
    jerk: float
    together_with: list[str]  # what must give way, too, where none helps alone


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveSizesEntry:
    """The same limits on smaller and larger moves than the profile's, worst over the corners.

    An end of ``size`` means: the band is kept at least so far.
    """

    way: Words  # recommended, by the commissioning rule, or by a moving average alone
    acceleration: Positive
    jerk: float | None
    setpoint_filter: SetpointFilterEntry | None
    move: Move
    own: Positive  # size of the profile's move
    size: Positives  # velocity steps or distances
    settling_time: PerSize
    residual_deviation: PerSize
    full_from: float | None  # from here on the acceleration is reached; None: never
    kept_from: float | None  # the band is kept about ``own`` from here; None: not even there
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ImprovementEntry:
    """What a single change would bring; ``outcome`` says why it has no number, or is not judged."""

    name: str
    change: Words
    settling_time: float | None
    saved: float | None  # of the settling time
    share: float | None  # the same relative to that of the recommendation [-]
    meets_requirements: bool
    outcome: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsPart:
    """All about the limits."""

    recommended: LimitsEntry
    listed_only: ListedEntry | None  # None: the listed sizes alone count anyway, or none are met
    today: TodayEntry | None  # None: the profile does not state the values now in the control
    modes: list[ModeLimitsEntry]
    attainable: list[AttainableEntry]  # empty: all are met, or no single one is the obstacle
    move_sizes: list[MoveSizesEntry]
    alternatives: list[Alternative]
    rules: list[RuleResult]
    rule: RuleText
    landscape: Landscape
    warnings: list[Words]  # part of the record's warnings, too
    would_bring: list[ImprovementEntry]
