"""What was identified, as the terminal shows it."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from mtcommission.cli.language import words
from mtcommission.cli.terminal import heading, warn
from mtcommission.identify.identified import NOT_DESCRIBED
from mtcommission.record.schema.identified import IdentifiedPart
from mtcommission.sheet.identified import doubts_and_notes, facts, mode_heads, mode_row


def refusal(part: IdentifiedPart, *, forced: bool) -> tuple[str, ...]:
    """Return that the model does not describe what was measured, and why; nothing if it does."""
    spoken = words(rotary=part.rotary)
    doubts = [one for one in part.warnings if one.kind == NOT_DESCRIBED]
    kind = "identify-forced" if forced else "identify-no-profile"
    heads = [spoken.text(kind, **one.values) for one in doubts[:1]]
    return (*heads, *map(spoken.say, doubts))


def describe_identified(part: IdentifiedPart, *, forced: bool) -> Group:
    """Return mass, delay, modes, spreads, the check of itself and what is in doubt.

    Parameters
    ----------
    part
        What was measured.
    forced
        Whether a profile is written although no model fits.
    """
    spoken = words(rotary=part.rotary)
    say, form = spoken.text, spoken.format
    modes = Table(box=None, pad_edge=False, header_style="bold")
    for head in mode_heads(spoken):
        modes.add_column(head, overflow="fold")
    for mode in part.modes:
        modes.add_row(*mode_row(mode, part, spoken))
    lines = [f"{name}: {value} ({why})" for name, value, why in facts(part, spoken)]
    lines += [
        f"{say('identify-head-explained')}: {form.percent(one.explained)}, {one.record}"
        + (f" ({say('identify-head-held-back')})" if one.held_back else "")
        for one in part.checks
    ]
    files = ", ".join(source.name for source in part.sources)
    parts: list[RenderableType] = [
        *(Text(line, style="bold red") for line in refusal(part, forced=forced)),
        heading(say("identify-title-of", files=files)),
        *map(Text, lines),
    ]
    if part.modes:
        parts += [Text(), modes]
    doubts, notes = doubts_and_notes(part)
    parts += [Text(say("identify-page-note")), *(Text(spoken.say(one)) for one in notes)]
    return Group(*parts, *warn(spoken, [one for one in doubts if one.kind != NOT_DESCRIBED]))
