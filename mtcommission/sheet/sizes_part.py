"""The recommended limits on smaller and larger moves than the profile's."""

from __future__ import annotations

import numpy as np

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.messages.quantities import motion_unit
from mtcommission.record.schema.limits import MoveSizesEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Words
from mtcommission.sheet.limits_part import shown_jerk
from mtcommission.sheet.model import (
    Block,
    Paragraph,
    Section,
    Subheading,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.verdict_part import band, move_title, slowest_move

STYLES: dict[Words, int] = {
    Message("way-recommended"): 4,
    Message("commissioning-rule"): 1,
    Message("way-listed"): 2,
}
"""Line style of each way."""


def move_sizes(record: Record, words: Catalogue) -> tuple[Section, ...]:
    """Return from which size on limits hold, move by move; nothing where nothing was tried."""
    text = words.text
    if not record.limits.move_sizes:
        return ()
    shown_before = slowest_move(record)
    blocks: list[Block] = [Paragraph(text=text("sizes-note"), tone=Tone.NOTE)]
    for number, move in enumerate(record.moves, start=1):
        if ways := _ways(record, number):
            blocks.append(Subheading(text=move_title(move.move, number, words)))
            blocks.append(_table(record, ways, text("move", number=number), words))
            if number != shown_before:
                blocks += size_plot(record, number, words)
    heading = text("sizes-heading")
    return (Section(key="sizes", heading=heading, blocks=tuple(blocks), is_appendix=True),)


def size_plot(record: Record, number: int, words: Catalogue) -> tuple[LinePlot, ...]:
    """Return the residual deviation over the size of a move; nothing where none was tried."""
    ways = _ways(record, number)
    title = words.text("move", number=number)
    return (_plot(record, ways, number, title, words),) if ways else ()


def _ways(record: Record, number: int) -> list[MoveSizesEntry]:
    move = record.moves[number - 1].move
    return [entry for entry in record.limits.move_sizes if entry.move == move]


def _unit(entry: MoveSizesEntry, words: Catalogue) -> str:
    length = motion_unit("m", rotary=words.rotary)
    return f"{length}/s" if "velocity_step" in entry.move else length


def _table(record: Record, ways: list[MoveSizesEntry], title: str, words: Catalogue) -> Table:
    text, f = words.text, words.format

    def row(entry: MoveSizesEntry) -> tuple[str, ...]:
        a, j, unit = entry.acceleration, entry.jerk, _unit(entry, words)
        low, high = entry.kept_from, entry.kept_to
        return (
            words.say(entry.way),
            f.axis(a, "m/s^2"),
            shown_jerk(a, j, record.loop, words),
            f.quantity(entry.setpoint_filter.duration if entry.setpoint_filter else None, "s"),
            f.quantity(entry.full_from, unit, missing=text("never")),
            _end(low, entry.size[0], "or-less", unit, words),
            _end(high, entry.size[-1], "or-more", unit, words),
        )

    heads = (
        text("acceleration"),
        text("jerk"),
        text("filter-time"),
        text("full-from"),
        text("kept-from"),
        text("kept-to"),
    )
    return Table(
        caption=text("sizes-caption", move=title),
        columns=name_and_numbers(text("limits-name"), heads, width=1.4),
        rows=tuple(map(row, ways)),
    )


def _end(value: float | None, last: float, open_end: str, unit: str, words: Catalogue) -> str:
    """Return an end of the range in which the band is kept; the last one tried is open."""
    shown = words.format.quantity(value, unit, missing=words.text("nowhere"))
    return words.text(open_end, value=shown) if value == last else shown


def _plot(
    record: Record, ways: list[MoveSizesEntry], number: int, title: str, words: Catalogue
) -> LinePlot:
    text, f, permitted, unit = words.text, words.format, band(record), _unit(ways[0], words)
    length = motion_unit("m", rotary=words.rotary)
    sizes = [np.array(entry.size) for entry in ways]
    found = [
        np.array([np.nan if value is None else value for value in entry.residual_deviation])
        for entry in ways
    ]
    x_scale, y_scale = f.scale_for(sizes, unit), f.scale(permitted or 1e-6, length)
    lines = tuple(
        Line(
            label=words.say(entry.way),
            x=size[np.isfinite(y)] / x_scale.size,
            y=y[np.isfinite(y)] / y_scale.size,
            style=STYLES.get(entry.way, 0),
        )
        for entry, size, y in zip(ways, sizes, found, strict=True)
    )
    shown = f.axis(permitted, "m")
    borders = () if permitted is None else (Border(label=shown, y=permitted / y_scale.size),)
    what = words.name("velocity_step" if "velocity_step" in ways[0].move else "distance")
    return LinePlot(
        key=f"sizes-{number}",
        caption=text("sizes-plot-caption", move=title),
        alt=text("sizes-plot-alt", ways=", ".join(line.label for line in lines), band=shown),
        x_label=words.text("in-unit", name=what, unit=x_scale.unit),
        x_is_log=True,
        link=f"sizes-{number}",
        panels=(
            Panel(
                y_label=text("in-unit", name=text("residual"), unit=y_scale.unit),
                lines=lines,
                borders=borders,
            ),
        ),
    )
