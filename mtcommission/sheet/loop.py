"""Page 3: how far the loop is from unstable, how stiff it is, and why it is this one.

The appendix has its gains, the loops beside it, corners and delays.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.messages.quantities import symbol
from mtcommission.record.loop import (
    LoopPart,
    Margins,
    VariantEntry,
)
from mtcommission.record.record import Record
from mtcommission.sheet.appendix import held_range
from mtcommission.sheet.document import (
    Block,
    Bullets,
    Column,
    LinePlot,
    Paragraph,
    Subheading,
    Table,
    note,
)
from mtcommission.sheet.identified import changes, short_name
from mtcommission.sheet.plots import (
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
    BANDWIDTH,
    DASH,
    GAIN_MARGIN,
    MAX_FORCE,
    PATH_GAINS,
    PHASE_MARGIN,
    RESIDUAL,
    SENSITIVITY,
    SETTLING,
    STIFFNESS,
    Quantity,
    beside,
    member,
    place_columns,
    show,
    table,
)
from mtcommission.sheet.verdict import permitted_margin

Array = NDArray[np.float64]

HIGHEST_DB = 40.0
"""Magnitude of the open loop from which on it is drawn."""

CUT_DB = 20.0 * np.log10(np.sqrt(0.5))
"""Of the closed velocity loop at its bandwidth."""


def third_page(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the frequency response with margins, filters and measured points, and stiffness.

    An open-loop axis has none: what counts is how far the frequency may be off.
    """
    text, loop = words.text, record.loop
    if loop.worst_corner is None:  # the remarks say so
        yield _said(loop.remarks, words)
    else:
        yield from map(note, _sensors(record, words))
        yield bode(record, words)
        yield _margins(record, loop.worst_corner, words)
        yield _disturbance(record, words)
    if loop.reasons:
        yield Paragraph(text=text("loop-why"))
        yield _said(loop.reasons, words)
    if loop.worst_corner is None:
        yield from held_range(record, words)


def loop_details(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield gains, the loops beside it, corners, delays, and by which rules."""
    text, loop = words.text, record.loop
    if loop.worst_corner is not None:
        values = (
            *PATH_GAINS,
            Quantity("reference-delay", "reference_delay", "s"),
            Quantity("rule-symbol-m-ff", "feedforward.mass", "kg", width=1.6),
        )
        yield table(words, "loop-in-use", values, [loop])
        yield from _variants(record, words)
        yield from _corners(record, words)
        yield _delays(record, words)
    if loop.remarks:
        yield Subheading(text=text("remarks"))
        yield _said(loop.remarks, words)


def _said(lines: Sequence[Message | str], words: Catalogue) -> Bullets:
    return Bullets(items=tuple(map(words.say, lines)))


def _sensors(record: Record, words: Catalogue) -> Iterator[str]:
    """What the loop uses beside the encoder that every loop has."""
    text, part = words.text, record.loop
    if len(part.sensors) > 1:
        sensors = (words.known(f"sensor-{name}", name) for name in part.sensors)
        yield text("sensors", names=", ".join(sensors))
    if part.observer.states:
        yield text("observed", names=", ".join(map(symbol, part.observer.states)))


def bode(record: Record, words: Catalogue) -> LinePlot:
    """Return the frequency response with its margins, filters, and what was measured of it."""
    text, part = words.text, record.loop
    frequency = np.array(part.bode.t)
    signals = {name: np.array(values) for name, values in part.bode.signals.items()}
    # Whole turns are added so that the phase begins between -360 and 0 degrees.
    turns = 360.0 * np.ceil(signals["open_loop_deg"][0] / 360.0)
    size, phase = signals["open_loop_db"], signals["open_loop_deg"] - turns
    # Far below the crossover a loop only rises; there it would take the room of the margins.
    first = max(int(np.argmax(size < HIGHEST_DB)) - 1, 0)
    frequency, size, phase = frequency[first:], size[first:], phase[first:]
    closed, ends = signals["closed_velocity_db"][first:], [float(size.min()), float(size.max())]
    measured = _measured(record, frequency, size, phase, words)
    gain_at = text("gain-margin-at", margin=GAIN_MARGIN.show(part, words))
    phase_at = text("phase-margin-at", margin=PHASE_MARGIN.show(part, words))
    corners = [item.natural_frequency / (2.0 * pi) for item in part.force_filters]
    magnitudes = [
        Curve(text("open-loop"), frequency, size),
        Curve(text("closed-velocity"), frequency, closed, OTHER),
        *(gain for gain, _ in measured),
        *_leg(part.gain_margin_hz, frequency, size, gain_at),
        *(
            Curve(text("filter-at", frequency=show(at, words, "Hz")), [at, at], ends, SETPOINT)
            for at in corners
        ),
    ]
    phases = [
        Curve(text("open-loop"), frequency, phase),
        *(angle for _, angle in measured),
        *_leg(part.phase_margin_hz, frequency, phase, phase_at, is_phase=True),
    ]
    return line_plot(
        words,
        "bode",
        [
            Signals(text("magnitude"), "", magnitudes, [0.0], "0 dB"),
            Signals(text("phase"), "", phases, [-180.0], "−180°"),
        ],
        x=(text("in-unit", name=text("frequency"), unit="Hz"), ""),
        is_log=True,
    )


def _leg(
    at: float | None, frequency: Array, curve: Array, label: str, *, is_phase: bool = False
) -> list[Curve]:
    """A margin as a line from the curve to 0 dB, or to the nearest turn of -180 degrees."""
    if at is None:
        return []
    y = float(np.interp(np.log(at), np.log(frequency), curve))
    axis = 360.0 * round((y + 180.0) / 360.0) - 180.0 if is_phase else 0.0
    return [Curve(label, [at, at], [axis, y], MARGIN)]


def _measured(
    record: Record, frequency: Array, size: Array, phase: Array, words: Catalogue
) -> list[tuple[Curve, Curve]]:
    """Magnitude and phase of the open loop with each measured response in it.

    It is the loop of the model times measured over fitted: all that lies between axis and loop is
    the same in both. Only responses of the loop's own encoder, and only where the profile still is
    what was fitted.
    """
    part = record.identified
    if part is None or changes(part, record, words):
        return []
    sensors = {short_name(one.name): one.sensor for one in part.sources}
    found = []
    for one in part.responses:
        if one.phase_deg is None or one.curve_phase_deg is None or not one.unit:
            continue
        if sensors.get(short_name(one.name)) != "encoder":
            continue
        low, high = max(frequency[0], one.curve_hz[0]), min(frequency[-1], one.curve_hz[-1])
        f = np.array(one.frequency_hz)
        inside = (f >= low) & (f <= high)
        f = f[inside]
        at, curve_at, base_at = np.log(f), np.log(one.curve_hz), np.log(frequency)
        gain = 20.0 * np.log10(one.magnitude)[inside]
        gain -= np.interp(at, curve_at, 20.0 * np.log10(one.curve_magnitude))
        angle = np.array(one.phase_deg)[inside] - np.interp(at, curve_at, one.curve_phase_deg)
        angle -= 360.0 * np.round(angle / 360.0)
        label = words.text("open-loop-measured", file=short_name(one.name))
        magnitudes = Curve(label, f, np.interp(at, base_at, size) + gain, THIRD)
        found.append((magnitudes, Curve(label, f, np.interp(at, base_at, phase) + angle, THIRD)))
    return found


def _margins(record: Record, worst: Margins, words: Catalogue) -> Table:
    part = record.loop

    def nominal(name: str, key: str) -> Quantity:
        def value(item: object) -> float | str | None:
            return getattr(item, key) if item is part else DASH

        return Quantity(name, value, "dB", "unlimited")

    def damping(mode: str) -> Callable[[object], float | None]:
        worst = part.worst_mode_damping
        return lambda item: (part.mode_damping if item is part else worst).get(mode)

    rows = (
        GAIN_MARGIN,
        nominal("gain-margin-up", "gain_margin_up_db"),
        nominal("gain-margin-down", "gain_margin_down_db"),
        PHASE_MARGIN,
        SENSITIVITY,
        replace(BANDWIDTH, value=lambda item: _bandwidth(item, part, words)),
        _stiffness(words),
        *(
            Quantity(Message("damping-of", mode=mode), damping(mode), "%")
            for mode in part.mode_damping
        ),
    )
    heads = (words.text("nominal"), words.text("worst-corner"))
    found = beside(words, "margins-caption", rows, heads, (part, worst), first="margin", width=1.6)
    asked = (permitted_margin(row, record, words) for row in rows)
    return replace(
        found,
        columns=(*found.columns, Column(head=words.text("permitted"), is_number=True)),
        rows=tuple((*row, one) for row, one in zip(found.rows, asked, strict=True)),
    )


def _bandwidth(item: Margins | LoopPart, part: LoopPart, words: Catalogue) -> object:
    """The bandwidth, and to where the loop follows again behind an antiresonance, nominally."""
    first, closed = item.bandwidth_hz, np.array(part.bode.signals["closed_velocity_db"])
    falls = np.flatnonzero((closed[:-1] >= CUT_DB) & (closed[1:] < CUT_DB))
    if item is not part or first is None or falls.size < 2:
        return first
    shown, last = (show(at, words, "Hz") for at in (first, part.bode.t[falls[-1]]))
    return words.text("bandwidth-again", bandwidth=shown, last=last)


def _stiffness(words: Catalogue) -> Quantity:
    """The dynamic stiffness, and at which frequency where that is known."""

    def shown(item: Margins | LoopPart) -> str:
        stiffness = STIFFNESS.show(item, words)
        if not isinstance(item, LoopPart | VariantEntry):
            return stiffness
        at = show(item.weakest_frequency_hz, words, "Hz")
        return words.text("stiffness-at", stiffness=stiffness, frequency=at)

    return Quantity("dynamic-stiffness", shown, "")


def _disturbance(record: Record, words: Catalogue) -> LinePlot:
    """How the tool gives way to a step of force, for each loop that was compared."""
    text, series = words.text, record.loop.disturbance
    used = {item.name.kind for item in record.loop.variants if item.used}
    unit = "rad/(N m)" if words.rotary else "m/N"
    curves = [
        Curve(text(name), series.t, y, MAIN if name in used or len(series.signals) == 1 else OTHER)
        for name, y in series.signals.items()
    ]
    return line_plot(
        words,
        "disturbance",
        [Signals(name=text("deflection"), unit=unit, curves=curves)],
        x=(text("time"), "s"),
    )


def _variants(record: Record, words: Catalogue) -> Iterator[Table]:
    variants = record.loop.variants
    if len(variants) < 2:
        return
    rows = (
        *(GAIN_MARGIN, PHASE_MARGIN, SENSITIVITY, BANDWIDTH, _stiffness(words)),
        *(
            Quantity(Message("damping-of", mode=mode.name), member(mode.name, "mode_damping"), "%")
            for mode in record.plant.modes
        ),
        *(SETTLING, RESIDUAL, MAX_FORCE),
    )
    heads = [words.say(item.name) for item in variants]
    heads = [
        words.text("variant-used", name=name) if item.used else name
        for name, item in zip(heads, variants, strict=True)
    ]
    yield beside(words, "variants-caption", rows, heads, variants)


def _corners(record: Record, words: Catalogue) -> Iterator[Table]:
    corners = record.loop.corners
    bandwidth = replace(BANDWIDTH, name="bandwidth-short")
    columns = (
        *place_columns(corners),
        GAIN_MARGIN,
        PHASE_MARGIN,
        SENSITIVITY,
        bandwidth,
        STIFFNESS,
    )
    if len(corners) > 1:
        yield table(words, "loop-corners-caption", columns, corners)


def _delays(record: Record, words: Catalogue) -> Table:
    def known(key: str) -> Callable[[object], float | None]:
        return lambda path: getattr(path, key) or None

    keys = ("setpoint_age", "dead_time", "hold", "lag", "total")
    times = (Quantity(key.replace("_", "-"), known(key), "s") for key in keys)
    path = Quantity("path", "path", width=1.6)
    return table(words, "delays-caption", (path, *times), record.loop.delays)
