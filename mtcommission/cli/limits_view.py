"""Limits and responses as the terminal shows them: what one screen holds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from math import inf
from operator import itemgetter

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.cli.terminal import Line, fold, heading, list_quantities, warn
from mtcommission.controls.kind import Jerk
from mtcommission.machine.checks import say_filter, say_jerk
from mtcommission.machine.machine import Machine
from mtcommission.record.limits import Alternative, LimitsAnswer, RecommendedEntry, TodayEntry
from mtcommission.record.moves import AssessmentPart, ResponseEntry, SimulationPart
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.sheet.limits import limits_columns
from mtcommission.sheet.tables import (
    MAX_FORCE,
    PEAK,
    RESIDUAL,
    SETTLING,
    Quantity,
    place_columns,
    say_requirement,
    show,
)
from mtcommission.sheet.verdict import check_columns, move_title

ROWS = 23
"""Of a screen of 24 lines, below which the shell asks for the next command."""

OF_LOOP = ("simulated-with-loop", "simulated-with-filters", "simulated-without-loop")
"""Kinds of what is said of the loop, no warnings."""

ASSUMED_ROWS = 3
"""Of what is assumed; ``check`` and page 1 of the sheet name all of it."""


def describe_limits(
    machine: Machine,
    answer: LimitsAnswer,
    spoken: Catalogue,
    *,
    assumed: Sequence[str],
    further: Iterable[Message | str] = (),
    rows: int = ROWS,
    has_sheet: bool = False,
) -> list[Line]:
    """Return the answer of ``limits`` and ``run`` on one screen, more only where warnings are long.

    ``assumed``: what nobody stated; ``further``: what is said where there is room, the most
    important first; ``rows`` of the screen; ``has_sheet``: whether a sheet says what is left out.
    """
    text, said, best, verdict = spoken.text, spoken.say, answer.recommended, answer.assessment
    warned = warn(spoken, [one for one in answer.warnings if not _is_of_loop(one)])
    shown = [
        *_verdict(machine, verdict, spoken),
        *warned,
        *_limits_table(machine, answer, spoken),
        _filter(machine, best, spoken),
        text("terminal-bound-by", what=said(best.bound_by)),
        *_checks(machine, verdict, spoken),
    ]  # fmt: skip
    room = rows - len(fold(shown))
    shown += [_assumed(assumed, spoken, rows=min(room, ASSUMED_ROWS))]
    notes = [
        *(said(one) for one in answer.warnings if _is_of_loop(one)),
        *(_loop_today(machine, spoken) if answer.today else []),
        *([said(answer.today.basis)] if answer.today else []),
        *map(said, further),
    ]
    more = f"terminal-more-notes-{'in-sheet' if has_sheet else 'of-run'}"
    return [*shown, *_as_many(notes, rows - len(fold(shown)), more, spoken)]


def _as_many(notes: Sequence[Line], room: int, more: str, spoken: Catalogue) -> Iterator[Line]:
    """Yield the notes for which there is room, and how many there are ``more``."""
    sizes = [len(fold([note])) for note in notes]
    left_out = 0
    for place, (note, size) in enumerate(zip(notes, sizes, strict=True)):
        is_last = place + 1 == len(notes) and not left_out
        if size <= room - (0 if is_last else 1):
            room -= size
            yield note
        else:
            left_out += 1
    if left_out:
        yield spoken.text(more, count=left_out)


def _filter(machine: Machine, best: RecommendedEntry, spoken: Catalogue) -> str:
    """The setpoint filter that belongs to the limits, and the ramp, the jerk time if so entered."""
    kind = "terminal-filter-with-limits" if best.setpoint_filter else "setpoint-filter"
    said = f"{spoken.text(kind)}: {say_filter(best.setpoint_filter, spoken)}"
    if not machine.control.kind.has_jerk_limit:
        return said
    ramp = "a/j" if machine.control.kind.jerk is Jerk.LIMIT else spoken.text("jerk-time")
    return f"{said}. {ramp}: {show(best.jerk_time, spoken, 's')}"


def _is_of_loop(note: Message | str) -> bool:
    return isinstance(note, Message) and note.kind in OF_LOOP


def _verdict(machine: Machine, verdict: AssessmentPart, spoken: Catalogue) -> Iterator[Line]:
    yield heading(spoken.text("terminal-machine", name=machine.name, axis_name=machine.axis))
    kind, style = ("verdict-met", "green") if verdict.met else ("verdict-not-met", "red")
    yield spoken.text(kind), f"bold {style}"
    if verdict.obstacle:
        yield spoken.text("obstacle", obstacle=say_requirement(verdict.obstacle, spoken))


def _loop_today(machine: Machine, spoken: Catalogue) -> Iterator[str]:
    today, form = machine.today, spoken.format
    gains = (
        ("Kv", today and today.position_gain, "1/s"),
        ("Kp", today and today.velocity_gain, "N s/m"),
        ("Tn", today and today.integral_time, "s"),
    )
    if stated := [f"{name} {form.axis(gain, unit)}" for name, gain, unit in gains if gain]:
        yield spoken.text("terminal-loop-today", gains=", ".join(stated))


Entry = RecommendedEntry | TodayEntry | Alternative


def _limits_table(machine: Machine, answer: LimitsAnswer, spoken: Catalogue) -> list[Line]:
    """Today's limits, the recommended ones, the rule by hand, and the best rule of thumb."""
    text, today, rules = spoken.text, answer.today, answer.rules
    rows: list[tuple[str, Entry, bool]] = [
        (text("recommended"), answer.recommended, answer.assessment.met)
    ]
    if today:
        rows.insert(0, (text("today"), today, today.meets_requirements))
    kept = [one for one in rules[1:] if one.meets_requirements]
    best = sorted(kept, key=lambda one: inf if one.settling_time is None else one.settling_time)
    others = (*rules[:1], *best[:1])
    rows += [(spoken.say(one.name), one, one.meets_requirements) for one in others]
    every = machine.requirements.every_size
    first = Quantity("terminal-limits-listed" if every else "limits-name", itemgetter(0))
    acceleration, jerk, *reached, _ = limits_columns(machine.control.shortest_ramp, spoken)
    given = (replace(acceleration, name="a"), replace(jerk, name="j"), *reached)
    columns = (
        first,
        *(one.within(itemgetter(1)) for one in given),
        Quantity("meets", itemgetter(2)),
    )
    styles = ["bold" if one is answer.recommended else "" for _, one, _ in rows]
    shown = list_quantities(spoken, columns, rows, styles)
    if more := [one for one in rules if one not in others]:
        met = sum(one.meets_requirements for one in more)
        shown.append(text("terminal-more-rules", count=len(more), met=met))
    return shown


def _assumed(assumed: Sequence[str], spoken: Catalogue, *, rows: int) -> str:
    """What nobody stated of the machine, as far as these rows hold it; at least one of it."""
    named, more = list(assumed), 0
    while True:
        listed = "; ".join(named)
        if more:
            listed = spoken.text("assumed-more", names=listed, count=more)
        said = spoken.text("terminal-assumed", what=listed)
        if len(fold([said])) <= rows or len(named) < 2:
            return said
        named, more = named[:-1], more + 1


def _checks(machine: Machine, verdict: AssessmentPart, spoken: Catalogue) -> list[Line]:
    first = "terminal-check-any-size" if machine.requirements.every_size else "check"
    name = Quantity(first, lambda check: say_requirement(check.name, spoken))
    styles = ["green" if check.met else "red" for check in verdict.checks]
    return list_quantities(spoken, (name, *check_columns(spoken)), verdict.checks, styles)


def describe_simulation(
    machine: Machine,
    limits: MotionLimits,
    part: SimulationPart,
    assumed: Sequence[str],
    spoken: Catalogue,
    *,
    first: int,
) -> list[Line]:
    """Return what was simulated, the response of each move in each corner, and the verdict.

    ``first``: number of the first move in the profile, from 1.
    """
    corners = [
        (number, one) for number, move in enumerate(part.moves, first) for one in move.corners
    ]

    def force(item: tuple[int, ResponseEntry]) -> str:
        shown = MAX_FORCE.show(item[1], spoken)
        return spoken.text("terminal-saturated", force=shown) if item[1].saturated else shown

    places = place_columns(one for _, one in corners)
    columns = (
        Quantity("move-head", itemgetter(0), ""),
        *(one.within(itemgetter(1)) for one in (*places, SETTLING, RESIDUAL, PEAK)),
        Quantity("word-f-set", force),
    )
    worst = [
        f"{say_requirement(check.name, spoken)}: {spoken.say(check.where)}"
        for check in part.assessment.checks
    ]
    shortest = machine.control.shortest_ramp
    simulated = spoken.text(
        "terminal-simulated",
        acceleration=show(limits.acceleration, spoken, "m/s^2"),
        jerk=say_jerk(limits.acceleration, limits.jerk, shortest, spoken),
        filter=say_filter(machine.control.setpoint_filter, spoken),
        moves="; ".join(move_title(one.move, n, spoken) for n, one in enumerate(part.moves, first)),
    )
    return [
        *_verdict(machine, part.assessment, spoken),
        *warn(spoken, [one for one in part.warnings if not _is_of_loop(one)]),
        simulated,
        heading(spoken.text("terminal-response")),
        *list_quantities(spoken, columns, corners),
        *_checks(machine, part.assessment, spoken),
        spoken.text("terminal-worst", places="; ".join(worst)),
        _assumed(assumed, spoken, rows=ASSUMED_ROWS),
        *(spoken.say(one) for one in part.warnings if _is_of_loop(one)),
    ]
