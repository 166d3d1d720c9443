"""What else is known of the loop: delays, disturbance, jerk feed-forward, corners."""

from __future__ import annotations

import numpy as np

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.record import Record
from mtcommission.sheet.model import Block, Column, Table, name_and_numbers
from mtcommission.sheet.plot_model import Line, LinePlot, Panel
from mtcommission.sheet.values import decibel, degree, residual, settling

USED, OTHER = 4, 1
"""Line styles: the loop that is used is the main curve."""


def loop_study(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return corners, delays, and the effect of the jerk feed-forward."""
    corners = (_corners(record, words),) if len(record.loop.corners) > 1 else ()
    return (
        *corners,
        _delays(record, words),
        *([_jerk_feedforward(record, words)] if record.loop.jerk_feedforward else []),
    )


def _corners(record: Record, words: Catalogue) -> Table:
    text, f = words.text, words.format
    heads = (
        text("payload"),
        text("frequencies"),
        text("dampings"),
        text("gain-margin"),
        text("phase-margin"),
        text("sensitivity-peak"),
        text("bandwidth-short"),
        text("stiffness-short"),
    )
    return Table(
        caption=text("loop-corners-caption"),
        columns=tuple(Column(head=head, is_number=True) for head in heads),
        rows=tuple(
            (
                f.axis(corner.payload, "kg"),
                f.percent(corner.frequency_factor),
                f.percent(corner.damping_factor),
                decibel(corner.gain_margin_db, words),
                degree(corner.phase_margin_deg, words),
                f.number(corner.sensitivity_peak, digits=3),
                f.quantity(corner.bandwidth_hz, "Hz"),
                f.axis(corner.dynamic_stiffness, "N/m"),
            )
            for corner in record.loop.corners
        ),
    )


def disturbance(record: Record, words: Catalogue) -> LinePlot:
    """Return how the tool gives way to a step of force, for each loop that was compared."""
    text, f, series = words.text, words.format, record.loop.disturbance
    used = {item.name.kind for item in record.loop.variants if item.used}
    t = np.array(series.t)
    curves = {name: np.array(values) for name, values in series.signals.items()}
    t_scale = f.scale(float(t[-1]) if t.size else 0.0, "s")
    unit = "rad/(N m)" if words.rotary else "m/N"
    y_scale = f.scale_for(list(curves.values()), unit)
    largest = "; ".join(
        f"{words.text(name)}: {f.quantity(float(np.max(np.abs(y))), unit)}"
        for name, y in curves.items()
    )
    lines = tuple(
        Line(
            label=words.text(name),
            x=t / t_scale.size,
            y=y / y_scale.size,
            style=USED if name in used or len(curves) == 1 else OTHER,
        )
        for name, y in curves.items()
    )
    return LinePlot(
        key="disturbance",
        caption=text("disturbance-caption"),
        alt=text("disturbance-alt", largest=largest),
        x_label=text("in-unit", name=text("time"), unit=t_scale.unit),
        x_is_log=False,
        link="disturbance",
        panels=(
            Panel(y_label=text("in-unit", name=text("deflection"), unit=y_scale.unit), lines=lines),
        ),
    )


def _delays(record: Record, words: Catalogue) -> Table:
    text, f = words.text, words.format
    heads = (text("setpoint-age"), text("dead-time"), text("hold"), text("lag"), text("total"))
    keys = ("setpoint_age", "dead_time", "hold", "lag", "total")
    return Table(
        caption=text("delays-caption"),
        columns=name_and_numbers(text("path"), heads, width=1.6),
        rows=tuple(
            (
                words.say(entry.path),
                *(f.quantity(getattr(entry, key) or None, "s") for key in keys),
            )
            for entry in record.loop.delays
        ),
    )


def _jerk_feedforward(record: Record, words: Catalogue) -> Table:
    text, f = words.text, words.format
    heads = (text("reference-delay"), text("wanted-force"), text("settling-time"), text("residual"))
    return Table(
        caption=text("jerk-feedforward-caption"),
        columns=name_and_numbers(text("jerk-weight"), heads, width=1.4),
        rows=tuple(
            (
                text("variant-used", name=f.number(entry.weight))
                if entry.used
                else f.number(entry.weight),
                f.quantity(entry.reference_delay, "s"),
                f.quantity(entry.max_force, record.plant.units["F"]),
                settling(entry.settling_time, words),
                residual(entry.residual_deviation, words),
            )
            for entry in record.loop.jerk_feedforward
        ),
        strong_rows=tuple(k for k, entry in enumerate(record.loop.jerk_feedforward) if entry.used),
    )
