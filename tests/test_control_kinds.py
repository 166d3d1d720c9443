"""What controls have: every entry with its evidence, and the page that says it to readers.

If one of these fails, a user is promised something that nobody has read of his control.
"""

from __future__ import annotations

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.kind import FEATURES, ControlKind
from mtcommission.controls.kinds import GENERIC, KINDS, STATE_SPACE
from mtcommission.export.catalogue import CONTROL_KEYS
from mtcommission.machine.basis import describe_kind
from mtcommission.machine.profile.read import parse_profile
from tests.controls_page import PAGE, number_sources, write_page
from tests.test_profile import MANIPULATOR

PRODUCTS = [kind for kind in KINDS.values() if kind not in (GENERIC, STATE_SPACE)]


@pytest.mark.parametrize("kind", PRODUCTS, ids=lambda kind: kind.key)
def test_no_entry_without_source_or_mark(kind: ControlKind) -> None:
    assert set(kind.features) == set(FEATURES)
    for name, feature in kind.features.items():
        assert number_sources(feature), name
        assert feature.source or not feature.is_verified, name


@pytest.mark.parametrize("kind", PRODUCTS, ids=lambda kind: kind.key)
def test_what_a_control_has_is_named_in_its_own_words(kind: ControlKind) -> None:
    """A feature that is used needs a parameter to set, or a remark that says why there is none."""
    for name in ("velocity_feedforward", "acceleration_feedforward", "reference_delay", "jerk"):
        feature = kind.features[name]
        assert feature.parameters or feature.note, name
        if name != "velocity_feedforward" and getattr(kind, name) is True:
            assert feature.parameters, name


def test_the_page_says_what_the_tables_say() -> None:
    assert PAGE.read_text("utf-8") == write_page(), "run: python -m tests.controls_page"


def test_what_was_not_read_is_marked_and_what_is_missing_is_said() -> None:
    said = Catalogue().say(describe_kind(KINDS["fanuc"]))
    assert said == (
        "has jerk limit, setpoint filter (?), velocity feed-forward (?), force feed-forward (?), "
        "5 filters in the force setpoint (?); lacks jerk feed-forward (?), balancing of the "
        "setpoint (?), state feedback (?)"
    )
    assert "lacks" not in Catalogue().say(describe_kind(STATE_SPACE))


@pytest.mark.parametrize("key", KINDS)
def test_every_kind_of_control_can_be_named_in_a_profile_and_exported(key: str) -> None:
    """Its own defaults fit together: cycles, position loop, feed-forward, delay."""
    control = parse_profile(f'{MANIPULATOR}[control]\nkind = "{key}"\n', where="p.toml").control
    assert control.kind is KINDS[key]
    assert (key in CONTROL_KEYS) == (control.kind is not STATE_SPACE)
