"""Certificates, assumptions, warnings, and the versions that computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from itertools import pairwise

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import symbol
from mtcommission.record.schema.optima import ArcEntry, OptimumEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Words
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
from mtcommission.sheet.settings_part import settings
from mtcommission.sheet.verdict_part import move_title


def certificates(record: Record, words: Catalogue) -> Section:
    """Return certificates, assumptions, warnings and numerical settings."""
    text = words.text
    tables: list[Block] = []
    for number, optima in enumerate(record.optima, start=1):
        title = move_title(optima.move, number, words)
        for name, _, optimum in named_optima(optima, words):
            caption = text("certificate-caption", move=title, what=name)
            tables.append(
                _pairs(caption, text("quantity"), _certificate_rows(optimum, words), words)
            )
    return Section(
        key="certificates",
        heading=text("evidence-heading"),
        blocks=(
            Subheading(text=text("assumptions")),
            _sentences(record.assumptions, Tone.PLAIN, words),
            Subheading(text=text("warnings")),
            _sentences(record.warnings, Tone.WARNING, words),
            *tables,
            *settings(record, words),
        ),
        is_appendix=True,
    )


def versions(record: Record, words: Catalogue) -> Section:
    """Return program, libraries, hash and text of the profile."""
    text, tool, profile = words.text, record.tool, record.profile
    rows = [
        (tool.name, tool.version),
        *tool.libraries.items(),
        (text("created"), record.created),
    ]
    return Section(
        key="versions",
        heading=text("versions-heading"),
        blocks=(
            _pairs(text("versions-caption"), text("program"), rows, words),
            Paragraph(text=f"{text('hash-row')}:"),
            Paragraph(text=profile.sha256, tone=Tone.CODE),
            Preformatted(caption=text("profile-caption", name=profile.name), text=profile.text),
        ),
        is_appendix=True,
    )


def _certificate_rows(optimum: OptimumEntry, words: Catalogue) -> list[tuple[str, str]]:
    text, f = words.text, words.format
    rows = [
        (text("final-time"), f.quantity(optimum.t_f, "s")),
        (text("method"), words.known(f"method-{optimum.method}", optimum.method)),
        (text("switches"), ", ".join(f.quantity(t, "s") for t in _changes(optimum.arcs))),
        (text("largest-error"), f.number(_largest_error(optimum), digits=2)),
    ]
    if optimum.cost is not None:
        unit = "N^2 m^2 s" if words.rotary else "N^2 s"
        rows.append((text("cost"), f.quantity(optimum.cost, unit)))
    if optimum.weights:
        rows.append((text("weights"), _listed(optimum.weights, words)))
    for key, value in asdict(optimum.certificate).items():
        rows.append((words.name(key), _evidence(key, value, words)))
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
    key: str, value: float | bool | dict[str, float] | list[float] | None, words: Catalogue
) -> str:
    f = words.format
    if value is None:
        return "–"
    if isinstance(value, bool):
        return words.text("yes") if value else words.text("no")
    if isinstance(value, dict):
        return _listed(value, words)
    if isinstance(value, list):
        return "; ".join(f.number(item) for item in value)
    return f.quantity(value, "s") if key.startswith("t_f") else f.number(value)


def _listed(values: dict[str, float], words: Catalogue) -> str:
    return "; ".join(
        f"{symbol(name)} = {words.format.number(value)}" for name, value in values.items()
    )


def _sentences(items: Sequence[Words], tone: Tone, words: Catalogue) -> Block:
    if not items:
        return Paragraph(text=words.text("none"))
    return Bullets(items=tuple(words.say(item) for item in items), tone=tone)


def _pairs(caption: str, head: str, rows: list[tuple[str, str]], words: Catalogue) -> Table:
    return Table(
        caption=caption,
        columns=(Column(head=head), Column(head=words.text("value"), width=1.6)),
        rows=tuple(rows),
    )
