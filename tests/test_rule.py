"""The commissioning rule: its formulas against the loop, its promise on random machines."""

from __future__ import annotations

import re
from dataclasses import replace
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.population import random_machine
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.commissioning_rule import (
    RESERVE,
    RuleResult,
    apply_commissioning_rule,
    ramp_vibration,
)
from mtcommission.limits.every_size import judge_sizes
from mtcommission.limits.judge import evaluate
from mtcommission.limits.requirements import RESIDUAL_DEVIATION
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import read_profile
from mtcommission.machine.readers import SignalValue
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits
from tests.machines import paper_machine


def for_every_size(machine: Machine) -> Machine:
    """The machine with a free setpoint filter, asked for every size."""
    return replace(
        machine,
        requirements=replace(machine.requirements, every_size=True),
        control=replace(machine.control, seeks_setpoint_filter=True),
    )


def worst_residual(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> float:
    """Proven residual of the worst of all sizes [m]."""
    needs = replace(machine.requirements, every_size=True)
    machine = replace(machine, requirements=needs)
    checks = judge_sizes(machine, tuned, limits)
    return next(c.bound for c in checks if c.requirement is RESIDUAL_DEVIATION)


def apply(machine: Machine) -> tuple[RuleResult, TunedLoop]:
    tuned = tune_loop(machine)
    return apply_commissioning_rule(machine, tuned), tuned


@pytest.mark.parametrize(("cycles", "damping"), [(0.3, 0.0), (1.0, 0.05), (2.1, 0.1)])
def test_ramp_vibration_against_an_integrated_oscillator(cycles, damping):
    """If it failed, the chart would promise a rest that does not come."""
    omega = 2 * pi * 40.0
    t_j = cycles * 2 * pi / omega

    def rates(t, y):
        push = min(t / t_j, 1.0)
        return [y[1], push * omega**2 - 2 * damping * omega * y[1] - omega**2 * y[0]]

    end = solve_ivp(rates, (0.0, t_j), [0.0, 0.0], rtol=1e-9, atol=1e-12).y[:, -1]
    # Amplitude of the free vibration about the static deflection 1, as a pole's residue; a jerk
    # step 1/t_j alone leaves 1/(omega t_j sqrt(1 - zeta^2)).
    p = omega * (-damping + 1j * sqrt(1 - damping**2))
    residue = abs((end[1] - p.conjugate() * (end[0] - 1.0)) / p.imag)
    single = 1.0 / (omega * t_j * sqrt(1 - damping**2).real)
    expected = ramp_vibration(cycles, damping=damping, spread=0.0)
    assert residue / single == pytest.approx(expected, rel=0.02 + damping)


@pytest.mark.parametrize("seed", [0, 5, 16, 29])
def test_rule_keeps_all_at_every_size_on_random_machines(seed):
    """If it failed, the sheet would print a rule that does not do what it is for."""
    machine = for_every_size(random_machine(seed))
    found, tuned = apply(machine)
    candidate = evaluate(machine, tuned, found.limits)
    assert candidate.assessment.is_met
    worst = next(c for c in candidate.sizes if c.requirement is RESIDUAL_DEVIATION)
    assert worst.bound <= RESERVE * found.best.residual_deviation
    assert candidate.settling_time == pytest.approx(found.predicted_settling_time, abs=1e-9)


def test_a_wider_band_is_never_slower():
    """If it failed, roughing limits could be lower than finishing limits."""
    machine = random_machine(12)
    times = []
    for band in (2e-6, 5e-6, 2e-5, 1e-4):
        needs = replace(machine.requirements, tcp_deviation=band)
        times.append(apply(replace(machine, requirements=needs))[0].predicted_settling_time)
    assert times == sorted(times, reverse=True)


def test_what_the_rule_does_not_know_is_said():
    """If it failed, the sheet would print the rule where it was never tried."""
    machine = random_machine(3)
    assert not apply(machine)[0].warnings
    needs = replace(machine.requirements, peaks=(SignalValue(name="v", value=1.0),))
    shaper = SetpointFilter(kind="zv", frequency_hz=40.0, damping_ratio=0.02)
    control = replace(machine.control, setpoint_filter=shaper, velocity_feedforward=0.9)
    warnings = apply(replace(machine, requirements=needs, control=control))[0].warnings
    assert len(warnings) == 3
    (seen,) = apply(paper_machine())[0].warnings
    assert seen.kind == "rule-careful-with-seen-mode"
    assert seen.values["share"] == pytest.approx(750.0 / 450.0)


DOC = Path(__file__).parent.parent / "docs" / "commissioning-rule.md"


def example_of_the_document(folder: Path) -> Machine:
    """The profile in the document, as a reader saves it."""
    found = re.search(r"```toml\n(.*?)```", DOC.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert found is not None
    path = folder / "example.toml"
    path.write_text(found[1], encoding="utf-8")
    return read_profile(path)


def test_the_example_by_hand_gives_what_the_program_gives(tmp_path):
    """If it failed, an engineer with a pocket calculator would get other limits than the sheet."""
    found, tuned = apply(example_of_the_document(tmp_path))
    # Once more from the document's text alone, with its numbers.
    Kp, m, T, F, v, e = 88880.0, 400.0, 2e-3, 2e3, 0.2, 4e-6
    assert tuned.controller.velocity_gain == pytest.approx(Kp, rel=1e-5)
    omega, omega_v = 2 * pi * 40.0 * 0.97, Kp / m
    C, gone = m * 0.002 / omega**3, 1 - np.exp(-2 * pi * 0.03 * 1.03)
    left = np.exp(-2 * pi * 0.03 * 0.97)
    W = np.sqrt(gone**2 + 4 * left * np.sin(0.03 * pi) ** 2) / (omega * 0.025)
    for candidate in found.tried:
        T_F = candidate.average
        assert T_F in (0.0, 0.025)
        C_S = 0.4 * T**2 / omega_v * (min(2.4, 6 / (omega_v * T_F)) if T_F else 2.4)
        j = e / (1.25 * np.hypot(C_S, 4 * C * (W if T_F else 1.0)))
        a = min(F / (1.17 * m + Kp * 1e-3 / 2), np.sqrt(v * j))
        assert candidate.limits.jerk == pytest.approx(j, rel=2e-3)
        assert candidate.limits.acceleration == pytest.approx(a, rel=2e-3)
        assert candidate.duration == pytest.approx(v / a + a / j + T_F, rel=2e-3)
        text = f"{1e3 * candidate.duration:.1f} ms"
        text = f"| **{text}** |" if candidate == found.best else f"| {text} |"
        assert text in DOC.read_text(encoding="utf-8")


def test_the_example_prints_what_is_simulated(tmp_path):
    """If it failed, the document would promise figures that nobody finds again."""
    machine = example_of_the_document(tmp_path)
    found, tuned = apply(machine)
    candidate = evaluate(machine, tuned, found.limits)
    force = next(check for check in candidate.assessment.checks if check.name == "set force")
    searched = choose_limits(machine, tuned).limits
    best = evaluate(machine, tuned, searched).settling_time
    naive = next(
        item
        for item in apply_rules_of_thumb(machine, build_plant(machine))
        if item.name.kind == "rule-of-thumb-period"
    )
    other = evaluate(machine, tuned, naive.limits)
    text = " ".join(DOC.read_text(encoding="utf-8").split())
    for said in (
        f"Simulated at every size: {1e3 * candidate.settling_time:.1f} ms, "
        f"{1e6 * worst_residual(machine, tuned, found.limits):.2f} µm, "
        f"{force.value:.0f} N of 2000 N.",
        f"The search finds {1e3 * best:.1f} ms with {searched.acceleration:g} m/s², "
        f"{searched.jerk:g} m/s³ and",
        f"leaves {1e6 * other.residual_deviation:.1f} µm and settles after "
        f"{1e3 * other.settling_time:.1f} ms",
    ):
        assert said in text


# Each rule of thumb must be what its source states.


def test_rules_on_the_papers_machine_by_hand():
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
