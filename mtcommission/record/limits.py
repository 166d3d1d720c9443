"""Commissioning -> all about the limits, as the record holds it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning
from mtcommission.limits.judge import Candidate
from mtcommission.machine.machine import Machine
from mtcommission.record.answer import (
    ends_entry,
    judged_entry,
    recommended_fields,
    rule_text,
    sizes_entry,
    today_entry,
)
from mtcommission.record.data import describe_move, filter_entry
from mtcommission.record.schema.limits import (
    Alternative,
    AttainableEntry,
    ImprovementEntry,
    Landscape,
    LimitsEntry,
    LimitsPart,
    ListedEntry,
    ModeLimitsEntry,
    MoveSizesEntry,
    RuleResult,
)
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.attainable import Attainable
from mtcommission.study.improvements import Improvement
from mtcommission.study.machining_modes import NO_LIMITS, ModeLimits
from mtcommission.study.move_sizes import MoveSizes

Array = NDArray[np.float64]


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
            **recommended_fields(machine, choice),
            frequency_range=ends_entry(commissioning.robustness.frequency_error),
            damping_range=ends_entry(commissioning.robustness.damping_range),
        ),
        listed_only=_listed_entry(machine, commissioning.listed),
        today=today_entry(machine, today) if today else None,
        modes=[_mode_entry(mode) for mode in commissioning.modes],
        attainable=[_attainable_entry(item) for item in commissioning.attainable],
        move_sizes=[_move_sizes_entry(item) for item in commissioning.move_sizes],
        alternatives=[
            judged_entry(Alternative, item, reserve) for item in commissioning.alternatives
        ],
        rules=[judged_entry(RuleResult, item, reserve) for item in commissioning.rules],
        rule=rule_text(commissioning.rule),
        landscape=entry_of(
            Landscape,
            seen,
            settling_time=_plotted(seen.settling_time),
            residual_deviation=_plotted(seen.residual_deviation),
            usage=_plotted(seen.usage),
        ),
        warnings=[*choice.warnings, *([today.failure] if today and today.failure else [])],
        would_bring=[_improvement_entry(item, before=best.settling_time) for item in improvements],
    )


def _improvement_entry(item: Improvement, *, before: float) -> ImprovementEntry:
    return entry_of(
        ImprovementEntry,
        item,
        name=item.change.kind.removeprefix("change-"),
        share=item.saved / before,
        outcome=item.outcome or "",
    )


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
        valid_for=sizes_entry(machine, every=False),
    )


def _attainable_entry(item: Attainable) -> AttainableEntry:
    return entry_of(
        AttainableEntry,
        item,
        item.limits,
        requirement=item.requirement.key,
        together_with=[other.key for other in item.together_with],
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
