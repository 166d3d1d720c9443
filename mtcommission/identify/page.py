"""What was identified as one HTML page: measured beside fitted, modes, and what is in doubt."""

from __future__ import annotations

from collections.abc import Sequence

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.record.identified import IdentifiedPart
from mtcommission.sheet.document import BigValue, Block, Headline, Preformatted
from mtcommission.sheet.html import set_parts
from mtcommission.sheet.identified import (
    check_table,
    file_table,
    mode_tables,
    plots,
    remarks,
    result_table,
)


def print_identified(part: IdentifiedPart, *, profile: str, language: str) -> str:
    """Return the page, which works offline."""
    words = Catalogue(language, rotary=part.rotary)
    say = words.text
    parts: dict[str, Sequence[Block]] = {
        "result": (_headline(part, words), result_table(part, words)),
        "modes": mode_tables(part, words, inside={}),
        "fits": plots(part, words),
        "doubts": remarks(part, words),
        "check": (check_table(part, words),) if part.checks else (),
        "sources": (file_table(part, words),),
        "profile": (Preformatted(caption=say("identify-part-profile"), text=profile),),
    }
    return set_parts(
        words,
        "identify",
        parts,
        machine=say("identify-document-name"),
        axis=part.created[:10],
        identity=", ".join(state.name for state in part.states),
        created=part.created,
        disclaimer=say("identify-page-note"),
    )


def _headline(part: IdentifiedPart, words: Catalogue) -> Headline:
    count = len(part.modes)
    files = {one.sha256 for one in part.sources}
    return Headline(
        is_met=bool(count),
        verdict=words.text("identify-verdict", modes=count)
        if count
        else words.text("identify-verdict-none"),
        detail=words.text("identify-detail", states=len(part.states), files=len(files)),
        values=tuple(
            BigValue(
                label=mode.name,
                value=words.format.quantity(mode.frequency_hz.value, "Hz"),
                aside=f"– ζ = {words.format.number(mode.damping_ratio.value, digits=3)}",
            )
            for mode in part.modes[:4]
        ),
    )
