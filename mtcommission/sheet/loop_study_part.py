"""What else is known of the loop: delays, disturbance, jerk feed-forward, corners."""

from __future__ import annotations

import numpy as np

from mtcommission.record.schema import Record
from mtcommission.sheet.format import Formatter, motion_unit
from mtcommission.sheet.model import Block, Column, Table, name_and_numbers
from mtcommission.sheet.plot_model import Line, LinePlot, Panel

USED, OTHER = 4, 1
"""Line styles: the loop that is used is the main curve."""


def loop_study(record: Record, f: Formatter) -> tuple[Block, ...]:
    """Return delays, disturbance response, effect of the jerk feed-forward, and corners."""
    corners = (_corners(record, f),) if len(record.loop.corners) > 1 else ()
    return (
        *corners,
        _disturbance(record, f),
        _delays(record, f),
        _jerk_feedforward(record, f),
    )


def _corners(record: Record, f: Formatter) -> Table:
    text = f.labels
    heads = (
        text.payload,
        text.frequencies,
        text.dampings,
        text.gain_margin,
        text.phase_margin,
        text.sensitivity_peak,
        text.bandwidth_short,
        text.stiffness_short,
    )
    return Table(
        caption=text.loop_corners_caption,
        columns=tuple(Column(head=head, is_number=True) for head in heads),
        rows=tuple(
            (
                f.quantity(corner.payload, motion_unit("kg", rotary=f.rotary)),
                f.percent(corner.frequency_factor),
                f.percent(corner.damping_factor),
                f.decibel(corner.gain_margin_db),
                f.degree(corner.phase_margin_deg),
                f.number(corner.sensitivity_peak, digits=3),
                f.quantity(corner.bandwidth_hz, "Hz"),
                f.quantity(corner.dynamic_stiffness, motion_unit("N/m", rotary=f.rotary)),
            )
            for corner in record.loop.corners
        ),
    )


def _disturbance(record: Record, f: Formatter) -> LinePlot:
    """Return how the tool gives way to a step of force, for each loop that was compared."""
    text, series = f.labels, record.loop.disturbance
    used = {item.name for item in record.loop.variants if item.used}
    t = np.array(series.t)
    curves = {name: np.array(values) for name, values in series.signals.items()}
    t_scale = f.scale(float(t[-1]) if t.size else 0.0, "s")
    unit = "rad/(N m)" if f.rotary else "m/N"
    y_scale = f.scale_for(list(curves.values()), unit)
    largest = "; ".join(
        f"{text.say(name)}: {f.quantity(float(np.max(np.abs(y))), unit)}"
        for name, y in curves.items()
    )
    lines = tuple(
        Line(
            label=text.say(name),
            x=t / t_scale.size,
            y=y / y_scale.size,
            style=USED if name in used or len(curves) == 1 else OTHER,
        )
        for name, y in curves.items()
    )
    return LinePlot(
        key="disturbance",
        caption=text.disturbance_caption,
        alt=text.disturbance_alt.format(largest=largest),
        x_label=f"{text.time} in {t_scale.unit}",
        x_is_log=False,
        link="disturbance",
        panels=(Panel(y_label=f"{text.deflection} in {y_scale.unit}", lines=lines),),
    )


def _delays(record: Record, f: Formatter) -> Table:
    text = f.labels
    heads = (text.setpoint_age, text.dead_time, text.hold, text.lag, text.total)
    keys = ("setpoint_age", "dead_time", "hold", "lag", "total")
    return Table(
        caption=text.delays_caption,
        columns=name_and_numbers(text.path, heads, width=1.6),
        rows=tuple(
            (
                text.say(entry.path),
                *(f.quantity(getattr(entry, key) or None, "s") for key in keys),
            )
            for entry in record.loop.delays
        ),
    )


def _jerk_feedforward(record: Record, f: Formatter) -> Table:
    text, length = f.labels, motion_unit("m", rotary=f.rotary)
    heads = (text.reference_delay, text.wanted_force, text.settling_time, text.residual)
    return Table(
        caption=text.jerk_feedforward_caption,
        columns=name_and_numbers(text.jerk_weight, heads, width=1.4),
        rows=tuple(
            (
                text.variant_used.format(name=f.number(entry.weight))
                if entry.used
                else f.number(entry.weight),
                f.quantity(entry.reference_delay, "s"),
                f.quantity(entry.max_force, record.plant.units["F"]),
                f.settling(entry.settling_time),
                f.quantity(entry.residual_deviation, length, missing=text.not_settled),
            )
            for entry in record.loop.jerk_feedforward
        ),
        strong_rows=tuple(k for k, entry in enumerate(record.loop.jerk_feedforward) if entry.used),
    )
