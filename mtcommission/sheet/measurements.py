"""Page 4: what to measure at the machine to confirm the calculation, with fields; signature."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.messages.quantities import motion_unit
from mtcommission.record.moves import MoveEntry
from mtcommission.record.read_back import Verified
from mtcommission.record.record import Record
from mtcommission.sheet.basis import find_band, find_number
from mtcommission.sheet.document import (
    Block,
    Bullets,
    Form,
    Paragraph,
    Subheading,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.tables import (
    BANDWIDTH,
    DASH,
    GAIN_MARGIN,
    MAX_FORCE,
    PEAK,
    PHASE_MARGIN,
    RESIDUAL,
    RMS_FORCE,
    SETTLING,
    Quantity,
    show,
    table,
)
from mtcommission.sheet.verdict import move_title, signature

if TYPE_CHECKING:
    from mtcommission.export.write import Export

HOW = tuple(f"measure-how-{i}" for i in range(1, 6))
HOW_FOLLOWED = HOW[0], HOW[3]
"""How each thing is measured; where the motor follows there is no loop, and no force known."""


class Measurement(NamedTuple):
    """What to measure, calculated and permitted value; and how ``verify`` calls it."""

    name: str
    calculated: str
    permitted: str = DASH
    key: str = ""
    value: float | None = None  # calculated [SI], where a difference can be told
    unit: str = ""


def fourth_page(
    record: Record, typed: Export | Message, words: Catalogue, verified: Verified | None
) -> Iterator[Block]:
    """Yield the measurements that confirm the record, with what was measured if it is known."""
    text, follows = words.text, record.machine.follows
    rows = [*_structure(record, words), *([] if follows else _loop(record, words))]
    titles = []
    for number, move in enumerate(record.moves, start=1):
        rows += _motion(record, move, number, words)
        titles.append(move_title(move.move, number, words))
    how = tuple(map(text, HOW_FOLLOWED if follows else HOW))
    yield note(text("measure-note", moves="; ".join(titles)))
    yield Bullets(items=how, tone=Tone.NOTE)
    yield _table(rows, verified, words)
    if verified:
        said = text(f"verify-verdict-{verified.verdict.replace(' ', '-')}")
        tone = Tone.PLAIN if verified.verdict == "holds" else Tone.WARNING
        yield Paragraph(text=text("measure-verdict", verdict=said), tone=tone)
    yield Form(fields=(text("measure-field-1"), text("measure-field-2")))
    yield Subheading(text=text("signature-heading"))
    yield from signature(record, typed, words)


def _table(rows: list[Measurement], verified: Verified | None, words: Catalogue) -> Table:
    filled = [(*row[:3], *_measured(row, verified, words)) for row in rows]
    last = "measured-by" if verified is None else "verdict"
    heads = {"measurement": 2.4, "calculated": 1.1, "permitted": 1.1, "measured": 1.1}
    heads |= {"difference": 1.1, last: 1.1}
    columns = (
        Quantity(head, itemgetter(k), "" if k in (1, 2) else None, width=width)
        for k, (head, width) in enumerate(heads.items())
    )
    return replace(table(words, "measure-caption", columns, filled), is_form=True)


def _measured(
    row: Measurement, verified: Verified | None, words: Catalogue
) -> tuple[str, str, str]:
    """Measured value, its difference from the calculated one, and the verdict; "" if not known."""
    found = verified.values.get(row.key) if verified else None
    if found is None:
        return "", "", ""
    said = words.text(f"verify-verdict-{found.verdict.replace(' ', '-')}") if found.verdict else ""
    if found.measured is None:
        return DASH, "", said

    def shown(value: float, digits: int = 4) -> str:
        if row.unit == "%":
            return words.format.percent(value, digits=digits)
        return words.format.quantity(value, row.unit, digits=digits)

    measured = shown(found.measured)
    if found.uncertainty is not None:
        measured += f" ± {shown(found.uncertainty, 2)}"
    return measured, "" if row.value is None else shown(found.measured - row.value, 3), said


def _structure(record: Record, words: Catalogue) -> list[Measurement]:
    """Mass, and frequency and damping of each mode, with the spread that the limits allow for."""
    text, plant = words.text, record.plant
    mass, unit = plant.moving_mass, motion_unit("kg", rotary=words.rotary)
    rows = []
    if not record.machine.follows:
        weighed = show(mass, words, "kg")
        rows = [Measurement(text("name-moving-mass"), weighed, DASH, "mass", mass, unit)]

    def permitted(kind: str) -> str:
        spread = find_number(record, f"requirements.{kind}_spread")
        return f"± {show(spread, words, '%')}" if spread else DASH

    for mode in plant.modes:
        for name, kind, key, value, unit in (
            ("frequency", "frequency", "frequency", mode.frequency_hz, "Hz"),
            ("damping-ratio", "damping", "damping_ratio", mode.damping_ratio, "%"),
        ):
            named = text("of-mode", name=text(name), mode=mode.name)
            shown, key = show(value, words, unit), f"{mode.name}.{key}"
            rows.append(Measurement(named, shown, permitted(kind), key, value, unit))
    return rows


def _loop(record: Record, words: Catalogue) -> list[Measurement]:
    return [
        Measurement(quantity.head(words), quantity.show(record.loop, words))
        for quantity in (GAIN_MARGIN, PHASE_MARGIN, BANDWIDTH)
    ]


def _motion(record: Record, move: MoveEntry, number: int, words: Catalogue) -> list[Measurement]:
    """Nominal values of one move; what is permitted is the requirement itself."""
    limits = {check.name: check.limit for check in record.assessment.checks}
    force = record.plant.units["F"]
    rows = (
        (SETTLING, "settling time", limits.get("settling time"), "s"),
        (RESIDUAL, "residual deviation", find_band(record), motion_unit("m", rotary=words.rotary)),
        (PEAK, "peak deviation", None, motion_unit("m", rotary=words.rotary)),
        (MAX_FORCE, "max force", limits.get("set force"), force),
        (RMS_FORCE, "RMS force", limits.get("RMS force"), force),
    )
    return [
        Measurement(
            f"{words.text('move', number=number)}: {quantity.head(words)}",
            quantity.show(move.response, words),
            show(permitted, words, unit),
            f"move {number}: {key}",
            # What is recorded of the largest force is the motor's, behind its lag.
            None if quantity is MAX_FORCE else getattr(move.response, str(quantity.value)),
            unit,
        )
        for quantity, key, permitted, unit in rows
    ]
