"""What is entered by hand on the control and on paper: parameters, and the signatures."""

from __future__ import annotations

from math import pi

from mtcommission.control_kinds.kinds import KINDS
from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema import Record
from mtcommission.sheet.loop_part import gain_rows
from mtcommission.sheet.model import Column, Form, Paragraph, Section, Table, Tone
from mtcommission.sheet.values import filter_rows, say_filter
from mtcommission.sheet.verdict_part import acceleration, jerk

KV_UNIT = 1000.0 / 60.0
"""Kv of 1 (m/min)/mm in 1/s."""


def parameters(record: Record, words: Catalogue) -> Section:
    """Return the parameters for the control, with empty columns."""
    text, f = words.text, words.format
    limits, kv = record.limits.recommended, record.loop.Kv
    kv_text = ""
    if kv is not None:
        per_minute = (60.0 * kv, "1/min") if words.rotary else (kv / KV_UNIT, "(m/min)/mm")
        kv_text = f.with_unit(f.number(float(f"{per_minute[0]:.4g}")), per_minute[1])
    rows = [
        (
            text("acceleration"),
            acceleration(record, words),
            _other_unit(limits.acceleration, "s²", words),
        ),
    ]
    if record.loop.jerk != "none":
        rows += [
            (text("jerk"), jerk(record, words), _other_unit(limits.jerk, "s³", words)),
            (text("jerk-time"), f.quantity(limits.jerk_time, "s"), ""),
        ]
    rows += _filter_rows(record, words)
    for name, value in gain_rows(record, words):
        rows.append((name, value, kv_text if name == words.name("Kv") else ""))
    old = todays_values(record, words)
    heads = (text("new-value"), text("entered-by"), text("verified"))
    table = Table(
        caption=text("entry-caption"),
        columns=(
            Column(head=text("parameter"), width=1.9),
            Column(head=text("value"), width=1.3, is_number=True),
            Column(head=text("also"), width=1.4, is_number=True),
            Column(head=text("old-value"), width=1.2),
            *(Column(head=head) for head in heads),
        ),
        rows=tuple((*row, old.get(row[0], ""), *("" for _ in heads)) for row in rows),
        strong_rows=(0, 1, 2) if record.loop.jerk != "none" else (0,),
        is_form=True,
    )
    return Section(
        key="parameters",
        heading=text("entry-heading"),
        blocks=(Paragraph(text=text("entry-note"), tone=Tone.NOTE), table),
    )


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


def signatures(record: Record, words: Catalogue) -> Section:
    """Return the block to be signed, with the values that are signed for."""
    text = words.text
    values = text(
        "signed-values",
        machine=record.machine.name,
        axis_name=record.machine.axis,
        acceleration=acceleration(record, words),
        jerk=jerk(record, words),
        filter=say_filter(record.limits.recommended.setpoint_filter, words),
    )
    return Section(
        key="signature",
        heading=text("signature-heading"),
        blocks=(
            Paragraph(text=values),
            Paragraph(text=text("disclaimer"), tone=Tone.NOTE),
            Form(fields=tuple(text(f"signature-field-{i}") for i in range(1, 5))),
        ),
        is_together=True,
    )


def _filter_rows(record: Record, words: Catalogue) -> list[tuple[str, str, str]]:
    """Return the filter as it is entered, by the control's own names where they were read."""
    kind, item = KINDS[record.loop.kind], record.limits.recommended.setpoint_filter
    if not kind.setpoint_filters:
        return []
    choice = kind.find_filter(item.kind) if item else None
    typed: tuple[str, ...] = ()
    if item and choice:
        typed = choice.enter(
            time=item.time,
            second_time=item.second_time,
            frequency_hz=item.frequency_hz,
            damping_ratio=item.damping_ratio,
        )
    rows = filter_rows(item, words)
    return [(*row, name) for row, name in zip(rows, [*typed, *[""] * len(rows)], strict=False)]


def _other_unit(value: float, per: str, words: Catalogue) -> str:
    """Return acceleration or jerk in the unit that many controls want: mm, or turns."""
    f = words.format
    if words.rotary:
        return f.quantity(value / (2 * pi), f"rev/{per}")
    return f.with_unit(f.number(value * 1e3), f"mm/{per}")
