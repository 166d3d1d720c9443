"""Limits and responses as the terminal shows them."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.text import Text

from mtcommission.cli.terminal import empty_table, heading, warn, words_for
from mtcommission.machine.basis import list_assumed
from mtcommission.machine.machine import Machine
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.schema.limits import (
    Alternative,
    LimitsEntry,
    LimitsPart,
    ModeLimitsEntry,
    MoveSizesEntry,
    RuleResult,
    TodayEntry,
)
from mtcommission.record.schema.moves import AssessmentPart, SimulationPart
from mtcommission.sheet.limits_part import ROUNDED
from mtcommission.sheet.values import say_limiting, say_requirement
from mtcommission.sheet.verdict_part import share_used, verdict_on


def describe_limits(
    machine: Machine, part: LimitsPart, *, met: bool, warnings: Sequence[Message | str]
) -> Group:
    """Return the recommendation, the optima's bounds, the rules of thumb, and the warnings."""
    spoken, length = words_for(machine), machine.axis_units.length.si
    printed, said, best = spoken.format, spoken.say, part.recommended
    unsettled, no_limit = spoken.text("terminal-not-settled"), spoken.text("no-jerk-limit")
    table = empty_table(spoken, "limits", "a", "j", "settling", "residual", "peak", "met")
    entries: list[
        tuple[str, LimitsEntry | TodayEntry | ModeLimitsEntry | Alternative | RuleResult, bool]
    ]
    entries = [(spoken.text("terminal-recommended"), best, met)]
    today = part.today
    if today:
        entries.insert(0, (spoken.text("terminal-today"), today, today.meets_requirements))
    for mode in part.modes:
        band = printed.quantity(mode.band, length)
        name = spoken.text(f"terminal-mode-{mode.name}", band=band)
        entries.append((name, mode, mode.meets_requirements))
    for other in (*part.alternatives, *part.rules):
        entries.append((said(other.name), other, other.meets_requirements))
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
            spoken.text("terminal-yes" if keeps else "terminal-no"),
        )
    rule = part.rule
    return Group(
        heading(spoken.text("terminal-limits")),
        Text(spoken.text("terminal-bound-by", what=said(best.bound_by))),
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
        *(
            Text(spoken.say(_hold_sentence(item, spoken, length)))
            for item in part.move_sizes
            if item.way == Message("way-recommended")
        ),
        *(
            Text(
                spoken.text(
                    "terminal-in-the-way",
                    obstacle=say_limiting(item, spoken),
                    limit=printed.quantity(item.limit, item.unit),
                    value=printed.quantity(item.value, item.unit),
                )
            )
            for item in part.attainable
        ),
        _assumed(machine, spoken),
        *warn(spoken, warnings),
    )


def _is_step(machine: Machine, acceleration: float | None, jerk: float | None) -> bool:
    """Whether a jerk limits nothing: the control has none, and the ramp takes one cycle."""
    if acceleration is None or jerk is None or machine.control.kind.has_jerk_limit:
        return False
    return acceleration < ROUNDED * machine.control.position_cycle * jerk


def _assumed(machine: Machine, spoken: Catalogue) -> Text:
    """What nobody stated of the machine."""
    return Text(spoken.text("terminal-assumed", what=tuple(list_assumed(machine))))


def _hold_sentence(item: MoveSizesEntry, spoken: Catalogue, length: str) -> Message:
    """Between which sizes of a move the recommendation keeps the band."""
    is_step = "velocity_step" in item.move
    unit, kind = (f"{length}/s", "steps") if is_step else (length, "distances")
    printed = spoken.format
    if item.kept_from is None:
        return Message("terminal-size-missed", sizes=kind, own=printed.quantity(item.own, unit))
    return Message(
        "terminal-sizes-kept",
        sizes=kind,
        least=printed.quantity(item.kept_from, unit),
        largest=printed.quantity(item.kept_to, unit),
        reached=printed.quantity(item.full_from, unit, missing=spoken.text("terminal-no-size")),
    )


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
