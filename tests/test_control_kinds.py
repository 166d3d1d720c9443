"""What controls have: docs/controls.md says for each entry where it was read, and the program
tunes, simulates and exports just that.

If one of these fails, a user is promised something that nobody has read of his control.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import ControlKind, FilterChoice, PositionLoop
from mtcommission.controls.kinds import GENERIC, KINDS, STATE_SPACE
from mtcommission.export.catalogue import CONTROL_KEYS
from mtcommission.machine.profile.read import parse_profile
from tests.test_profile import MANIPULATOR

PRODUCTS = [kind for kind in KINDS.values() if kind not in (GENERIC, STATE_SPACE)]

PAGE = (Path(__file__).parent.parent / "docs" / "controls.md").read_text("utf-8")

LISTED = (
    *("acceleration", "jerk", "modes", "setpoint_filters", "velocity_feedforward"),
    *("acceleration_feedforward", "jerk_feedforward", "reference_delay", "position_loops"),
    *("position_cycle", "velocity_cycle", "position_gain", "velocity_gain", "force_filters"),
    "state_feedback",
)
"""What there must be evidence for, of every control."""


@pytest.mark.parametrize("kind", PRODUCTS, ids=lambda kind: kind.key)
def test_a_control_has_what_the_page_shows_with_source_or_mark(kind):
    """A feature that is used needs a parameter to set, or a remark that says why there is none."""
    name = Catalogue().say(Message(f"control-{kind.key}"))
    found = {what.replace(" ", "_"): rest for what, *rest in _read(f"{kind.key}: {name}")}
    assert tuple(found) == LISTED
    places = {number for number, *_ in _read("Sources")}
    for feature, (has, parameters, remark, source) in found.items():
        assert has == _has(kind, feature), feature
        assert source.endswith("(?)") or re.match(r"\[\d+\]", source), feature
        assert set(re.findall(r"\[(\d+)\]", source)) <= places, feature
        if hasattr(kind, feature):
            assert source.endswith("(?)") == (feature in kind.unread), feature
        if "feedforward" in feature or feature in ("reference_delay", "jerk"):
            is_set = getattr(kind, feature) is True and feature != "velocity_feedforward"
            assert parameters or (remark and not is_set), feature


def _read(title: str) -> list[list[str]]:
    """The cells of the table of a section, without its head."""
    _, _, section = PAGE.partition(f"## {title}\n")
    lines = [line for line in section.partition("\n## ")[0].splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line[2:-2].split(" | ")] for line in lines[2:]]


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


@pytest.mark.parametrize("key", KINDS)
def test_every_kind_of_control_can_be_named_in_a_profile_and_exported(key):
    """Its own defaults fit together: cycles, position loop, feed-forward, delay."""
    control = parse_profile(f'{MANIPULATOR}[control]\nkind = "{key}"\n', where="p.toml").control
    assert control.kind is KINDS[key]
    assert (key in CONTROL_KEYS) == (control.kind is not STATE_SPACE)
    assert control.position_loop is control.kind.position_loops[0]
    for one in ("position_cycle", "velocity_cycle", "velocity_feedforward"):
        assert getattr(control, one) == getattr(control.kind, one), one
    assert (control.reference_delay == 0.0) is (control.kind.reference_delay is False)
