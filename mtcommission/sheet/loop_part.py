"""The control loop: frequency response with its margins, stiffness, the loops that were tried."""

from __future__ import annotations

from math import inf, isfinite

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import symbol
from mtcommission.record.schema.loop import CandidateEntry, LoopPart, Margins, VariantEntry
from mtcommission.record.schema.record import Record
from mtcommission.sheet.bode_part import bode
from mtcommission.sheet.control_part import control_has
from mtcommission.sheet.diagram_part import structure
from mtcommission.sheet.loop_study_part import disturbance, loop_study
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Column,
    Paragraph,
    Section,
    Subheading,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.values import decibel, degree, settling


def loop_blocks(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return how far the loop is from unstable, how stiff it is, and why it is this one."""
    text = words.text
    reasons = tuple(map(words.say, record.loop.reasons))
    why: tuple[Block, ...] = ()
    if reasons:
        why = (Paragraph(text=text("loop-why")), Bullets(items=reasons))
    if record.loop.worst_corner is None:  # the motor follows: the remarks say so
        return (Bullets(items=tuple(map(words.say, record.loop.remarks))), *why)
    return (
        Paragraph(text=_sensors(record, words), tone=Tone.NOTE),
        bode(record, words),
        margins(record.loop, record.loop.worst_corner, words),
        disturbance(record, words),
        *why,
    )


def loop_details(record: Record, words: Catalogue) -> Section:
    """Return structure, loops that were tried, corners, delays, and what the control has."""
    text, part = words.text, record.loop
    remarks: tuple[Block, ...] = ()
    if part.remarks:
        remarks = (
            Subheading(text=text("remarks")),
            Bullets(items=tuple(map(words.say, part.remarks))),
        )
    details: tuple[Block, ...] = ()
    if part.worst_corner is not None:
        details = (
            structure(record, words),
            *_cross_check(part, words),
            *_trade_off(record, words),
            *_variants(record, words),
            *loop_study(record, words),
        )
    return Section(
        key="loop-details",
        heading=text("loop-details-heading"),
        blocks=(*details, *remarks, *control_has(record, words)),
        is_appendix=True,
    )


def _cross_check(part: LoopPart, words: Catalogue) -> tuple[Block, ...]:
    """Return what python-control says of the same blocks."""
    found = part.cross_check
    if found is None:
        return ()
    sentence = words.text(
        "loop-cross-check",
        gain=decibel(found.gain_margin_db, words),
        phase=degree(found.phase_margin_deg, words),
        poles=words.format.number(found.pole_difference, digits=1),
    )
    return (Paragraph(text=sentence, tone=Tone.NOTE),)


def _sensors(record: Record, words: Catalogue) -> str:
    """Return what the loop measures, observes and feeds back."""
    text, part = words.text, record.loop
    sensors = (words.known(f"sensor-{name}", name) for name in part.sensors)
    sentences = [text("sensors", names=", ".join(sensors))]
    if part.observer.states:
        sentences.append(text("observed", names=", ".join(map(symbol, part.observer.states))))
    if not part.state_feedback:
        sentences.append(text("no-state-feedback"))
    return " ".join(sentences)


def margins(part: LoopPart, worst: Margins, words: Catalogue) -> Table:
    """Return margins, bandwidth, stiffness and damping, nominal and in the worst corner."""
    text, f = words.text, words.format
    peak = worst.sensitivity_peak
    rows = (
        (
            text("gain-margin"),
            decibel(part.gain_margin_db, words),
            decibel(worst.gain_margin_db, words),
        ),
        (text("gain-margin-up"), decibel(part.gain_margin_up_db, words), "–"),
        (text("gain-margin-down"), decibel(part.gain_margin_down_db, words), "–"),
        (
            text("phase-margin"),
            degree(part.phase_margin_deg, words),
            degree(worst.phase_margin_deg, words),
        ),
        (
            text("sensitivity-peak"),
            f.quantity(part.sensitivity_peak, "", digits=3),
            f.number(peak, digits=3) if isfinite(peak) else "–",
        ),
        (
            text("bandwidth"),
            f.quantity(part.bandwidth_hz, "Hz"),
            f.quantity(worst.bandwidth_hz, "Hz"),
        ),
        (
            text("dynamic-stiffness"),
            _stiffness(part, words),
            f.axis(worst.dynamic_stiffness, "N/m"),
        ),
        *(
            (
                text("damping-of", mode=mode),
                f.percent(damping),
                f.percent_if_known(part.worst_mode_damping.get(mode)),
            )
            for mode, damping in part.mode_damping.items()
        ),
    )
    return Table(
        caption=text("margins-caption"),
        columns=(
            Column(head=text("margin"), width=2.0),
            Column(head=text("nominal"), is_number=True),
            Column(head=text("worst-corner"), is_number=True),
        ),
        rows=rows,
    )


def _trade_off(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return the loops that no other one beats in both stiffness and settling."""
    text, f, tried = words.text, words.format, record.loop.candidates
    shown = [item for item in tried if item.used or item.classic or not _is_beaten(item, tried)]
    if len(shown) < 2:
        return ()
    heads = (
        "settling-time",
        "stiffness-short",
        "gain-margin",
        "phase-margin",
        "sensitivity-peak",
    )
    table = Table(
        caption=text("trade-off-caption", shown=len(shown), tried=len(tried)),
        columns=(
            Column(head=text("loop"), width=1.5),
            *(Column(head=name, width=1.2, is_number=True) for name in ("Kv", "Kp", "Tn")),
            *(Column(head=text(head), is_number=True) for head in heads),
        ),
        rows=tuple(
            (
                _candidate_name(item, words),
                f.quantity(item.Kv, "1/s"),
                f.axis(item.Kp, "N s/m"),
                f.quantity(item.Tn, "s"),
                settling(item.settling_time, words),
                f.axis(item.dynamic_stiffness, "N/m"),
                decibel(item.gain_margin_db, words),
                degree(item.phase_margin_deg, words),
                f.number(item.sensitivity_peak, digits=3),
            )
            for item in shown
        ),
        strong_rows=tuple(k for k, item in enumerate(shown) if item.used),
    )
    return (table,)


def _is_beaten(item: CandidateEntry, others: list[CandidateEntry]) -> bool:
    """Whether another loop settles no later and is stiffer, or the other way round."""
    time, stiffness = item.settling_time or inf, item.dynamic_stiffness
    return any(
        (other.settling_time or inf) <= time
        and other.dynamic_stiffness >= stiffness
        and ((other.settling_time or inf), -other.dynamic_stiffness) != (time, -stiffness)
        for other in others
    )


def _candidate_name(item: CandidateEntry, words: Catalogue) -> str:
    text = words.text
    kind = text("with-state-feedback" if item.state_feedback else "cascade")
    name = text("classic-loop", name=kind) if item.classic else kind
    return text("variant-used", name=name) if item.used else name


def _variants(record: Record, words: Catalogue) -> tuple[Table, ...]:
    """Return the loops that were compared side by side; nothing if there was no choice."""
    text, f, variants = words.text, words.format, record.loop.variants
    if len(variants) < 2:
        return ()
    force = record.plant.units["F"]
    rows = [
        (text("gain-margin"), *(decibel(item.gain_margin_db, words) for item in variants)),
        (text("phase-margin"), *(degree(item.phase_margin_deg, words) for item in variants)),
        (text("sensitivity-peak"), *(f.number(i.sensitivity_peak, digits=3) for i in variants)),
        (text("bandwidth"), *(f.quantity(item.bandwidth_hz, "Hz") for item in variants)),
        (text("dynamic-stiffness"), *(_stiffness(item, words) for item in variants)),
    ]
    for mode in record.plant.modes:
        name = mode.name
        dampings = (f.percent(item.mode_damping[name]) for item in variants)
        rows.append((text("damping-of", mode=name), *dampings))
    rows += [
        (text("settling-time"), *(settling(item.settling_time, words) for item in variants)),
        (text("residual"), *(f.axis(item.residual_deviation, "m") for item in variants)),
        (text("max-force"), *(f.quantity(item.max_force, force) for item in variants)),
    ]
    heads = (
        text("variant-used", name=words.say(item.name)) if item.used else words.say(item.name)
        for item in variants
    )
    return (
        Table(
            caption=text("variants-caption"),
            columns=name_and_numbers(text("quantity"), heads, width=1.6),
            rows=tuple(rows),
        ),
    )


def _stiffness(part: LoopPart | VariantEntry, words: Catalogue) -> str:
    f = words.format
    return words.text(
        "stiffness-at",
        stiffness=f.axis(part.dynamic_stiffness, "N/m"),
        frequency=f.quantity(part.weakest_frequency_hz, "Hz"),
    )
