"""The quick verdict on margins: the same as that of the whole loop, corner by corner."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.population import random_machine
from mtcommission.loop.analysis import lay_grids
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.family import build, cascade_family, seems_to_keep, tune_shape
from mtcommission.loop.tuning.gains import (
    CLASSIC,
    Shape,
    add_state_feedback,
    build_cascade,
    design_observer,
    moving_modes,
    symmetrical_optimum,
)
from mtcommission.loop.tuning.tuned import (
    CornerPlants,
    TuningSettings,
    close_loop,
    corner_plants,
    has_margins,
)
from mtcommission.machine.control import TcpSensor
from mtcommission.machine.machine import Machine
from mtcommission.profile.read import read_profile

PROFILES = [
    path
    for path in sorted((Path(__file__).parent.parent / "profiles").glob("*.toml"))
    if not read_profile(path).drive.follows  # no loop to tune
]
LADDER = (2.0, 1.0, 0.5, 0.2)
SETTINGS = TuningSettings()


def machines() -> Iterator[Machine]:
    """Every shipped profile with all gains by rule, and random machines, half with a TCP scale."""
    for path in PROFILES:
        machine = read_profile(path)
        yield replace(machine, control=replace(machine.control, velocity_gain=None))
    for seed in range(4):
        machine = random_machine(seed)
        sensor = TcpSensor.POSITION if seed % 2 else TcpSensor.NONE
        yield replace(machine, control=replace(machine.control, tcp_sensor=sensor))


def tries(machine: Machine, bench: CornerPlants) -> Iterator[Controller]:
    """Controllers that share an observer, from far too stiff to soft."""
    first = build_cascade(machine, bench.model, fraction=1.0)
    observer = design_observer(machine, bench.model, first, settings=SETTINGS)
    damps = moving_modes(bench.model, first.sensors)
    for fraction in LADDER:
        cascade = build_cascade(machine, bench.model, fraction=fraction)
        if not damps:
            yield replace(cascade, observer=observer)
            continue
        yield add_state_feedback(machine, bench.model, cascade, weight=1.0, observer=observer)


def test_quick_verdict_is_that_of_the_whole_loop() -> None:
    """A gain would be refused that has the margins, or typed in without them."""
    kept = refused = 0
    for machine in machines():
        bench = corner_plants(machine)
        ladder = list(tries(machine, bench))
        grids = lay_grids(bench.plants, ladder[0])
        for controller in ladder:
            expected = close_loop(bench, controller).keeps_margins(SETTINGS)
            seems = all(seems_to_keep(grid, controller, SETTINGS) for grid in grids)
            assert seems is expected
            kept, refused = kept + expected, refused + (not expected)
    assert kept > 10
    assert refused > 10


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.stem)
def test_one_step_more_of_Kp_lacks_the_margins(path: Path) -> None:
    """Kp would be lower than need be, and the axis softer: seen by the whole loop."""
    machine = read_profile(path)
    free = replace(machine.control, velocity_gain=None, position_gain=None, integral_time=None)
    machine = replace(machine, control=replace(free, force_filters=(), minimum_bandwidth_hz=0.0))
    family = cascade_family(machine, SETTINGS)
    for shape in (CLASSIC, Shape(position_ratio=0.125, integral_ratio=16.0)):
        tuned = tune_shape(family, shape, largest=4.0)
        assert tuned is not None
        assert all(has_margins(item, settings=SETTINGS) for item in tuned.analyses)
        share = tuned.controller.velocity_gain / symmetrical_optimum(machine)
        assert share < 4.0
        above = build(family, shape, fraction=1.01 * share)
        analyses = close_loop(family.bench, above).analyses
        assert not all(has_margins(item, settings=SETTINGS) for item in analyses)
