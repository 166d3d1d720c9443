"""Commissioning -> all about the limits, as the record holds it."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning, ModeLimits
from mtcommission.machine.machine import VelocityStep
from mtcommission.record.data import describe_move
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
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT
from mtcommission.study.evaluate import Trial
from mtcommission.study.move_sizes import MoveSizes

Array = NDArray[np.float64]
Judged = TypeVar("Judged", bound=JudgedLimits)


def limits_part(commissioning: Commissioning) -> LimitsPart:
    """Return all about the limits, as ``limits --json`` prints it."""
    choice, best = commissioning.choice, commissioning.recommended
    return LimitsPart(
        recommended=entry_of(LimitsEntry, best, best.limits, bound_by=choice.bound_by),
        modes=[_mode_entry(mode) for mode in commissioning.modes],
        attainable=[
            entry_of(AttainableEntry, item, item.limits) for item in commissioning.attainable
        ],
        move_sizes=[_move_sizes_entry(item) for item in commissioning.move_sizes],
        alternatives=[_judged(Alternative, trial) for trial in commissioning.alternatives],
        rules=[_judged(RuleResult, trial) for trial in commissioning.rules],
        rule=_rule_text(commissioning),
        landscape=entry_of(
            Landscape,
            choice,
            settling_time=_plotted(choice.settling_time),
            residual_deviation=_plotted(choice.residual_deviation),
            usage=_plotted(choice.usage),
        ),
        search={"evaluations": choice.evaluations},
    )


def _judged(form: type[Judged], trial: Trial) -> Judged:
    return entry_of(form, trial, trial.limits, meets_requirements=trial.assessment.is_met)


def _rule_text(commissioning: Commissioning) -> RuleText:
    rule = commissioning.rule
    return entry_of(
        RuleText,
        rule,
        rule.limits,
        text=(
            "A rule to apply by hand: each jerk step leaves a vibration in every mode and a tail "
            "of the servo loop, both in proportion to the jerk; ramps of whole periods cancel "
            "the vibration. Of the ramps tried, the one with the shortest motion is taken."
        ),
        valid_for=rule.validity,
        steps=[entry_of(RuleStepEntry, step) for step in rule.steps],
    )


def _mode_entry(mode: ModeLimits) -> ModeLimitsEntry:
    trial, found = mode.trial, mode.attainable
    is_met = trial.assessment.is_met
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
        trial,
        trial.limits,
        bound_by=mode.choice.bound_by if is_met else NO_LIMITS,
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
        move=describe_move(move),
        own=move.velocity_step if isinstance(move, VelocityStep) else move.distance,
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
