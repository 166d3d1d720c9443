"""Certificates, assumptions, warnings, and the versions that computed."""

from __future__ import annotations

from dataclasses import asdict
from itertools import pairwise

from mtcommission.record.schema import ArcEntry, OptimumEntry, Record
from mtcommission.sheet.format import Formatter
from mtcommission.sheet.model import (
    Block,
    Bullets,
    Column,
    Paragraph,
    Preformatted,
    Section,
    Subheading,
    Table,
    Tone,
)
from mtcommission.sheet.motion_part import named_optima
from mtcommission.sheet.phrases import polish
from mtcommission.sheet.settings_part import settings
from mtcommission.sheet.verdict_part import move_title


def certificates(record: Record, f: Formatter) -> Section:
    """Return certificates, assumptions, warnings and numerical settings."""
    text = f.labels
    tables: list[Block] = []
    for number, optima in enumerate(record.optima, start=1):
        title = move_title(optima.move, number, f)
        for name, _, optimum in named_optima(optima, f):
            caption = text.certificate_caption.format(move=title, what=name)
            tables.append(_pairs(caption, text.quantity, _certificate_rows(optimum, f), f))
    return Section(
        key="certificates",
        heading=text.evidence_heading,
        blocks=(
            Subheading(text=text.assumptions),
            _sentences(record.assumptions, Tone.PLAIN, f),
            Subheading(text=text.warnings),
            _sentences(record.warnings, Tone.WARNING, f),
            *tables,
            *settings(record, f),
        ),
    )


def versions(record: Record, f: Formatter) -> Section:
    """Return program, libraries, hash and text of the profile."""
    text, tool, profile = f.labels, record.tool, record.profile
    rows = [
        (tool.name, tool.version),
        *tool.libraries.items(),
        (text.created, record.created),
    ]
    return Section(
        key="versions",
        heading=text.versions_heading,
        blocks=(
            _pairs(text.versions_caption, text.program, rows, f),
            Paragraph(text=f"{text.hash_row}:"),
            Paragraph(text=profile.sha256, tone=Tone.CODE),
            Preformatted(caption=text.profile_caption.format(name=profile.name), text=profile.text),
        ),
    )


def _certificate_rows(optimum: OptimumEntry, f: Formatter) -> list[tuple[str, str]]:
    text = f.labels
    rows = [
        (text.final_time, f.quantity(optimum.t_f, "s")),
        (text.method, text.say(optimum.method)),
        (text.switches, ", ".join(f.quantity(t, "s") for t in _changes(optimum.arcs))),
        (text.largest_error, f.number(_largest_error(optimum), digits=2)),
    ]
    if optimum.cost is not None:
        rows.append((text.cost, f.quantity(optimum.cost, "N^2 s")))
    if optimum.weights:
        rows.append((text.weights, _listed(optimum.weights, f)))
    for key, value in asdict(optimum.certificate).items():
        rows.append((text.name(key), _evidence(key, value, f)))
    return [row for row in rows if row[1]]


def _changes(arcs: list[ArcEntry]) -> list[float]:
    """Return when the kind of control changes [s]; arcs within the force bound run into another."""
    return [arc.t_end for arc, after in pairwise(arcs) if arc.control != after.control]


def _largest_error(optimum: OptimumEntry) -> float:
    return max(
        (
            abs(error) / optimum.peaks[state]
            for state, error in optimum.terminal_error.items()
            if optimum.peaks.get(state)
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
    return "; ".join(f"{polish(name)} = {f.number(value)}" for name, value in values.items())


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
