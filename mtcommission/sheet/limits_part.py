"""Limits by machining mode, what could be met instead, rules of thumb, and the landscape."""

from __future__ import annotations

import numpy as np
from contourpy import contour_generator
from numpy.typing import NDArray

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import motion_unit
from mtcommission.record.schema.limits import (
    Alternative,
    JudgedLimits,
    LimitsEntry,
    ModeLimitsEntry,
    RuleResult,
    TodayEntry,
)
from mtcommission.record.schema.loop import LoopPart
from mtcommission.record.schema.record import Record
from mtcommission.sheet.model import (
    Block,
    Column,
    Paragraph,
    Section,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.plot_model import Border, Contour, HeatMap, Mark, PointPlot
from mtcommission.sheet.values import ROUNDED, residual, say_limiting, settling
from mtcommission.sheet.verdict_part import (
    acceleration,
    band,
    capitalised,
    met_at_all,
)

Array = NDArray[np.float64]

RESIDUAL_BORDER, USAGE_BORDER = 1, 4
"""Line styles of the borders in the map: dashed and solid."""

UNSEEN = 0.1
"""Share of a velocity cycle below which a ramp is a step to the drive."""

SMALLEST = 1e-12
"""Stands for zero in a logarithm; far below any share of a limit that matters."""

RECOMMENDED, ALTERNATIVE, RULE = 0, 1, 2
"""Symbols of the point plot."""


def attainable_table(record: Record, words: Catalogue) -> tuple[Table, ...]:
    """Return what could be met where a requirement stands in the way; nothing if none does."""
    text, f = words.text, words.format
    heads = (text("permitted"), text("attainable"), text("acceleration"), text("jerk"))
    rows = tuple(
        (
            capitalised(say_limiting(item, words)),
            f.quantity(item.limit, item.unit),
            f.quantity(item.value, item.unit),
            f.axis(item.acceleration, "m/s^2"),
            shown_jerk(item.acceleration, item.jerk, record.loop, words),
        )
        for item in record.limits.attainable
    )
    columns = name_and_numbers(text("check"), heads, width=1.6)
    return (Table(caption=text("attainable-caption"), columns=columns, rows=rows),) if rows else ()


def _mode_bound(mode: ModeLimitsEntry, words: Catalogue) -> str:
    """Return what bounds a machining mode, or why it has no values and what band it could have."""
    text, f = words.text, words.format
    if not mode.reason:
        return words.say(mode.bound_by)
    reason = words.say(mode.reason)
    if mode.attainable is None:
        return reason
    least = f.axis(mode.attainable, "m")
    return text("attainable-band", reason=reason, band=least)


def machining_modes(record: Record, words: Catalogue) -> Table:
    """Return the three columns of limits after the usual machining modes, as rows."""
    text, f = words.text, words.format
    heads = (
        text("permitted-band"),
        text("acceleration"),
        text("jerk"),
        text("jerk-time"),
        text("settling-time"),
    )
    return Table(
        caption=text("machining-caption"),
        columns=(
            Column(head=text("machining-mode"), width=1.7),
            *(
                Column(head=head, width=1.7 if head == text("jerk") else 1.2, is_number=True)
                for head in heads
            ),
            Column(head=text("bound-by-column"), width=1.9),
            Column(head=text("meets"), width=0.8),
        ),
        rows=tuple(
            (
                words.known(f"machining-{mode.name}", mode.name),
                f.axis(mode.band, "m"),
                f.axis(mode.acceleration, "m/s^2"),
                shown_jerk(mode.acceleration, mode.jerk, record.loop, words)
                if mode.acceleration is not None
                else f.axis(mode.jerk, "m/s^3"),
                f.quantity(mode.jerk_time, "s"),
                settling(mode.settling_time, words),
                _mode_bound(mode, words),
                met_at_all(mode.meets_requirements, True, words),
            )
            for mode in record.limits.modes
        ),
    )


def rules(record: Record, words: Catalogue) -> Section:
    """Return the rules of thumb that meet all requirements as a table, all of them as a plot."""
    text, part = words.text, record.limits
    good = [item for item in part.rules if item.meets_requirements]
    others = [
        words.say(item.name)
        for item in [*part.alternatives, *part.rules]
        if not item.meets_requirements
    ]
    table = Table(
        caption=text("rules-caption"),
        columns=(
            Column(head=text("rule"), width=2.2),
            Column(head=text("source"), width=2.3),
            *number_columns(words),
        ),
        rows=tuple(
            (
                words.say(item.name),
                words.say(item.source),
                *limits_numbers(item, record, words),
                met_at_all(item.meets_requirements, item.keeps_reserve, words),
            )
            for item in good
        ),
    )
    missed = Paragraph(text=text("rules-missed", names="; ".join(others)))
    left_out = [
        words.say(item.name)
        for item in [*part.alternatives, *part.rules]
        if item.settling_time is None or not item.residual_deviation
    ]
    note: tuple[Block, ...] = ()
    if left_out:
        sentence = text("unsettled-rules", names="; ".join(left_out))
        note = (Paragraph(text=sentence, tone=Tone.NOTE),)
    return Section(
        key="rules",
        heading=text("rules-heading"),
        blocks=(
            *([table] if good else []),
            *([missed] if others else []),
            *_comparison(record, words),
            *note,
        ),
        is_appendix=True,
    )


def landscape(record: Record, words: Catalogue) -> Section:
    """Return the map of settling times with the chosen point."""
    text, f, part = words.text, words.format, record.limits.landscape
    recommended = record.limits.recommended
    values = np.array(
        [[np.nan if cell is None else cell for cell in row] for row in part.settling_time]
    ).reshape(len(part.acceleration), len(part.jerk_time))
    known = values[np.isfinite(values)]
    a_axis, t_axis = np.array(part.acceleration), np.array(part.jerk_time)
    a_scale = f.scale_for([a_axis], motion_unit("m/s^2", rotary=words.rotary))
    t_scale = f.scale_for([t_axis], "s")
    value_scale = f.scale_for([known], "s")
    alt = text(
        "landscape-alt",
        rows=a_axis.size,
        columns=t_axis.size,
        least=settling(float(known.min()) if known.size else None, words),
        most=settling(float(known.max()) if known.size else None, words),
        acceleration=acceleration(record, words),
        jerk_time=f.quantity(recommended.jerk_time, "s"),
    )
    caption = text("landscape-caption")
    if known.size < values.size:
        caption = text("hatched", caption=caption)
    chosen = Mark(
        label=text("chosen"),
        x=recommended.jerk_time / t_scale.size,
        y=recommended.acceleration / a_scale.size,
        style=RECOMMENDED,
    )
    heat_map = HeatMap(
        key="landscape",
        caption=caption,
        alt=alt,
        x_label=text("in-unit", name=text("jerk-time"), unit=t_scale.unit),
        y_label=text("in-unit", name=text("acceleration"), unit=a_scale.unit),
        value_label=text("in-unit", name=text("settling-time"), unit=value_scale.unit),
        x=t_axis / t_scale.size,
        y=a_axis / a_scale.size,
        values=values / value_scale.size,
        chosen=chosen,
        contours=_borders(record, t_scale.size, a_scale.size, words),
    )
    return Section(
        key="landscape", heading=text("landscape-heading"), blocks=(heat_map,), is_appendix=True
    )


def _borders(record: Record, t_size: float, a_size: float, words: Catalogue) -> tuple[Contour, ...]:
    """Return the curves on which the residual fills the band, and the drive its limits."""
    text, f, part, permitted = words.text, words.format, record.limits.landscape, band(record)
    found = []
    if permitted is not None:
        shown = f.axis(permitted, "m")
        label = text("residual-border", band=shown)
        found.append((label, RESIDUAL_BORDER, part.residual_deviation, permitted))
    found.append((text("usage-border"), USAGE_BORDER, part.usage, 1.0))
    size = np.array([t_size, a_size])
    contours = []
    for label, style, grid, level in found:
        values = np.array([[np.nan if cell is None else cell for cell in row] for row in grid])
        paths = trace(np.array(part.jerk_time), np.array(part.acceleration), values, level=level)
        if paths:
            scaled = tuple(path / size for path in paths)
            contours.append(Contour(label=label, style=style, paths=scaled))
    return tuple(contours)


def trace(x: Array, y: Array, values: Array, *, level: float) -> tuple[Array, ...]:
    """Return where values on a grid reach a level.

    Parameters
    ----------
    x, y
        Axes, shapes (n_x,) and (n_y,).
    values
        Not negative, shape (n_y, n_x); nan where unknown.
    level
        Above 0.

    Returns
    -------
    tuple of ndarray
        Curves of shape (n, 2). Between the points of the grid the logarithm of the value is
        taken as linear: residuals span decades.

    Examples
    --------
    >>> trace(np.array([0.0, 2.0]), np.array([0.0, 1.0]),
    ...     np.array([[0.1, 10.0], [0.1, 10.0]]), level=1.0)[0][:, 0]
    array([1., 1.])
    """
    if min(values.shape) < 2:
        return ()
    logarithm = np.log(np.maximum(values / level, SMALLEST))
    lines = contour_generator(x, y, np.ma.masked_invalid(logarithm)).lines(0.0)
    return tuple(np.asarray(line, dtype=np.float64) for line in lines)


def _comparison(record: Record, words: Catalogue) -> tuple[PointPlot, ...]:
    """Return the plot of settling time against residual; nothing if no point has both."""
    text, f, part, permitted = words.text, words.format, record.limits, band(record)
    named: list[tuple[str, LimitsEntry | Alternative | RuleResult, int]] = [
        (text("recommended"), part.recommended, RECOMMENDED),
        *((words.say(item.name), item, ALTERNATIVE) for item in part.alternatives),
        *((words.say(item.name), item, RULE) for item in part.rules),
    ]
    points = [
        (name, item.settling_time, item.residual_deviation, style)
        for name, item, style in named
        if item.settling_time and item.residual_deviation
    ]
    if not points or permitted is None:
        return ()
    t_scale = f.scale_for([np.array([point[1] for point in points], dtype=np.float64)], "s")
    e_scale = f.scale(permitted, motion_unit("m", rotary=words.rotary))
    marks = tuple(
        Mark(label=name, x=(t or 0.0) / t_scale.size, y=(e or 0.0) / e_scale.size, style=style)
        for name, t, e, style in points
    )
    recommended = part.recommended
    return (
        PointPlot(
            key="comparison",
            caption=text("compare-caption"),
            alt=text(
                "compare-alt",
                settling=settling(recommended.settling_time, words),
                residual=f.axis(recommended.residual_deviation, "m"),
            ),
            x_label=text("in-unit", name=text("settling-time"), unit=t_scale.unit),
            y_label=text("in-unit", name=text("residual"), unit=e_scale.unit),
            marks=marks,
            border=Border(
                label=text("band", band=f.axis(permitted, "m")),
                y=permitted / e_scale.size,
            ),
        ),
    )


def number_columns(words: Catalogue) -> tuple[Column, ...]:
    """Return the columns of what limits are and give."""
    text = words.text
    heads = (
        text("acceleration"),
        text("jerk"),
        text("settling-time"),
        text("residual"),
        text("peak-deviation"),
    )
    # A jerk in degrees needs the most room.
    columns = tuple(
        Column(head=head, width=1.5 if head == text("jerk") else 1.2, is_number=True)
        for head in heads
    )
    return (*columns, Column(head=text("meets"), width=1.15))


def shown_jerk(acceleration: float, jerk: float | None, loop: LoopPart, words: Catalogue) -> str:
    """Return a jerk limit; in words where its ramp is far shorter than a velocity cycle.

    Shapers and steps of acceleration stand in the record with a jerk that limits nothing. Where
    the control has no jerk limit, that is a ramp of a position cycle; a rule that was tried with a
    longer one shows the jerk that it was tried with.
    """
    shortest = UNSEEN * loop.velocity_cycle
    if loop.jerk == "none":
        shortest = ROUNDED * loop.position_cycle
    if jerk is None or acceleration < shortest * jerk:
        return words.text("no-jerk-limit")
    return words.format.axis(jerk, "m/s^3")


def limits_numbers(
    item: LimitsEntry | JudgedLimits | TodayEntry, record: Record, words: Catalogue
) -> tuple[str, ...]:
    """Return acceleration, jerk, settling time, residual and peak deviation of limits."""
    f = words.format
    return (
        f.axis(item.acceleration, "m/s^2"),
        shown_jerk(item.acceleration, item.jerk, record.loop, words),
        settling(item.settling_time, words),
        residual(item.residual_deviation, words),
        f.axis(item.peak_deviation, "m"),
    )
