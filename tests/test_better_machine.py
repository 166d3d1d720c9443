"""A better machine never gets a recommendation that settles later."""

from __future__ import annotations

import pytest

from benchmarks.better_machine import LATER, later
from benchmarks.every_size import draw_profile
from mtcommission.machine.profile.read import parse_profile


@pytest.mark.parametrize("seed", [3])
def test_random_machines_that_are_better_settle_no_later(seed):
    """An engineer who buys a stiffer screw would be told to move more slowly."""
    found = dict(later(parse_profile(draw_profile(seed), where=f"machine {seed}")))
    assert found
    assert max(found.values()) <= LATER, found
