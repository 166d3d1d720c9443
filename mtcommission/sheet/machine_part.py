"""Machine and axis data, modes, moves and requirements."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.machine import Datum
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Words
from mtcommission.sheet.model import Column, Paragraph, Section, Table, Tone

REQUIRED = ("requirements.", "moves")
"""Beginnings of the keys that say what is required, not what the machine is."""

LONGEST_SOURCE = 28
"""Letters of a source that fits into its column; a longer one stands once, with a number."""


def machine_data(record: Record, words: Catalogue) -> Section:
    """Return the machine's data with their sources, and its modes."""
    text, machine, sources = words.text, record.machine, long_sources(record)
    data = [item for item in record.data if not item.key.startswith(REQUIRED)]
    title = Table(
        caption=text("rigid-caption"),
        columns=(Column(head=text("quantity")), Column(head=text("value"), width=2.0)),
        rows=(
            (text("machine-row"), machine.name),
            (text("axis-row"), machine.axis),
            (text("motion-row"), text("rotary") if words.rotary else text("linear")),
            (text("source"), _numbered(machine.source, sources, words)),
            *_rigid_rows(record, words),
        ),
    )
    return Section(
        key="machine",
        heading=text("machine-heading"),
        blocks=(
            title,
            _data_table(text("data-caption"), data, record, words),
            *(
                Paragraph(text=_numbered(source, sources, words), tone=Tone.NOTE)
                for source in sources
                if source != machine.source
            ),
            _modes(record, words),
        ),
        is_appendix=True,
    )


def requirements(record: Record, words: Catalogue) -> Section:
    """Return the moves and what is required of them."""
    text = words.text
    data = [item for item in record.data if item.key.startswith(REQUIRED)]
    return Section(
        key="requirements",
        heading=text("requirements-heading"),
        blocks=(_data_table(text("requirements-caption"), data, record, words),),
        is_appendix=True,
    )


def _rigid_rows(record: Record, words: Catalogue) -> tuple[tuple[str, str], ...]:
    text, f, plant = words.text, words.format, record.plant
    mass = f.axis(plant.moving_mass, "kg")
    rank = text("of-states", rank=plant.controllability_rank, count=len(plant.states))
    return (
        (text("moving-mass"), mass),
        (text("controllability"), rank),
    )


def long_sources(record: Record) -> list[str]:
    """Return the sources too long to be repeated in each row; the first is number 1."""
    named = [record.machine.source, *(item.source for item in record.data)]
    users = [source for source in dict.fromkeys(named) if isinstance(source, str)]
    return [source for source in users if len(source) > LONGEST_SOURCE]


def _numbered(source: Words, sources: list[str], words: Catalogue) -> str:
    """Return a source behind its number, if it has one."""
    said = words.say(source)
    return (
        f"[{sources.index(source) + 1}] {said}"
        if isinstance(source, str) and source in sources
        else said
    )


def _data_table(caption: str, data: list[Datum], record: Record, words: Catalogue) -> Table:
    text, sources = words.text, long_sources(record)

    def cited(source: Words) -> str:
        return (
            _numbered(source, sources, words).partition(" ")[0]
            if source in sources
            else (words.say(source))
        )

    return Table(
        caption=caption,
        columns=(
            Column(head=text("quantity"), width=1.3),
            Column(head=text("value"), width=0.8, is_number=True),
            Column(head=text("key"), width=1.5),
            Column(head=text("source"), width=1.1),
        ),
        rows=tuple(
            (
                datum_name(item, words),
                datum(item, record.plant.units, words),
                item.key,
                cited(item.source),
            )
            for item in data
        ),
    )


def datum_name(item: Datum, words: Catalogue) -> str:
    """Return the name of a datum, with the number of its move or the name of its mode."""
    *path, last = item.key.split(".")
    name = words.name(last)
    number = ".".join(path).removeprefix("moves[").removesuffix("]")
    if number.isdecimal():
        return f"{words.text('move', number=number)}: {name}"
    if path[:2] == ["plant", "modes"]:
        return words.text("of-mode", name=name, mode=".".join(path[2:]))
    if path == ["requirements", "peaks"]:
        return words.text("peak-bound", name=name)
    return name


def datum(item: Datum, units: dict[str, str], words: Catalogue) -> str:
    """Return the value of a datum with its unit; ``units`` are those of the plant's signals."""
    f = words.format
    key, value = item.key, item.value
    if isinstance(value, str):
        return words.known(f"loop-at-{value}", value)
    if key.endswith(("_spread", "damping_ratio")) or key.startswith("requirements.reserve."):
        return f.percent(value)
    if key.startswith("requirements.peaks."):
        return f.quantity(value, units.get(key.rpartition(".")[2], item.unit))
    return f.quantity(value, item.unit)


def _modes(record: Record, words: Catalogue) -> Table:
    text, f = words.text, words.format
    return Table(
        caption=text("modes-caption"),
        columns=(
            Column(head=text("mode"), width=1.4),
            Column(head=text("frequency"), is_number=True),
            Column(head=text("damping-ratio"), is_number=True),
            Column(head=text("tcp-gain"), is_number=True),
            Column(head=text("measured-gain"), is_number=True),
        ),
        rows=tuple(
            (
                mode.name,
                f.quantity(mode.frequency_hz, "Hz"),
                f.percent(mode.damping_ratio),
                # Below a motor that follows, q hangs back: the plant has -q for its F.
                f.axis(-mode.tcp_gain if words.follows else mode.tcp_gain, "1/kg"),
                f.axis(mode.measured_gain, "1/kg"),
            )
            for mode in record.plant.modes
        ),
    )
