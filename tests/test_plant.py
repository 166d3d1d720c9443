"""The plant must be the paper's equation (1), and the modal kind its definition."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.plant.plant import build_plant, kalman_rank
from tests.independent_loop import axis_of
from tests.machines import paper_machine, random_modal_machine

MACHINES = [paper_machine(), *(random_modal_machine(n, n_modes=n) for n in (1, 3, 4))]


@pytest.mark.parametrize("machine", MACHINES)
def test_plants_are_those_that_the_second_program_writes_down(machine):
    """Equation (1) of the paper; q'' + 2 ζ ω q' + ω² q = F, tool = x + sum of gains times q."""
    plant, axis = build_plant(machine), axis_of(machine)
    np.testing.assert_allclose(plant.A, axis.A, rtol=1e-12)
    np.testing.assert_allclose(plant.B, axis.B, rtol=1e-12)
    assert plant.row("tcp") == pytest.approx(axis.tool, rel=1e-12)
    assert plant.row("encoder") == pytest.approx(axis.encoder, rel=1e-12)
    assert plant.row("tcp_vibration")[[plant.position, plant.velocity]].tolist() == [0.0, 0.0]
    assert kalman_rank(plant) == plant.order


def test_poles_of_the_notes_to_the_paper():
    poles = np.linalg.eigvals(build_plant(paper_machine()).A)
    for pole in (-400.0, -9.444 + 314.006j, -9.444 - 314.006j, -22.5 + 452.210j, -22.5 - 452.21j):
        assert np.min(np.abs(poles - pole)) < 1e-3
    assert np.sum(np.abs(poles) < 1e-6) == 2


def test_equal_poles_are_a_named_outcome():
    mode = FlexibleMode(name="a", natural_frequency=2 * pi * 40, damping_ratio=0.02, tcp_gain=1e-3)
    twin = replace(mode, name="b", tcp_gain=-2e-3)
    machine = replace(paper_machine(), mechanics=Modal(moving_mass=300.0, modes=(mode, twin)))
    with pytest.raises(ComputationError, match="modes a and b at 40 Hz") as caught:
        build_plant(machine)
    assert caught.value.outcome is Outcome.EQUAL_POLES
    other = replace(twin, damping_ratio=0.03)
    apart = replace(machine, mechanics=Modal(moving_mass=300.0, modes=(mode, other)))
    assert kalman_rank(build_plant(apart)) == 7


def test_a_tower_that_no_force_turns_is_a_named_outcome():
    machine = paper_machine()
    parts = machine.mechanics
    assert isinstance(parts, Manipulator)
    with pytest.raises(ComputationError) as caught:
        build_plant(replace(machine, mechanics=replace(parts, lever_arm=0.0)))
    assert caught.value.outcome is Outcome.NOT_CONTROLLABLE


@pytest.mark.parametrize("zeta", [0.02, 0.9, 1.25])
def test_a_mode_s_pole_solves_its_equation(zeta):
    """A damping ratio of 0.65, times 1.7 in the study of damping, ended ``run`` in a fault."""
    mode = FlexibleMode(name="a", natural_frequency=250.0, damping_ratio=zeta, tcp_gain=1e-3)
    slower = max(
        np.roots([1.0, 2.0 * zeta * 250.0, 250.0**2]), key=lambda one: (one.real, one.imag)
    )
    assert mode.pole == pytest.approx(slower, rel=1e-9)
