"""The control loop: gains, margins, frequency response and poles."""

from __future__ import annotations

from dataclasses import asdict
from math import hypot, isfinite, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.record.schema import LoopPart, Record, VariantEntry
from mtcommission.sheet.diagram_part import structure
from mtcommission.sheet.format import Formatter, motion_unit
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
from mtcommission.sheet.phrases import polish
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel

Array = NDArray[np.float64]

OPEN, CLOSED = 4, 1
"""Line styles: the open loop is the main curve."""


def loop(record: Record, f: Formatter) -> Section:
    """Return gains, margins, frequency response and poles."""
    text, part = f.labels, record.loop
    sentences = [text.sensors.format(names=", ".join(map(text.say, part.sensors)))]
    if part.observer.states:
        sentences.append(text.observed.format(names=", ".join(map(polish, part.observer.states))))
    if not part.state_feedback:
        sentences.append(text.no_state_feedback)
    gains = Table(
        caption=text.gains_caption,
        columns=(Column(head=text.quantity, width=2.0), Column(head=text.value, is_number=True)),
        rows=gain_rows(record, f),
    )
    remarks: tuple[Block, ...] = ()
    if part.remarks:
        remarks = (
            Subheading(text=text.remarks),
            Bullets(items=tuple(map(text.say, part.remarks))),
        )
    return Section(
        key="loop",
        heading=text.loop_heading,
        blocks=(
            structure(record, f),
            gains,
            Paragraph(text=" ".join(sentences), tone=Tone.NOTE),
            _margins(record, f),
            *_variants(record, f),
            _bode(record, f),
            *loop_study(record, f),
            _poles(record, f),
            *remarks,
        ),
    )


def gain_rows(record: Record, f: Formatter) -> tuple[tuple[str, str], ...]:
    """Return name and value of every gain, delay and cycle."""
    text, part, units = f.labels, record.loop, record.plant.units
    damping = motion_unit("N s/m", rotary=f.rotary)
    mass = motion_unit("kg", rotary=f.rotary)
    rows = [
        (text.name("Kv"), f.quantity(part.Kv, "1/s")),
        (text.name("Kp"), f.quantity(part.Kp, damping)),
        (text.name("Tn"), f.quantity(part.Tn, "s")),
        (text.reference_delay, f.quantity(part.reference_delay, "s")),
    ]
    for name, value in asdict(part.feedforward).items():
        unit = mass if "mass" in name else ""
        rows.append((text.feedforward.format(name=text.say(name)), f.quantity(value, unit)))
    for state, gain in part.state_feedback.items():
        unit = f"{units['F']}/({units[state]})" if state in units else ""
        rows.append((text.state_feedback.format(name=polish(state)), f.quantity(gain, unit)))
    rows.append((text.position_cycle, f.quantity(part.position_cycle, "s")))
    rows.append((text.velocity_cycle, f.quantity(part.velocity_cycle, "s")))
    return tuple(rows)


def _margins(record: Record, f: Formatter) -> Table:
    text, part = f.labels, record.loop
    worst = part.worst_corner
    peak = worst.sensitivity_peak
    rows = (
        (
            text.gain_margin,
            f.decibel(part.gain_margin_db),
            f.decibel(worst.gain_margin_db),
        ),
        (text.gain_margin_up, f.decibel(part.gain_margin_up_db), "–"),
        (text.gain_margin_down, f.decibel(part.gain_margin_down_db), "–"),
        (
            text.phase_margin,
            f.degree(part.phase_margin_deg),
            f.degree(worst.phase_margin_deg),
        ),
        (
            text.sensitivity_peak,
            f.number(part.sensitivity_peak, digits=3),
            f.number(peak, digits=3) if isfinite(peak) else "–",
        ),
        (
            text.bandwidth,
            f.quantity(part.bandwidth_hz, "Hz"),
            f.quantity(worst.bandwidth_hz, "Hz"),
        ),
        (
            text.dynamic_stiffness,
            _stiffness(part, f),
            f.quantity(worst.dynamic_stiffness, motion_unit("N/m", rotary=f.rotary)),
        ),
        *(
            (
                text.damping_of.format(mode=mode),
                f.percent(damping),
                f.percent_if_known(part.worst_mode_damping.get(mode)),
            )
            for mode, damping in part.mode_damping.items()
        ),
    )
    return Table(
        caption=text.margins_caption,
        columns=(
            Column(head=text.margin, width=2.0),
            Column(head=text.nominal, is_number=True),
            Column(head=text.worst_corner, is_number=True),
        ),
        rows=rows,
    )


def _variants(record: Record, f: Formatter) -> tuple[Table, ...]:
    """Return the loops that were compared side by side; nothing if there was no choice."""
    text, variants = f.labels, record.loop.variants
    if len(variants) < 2:
        return ()
    length = motion_unit("m", rotary=f.rotary)
    force = record.plant.units["F"]
    rows = [
        (text.gain_margin, *(f.decibel(item.gain_margin_db) for item in variants)),
        (text.phase_margin, *(f.degree(item.phase_margin_deg) for item in variants)),
        (text.sensitivity_peak, *(f.number(i.sensitivity_peak, digits=3) for i in variants)),
        (text.bandwidth, *(f.quantity(item.bandwidth_hz, "Hz") for item in variants)),
        (text.dynamic_stiffness, *(_stiffness(item, f) for item in variants)),
    ]
    for mode in record.plant.modes:
        name = mode.name
        dampings = (f.percent(item.mode_damping[name]) for item in variants)
        rows.append((text.damping_of.format(mode=name), *dampings))
    rows += [
        (text.settling_time, *(f.settling(item.settling_time) for item in variants)),
        (text.residual, *(f.quantity(item.residual_deviation, length) for item in variants)),
        (text.max_force, *(f.quantity(item.max_force, force) for item in variants)),
    ]
    heads = (
        text.variant_used.format(name=text.say(item.name)) if item.used else text.say(item.name)
        for item in variants
    )
    return (
        Table(
            caption=text.variants_caption,
            columns=name_and_numbers(text.quantity, heads, width=1.6),
            rows=tuple(rows),
        ),
    )


def _stiffness(part: LoopPart | VariantEntry, f: Formatter) -> str:
    return f.labels.stiffness_at.format(
        stiffness=f.quantity(part.dynamic_stiffness, motion_unit("N/m", rotary=f.rotary)),
        frequency=f.quantity(part.weakest_frequency_hz, "Hz"),
    )


def _bode(record: Record, f: Formatter) -> LinePlot:
    text, part = f.labels, record.loop
    frequency = np.array(part.bode.t)
    signals = {name: np.array(values) for name, values in part.bode.signals.items()}
    # Whole turns are added so that the phase begins between -360 and 0 degrees.
    phase = signals["open_loop_deg"] - 360.0 * np.ceil(signals["open_loop_deg"][0] / 360.0)

    def line(label: str, y: Array, style: int) -> Line:
        return Line(label=label, x=frequency, y=y, style=style)

    return LinePlot(
        key="bode",
        caption=text.bode_caption,
        alt=text.bode_alt.format(
            gain=f.decibel(part.gain_margin_db),
            phase=f.degree(part.phase_margin_deg),
            bandwidth=f.quantity(part.bandwidth_hz, "Hz"),
        ),
        x_label=f"{text.frequency} in Hz",
        x_is_log=True,
        link="bode",
        panels=(
            Panel(
                y_label=text.magnitude,
                lines=(
                    line(text.open_loop, signals["open_loop_db"], OPEN),
                    line(text.closed_velocity, signals["closed_velocity_db"], CLOSED),
                ),
                borders=(Border(label="0 dB", y=0.0),),
            ),
            Panel(
                y_label=text.phase,
                lines=(line(text.open_loop, phase, OPEN),),
                borders=(Border(label="−180°", y=-180.0),),
            ),
        ),
    )


def _poles(record: Record, f: Formatter) -> Table:
    """Return one row for each real pole and each pair."""
    text = f.labels
    upper = sorted(
        ((real, imaginary) for real, imaginary in record.loop.poles if imaginary >= 0.0),
        key=lambda pole: -pole[0],
    )
    rows = []
    for real, imaginary in upper:
        omega = hypot(real, imaginary)
        is_pair = imaginary > 0.0
        rows.append(
            (
                f.quantity(real, "1/s"),
                f.quantity(omega / (2 * pi), "Hz") if is_pair else "–",
                f.percent(-real / omega) if is_pair else "–",
            )
        )
    return Table(
        caption=text.poles_caption,
        columns=(
            Column(head=text.real_part, is_number=True),
            Column(head=text.frequency, is_number=True),
            Column(head=text.damping_ratio, is_number=True),
        ),
        rows=tuple(rows),
    )
