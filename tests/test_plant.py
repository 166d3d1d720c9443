"""The plant must be the paper's equation (1), and the modal kind its definition."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.plant.plant import build_plant, kalman_rank
from tests.independent_loop import axis_of
from tests.machines import paper_machine, random_modal_machine


def test_equation_1_of_the_paper_row_by_row() -> None:
    m_b, m_s, J, r, h = 450.0, 750.0, 40.0, 0.25, 0.21
    k_b, d_b, k, d, T = 44.41e6, 8500.0, 8.2e6, 1800.0, 2.5e-3
    plant = build_plant(paper_machine())
    A = np.array(
        [
            [0, 0, 0, 1, 0, 0, 0],
            [0, 0, 0, 0, 1, 0, 0],
            [0, 0, 0, 0, 0, 1, 0],
            [-k_b / m_b, 0, 0, -d_b / m_b, 0, 0, -1 / m_b],
            [0, 0, 0, 0, 0, 0, 1 / m_s],
            [0, 0, -k / J, 0, 0, -d / J, r / J],
            [0, 0, 0, 0, 0, 0, -1 / T],
        ]
    )
    assert plant.states == ("x_b", "x_s", "phi", "v_b", "v_s", "v_phi", "F")
    assert np.allclose(plant.A, A, rtol=1e-12)
    assert np.allclose(plant.B, [0, 0, 0, 0, 0, 0, 1 / T], rtol=1e-12)
    assert np.allclose(plant.row("tcp"), [-1, 1, h, 0, 0, 0, 0], rtol=1e-12)
    assert np.allclose(plant.row("encoder"), [-1, 1, 0, 0, 0, 0, 0], rtol=1e-12)
    assert np.allclose(plant.row("tcp_vibration"), [-1, 0, h, 0, 0, 0, 0], rtol=1e-12)


def test_poles_of_the_notes_to_the_paper() -> None:
    poles = np.linalg.eigvals(build_plant(paper_machine()).A)
    for pole in (-400.0, -9.444 + 314.006j, -9.444 - 314.006j, -22.5 + 452.210j, -22.5 - 452.21j):
        assert np.min(np.abs(poles - pole)) < 1e-3
    assert np.sum(np.abs(poles) < 1e-6) == 2


@given(seed=st.integers(0, 10_000), n_modes=st.integers(1, 4))
@settings(max_examples=40, deadline=None)
def test_modal_axes_are_controllable_and_follow_their_definition(seed: int, n_modes: int) -> None:
    """q'' + 2 ζ ω q' + ω² q = F, tool = x + sum of gains times q, checked on random states."""
    machine = random_modal_machine(seed, n_modes=n_modes)
    mechanics = machine.mechanics
    assert isinstance(mechanics, Modal)
    plant = build_plant(machine)
    state = np.random.default_rng(seed).normal(size=plant.order)
    slope = plant.A @ state
    x, v, F = state[0], state[1], state[-1]
    assert slope[0] == v
    assert slope[1] == pytest.approx(F / mechanics.moving_mass)
    tool, encoder = x, x
    for i, mode in enumerate(mechanics.modes):
        q, rate = state[2 + 2 * i : 4 + 2 * i]
        omega = mode.natural_frequency
        assert slope[2 + 2 * i] == rate
        expected = F - 2 * mode.damping_ratio * omega * rate - omega**2 * q
        assert slope[3 + 2 * i] == pytest.approx(expected, rel=1e-9, abs=1e-9 * omega**2)
        tool += mode.tcp_gain * q
        encoder += mode.measured_gain * q
    assert plant.row("tcp") @ state == pytest.approx(tool)
    assert plant.row("encoder") @ state == pytest.approx(encoder)
    frequencies = [mode.natural_frequency for mode in mechanics.modes]
    apart = min(np.diff(sorted(frequencies)) / frequencies[0], default=1.0)
    if n_modes <= 3 and apart > 0.1:
        assert kalman_rank(plant) == plant.order


def test_both_programs_have_the_same_static_deflection() -> None:
    """x = 0, F constant: the modes bend by F/ω², the tool by the sum of their gains."""
    machine = paper_machine()
    plant = build_plant(machine)
    parts = machine.mechanics
    assert isinstance(parts, Manipulator)
    F = 1000.0
    tool = (
        F / parts.base_stiffness + parts.tcp_height * parts.lever_arm * F / parts.rotary_stiffness
    )
    state = np.zeros(7)
    state[0], state[2] = -F / parts.base_stiffness, parts.lever_arm * F / parts.rotary_stiffness
    state[6] = F
    assert np.allclose((plant.A @ state)[[3, 5]], 0.0, atol=1e-12)
    assert plant.row("tcp_vibration") @ state == pytest.approx(tool)
    axis = axis_of(machine)
    assert sum(m.tool * F / abs(m.pole) ** 2 for m in axis.modes) == pytest.approx(tool)


def test_equal_poles_are_a_named_outcome() -> None:
    mode = FlexibleMode(name="a", natural_frequency=2 * pi * 40, damping_ratio=0.02, tcp_gain=1e-3)
    twin = replace(mode, name="b", tcp_gain=-2e-3)
    machine = replace(paper_machine(), mechanics=Modal(moving_mass=300.0, modes=(mode, twin)))
    with pytest.raises(ComputationError, match="modes a and b at 40 Hz") as caught:
        build_plant(machine)
    assert caught.value.outcome is Outcome.EQUAL_POLES
    other = replace(twin, damping_ratio=0.03)
    apart = replace(machine, mechanics=Modal(moving_mass=300.0, modes=(mode, other)))
    assert kalman_rank(build_plant(apart)) == 7


def test_a_tower_that_no_force_turns_is_a_named_outcome() -> None:
    machine = paper_machine()
    parts = machine.mechanics
    assert isinstance(parts, Manipulator)
    with pytest.raises(ComputationError) as caught:
        build_plant(replace(machine, mechanics=replace(parts, lever_arm=0.0)))
    assert caught.value.outcome is Outcome.NOT_CONTROLLABLE


@pytest.mark.parametrize("zeta", [0.02, 0.9, 1.25])
def test_a_mode_s_pole_solves_its_equation(zeta: float) -> None:
    """A damping ratio of 0.65, times 1.7 in the study of damping, ended ``run`` in a fault."""
    mode = FlexibleMode(name="a", natural_frequency=250.0, damping_ratio=zeta, tcp_gain=1e-3)
    slower = max(
        np.roots([1.0, 2.0 * zeta * 250.0, 250.0**2]), key=lambda one: (one.real, one.imag)
    )
    assert mode.pole == pytest.approx(slower, rel=1e-9)
