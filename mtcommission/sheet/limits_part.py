"""Recommended limits, their alternatives, the rules of thumb beside them, and the landscape."""

from __future__ import annotations

import numpy as np
from contourpy import contour_generator
from numpy.typing import NDArray

from mtcommission.record.schema import (
    Alternative,
    AttainableEntry,
    LimitsEntry,
    ModeLimitsEntry,
    Record,
    RuleResult,
)
from mtcommission.sheet.format import Formatter, motion_unit
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
from mtcommission.sheet.verdict_part import acceleration, band, capitalised

Array = NDArray[np.float64]

RESIDUAL_BORDER, USAGE_BORDER = 1, 4
"""Line styles of the borders in the map: dashed and solid."""

UNSEEN = 0.1
"""Share of a velocity cycle below which a ramp is a step to the drive."""

SMALLEST = 1e-12
"""Stands for zero in a logarithm; far below any share of a limit that matters."""

RECOMMENDED, ALTERNATIVE, RULE = 0, 1, 2
"""Symbols of the point plot."""


def limits(record: Record, f: Formatter) -> Section:
    """Return the recommendation, what bound it and its alternatives."""
    text, part = f.labels, record.limits
    recommended = part.recommended
    head = (
        text.recommended,
        *_numbers(recommended, record, f),
        _met(record.assessment.met, f),
    )
    rows = [
        (text.say(item.name), *_numbers(item, record, f), _met(item.meets_requirements, f))
        for item in part.alternatives
    ]
    table = Table(
        caption=text.alternatives_caption,
        columns=(Column(head=text.limits_name, width=2.4), *_number_columns(f)),
        rows=(head, *rows),
        strong_rows=(0,),
    )
    return Section(
        key="limits",
        heading=text.limits_heading,
        blocks=(
            Paragraph(text=text.values_bound_by.format(bound=text.say(recommended.bound_by))),
            table,
            *_attainable(record, f),
            _machining_modes(record, f),
        ),
    )


def _attainable(record: Record, f: Formatter) -> tuple[Table, ...]:
    """Return what could be met where a requirement stands in the way; nothing if none does."""
    text, length = f.labels, motion_unit("m", rotary=f.rotary)
    heads = (text.permitted, text.attainable, text.acceleration, text.jerk)
    rows = tuple(
        (
            capitalised(text.say(name_obstacle(item))),
            f.quantity(item.limit, item.unit),
            f.quantity(item.value, item.unit),
            f.quantity(item.acceleration, f"{length}/s^2"),
            f.quantity(item.jerk, f"{length}/s^3"),
        )
        for item in record.limits.attainable
    )
    columns = name_and_numbers(text.check, heads, width=1.6)
    return (Table(caption=text.attainable_caption, columns=columns, rows=rows),) if rows else ()


def name_obstacle(item: AttainableEntry) -> str:
    """Return the requirement, and those that must give way with it, in the record's English.

    Parameters
    ----------
    item
        What could be met instead; records of older versions do not hold the others.

    Examples
    --------
    >>> item = AttainableEntry(requirement="settling time", limit=0.02, value=0.09, unit="s",
    ...     acceleration=1.8, jerk=64.0, together_with=["peak v_s"])
    >>> name_obstacle(item)
    'settling time, together with peak v_s'
    """
    others = " and ".join(item.together_with)
    return f"{item.requirement}, together with {others}" if others else item.requirement


def _mode_bound(mode: ModeLimitsEntry, f: Formatter) -> str:
    """Return what bounds a machining mode, or why it has no values and what band it could have."""
    text = f.labels
    if not mode.reason:
        return text.say(mode.bound_by)
    words = text.say(mode.reason)
    if mode.attainable is None:
        return words
    least = f.quantity(mode.attainable, motion_unit("m", rotary=f.rotary))
    return text.attainable_band.format(reason=words, band=least)


def _machining_modes(record: Record, f: Formatter) -> Table:
    """Return the three columns of limits after the usual machining modes, as rows."""
    text, length = f.labels, motion_unit("m", rotary=f.rotary)
    heads = (text.permitted_band, text.acceleration, text.jerk, text.jerk_time, text.settling_time)
    return Table(
        caption=text.machining_caption,
        columns=(
            Column(head=text.machining_mode, width=1.7),
            *(
                Column(head=head, width=1.7 if head == text.jerk else 1.2, is_number=True)
                for head in heads
            ),
            Column(head=text.bound_by_column, width=1.9),
            Column(head=text.meets, width=0.8),
        ),
        rows=tuple(
            (
                text.machining_names.get(mode.name, mode.name),
                f.quantity(mode.band, length),
                f.quantity(mode.acceleration, f"{length}/s^2"),
                f.quantity(mode.jerk, f"{length}/s^3"),
                f.quantity(mode.jerk_time, "s"),
                f.settling(mode.settling_time),
                _mode_bound(mode, f),
                _met(mode.meets_requirements, f),
            )
            for mode in record.limits.modes
        ),
    )


def rules(record: Record, f: Formatter) -> Section:
    """Return the comparison with the rules of thumb, as table and plot."""
    text, part = f.labels, record.limits
    table = Table(
        caption=text.rules_caption,
        columns=(
            Column(head=text.rule, width=2.2),
            Column(head=text.source, width=2.3),
            *_number_columns(f),
        ),
        rows=tuple(
            (
                text.say(item.name),
                text.say(item.source),
                *_numbers(item, record, f),
                _met(item.meets_requirements, f),
            )
            for item in part.rules
        ),
    )
    left_out = [
        text.say(item.name)
        for item in [*part.alternatives, *part.rules]
        if item.settling_time is None or not item.residual_deviation
    ]
    note: tuple[Block, ...] = ()
    if left_out:
        sentence = text.unsettled_rules.format(names="; ".join(left_out))
        note = (Paragraph(text=sentence, tone=Tone.NOTE),)
    return Section(
        key="rules",
        heading=text.rules_heading,
        blocks=(table, *_comparison(record, f), *note),
    )


def landscape(record: Record, f: Formatter) -> Section:
    """Return the map of settling times with the chosen point."""
    text, part = f.labels, record.limits.landscape
    recommended = record.limits.recommended
    values = np.array(
        [[np.nan if cell is None else cell for cell in row] for row in part.settling_time]
    ).reshape(len(part.acceleration), len(part.jerk_time))
    known = values[np.isfinite(values)]
    a_axis, t_axis = np.array(part.acceleration), np.array(part.jerk_time)
    a_scale = f.scale_for([a_axis], motion_unit("m/s^2", rotary=f.rotary))
    t_scale = f.scale_for([t_axis], "s")
    value_scale = f.scale_for([known], "s")
    alt = text.landscape_alt.format(
        rows=a_axis.size,
        columns=t_axis.size,
        least=f.settling(float(known.min()) if known.size else None),
        most=f.settling(float(known.max()) if known.size else None),
        acceleration=acceleration(record, f),
        jerk_time=f.quantity(recommended.jerk_time, "s"),
    )
    caption = text.landscape_caption
    if known.size < values.size:
        caption = text.hatched.format(caption=caption)
    chosen = Mark(
        label=text.chosen,
        x=recommended.jerk_time / t_scale.size,
        y=recommended.acceleration / a_scale.size,
        style=RECOMMENDED,
    )
    heat_map = HeatMap(
        key="landscape",
        caption=caption,
        alt=alt,
        x_label=f"{text.jerk_time} in {t_scale.unit}",
        y_label=f"{text.acceleration} in {a_scale.unit}",
        value_label=f"{text.settling_time} in {value_scale.unit}",
        x=t_axis / t_scale.size,
        y=a_axis / a_scale.size,
        values=values / value_scale.size,
        missing_label=text.not_settled,
        chosen=chosen,
        contours=_borders(record, t_scale.size, a_scale.size, f),
    )
    return Section(key="landscape", heading=text.landscape_heading, blocks=(heat_map,))


def _borders(record: Record, t_size: float, a_size: float, f: Formatter) -> tuple[Contour, ...]:
    """Return the curves on which the residual fills the band, and the drive its limits."""
    text, part, permitted = f.labels, record.limits.landscape, band(record)
    found = []
    if permitted is not None:
        shown = f.quantity(permitted, motion_unit("m", rotary=f.rotary))
        label = text.residual_border.format(band=shown)
        found.append((label, RESIDUAL_BORDER, part.residual_deviation, permitted))
    found.append((text.usage_border, USAGE_BORDER, part.usage, 1.0))
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


def _comparison(record: Record, f: Formatter) -> tuple[PointPlot, ...]:
    """Return the plot of settling time against residual; nothing if no point has both."""
    text, part, permitted = f.labels, record.limits, band(record)
    named: list[tuple[str, LimitsEntry | Alternative | RuleResult, int]] = [
        (text.recommended, part.recommended, RECOMMENDED),
        *((text.say(item.name), item, ALTERNATIVE) for item in part.alternatives),
        *((text.say(item.name), item, RULE) for item in part.rules),
    ]
    points = [
        (name, item.settling_time, item.residual_deviation, style)
        for name, item, style in named
        if item.settling_time and item.residual_deviation
    ]
    if not points or permitted is None:
        return ()
    length = motion_unit("m", rotary=f.rotary)
    t_scale = f.scale_for([np.array([point[1] for point in points], dtype=np.float64)], "s")
    e_scale = f.scale(permitted, length)
    marks = tuple(
        Mark(label=name, x=(t or 0.0) / t_scale.size, y=(e or 0.0) / e_scale.size, style=style)
        for name, t, e, style in points
    )
    recommended = part.recommended
    return (
        PointPlot(
            key="comparison",
            caption=text.compare_caption,
            alt=text.compare_alt.format(
                settling=f.settling(recommended.settling_time),
                residual=f.quantity(recommended.residual_deviation, length),
            ),
            x_label=f"{text.settling_time} in {t_scale.unit}",
            y_label=f"{text.residual} in {e_scale.unit}",
            marks=marks,
            border=Border(
                label=text.band.format(band=f.quantity(permitted, length)),
                y=permitted / e_scale.size,
            ),
        ),
    )


def _number_columns(f: Formatter) -> tuple[Column, ...]:
    text = f.labels
    heads = (text.acceleration, text.jerk, text.settling_time, text.residual, text.peak_deviation)
    # A jerk in degrees needs the most room.
    columns = tuple(
        Column(head=head, width=1.5 if head == text.jerk else 1.2, is_number=True) for head in heads
    )
    return (*columns, Column(head=text.meets, width=0.8))


def shown_jerk(acceleration: float, jerk: float, cycle: float, f: Formatter) -> str:
    """Return a jerk limit; in words where its ramp is far shorter than a velocity cycle [s].

    Shapers and steps of acceleration stand in the record with a jerk that limits nothing.
    """
    if acceleration < UNSEEN * cycle * jerk:
        return f.labels.no_jerk_limit
    return f.quantity(jerk, motion_unit("m/s^3", rotary=f.rotary))


def _numbers(
    item: LimitsEntry | Alternative | RuleResult, record: Record, f: Formatter
) -> tuple[str, ...]:
    length, cycle = motion_unit("m", rotary=f.rotary), record.loop.velocity_cycle
    return (
        f.quantity(item.acceleration, f"{length}/s^2"),
        shown_jerk(item.acceleration, item.jerk, cycle, f),
        f.settling(item.settling_time),
        f.quantity(item.residual_deviation, length, missing=f.labels.not_settled),
        f.quantity(item.peak_deviation, length),
    )


def _met(is_met: bool, f: Formatter) -> str:
    return f.labels.yes if is_met else f.labels.no
