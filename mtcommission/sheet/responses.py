"""Page 2: what the limits do to the moves, optima as yardsticks, sizes, other limits, what helps.

The appendix has every move with all its signals, and the limits on smaller and larger moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements import RESIDUAL_DEVIATION
from mtcommission.machine.moves import size_unit
from mtcommission.record.limits import MoveSizesEntry
from mtcommission.record.moves import MoveEntry, Series
from mtcommission.record.optima import OptimaEntry, OptimumEntry
from mtcommission.record.record import Record
from mtcommission.record.shape import Words
from mtcommission.sheet.document import Block, LinePlot, Paragraph, Subheading, Table, note
from mtcommission.sheet.limits import jerk_column, other_limits
from mtcommission.sheet.plots import (
    FOURTH,
    MAIN,
    MARGIN,
    OTHER,
    SETPOINT,
    THIRD,
    Curve,
    Signals,
    line_plot,
)
from mtcommission.sheet.tables import (
    ACCELERATION,
    SETTLING,
    Quantity,
    beside,
    member,
    show,
    table,
)
from mtcommission.sheet.verdict import (
    find_band,
    move_title,
    reference_sentence,
    slowest_move,
    worst_sizes,
)
from mtcommission.study.improvements import Improvement

MOST_CHANGES = 5
"""Changes that are listed; those that bring less are named."""

NO_BAND = ("band-saves-nothing", "band-wider-than-move", "band-optimum-failed")
"""Remarks on why there is no optimum with the band in place of exact rest."""

SHORT = 0.5
"""Where the mark of the worst size begins, over its value."""

WAYS: dict[Words, int] = {
    Message("way-recommended"): MAIN,
    Message("commissioning-rule"): OTHER,
    Message("way-listed"): THIRD,
}
"""Line style of the ways of choosing limits."""


def second_page(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the slowest move, all moves beside their optima, sizes, other limits, what helps."""
    number = slowest_move(record)
    yield _yardsticks(record, words)
    yield from _missing_yardsticks(record, words)
    yield _response_plot(record, number, words)
    yield from _size_plot(record, number, words)
    yield from other_limits(record, words)
    yield from _improvements(record, words)


def _yardsticks(record: Record, words: Catalogue) -> Table:
    """Each move in the loop, worst corner apart, beside the least times of the drive."""
    f = words.format

    def beside_least(move: MoveEntry, t_f: float | None) -> str | None:
        if t_f is None or move.response.settling_time is None:
            return None if t_f is None else f.quantity(t_f, "s")
        more = f.signed_percent(move.response.settling_time / t_f - 1.0)
        return f"{f.quantity(t_f, 's')} ({more})"

    def least(name: str, key: str) -> Quantity:
        return Quantity(
            name, lambda it: beside_least(it[1], getattr(getattr(it[2], key), "t_f", None)), "s"
        )

    def rest(item: tuple[int, MoveEntry, OptimaEntry]) -> str | None:
        return beside_least(item[1], (item[2].constrained or item[2].time).t_f)

    columns = (
        Quantity("move-head", lambda it: move_title(it[1].move, it[0], words), width=2.3),
        Quantity("settling-time", lambda it: it[1].response.settling_time, "s", "not-settled"),
        Quantity("exact-rest", rest, "s"),
        least("within-band", "band"),
        least("robust-short", "robust"),
        Quantity("peak-deviation", lambda it: it[1].response.peak_deviation, "m"),
        Quantity("max-force", lambda it: it[1].response.max_force, "N"),
    )
    numbers = range(1, len(record.moves) + 1)
    items = zip(numbers, record.moves, record.optima, strict=True)
    return table(words, "yardstick-caption", columns, items)


def _missing_yardsticks(record: Record, words: Catalogue) -> Iterator[Block]:
    """Why a least time within the band is a dash; nothing where none is."""
    reasons = [
        f"{words.text('move', number=number)}: {words.say(remark)}"
        for number, optima in enumerate(record.optima, start=1)
        for remark in optima.remarks
        if optima.band is None and isinstance(remark, Message) and remark.kind in NO_BAND
    ]
    if reasons:
        yield note(" ".join(reasons))


def _improvements(record: Record, words: Catalogue) -> Iterator[Block]:
    text, found = words.text, record.limits.would_bring
    if not found:
        return
    gains = [item for item in found if not item.outcome][:MOST_CHANGES]
    rest = [words.say(item.change) for item in found if item not in gains]

    def share(item: Improvement) -> str | None:
        return None if item.share is None else words.format.signed_percent(-item.share)

    columns = (
        Quantity("change", "change", width=2.6),
        SETTLING,
        Quantity("improvement-saved", "saved", "s"),
        Quantity("improvement-share", share, "%"),
        Quantity("meets", "meets_requirements"),
    )
    listed, loop = "yes" if gains else "no", "none" if record.machine.follows else "tuned"
    said = [text("improvements-none", changes=", ".join(rest), listed=listed)] if rest else []
    if gains:
        yield table(words, "improvements-caption", columns, gains)
        said.insert(0, text("improvements-note", loop=loop))
    yield note(" ".join(said))


def motions(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield plots and tables of each move."""
    text = words.text
    yield note(text("motion-note", delay=show(record.loop.reference_delay, words, "s")))
    for number, (optima, move) in enumerate(zip(record.optima, record.moves, strict=True), start=1):
        short = text("move", number=number)
        yield Subheading(text=move_title(move.move, number, words))
        yield Paragraph(text=reference_sentence(record, number, words))
        yield from _motion_plots(record, number, short, words)
        yield _peaks(record, optima, move, short, words)
        yield from (note(words.say(remark)) for remark in optima.remarks)


def named_optima(optima: OptimaEntry, words: Catalogue) -> list[tuple[str, int, OptimumEntry]]:
    """Return the optima that there are, with name and line style."""
    found = (
        (words.text("control-time-optimal"), OTHER, optima.time),
        (words.text("constrained"), THIRD, optima.constrained),
        (words.text("control-damping-optimal"), FOURTH, optima.damping),
    )
    return [(name, style, item) for name, style, item in found if item is not None]


def _peaks(
    record: Record, optima: OptimaEntry, move: MoveEntry, title: str, words: Catalogue
) -> Table:
    units, named = record.plant.units, named_optima(optima, words)
    signals = move.response.peaks
    rows = (Quantity(words.name(one), member(one), units[one]) for one in signals)
    heads = [*(name for name, *_ in named), words.text("response")]
    items = [*(item.peaks for *_, item in named), signals]
    return beside(words, "peaks-caption", rows, heads, items, first="signal-head", move=title)


def _signals(record: Record, number: int, words: Catalogue) -> list[Signals]:
    """What drive and machine do in a move and its optima, from top to bottom."""
    text, units, mass = words.text, record.plant.units, record.plant.moving_mass
    move, optima = record.moves[number - 1], record.optima[number - 1]
    own = [(text("response"), MAIN, move.series)]
    every = [(name, style, item.series) for name, style, item in named_optima(optima, words)] + own
    setpoint = [(text("setpoint"), SETPOINT, move.series)]

    def curves(
        named: Iterable[tuple[str, int, Series]], signal: str, factor: float = 1.0
    ) -> list[Curve]:
        return [
            Curve(
                name,
                series.t,
                factor * np.array(series.signals[signal]),
                style,
                stepped=signal == "F_set",
            )
            for name, style, series in named
            if signal in series.signals
        ]

    def both(bound: float | None) -> tuple[float, ...]:
        return () if bound is None else (bound, -bound)

    def one(name: str, unit: str, shown: list[Curve], bound: float | None = None) -> Signals:
        return Signals(name=name, unit=unit, curves=shown, limits=both(bound))

    forces = curves(every, "F_set")
    states = record.plant.states
    speed = "v_s" if {"v_s", "x_s"} <= set(states) else "v"
    rates = [state for state in states if state.startswith("v_") and state != speed]
    accelerations = [*curves(setpoint, "a_ref"), *curves(every, "F", 1.0 / mass)]
    velocities = [*curves(setpoint, "v_ref"), *curves(every, speed)]
    bounds = optima.constrained.limits if optima.constrained else {}
    tool, tcp = curves(every, "tcp_vibration"), units["tcp"]
    found = [
        one(words.name("F_set"), units["F"], forces, optima.time.f_max),
        one(text("acceleration"), "m/s^2", accelerations),
        one(text("velocity"), units[speed], velocities),
        *(
            one(words.name(rate), units[rate], curves(every, rate), bounds.get(rate))
            for rate in rates
        ),
        one(words.name("tcp_vibration"), tcp, tool),
        one(text("deviation"), tcp, curves(own, "deviation"), find_band(record)),
    ]
    return [panel for panel in found if panel.curves]


def _motion_plots(
    record: Record, number: int, title: str, words: Catalogue
) -> tuple[LinePlot, LinePlot]:
    """Two plots over the same time: what the drive does, and what the machine does."""
    panels = _signals(record, number, words)

    def plot(key: str, part: list[Signals]) -> LinePlot:
        return line_plot(
            words,
            f"{key}-{number}",
            part,
            x=(words.text("time"), "s"),
            text=key,
            link=f"move-{number}",
            move=title,
        )

    return plot("drive", panels[:3]), plot("vibration", panels[3:])


def _response_plot(record: Record, number: int, words: Catalogue) -> LinePlot:
    text, move, optima = words.text, record.moves[number - 1], record.optima[number - 1]
    force, acceleration, *_, deviation = _signals(record, number, words)
    rest = text("constrained" if optima.constrained else "control-time-optimal")
    own = {text("setpoint"), text("response"), rest}

    def only(panel: Signals) -> Signals:
        return replace(panel, curves=[one for one in panel.curves if one.label in own])

    return line_plot(
        words,
        "responses",
        map(only, (acceleration, deviation, force)),
        x=(text("time"), "s"),
        link=f"move-{number}",
        move=move_title(move.move, number, words),
    )


def move_sizes(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield from which size on limits hold, move by move; nothing where nothing was tried."""
    for number, move in enumerate(record.moves, start=1):
        if ways := _ways(record, number):
            yield Subheading(text=move_title(move.move, number, words))
            yield _sizes(record, ways, words.text("move", number=number), words)
            if number != slowest_move(record):  # that one stands on page 2
                yield from _size_plot(record, number, words)


def _ways(record: Record, number: int) -> list[MoveSizesEntry]:
    move = record.moves[number - 1].move
    return [entry for entry in record.limits.move_sizes if entry.move == move]


def _sizes(record: Record, ways: list[MoveSizesEntry], title: str, words: Catalogue) -> Table:
    def unit(entry: MoveSizesEntry) -> str:
        return size_unit(entry.move)

    def end(entry: MoveSizesEntry, value: float | None, last: float, open_end: str) -> str:
        """An end of the range in which the band is kept; the last one tried is open."""
        shown = show(value, words, unit(entry), "nowhere")
        return words.text(open_end, value=shown) if value == last else shown

    columns = (
        Quantity("limits-name", "way", width=1.4),
        ACCELERATION,
        jerk_column(record.loop.shortest_ramp, words, width=1.0),
        Quantity("filter-time", lambda it: it.setpoint_filter and it.setpoint_filter.duration, "s"),
        Quantity("full-from", "full_from", unit, "never"),
        Quantity("kept-from", lambda it: end(it, it.kept_from, it.size[0], "or-less"), ""),
        Quantity("kept-to", lambda it: end(it, it.kept_to, it.size[-1], "or-more"), ""),
    )
    return table(words, "sizes-caption", columns, ways, move=title)


def _size_plot(record: Record, number: int, words: Catalogue) -> Iterator[LinePlot]:
    text, ways, permitted = words.text, _ways(record, number), find_band(record)
    if not ways:
        return
    unit = size_unit(ways[0].move)
    curves = [
        Curve(words.say(one.way), one.size, one.residual_deviation, WAYS.get(one.way, SETPOINT))
        for one in ways
    ]
    curves += [
        Curve(said, [worst.size] * 2, [SHORT * worst.value, worst.value], MARGIN)
        for worst, said in worst_sizes(record, words)
        if (worst.requirement, worst.move) == (RESIDUAL_DEVIATION.key, number)
    ]
    limits = () if permitted is None else (permitted,)
    residual = Signals(name=text("residual"), unit="m", curves=curves, limits=limits)
    yield line_plot(
        words,
        f"sizes-{number}",
        [residual],
        x=(words.name("velocity_step" if unit == "m/s" else "distance"), unit),
        text="sizes-plot",
        is_log=True,
        move=text("move", number=number),
    )
