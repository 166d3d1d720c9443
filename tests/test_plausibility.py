from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from mtcommission.machine.control import Control
from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.plausibility import check_plausibility
from mtcommission.machine.requirements import Modes
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.messages.quantities import THIN_SPACE
from mtcommission.plant.manipulator import Manipulator
from mtcommission.plant.modal import Modal
from mtcommission.profile.read import read_profile
from tests.machines import paper_machine

PROFILES = Path(__file__).parent.parent / "profiles"
PAPER = paper_machine()


def said(machine: Machine, remarks: Sequence[Message]) -> list[str]:
    catalogue = Catalogue("en", rotary=machine.motion is Motion.ROTARY)
    return [catalogue.say(remark).replace(THIN_SPACE, " ") for remark in remarks]


def remarks_on(machine: Machine) -> list[str]:
    return said(machine, check_plausibility(machine))


def with_mode(**changes: float) -> Machine:
    mode = FlexibleMode(name="column", natural_frequency=250.0, damping_ratio=0.03, tcp_gain=1e-3)
    modal = Modal(moving_mass=750.0, modes=(replace(mode, **changes),))
    return replace(PAPER, mechanics=modal)


@pytest.mark.parametrize("path", sorted(PROFILES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_shipped_machines_are_plausible(path: Path) -> None:
    assert remarks_on(read_profile(path)) == []


@pytest.mark.parametrize(
    ("changes", "remark"),
    [
        (
            {"damping_ratio": 0.35},
            "damping ratio 0.35 is above what machine structures show, 0.002 to 0.3",
        ),
        (
            {"damping_ratio": 0.0},
            "damping ratio 0 is below what machine structures show, 0.002 to 0.3",
        ),
        (
            {"natural_frequency": 628.3},
            "100 Hz is above a third",
        ),
        ({"natural_frequency": 5.0}, "0.796 Hz is slower than any machine structure"),
        ({"tcp_gain": 0.0}, "neither tool nor encoder sees it"),
        ({"tcp_gain": 1.0}, "its gain is 750 times 1/moving_mass"),
    ],
)
def test_an_unusual_mode(changes: dict[str, float], remark: str) -> None:
    machine = with_mode(**changes)
    if "third" in remark:
        machine = replace(machine, control=Control(position_cycle=4e-3))
    found = [text for text in remarks_on(machine) if remark in text]
    assert len(found) == 1
    assert found[0].startswith("mode column: ")


@pytest.mark.parametrize(
    ("position_cycle", "velocity_cycle", "expected"),
    [
        (2e-3, 125e-6, []),
        (
            4e-3,
            125e-6,
            [
                "mode rotation: one period has only 3.5 position cycles of 4 ms; "
                "a jerk time can only be set that coarsely",
            ],
        ),
        (
            5.5e-3,
            5.5e-3,
            [
                "mode base: one period has only 3.6 position cycles of 5.5 ms; "
                "a jerk time can only be set that coarsely",
                "mode rotation: 72.1 Hz is above a third of the velocity loop's sampling "
                "rate, 181.8 Hz; no feedback can damp it",
                "mode rotation: 72.1 Hz is above a third of the position loop's sampling "
                "rate, 181.8 Hz; setpoints at that cycle cannot shape it",
            ],
        ),
    ],
)
def test_cycles_too_long_for_the_modes_of_the_paper(
    position_cycle: float, velocity_cycle: float, expected: list[str]
) -> None:
    control = Control(position_cycle=position_cycle, velocity_cycle=velocity_cycle)
    assert remarks_on(replace(PAPER, control=control)) == expected


def with_drive(**changes: float) -> Machine:
    return replace(PAPER, drive=replace(PAPER.drive, **changes))


def with_needs(**changes: object) -> Machine:
    return replace(PAPER, requirements=replace(PAPER.requirements, **changes))


@pytest.mark.parametrize(
    ("machine", "expected"),
    [
        (
            with_drive(max_force=2.0),
            "Max force: 2 N on 750 kg give 2.67 mm/s², which hardly moves the axis; "
            "check both units",
        ),
        (
            replace(with_needs(tcp_deviation=1e-3), drive=replace(PAPER.drive, max_force=2e6)),
            "Max force: 2000 kN on 750 kg give 2667 m/s², which is more than a machine "
            "axis bears; check both units",
        ),
        (
            with_drive(static_load=-1200.0),
            "Static load: 1.2 kN take more than half of max_force = 2 kN; "
            "consider a counterbalance",
        ),
        (
            with_drive(continuous_force=3000.0),
            "Continuous force: 3 kN is above max_force = 2 kN, so it limits nothing; "
            "the two may be swapped",
        ),
        (
            with_drive(force_lag=0.25),
            "Time constant of the force loop T: 250 ms is long for a force loop "
            "(servo drives: 0.5 to 5 ms)",
        ),
        (
            replace(PAPER, moves=(VelocityStep(velocity_step=0.1), Positioning(distance=5e3))),
            "Move 2: a rigid axis would need 86.6 s for this move; "
            "check distance, velocity and force",
        ),
        (
            replace(PAPER, moves=(Positioning(distance=1.0, max_velocity=1e-3),)),
            "Move 1: a rigid axis would need 1×10³ s for this move; "
            "check distance, velocity and force",
        ),
        (
            with_needs(tcp_deviation=0.05),
            "Permitted TCP deviation (band): 50 mm is no accuracy at all; check the unit",
        ),
        (
            with_needs(payload=(0.0, 3000.0)),
            "the payload, 3000 kg, is more than three times the moving mass, 750 kg; "
            "one set of limits will be slow for the empty axis",
        ),
        (
            with_needs(modes=Modes(surface=20e-6, accuracy=5e-6, speed=2e-6)),
            "the bands of the machining modes, surface 2×10⁻⁵, accuracy 5×10⁻⁶ and speed 2×10⁻⁶ m, "
            "do not widen in this order; they may be swapped",
        ),
        (
            replace(PAPER, control=Control(feedforward_mass=75.0)),
            "75 kg in the feed-forward is far from the moving mass, 750 to 750 kg; "
            "the feed-forward will push too little or too much",
        ),
        (
            replace(PAPER, control=Control(position_gain=4.0)),
            "Kv = 4 1/s is only 0.24 (m/min)/mm; if 4 (m/min)/mm is meant, "
            'write the unit: "4 (m/min)/mm"',
        ),
        (
            replace(PAPER, moves=(Positioning(distance=0.02, max_velocity=30.0),)),
            "Move 1: Max velocity: 30 m/s is faster than machine axes move, 10 m/s; check the unit",
        ),
        (
            replace(PAPER, control=Control(minimum_bandwidth_hz=15e3)),
            "a least bandwidth of 1.5×10⁴ Hz is above a third of the velocity loop's "
            "sampling rate, 8000 Hz",
        ),
    ],
)
def test_one_unusual_number_one_remark(machine: Machine, expected: str) -> None:
    assert remarks_on(machine) == [expected]


def test_stiffness_a_thousand_times_too_soft_is_noticed() -> None:
    assert isinstance(PAPER.mechanics, Manipulator)
    soft = replace(PAPER.mechanics, rotary_stiffness=8.2e2, rotary_damping=18.0)
    assert any(
        "the full force bends the tool by" in text
        for text in remarks_on(replace(PAPER, mechanics=soft))
    )


def test_a_rotary_axis_is_described_in_its_own_units() -> None:
    axis = replace(PAPER, motion=Motion.ROTARY, drive=replace(PAPER.drive, max_force=2.0))
    assert remarks_on(axis) == [
        "Max torque: 2 N·m on 750 kg·m² give 0.153°/s², which hardly moves the axis; "
        "check both units"
    ]


@pytest.mark.parametrize(
    ("damping_ratio", "words"),
    [
        (0.02, []),
        (0.004, ["mode column: 15.9 Hz at a damping ratio of 0.004 rings for "]),
        (0.0, ["mode column: 15.9 Hz at a damping ratio of 0 rings for ever"]),
    ],
)
def test_a_mode_that_rings_for_long_is_announced(damping_ratio: float, words: list[str]) -> None:
    """Else nobody asks what makes a move settle so late. 4.605 / (0.004 x 100/s) = 11.5 s."""
    machine = with_mode(natural_frequency=100.0, damping_ratio=damping_ratio)
    found = [text for text in said(machine, check_plausibility(machine)) if "rings" in text]
    assert len(found) == len(words)
    assert all(text.startswith(word) for text, word in zip(found, words, strict=True))
    assert damping_ratio != 0.004 or "for 11.5 s until 1 % is left" in found[0]
