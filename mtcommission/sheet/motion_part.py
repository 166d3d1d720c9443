"""Optima, recommendation and response of each move over one time axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import motion_unit
from mtcommission.record.schema.moves import MoveEntry
from mtcommission.record.schema.optima import OptimaEntry, OptimumEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Series
from mtcommission.sheet.model import (
    Block,
    Column,
    Paragraph,
    Section,
    Subheading,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.values import say_filter, settling
from mtcommission.sheet.verdict_part import band, move_title, reference_sentence

Array = NDArray[np.float64]

SETPOINT, TIME_OPTIMAL, CONSTRAINED, DAMPING_OPTIMAL, RESPONSE = 0, 1, 2, 3, 4
"""Line styles, the same in every panel."""

MOST_POINTS = 800
"""Points of a curve; more are not seen on paper and swell the page."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """A signal over time, still in SI.

    Parameters
    ----------
    label, style
        As in ``Line``.
    series
        Where it is found.
    signal
        Its name there.
    factor
        Factor on the stored values.
    is_stepped
        Whether the value holds until the next sample.
    """

    label: str
    style: int
    series: Series
    signal: str
    factor: float = 1.0
    is_stepped: bool = False


def motions(record: Record, words: Catalogue) -> Section:
    """Return plots and tables of each move."""
    text, f = words.text, words.format
    delay = f.quantity(record.loop.reference_delay, "s")
    blocks: list[Block] = [Paragraph(text=text("motion-note", delay=delay), tone=Tone.NOTE)]
    for number, (optima, move) in enumerate(zip(record.optima, record.moves, strict=True), start=1):
        title = move_title(move.move, number, words)
        blocks.append(Subheading(text=title))
        blocks.append(Paragraph(text=reference_sentence(record, number, words)))
        short = text("move", number=number)
        blocks += [_amplitudes(move, short, words), *_segments(move, short, words)]
        blocks.extend(_plots(record, optima, move, number, short, words))
        blocks.append(_peaks(record, optima, move, short, words))
        blocks.extend(
            Paragraph(text=words.say(remark), tone=Tone.NOTE) for remark in optima.remarks
        )
    return Section(
        key="motions", heading=text("motion-heading"), blocks=tuple(blocks), is_appendix=True
    )


def response_plot(record: Record, number: int, words: Catalogue) -> LinePlot:
    """Return acceleration, deviation and force of a move with the optimum, for a page."""
    text, f, move = words.text, words.format, record.moves[number - 1]
    optima = record.optima[number - 1]
    plans = _panels(record, optima, move, words)
    t_scale = f.scale(move.series.t[-1], "s")
    rest = text("constrained" if optima.constrained else "time-optimal")
    own = {text("setpoint"), text("response"), rest}
    panels = tuple(
        _panel([c for c in curves if c.label in own], name, unit, t_scale.size, words, borders)
        for name, unit, curves, borders in (plans[1], plans[-1], plans[0])
    )
    response = move.response
    return LinePlot(
        key="responses",
        caption=text("responses-caption", move=move_title(move.move, number, words)),
        alt=text(
            "responses-alt",
            peak=f.axis(response.peak_deviation, "m"),
            settling=settling(response.settling_time, words),
            force=f.quantity(response.max_force, record.plant.units["F"]),
        ),
        x_label=text("in-unit", name=text("time"), unit=t_scale.unit),
        x_is_log=False,
        link=f"move-{number}",
        panels=panels,
    )


def named_optima(optima: OptimaEntry, words: Catalogue) -> list[tuple[str, int, OptimumEntry]]:
    """Return the optima that there are, with name and line style."""
    text = words.text
    found = (
        (text("time-optimal"), TIME_OPTIMAL, optima.time),
        (text("constrained"), CONSTRAINED, optima.constrained),
        (text("damping-optimal"), DAMPING_OPTIMAL, optima.damping),
    )
    return [(name, style, item) for name, style, item in found if item is not None]


def thin_out(x: Array, y: Array) -> tuple[Array, Array]:
    """Return a curve with fewer points but with every peak kept.

    Parameters
    ----------
    x, y
        Shape (n,).

    Returns
    -------
    ndarray, ndarray
        At most about ``MOST_POINTS`` points: of each bucket the first, least, largest and last.

    Examples
    --------
    >>> x = np.arange(10000.0)
    >>> y = np.where(x == 4321.0, 1.0, 0.0)
    >>> len(thin_out(x, y)[0]) <= MOST_POINTS, thin_out(x, y)[1].max()
    (True, np.float64(1.0))
    """
    if x.size <= MOST_POINTS:
        return x, y
    keep: set[int] = set()
    for bucket in np.array_split(np.arange(x.size), MOST_POINTS // 4):
        part = y[bucket]
        keep.update(int(bucket[i]) for i in (0, int(part.argmin()), int(part.argmax()), -1))
    chosen = np.array(sorted(keep))
    return x[chosen], y[chosen]


def _plots(
    record: Record, optima: OptimaEntry, move: MoveEntry, number: int, title: str, words: Catalogue
) -> tuple[LinePlot, LinePlot]:
    """Return two plots over the same time: what the drive does, and what the machine does."""
    text, f, response = words.text, words.format, move.response
    end = max([move.series.t[-1], *(item.t_f for *_, item in named_optima(optima, words))])
    t_scale = f.scale(end, "s")
    plans = [plan for plan in _panels(record, optima, move, words) if plan[2]]

    def plot(key: str, part: list[PanelPlan]) -> LinePlot:
        panels = tuple(
            _panel(curves, name, unit, t_scale.size, words, borders)
            for name, unit, curves, borders in part
        )
        return LinePlot(
            key=f"{key}-{number}",
            caption=text(f"{key}-caption", move=title),
            alt=text(
                "motion-alt",
                signals=", ".join(panel.y_label for panel in panels),
                force=f.quantity(response.max_force, record.plant.units["F"]),
                peak=f.quantity(response.peak_deviation, record.plant.units["tcp"]),
                settling=settling(response.settling_time, words),
            ),
            x_label=text("in-unit", name=text("time"), unit=t_scale.unit),
            x_is_log=False,
            link=f"move-{number}",
            panels=panels,
        )

    return (
        plot("drive", plans[:3]),
        plot("vibration", plans[3:]),
    )


PanelPlan = tuple[str, str, list[Curve], tuple[float, ...]]


def _panels(
    record: Record, optima: OptimaEntry, move: MoveEntry, words: Catalogue
) -> list[PanelPlan]:
    """Return name, unit, curves and limits of each panel, from top to bottom."""
    text, plant = words.text, record.plant
    units, mass = plant.units, plant.moving_mass
    speed = rigid_velocity(plant.states)
    a_unit = motion_unit("m/s^2", rotary=words.rotary)

    def curves(signal: str, *, factor: float = 1.0) -> list[Curve]:
        found = [
            Curve(
                label=name,
                style=style,
                series=item.series,
                signal=signal,
                factor=factor,
                is_stepped=signal == "F_set",
            )
            for name, style, item in named_optima(optima, words)
        ]
        found.append(
            Curve(
                label=text("response"),
                style=RESPONSE,
                series=move.series,
                signal=signal,
                factor=factor,
                is_stepped=signal == "F_set",
            )
        )
        return [curve for curve in found if curve.signal in curve.series.signals]

    def setpoint(signal: str) -> list[Curve]:
        curve = Curve(label=text("setpoint"), style=SETPOINT, series=move.series, signal=signal)
        return [curve] if signal in move.series.signals else []

    force = optima.time.f_max
    plans: list[PanelPlan] = [
        (words.name("F_set"), units["F"], curves("F_set"), (force, -force)),
        (text("acceleration"), a_unit, setpoint("a_ref") + curves("F", factor=1.0 / mass), ()),
        (text("velocity"), units[speed], setpoint("v_ref") + curves(speed), ()),
    ]
    for rate in flexible_rates(plant.states):
        bound = optima.constrained.limits.get(rate) if optima.constrained else None
        borders = () if bound is None else (bound, -bound)
        plans.append((words.name(rate), units[rate], curves(rate), borders))
    permitted = band(record)
    deviation = [
        Curve(label=text("response"), style=RESPONSE, series=move.series, signal="deviation")
    ]
    plans.append((words.name("tcp_vibration"), units["tcp"], curves("tcp_vibration"), ()))
    limits = () if permitted is None else (permitted, -permitted)
    plans.append((text("deviation"), units["tcp"], deviation, limits))
    return plans


def rigid_velocity(states: list[str]) -> str:
    """Return the state that is the rigid velocity of the axis."""
    return "v_s" if "v_s" in states and "x_s" in states else "v"


def flexible_rates(states: list[str]) -> list[str]:
    """Return the states that are rates of flexible modes."""
    speed = rigid_velocity(states)
    return [state for state in states if state.startswith("v_") and state != speed]


def _panel(
    curves: list[Curve],
    name: str,
    unit: str,
    t_size: float,
    words: Catalogue,
    limits: tuple[float, ...],
) -> Panel:
    f = words.format
    arrays = [np.array(curve.series.signals[curve.signal]) * curve.factor for curve in curves]
    scale = f.scale_for(arrays, unit)
    lines = []
    for curve, values in zip(curves, arrays, strict=True):
        x, y = thin_out(np.array(curve.series.t) / t_size, values / scale.size)
        lines.append(
            Line(label=curve.label, x=x, y=y, style=curve.style, is_stepped=curve.is_stepped)
        )
    borders = tuple(Border(label=f.quantity(limit, unit), y=limit / scale.size) for limit in limits)
    return Panel(
        y_label=words.text("in-unit", name=name, unit=scale.unit),
        lines=tuple(lines),
        borders=borders,
    )


def _peaks(
    record: Record, optima: OptimaEntry, move: MoveEntry, title: str, words: Catalogue
) -> Table:
    text, f, units = words.text, words.format, record.plant.units
    named = named_optima(optima, words)
    rows = tuple(
        (
            words.name(signal),
            *(f.quantity(item.peaks.get(signal), units[signal]) for *_, item in named),
            f.quantity(peak, units[signal]),
        )
        for signal, peak in move.response.peaks.items()
    )
    heads = [*(name for name, *_ in named), text("response")]
    return Table(
        caption=text("peaks-caption", move=title),
        columns=name_and_numbers(text("signal-head"), heads, width=1.6),
        rows=rows,
    )


def _amplitudes(move: MoveEntry, title: str, words: Catalogue) -> Table:
    text, f = words.text, words.format
    return Table(
        caption=text("amplitudes-caption", move=title),
        columns=(Column(head=text("mode")), Column(head=text("amplitude"), is_number=True)),
        rows=tuple(
            (name, f.axis(value, "m")) for name, value in move.response.mode_amplitudes.items()
        ),
    )


def _segments(move: MoveEntry, title: str, words: Catalogue) -> tuple[Block, ...]:
    text, f, setpoint = words.text, words.format, move.setpoint
    table = Table(
        caption=text("setpoint-caption", move=title),
        columns=(
            Column(head=text("segment")),
            Column(head=text("duration"), is_number=True),
            Column(head=text("jerk"), is_number=True),
        ),
        rows=tuple(
            (
                str(number),
                f.quantity(segment.duration, "s"),
                f.axis(segment.jerk, "m/s^3"),
            )
            for number, segment in enumerate(setpoint.segments, start=1)
        ),
    )
    if not setpoint.setpoint_filter:
        return (table,)
    longer = f.quantity(setpoint.setpoint_filter.duration, "s")
    said = say_filter(setpoint.setpoint_filter, words)
    note = text("setpoint-behind-filter", filter=said, time=longer)
    return (table, Paragraph(text=note, tone=Tone.NOTE))
