"""Each rule of thumb must be what its source states."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from mtcommission.limits.judge import evaluate
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb, apply_slower_ramps
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Positioning, VelocityStep
from mtcommission.machine.rigid_body import peak_velocity
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.plant.plant import build_plant, dominant_mode, longest_period
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.variations import Row, judge
from tests.independent_loop import Vibration, profile_of
from tests.machines import paper_machine, random_modal_machine


def test_rules_on_the_papers_machine_by_hand() -> None:
    machine = paper_machine()
    rules = {
        Catalogue().say(rule.name): rule.limits
        for rule in apply_rules_of_thumb(machine, build_plant(machine))
    }
    a = 2000.0 / 750.0
    f = sqrt(44.41e6 / 450.0) / (2 * pi)  # the base: 1/k_b exceeds h r / k
    soft = min(a, 5e-6 * (2 * pi * f) ** 2)
    expected = {
        "a = F_max/m, no jerk limit": (a, a / 2e-3),
        "j = a f (base, 50 Hz)": (a, a * f),
        "a = e ω², j = a f": (soft, soft * f),
        "j = 10 a": (a, 10 * a),
        "j = 100 a": (a, 100 * a),
        "j = a²/v_max": (a, a**2 / 0.1),
    }
    assert set(rules) == set(expected)
    for name, (acceleration, jerk) in expected.items():
        assert rules[name].acceleration == pytest.approx(acceleration), name
        assert rules[name].jerk == pytest.approx(jerk), name


def test_slower_ramps_take_two_and_three_periods() -> None:
    """If it failed, the later zeros of j = a f / k would not be what is compared."""
    machine = paper_machine()
    a, period = 2000.0 / 750.0, 2 * pi * sqrt(450.0 / 44.41e6)
    found = {
        Catalogue().say(rule.name): rule.limits
        for rule in apply_slower_ramps(machine, build_plant(machine))
    }
    assert list(found) == ["j = a f / 2 (base, 50 Hz)", "j = a f / 3 (base, 50 Hz)"]
    for k, limits in zip((2, 3), found.values(), strict=True):
        assert limits.acceleration == pytest.approx(a)
        assert limits.jerk_time == pytest.approx(k * period, rel=1e-3)


@pytest.mark.parametrize(("acceleration", "jerk"), [(1.0, 25.0), (1.5, 50.0), (2.5, 1300.0)])
def test_a_row_is_judged_like_the_recommendation(acceleration: float, jerk: float) -> None:
    """If it failed, a rule would be called good that smaller moves, or the verdict, refuse."""
    machine = paper_machine()
    needs = replace(machine.requirements, every_size=True)
    machine = replace(machine, requirements=needs)
    tuned, limits = tune_loop(machine), MotionLimits(acceleration=acceleration, jerk=jerk)
    found = judge(Row(label=Message("x"), machine=machine, tuned=tuned, limits=limits))
    own = evaluate(machine, build_plant(machine), tuned, limits)
    assert found.settling_time == own.settling_time
    assert found.residual_deviation == own.residual_deviation
    assert found.assessment.is_met == own.assessment.is_met
    assert found.assessment.keeps(needs.reserve) == own.assessment.keeps(needs.reserve)


def test_dominant_mode_bends_the_tool_most_per_newton() -> None:
    for seed in range(10):
        plant = build_plant(random_modal_machine(seed, n_modes=4))
        bends = {m.name: abs(m.tcp_gain) / m.natural_frequency**2 for m in plant.modes}
        assert bends[dominant_mode(plant).name] == max(bends.values())


def test_longest_period_is_that_of_the_slowest_mode() -> None:
    assert longest_period(build_plant(paper_machine())) == pytest.approx(1 / 50.0, rel=1e-3)


def test_peak_velocity_of_a_move() -> None:
    assert peak_velocity(VelocityStep(velocity_step=0.3), 2.0) == 0.3
    assert peak_velocity(Positioning(distance=0.02), 2.0) == pytest.approx(sqrt(2.0 * 0.02))
    assert peak_velocity(Positioning(distance=9.0, max_velocity=0.5), 2.0) == 0.5


def test_rules_use_the_force_that_is_left_for_motion() -> None:
    machine = paper_machine()
    loaded = replace(machine, drive=replace(machine.drive, static_load=-500.0))
    rule = apply_rules_of_thumb(loaded, build_plant(loaded))[0]
    assert rule.limits.acceleration == pytest.approx(1500.0 / 750.0)


def swing(frequency: float, damping: float, a: float, t_j: float) -> float:
    """Free amplitude of a mode under an acceleration setpoint of an ideal loop, over a/ω²."""
    omega = 2 * pi * frequency
    profile = profile_of(VelocityStep(velocity_step=40 * a * t_j), a, a / t_j)
    mode = Vibration(complex(-damping * omega, omega * sqrt(1 - damping**2)), 1.0, 0.0, 1.0)
    t = np.linspace(0.0, t_j, 200001)
    h = t[1] - t[0]
    # The response at the end of the first ramp, about the static deflection that follows it.
    acceleration = np.array([profile.at(x)[2] for x in t[::100]])
    force = np.interp(t, t[::100], acceleration)
    kernel = np.exp(mode.pole * (t_j - t))
    w = np.trapezoid(kernel * force, dx=h) + a / mode.pole
    return float(abs(w) / mode.pole.imag / (a / omega**2))


@pytest.mark.parametrize("k", [1, 2, 3])
def test_jerk_time_of_whole_periods_leaves_an_undamped_mode_at_rest(k: int) -> None:
    """Biagiotti & Melchiorri: the ramp is a moving average with zeros at multiples of 1/t_j."""
    assert swing(50.0, 0.0, 2.0, k / 50.0) < 1e-6
    assert swing(50.0, 0.0, 2.0, (k + 0.5) / 50.0) > 0.08


@pytest.mark.parametrize(("damping", "residual"), [(0.02, 0.019), (0.05, 0.043), (0.1, 0.075)])
def test_residual_of_one_ramp_by_the_closed_form(damping: float, residual: float) -> None:
    """|exp(p t_j) - 1| / (ω t_j sqrt(1 - ζ²)) at f t_j = 1: the notes' table, recomputed."""
    omega = 2 * pi * 50.0
    root = sqrt(1 - damping**2)
    p = complex(-damping * omega, omega * root)
    t_j = 1 / 50.0
    closed = abs(np.exp(p * t_j) - 1) / (omega * t_j * root)
    assert closed == pytest.approx(residual, abs=1e-3)
    assert swing(50.0, damping, 2.0, t_j) == pytest.approx(closed, rel=1e-4)
