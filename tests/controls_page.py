"""Writes docs/controls.md from the tables of the kinds: ``python -m tests.controls_page``."""

from __future__ import annotations

from pathlib import Path

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import (
    FEATURES,
    ControlKind,
    Feature,
    FilterChoice,
    PositionLoop,
)
from mtcommission.controls.kinds import ADDRESSES, GENERIC, KINDS, STATE_SPACE

PAGE = Path(__file__).parent.parent / "docs" / "controls.md"

HEAD = """\
# What each kind of control has

`control.kind` of a profile names the control. What it lacks is neither tuned nor simulated nor
exported, and asking for it is a fault with its line. This page is written from the tables in
`mtcommission/controls/makers/` by `python -m tests.controls_page`; a test holds both together.

"(?)" stands behind what was not read in a maker's text or source file: check it against the manual
of your software version. Excerpts were read, in November 2026, not whole manuals.

| where the position loop closes | what that means |
|---|---|
| `control` | in the control at the position cycle; what it hands down is held |
| `interpolated` | the same, but feed-forward is interpolated at the velocity cycle |
| `drive` | in the drive at the velocity cycle, setpoint and feed-forward interpolated (DSC) |

The first one of each kind is what it does unless `control.position_loop` says otherwise.

Two kinds are no products. `generic` is the cascade that most of them can be set to: limit of the
jerk, moving average, velocity and force feed-forward, balanced setpoint, eight filters in the
torque setpoint, the position loop anywhere. No single product below has all of it, so choose
yours before you type in values. `state-space` is a free controller: jerk feed-forward, and states
fed back through an observer.
"""


def write_page() -> str:
    """Return the page."""
    parts = [HEAD]
    parts += [_kind_part(kind) for kind in KINDS.values() if kind not in (GENERIC, STATE_SPACE)]
    rows = [f"| {n} | {title} | {ADDRESSES[title]} |" for n, title in enumerate(ADDRESSES, start=1)]
    parts += ["## Sources\n", "| | source | place |", "|--:|---|---|", *rows, ""]
    return "\n".join(parts)


def number_sources(feature: Feature) -> str:
    """Return the sources of a feature by their numbers on the page; fails if one has no place."""
    numbers = []
    for part in filter(None, feature.source.split("; ")):
        number, title = next(
            (n, title) for n, title in enumerate(ADDRESSES, start=1) if part.startswith(title)
        )
        numbers.append(f"[{number}]{part.removeprefix(title).lstrip(',')}")
    return " ".join([*numbers, feature.mark]).strip()


def _kind_part(kind: ControlKind) -> str:
    rows = [f"## {kind.key}: {Catalogue().say(Message(f'control-{kind.key}'))}\n"]
    rows += ["| what | has | parameters | remark | source |", "|---|---|---|---|---|"]
    for name in FEATURES:
        one = kind.features[name]
        shown = [one.parameters, one.note, number_sources(one)]
        cells = [name.replace("_", " "), _has(kind, name), *shown]
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n"


def _has(kind: ControlKind, name: str) -> str:
    """What the tuned and simulated loop takes from the table."""
    value = getattr(kind, name, None)
    match value:
        case None:
            return ""
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{1e3 * value:g} ms"
        case tuple():
            return ", ".join(_word(item) for item in value) or "none"
    return str(getattr(value, "value", value))


def _word(item: object) -> str:
    match item:
        case PositionLoop():
            return item.value
        case FilterChoice(kind=kind) if not item.advised_cycles:
            return f"{kind} (never chosen)"
        case FilterChoice(kind=kind) if item.least_cycles:
            most = min(item.most_cycles, item.advised_cycles)
            return f"{kind} ({item.least_cycles:g} to {most:g} position cycles)"
    return str(getattr(item, "kind", item))


if __name__ == "__main__":
    PAGE.write_text(write_page(), encoding="utf-8")
