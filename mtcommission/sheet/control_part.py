"""What the kind of control has: names and sources, and what was not read there."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.loop import FeatureEntry
from mtcommission.record.schema.record import Record
from mtcommission.sheet.basis_part import control_name
from mtcommission.sheet.model import Block, Column, Paragraph, Subheading, Table, Tone

FUNCTIONS = (
    "jerk",
    "modes",
    "setpoint_filters",
    "velocity_feedforward",
    "acceleration_feedforward",
    "jerk_feedforward",
    "reference_delay",
    "force_filters",
    "state_feedback",
)
"""What one control has and another lacks; the rest differs by name only."""


def control_has(record: Record, words: Catalogue) -> tuple[Block, ...]:
    """Return what the control has, its names for it, and sources with numbers.

    A kind that is no product has no names: then it is one sentence.
    """
    text, features = words.text, record.loop.features
    functions = [item for item in features if item.name in FUNCTIONS]
    has = [_name(item, words) for item in functions if item.has]
    lacks = [_name(item, words) for item in functions if not item.has]
    told = text("control-functions", has=", ".join(has))
    if lacks:
        told = text("control-functions-and-lacks", has=", ".join(has), lacks=", ".join(lacks))
    named = [item for item in features if item.parameters]
    sources = list(dict.fromkeys(source for item in named for source in _sources(item)))
    table = Table(
        caption=text("control-caption", control=control_name(record.loop.kind, words)),
        columns=(
            Column(head=text("quantity"), width=1.2),
            Column(head=text("control-parameters"), width=2.6),
            Column(head=text("source"), width=0.6),
        ),
        rows=tuple(
            (
                _name(item, words),
                item.parameters,
                " ".join(f"[{sources.index(one) + 1}]" for one in _sources(item)),
            )
            for item in named
        ),
    )
    listed = "; ".join(f"[{number}] {source}" for number, source in enumerate(sources, start=1))
    return (
        Subheading(text=text("control-heading")),
        Paragraph(text=told),
        *([table] if named else []),
        *([Paragraph(text=listed, tone=Tone.NOTE)] if listed else []),
    )


def _name(item: FeatureEntry, words: Catalogue) -> str:
    """The feature's name, with "(?)" where it was not read."""
    name = words.text(f"has-{item.name.replace('_', '-')}")
    return name if item.verified else f"{name} (?)"


def _sources(item: FeatureEntry) -> list[str]:
    return [source for source in item.source.split("; ") if source]
