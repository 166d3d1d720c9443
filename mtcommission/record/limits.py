"""Commissioning -> all about the limits, as the record holds it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning, ModeLimits
from mtcommission.machine.machine import VelocityStep
from mtcommission.record.data import describe_move
from mtcommission.record.optima import finite_or_none
from mtcommission.record.schema import (
    NO_LIMITS,
    Alternative,
    AttainableEntry,
    JudgedLimits,
    Landscape,
    LimitsEntry,
    LimitsPart,
    ModeLimitsEntry,
    MoveSizesEntry,
    RuleResult,
    RuleStepEntry,
    RuleText,
)
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT
from mtcommission.study.attainable import Attainable
from mtcommission.study.evaluate import Candidate
from mtcommission.study.move_sizes import MoveSizes

Array = NDArray[np.float64]


def limits_part(commissioning: Commissioning) -> LimitsPart:
    """Return all about the limits, as ``limits --json`` prints it."""
    choice, best = commissioning.choice, commissioning.recommended
    return LimitsPart(
        recommended=LimitsEntry(
            acceleration=best.limits.acceleration,
            jerk=best.limits.jerk,
            jerk_time=best.limits.jerk_time,
            bound_by=choice.bound_by,
            settling_time=finite_or_none(best.settling_time),
            residual_deviation=finite_or_none(best.residual_deviation),
            peak_deviation=best.peak_deviation,
        ),
        modes=[_mode_entry(mode) for mode in commissioning.modes],
        attainable=[_attainable_entry(item) for item in commissioning.attainable],
        move_sizes=[_move_sizes_entry(item) for item in commissioning.move_sizes],
        alternatives=[
            Alternative(name=candidate.name, **_judged(candidate))
            for candidate in commissioning.alternatives
        ],
        rules=[
            RuleResult(name=candidate.name, source=candidate.source, **_judged(candidate))
            for candidate in commissioning.rules
        ],
        rule=_rule_text(commissioning),
        landscape=Landscape(
            acceleration=choice.acceleration.tolist(),
            jerk_time=choice.jerk_time.tolist(),
            settling_time=_plotted(choice.settling_time),
            residual_deviation=_plotted(choice.residual_deviation),
            usage=_plotted(choice.usage),
        ),
        search={"evaluations": choice.evaluations},
    )


def _judged(candidate: Candidate) -> JudgedLimits:
    return JudgedLimits(
        acceleration=candidate.limits.acceleration,
        jerk=candidate.limits.jerk,
        settling_time=finite_or_none(candidate.settling_time),
        residual_deviation=finite_or_none(candidate.residual_deviation),
        peak_deviation=candidate.peak_deviation,
        meets_requirements=candidate.assessment.is_met,
    )


def _attainable_entry(item: Attainable) -> AttainableEntry:
    return AttainableEntry(
        requirement=item.requirement,
        limit=item.limit,
        value=item.value,
        unit=item.unit,
        acceleration=item.limits.acceleration,
        jerk=item.limits.jerk,
        together_with=list(item.together_with),
    )


def _rule_text(commissioning: Commissioning) -> RuleText:
    rule = commissioning.rule
    return RuleText(
        text=(
            "A rule to apply by hand: each jerk step leaves a vibration in every mode and a tail "
            "of the servo loop, both in proportion to the jerk; ramps of whole periods cancel "
            "the vibration. Of the ramps tried, the one with the shortest motion is taken."
        ),
        formula=rule.formula,
        valid_for=rule.validity,
        acceleration=rule.limits.acceleration,
        jerk=rule.limits.jerk,
        jerk_time=rule.limits.jerk_time,
        chosen=rule.chosen,
        bound_by=rule.bound_by,
        predicted_settling_time=finite_or_none(rule.predicted_settling_time),
        predicted_residual=finite_or_none(rule.predicted_residual),
        steps=[
            RuleStepEntry(
                name=step.name,
                formula=step.formula,
                value=finite_or_none(step.value),
                unit=step.unit,
            )
            for step in rule.steps
        ],
        warnings=list(rule.warnings),
    )


def _mode_entry(mode: ModeLimits) -> ModeLimitsEntry:
    candidate, limits = mode.candidate, mode.candidate.limits
    is_met = candidate.assessment.is_met
    return ModeLimitsEntry(
        name=mode.name,
        band=mode.band,
        acceleration=limits.acceleration if is_met else None,
        jerk=limits.jerk if is_met else None,
        jerk_time=limits.jerk_time if is_met else None,
        bound_by=mode.choice.bound_by if is_met else NO_LIMITS,
        settling_time=finite_or_none(candidate.settling_time) if is_met else None,
        residual_deviation=finite_or_none(candidate.residual_deviation) if is_met else None,
        peak_deviation=candidate.peak_deviation if is_met else None,
        meets_requirements=is_met,
        reason="" if is_met else NO_LIMITS,
        attainable=mode.attainable.value if mode.attainable else None,
    )


def _move_sizes_entry(item: MoveSizes) -> MoveSizesEntry:
    way, move = item.way, item.move
    is_limited = way.limits.jerk_time > 2.0 * NO_JERK_LIMIT
    return MoveSizesEntry(
        way=way.name,
        acceleration=way.limits.acceleration,
        jerk=way.limits.jerk if is_limited else None,
        moving_average=way.moving_average,
        move=describe_move(move),
        own=move.velocity_step if isinstance(move, VelocityStep) else move.distance,
        size=[_five_digits(value) for value in item.size.tolist()],
        settling_time=_row(item.settling_time),
        residual_deviation=_row(item.residual_deviation),
        full_from=finite_or_none(item.full_from),
        kept_from=finite_or_none(item.kept_from),
        kept_to=finite_or_none(item.kept_to),
    )


def _plotted(grid: Array) -> list[list[float | None]]:
    """A grid for plots only."""
    return [_row(row) for row in grid]


def _row(values: Array) -> list[float | None]:
    return [finite_or_none(_five_digits(value)) for value in values.tolist()]


def _five_digits(value: float) -> float:
    """Enough for a plot, and short to write."""
    return float(f"{value:.5g}")
