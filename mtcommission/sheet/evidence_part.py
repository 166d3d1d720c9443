"""Certificates, assumptions, settings, versions, and what is filled in by hand."""

from __future__ import annotations

from math import pi

from mtcommission.record.schema import OptimumEntry, Record
from mtcommission.sheet.format import Formatter
from mtcommission.sheet.loop_part import gain_rows
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Column,
    Form,
    Paragraph,
    Preformatted,
    Section,
    Subheading,
    Table,
    Tone,
)
from mtcommission.sheet.motion_part import named_optima
from mtcommission.sheet.verdict_part import acceleration, jerk, move_title

KV_UNIT = 1000.0 / 60.0
"""Kv of 1 (m/min)/mm in 1/s."""


def certificates(record: Record, f: Formatter) -> Section:
    """Return certificates, assumptions, warnings and numerical settings."""
    text = f.labels
    tables: list[Block] = []
    for number, optima in enumerate(record["optima"], start=1):
        title = move_title(optima["move"], number, f)
        for name, _, optimum in named_optima(optima, f):
            caption = text.certificate_caption.format(move=title, what=name)
            tables.append(_pairs(caption, text.quantity, _certificate_rows(optimum, f), f))
    settings = [
        (text.say(_setting_name(key)), _setting(value, f))
        for key, value in [*record["settings"].items(), *record["limits"]["search"].items()]
    ]
    return Section(
        key="certificates",
        heading=text.evidence_heading,
        blocks=(
            Subheading(text=text.assumptions),
            _sentences(record["assumptions"], Tone.PLAIN, f),
            Subheading(text=text.warnings),
            _sentences(record["warnings"], Tone.WARNING, f),
            *tables,
            _pairs(text.settings_caption, text.setting, settings, f),
        ),
    )


def versions(record: Record, f: Formatter) -> Section:
    """Return program, libraries, hash and text of the profile."""
    text, tool, profile = f.labels, record["tool"], record["profile"]
    rows = [
        (tool["name"], tool["version"]),
        *tool["libraries"].items(),
        (text.created, record["created"]),
    ]
    return Section(
        key="versions",
        heading=text.versions_heading,
        blocks=(
            _pairs(text.versions_caption, text.program, rows, f),
            Paragraph(text=f"{text.hash_row}:"),
            Paragraph(text=profile["sha256"], tone=Tone.CODE),
            Preformatted(
                caption=text.profile_caption.format(name=profile["name"]), text=profile["text"]
            ),
        ),
    )


def entry_form(record: Record, f: Formatter) -> Section:
    """Return the table of parameters with empty columns, and the signature block."""
    text = f.labels
    limits, kv = record["limits"]["recommended"], record["loop"]["Kv"]
    kv_text = f.with_unit(f.number(kv / KV_UNIT), "(m/min)/mm")
    rows = [
        (text.acceleration, acceleration(record, f), _other_unit(limits["acceleration"], "s²", f)),
        (text.jerk, jerk(record, f), _other_unit(limits["jerk"], "s³", f)),
        (text.jerk_time, f.quantity(limits["jerk_time"], "s"), ""),
    ]
    for name, value in gain_rows(record, f):
        rows.append((name, value, kv_text if name == text.name("Kv") else ""))
    heads = (text.old_value, text.new_value, text.entered_by, text.verified)
    table = Table(
        caption=text.entry_caption,
        columns=(
            Column(head=text.parameter, width=1.9),
            Column(head=text.value, width=1.3, is_number=True),
            Column(head=text.also, width=1.4, is_number=True),
            *(Column(head=head) for head in heads),
        ),
        rows=tuple((*row, *("" for _ in heads)) for row in rows),
        strong_rows=(0, 1, 2),
        is_form=True,
    )
    return Section(
        key="entry",
        heading=text.entry_heading,
        blocks=(
            table,
            Paragraph(text=f"{text.entry_note} {text.disclaimer}", tone=Tone.NOTE),
            Form(fields=text.signature_fields),
        ),
        is_together=True,
    )


def _setting_name(key: str) -> str:
    """Return e.g. "tuning: sensitivity peak" for ``tuning.sensitivity_peak``."""
    return key.replace(".", ": ").replace("_", " ")


def _setting(value: float | str, f: Formatter) -> str:
    """Return one number, or several that the record separates by commas; words as they are."""
    if not isinstance(value, str):
        return f.number(value)
    try:
        return "; ".join(f.number(float(part)) for part in value.split(","))
    except ValueError:
        return value


def _other_unit(value: float, per: str, f: Formatter) -> str:
    """Return acceleration or jerk in the unit that many controls want: mm, or turns."""
    if f.rotary:
        return f.quantity(value / (2 * pi), f"rev/{per}")
    return f.with_unit(f.number(value * 1e3), f"mm/{per}")


def _certificate_rows(optimum: OptimumEntry, f: Formatter) -> list[tuple[str, str]]:
    text = f.labels
    rows = [
        (text.final_time, f.quantity(optimum["t_f"], "s")),
        (text.method, text.say(optimum["method"])),
        (text.switches, ", ".join(f.quantity(t, "s") for t in optimum["switching_times"])),
        (text.largest_error, f.number(_largest_error(optimum), digits=2)),
    ]
    if optimum["cost"] is not None:
        rows.append((text.cost, f.quantity(optimum["cost"], "N^2 s")))
    if optimum["weights"]:
        rows.append((text.weights, _listed(optimum["weights"], f)))
    for key, value in optimum["certificate"].items():
        rows.append((text.name(key), _evidence(key, value, f)))
    return [row for row in rows if row[1]]


def _largest_error(optimum: OptimumEntry) -> float:
    return max(
        (
            abs(error) / optimum["peaks"][state]
            for state, error in optimum["terminal_error"].items()
            if optimum["peaks"].get(state)
        ),
        default=0.0,
    )


def _evidence(
    key: str, value: float | bool | dict[str, float] | list[float] | None, f: Formatter
) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return f.labels.yes if value else f.labels.no
    if isinstance(value, dict):
        return _listed(value, f)
    if isinstance(value, list):
        return "; ".join(f.number(item) for item in value)
    return f.quantity(value, "s") if key.startswith("t_f") else f.number(value)


def _listed(values: dict[str, float], f: Formatter) -> str:
    return "; ".join(f"{name} = {f.number(value)}" for name, value in values.items())


def _sentences(items: list[str], tone: Tone, f: Formatter) -> Block:
    if not items:
        return Paragraph(text=f.labels.none)
    return Bullets(items=tuple(f.labels.say(item) for item in items), tone=tone)


def _pairs(caption: str, head: str, rows: list[tuple[str, str]], f: Formatter) -> Table:
    return Table(
        caption=caption,
        columns=(Column(head=head), Column(head=f.labels.value, width=1.6)),
        rows=tuple(rows),
    )
