"""What the limits do to the moves: response, the optimum as yardstick, other limits, what helps."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.schema.limits import ImprovementEntry
from mtcommission.record.schema.moves import MoveEntry
from mtcommission.record.schema.optima import OptimaEntry
from mtcommission.record.schema.record import Record
from mtcommission.sheet.limits_part import limits_numbers, number_columns
from mtcommission.sheet.model import Block, Column, Paragraph, Table, Tone, name_and_numbers
from mtcommission.sheet.motion_part import response_plot
from mtcommission.sheet.sizes_part import size_plot
from mtcommission.sheet.values import is_of_calibration, settling
from mtcommission.sheet.verdict_part import (
    keeps_reserve,
    met_at_all,
    move_title,
    slowest_move,
)

MOST_CHANGES = 5
"""Changes that are listed; those that bring less are named."""


NO_BAND = ("band-saves-nothing", "band-wider-than-move", "band-optimum-failed")
"""Remarks on why there is no optimum with the band in place of exact rest."""


def response_blocks(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return the slowest move, all moves beside their optima, sizes, other limits, what helps."""
    number = slowest_move(record)
    return (
        _yardsticks(record, words),
        Paragraph(text=words.text("yardstick-note"), tone=Tone.NOTE),
        *_missing_yardsticks(record, words),
        response_plot(record, number, words),
        *size_plot(record, number, words),
        *_other_limits(record, words),
        *_improvements(record, words),
    )


def _yardsticks(record: Record, words: Catalogue) -> Table:
    """Return each move in the loop, worst corner apart, beside the least times of the drive."""
    text = words.text
    heads = (
        text("settling-time"),
        text("exact-rest"),
        text("within-band"),
        text("robust-short"),
        text("peak-deviation"),
        text("max-force"),
    )
    return Table(
        caption=text("yardstick-caption"),
        columns=name_and_numbers(text("move-head"), heads, width=2.3),
        rows=tuple(
            _yardstick(record, move, optima, number, words)
            for number, (move, optima) in enumerate(
                zip(record.moves, record.optima, strict=True), start=1
            )
        ),
    )


def _missing_yardsticks(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return why a least time within the band is a dash; nothing where none is."""
    reasons = [
        f"{words.text('move', number=number)}: {words.say(remark)}"
        for number, optima in enumerate(record.optima, start=1)
        for remark in optima.remarks
        if optima.band is None and isinstance(remark, Message) and remark.kind in NO_BAND
    ]
    return (Paragraph(text=" ".join(reasons), tone=Tone.NOTE),) if reasons else ()


def _yardstick(
    record: Record, move: MoveEntry, optima: OptimaEntry, number: int, words: Catalogue
) -> tuple[str, ...]:
    f, response = words.format, move.response
    rest = optima.constrained or optima.time

    def least(t_f: float | None) -> str:
        if t_f is None:
            return "–"
        if response.settling_time is None:
            return f.quantity(t_f, "s")
        more = f.signed_percent(response.settling_time / t_f - 1.0)
        return f"{f.quantity(t_f, 's')} ({more})"

    return (
        move_title(move.move, number, words),
        settling(response.settling_time, words),
        least(rest.t_f),
        least(optima.band.t_f if optima.band else None),
        least(optima.robust.t_f if optima.robust else None),
        f.axis(response.peak_deviation, "m"),
        f.quantity(response.max_force, record.plant.units["F"]),
    )


def _other_limits(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return today's and other limits that serve, with what they give; the others by name."""
    text, part, today = words.text, record.limits, record.limits.today
    rows: list[tuple[str, ...]] = []
    if today:
        judged = met_at_all(today.meets_requirements, today.keeps_reserve, words)
        shown = limits_numbers(today, record, words)
        known = shown if not today.failure else (*shown[:2], "–", "–", "–")
        rows.append((text("today"), *known, judged))
    is_met = met_at_all(record.assessment.met, keeps_reserve(record), words)
    chosen = len(rows)
    rows.append((text("recommended"), *limits_numbers(part.recommended, record, words), is_met))
    alone = part.listed_only
    if alone:
        judged = met_at_all(alone.meets_requirements, alone.keeps_reserve, words)
        rows.append((text("listed-short"), *limits_numbers(alone, record, words), judged))
    others = [*part.alternatives, *part.rules]
    for item in others:
        if item.meets_requirements or is_of_calibration(item):
            judged = met_at_all(item.meets_requirements, item.keeps_reserve, words)
            rows.append((words.say(item.name), *limits_numbers(item, record, words), judged))
    missed = [
        words.say(item.name)
        for item in others
        if not item.meets_requirements and not is_of_calibration(item)
    ]
    table = Table(
        caption=text("alternatives-caption"),
        columns=(Column(head=text("limits-name"), width=2.3), *number_columns(words)),
        rows=tuple(rows),
        strong_rows=(chosen,),
    )
    if not missed:
        return (table,)
    sentence = text("limits-missed", count=len(missed))
    return (table, Paragraph(text=sentence, tone=Tone.NOTE))


def _improvements(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return the changes, the one that brings most first; nothing where none was looked at."""
    text, found = words.text, record.limits.would_bring
    if not found:
        return ()
    gains = [item for item in found if item.settling_time is not None or not item.outcome]
    gains = [item for item in gains if item.saved is None or item.saved > 0.0][:MOST_CHANGES]
    rest = [words.say(item.change) for item in found if item not in gains]
    table = Table(
        caption=text("improvements-caption"),
        columns=(
            Column(head=text("improvement"), width=2.6),
            Column(head=text("settling-time"), is_number=True),
            Column(head=text("improvement-saved"), is_number=True),
            Column(head=text("improvement-share"), is_number=True),
            Column(head=text("meets"), width=2.2),
        ),
        rows=tuple(_improvement(item, words) for item in gains),
    )
    told = text("improvements-note", loop="none" if record.machine.follows else "tuned")
    if rest:
        told = f"{told} {text('improvements-none', changes=', '.join(rest))}"
    return (*([table] if gains else []), Paragraph(text=told, tone=Tone.NOTE))


def _improvement(item: ImprovementEntry, words: Catalogue) -> tuple[str, ...]:
    text, f = words.text, words.format
    judged = words.say(item.outcome) or text("yes" if item.meets_requirements else "no")
    share = "–" if item.share is None else f.signed_percent(-item.share)
    return (
        words.say(item.change),
        settling(item.settling_time, words),
        f.quantity(item.saved, "s"),
        share,
        judged,
    )
