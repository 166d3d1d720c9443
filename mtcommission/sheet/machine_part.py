"""Machine and axis data, modes, moves and requirements."""

from __future__ import annotations

import re

from mtcommission.record.schema import Datum, Record
from mtcommission.sheet.format import Formatter, motion_unit
from mtcommission.sheet.model import Column, Paragraph, Section, Table, Tone

REQUIRED = ("requirements.", "moves")
"""Beginnings of the keys that say what is required, not what the machine is."""

LONGEST_SOURCE = 28
"""Letters of a source that fits into its column; a longer one stands once, with a number."""


def machine_data(record: Record, f: Formatter) -> Section:
    """Return the machine's data with their sources, and its modes."""
    text, machine, sources = f.labels, record.machine, long_sources(record)
    data = [item for item in record.data if not item.key.startswith(REQUIRED)]
    title = Table(
        caption=text.rigid_caption,
        columns=(Column(head=text.quantity), Column(head=text.value, width=2.0)),
        rows=(
            (text.machine_row, machine.name),
            (text.axis_row, machine.axis),
            (text.motion_row, text.rotary if f.rotary else text.linear),
            (text.source, _numbered(machine.source, sources, f)),
            *_rigid_rows(record, f),
        ),
    )
    return Section(
        key="machine",
        heading=text.machine_heading,
        blocks=(
            title,
            _data_table(text.data_caption, data, record, f),
            *(
                Paragraph(text=_numbered(source, sources, f), tone=Tone.NOTE)
                for source in sources
                if source != machine.source
            ),
            _modes(record, f),
        ),
    )


def requirements(record: Record, f: Formatter) -> Section:
    """Return the moves and what is required of them."""
    text = f.labels
    data = [item for item in record.data if item.key.startswith(REQUIRED)]
    return Section(
        key="requirements",
        heading=text.requirements_heading,
        blocks=(_data_table(text.requirements_caption, data, record, f),),
    )


def _rigid_rows(record: Record, f: Formatter) -> tuple[tuple[str, str], ...]:
    text, plant = f.labels, record.plant
    mass = f.quantity(plant.moving_mass, motion_unit("kg", rotary=f.rotary))
    rank = text.of_states.format(rank=plant.controllability_rank, count=len(plant.states))
    return (
        (text.moving_mass, mass),
        (text.controllability, rank),
    )


def long_sources(record: Record) -> list[str]:
    """Return the sources too long to be repeated in each row; the first is number 1."""
    named = [record.machine.source, *(item.source for item in record.data)]
    return [source for source in dict.fromkeys(named) if len(source) > LONGEST_SOURCE]


def _numbered(source: str, sources: list[str], f: Formatter) -> str:
    """Return a source behind its number, if it has one."""
    words = f.labels.say_if_known(source)
    return f"[{sources.index(source) + 1}] {words}" if source in sources else words


def _data_table(caption: str, data: list[Datum], record: Record, f: Formatter) -> Table:
    text, sources = f.labels, long_sources(record)

    def cited(source: str) -> str:
        return (
            _numbered(source, sources, f).partition(" ")[0]
            if source in sources
            else (text.say_if_known(source))
        )

    return Table(
        caption=caption,
        columns=(
            Column(head=text.quantity, width=1.3),
            Column(head=text.value, width=0.8, is_number=True),
            Column(head=text.key, width=1.5),
            Column(head=text.source, width=1.1),
        ),
        rows=tuple(
            (
                datum_name(item, f),
                datum(item, record.plant.units, f),
                item.key,
                cited(item.source),
            )
            for item in data
        ),
    )


def datum_name(item: Datum, f: Formatter) -> str:
    """Return the name of a datum, with the number of its move or the name of its mode."""
    *path, last = item.key.split(".")
    name = f.labels.name(last)
    number = re.fullmatch(r"moves\[(\d+)\]", ".".join(path))
    if number:
        return f"{f.labels.move.format(number=number[1])}: {name}"
    if path[:2] == ["plant", "modes"]:
        return f.labels.of_mode.format(name=name, mode=".".join(path[2:]))
    if path == ["requirements", "peaks"]:
        return f.labels.peak_bound.format(name=name)
    return name


def datum(item: Datum, units: dict[str, str], f: Formatter) -> str:
    """Return the value of a datum with its unit; ``units`` are those of the plant's signals."""
    key, value = item.key, item.value
    if isinstance(value, str):
        return value
    if key.endswith(("_spread", "damping_ratio")):
        return f.percent(value)
    if key.startswith("requirements.peaks."):
        return f.quantity(value, units.get(key.rpartition(".")[2], item.unit))
    return f.quantity(value, item.unit)


def _modes(record: Record, f: Formatter) -> Table:
    text = f.labels
    per_mass = motion_unit("1/kg", rotary=f.rotary)
    return Table(
        caption=text.modes_caption,
        columns=(
            Column(head=text.mode, width=1.4),
            Column(head=text.frequency, is_number=True),
            Column(head=text.damping_ratio, is_number=True),
            Column(head=text.tcp_gain, is_number=True),
            Column(head=text.measured_gain, is_number=True),
        ),
        rows=tuple(
            (
                mode.name,
                f.quantity(mode.frequency_hz, "Hz"),
                f.percent(mode.damping_ratio),
                f.quantity(mode.tcp_gain, per_mass),
                f.quantity(mode.measured_gain, per_mass),
            )
            for mode in record.plant.modes
        ),
    )
