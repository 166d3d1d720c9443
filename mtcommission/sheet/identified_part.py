"""What was measured on the axis: estimates with their intervals, points over fitted curves, advice.

The sheet and the page of ``identify`` print the same blocks.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.schema.identified import (
    IdentifiedPart,
    MeasuredResponseEntry,
    ToolSensorEntry,
)
from mtcommission.record.schema.limits import JudgedLimits, LimitsEntry
from mtcommission.record.schema.machine import ModeEntry
from mtcommission.record.schema.record import Record
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Column,
    Paragraph,
    Section,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.sheet.values import say_filter
from mtcommission.units.axis_units import LINEAR, ROTARY, AxisUnits

Array = NDArray[np.float64]

INFORMATION = (
    *("identify-by-", "identify-hold", "identify-band-given", "identify-loudest-axis"),
    *("identify-klipper-choice", "identify-core-xy"),
)
"""How the kinds of messages begin that warn of nothing."""
SHOWN_DIGITS = 16
"""Of a hash; the profile's text has it whole."""
CHANGED = 1e-3
"""Relative difference beyond which the profile no longer says what was measured."""


def identified(record: Record, words: Catalogue) -> tuple[Section, ...]:
    """Return what was measured; nothing where the numbers come from elsewhere."""
    part = record.identified
    if part is None:
        return ()
    inside = {mode.name: mode for mode in record.plant.modes}
    told = changes(part, record, words)
    blocks: tuple[Block, ...] = (
        Paragraph(text=words.text("identified-note", date=part.created[:10]), tone=Tone.NOTE),
        result_table(part, words),
        *mode_tables(part, words, inside=inside),
        *([Bullets(items=told, tone=Tone.WARNING)] if told else []),
        *([_tool_sensor(part.tool_sensor, words)] if part.tool_sensor else []),
        *_beside_klipper(part, record, words),
        *plots(part, words),
        *remarks(part, words),
        *([check_table(part, words)] if part.checks else []),
        file_table(part, words),
    )
    heading = words.text("identified-heading")
    return (Section(key="identified", heading=heading, blocks=blocks, is_appendix=True),)


def plus_minus(one: Estimate | None, unit: str, words: Catalogue) -> str:
    """Return a value with two standard errors, in its unit."""
    if one is None:
        return words.text("identify-not-known")
    scale = words.format.scale(abs(one.value), unit)
    value, error = one.value / scale.size, 2.0 * one.sigma / scale.size
    if not np.isfinite(error):  # nothing determines it
        return words.format.with_unit(f"{words.format.number(value)} ± ∞", scale.unit)
    digits = 3 if error == 0.0 or value == 0.0 else int(np.ceil(np.log10(abs(value / error)))) + 2
    shown = words.format.number(value, digits=int(np.clip(digits, 2, 6)))
    reach = words.format.number(error, digits=2)
    return words.format.with_unit(f"{shown} ± {reach}", scale.unit)


def facts(part: IdentifiedPart, words: Catalogue) -> tuple[tuple[str, str, str], ...]:
    """Return what was found over all modes: name, value, and where it comes from."""
    say, unit, because = words.text, _units(words), part.spread.because
    rows: list[tuple[str, str, str]] = []
    if not part.base_excited:  # a held motor shows neither
        mass = plus_minus(part.moving_mass, unit.mass.si, words)
        delay = plus_minus(part.delay, "s", words)
        rows = [
            (say("identify-mass"), mass, say("identify-mass-meaning")),
            (say("identify-delay"), delay, say("identify-delay-meaning")),
        ]
    if part.lag:
        value = plus_minus(part.lag, "s", words)
        rows.append((say("identify-lag"), value, say("identify-lag-meaning")))
    if part.band_hz:
        low, high = part.band_hz
        value = say("identify-band-from-to", low=low, high=high)
        rows.append((say("identify-band"), value, say("identify-band-meaning")))
    if part.misfit is not None:
        value = words.format.number(part.misfit, digits=3)
        rows.append((say("identify-misfit"), value, say("identify-misfit-meaning")))
    for place, (kind, spread) in enumerate(
        (("frequency", part.spread.frequency), ("damping", part.spread.damping))
    ):
        why = words.say(because[place]) if because else say("identified-by-profile")
        rows.append((say(f"identify-spread-{kind}"), f"± {words.format.percent(spread)}", why))
    return tuple(rows)


def result_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return mass, delay, band, misfit and spreads."""
    return Table(
        caption=words.text("identify-caption-result"),
        columns=(
            Column(head="", width=1.2),
            Column(head=words.text("identify-head-value"), is_number=True),
            Column(head=words.text("identify-head-why"), width=2.4),
        ),
        rows=facts(part, words),
    )


def mode_heads(words: Catalogue) -> tuple[str, ...]:
    """Return the heads of a table of modes."""
    kinds = ("mode", "frequency", "damping", "encoder", "tool")
    return tuple(words.text(f"identify-head-{kind}") for kind in kinds)


def mode_row(
    mode: MeasuredMode, part: IdentifiedPart, words: Catalogue, *, stated: ModeEntry | None = None
) -> tuple[str, ...]:
    """Return a row of such a table; ``stated`` is the mode in the profile."""
    gain = "" if part.base_excited else _units(words).gain.si
    tool = plus_minus(mode.tcp_gain, gain, words)
    if mode.tcp_gain is None and stated is not None:
        tool = words.text("identified-assumed", value=words.format.quantity(stated.tcp_gain, gain))
    return (
        mode.name,
        plus_minus(mode.frequency_hz, "Hz", words),
        plus_minus(mode.damping_ratio, "", words),
        plus_minus(mode.measured_gain, gain, words),
        tool,
    )


def mode_tables(
    part: IdentifiedPart, words: Catalogue, *, inside: Mapping[str, ModeEntry]
) -> tuple[Table, ...]:
    """Return the modes over all states and, where there are several, in each.

    Parameters
    ----------
    part
        What was measured.
    words
        Language.
    inside
        Modes of the profile, by name.
    """
    first, *others = mode_heads(words)
    tables = [
        Table(
            caption=words.text("identify-caption-modes"),
            columns=name_and_numbers(first, others, width=1.0),
            rows=tuple(
                mode_row(mode, part, words, stated=inside.get(mode.name)) for mode in part.modes
            ),
        )
    ]
    if len(part.states) > 1:
        head = words.text("identify-head-state")
        rows = [
            (state.name, *mode_row(mode, part, words))
            for name in [mode.name for mode in part.modes]
            for state in part.states
            for mode in state.modes
            if mode.name == name
        ]
        columns = name_and_numbers(first, others, width=1.0)
        tables.append(
            Table(
                caption=words.text("identify-caption-states"),
                columns=(Column(head=head, width=1.5), *columns),
                rows=tuple(rows),
            )
        )
    return tuple(tables)


def remarks(part: IdentifiedPart, words: Catalogue) -> tuple[Bullets, ...]:
    """Return what to mind and what to measure better, then how it was done."""
    doubts, notes = doubts_and_notes(part)
    return tuple(
        Bullets(items=tuple(words.say(one) for one in some), tone=tone)
        for some, tone in ((doubts, Tone.WARNING), (notes, Tone.NOTE))
        if some
    )


def doubts_and_notes(part: IdentifiedPart) -> tuple[tuple[Message, ...], tuple[Message, ...]]:
    """Return what to mind and what to measure better; and how something was done."""
    notes = tuple(one for one in part.warnings if one.kind.startswith(INFORMATION))
    return tuple(one for one in part.warnings if one not in notes), notes


def check_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return how well the model explains the records it came from, and one held back."""
    return Table(
        caption=words.text("identify-caption-check"),
        columns=(
            Column(head=words.text("identify-head-file"), width=2.0),
            Column(head=words.text("identify-head-explained"), is_number=True),
            Column(head=words.text("identify-head-held-back")),
        ),
        rows=tuple(
            (
                one.record,
                words.format.percent(one.explained),
                words.text("terminal-yes" if one.held_back else "terminal-no"),
            )
            for one in part.checks
        ),
    )


def file_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return what was read."""
    heads = ("identify-head-file", "identify-head-sensor", "identify-head-format")
    return Table(
        caption=words.text("identify-caption-files"),
        columns=(
            *(Column(head=words.text(head), width=1.5) for head in heads),
            Column(head=words.text("identify-head-hash"), width=1.5),
        ),
        rows=tuple(
            (
                short_name(one.name),
                words.text(f"identify-sensor-{one.sensor}"),
                words.say(part.formats[one.name]) if one.name in part.formats else "–",
                one.sha256[:SHOWN_DIGITS],
            )
            for one in part.sources
        ),
    )


def plots(part: IdentifiedPart, words: Catalogue) -> tuple[LinePlot, ...]:
    """Return measured points over fitted curves."""
    return tuple(
        _plot(f"fit-{number}", one, words) for number, one in enumerate(part.responses, start=1)
    )


def _plot(key: str, one: MeasuredResponseEntry, words: Catalogue) -> LinePlot:
    say, f, curve = words.text, np.array(one.frequency_hz), np.array(one.curve_hz)
    size = np.array(one.magnitude)

    def panel(kind: str, *lines: Line, unit: str = "", borders: tuple[Border, ...] = ()) -> Panel:
        label = say(f"identify-plot-{kind}", unit=unit) if unit else say(f"identify-plot-{kind}")
        return Panel(y_label=label, lines=lines, borders=borders)

    def measured(y: Array) -> Line:
        return Line(label=say("identify-line-measured"), x=f, y=y, style=0)

    def fitted(y: Array) -> Line:
        return Line(label=say("identify-line-fitted"), x=curve, y=y, style=4)

    def reach(y: Array) -> Line:
        return Line(label=say("identify-line-error"), x=f, y=y, style=2)

    lines = []
    if one.error is not None:
        error = 2.0 * np.sqrt(2.0) * np.array(one.error)
        lines += [reach(np.log10(y)) for y in (size + error, np.maximum(size - error, 0.2 * size))]
    lines += [fitted(np.log10(one.curve_magnitude)), measured(np.log10(size))]
    kind = "magnitude" if one.unit else "density"
    panels = [panel(kind, *lines, unit=one.unit)]
    if one.phase_deg is not None and one.curve_phase_deg is not None:
        both = fitted(np.array(one.curve_phase_deg)), measured(np.array(one.phase_deg))
        panels.append(panel("phase", *both))
    if one.coherence is not None:
        panels.append(panel("coherence", measured(np.array(one.coherence))))
    if one.missed is not None:
        limit = (Border(label="2", y=2.0),)
        panels.append(panel("misfit", measured(np.array(one.missed)), borders=limit))
    about = {} if one.misfit is None else {"misfit": one.misfit}
    what = "plot" if about else "spectrum"
    return LinePlot(
        key=key,
        caption=say(f"identify-{what}-caption", file=short_name(one.name)),
        alt=say(f"identify-{what}-alt", file=short_name(one.name), **about),
        x_label=say("identify-plot-frequency"),
        x_is_log=True,
        link="fits",
        panels=tuple(panels),
    )


def short_name(name: str) -> str:
    """Return a file without its folder."""
    return name.rpartition("/")[2].rpartition("\\")[2]


def changes(part: IdentifiedPart, record: Record, words: Catalogue) -> tuple[str, ...]:
    """Return what the profile no longer says as it was measured."""
    text, stated = words.text, {mode.name: mode for mode in record.plant.modes}
    found = []
    for mode in part.modes:
        now = stated.get(mode.name)
        if now is None:
            found.append(text("identified-not-in-profile", mode=mode.name))
            continue
        for kind, measured, value in (
            ("frequency", mode.frequency_hz, now.frequency_hz),
            ("damping", mode.damping_ratio, now.damping_ratio),
        ):
            if abs(value - measured.value) > CHANGED * abs(measured.value):
                name = text(f"identify-head-{kind}")
                unit = "Hz" if kind == "frequency" else ""
                shown = words.format.quantity(value, unit)
                told = plus_minus(measured, unit, words)
                found.append(
                    text("identified-changed", mode=mode.name, what=name, now=shown, was=told)
                )
    mass = record.plant.moving_mass
    if part.moving_mass and abs(mass - part.moving_mass.value) > CHANGED * mass:
        unit = _units(words).mass.si
        found.append(
            text(
                "identified-mass-changed",
                now=words.format.quantity(mass, unit),
                was=plus_minus(part.moving_mass, unit, words),
            )
        )
    data = {item.key: item.value for item in record.data}
    for kind, spread in (
        ("frequency", part.spread.frequency),
        ("damping", part.spread.damping),
    ):
        held = data.get(f"requirements.{kind}_spread")
        if isinstance(held, float) and held < (1.0 - CHANGED) * spread:
            what = text(f"identify-spread-{kind}")
            limits = words.format.percent(held), words.format.percent(spread)
            found.append(text("identified-spread-less", what=what, now=limits[0], was=limits[1]))
    return tuple(found)


def _beside_klipper(part: IdentifiedPart, record: Record, words: Catalogue) -> tuple[Block, ...]:
    """What calibrate_shaper would choose, by its own measures; then simulated, beside ours."""
    if not part.proposals:
        return ()
    text, f = words.text, words.format
    proposals = Table(
        caption=text("identified-klipper-caption"),
        columns=tuple(
            Column(head=text(f"identified-klipper-{head}"), is_number=head != "shaper")
            for head in ("shaper", "frequency", "vibration", "smoothing", "max-accel")
        ),
        rows=tuple(
            (
                text("identified-klipper-chosen", shaper=one.shaper.upper())
                if one.is_recommended
                else one.shaper.upper(),
                f.quantity(one.frequency_hz, "Hz"),
                f.percent(one.vibration),
                f.quantity(one.smoothing, "m"),
                f.with_unit(f.number(1e3 * one.max_acceleration, digits=4), "mm/s²"),
            )
            for one in part.proposals
        ),
    )
    ours = record.limits.recommended
    simulated = [
        (words.say(one.name), one)
        for one in record.limits.rules
        if isinstance(one.name, Message) and one.name.kind == "shaper-of-calibration"
    ]
    own = text("identified-klipper-ours", filter=say_filter(ours.setpoint_filter, words))
    verdict = "yes" if record.assessment.met else "no"
    rows: list[tuple[str, str, LimitsEntry | JudgedLimits]] = [
        (own, verdict, ours),
        *((name, _met(one), one) for name, one in simulated),
    ]
    beside = Table(
        caption=text("identified-klipper-simulated"),
        columns=(
            Column(head="", width=2.6),
            Column(head=text("acceleration"), is_number=True),
            Column(head=text("settling-time"), is_number=True),
            Column(head=text("residual"), is_number=True),
            Column(head=text("meets")),
        ),
        rows=tuple(
            (
                name,
                f.axis(one.acceleration, "m/s^2"),
                text("not-settled")
                if one.settling_time is None
                else f.quantity(one.settling_time, "s"),
                text("not-settled")
                if one.residual_deviation is None
                else f.axis(one.residual_deviation, "m"),
                text(met),
            )
            for name, met, one in rows
        ),
    )
    return (proposals, *([beside] if simulated else []))


def _met(one: JudgedLimits) -> str:
    if not one.meets_requirements:
        return "no"
    return "yes" if one.keeps_reserve else "yes-without-reserve"


def _tool_sensor(one: ToolSensorEntry, words: Catalogue) -> Paragraph:
    named = {"modes": ", ".join(one.modes)}
    if one.settling_time is None or one.least is None:
        met = "no" if one.least is None else "yes"
        said = words.text("identified-tool-decides", **named, met=met)
    elif one.least >= one.settling_time:
        said = words.text("identified-tool-frees-nothing", **named)
    else:
        said = words.text(
            "identified-tool-frees",
            **named,
            now=one.settling_time,
            least=one.least,
            freed=one.settling_time - one.least,
        )
    return Paragraph(text=said, tone=Tone.NOTE)


def _units(words: Catalogue) -> AxisUnits:
    return ROTARY if words.rotary else LINEAR
