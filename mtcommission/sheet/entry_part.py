"""What is typed in, by the control's own names, old beside new; and what is signed for."""

from __future__ import annotations

import re
from math import pi

from mtcommission.control_kinds.kinds import KINDS
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import motion_unit, symbol
from mtcommission.record.schema.record import Record
from mtcommission.sheet.model import Block, Column, Form, Paragraph, Table
from mtcommission.sheet.values import filter_rows, say_filter
from mtcommission.sheet.verdict_part import acceleration, jerk

KV_UNIT = 1000.0 / 60.0
"""Kv of 1 (m/min)/mm in 1/s."""

TYPED_POINT = re.compile(r"(?<=\d)\.(?=\d+ m?s\b)")
"""The decimal point of a time that is typed into a mask."""

MOTION_UNIT = re.compile(r" \[[^\]]*/s\^[23][^\]]*\]")
"""Units of acceleration and jerk in the text about a parameter."""

Row = tuple[str, str, str]
"""What it is, what of the control holds it (as in ``FEATURES``), its value."""


def entries(record: Record, words: Catalogue) -> Table:
    """Return every value to enter: its name in the control, old beside new."""
    text, old = words.text, todays_values(record, words)
    rows = entry_rows(record, words)
    own = _own_names(record, rows, words.format.decimal_mark)
    # One text of a control may hold several values: it stands at the first of them.
    shown = [
        text("entry-above") if name and name in own[:k] else name for k, name in enumerate(own)
    ]
    has_names = any(own)
    return Table(
        caption=text("entry-caption", jerk=record.loop.jerk),
        columns=(
            Column(head=text("parameter"), width=1.6),
            *([Column(head=text("control-parameters"), width=3.0)] if has_names else []),
            Column(head=text("old-value"), width=0.85, is_number=True),
            Column(head=text("new-value"), width=2.1, is_number=True),
        ),
        rows=tuple(
            (name, *([own_name] if has_names else []), old.get(name, ""), value)
            for (name, _, value), own_name in zip(rows, shown, strict=True)
        ),
        strong_rows=tuple(k for k, (_, feature, _) in enumerate(rows) if feature in LIMITS),
    )


LIMITS = ("acceleration", "jerk", "setpoint_filters")
"""What a commissioning is about; stressed in the table."""


def entry_rows(record: Record, words: Catalogue) -> list[Row]:
    """Return the limits, the filter, and every gain, delay and cycle of the loop."""
    text, f, part, units = words.text, words.format, record.loop, record.plant.units
    limits = record.limits.recommended
    named = {item.name: item.parameters for item in record.loop.features}
    a = _in_units(
        acceleration(record, words),
        limits.acceleration,
        2,
        named.get("acceleration", ""),
        words,
    )
    rows: list[Row] = [(text("acceleration"), "acceleration", a)]
    if part.jerk != "none":
        j = _in_units(jerk(record, words), limits.jerk, 3, named.get("jerk", ""), words)
        rows += [(text("jerk"), "jerk", j)]
    if part.jerk == "time":
        rows.append((text("jerk-time"), "jerk", f.quantity(limits.jerk_time, "s")))
    if KINDS[part.kind].setpoint_filters:
        rows += [
            (name, "setpoint_filters", value)
            for name, value in filter_rows(limits.setpoint_filter, words)
        ]
    if part.Kv is None:  # the motor follows its setpoint: nothing of a loop is typed in
        return rows
    rows += [
        (words.name("Kv"), "position_gain", _gain(part.Kv, words)),
        (
            words.name("Kp"),
            "velocity_gain",
            _at_shaft(record, f.axis(part.Kp, "N s/m"), part.Kp, "N m s/rad", words),
        ),
        (words.name("Tn"), "velocity_gain", f.quantity(part.Tn, "s")),
    ]
    fed = part.feedforward
    mass = f.quantity(fed.mass, motion_unit("kg", rotary=words.rotary))
    inertia = _at_shaft(record, mass, fed.mass, "kg m^2", words)
    for name, value in (
        ("velocity", f.number(fed.velocity)),
        ("acceleration", f"{f.number(fed.acceleration)} × {inertia}"),
        ("jerk", f.number(fed.jerk)),
    ):
        if name != "jerk" or fed.jerk:
            said = text("feedforward", name=text(f"feedforward-{name}"))
            rows.append((said, f"{name}_feedforward", value))
    rows.append((text("reference-delay"), "reference_delay", f.quantity(part.reference_delay, "s")))
    for state, gain in part.state_feedback.items():
        unit = f"{units['F']}/({units[state]})" if state in units else ""
        rows.append(
            (text("state-feedback", name=symbol(state)), "state_feedback", f.quantity(gain, unit))
        )
    if part.reference_model_time:
        rows.append((text("reference-model"), "", f.quantity(part.reference_model_time, "s")))
    for number, item in enumerate(part.force_filters, start=1):
        said = text(
            f"loop-filter-{item.kind.replace('_', '-')}",
            frequency=item.natural_frequency / (2.0 * pi),
            damping=item.damping,
            width=item.width,
        )
        rows.append((text("force-filter", number=number), "force_filters", said))
    cycles = f"{f.quantity(part.position_cycle, 's')}, {f.quantity(part.velocity_cycle, 's')}"
    rows.append((text("cycles"), "position_cycle", cycles))
    return rows


def _names(record: Record) -> dict[str, str]:
    """Return the control's own parameters by what they hold; "(?)" where they were not read.

    The unit of acceleration and jerk stands beside their values.
    """
    named = {}
    for item in record.loop.features:
        own = MOTION_UNIT.sub(lambda unit: " (?)" if "(?)" in unit[0] else "", item.parameters)
        named[item.name] = own if item.verified or not own or "(?)" in own else f"{own} (?)"
    return named


def _own_names(record: Record, rows: list[Row], mark: str) -> list[str]:
    """Return what the control calls each row; of its setpoint filter what is typed, if known."""
    named, typed = _names(record), iter(_typed_filter(record, mark))
    return [
        next(typed, "") or named.get(feature, "")
        if feature == "setpoint_filters"
        else named.get(feature, "")
        for _, feature, _ in rows
    ]


def _typed_filter(record: Record, mark: str) -> tuple[str, ...]:
    """Return what is typed in for the setpoint filter, for each of its rows; empty if not read."""
    kind, item = KINDS[record.loop.kind], record.limits.recommended.setpoint_filter
    choice = kind.find_filter(item.kind) if item else None
    if not item or not choice:
        return ()
    entered = choice.enter(
        time=item.time,
        second_time=item.second_time,
        frequency_hz=item.frequency_hz,
        damping_ratio=item.damping_ratio,
        axis=record.machine.axis,
    )
    # A quantity is read like every other one here; a line of a file keeps its own decimal point.
    return tuple(TYPED_POINT.sub(mark, text) for text in entered)


def _gain(kv: float, words: Catalogue) -> str:
    """Return Kv in both of the units that controls ask for."""
    f = words.format
    value, unit = (60.0 * kv, "1/min") if words.rotary else (kv / KV_UNIT, "(m/min)/mm")
    other = f.with_unit(f.number(float(f"{value:.4g}")), unit)
    return f"{f.quantity(kv, '1/s')} = {other}"


def _at_shaft(record: Record, shown: str, value: float | None, unit: str, words: Catalogue) -> str:
    """Return gain or mass at the axis, and what it is at the motor's shaft, where drives want it.

    The axis moves r = lead / (2 pi gear) per radian of the motor (rotary: 1 / gear): times r².
    """
    stated = {item.key: item.value for item in record.data}
    lead, gear = stated.get("drive.lead"), stated.get("drive.gear")
    ratio = float(gear) if isinstance(gear, float | int) else 1.0
    if words.rotary:
        r = 1.0 / ratio
    elif isinstance(lead, float | int):
        r = float(lead) / (2.0 * pi * ratio)
    else:
        r = 1.0
    if r == 1.0 or value is None:
        return shown
    return words.text("at-shaft", own=shown, shaft=words.format.quantity(value * r**2, unit))


def _in_units(shown: str, value: float, power: int, own: str, words: Catalogue) -> str:
    """Return acceleration or jerk, also in the unit that the control's parameter names."""
    f = words.format
    if words.rotary and f"rev/s^{power}" in own:
        return f"{shown} = {f.quantity(value / (2.0 * pi), f'rev/s^{power}')}"
    if not words.rotary and f"mm/s^{power}" in own:
        sign = {2: "²", 3: "³"}[power]
        return f"{shown} = {f.with_unit(f.number(1e3 * value), f'mm/s{sign}')}"
    return shown


def todays_values(record: Record, words: Catalogue) -> dict[str, str]:
    """Return what is in the control now as the profile states it, by the name of the parameter."""
    text, f, today = words.text, words.format, record.limits.today
    if today is None:
        return {}
    found = {
        text("acceleration"): f.axis(today.acceleration, "m/s^2"),
        text("jerk"): f.axis(today.jerk, "m/s^3", missing=text("no-jerk-limit")),
    }
    if today.setpoint_filter:
        found |= dict(filter_rows(today.setpoint_filter, words))
    gains = (("Kv", today.Kv, "1/s"), ("Kp", today.Kp, "N s/m"), ("Tn", today.Tn, "s"))
    for name, value, unit in gains:
        if name in today.stated:
            found[words.name(name)] = f.axis(value, unit)
    return found


def signature(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return the values that are signed for, and the lines to sign on."""
    text = words.text
    values = text(
        "signed-values",
        machine=record.machine.name,
        axis_name=record.machine.axis,
        acceleration=acceleration(record, words),
        jerk=jerk(record, words),
        filter=say_filter(record.limits.recommended.setpoint_filter, words),
    )
    return (
        Paragraph(text=values),
        Form(fields=tuple(text(f"signature-field-{i}") for i in range(1, 5))),
    )
