"""What was identified, as the terminal shows it."""

from __future__ import annotations

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.language import words
from mtcommission.cli.terminal import Line, heading, list_quantities, warn
from mtcommission.identify.identified import NOT_DESCRIBED
from mtcommission.record.identified import IdentifiedPart
from mtcommission.sheet.identified import doubts_and_notes, facts, mode_columns


def refusal(part: IdentifiedPart, *, forced: bool) -> tuple[str, ...]:
    """Return that the model does not describe what was measured, and why; nothing if it does."""
    spoken = words(rotary=part.rotary)
    doubts = [one for one in part.warnings if one.kind == NOT_DESCRIBED]
    kind = "identify-forced" if forced else "identify-no-profile"
    heads = [spoken.text(kind, **one.values) for one in doubts[:1]]
    return (*heads, *map(spoken.say, doubts))


def describe_identified(part: IdentifiedPart, *, forced: bool) -> list[Line]:
    """Return mass, delay, modes, spreads, the check of itself and what is in doubt.

    ``forced``: whether a profile is written although no model fits.
    """
    spoken = words(rotary=part.rotary)
    doubts, notes = doubts_and_notes(part)
    files = ", ".join(source.name for source in part.sources)
    columns = mode_columns(part, spoken)
    modes = list_quantities(spoken, columns, part.modes)
    return [
        *((line, "bold red") for line in refusal(part, forced=forced)),
        heading(spoken.text("identify-title-of", files=files)),
        *(f"{name}: {value} ({why})" for name, value, why in facts(part, spoken)),
        *_checks(part, spoken),
        *(["", *modes] if part.modes else []),
        spoken.text("identify-page-note"),
        *map(spoken.say, notes),
        *warn(spoken, [one for one in doubts if one.kind != NOT_DESCRIBED]),
    ]


def _checks(part: IdentifiedPart, spoken: Catalogue) -> list[str]:
    say = spoken.text
    return [
        f"{say('identify-head-explained')}: {spoken.format.percent(one.explained)}, {one.record}"
        + (f" ({say('identify-head-held-back')})" if one.held_back else "")
        for one in part.checks
    ]
