"""The control loop: frequency response with its margins, stiffness, the loops that were tried."""

from __future__ import annotations

from math import inf, isfinite, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import symbol
from mtcommission.record.schema import CandidateEntry, LoopPart, Record, VariantEntry
from mtcommission.sheet.control_part import control_has
from mtcommission.sheet.diagram_part import structure
from mtcommission.sheet.identified_part import changes, short_name
from mtcommission.sheet.loop_study_part import disturbance, loop_study
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Column,
    Paragraph,
    Section,
    Subheading,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.values import decibel, degree, settling

Array = NDArray[np.float64]

OPEN, CLOSED, MEASURED, MARGIN, FILTER = 4, 1, 2, 3, 0
"""Line styles: the open loop is the main curve."""

HIGHEST_DB = 40.0
"""Magnitude of the open loop from which on it is drawn."""

SEEN_DB, SEEN_DEG = 0.5, 2.0
"""How near a crossing of the plotted curve must be to a margin of the record to carry it."""

JUMP = 0.5
"""Share of all that a curve spans by which it changes from point to point only where it wraps."""


def loop_blocks(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return how far the loop is from unstable, how stiff it is, and why it is this one."""
    text = words.text
    reasons = tuple(map(words.say, record.loop.reasons))
    why: tuple[Block, ...] = ()
    if reasons:
        why = (Paragraph(text=text("loop-why")), Bullets(items=reasons))
    return (
        Paragraph(text=_sensors(record, words), tone=Tone.NOTE),
        bode(record, words),
        margins(record, words),
        disturbance(record, words),
        *why,
    )


def loop_details(record: Record, words: Catalogue) -> Section:
    """Return structure, loops that were tried, corners, delays, and what the control has."""
    text, part = words.text, record.loop
    remarks: tuple[Block, ...] = ()
    if part.remarks:
        remarks = (
            Subheading(text=text("remarks")),
            Bullets(items=tuple(map(words.say, part.remarks))),
        )
    return Section(
        key="loop-details",
        heading=text("loop-details-heading"),
        blocks=(
            structure(record, words),
            *_trade_off(record, words),
            *_variants(record, words),
            *loop_study(record, words),
            *remarks,
            *control_has(record, words),
        ),
        is_appendix=True,
    )


def _sensors(record: Record, words: Catalogue) -> str:
    """Return what the loop measures, observes and feeds back."""
    text, part = words.text, record.loop
    sensors = (words.known(f"sensor-{name}", name) for name in part.sensors)
    sentences = [text("sensors", names=", ".join(sensors))]
    if part.observer.states:
        sentences.append(text("observed", names=", ".join(map(symbol, part.observer.states))))
    if not part.state_feedback:
        sentences.append(text("no-state-feedback"))
    return " ".join(sentences)


def margins(record: Record, words: Catalogue) -> Table:
    """Return margins, bandwidth, stiffness and damping, nominal and in the worst corner."""
    text, f, part = words.text, words.format, record.loop
    worst = part.worst_corner
    peak = worst.sensitivity_peak
    rows = (
        (
            text("gain-margin"),
            decibel(part.gain_margin_db, words),
            decibel(worst.gain_margin_db, words),
        ),
        (text("gain-margin-up"), decibel(part.gain_margin_up_db, words), "–"),
        (text("gain-margin-down"), decibel(part.gain_margin_down_db, words), "–"),
        (
            text("phase-margin"),
            degree(part.phase_margin_deg, words),
            degree(worst.phase_margin_deg, words),
        ),
        (
            text("sensitivity-peak"),
            f.number(part.sensitivity_peak, digits=3),
            f.number(peak, digits=3) if isfinite(peak) else "–",
        ),
        (
            text("bandwidth"),
            f.quantity(part.bandwidth_hz, "Hz"),
            f.quantity(worst.bandwidth_hz, "Hz"),
        ),
        (
            text("dynamic-stiffness"),
            _stiffness(part, words),
            f.axis(worst.dynamic_stiffness, "N/m"),
        ),
        *(
            (
                text("damping-of", mode=mode),
                f.percent(damping),
                f.percent_if_known(part.worst_mode_damping.get(mode)),
            )
            for mode, damping in part.mode_damping.items()
        ),
    )
    return Table(
        caption=text("margins-caption"),
        columns=(
            Column(head=text("margin"), width=2.0),
            Column(head=text("nominal"), is_number=True),
            Column(head=text("worst-corner"), is_number=True),
        ),
        rows=rows,
    )


def _trade_off(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return the loops that no other one beats in both stiffness and settling."""
    text, f, tried = words.text, words.format, record.loop.candidates
    shown = [item for item in tried if item.used or item.classic or not _is_beaten(item, tried)]
    if len(shown) < 2:
        return ()
    heads = (
        "settling-time",
        "stiffness-short",
        "gain-margin",
        "phase-margin",
        "sensitivity-peak",
    )
    table = Table(
        caption=text("trade-off-caption", shown=len(shown), tried=len(tried)),
        columns=(
            Column(head=text("loop"), width=1.5),
            *(Column(head=name, width=1.2, is_number=True) for name in ("Kv", "Kp", "Tn")),
            *(Column(head=text(head), is_number=True) for head in heads),
        ),
        rows=tuple(
            (
                _candidate_name(item, words),
                f.quantity(item.Kv, "1/s"),
                f.axis(item.Kp, "N s/m"),
                f.quantity(item.Tn, "s"),
                settling(item.settling_time, words),
                f.axis(item.dynamic_stiffness, "N/m"),
                decibel(item.gain_margin_db, words),
                degree(item.phase_margin_deg, words),
                f.number(item.sensitivity_peak, digits=3),
            )
            for item in shown
        ),
        strong_rows=tuple(k for k, item in enumerate(shown) if item.used),
    )
    return (table,)


def _is_beaten(item: CandidateEntry, others: list[CandidateEntry]) -> bool:
    """Whether another loop settles no later and is stiffer, or the other way round."""
    time, stiffness = item.settling_time or inf, item.dynamic_stiffness
    return any(
        (other.settling_time or inf) <= time
        and other.dynamic_stiffness >= stiffness
        and ((other.settling_time or inf), -other.dynamic_stiffness) != (time, -stiffness)
        for other in others
    )


def _candidate_name(item: CandidateEntry, words: Catalogue) -> str:
    text = words.text
    kind = text("with-state-feedback" if item.state_feedback else "cascade")
    name = text("classic-loop", name=kind) if item.classic else kind
    return text("variant-used", name=name) if item.used else name


def _variants(record: Record, words: Catalogue) -> tuple[Table, ...]:
    """Return the loops that were compared side by side; nothing if there was no choice."""
    text, f, variants = words.text, words.format, record.loop.variants
    if len(variants) < 2:
        return ()
    force = record.plant.units["F"]
    rows = [
        (text("gain-margin"), *(decibel(item.gain_margin_db, words) for item in variants)),
        (text("phase-margin"), *(degree(item.phase_margin_deg, words) for item in variants)),
        (text("sensitivity-peak"), *(f.number(i.sensitivity_peak, digits=3) for i in variants)),
        (text("bandwidth"), *(f.quantity(item.bandwidth_hz, "Hz") for item in variants)),
        (text("dynamic-stiffness"), *(_stiffness(item, words) for item in variants)),
    ]
    for mode in record.plant.modes:
        name = mode.name
        dampings = (f.percent(item.mode_damping[name]) for item in variants)
        rows.append((text("damping-of", mode=name), *dampings))
    rows += [
        (text("settling-time"), *(settling(item.settling_time, words) for item in variants)),
        (text("residual"), *(f.axis(item.residual_deviation, "m") for item in variants)),
        (text("max-force"), *(f.quantity(item.max_force, force) for item in variants)),
    ]
    heads = (
        text("variant-used", name=words.say(item.name)) if item.used else words.say(item.name)
        for item in variants
    )
    return (
        Table(
            caption=text("variants-caption"),
            columns=name_and_numbers(text("quantity"), heads, width=1.6),
            rows=tuple(rows),
        ),
    )


def _stiffness(part: LoopPart | VariantEntry, words: Catalogue) -> str:
    f = words.format
    return words.text(
        "stiffness-at",
        stiffness=f.axis(part.dynamic_stiffness, "N/m"),
        frequency=f.quantity(part.weakest_frequency_hz, "Hz"),
    )


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
