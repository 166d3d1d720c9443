"""What to measure on the machine to confirm the calculation, with fields for the results."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import motion_unit
from mtcommission.record.schema.moves import MoveEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.verified import Verified
from mtcommission.sheet.model import Block, Bullets, Column, Form, Paragraph, Table, Tone
from mtcommission.sheet.values import decibel, degree, residual, settling
from mtcommission.sheet.verdict_part import band, move_title

Row = tuple[str, str, str, str, float | None, str]
"""What to measure, calculated and permitted value as texts; name in the JSON of ``verify``,
calculated value [SI] and its unit, "%" for a ratio."""

HOW = tuple(f"measure-how-{i}" for i in range(1, 6))
HOW_FOLLOWED = ("measure-how-held", "measure-how-4")
"""How each thing is measured; where the motor follows there is no loop, and no force known."""


def measurement_blocks(
    record: Record, words: Catalogue, verified: Verified | None = None
) -> tuple[Block, ...]:
    """Return the measurements that confirm the record, with what was measured if it is known."""
    text = words.text
    rows, how = [*_structure(record, words), *_loop(record, words)], HOW
    if record.machine.follows:
        rows, how = _structure(record, words), HOW_FOLLOWED
    for number, move in enumerate(record.moves, start=1):
        rows += _motion(record, move, number, words)
    last = "measured-by" if verified is None else "verdict-column"
    heads = (text("measured"), text("difference"), text(last))
    table = Table(
        caption=text("measure-caption"),
        columns=(
            Column(head=text("measurement"), width=2.4),
            Column(head=text("calculated"), width=1.1, is_number=True),
            Column(head=text("permitted"), width=1.1, is_number=True),
            *(Column(head=head, width=1.1) for head in heads),
        ),
        rows=tuple((*row[:3], *_measured(row, verified, words)) for row in rows),
        is_form=True,
    )
    titles = "; ".join(
        move_title(move.move, number, words) for number, move in enumerate(record.moves, start=1)
    )
    return (
        Paragraph(text=text("measure-note", moves=titles), tone=Tone.NOTE),
        Bullets(items=tuple(text(name) for name in how), tone=Tone.NOTE),
        table,
        *([_verdict(verified, words)] if verified else []),
        Form(fields=(text("measure-field-1"), text("measure-field-2"))),
    )


def _verdict(verified: Verified, words: Catalogue) -> Paragraph:
    """The verdict over all of the recorded moves."""
    said = words.text(f"verify-verdict-{verified.verdict.replace(' ', '-')}")
    tone = Tone.PLAIN if verified.verdict == "holds" else Tone.WARNING
    return Paragraph(text=words.text("measure-verdict", verdict=said), tone=tone)


def _measured(row: Row, verified: Verified | None, words: Catalogue) -> tuple[str, str, str]:
    """Measured value, its difference from the calculated one, and the verdict; "" if not known."""
    *_, name, calculated, unit = row
    found = verified.values.get(name) if verified else None
    if found is None:
        return "", "", ""
    said = words.text(f"verify-verdict-{found.verdict.replace(' ', '-')}") if found.verdict else ""
    if found.value is None:
        return "–", "", said

    def shown(value: float, digits: int = 4) -> str:
        if unit == "%":
            return words.format.percent(value, digits=digits)
        return words.format.quantity(value, unit, digits=digits)

    measured = shown(found.value)
    if found.uncertainty is not None:
        measured += f" ± {shown(found.uncertainty, 2)}"
    apart = "" if calculated is None else shown(found.value - calculated, 3)
    return measured, apart, said


def _structure(record: Record, words: Catalogue) -> list[Row]:
    """Mass, and frequency and damping of each mode, with the spread that the limits allow for."""
    text, f, plant = words.text, words.format, record.plant
    mass = f.axis(plant.moving_mass, "kg")
    unit = motion_unit("kg", rotary=words.rotary)
    weighed: Row = (text("moving-mass"), mass, "–", "mass", plant.moving_mass, unit)
    rows = [] if record.machine.follows else [weighed]
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
            (
                frequency,
                f.quantity(mode.frequency_hz, "Hz"),
                permitted("frequency_spread"),
                f"{mode.name}.frequency",
                mode.frequency_hz,
                "Hz",
            ),
            (
                damping,
                f.percent(mode.damping_ratio),
                permitted("damping_spread"),
                f"{mode.name}.damping_ratio",
                mode.damping_ratio,
                "%",
            ),
        ]
    return rows


def _loop(record: Record, words: Catalogue) -> list[Row]:
    text, f, part = words.text, words.format, record.loop
    return [
        (text("gain-margin"), decibel(part.gain_margin_db, words), "–", "", None, ""),
        (text("phase-margin"), degree(part.phase_margin_deg, words), "–", "", None, ""),
        (text("bandwidth"), f.quantity(part.bandwidth_hz, "Hz"), "–", "", None, ""),
    ]


def _motion(record: Record, move: MoveEntry, number: int, words: Catalogue) -> list[Row]:
    """Nominal values of one move; what is permitted is the requirement itself."""
    text, f, response, units = words.text, words.format, move.response, record.plant.units
    name = text("move", number=number)
    limits = {check.name: check.limit for check in record.assessment.checks}
    length, force = motion_unit("m", rotary=words.rotary), units["F"]
    rows = (
        ("settling-time", settling(response.settling_time, words),
         f.quantity(limits.get("settling time"), "s"),
         "settling time", response.settling_time, "s"),
        ("residual", residual(response.residual_deviation, words), f.axis(band(record), "m"),
         "residual deviation", response.residual_deviation, length),
        ("peak-deviation", f.axis(response.peak_deviation, "m"), "–",
         "peak deviation", response.peak_deviation, length),
        ("max-force", f.quantity(response.max_force, force),
         f.quantity(limits.get("set force"), force),
         "max force", None, force),  # what is recorded is the motor's, behind its lag
        ("rms-force", f.quantity(response.rms_force, force),
         f.quantity(limits.get("RMS force"), force), "RMS force", response.rms_force, force),
    )  # fmt: skip
    return [
        (f"{name}: {text(kind)}", shown, permitted, f"move {number}: {key}", value, unit)
        for kind, shown, permitted, key, value, unit in rows
    ]
