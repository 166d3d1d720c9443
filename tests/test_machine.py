"""Corners must be exactly the combinations that the requirements state."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.machine.checks import list_neglected
from mtcommission.machine.machine import NOMINAL, Corner, corners, moving_mass, vary
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.record.machine import list_assumed
from tests.machines import paper_machine, random_modal_machine

MACHINES = [paper_machine(), random_modal_machine(3, n_modes=3)]


@pytest.mark.parametrize("machine", MACHINES)
@given(
    payload=st.floats(0.0, 200.0),
    frequency=st.floats(0.5, 1.5),
    damping=st.floats(0.2, 3.0),
)
def test_a_corner_scales_frequencies_and_keeps_damping_ratios(
    machine,
    payload,
    frequency,
    damping,  # type: ignore[no-untyped-def]
):
    """A frequency spread must act through stiffness: the poles scale as a whole."""
    corner = Corner(payload=payload, frequency_factor=frequency, damping_factor=damping)
    varied = vary(machine, corner)
    assert moving_mass(varied) == pytest.approx(moving_mass(machine) + payload)
    for before, after in zip(machine.mechanics.modes, varied.mechanics.modes, strict=True):
        assert after.natural_frequency == pytest.approx(frequency * before.natural_frequency)
        assert after.damping_ratio == pytest.approx(damping * before.damping_ratio)
        assert after.tcp_gain == before.tcp_gain
    same_damping = vary(machine, replace(corner, damping_factor=1.0))
    poles = np.array([mode.pole for mode in build_plant(machine).modes])
    scaled = np.array([mode.pole for mode in build_plant(same_damping).modes])
    assert np.allclose(scaled, frequency * poles, rtol=1e-12)


def test_payload_turns_the_tower_only_with_a_radius():
    """The definition: payload adds to the inertia only if payload_radius is given."""
    machine, corner = paper_machine(), Corner(payload=100.0)
    parts = vary(machine, corner).mechanics
    assert isinstance(parts, Manipulator)
    assert parts.rotary_inertia == 40.0
    away = replace(machine, requirements=replace(machine.requirements, payload_radius=0.3))
    parts = vary(away, corner).mechanics
    assert isinstance(parts, Manipulator)
    assert parts.rotary_inertia == pytest.approx(40.0 + 100.0 * 0.3**2)


def test_corners_are_enumerated_with_the_nominal_machine_first():
    spreads = {"payload": (20.0, 100.0), "frequency_spread": 0.05, "damping_spread": 0.3}
    needs = replace(paper_machine().requirements, **spreads)
    first, *outer = corners(replace(paper_machine(), requirements=needs))
    assert first == NOMINAL
    found = [(c.payload, c.frequency_factor, c.damping_factor) for c in outer]
    assert sorted(found) == sorted(product((20.0, 100.0), (0.95, 1.05), (0.7, 1.3)))


def test_what_nobody_stated_is_said_by_its_name_and_value():
    """A profile of the least keys rests on all of it; its sheet says the same in the same words."""
    profile = read_shipped("milling-manipulator")
    plant, words = build_plant(profile.machine), Catalogue()
    said = list_assumed(profile.machine, plant, profile.text, words)
    assert [one.replace("\u202f", " ") for one in said[:2]] == [
        "Frequency spread = 5 %",
        "Damping spread = 30 %",
    ]
    assert "Place of the position loop = in the control" in said
    assert not any(one.startswith("Base mass") for one in said)
    assert said[-1].startswith("tcp_height: the tool stands above the rotary joint")


def test_the_encoder_is_neglected_until_its_resolution_is_stated():
    machine = paper_machine()
    fine = replace(machine, drive=replace(machine.drive, encoder_resolution=1e-7))
    gone = {one.kind for one in list_neglected(machine)} - {
        one.kind for one in list_neglected(fine)
    }
    assert gone == {"neglected-encoder"}
