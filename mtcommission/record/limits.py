"""Commissioning -> all about the limits, as the record holds it."""

from __future__ import annotations

from math import isfinite
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning
from mtcommission.limits.commissioning_rule.rule import ADVICE, DESCRIPTION, VALIDITY
from mtcommission.machine.machine import Machine, Reserve, VelocityStep
from mtcommission.record.data import describe_move
from mtcommission.record.schema import (
    Alternative,
    AttainableEntry,
    JudgedLimits,
    Landscape,
    LimitsEntry,
    LimitsPart,
    ModeLimitsEntry,
    MoveSizesEntry,
    RuleFormulaEntry,
    RuleResult,
    RuleStepEntry,
    RuleText,
    SetpointFilterEntry,
    SizesEntry,
    TodayEntry,
)
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT
from mtcommission.study.attainable import Attainable
from mtcommission.study.machining_modes import NO_LIMITS, ModeLimits
from mtcommission.study.move_sizes import MoveSizes
from mtcommission.study.robustness import DampingRange, FrequencyError
from mtcommission.study.today import TodaysValues
from mtcommission.verdict.evaluate import Candidate

Array = NDArray[np.float64]
Judged = TypeVar("Judged", bound=JudgedLimits)


def limits_part(commissioning: Commissioning) -> LimitsPart:
    """Return all about the limits, as ``limits --json`` prints it."""
    choice, best, machine = commissioning.choice, commissioning.recommended, commissioning.machine
    seen, today = choice.landscape, commissioning.today
    reserve = machine.requirements.reserve
    return LimitsPart(
        recommended=entry_of(
            LimitsEntry,
            best,
            best.limits,
            setpoint_filter=_filter_entry(machine.control.moving_average_time),
            bound_by=choice.bound_by,
            frequency_range=_range(commissioning.robustness.frequency_error),
            damping_range=_range(commissioning.robustness.damping_range),
            valid_for=_sizes(machine),
        ),
        today=_today_entry(machine, today) if today else None,
        modes=[_mode_entry(mode) for mode in commissioning.modes],
        attainable=[_attainable_entry(item) for item in commissioning.attainable],
        move_sizes=[_move_sizes_entry(item) for item in commissioning.move_sizes],
        alternatives=[_judged(Alternative, item, reserve) for item in commissioning.alternatives],
        rules=[_judged(RuleResult, item, reserve) for item in commissioning.rules],
        rule=_rule_text(commissioning),
        landscape=entry_of(
            Landscape,
            seen,
            settling_time=_plotted(seen.settling_time),
            residual_deviation=_plotted(seen.residual_deviation),
            usage=_plotted(seen.usage),
        ),
        search={"evaluations": choice.evaluations},
        warnings=[*choice.warnings, *([today.failure] if today and today.failure else [])],
    )


def _filter_entry(time: float) -> SetpointFilterEntry | None:
    return SetpointFilterEntry(kind="moving_average", time=time) if time else None


def _range(error: FrequencyError | DampingRange) -> list[float] | None:
    ends = [error.kept_from, error.kept_to]
    return ends if all(map(isfinite, ends)) else None


def _sizes(machine: Machine) -> list[SizesEntry]:
    """Of each move the one size that is listed; no other was judged."""
    sizes = [
        move.velocity_step if isinstance(move, VelocityStep) else move.distance
        for move in machine.moves
    ]
    return [SizesEntry(smallest=size, largest=size) for size in sizes]


def _today_entry(machine: Machine, found: TodaysValues) -> TodayEntry:
    today, judged, loop = found.today, found.judged, found.controller
    limiting = judged and judged.assessment.limiting_requirement
    return TodayEntry(
        acceleration=today.acceleration,
        jerk=today.jerk,
        jerk_time=found.limits.jerk_time,
        setpoint_filter=_filter_entry(today.moving_average_time),
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
        valid_for=_sizes(machine),
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
        requirement=item.requirement.value,
        together_with=[other.value for other in item.together_with],
    )


def _rule_text(commissioning: Commissioning) -> RuleText:
    rule = commissioning.rule
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
