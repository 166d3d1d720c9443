"""What to measure on the machine to confirm the calculation, with fields for the results."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema import MoveEntry, Record
from mtcommission.sheet.model import Bullets, Column, Form, Paragraph, Section, Table, Tone
from mtcommission.sheet.values import decibel, degree, residual, settling
from mtcommission.sheet.verdict_part import band, move_title

Row = tuple[str, str, str]
"""What to measure, calculated value, permitted value."""


def measurements(record: Record, words: Catalogue) -> Section:
    """Return the measurements that confirm the record, with empty fields."""
    text = words.text
    rows = [*_structure(record, words), *_loop(record, words)]
    for number, move in enumerate(record.moves, start=1):
        rows += _motion(record, move, text("move", number=number), words)
    heads = (text("measured"), text("difference"), text("measured-by"))
    table = Table(
        caption=text("measure-caption"),
        columns=(
            Column(head=text("measurement"), width=2.4),
            Column(head=text("calculated"), width=1.1, is_number=True),
            Column(head=text("permitted"), width=1.1, is_number=True),
            *(Column(head=head, width=1.1) for head in heads),
        ),
        rows=tuple((*row, *("" for _ in heads)) for row in rows),
        is_form=True,
    )
    titles = "; ".join(
        move_title(move.move, number, words) for number, move in enumerate(record.moves, start=1)
    )
    return Section(
        key="measurements",
        heading=text("measure-heading"),
        blocks=(
            Paragraph(text=text("measure-note", moves=titles), tone=Tone.NOTE),
            Bullets(items=tuple(text(f"measure-how-{i}") for i in range(1, 6))),
            table,
            Form(fields=(text("measure-field-1"), text("measure-field-2"))),
        ),
    )


def _structure(record: Record, words: Catalogue) -> list[Row]:
    """Mass, and frequency and damping of each mode, with the spread that the limits allow for."""
    text, f, plant = words.text, words.format, record.plant
    mass = f.axis(plant.moving_mass, "kg")
    rows = [(text("moving-mass"), mass, "–")]
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
            text("of-mode", name=name, mode=mode.name)
            for name in (text("frequency"), text("damping-ratio"))
        )
        rows += [
            (frequency, f.quantity(mode.frequency_hz, "Hz"), permitted("frequency_spread")),
            (damping, f.percent(mode.damping_ratio), permitted("damping_spread")),
        ]
    return rows


def _loop(record: Record, words: Catalogue) -> list[Row]:
    text, f, part = words.text, words.format, record.loop
    return [
        (text("gain-margin"), decibel(part.gain_margin_db, words), "–"),
        (text("phase-margin"), degree(part.phase_margin_deg, words), "–"),
        (text("bandwidth"), f.quantity(part.bandwidth_hz, "Hz"), "–"),
    ]


def _motion(record: Record, move: MoveEntry, name: str, words: Catalogue) -> list[Row]:
    """Nominal values of one move; what is permitted is the requirement itself."""
    text, f, response, units = words.text, words.format, move.response, record.plant.units
    limits = {check.name: check.limit for check in record.assessment.checks}
    rows = [
        (
            text("settling-time"),
            settling(response.settling_time, words),
            f.quantity(limits.get("settling time"), "s"),
        ),
        (
            text("residual"),
            residual(response.residual_deviation, words),
            f.axis(band(record), "m"),
        ),
        (text("peak-deviation"), f.axis(response.peak_deviation, "m"), "–"),
        (
            text("max-force"),
            f.quantity(response.max_force, units["F"]),
            f.quantity(limits.get("set force"), units["F"]),
        ),
        (
            text("rms-force"),
            f.quantity(response.rms_force, units["F"]),
            f.quantity(limits.get("RMS force"), units["F"]),
        ),
    ]
    return [(f"{name}: {what}", calculated, permitted) for what, calculated, permitted in rows]
