"""Limits and responses as the terminal shows them."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.text import Text

from mtcommission.cli.terminal import empty_table, heading, warn, words_for
from mtcommission.machine.basis import list_assumed
from mtcommission.machine.machine import Machine
from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.limits import LimitsAnswer
from mtcommission.record.schema.limits import (
    RecommendedEntry,
    RuleResult,
    TodayEntry,
)
from mtcommission.record.schema.moves import AssessmentPart, SimulationPart
from mtcommission.sheet.limits import ROUNDED
from mtcommission.sheet.tables import filter_rows, say_requirement
from mtcommission.sheet.verdict import share_used, verdict_on


def describe_limits(machine: Machine, answer: LimitsAnswer) -> Group:
    """Return the recommendation and its verdict, the rules beside it, and the warnings."""
    spoken, length = words_for(machine), machine.axis_units.length.si
    printed, said, best = spoken.format, spoken.say, answer.recommended
    unsettled, no_limit = spoken.text("terminal-not-settled"), spoken.text("no-jerk-limit")
    table = empty_table(spoken, "limits", "a", "j", "settling", "residual", "peak", "met")
    entries: list[tuple[str, RecommendedEntry | TodayEntry | RuleResult, bool]]
    entries = [(spoken.text("terminal-recommended"), best, answer.assessment.met)]
    today = answer.today
    if today:
        entries.insert(0, (spoken.text("terminal-today"), today, today.meets_requirements))
    entries += [(said(rule.name), rule, rule.meets_requirements) for rule in answer.rules]
    for name, entry, keeps in entries:
        is_step = _is_step(machine, entry.acceleration, entry.jerk)
        table.add_row(
            escape(name),
            printed.quantity(entry.acceleration, f"{length}/s^2"),
            printed.quantity(
                None if is_step else entry.jerk,
                f"{length}/s^3",
                missing=no_limit if is_step or entry is today else "–",
            ),
            printed.quantity(entry.settling_time, "s", missing=unsettled),
            printed.quantity(entry.residual_deviation, length),
            printed.quantity(entry.peak_deviation, length),
            spoken.text("yes" if keeps else "no"),
        )
    rule, item = answer.rule, best.setpoint_filter
    rows = filter_rows(item, spoken) if item else []
    return Group(
        heading(spoken.text("limits-name")),
        Text(spoken.text("terminal-bound-by", what=said(best.bound_by))),
        *(Text(f"{name}: {value}") for name, value in rows),
        table,
        *([Text(said(today.basis))] if today else []),
        Text(
            spoken.text(
                "terminal-by-hand",
                chosen=said(rule.chosen),
                acceleration=rule.acceleration,
                jerk=rule.jerk,
            )
        ),
        *_verdict(spoken, answer.assessment),
        _assumed(machine, spoken),
        *warn(spoken, answer.warnings),
    )


def _is_step(machine: Machine, acceleration: float | None, jerk: float | None) -> bool:
    """Whether a jerk limits nothing: the control has none, and the ramp takes one cycle."""
    if acceleration is None or jerk is None or machine.control.kind.has_jerk_limit:
        return False
    return acceleration < ROUNDED * machine.control.position_cycle * jerk


def _assumed(machine: Machine, spoken: Catalogue) -> Text:
    """What nobody stated of the machine."""
    return Text(spoken.text("terminal-assumed", what=tuple(list_assumed(machine))))


def describe_simulation(machine: Machine, part: SimulationPart) -> Group:
    """Return the worst response of each move and the verdict."""
    spoken, axis = words_for(machine), machine.axis_units
    printed, unsettled = spoken.format, spoken.text("terminal-not-settled")
    mass, length, force = axis.mass.si, axis.length.si, axis.force.si
    table = empty_table(spoken, "move", "corner", "settling", "residual", "peak", "set-force")
    for number, move in enumerate(part.moves, start=1):
        for index, response in enumerate(move.corners):
            corner = (
                spoken.text("terminal-nominal")
                if index == 0
                else spoken.text(
                    "terminal-corner",
                    payload=printed.quantity(response.payload, mass),
                    frequency=response.frequency_factor,
                    damping=response.damping_factor,
                )
            )
            wanted = printed.quantity(response.max_force, force)
            table.add_row(
                str(number),
                corner,
                printed.quantity(response.settling_time, "s", missing=unsettled),
                printed.quantity(response.residual_deviation, length, missing=unsettled),
                printed.quantity(response.peak_deviation, length),
                spoken.text("terminal-saturated", force=wanted) if response.saturated else wanted,
            )
    verdict = _verdict(spoken, part.assessment)
    warnings = warn(spoken, part.warnings)
    parts = (table, *verdict, _assumed(machine, spoken), *warnings)
    return Group(heading(spoken.text("terminal-response")), *parts)


def _verdict(spoken: Catalogue, assessment: AssessmentPart) -> list[RenderableType]:
    printed, lines = spoken.format, list[RenderableType]()
    unsettled = spoken.text("terminal-not-settled")
    for check in assessment.checks:
        line = spoken.text(
            "terminal-check",
            verdict=verdict_on(check, spoken),
            name=say_requirement(check.name, spoken),
            value=printed.quantity(check.value, check.unit, missing=unsettled),
            limit=printed.quantity(check.limit, check.unit),
            share=share_used(check, spoken),
            where=spoken.say(check.where),
        )
        lines.append(Text(line, style="green" if check.met else "red"))
    return lines
