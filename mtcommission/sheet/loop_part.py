"""The control loop: gains, margins, the loops that were tried, and frequency response."""

from __future__ import annotations

from dataclasses import asdict
from math import inf, isfinite, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import motion_unit, symbol
from mtcommission.record.schema import CandidateEntry, LoopPart, Margins, Record, VariantEntry
from mtcommission.sheet.control_part import control_has
from mtcommission.sheet.diagram_part import structure
from mtcommission.sheet.loop_study_part import loop_study
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
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.values import decibel, degree, settling

Array = NDArray[np.float64]

OPEN, CLOSED = 4, 1
"""Line styles: the open loop is the main curve."""


def loop(record: Record, words: Catalogue) -> Section:
    """Return gains, margins, the loops that were tried, and frequency response."""
    text, part = words.text, record.loop
    remarks: tuple[Block, ...] = ()
    if part.remarks:
        remarks = (
            Subheading(text=text("remarks")),
            Bullets(items=tuple(map(words.say, part.remarks))),
        )
    if part.worst_corner is None:
        return Section(
            key="loop",
            heading=text("loop-heading"),
            blocks=(_gains(record, words), *remarks, *control_has(record, words)),
        )
    sensors = (words.known(f"sensor-{name}", name) for name in part.sensors)
    sentences = [text("sensors", names=", ".join(sensors))]
    if part.observer.states:
        sentences.append(text("observed", names=", ".join(map(symbol, part.observer.states))))
    if not part.state_feedback:
        sentences.append(text("no-state-feedback"))
    return Section(
        key="loop",
        heading=text("loop-heading"),
        blocks=(
            structure(record, words),
            _gains(record, words),
            Paragraph(text=" ".join(sentences), tone=Tone.NOTE),
            _margins(part, part.worst_corner, words),
            *_trade_off(record, words),
            *_variants(record, words),
            _bode(record, words),
            *loop_study(record, words),
            *remarks,
            *control_has(record, words),
        ),
    )


def _gains(record: Record, words: Catalogue) -> Table:
    text = words.text
    return Table(
        caption=text("gains-caption"),
        columns=(
            Column(head=text("quantity"), width=2.0),
            Column(head=text("value"), is_number=True),
        ),
        rows=gain_rows(record, words),
    )


def gain_rows(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    """Return name and value of every gain, delay and cycle."""
    text, f, part, units = words.text, words.format, record.loop, record.plant.units
    mass = motion_unit("kg", rotary=words.rotary)
    if part.Kv is None:
        return (
            (text("reference-delay"), f.quantity(part.reference_delay, "s")),
            (text("setpoint-spacing"), f.quantity(part.position_cycle, "s")),
        )
    rows = [
        (words.name("Kv"), f.quantity(part.Kv, "1/s")),
        (words.name("Kp"), f.axis(part.Kp, "N s/m")),
        (words.name("Tn"), f.quantity(part.Tn, "s")),
        (text("reference-delay"), f.quantity(part.reference_delay, "s")),
    ]
    for name, value in asdict(part.feedforward).items():
        unit = mass if "mass" in name else ""
        rows.append(
            (text("feedforward", name=text(f"feedforward-{name}")), f.quantity(value, unit))
        )
    for state, gain in part.state_feedback.items():
        unit = f"{units['F']}/({units[state]})" if state in units else ""
        rows.append((text("state-feedback", name=symbol(state)), f.quantity(gain, unit)))
    if part.reference_model_time:
        rows.append((text("reference-model"), f.quantity(part.reference_model_time, "s")))
    for number, item in enumerate(part.force_filters, start=1):
        said = text(
            f"loop-filter-{item.kind.replace('_', '-')}",
            frequency=item.natural_frequency / (2.0 * pi),
            damping=item.damping,
            width=item.width,
        )
        rows.append((text("force-filter", number=number), said))
    rows.append((text("position-cycle"), f.quantity(part.position_cycle, "s")))
    rows.append((text("velocity-cycle"), f.quantity(part.velocity_cycle, "s")))
    return tuple(rows)


def _margins(part: LoopPart, worst: Margins, words: Catalogue) -> Table:
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
    """Return the loops that no other one beats in both stiffness and settling, and the reasons."""
    text, f, tried = words.text, words.format, record.loop.candidates
    reasons = tuple(map(words.say, record.loop.reasons))
    told = (Bullets(items=reasons),) if reasons else ()
    shown = [item for item in tried if item.used or item.classic or not _is_beaten(item, tried)]
    if len(shown) < 2:
        return told
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
    return (table, *told)


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


def _bode(record: Record, words: Catalogue) -> LinePlot:
    text, f, part = words.text, words.format, record.loop
    frequency = np.array(part.bode.t)
    signals = {name: np.array(values) for name, values in part.bode.signals.items()}
    # Whole turns are added so that the phase begins between -360 and 0 degrees.
    phase = signals["open_loop_deg"] - 360.0 * np.ceil(signals["open_loop_deg"][0] / 360.0)

    def line(label: str, y: Array, style: int) -> Line:
        return Line(label=label, x=frequency, y=y, style=style)

    return LinePlot(
        key="bode",
        caption=text("bode-caption"),
        alt=text(
            "bode-alt",
            gain=decibel(part.gain_margin_db, words),
            phase=degree(part.phase_margin_deg, words),
            bandwidth=f.quantity(part.bandwidth_hz, "Hz"),
        ),
        x_label=text("in-unit", name=text("frequency"), unit="Hz"),
        x_is_log=True,
        link="bode",
        panels=(
            Panel(
                y_label=text("magnitude"),
                lines=(
                    line(text("open-loop"), signals["open_loop_db"], OPEN),
                    line(text("closed-velocity"), signals["closed_velocity_db"], CLOSED),
                ),
                borders=(Border(label="0 dB", y=0.0),),
            ),
            Panel(
                y_label=text("phase"),
                lines=(line(text("open-loop"), phase, OPEN),),
                borders=(Border(label="−180°", y=-180.0),),
            ),
        ),
    )
