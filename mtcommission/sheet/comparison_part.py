"""The setpoint in the loop beside the optimal controls, and the optima fed forward."""

from __future__ import annotations

from collections import Counter

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import symbol
from mtcommission.record.schema.comparisons import ComparedEntry, FedForwardEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Words
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Paragraph,
    Section,
    Subheading,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.motion_part import flexible_rates
from mtcommission.sheet.values import residual, settling
from mtcommission.sheet.verdict_part import move_title


def comparisons(record: Record, words: Catalogue) -> Section:
    """Return for each move what the ways of doing it cost and reach."""
    text = words.text
    blocks: list[Block] = [Paragraph(text=text("comparison-note"), tone=Tone.NOTE)]
    for number, (move, entry) in enumerate(
        zip(record.moves, record.comparisons, strict=True), start=1
    ):
        short = text("move", number=number)
        blocks.append(Subheading(text=move_title(move.move, number, words)))
        blocks.append(_controls(record, entry.controls, short, words))
        blocks += _told(text("claims"), entry.claims, words)
        blocks += _fed_forward(entry.fed_forward, short, words)
        blocks += _told(text("why-not"), entry.why_not_the_optimum, words)
    heading = text("comparison-heading")
    return Section(key="comparisons", heading=heading, blocks=tuple(blocks), is_appendix=True)


def _told(lead: str, sentences: list[Words], words: Catalogue) -> tuple[Block, ...]:
    """Return sentences of the record behind the words that lead to them."""
    if not sentences:
        return ()
    told = tuple(words.say(sentence) for sentence in sentences)
    return Paragraph(text=lead), Bullets(items=told)


def _controls(record: Record, controls: list[ComparedEntry], move: str, words: Catalogue) -> Table:
    text, f, units = words.text, words.format, record.plant.units
    rates = flexible_rates(record.plant.states)
    force = units["F"]
    heads = (
        text("transfer-time"),
        text("overshoot"),
        *(text("peak-of", name=symbol(rate)) for rate in rates),
        text("max-force"),
        text("heat"),
        text("work"),
    )
    rows = tuple(
        (
            words.say(control.name),
            settling(control.transfer_time, words),
            f.signed_percent(control.overshoot).removeprefix("+"),
            *(f.quantity(control.peaks.get(rate), units[rate]) for rate in rates),
            f.quantity(control.max_force, force),
            f.quantity(control.heat, "N^2 m^2 s" if words.rotary else "N^2 s"),
            f.quantity(control.work, "J"),
        )
        for control in controls
    )
    return Table(
        caption=text("controls-caption", move=move),
        columns=name_and_numbers(text("control"), heads, width=2.0),
        rows=rows,
    )


def _fed_forward(entries: list[FedForwardEntry], move: str, words: Catalogue) -> tuple[Block, ...]:
    """Return the machines on which a control settles; those on which none does as a sentence."""
    text, f = words.text, words.format
    settled = [entry for entry in entries if entry.settling_time is not None]
    lost = Counter(words.say(entry.control) for entry in entries if entry.settling_time is None)
    told = "; ".join(f"{name}: {count}" for name, count in lost.items())
    note = (Paragraph(text=text("fed-forward-lost", told=told)),) if lost else ()
    if not settled:
        return note
    heads = (
        text("payload"),
        text("frequencies"),
        text("dampings"),
        text("settling-time"),
        text("residual"),
        text("peak-deviation"),
        text("saturated-share"),
    )
    table = Table(
        caption=text("fed-forward-caption", move=move),
        columns=name_and_numbers(text("control"), heads, width=1.4),
        rows=tuple(
            (
                words.say(entry.control),
                f.axis(entry.payload, "kg"),
                f.percent(entry.frequency_factor),
                f.percent(entry.damping_factor),
                settling(entry.settling_time, words),
                residual(entry.residual_deviation, words),
                f.axis(entry.peak_deviation, "m"),
                f.percent(entry.saturated_share),
            )
            for entry in settled
        ),
    )
    return (table, *note)
