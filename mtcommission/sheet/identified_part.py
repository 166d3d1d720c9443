"""What was measured on the axis, beside what the profile says of it now."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.identified import (
    IdentifiedPart,
    ToolSensorEntry,
)
from mtcommission.record.schema.limits import JudgedLimits, LimitsEntry
from mtcommission.record.schema.record import Record
from mtcommission.sheet.measured_blocks import (
    axis_of,
    check_table,
    file_table,
    mode_tables,
    plots,
    plus_minus,
    remarks,
    result_table,
)
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Column,
    Paragraph,
    Section,
    Table,
    Tone,
)
from mtcommission.sheet.values import is_of_calibration, say_filter

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
        unit = axis_of(words).mass.si
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
        (words.say(one.name), one) for one in record.limits.rules if is_of_calibration(one)
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
