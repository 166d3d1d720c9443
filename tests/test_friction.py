"""Friction in the loop: against closed forms, and against a smooth model in another solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mtcommission.loop.simulate import find_friction
from mtcommission.machine.drive import Drive
from mtcommission.machine.plant.plant import build_plant
from tests.machines import paper_machine

STEP = 125e-6


def coast(coulomb: float, viscous: float, v: float, force: float, until: float) -> np.ndarray:
    """Velocity of the slider under a constant force from a velocity on, modes left out."""
    machine = paper_machine()
    plant = build_plant(machine)
    rubs = find_friction(plant, coulomb=coulomb, viscous=viscous, step=STEP)
    m, found = plant.moving_mass, [v]
    stiff = replace(rubs, velocity=np.eye(plant.order)[plant.velocity],
                    push=np.eye(plant.order)[plant.velocity] * STEP / m)  # fmt: skip
    for _ in range(round(until / STEP)):
        x = np.zeros((1, plant.order))
        x[0, plant.velocity] = found[-1] + STEP / m * force
        x += stiff.force(x)[:, None] * stiff.push
        found.append(float(x[0, plant.velocity]))
    return np.array(found)


def test_an_axis_sticks_under_less_than_coulomb_friction_and_slides_under_more():
    assert np.all(coast(100.0, 0.0, 0.0, 99.0, 0.2) == 0.0)
    m = build_plant(paper_machine()).moving_mass
    v = coast(100.0, 0.0, 0.0, 130.0, 0.2)
    assert v[-1] == pytest.approx(30.0 / m * 0.2, rel=1e-9)


def test_a_smooth_model_in_another_solver_agrees():
    """There and back under a force that changes sign: tanh at 1 um/s, Radau."""
    m, coulomb, viscous = build_plant(paper_machine()).moving_mass, 80.0, 400.0

    def rate(t, v):
        force = 300.0 * np.sign(np.sin(2.0 * np.pi * t / 0.4))
        return (force - coulomb * np.tanh(v / 1e-6) - viscous * v) / m

    smooth = solve_ivp(rate, (0.0, 0.8), [0.0], method="Radau", max_step=1e-3, rtol=1e-8, atol=1e-9)
    pieces, v = [], 0.0
    for half in range(4):
        own = coast(coulomb, viscous, v, 300.0 * (-1.0) ** half, 0.2)
        pieces.append(own[:-1])
        v = float(own[-1])
    ours = np.concatenate(pieces)
    t = STEP * np.arange(ours.size)
    assert ours == pytest.approx(np.interp(t, smooth.t, smooth.y[0]), abs=1e-4)


def test_coulomb_friction_takes_its_amount_from_the_force():
    drive = Drive(force_lag=1e-3, max_force=2000.0, static_load=-300.0, coulomb_friction=150.0)
    assert (drive.usable_force, drive.motion_force) == (1700.0, 1550.0)
