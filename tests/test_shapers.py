"""Input shapers: their zeros, their setpoints, and their place in the comparison."""

from __future__ import annotations

from cmath import exp
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Control, Positioning, StateFeedback, VelocityStep
from mtcommission.messages.catalogue import Catalogue
from mtcommission.plant.plant import PlantMode, build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint, sample_setpoint
from mtcommission.study.shapers import Shaper, compare_shapers, design_shapers, shape_setpoint
from tests.machines import paper_machine


def mode(damping: float) -> PlantMode:
    return PlantMode(
        name="m",
        natural_frequency=2 * pi * 40.0,
        damping_ratio=damping,
        tcp_gain=1.0,
        measured_gain=0.0,
        scale=1.0,
        deflection=2,
        rate=3,
    )


def vibration(shaper: Shaper, pole: complex) -> float:
    """Residual vibration over that of a single impulse at the end of the sequence."""
    end = shaper.times[-1]
    total = sum(
        a * exp(pole * (end - t)) for a, t in zip(shaper.amplitudes, shaper.times, strict=True)
    )
    return abs(total)


@pytest.mark.parametrize("damping", [0.0, 0.02, 0.1])
def test_singer_seering_1990_zeros(damping: float) -> None:
    """If it failed, ZV and ZVD would not cancel the mode they are designed for."""
    own = mode(damping)
    zv, _, zvd, _ = design_shapers(own)
    assert vibration(zv, own.pole) < 1e-12
    assert vibration(zvd, own.pole) < 1e-12
    shifted = own.pole + 1e-4j * own.natural_frequency
    # A double zero: a small error of frequency counts squared.
    assert vibration(zvd, shifted) < 0.01 * vibration(zv, shifted)


def test_singhose_1994_ei_tolerates_five_per_cent_at_its_centre_and_none_beside() -> None:
    """If it failed, the comparison would hold a weak EI against the recommendation."""
    own = mode(0.0)
    ei = design_shapers(own)[3]
    assert vibration(ei, own.pole) == pytest.approx(0.05)
    ratios = np.linspace(0.8, 1.2, 401)
    curve = [vibration(ei, own.pole * r) for r in ratios]
    inside = [r for r, v in zip(ratios, curve, strict=True) if v <= 0.0501]
    # Published insensitivity of EI at 5 %: 0.399, from about 0.8 to 1.2 of the frequency.
    assert max(inside) - min(inside) == pytest.approx(0.399, abs=0.005)


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_amplitudes_are_shares(damping: float) -> None:
    """If it failed, the shaped setpoint would not arrive."""
    for shaper in design_shapers(mode(damping)):
        assert sum(shaper.amplitudes) == pytest.approx(1.0, abs=1e-14)
        assert min(shaper.amplitudes) > 0.0
        assert shaper.times[0] == 0.0


def test_mzv_vibration_at_its_frequency() -> None:
    """If it failed, MZV would not be the shaper of Klipper: a zero at f, 0.75/f long."""
    own = mode(0.0)
    mzv = design_shapers(own)[1]
    assert vibration(mzv, own.pole) < 1e-12
    assert mzv.times[-1] == pytest.approx(0.75 / 40.0)
    assert mzv.amplitudes[0] == pytest.approx(1 - 1 / sqrt(2))


@pytest.mark.parametrize("move", [VelocityStep(velocity_step=0.1), Positioning(distance=0.03)])
def test_shaped_setpoint_is_the_sum_of_copies(move: VelocityStep | Positioning) -> None:
    """If it failed, the shapers would be judged on a motion that no control produces."""
    plain = plan_setpoint(move, MotionLimits(acceleration=2.0, jerk=2e5))
    shaper = design_shapers(mode(0.03))[2]
    shaped = shape_setpoint(plain, shaper)
    assert shaped.duration == pytest.approx(plain.duration + shaper.times[-1])
    t = np.linspace(0.0, shaped.duration + 0.01, 300)
    copies = sum(
        a * sample_setpoint(plain, t - delay)
        for a, delay in zip(shaper.amplitudes, shaper.times, strict=True)
    )
    assert sample_setpoint(shaped, t)[:, :3] == pytest.approx(copies[:, :3], abs=1e-8)


def test_comparison_on_the_papers_machine() -> None:
    """If it failed, the sheet's table of shapers would be empty or judged otherwise."""
    machine = paper_machine()
    needs = replace(machine.requirements, tcp_deviation=50e-6)
    machine = replace(
        machine, requirements=needs, control=Control(state_feedback=StateFeedback.OFF)
    )
    trials = compare_shapers(machine, build_plant(machine), tune_loop(machine))
    assert [Catalogue().say(trial.name).split()[0] for trial in trials] == [
        "ZV",
        "MZV",
        "ZVD",
        "EI",
        "moving",
    ]
    for trial in trials:
        force = next(c for c in trial.assessment.checks if c.name == "set force")
        assert force.is_met
        inside = trial.residual_deviation <= needs.tcp_deviation
        assert trial.assessment.is_met == inside
    # At a wide band all manage, and the longer filter settles later than the short shaper.
    assert all(trial.assessment.is_met for trial in trials)
    assert trials[0].settling_time < trials[2].settling_time + 0.02
