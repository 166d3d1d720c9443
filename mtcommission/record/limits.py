"""Commissioning -> all about the limits, as the record holds it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from math import isfinite
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning, Recommendation
from mtcommission.limits.choose import Choice
from mtcommission.limits.commissioning_rule.rule import ADVICE, DESCRIPTION, VALIDITY
from mtcommission.limits.commissioning_rule.rule import RuleResult as RuleOutcome
from mtcommission.machine.machine import Machine, Reserve
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
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.attainable import Attainable
from mtcommission.study.improvements import Improvement
from mtcommission.study.kept_range import DampingRange, FrequencyError
from mtcommission.study.loop_choice import describe_loop
from mtcommission.study.machining_modes import NO_LIMITS, ModeLimits
from mtcommission.study.move_sizes import MoveSizes
from mtcommission.study.today import TodaysValues
from mtcommission.verdict.evaluate import Candidate

Array = NDArray[np.float64]
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


def limits_part(
    commissioning: Commissioning, *, improvements: Sequence[Improvement] = ()
) -> LimitsPart:
    """Return all about the limits, as ``limits --json`` prints it.

    Parameters
    ----------
    commissioning
        What was computed.
    improvements
        What single changes would bring, for a record.
    """
    choice, best, machine = commissioning.choice, commissioning.recommended, commissioning.machine
    seen, today = choice.landscape, commissioning.today
    reserve = machine.requirements.reserve
    return LimitsPart(
        recommended=LimitsEntry(
            **_recommended(machine, choice),
            frequency_range=_range(commissioning.robustness.frequency_error),
            damping_range=_range(commissioning.robustness.damping_range),
        ),
        listed_only=_listed_entry(machine, commissioning.listed),
        today=_today_entry(machine, today) if today else None,
        modes=[_mode_entry(mode) for mode in commissioning.modes],
        attainable=[_attainable_entry(item) for item in commissioning.attainable],
        move_sizes=[_move_sizes_entry(item) for item in commissioning.move_sizes],
        alternatives=[_judged(Alternative, item, reserve) for item in commissioning.alternatives],
        rules=[_judged(RuleResult, item, reserve) for item in commissioning.rules],
        rule=_rule_text(commissioning.rule),
        landscape=entry_of(
            Landscape,
            seen,
            settling_time=_plotted(seen.settling_time),
            residual_deviation=_plotted(seen.residual_deviation),
            usage=_plotted(seen.usage),
        ),
        warnings=[
            *choice.warnings,
            *([today.failure] if today and today.failure else []),
            *commissioning.left_out,
        ],
        would_bring=[_improvement_entry(item, before=best.settling_time) for item in improvements],
    )


def limits_answer(found: Recommendation) -> LimitsAnswer:
    """Return limits, rules and verdict, as ``limits --json`` prints them."""
    choice, machine, today = found.choice, found.machine, found.today
    reserve, best = machine.requirements.reserve, choice.candidate
    assert found.rule is not None
    return LimitsAnswer(
        recommended=RecommendedEntry(**_recommended(machine, choice)),
        today=_today_entry(machine, today) if today else None,
        rules=[_judged(RuleResult, item, reserve) for item in found.rules],
        rule=_rule_text(found.rule),
        assessment=assessment_part(best.assessment, reserve),
        warnings=[
            *describe_loop(found.tuned.controller),
            *choice.warnings,
            *found.tuned.warnings,
            *([today.failure] if today and today.failure else []),
        ],
    )


def _recommended(machine: Machine, choice: Choice) -> dict[str, Any]:
    """The fields of a ``RecommendedEntry``."""
    best = choice.candidate
    item = best.limits.setpoint_filter or machine.control.setpoint_filter
    entry = entry_of(
        RecommendedEntry,
        best,
        best.limits,
        setpoint_filter=filter_entry(item),
        bound_by=choice.bound_by,
        valid_for=_sizes(machine, every=best.assessment.is_met),
        worst_sizes=[
            entry_of(WorstSizeEntry, check, requirement=check.requirement.key)
            for check in best.sizes
        ],
    )
    return {field.name: getattr(entry, field.name) for field in fields(entry)}


def _improvement_entry(item: Improvement, *, before: float) -> ImprovementEntry:
    return entry_of(
        ImprovementEntry,
        item,
        name=item.change.kind.removeprefix("change-"),
        share=item.saved / before,
        outcome=item.outcome or "",
    )


def _range(error: FrequencyError | DampingRange) -> list[float] | None:
    ends = [error.kept_from, error.kept_to]
    return ends if all(map(isfinite, ends)) else None


def _sizes(machine: Machine, *, every: bool) -> list[SizesEntry]:
    """From which size of each move to which all requirements hold, if they do at the listed one."""
    every &= machine.requirements.every_size
    sizes = map(size_of, machine.moves)
    return [SizesEntry(smallest=0.0 if every else size, largest=size) for size in sizes]


def _listed_entry(machine: Machine, found: Candidate | None) -> ListedEntry | None:
    if found is None:
        return None
    return entry_of(
        ListedEntry,
        found,
        found.limits,
        meets_requirements=found.assessment.is_met,
        keeps_reserve=found.assessment.keeps(machine.requirements.reserve),
        setpoint_filter=filter_entry(found.limits.setpoint_filter),
        valid_for=_sizes(machine, every=False),
    )


def _today_entry(machine: Machine, found: TodaysValues) -> TodayEntry:
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
        frequency_range=_range(found.frequency_error) if found.frequency_error else None,
        valid_for=_sizes(machine, every=judged is not None and judged.assessment.is_met),
    )


def _judged(form: type[Judged], item: Candidate, reserve: Reserve) -> Judged:
    return entry_of(
        form,
        item,
        item.limits,
        meets_requirements=item.assessment.is_met,
        keeps_reserve=item.assessment.keeps(reserve),
    )


def _attainable_entry(item: Attainable) -> AttainableEntry:
    return entry_of(
        AttainableEntry,
        item,
        item.limits,
        requirement=item.requirement.key,
        together_with=[other.key for other in item.together_with],
    )


def _rule_text(rule: RuleOutcome) -> RuleText:
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


def _mode_entry(mode: ModeLimits) -> ModeLimitsEntry:
    candidate, found = mode.candidate, mode.attainable
    is_met = candidate.assessment.is_met
    nothing = dict.fromkeys(
        (
            "acceleration",
            "jerk",
            "jerk_time",
            "settling_time",
            "residual_deviation",
            "peak_deviation",
        )
    )
    return entry_of(
        ModeLimitsEntry,
        mode,
        candidate,
        candidate.limits,
        bound_by=mode.bound_by if is_met else NO_LIMITS,
        meets_requirements=is_met,
        reason="" if is_met else NO_LIMITS,
        attainable=found.value if found else None,
        **({} if is_met else nothing),
    )


def _move_sizes_entry(item: MoveSizes) -> MoveSizesEntry:
    way, move = item.way, item.move
    is_limited = way.limits.jerk_time > 2.0 * NO_JERK_LIMIT
    return entry_of(
        MoveSizesEntry,
        item,
        way,
        way.limits,
        way=way.name,
        jerk=way.limits.jerk if is_limited else None,
        setpoint_filter=filter_entry(way.limits.setpoint_filter),
        move=describe_move(move),
        own=size_of(move),
        size=[_five_digits(value) for value in item.size.tolist()],
        settling_time=_row(item.settling_time),
        residual_deviation=_row(item.residual_deviation),
    )


def _plotted(grid: Array) -> list[list[float | None]]:
    """A grid for plots only."""
    return [_row(row) for row in grid]


def _row(values: Array) -> list[float | None]:
    return [finite_or_none(_five_digits(value)) for value in values.tolist()]


def _five_digits(value: float) -> float:
    """Enough for a plot, and short to write."""
    return float(f"{value:.5g}")
