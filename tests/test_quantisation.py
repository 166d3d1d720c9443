"""What is taken off band and force for the steps of an encoder must cover what they do."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.population import random_machine
from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.disturbance import encoder_noise
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import Positioning
from tests.independent_loop import profile_of, quiet_copy, run
from tests.machines import paper_machine

Array = NDArray[np.float64]

NOTCH = ForceFilter(kind="notch", natural_frequency=2 * pi * 150.0, damping=0.2)
LOW_PASS = ForceFilter(kind="low_pass", natural_frequency=2 * pi * 900.0, damping=0.7)

TRAVEL = Positioning(distance=3e-3, max_velocity=0.05)

REST = 0.2
"""From then on after the end only the encoder still moves the axis [s]."""


def member(seed: int) -> Machine:
    """Every position loop, with filters, reference models and, the first one, state feedback."""
    if seed == 0:
        return paper_machine()
    machine = random_machine(seed)
    return quiet_copy(
        machine,
        position_loop=list(PositionLoop)[seed % 3],
        force_filters=((), (NOTCH,), (LOW_PASS,), (NOTCH, LOW_PASS))[seed % 4],
        reference_model_time=machine.drive.force_lag if seed % 5 == 0 else 0.0,
    )


def tremble(seed: int) -> tuple[float, float, Array, Array, Array]:
    """Noise of tool and force, then what rounding does to both, as shares of it, and the times.

    Times are counted from the end of the setpoint.
    """
    generator = np.random.default_rng(seed)
    machine = member(seed)
    tuned = tune_loop(machine)
    gains, q = tuned.controller, float(10 ** generator.uniform(-9.0, -5.5))
    found = encoder_noise(tuned.loops[0], resolution=q)
    a = 0.5 * machine.drive.motion_force / moving_mass(machine)
    profile = profile_of(TRAVEL, a, a / 0.02)
    samples = int((profile.end + 0.7) / gains.velocity_cycle)
    perfect, rounded = (
        run(
            machine,
            gains,
            profile,
            nominal=machine,
            samples=samples,
            resolution=step,
            phase=float(generator.uniform()),
        )
        for step in (0.0, q)
    )
    tool = np.abs(rounded.tool - perfect.tool) / found.tool
    force = np.abs(rounded.force - perfect.force) / found.force
    return found.tool / q, found.force, tool, force, perfect.t - profile.end


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 5])
def test_rounding_stays_within_the_noise_that_is_counted(seed):
    """Limits would fill a band that a coarse encoder then leaves, or a force that it exceeds."""
    steps, _, tool, force, t = tremble(seed)
    for part in (t < 0.0, t > REST):
        assert np.mean(tool[part] <= 1.0) >= 0.99
        assert np.mean(force[part] <= 1.0) >= 0.99
    # And not by luck of a bound that covers anything.
    assert np.max(tool) > 0.05
    assert np.max(force) > 0.5
    assert steps < 10.0
