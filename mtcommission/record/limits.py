"""The limits of a record: recommended, today's, by rules, and what stands in their way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mtcommission.base.messages.message import Message
from mtcommission.commission.recommend import Recommendation
from mtcommission.limits.choose import Choice
from mtcommission.limits.commissioning_rule import (
    ADVICE,
    DESCRIPTION,
    VALIDITY,
    RuleFormula,
    RuleStep,
)
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.moves import Array, AssessmentPart, rounded
from mtcommission.record.shape import Words, entry_of, of
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.attainable import Attainable, ModeLimits
from mtcommission.study.improvements import Improvement
from mtcommission.study.loops import describe_loop
from mtcommission.study.robustness import KeptRange
from mtcommission.study.rules import TodaysValues

if TYPE_CHECKING:  # the optima and their libraries take a second; ``limits`` needs none of them
    from mtcommission.commission.commission import Commissioning


REACHED = ("settling_time", "residual_deviation", "peak_deviation")
"""What is None where nothing was judged."""


def _plotted(name: str) -> Callable[[Any], Array]:
    return lambda result: rounded(getattr(result, name), 5)


def _ends(error: KeptRange | None) -> list[float] | None:
    """Both ends of a range that was found; None where an end was not."""
    if error is None or error.kept_from is None or error.kept_to is None:
        return None
    return [error.kept_from, error.kept_to]


@dataclass(frozen=True, slots=True, kw_only=True)
class SizesEntry:
    """Between which sizes of a move all requirements were judged [m/s or m, as the move]."""

    smallest: float
    largest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstSizeEntry:
    """The worst of all sizes of move for one requirement."""

    requirement: str
    value: float  # worst of the sizes that were looked at
    bound: float | None  # what no size between them exceeds either; None: not proved
    move: int  # its number, from 1
    size: float  # velocity step or distance of the worst


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedLimits:
    """Limits and what they reach, worst over moves and corners."""

    acceleration: float = of("limits.acceleration")
    jerk: float = of("limits.jerk")
    jerk_time: float = of("limits.jerk_time")
    setpoint_filter: SetpointFilter | None = of("limits.setpoint_filter")
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    meets_requirements: bool = of("assessment.is_met")
    keeps_reserve: bool = of("assessment.keeps_reserve")


@dataclass(frozen=True, slots=True, kw_only=True)
class RecommendedEntry(JudgedLimits):
    """Limits for the control, what binds them, and where they were judged."""

    bound_by: Words
    valid_for: list[SizesEntry]
    worst_sizes: list[WorstSizeEntry] = of("sizes")  # empty where the listed sizes alone count


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsEntry(RecommendedEntry):
    """The same with the factors by which all frequencies or damping ratios may be off.

    None: the requirements are not even kept at those of the profile.
    """

    frequency_range: list[float] | None
    damping_range: list[float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedEntry(JudgedLimits):
    """Limits for the listed sizes alone: what it costs to serve every smaller move, too."""

    valid_for: list[SizesEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class Alternative(JudgedLimits):
    """Other limits, why they are shown, and which maker or textbook says so; "": nobody."""

    name: Words
    source: Words = of(lambda candidate: candidate.source or "")


@dataclass(frozen=True, slots=True, kw_only=True)
class TodayEntry:
    """The values now in the control, judged; all None where ``failure`` says why they cannot be."""

    acceleration: float = of("today.acceleration")
    jerk: float | None = of("today.jerk")  # None: the control has no limit of the jerk
    jerk_time: float = of("limits.jerk_time")  # then the ramp that was simulated
    setpoint_filter: SetpointFilter | None = of("today.setpoint_filter")
    Kv: float = of("controller.position_gain")
    Kp: float = of("controller.velocity_gain")
    Tn: float = of("controller.integral_time")
    stated: list[str]  # which of Kv, Kp and Tn are today's
    basis: Words  # the same as a sentence
    failure: Message | None
    bound_by: Message | None
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float | None
    meets_requirements: bool
    keeps_reserve: bool
    frequency_range: list[float] | None = of(lambda today: _ends(today.frequency_error))
    valid_for: list[SizesEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleText:
    """The commissioning rule, in words and as a formula, with its range, applied here."""

    text: Words = of(lambda _: DESCRIPTION)
    formula: list[RuleFormula] = of("formulas")
    advice: Words = of(lambda _: ADVICE)
    valid_for: Words = of(lambda _: VALIDITY)
    acceleration: float = of("limits.acceleration")
    jerk: float = of("limits.jerk")
    jerk_time: float = of("limits.jerk_time")
    average: float = of("best.average")
    chosen: Words = of("best.name")
    bound_by: Words = of("best.bound_by")
    predicted_residual: float | None = of("best.residual_deviation")
    steps: list[RuleStep]
    warnings: list[Words]


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveSizesEntry:
    """The same limits on smaller and larger moves than the profile's, worst over the corners.

    An end of ``size`` means: the band is kept at least so far.
    """

    way: Words = of("name")  # recommended, by the commissioning rule, or by a moving average alone
    acceleration: float = of("limits.acceleration")
    jerk: float | None = of(
        lambda it: it.limits.jerk if it.limits.jerk_time > 2.0 * NO_JERK_LIMIT else None
    )
    setpoint_filter: SetpointFilter | None = of("limits.setpoint_filter")
    move: Move
    size: list[float] = of(_plotted("size"))  # velocity steps or distances
    residual_deviation: list[float | None] = of(_plotted("residual_deviation"))
    full_from: float | None  # from here on the acceleration is reached; None: never
    kept_from: float | None  # the band is kept about the profile's size from here; None: not there
    kept_to: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsPart:
    """All about the limits."""

    recommended: LimitsEntry
    listed_only: ListedEntry | None  # None: the listed sizes alone count anyway, or none are met
    today: TodayEntry | None  # None: the profile does not state the values now in the control
    modes: list[ModeLimits]
    attainable: list[Attainable]  # empty: all are met, or no single one is the obstacle
    move_sizes: list[MoveSizesEntry]
    alternatives: list[Alternative]
    rules: list[Alternative]
    rule: RuleText
    warnings: list[Words]  # part of the record's warnings, too
    would_bring: list[Improvement]


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsAnswer:
    """What ``limits --json`` prints: all that needs no second search."""

    recommended: RecommendedEntry
    today: TodayEntry | None
    rules: list[Alternative]
    rule: RuleText
    assessment: AssessmentPart = of("choice.candidate.assessment")
    warnings: list[Words]


def limits_answer(found: Recommendation | Commissioning) -> LimitsAnswer:
    """Return limits, rules and verdict, as ``limits --json`` prints them."""
    choice, machine, today = found.choice, found.machine, found.today
    return entry_of(
        LimitsAnswer,
        found,
        recommended=recommended_entry(RecommendedEntry, machine, choice),
        today=today and today_entry(machine, today),
        warnings=[
            *describe_loop(found.tuned.controller),
            *choice.warnings,
            *found.tuned.warnings,
            *_failure(today),
        ],
    )


def limits_part(found: Commissioning) -> LimitsPart:
    """Return all about the limits of a record."""
    choice, machine, today, listed = found.choice, found.machine, found.today, found.listed
    kept = found.robustness
    return entry_of(
        LimitsPart,
        found,
        recommended=recommended_entry(
            LimitsEntry,
            machine,
            choice,
            frequency_range=_ends(kept.frequency_error),
            damping_range=_ends(kept.damping_error),
        ),
        listed_only=listed
        and entry_of(ListedEntry, listed, valid_for=_sizes(machine, every=False)),
        today=today and today_entry(machine, today),
        warnings=[*choice.warnings, *_failure(today)],
        would_bring=found.improvements,
    )


def _failure(today: TodaysValues | None) -> list[Message]:
    return [today.failure] if today and today.failure else []


def recommended_entry(form: type[Any], machine: Machine, choice: Choice, **more: object) -> Any:
    """Return a choice as the entry of some form that is one of recommended limits."""
    best = choice.candidate
    return entry_of(
        form,
        best,
        choice,
        setpoint_filter=best.limits.setpoint_filter or machine.control.setpoint_filter,
        valid_for=_sizes(machine, every=best.assessment.is_met),
        **more,
    )


def _sizes(machine: Machine, *, every: bool) -> list[SizesEntry]:
    """The sizes for which all requirements hold, if they do at the listed one."""
    every &= machine.requirements.every_size
    sizes = map(size_of, machine.moves)
    return [SizesEntry(smallest=0.0 if every else size, largest=size) for size in sizes]


def today_entry(machine: Machine, found: TodaysValues) -> TodayEntry:
    """Return what the values now in the control do; nothing is judged where that cannot be told."""
    judged = found.judged
    verdict = judged.assessment if judged else None
    limiting = verdict.limiting_requirement if verdict else None
    is_met = verdict is not None and verdict.is_met
    return entry_of(
        TodayEntry,
        found,
        judged,
        bound_by=limiting.message if limiting else None,
        meets_requirements=is_met,
        keeps_reserve=verdict is not None and verdict.keeps_reserve,
        valid_for=_sizes(machine, every=is_met),
        **({} if judged else dict.fromkeys(REACHED)),
    )
