"""How the recommended limits fare on machines that are a little different from the profile."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.record.schema import DistributionEntry, MonteCarloEntry, MoveEntry, Record
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
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.verdict_part import band, move_title

Array = NDArray[np.float64]

CURVE = 4
"""Line style of what is found."""


def robustness(record: Record, f: Formatter) -> Section:
    """Return corners, frequency error, drawn machines, and what small changes cost."""
    text, drawn = f.labels, record.robustness.monte_carlo
    corners = (
        _corners(move, move_title(move.move, number, f), record.plant.units["F"], f)
        for number, move in enumerate(record.moves, start=1)
    )
    found: tuple[Block, ...] = (Paragraph(text=text.nothing_drawn, tone=Tone.NOTE),)
    if drawn is not None:
        found = _drawn(record, drawn, f)
    return Section(
        key="robustness",
        heading=text.robustness_heading,
        blocks=(
            *corners,
            Paragraph(text=kept_sentence(record, f)),
            *_frequency_error(record, f),
            *found,
            _sensitivities(record, f),
        ),
    )


def _corners(move: MoveEntry, title: str, force_unit: str, f: Formatter) -> Table:
    text = f.labels
    length = motion_unit("m", rotary=f.rotary)
    rows = tuple(
        (
            f.quantity(corner.payload, motion_unit("kg", rotary=f.rotary)),
            f.percent(corner.frequency_factor),
            f.percent(corner.damping_factor),
            f.settling(corner.settling_time),
            f.quantity(corner.residual_deviation, length, missing=text.not_settled),
            f.quantity(corner.peak_deviation, length),
            f.quantity(corner.max_force, force_unit),
            f.quantity(corner.rms_force, force_unit),
            text.yes if corner.saturated else text.no,
        )
        for corner in move.corners
    )
    heads = (
        text.payload,
        text.frequencies,
        text.dampings,
        text.settling_time,
        text.residual,
        text.peak_deviation,
        text.max_force,
        text.rms_force,
        text.saturated,
    )
    return Table(
        caption=text.corners_caption.format(move=title),
        columns=tuple(Column(head=head, is_number=head != text.saturated) for head in heads),
        rows=rows,
        strong_rows=tuple(
            i for i, corner in enumerate(move.corners) if corner.settling_time is None
        ),
    )


def kept_sentence(record: Record, f: Formatter) -> str:
    """Return between which frequency errors every requirement is kept."""
    text, error = f.labels, record.robustness.frequency_error
    low, high = error.kept_from, error.kept_to
    if low is None or high is None:
        return text.kept_nowhere
    ends = zip((low, high), (error.factor[0], error.factor[-1]), strict=True)
    shown = []
    for end, tried in ends:
        value = f.signed_percent(end - 1.0)
        # Beyond the last one tried nothing is known.
        shown.append(text.at_least.format(value=value) if end == tried else value)
    return text.kept_between.format(low=shown[0], high=shown[1])


def _frequency_error(record: Record, f: Formatter) -> tuple[Block, ...]:
    """Return the curves over the frequency error; where one has no point, why it is missing."""
    text, error = f.labels, record.robustness.frequency_error
    residual, settling = (
        np.array([np.nan if value is None else value for value in values])
        for values in (error.residual_deviation, error.settling_time)
    )
    tried = {
        "low": f.signed_percent(error.factor[0] - 1.0),
        "high": f.signed_percent(error.factor[-1] - 1.0),
    }
    if not np.isfinite(residual).any():
        return (Paragraph(text=text.no_error_curves.format(**tried), tone=Tone.NOTE),)
    plot = _frequency_plot(record, residual, settling, f)
    if np.isfinite(settling).any():
        return (plot,)
    return (plot, Paragraph(text=text.no_settling_curve.format(**tried), tone=Tone.NOTE))


def _frequency_plot(record: Record, residual: Array, settling: Array, f: Formatter) -> LinePlot:
    """Return residual deviation and, where it has points, settling time over the error."""
    text, permitted = f.labels, band(record)
    x = 100.0 * (np.array(record.robustness.frequency_error.factor) - 1.0)
    length = motion_unit("m", rotary=f.rotary)
    limits = () if permitted is None else (permitted,)
    panels = [_panel(text.residual, text.recommended, x, residual, length, limits, f)]
    caption, alt = text.residual_error_caption, text.residual_error_alt
    if np.isfinite(settling).any():
        panels.append(_panel(text.settling_time, text.recommended, x, settling, "s", (), f))
        caption, alt = text.frequency_error_caption, text.frequency_error_alt
    return LinePlot(
        key="frequency-error",
        caption=caption,
        alt=alt.format(
            least=f.quantity(float(np.nanmin(residual)), length),
            most=f.quantity(float(np.nanmax(residual)), length),
            band=f.quantity(permitted, length),
        ),
        x_label=text.frequency_error,
        x_is_log=False,
        link="frequency-error",
        panels=tuple(panels),
    )


def _panel(
    name: str, label: str, x: Array, y: Array, unit: str, limits: tuple[float, ...], f: Formatter
) -> Panel:
    known = np.isfinite(y)
    scale = f.scale_for([y[known], np.array(limits)], unit)
    return Panel(
        y_label=f"{name} in {scale.unit}",
        lines=(Line(label=label, x=x[known], y=y[known] / scale.size, style=CURVE),),
        borders=tuple(
            Border(label=f.quantity(limit, unit), y=limit / scale.size) for limit in limits
        ),
    )


def _drawn(record: Record, drawn: MonteCarloEntry, f: Formatter) -> tuple[Block, ...]:
    """Return what was drawn, the distribution, and the worst machines."""
    text = f.labels
    histograms = [
        _histogram("settling_time", text.settling_time, drawn.settling_time, f),
        _histogram("residual_deviation", text.residual, drawn.residual_deviation, f),
    ]
    return (
        Paragraph(text=drawn_sentence(drawn, f)),
        _quantiles(drawn, f),
        *(plot for plot in histograms if plot is not None),
        _extremes(drawn, f),
    )


def drawn_sentence(drawn: MonteCarloEntry, f: Formatter) -> str:
    """Return how many machines were drawn and how many of them keep the requirements."""
    return f.labels.drawn.format(
        samples=f.number(drawn.samples),
        seed=drawn.seed,
        met=f.percent(drawn.share_met),
        band=f.percent(drawn.share_in_band),
    )


def _quantiles(drawn: MonteCarloEntry, f: Formatter) -> Table:
    text = f.labels
    settling, residual = drawn.settling_time, drawn.residual_deviation
    rows = []
    for slow, far in zip(settling.quantiles, residual.quantiles, strict=True):
        name = {0.0: text.least, 1.0: text.largest}.get(slow.share)
        share = name or text.share_of_machines.format(share=f.percent(slow.share))
        rows.append(
            (
                share,
                f.quantity(slow.value, settling.unit, missing=text.not_settled),
                f.quantity(far.value, residual.unit, missing=text.not_settled),
            )
        )
    return Table(
        caption=text.quantiles_caption,
        columns=(
            Column(head=text.machines, width=1.6),
            Column(head=text.settling_time, is_number=True),
            Column(head=text.residual, is_number=True),
        ),
        rows=tuple(rows),
    )


def _histogram(key: str, name: str, values: DistributionEntry, f: Formatter) -> LinePlot | None:
    """Return how many machines lie where; None where all are alike or none settles."""
    text, edges = f.labels, np.array(values.histogram.edges)
    if edges.size < 3:
        return None
    counts = np.array(values.histogram.counts, dtype=np.float64)
    scale = f.scale_for([edges], values.unit)
    x = np.concatenate([edges[:1], edges]) / scale.size
    y = np.concatenate([[0.0], counts, [0.0]])
    line = Line(label=text.machines, x=x, y=y, style=CURVE, is_stepped=True)
    fullest = int(counts.argmax())
    return LinePlot(
        key=f"histogram-{key}",
        caption=text.histogram_caption.format(name=name),
        alt=text.histogram_alt.format(
            low=f.quantity(edges[0], values.unit),
            high=f.quantity(edges[-1], values.unit),
            most=f.number(counts[fullest]),
            place=f.quantity((edges[fullest] + edges[fullest + 1]) / 2, values.unit),
        ),
        x_label=f"{name} in {scale.unit}",
        x_is_log=False,
        link=f"histogram-{key}",
        panels=(Panel(y_label=text.machines, lines=(line,)),),
    )


def _extremes(drawn: MonteCarloEntry, f: Formatter) -> Table:
    text, length = f.labels, motion_unit("m", rotary=f.rotary)
    named = ((text.worst_machine, drawn.worst), (text.slowest_machine, drawn.slowest))
    heads = (
        text.payload,
        text.frequencies,
        text.dampings,
        text.settling_time,
        text.residual,
    )
    return Table(
        caption=text.extremes_caption,
        columns=name_and_numbers(text.machine_row, heads, width=1.8),
        rows=tuple(
            (
                name,
                f.quantity(sample.payload, motion_unit("kg", rotary=f.rotary)),
                f.percent(sample.frequency_factor),
                f.percent(sample.damping_factor),
                f.settling(sample.settling_time),
                f.quantity(sample.residual_deviation, length, missing=text.not_settled),
            )
            for name, sample in named
        ),
    )


def _sensitivities(record: Record, f: Formatter) -> Table:
    text, length = f.labels, motion_unit("m", rotary=f.rotary)

    def share(change: float | None) -> str:
        return "–" if change is None else f.signed_percent(change)

    heads = (text.settling_time, text.change, text.residual, text.change)
    return Table(
        caption=text.sensitivities_caption,
        columns=(
            Column(head=text.what_changes, width=1.8),
            *(Column(head=head, is_number=True) for head in heads),
            Column(head=text.meets, width=0.8),
        ),
        rows=tuple(
            (
                text.say(item.change),
                f.settling(item.settling_time),
                share(item.settling_change),
                f.quantity(item.residual_deviation, length, missing=text.not_settled),
                share(item.residual_change),
                text.yes if item.meets_requirements else text.no,
            )
            for item in record.robustness.sensitivities
        ),
    )
