"""Machine and axis data, modes, moves and requirements."""

from __future__ import annotations

from mtcommission.record.schema import Quantity, Record
from mtcommission.sheet.format import Formatter, motion_unit
from mtcommission.sheet.model import Block, Column, Paragraph, Section, Table
from mtcommission.sheet.verdict_part import move_title

REQUIRED = ("requirements.", "moves")
"""Beginnings of the keys that say what is required, not what the machine is."""


def machine_data(record: Record, f: Formatter) -> Section:
    """Return the machine's data with their sources, and its modes."""
    text, machine = f.labels, record["machine"]
    data = [item for item in record["data"] if not item["key"].startswith(REQUIRED)]
    title = Table(
        caption=text.rigid_caption,
        columns=(Column(head=text.quantity), Column(head=text.value, width=2.0)),
        rows=(
            (text.machine_row, machine["name"]),
            (text.axis_row, machine["axis"]),
            (text.motion_row, text.rotary if f.rotary else text.linear),
            (text.source, text.say_if_known(machine["source"])),
            *_rigid_rows(record, f),
        ),
    )
    return Section(
        key="machine",
        heading=text.machine_heading,
        blocks=(
            title,
            _data_table(text.data_caption, data, record["plant"]["units"], f),
            _modes(record, f),
        ),
    )


def requirements(record: Record, f: Formatter) -> Section:
    """Return the moves and what is required of them."""
    text = f.labels
    data = [item for item in record["data"] if item["key"].startswith(REQUIRED)]
    moves: tuple[Block, ...] = tuple(
        Paragraph(text=move_title(move["move"], number, f) + ".")
        for number, move in enumerate(record["moves"], start=1)
    )
    return Section(
        key="requirements",
        heading=text.requirements_heading,
        blocks=(*moves, _data_table(text.requirements_caption, data, record["plant"]["units"], f)),
    )


def _rigid_rows(record: Record, f: Formatter) -> tuple[tuple[str, str], ...]:
    text, plant = f.labels, record["plant"]
    mass = f.quantity(plant["moving_mass"], motion_unit("kg", rotary=f.rotary))
    rank = text.of_states.format(rank=plant["controllability_rank"], count=len(plant["states"]))
    return (
        (text.moving_inertia if f.rotary else text.moving_mass, mass),
        (text.controllability, rank),
    )


def _data_table(caption: str, data: list[Quantity], units: dict[str, str], f: Formatter) -> Table:
    text = f.labels
    return Table(
        caption=caption,
        columns=(
            Column(head=text.quantity, width=1.3),
            Column(head=text.value, width=0.8, is_number=True),
            Column(head=text.key, width=1.5),
            Column(head=text.source, width=1.8),
        ),
        rows=tuple(
            (
                datum_name(item, f),
                datum(item, units, f),
                item["key"],
                text.say_if_known(item["source"]),
            )
            for item in data
        ),
    )


def datum_name(item: Quantity, f: Formatter) -> str:
    """Return the name of a datum; of one of a mode, with the mode's name."""
    *path, last = item["key"].split(".")
    name = f.labels.name(last)
    if path[:2] == ["plant", "modes"]:
        return f.labels.of_mode.format(name=name, mode=".".join(path[2:]))
    if path == ["requirements", "peaks"]:
        return f.labels.peak_bound.format(name=name)
    return name


def datum(item: Quantity, units: dict[str, str], f: Formatter) -> str:
    """Return the value of a datum with its unit; ``units`` are those of the plant's signals."""
    key, value = item["key"], item["value"]
    if isinstance(value, str):
        return value
    if key.endswith(("_spread", "damping_ratio")):
        return f.percent(value)
    if key.startswith("requirements.peaks."):
        return f.quantity(value, units.get(key.rpartition(".")[2], item["unit"]))
    return f.quantity(value, item["unit"])


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
                mode["name"],
                f.quantity(mode["frequency_hz"], "Hz"),
                f.percent(mode["damping_ratio"]),
                f.quantity(mode["tcp_gain"], per_mass),
                f.quantity(mode["measured_gain"], per_mass),
            )
            for mode in record["plant"]["modes"]
        ),
    )
