"""Recommendation -> what ``limits --json`` prints, and those parts that the record has, too."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite
from typing import Any, TypeVar

from mtcommission.limits.choose import Choice
from mtcommission.limits.commissioning_rule.rule import ADVICE, DESCRIPTION, VALIDITY
from mtcommission.limits.commissioning_rule.rule import RuleResult as RuleOutcome
from mtcommission.limits.judge import Candidate
from mtcommission.machine.machine import Machine, Reserve
from mtcommission.recommend import Recommendation
from mtcommission.record.data import filter_entry
from mtcommission.record.moves import assessment_part
from mtcommission.record.schema.limits import (
    JudgedLimits,
    RecommendedEntry,
    RuleFormulaEntry,
    RuleResult,
    RuleStepEntry,
    RuleText,
    SizesEntry,
    TodayEntry,
    WorstSizeEntry,
)
from mtcommission.record.schema.moves import AssessmentPart
from mtcommission.record.schema.values import Words
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.loop_choice import describe_loop
from mtcommission.study.robustness import KeptRange
from mtcommission.study.today import TodaysValues

Judged = TypeVar("Judged", bound=JudgedLimits)


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsAnswer:
    """What ``limits --json`` prints: all that needs no second search."""

    recommended: RecommendedEntry
    today: TodayEntry | None
    rules: list[RuleResult]
    rule: RuleText
    assessment: AssessmentPart
    warnings: list[Words]


def limits_answer(found: Recommendation) -> LimitsAnswer:
    """Return limits, rules and verdict, as ``limits --json`` prints them."""
    choice, machine, today = found.choice, found.machine, found.today
    reserve, best = machine.requirements.reserve, choice.candidate
    assert found.rule is not None
    return LimitsAnswer(
        recommended=RecommendedEntry(**recommended_fields(machine, choice)),
        today=today_entry(machine, today) if today else None,
        rules=[judged_entry(RuleResult, item, reserve) for item in found.rules],
        rule=rule_text(found.rule),
        assessment=assessment_part(best.assessment, reserve),
        warnings=[
            *describe_loop(found.tuned.controller),
            *choice.warnings,
            *found.tuned.warnings,
            *([today.failure] if today and today.failure else []),
        ],
    )


def recommended_fields(machine: Machine, choice: Choice) -> dict[str, Any]:
    """Return the fields of a ``RecommendedEntry``."""
    best = choice.candidate
    item = best.limits.setpoint_filter or machine.control.setpoint_filter
    entry = entry_of(
        RecommendedEntry,
        best,
        best.limits,
        setpoint_filter=filter_entry(item),
        bound_by=choice.bound_by,
        valid_for=sizes_entry(machine, every=best.assessment.is_met),
        worst_sizes=[
            entry_of(WorstSizeEntry, check, requirement=check.requirement.key)
            for check in best.sizes
        ],
    )
    return {field.name: getattr(entry, field.name) for field in fields(entry)}


def ends_entry(error: KeptRange) -> list[float] | None:
    """Return both ends of a range that was found; None where an end was not."""
    ends = [error.kept_from, error.kept_to]
    return ends if all(map(isfinite, ends)) else None


def sizes_entry(machine: Machine, *, every: bool) -> list[SizesEntry]:
    """Return the sizes for which all requirements hold, if they do at the listed one."""
    every &= machine.requirements.every_size
    sizes = map(size_of, machine.moves)
    return [SizesEntry(smallest=0.0 if every else size, largest=size) for size in sizes]


def today_entry(machine: Machine, found: TodaysValues) -> TodayEntry:
    """Return what the values now in the control do."""
    today, judged, loop = found.today, found.judged, found.controller
    limiting = judged and judged.assessment.limiting_requirement
    return TodayEntry(
        acceleration=today.acceleration,
        jerk=today.jerk,
        jerk_time=found.limits.jerk_time,
        setpoint_filter=filter_entry(today.setpoint_filter),
        Kv=loop.position_gain,
        Kp=loop.velocity_gain,
        Tn=loop.integral_time,
        stated=list(found.stated),
        basis=found.basis,
        failure=found.failure,
        bound_by=limiting.message if limiting else None,
        settling_time=finite_or_none(judged.settling_time) if judged else None,
        residual_deviation=finite_or_none(judged.residual_deviation) if judged else None,
        peak_deviation=finite_or_none(judged.peak_deviation) if judged else None,
        meets_requirements=judged is not None and judged.assessment.is_met,
        keeps_reserve=judged is not None and judged.assessment.keeps(machine.requirements.reserve),
        frequency_range=ends_entry(found.frequency_error) if found.frequency_error else None,
        valid_for=sizes_entry(machine, every=judged is not None and judged.assessment.is_met),
    )


def judged_entry(form: type[Judged], item: Candidate, reserve: Reserve) -> Judged:
    """Return judged limits in their form of the record."""
    return entry_of(
        form,
        item,
        item.limits,
        meets_requirements=item.assessment.is_met,
        keeps_reserve=item.assessment.keeps(reserve),
    )


def rule_text(rule: RuleOutcome) -> RuleText:
    """Return the commissioning rule, applied to a machine."""
    return entry_of(
        RuleText,
        rule,
        rule.best,
        rule.limits,
        text=DESCRIPTION,
        formula=[entry_of(RuleFormulaEntry, item) for item in rule.formulas],
        advice=ADVICE,
        valid_for=VALIDITY,
        chosen=rule.best.name,
        predicted_residual=rule.best.residual_deviation,
        steps=[entry_of(RuleStepEntry, step) for step in rule.steps],
    )
