"""How the recommended limits fare on machines that are a little different from the profile."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import motion_unit
from mtcommission.record.schema.moves import MoveEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.robustness import DistributionEntry, MonteCarloEntry
from mtcommission.sheet.basis_part import kept_sentence
from mtcommission.sheet.model import (
    Block,
    Column,
    Paragraph,
    Section,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.values import residual, settling
from mtcommission.sheet.verdict_part import band, move_title

Array = NDArray[np.float64]

CURVE = 4
"""Line style of what is found."""


def robustness(record: Record, words: Catalogue) -> Section:
    """Return corners, frequency error and drawn machines."""
    text, drawn = words.text, record.robustness.monte_carlo
    found: tuple[Block, ...] = (Paragraph(text=text("nothing-drawn"), tone=Tone.NOTE),)
    if drawn is not None:
        found = _drawn(record, drawn, words)
    return Section(
        key="robustness-details" if record.machine.follows else "robustness",
        heading=text("robustness-heading"),
        blocks=(
            *([] if record.machine.follows else held_range(record, words)),
            *found,
        ),
        is_appendix=True,
    )


def held_range(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return what comes about in every corner, and over the error of all frequencies."""
    corners = (
        _corners(move, move_title(move.move, number, words), record.plant.units["F"], words)
        for number, move in enumerate(record.moves, start=1)
    )
    return (
        *corners,
        Paragraph(text=kept_sentence(record, words)),
        *_frequency_error(record, words),
    )


def _corners(move: MoveEntry, title: str, force_unit: str, words: Catalogue) -> Table:
    text, f = words.text, words.format
    rows = tuple(
        (
            f.axis(corner.payload, "kg"),
            f.percent(corner.frequency_factor),
            f.percent(corner.damping_factor),
            settling(corner.settling_time, words),
            residual(corner.residual_deviation, words),
            f.axis(corner.peak_deviation, "m"),
            f.quantity(corner.max_force, force_unit),
            f.quantity(corner.rms_force, force_unit),
            text("yes") if corner.saturated else text("no"),
        )
        for corner in move.corners
    )
    heads = (
        text("payload"),
        text("frequencies"),
        text("dampings"),
        text("settling-time"),
        text("residual"),
        text("peak-deviation"),
        text("max-force"),
        text("rms-force"),
        text("saturated"),
    )
    return Table(
        caption=text("corners-caption", move=title),
        columns=tuple(Column(head=head, is_number=head != text("saturated")) for head in heads),
        rows=rows,
        strong_rows=tuple(
            i for i, corner in enumerate(move.corners) if corner.settling_time is None
        ),
    )


def _frequency_error(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return the curves over the frequency error; where one has no point, why it is missing."""
    text, f, error = words.text, words.format, record.robustness.frequency_error
    residual, settling = (
        np.array([np.nan if value is None else value for value in values])
        for values in (error.residual_deviation, error.settling_time)
    )
    tried = {
        "low": f.signed_percent(error.factor[0] - 1.0),
        "high": f.signed_percent(error.factor[-1] - 1.0),
    }
    if not np.isfinite(residual).any():
        return (Paragraph(text=text("no-error-curves", **tried), tone=Tone.NOTE),)
    plot = _frequency_plot(record, residual, settling, words)
    if np.isfinite(settling).any():
        return (plot,)
    return (plot, Paragraph(text=text("no-settling-curve", **tried), tone=Tone.NOTE))


def _frequency_plot(record: Record, residual: Array, settling: Array, words: Catalogue) -> LinePlot:
    """Return residual deviation and, where it has points, settling time over the error."""
    text, f, permitted = words.text, words.format, band(record)
    x = 100.0 * (np.array(record.robustness.frequency_error.factor) - 1.0)
    length = motion_unit("m", rotary=words.rotary)
    limits = () if permitted is None else (permitted,)
    panels = [_panel(text("residual"), text("recommended"), x, residual, length, limits, words)]
    shown = "residual-error"
    if np.isfinite(settling).any():
        panels.append(
            _panel(text("settling-time"), text("recommended"), x, settling, "s", (), words)
        )
        shown = "frequency-error"
    return LinePlot(
        key="frequency-error",
        caption=text(f"{shown}-caption"),
        alt=text(
            f"{shown}-alt",
            least=f.axis(float(np.nanmin(residual)), "m"),
            most=f.axis(float(np.nanmax(residual)), "m"),
            band=f.axis(permitted, "m"),
        ),
        x_label=text("frequency-error"),
        x_is_log=False,
        link="frequency-error",
        panels=tuple(panels),
    )


def _panel(
    name: str,
    label: str,
    x: Array,
    y: Array,
    unit: str,
    limits: tuple[float, ...],
    words: Catalogue,
) -> Panel:
    f = words.format
    known = np.isfinite(y)
    scale = f.scale_for([y[known], np.array(limits)], unit)
    return Panel(
        y_label=words.text("in-unit", name=name, unit=scale.unit),
        lines=(Line(label=label, x=x[known], y=y[known] / scale.size, style=CURVE),),
        borders=tuple(
            Border(label=f.quantity(limit, unit), y=limit / scale.size) for limit in limits
        ),
    )


def _drawn(record: Record, drawn: MonteCarloEntry, words: Catalogue) -> tuple[Block, ...]:
    """Return what was drawn, the distribution, and the worst machines."""
    text = words.text
    histograms = [
        _histogram("settling_time", text("settling-time"), drawn.settling_time, words),
        _histogram("residual_deviation", text("residual"), drawn.residual_deviation, words),
    ]
    return (
        Paragraph(text=drawn_sentence(drawn, words)),
        _quantiles(drawn, words),
        *(plot for plot in histograms if plot is not None),
        _extremes(drawn, words),
    )


def drawn_sentence(drawn: MonteCarloEntry, words: Catalogue) -> str:
    """Return how many machines were drawn and how many of them keep the requirements."""
    f = words.format
    return words.text(
        "drawn",
        samples=f.number(drawn.samples),
        seed=drawn.seed,
        met=f.percent(drawn.share_met),
        band=f.percent(drawn.share_in_band),
    )


def _quantiles(drawn: MonteCarloEntry, words: Catalogue) -> Table:
    text, f = words.text, words.format
    settling, residual = drawn.settling_time, drawn.residual_deviation
    rows = []
    for slow, far in zip(settling.quantiles, residual.quantiles, strict=True):
        name = {0.0: text("least"), 1.0: text("largest")}.get(slow.share)
        share = name or text("share-of-machines", share=f.percent(slow.share))
        rows.append(
            (
                share,
                f.quantity(slow.value, settling.unit, missing=text("not-settled")),
                f.quantity(far.value, residual.unit, missing=text("not-settled")),
            )
        )
    return Table(
        caption=text("quantiles-caption"),
        columns=(
            Column(head=text("machines"), width=1.6),
            Column(head=text("settling-time"), is_number=True),
            Column(head=text("residual"), is_number=True),
        ),
        rows=tuple(rows),
    )


def _histogram(key: str, name: str, values: DistributionEntry, words: Catalogue) -> LinePlot | None:
    """Return how many machines lie where; None where all are alike or none settles."""
    text, f, edges = words.text, words.format, np.array(values.histogram.edges)
    if edges.size < 3:
        return None
    counts = np.array(values.histogram.counts, dtype=np.float64)
    scale = f.scale_for([edges], values.unit)
    x = np.concatenate([edges[:1], edges]) / scale.size
    y = np.concatenate([[0.0], counts, [0.0]])
    line = Line(label=text("machines"), x=x, y=y, style=CURVE, is_stepped=True)
    fullest = int(counts.argmax())
    return LinePlot(
        key=f"histogram-{key}",
        caption=text("histogram-caption", name=name),
        alt=text(
            "histogram-alt",
            low=f.quantity(edges[0], values.unit),
            high=f.quantity(edges[-1], values.unit),
            most=f.number(counts[fullest]),
            place=f.quantity((edges[fullest] + edges[fullest + 1]) / 2, values.unit),
        ),
        x_label=words.text("in-unit", name=name, unit=scale.unit),
        x_is_log=False,
        link=f"histogram-{key}",
        panels=(Panel(y_label=text("machines"), lines=(line,)),),
    )


def _extremes(drawn: MonteCarloEntry, words: Catalogue) -> Table:
    text, f = words.text, words.format
    named = ((text("worst-machine"), drawn.worst), (text("slowest-machine"), drawn.slowest))
    heads = (
        text("payload"),
        text("frequencies"),
        text("dampings"),
        text("settling-time"),
        text("residual"),
    )
    return Table(
        caption=text("extremes-caption"),
        columns=name_and_numbers(text("machine-row"), heads, width=1.8),
        rows=tuple(
            (
                name,
                f.axis(sample.payload, "kg"),
                f.percent(sample.frequency_factor),
                f.percent(sample.damping_factor),
                settling(sample.settling_time, words),
                residual(sample.residual_deviation, words),
            )
            for name, sample in named
        ),
    )
