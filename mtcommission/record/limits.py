"""Commissioning -> all about the limits, as the record holds it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning
from mtcommission.record.optima import finite_or_none
from mtcommission.record.schema import (
    Alternative,
    Landscape,
    LimitsEntry,
    LimitsPart,
    ModeLimitsEntry,
    RuleResult,
    RuleStepEntry,
    RuleText,
)

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
        modes=[
            ModeLimitsEntry(
                name=mode.name,
                band=mode.band,
                acceleration=mode.trial.limits.acceleration,
                jerk=mode.trial.limits.jerk,
                jerk_time=mode.trial.limits.jerk_time,
                bound_by=mode.choice.bound_by,
                settling_time=finite_or_none(mode.trial.settling_time),
                residual_deviation=finite_or_none(mode.trial.residual_deviation),
                meets_requirements=mode.trial.assessment.is_met,
            )
            for mode in commissioning.modes
        ],
        alternatives=[
            Alternative(
                name=trial.name,
                acceleration=trial.limits.acceleration,
                jerk=trial.limits.jerk,
                settling_time=finite_or_none(trial.settling_time),
                residual_deviation=finite_or_none(trial.residual_deviation),
                peak_deviation=trial.peak_deviation,
                meets_requirements=trial.assessment.is_met,
            )
            for trial in commissioning.alternatives
        ],
        rules=[
            RuleResult(
                name=trial.name,
                source=trial.source,
                acceleration=trial.limits.acceleration,
                jerk=trial.limits.jerk,
                settling_time=finite_or_none(trial.settling_time),
                residual_deviation=finite_or_none(trial.residual_deviation),
                peak_deviation=trial.peak_deviation,
                meets_requirements=trial.assessment.is_met,
            )
            for trial in commissioning.rules
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


def _plotted(grid: Array) -> list[list[float | None]]:
    """A grid for plots only: five digits."""
    return [[finite_or_none(float(f"{value:.5g}")) for value in row] for row in grid]
