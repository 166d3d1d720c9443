"""The limits of a record: recommended, today's, by rules, and what stands in their way."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.messages.message import Message
from mtcommission.record.schema.values import SetpointFilterEntry, Words


@dataclass(frozen=True, slots=True, kw_only=True)
class SizesEntry:
    """Between which sizes of a move all requirements were judged [m/s or m, as the move]."""

    smallest: float
    largest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstSizeEntry:
    """The worst of all sizes of move for one requirement.

    ``value``: worst of the sizes that were looked at; ``bound``: what no size between them exceeds
    either, null where that was not proved. ``move``: its number, from 1; ``size``: velocity step or
    distance of the worst.
    """

    requirement: str
    value: float
    bound: float | None
    move: int
    size: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RecommendedEntry:
    """Limits for the control, what binds them, and where they were judged.

    ``valid_for``: by move; ``worst_sizes``: empty where the listed sizes alone count.
    """

    acceleration: float
    jerk: float
    jerk_time: float
    setpoint_filter: SetpointFilterEntry | None
    bound_by: Words
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    valid_for: list[SizesEntry]
    worst_sizes: list[WorstSizeEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsEntry(RecommendedEntry):
    """The same with how far frequencies and damping may be off.

    ``frequency_range``: every requirement is kept where all eigenfrequencies are off by a factor
    between these two [-]; null: not even at those of the profile. ``damping_range``: likewise,
    of all damping ratios.
    """

    frequency_range: list[float] | None
    damping_range: list[float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TodayEntry:
    """The values now in the control, judged like the recommended ones.

    ``jerk`` is null where the control has no limit of the jerk; ``jerk_time`` is then the ramp
    that was simulated. ``stated`` names those of Kv, Kp and Tn that are today's, ``basis`` says
    it as a sentence. All that was to be judged is null
    where ``failure`` says why it cannot be told, e.g. that the loop is unstable.
    """

    acceleration: float
    jerk: float | None
    jerk_time: float
    setpoint_filter: SetpointFilterEntry | None
    Kv: float
    Kp: float
    Tn: float
    stated: list[str]
    basis: Words
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
    """Limits and what they reach, worst over moves and corners.

    ``keeps_reserve``: they need no more of what is allowed than recommendations may use.
    """

    acceleration: float
    jerk: float
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    meets_requirements: bool
    keeps_reserve: bool


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
    acceleration: float
    jerk: float
    jerk_time: float
    average: float
    chosen: Words
    bound_by: Words
    predicted_settling_time: float | None
    predicted_residual: float | None
    steps: list[RuleStepEntry]
    warnings: list[Words]


@dataclass(frozen=True, slots=True, kw_only=True)
class Landscape:
    """Worst case over (a, t_j): ``settling_time[i][k]`` at acceleration i, jerk time k.

    ``usage`` is the share of the force limit (and of bounded peaks and RMS force) that is used.
    """

    acceleration: list[float]
    jerk_time: list[float]
    settling_time: list[list[float | None]]
    residual_deviation: list[list[float | None]]
    usage: list[list[float | None]]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeLimitsEntry:
    """Limits for one machining mode, from a band of its own.

    Where none were found that meet all requirements with this band, ``meets_requirements`` is
    false, ``reason`` says so, and all values are null: nothing must be typed in. ``attainable``
    is then the least residual deviation that was found with all other requirements kept, i.e.
    the band that could be asked for [m]; null if there is none.
    """

    name: str
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
    attainable: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class AttainableEntry:
    """A requirement that stands in the way: ``value`` could be met instead of ``limit``.

    All other requirements are kept then, by these limits. Names as in the verdict's checks.
    ``together_with``: the requirements that must give way, too, where none helps alone.
    """

    requirement: str
    limit: float
    value: float
    unit: str
    acceleration: float
    jerk: float
    together_with: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveSizesEntry:
    """The same limits on smaller and larger moves than the profile's, worst over the corners.

    ``way``: "recommended", "commissioning rule", or "moving average" (the setpoint filter with
    the length of one period, without a jerk limit: ``jerk`` null; only where it keeps the band
    on all smaller moves). ``size`` is the velocity step [m/s] or the distance [m]; ``own`` that
    of the profile's move. From ``full_from`` on the acceleration is reached (a²/j, or 2 a³/j²;
    null: never). The band is kept for all sizes from ``kept_from`` to ``kept_to``, about
    ``own`` (both null if not even there); an end of ``size`` means: at least so far.
    """

    way: Words
    acceleration: float
    jerk: float | None
    setpoint_filter: SetpointFilterEntry | None
    move: dict[str, float]
    own: float
    size: list[float]
    settling_time: list[float | None]
    residual_deviation: list[float | None]
    full_from: float | None
    kept_from: float | None
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ImprovementEntry:
    """What a single change would bring.

    ``saved`` is what the settling time is less than with the recommendation [s], ``share`` the same
    relative to that [-]. ``outcome`` says why numbers are null, or what was not judged;
    empty where all was.
    """

    name: str
    change: Words
    settling_time: float | None
    saved: float | None
    share: float | None
    meets_requirements: bool
    outcome: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsPart:
    """All about the limits.

    ``attainable`` is empty if all requirements are met, or if no single one is the obstacle.
    ``listed_only`` is null where the listed sizes alone count anyway, or where no limits are met.
    ``today`` is null where the profile does not state the values now in the control.
    ``warnings`` are part of the record's warnings, too. ``would_bring`` is empty but in a record.
    """

    recommended: LimitsEntry
    listed_only: ListedEntry | None
    today: TodayEntry | None
    modes: list[ModeLimitsEntry]
    attainable: list[AttainableEntry]
    move_sizes: list[MoveSizesEntry]
    alternatives: list[Alternative]
    rules: list[RuleResult]
    rule: RuleText
    landscape: Landscape
    warnings: list[Words]
    would_bring: list[ImprovementEntry]
