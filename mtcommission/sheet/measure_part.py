"""What to measure on the machine to confirm the calculation, with fields for the results."""

from __future__ import annotations

from mtcommission.record.schema import MoveEntry, Record
from mtcommission.sheet.format import Formatter, motion_unit
from mtcommission.sheet.model import Bullets, Column, Form, Paragraph, Section, Table, Tone
from mtcommission.sheet.verdict_part import band, move_title

Row = tuple[str, str, str]
"""What to measure, calculated value, permitted value."""


def measurements(record: Record, f: Formatter) -> Section:
    """Return the measurements that confirm the record, with empty fields."""
    text = f.labels
    rows = [*_structure(record, f), *_loop(record, f)]
    for number, move in enumerate(record.moves, start=1):
        rows += _motion(record, move, text.move.format(number=number), f)
    heads = (text.measured, text.difference, text.measured_by)
    table = Table(
        caption=text.measure_caption,
        columns=(
            Column(head=text.measurement, width=2.4),
            Column(head=text.calculated, width=1.1, is_number=True),
            Column(head=text.permitted, width=1.1, is_number=True),
            *(Column(head=head, width=1.1) for head in heads),
        ),
        rows=tuple((*row, *("" for _ in heads)) for row in rows),
        is_form=True,
    )
    titles = "; ".join(
        move_title(move.move, number, f) for number, move in enumerate(record.moves, start=1)
    )
    return Section(
        key="measurements",
        heading=text.measure_heading,
        blocks=(
            Paragraph(text=text.measure_note.format(moves=titles), tone=Tone.NOTE),
            Bullets(items=text.measure_how),
            table,
            Form(fields=text.measure_fields),
        ),
    )


def _structure(record: Record, f: Formatter) -> list[Row]:
    """Mass, and frequency and damping of each mode, with the spread that the limits allow for."""
    text, plant = f.labels, record.plant
    mass = f.quantity(plant.moving_mass, motion_unit("kg", rotary=f.rotary))
    rows = [(text.moving_mass, mass, "–")]
    spreads = {
        item.key: item.value
        for item in record.data
        if item.key.endswith("_spread") and isinstance(item.value, float | int)
    }

    def permitted(key: str) -> str:
        spread = spreads.get(f"requirements.{key}")
        return f"± {f.percent(float(spread))}" if spread else "–"

    for mode in plant.modes:
        frequency, damping = (
            text.of_mode.format(name=name, mode=mode.name)
            for name in (text.frequency, text.damping_ratio)
        )
        rows += [
            (frequency, f.quantity(mode.frequency_hz, "Hz"), permitted("frequency_spread")),
            (damping, f.percent(mode.damping_ratio), permitted("damping_spread")),
        ]
    return rows


def _loop(record: Record, f: Formatter) -> list[Row]:
    text, part = f.labels, record.loop
    return [
        (text.gain_margin, f.decibel(part.gain_margin_db), "–"),
        (text.phase_margin, f.degree(part.phase_margin_deg), "–"),
        (text.bandwidth, f.quantity(part.bandwidth_hz, "Hz"), "–"),
    ]


def _motion(record: Record, move: MoveEntry, name: str, f: Formatter) -> list[Row]:
    """Nominal values of one move; what is permitted is the requirement itself."""
    text, response, units = f.labels, move.response, record.plant.units
    length = motion_unit("m", rotary=f.rotary)
    limits = {check.name: check.limit for check in record.assessment.checks}
    rows = [
        (
            text.settling_time,
            f.settling(response.settling_time),
            f.quantity(limits.get("settling time"), "s"),
        ),
        (
            text.residual,
            f.quantity(response.residual_deviation, length, missing=text.not_settled),
            f.quantity(band(record), length),
        ),
        (text.peak_deviation, f.quantity(response.peak_deviation, length), "–"),
        (
            text.max_force,
            f.quantity(response.max_force, units["F"]),
            f.quantity(limits.get("set force"), units["F"]),
        ),
        (
            text.rms_force,
            f.quantity(response.rms_force, units["F"]),
            f.quantity(limits.get("RMS force"), units["F"]),
        ),
    ]
    return [(f"{name}: {what}", calculated, permitted) for what, calculated, permitted in rows]
