"""Kp is as large as the margins allow, seen by the whole loop."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from mtcommission.loop.tuning.family import build, cascade_family, tune_shape
from mtcommission.loop.tuning.gains import symmetrical_optimum
from mtcommission.loop.tuning.tuned import (
    CLASSIC,
    Shape,
    close_loop,
    has_margins,
)
from mtcommission.machine.profile.read import read_profile

PROFILES = [
    path
    for path in sorted((Path(__file__).parent.parent / "profiles").glob("*.toml"))
    if not read_profile(path).drive.follows  # no loop to tune
]


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.stem)
def test_one_step_more_of_Kp_lacks_the_margins(path: Path) -> None:
    """Kp would be lower than need be, and the axis softer: seen by the whole loop."""
    machine = read_profile(path)
    free = replace(machine.control, velocity_gain=None, position_gain=None, integral_time=None)
    machine = replace(machine, control=replace(free, force_filters=(), minimum_bandwidth_hz=0.0))
    family = cascade_family(machine)
    for shape in (CLASSIC, Shape(position_ratio=0.125, integral_ratio=16.0)):
        tuned = tune_shape(family, shape, largest=4.0)
        assert tuned is not None
        assert all(has_margins(item) for item in tuned.analyses)
        share = tuned.controller.velocity_gain / symmetrical_optimum(machine)
        assert share < 4.0
        above = build(family, shape, fraction=1.01 * share)
        analyses = close_loop(family.bench, above).analyses
        assert not all(has_margins(item) for item in analyses)
