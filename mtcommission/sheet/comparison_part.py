"""The setpoint in the loop beside the optimal controls, and the optima fed forward."""

from __future__ import annotations

from mtcommission.record.schema import ComparedEntry, ContinuousEntry, FedForwardEntry, Record
from mtcommission.sheet.format import Formatter, motion_unit
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
from mtcommission.sheet.phrases import polish
from mtcommission.sheet.verdict_part import move_title


def comparisons(record: Record, f: Formatter) -> Section:
    """Return for each move what the ways of doing it cost and reach."""
    text = f.labels
    blocks: list[Block] = [Paragraph(text=text.comparison_note, tone=Tone.NOTE)]
    for number, (move, entry) in enumerate(
        zip(record.moves, record.comparisons, strict=True), start=1
    ):
        short = text.move.format(number=number)
        blocks.append(Subheading(text=move_title(move.move, number, f)))
        blocks.append(_controls(record, entry.controls, short, f))
        blocks += _told(text.claims, entry.claims, f)
        if entry.fed_forward:
            blocks.append(_fed_forward(entry.fed_forward, short, f))
        blocks += _told(text.why_not, entry.why_not_the_optimum, f)
        sampled = f.settling(move.response.settling_time)
        check = _continuous_check(entry.continuous, sampled, f)
        blocks.append(Paragraph(text=check, tone=Tone.NOTE))
    return Section(key="comparisons", heading=text.comparison_heading, blocks=tuple(blocks))


def _told(lead: str, sentences: list[str], f: Formatter) -> tuple[Block, ...]:
    """Return sentences of the record behind the words that lead to them."""
    if not sentences:
        return ()
    told = tuple(f.labels.say(sentence) for sentence in sentences)
    return Paragraph(text=lead), Bullets(items=told)


def _continuous_check(found: ContinuousEntry, sampled: str, f: Formatter) -> str:
    """Return what the continuous approximation says; one that does not settle has no numbers."""
    text = f.labels
    if found.settling_time is None:
        return text.continuous_unsettled.format(sampled=sampled)
    return text.continuous_check.format(
        settling=f.settling(found.settling_time),
        residual=f.quantity(found.residual_deviation, motion_unit("m", rotary=f.rotary)),
        sampled=sampled,
        settling_difference=_difference(found.settling_difference, f),
        residual_difference=_difference(found.residual_difference, f),
    )


def _difference(share: float | None, f: Formatter) -> str:
    return "–" if share is None else f.signed_percent(share)


def _controls(record: Record, controls: list[ComparedEntry], move: str, f: Formatter) -> Table:
    text, units = f.labels, record.plant.units
    rates = flexible_rates(record.plant.states)
    force = units["F"]
    heads = (
        text.transfer_time,
        text.overshoot,
        *(text.peak_of.format(name=polish(rate)) for rate in rates),
        text.max_force,
        text.heat,
        text.work,
    )
    rows = tuple(
        (
            text.say(control.name),
            f.settling(control.transfer_time),
            f.signed_percent(control.overshoot).removeprefix("+"),
            *(f.quantity(control.peaks.get(rate), units[rate]) for rate in rates),
            f.quantity(control.max_force, force),
            f.quantity(control.heat, "N^2 m^2 s" if f.rotary else "N^2 s"),
            f.quantity(control.work, "J"),
        )
        for control in controls
    )
    return Table(
        caption=text.controls_caption.format(move=move),
        columns=name_and_numbers(text.control, heads, width=2.0),
        rows=rows,
    )


def _fed_forward(entries: list[FedForwardEntry], move: str, f: Formatter) -> Table:
    text = f.labels
    length, mass = motion_unit("m", rotary=f.rotary), motion_unit("kg", rotary=f.rotary)
    heads = (
        text.payload,
        text.frequencies,
        text.dampings,
        text.settling_time,
        text.residual,
        text.peak_deviation,
        text.saturated_share,
    )
    return Table(
        caption=text.fed_forward_caption.format(move=move),
        columns=name_and_numbers(text.control, heads, width=1.4),
        rows=tuple(
            (
                text.say(entry.control),
                f.quantity(entry.payload, mass),
                f.percent(entry.frequency_factor),
                f.percent(entry.damping_factor),
                f.settling(entry.settling_time),
                f.quantity(entry.residual_deviation, length, missing=text.not_settled),
                f.quantity(entry.peak_deviation, length),
                f.percent(entry.saturated_share),
            )
            for entry in entries
        ),
    )
