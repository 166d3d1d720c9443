"""What single changes of the machine or its control would bring, ranked."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema import ImprovementEntry, Record
from mtcommission.sheet.model import Block, Column, Paragraph, Section, Table, Tone
from mtcommission.sheet.values import settling


def improvements(record: Record, words: Catalogue) -> tuple[Section, ...]:
    """Return the changes, the one that brings most first; nothing where none was looked at."""
    text, found = words.text, record.limits.would_bring
    if not found:
        return ()
    gains = [item for item in found if item.saved is None or item.saved > 0.0]
    rest = [words.say(item.change) for item in found if item not in gains]
    table = Table(
        caption=text("improvements-caption"),
        columns=(
            Column(head=text("improvement"), width=3.2),
            Column(head=text("settling-time"), is_number=True),
            Column(head=text("improvement-saved"), is_number=True),
            Column(head=text("improvement-share"), is_number=True),
            Column(head=text("meets"), width=2.2),
        ),
        rows=tuple(_row(item, words) for item in gains),
    )
    note = Paragraph(text=text("improvements-note"), tone=Tone.NOTE)
    blocks: tuple[Block, ...] = (note, table) if gains else (note,)
    if rest:
        blocks += (Paragraph(text=text("improvements-none", changes=", ".join(rest))),)
    return (Section(key="improvements", heading=text("improvements-heading"), blocks=blocks),)


def _row(item: ImprovementEntry, words: Catalogue) -> tuple[str, ...]:
    text, f = words.text, words.format
    change = words.say(item.change)
    judged = words.say(item.outcome) or text("yes" if item.meets_requirements else "no")
    if item.settling_time is None and item.outcome:
        return (change, "–", "–", "–", judged)
    share = "–" if item.share is None else f.signed_percent(-item.share)
    return (
        change,
        settling(item.settling_time, words),
        f.quantity(item.saved, "s"),
        share,
        judged,
    )
