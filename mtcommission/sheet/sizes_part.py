"""The recommended limits on smaller and larger moves than the profile's."""

from __future__ import annotations

import numpy as np

from mtcommission.record.schema import MoveSizesEntry, Record
from mtcommission.sheet.format import Formatter, motion_unit
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
from mtcommission.sheet.verdict_part import band, move_title

STYLES = {"recommended": 4, "commissioning rule": 1, "moving average": 2}
"""Line style of each way."""


def move_sizes(record: Record, f: Formatter) -> tuple[Section, ...]:
    """Return from which size on limits hold, move by move; nothing where nothing was tried."""
    text, entries = f.labels, record.limits.move_sizes
    if not entries:
        return ()
    blocks: list[Block] = [Paragraph(text=text.sizes_note, tone=Tone.NOTE)]
    for number, move in enumerate(record.moves, start=1):
        ways = [entry for entry in entries if entry.move == move.move]
        if ways:
            title = move_title(move.move, number, f)
            short = text.move.format(number=number)
            blocks.append(Subheading(text=title))
            blocks.append(_table(record, ways, short, f))
            blocks.append(_plot(record, ways, number, short, f))
    return (Section(key="sizes", heading=text.sizes_heading, blocks=tuple(blocks)),)


def _unit(entry: MoveSizesEntry, f: Formatter) -> str:
    length = motion_unit("m", rotary=f.rotary)
    return f"{length}/s" if "velocity_step" in entry.move else length


def _table(record: Record, ways: list[MoveSizesEntry], title: str, f: Formatter) -> Table:
    text, length = f.labels, motion_unit("m", rotary=f.rotary)
    cycle = record.loop.velocity_cycle

    def row(entry: MoveSizesEntry) -> tuple[str, ...]:
        a, j, unit = entry.acceleration, entry.jerk, _unit(entry, f)
        low, high = entry.kept_from, entry.kept_to
        return (
            text.say(entry.way),
            f.quantity(a, f"{length}/s^2"),
            text.no_jerk_limit if j is None else shown_jerk(a, j, cycle, f),
            f.quantity(entry.moving_average or None, "s"),
            f.quantity(entry.full_from, unit, missing=text.never),
            _end(low, entry.size[0], text.or_less, unit, f),
            _end(high, entry.size[-1], text.or_more, unit, f),
        )

    heads = (
        text.acceleration,
        text.jerk,
        text.filter_time,
        text.full_from,
        text.kept_from,
        text.kept_to,
    )
    return Table(
        caption=text.sizes_caption.format(move=title),
        columns=name_and_numbers(text.limits_name, heads, width=1.4),
        rows=tuple(map(row, ways)),
    )


def _end(value: float | None, last: float, form: str, unit: str, f: Formatter) -> str:
    """Return an end of the range in which the band is kept; the last one tried is open."""
    shown = f.quantity(value, unit, missing=f.labels.nowhere)
    return form.format(value=shown) if value == last else shown


def _plot(
    record: Record, ways: list[MoveSizesEntry], number: int, title: str, f: Formatter
) -> LinePlot:
    text, permitted, unit = f.labels, band(record), _unit(ways[0], f)
    length = motion_unit("m", rotary=f.rotary)
    sizes = [np.array(entry.size) for entry in ways]
    found = [
        np.array([np.nan if value is None else value for value in entry.residual_deviation])
        for entry in ways
    ]
    x_scale, y_scale = f.scale_for(sizes, unit), f.scale(permitted or 1e-6, length)
    lines = tuple(
        Line(
            label=text.say(entry.way),
            x=size[np.isfinite(y)] / x_scale.size,
            y=y[np.isfinite(y)] / y_scale.size,
            style=STYLES.get(entry.way, 0),
        )
        for entry, size, y in zip(ways, sizes, found, strict=True)
    )
    shown = f.quantity(permitted, length)
    borders = () if permitted is None else (Border(label=shown, y=permitted / y_scale.size),)
    what = text.name("velocity_step" if "velocity_step" in ways[0].move else "distance")
    return LinePlot(
        key=f"sizes-{number}",
        caption=text.sizes_plot_caption.format(move=title),
        alt=text.sizes_plot_alt.format(ways=", ".join(line.label for line in lines), band=shown),
        x_label=f"{what} in {x_scale.unit}",
        x_is_log=True,
        link=f"sizes-{number}",
        panels=(Panel(y_label=f"{text.residual} in {y_scale.unit}", lines=lines, borders=borders),),
    )
