"""Recommendation and commissioning -> all about the limits, as the record holds it."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.choose import Choice
from mtcommission.limits.commissioning_rule import ADVICE, DESCRIPTION, VALIDITY
from mtcommission.limits.commissioning_rule import RuleResult as RuleOutcome
from mtcommission.limits.judge import Candidate
from mtcommission.machine.machine import Machine
from mtcommission.recommend import Recommendation
from mtcommission.record.data import describe_move, filter_entry
from mtcommission.record.moves import assessment_part
from mtcommission.record.schema.limits import (
    Alternative,
    AttainableEntry,
    ImprovementEntry,
    JudgedLimits,
    Landscape,
    LimitsEntry,
    LimitsPart,
    ListedEntry,
    ModeLimitsEntry,
    MoveSizesEntry,
    RecommendedEntry,
    RuleResult,
    RuleText,
    SizesEntry,
    TodayEntry,
)
from mtcommission.record.schema.moves import AssessmentPart
from mtcommission.record.schema.values import Words
from mtcommission.record.shape import entry_of
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.attainable import NO_LIMITS, ModeLimits
from mtcommission.study.loops import describe_loop
from mtcommission.study.robustness import KeptRange, MoveSizes
from mtcommission.study.rules import TodaysValues

if TYPE_CHECKING:  # the optima and their libraries take a second; ``limits`` needs none of them
    from mtcommission.commission import Commissioning

Array = NDArray[np.float64]
Judged = TypeVar("Judged", bound=JudgedLimits)

REACHED = ("settling_time", "residual_deviation", "peak_deviation")
"""What is None where nothing was judged."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsAnswer:
    """What ``limits --json`` prints: all that needs no second search."""

    recommended: RecommendedEntry
    today: TodayEntry | None
    rules: list[RuleResult]
    rule: RuleText
    assessment: AssessmentPart
    warnings: list[Words]


def limits_answer(found: Recommendation | Commissioning) -> LimitsAnswer:
    """Return limits, rules and verdict, as ``limits --json`` prints them."""
    choice, machine, today = found.choice, found.machine, found.today
    assert found.rule is not None
    return LimitsAnswer(
        recommended=_recommended(RecommendedEntry, machine, choice),
        today=_today(machine, today) if today else None,
        rules=[_judged(RuleResult, item, machine) for item in found.rules],
        rule=_rule_text(found.rule),
        assessment=assessment_part(choice.candidate.assessment, machine.requirements.reserve),
        warnings=[
            *describe_loop(found.tuned.controller),
            *choice.warnings,
            *found.tuned.warnings,
            *([today.failure] if today and today.failure else []),
        ],
    )


def limits_part(found: Commissioning) -> LimitsPart:
    """Return all about the limits of a record."""
    choice, machine, today, listed = found.choice, found.machine, found.today, found.listed
    seen = choice.landscape
    return LimitsPart(
        recommended=_recommended(
            LimitsEntry,
            machine,
            choice,
            frequency_range=_ends(found.robustness.frequency_error),
            damping_range=_ends(found.robustness.damping_range),
        ),
        listed_only=_judged(
            ListedEntry,
            listed,
            machine,
            setpoint_filter=filter_entry(listed.limits.setpoint_filter),
            valid_for=_sizes(machine, every=False),
        )
        if listed
        else None,
        today=_today(machine, today) if today else None,
        modes=[_mode_entry(mode) for mode in found.modes],
        attainable=[entry_of(AttainableEntry, item, item.limits) for item in found.attainable],
        move_sizes=[_move_sizes_entry(item) for item in found.move_sizes],
        alternatives=[_judged(Alternative, item, machine) for item in found.alternatives],
        rules=[_judged(RuleResult, item, machine) for item in found.rules],
        rule=_rule_text(found.rule),
        landscape=entry_of(
            Landscape,
            seen,
            settling_time=_plotted(seen.settling_time),
            residual_deviation=_plotted(seen.residual_deviation),
            usage=_plotted(seen.usage),
        ),
        warnings=[*choice.warnings, *([today.failure] if today and today.failure else [])],
        would_bring=[
            entry_of(
                ImprovementEntry,
                item,
                name=item.change.kind.removeprefix("change-"),
                share=item.saved / found.recommended.settling_time,
                outcome=item.outcome or "",
            )
            for item in found.improvements
        ],
    )


def _recommended(form: type[Any], machine: Machine, choice: Choice, **more: object) -> Any:
    best = choice.candidate
    item = best.limits.setpoint_filter or machine.control.setpoint_filter
    return entry_of(
        form,
        best,
        best.limits,
        setpoint_filter=filter_entry(item),
        bound_by=choice.bound_by,
        valid_for=_sizes(machine, every=best.assessment.is_met),
        worst_sizes=best.sizes,
        **more,
    )


def _ends(error: KeptRange) -> list[float] | None:
    """Both ends of a range that was found; None where an end was not."""
    ends = [error.kept_from, error.kept_to]
    return ends if all(map(isfinite, ends)) else None


def _sizes(machine: Machine, *, every: bool) -> list[SizesEntry]:
    """The sizes for which all requirements hold, if they do at the listed one."""
    every &= machine.requirements.every_size
    sizes = map(size_of, machine.moves)
    return [SizesEntry(smallest=0.0 if every else size, largest=size) for size in sizes]


def _judged(form: type[Judged], item: Candidate, machine: Machine, **more: object) -> Judged:
    return entry_of(
        form,
        item,
        item.limits,
        meets_requirements=item.assessment.is_met,
        keeps_reserve=item.assessment.keeps(machine.requirements.reserve),
        **more,
    )


def _today(machine: Machine, found: TodaysValues) -> TodayEntry:
    """What the values now in the control do; nothing is judged where that cannot be told."""
    judged, loop = found.judged, found.controller
    limiting = judged and judged.assessment.limiting_requirement
    return entry_of(
        TodayEntry,
        found.today,
        found,
        found.limits,
        *([judged] if judged else []),
        setpoint_filter=filter_entry(found.today.setpoint_filter),
        Kv=loop.position_gain,
        Kp=loop.velocity_gain,
        Tn=loop.integral_time,
        bound_by=limiting.message if limiting else None,
        meets_requirements=judged is not None and judged.assessment.is_met,
        keeps_reserve=judged is not None and judged.assessment.keeps(machine.requirements.reserve),
        frequency_range=_ends(found.frequency_error) if found.frequency_error else None,
        valid_for=_sizes(machine, every=judged is not None and judged.assessment.is_met),
        **({} if judged else dict.fromkeys(REACHED)),
    )


def _rule_text(rule: RuleOutcome) -> RuleText:
    """The commissioning rule, applied to a machine."""
    return entry_of(
        RuleText,
        rule,
        rule.best,
        rule.limits,
        text=DESCRIPTION,
        formula=rule.formulas,
        advice=ADVICE,
        valid_for=VALIDITY,
        chosen=rule.best.name,
        predicted_residual=rule.best.residual_deviation,
    )


def _mode_entry(mode: ModeLimits) -> ModeLimitsEntry:
    candidate, found = mode.candidate, mode.attainable
    is_met = candidate.assessment.is_met
    return entry_of(
        ModeLimitsEntry,
        mode,
        candidate,
        candidate.limits,
        bound_by=mode.bound_by if is_met else NO_LIMITS,
        meets_requirements=is_met,
        reason="" if is_met else NO_LIMITS,
        attainable=found.value if found else None,
        **({} if is_met else dict.fromkeys(("acceleration", "jerk", "jerk_time", *REACHED))),
    )


def _move_sizes_entry(item: MoveSizes) -> MoveSizesEntry:
    limits = item.limits
    is_limited = limits.jerk_time > 2.0 * NO_JERK_LIMIT
    return entry_of(
        MoveSizesEntry,
        item,
        limits,
        way=item.name,
        jerk=limits.jerk if is_limited else None,
        setpoint_filter=filter_entry(limits.setpoint_filter),
        move=describe_move(item.move),
        own=size_of(item.move),
        size=_plotted(item.size),
        settling_time=_plotted(item.settling_time),
        residual_deviation=_plotted(item.residual_deviation),
    )


def _plotted(values: Array) -> Array:
    """Values to five digits: enough for a plot, and short to write."""
    return np.array([float(f"{value:.5g}") for value in values.flat]).reshape(values.shape)
