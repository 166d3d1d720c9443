"""The frequency response with its margins and filters, and what was measured of it."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.record import Record
from mtcommission.sheet.identified_part import changes
from mtcommission.sheet.measured_blocks import short_name
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.values import decibel, degree

Array = NDArray[np.float64]

OPEN, CLOSED, MEASURED, MARGIN, FILTER = 4, 1, 2, 3, 0
"""Line styles: the open loop is the main curve."""

HIGHEST_DB = 40.0
"""Magnitude of the open loop from which on it is drawn."""

SEEN_DB, SEEN_DEG = 0.5, 2.0
"""How near a crossing of the plotted curve must be to a margin of the record to carry it."""

JUMP = 0.5
"""Share of all that a curve spans by which it changes from point to point only where it wraps."""


def bode(record: Record, words: Catalogue) -> LinePlot:
    """Return the frequency response with its margins, filters, and what was measured of it."""
    text, f, part = words.text, words.format, record.loop
    frequency = np.array(part.bode.t)
    signals = {name: np.array(values) for name, values in part.bode.signals.items()}
    # Whole turns are added so that the phase begins between -360 and 0 degrees.
    turns = 360.0 * np.ceil(signals["open_loop_deg"][0] / 360.0)
    size, phase = signals["open_loop_db"], signals["open_loop_deg"] - turns
    # Far below the crossover a loop only rises; there it would take the room of the margins.
    first = max(int(np.argmax(size < HIGHEST_DB)) - 1, 0)
    frequency, size, phase = frequency[first:], size[first:], phase[first:]
    closed = signals["closed_velocity_db"][first:]

    def line(label: str, y: Array, style: int) -> Line:
        return Line(label=label, x=frequency, y=y, style=style)

    gain_line, phase_line = _margin_lines(record, frequency, size, phase, words)
    measured = _measured(record, frequency, size, phase, words)
    corners = [item.natural_frequency / (2.0 * pi) for item in part.force_filters]
    filters = tuple(
        Line(
            label=text("filter-at", frequency=f.quantity(corner, "Hz")),
            x=np.full(2, corner),
            y=np.array([float(size.min()), float(size.max())]),
            style=FILTER,
        )
        for corner in corners
    )
    return LinePlot(
        key="bode",
        caption=text("bode-caption"),
        alt=text(
            "bode-alt",
            gain=decibel(part.gain_margin_db, words),
            phase=degree(part.phase_margin_deg, words),
            bandwidth=f.quantity(part.bandwidth_hz, "Hz"),
        ),
        x_label=text("in-unit", name=text("frequency"), unit="Hz"),
        x_is_log=True,
        link="bode",
        panels=(
            Panel(
                y_label=text("magnitude"),
                lines=(
                    line(text("open-loop"), size, OPEN),
                    line(text("closed-velocity"), closed, CLOSED),
                    *(one for one, _ in measured),
                    *gain_line,
                    *filters,
                ),
                borders=(Border(label="0 dB", y=0.0),),
            ),
            Panel(
                y_label=text("phase"),
                lines=(
                    line(text("open-loop"), phase, OPEN),
                    *(two for _, two in measured),
                    *phase_line,
                ),
                borders=(Border(label="−180°", y=-180.0),),
            ),
        ),
    )


def _margin_lines(
    record: Record, frequency: Array, size: Array, phase: Array, words: Catalogue
) -> tuple[tuple[Line, ...], tuple[Line, ...]]:
    """Return the margins as lines at the frequencies at which the curves have them.

    Of all crossings the one that has the margin of the record; none where the curve does not.
    """
    text, part = words.text, record.loop
    gain: tuple[Line, ...] = ()
    turned = (phase + 180.0) / 360.0
    found = _crossings(frequency, turned - np.round(turned), size)
    if part.gain_margin_db is not None and found:
        margin = part.gain_margin_db
        x, y = min(found, key=lambda at: abs(abs(at[1]) - margin))
        if abs(abs(y) - margin) < SEEN_DB:
            label = text("gain-margin-at", margin=decibel(margin, words))
            gain = (Line(label=label, x=np.full(2, x), y=np.array([y, 0.0]), style=MARGIN),)
    angle: tuple[Line, ...] = ()
    found = _crossings(frequency, size, phase)
    if part.phase_margin_deg is not None and found:
        wanted = part.phase_margin_deg
        legs = [(x, y, 360.0 * round((y + 180.0) / 360.0) - 180.0) for x, y in found]
        x, y, axis = min(legs, key=lambda leg: abs(abs(leg[1] - leg[2]) - wanted))
        if abs(abs(y - axis) - wanted) < SEEN_DEG:
            label = text("phase-margin-at", margin=degree(wanted, words))
            angle = (Line(label=label, x=np.full(2, x), y=np.array([axis, y]), style=MARGIN),)
    return gain, angle


def _crossings(x: Array, y: Array, other: Array) -> list[tuple[float, float]]:
    """Return where y goes through 0, and what another curve is there; a jump is no crossing."""
    step = np.abs(np.diff(y))
    span = max(float(np.ptp(y)), 1e-12)
    k = np.flatnonzero((y[:-1] * y[1:] <= 0.0) & (step > 0.0) & (step < JUMP * span))
    share = y[k] / (y[k] - y[k + 1])
    places = x[k] * (x[k + 1] / x[k]) ** share
    values = other[k] + share * (other[k + 1] - other[k])
    return list(zip(places.tolist(), values.tolist(), strict=True))


def _measured(
    record: Record, frequency: Array, size: Array, phase: Array, words: Catalogue
) -> list[tuple[Line, Line]]:
    """Return magnitude and phase of the open loop with each measured response in it.

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
        places = np.log(f), np.log(one.curve_hz), np.log(frequency)
        label = words.text("open-loop-measured", file=short_name(one.name))
        pair = []
        for values, curve, base in (
            (20.0 * np.log10(one.magnitude), 20.0 * np.log10(one.curve_magnitude), size),
            (np.array(one.phase_deg), np.array(one.curve_phase_deg), phase),
        ):
            over = values[inside] - np.interp(places[0], places[1], curve)
            if base is phase:
                over -= 360.0 * np.round(over / 360.0)
            y = np.interp(places[0], places[2], base) + over
            pair.append(Line(label=label, x=f, y=y, style=MEASURED))
        found.append((pair[0], pair[1]))
    return found
