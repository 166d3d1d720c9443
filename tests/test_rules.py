"""Each rule of thumb must be what its source states."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.limits.judge import evaluate
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.plant.plant import build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.variations import Row, judge
from tests.machines import paper_machine


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
        "j = a f / 2 (base, 50 Hz)": (a, a * f / 2.0),
        "j = a f / 3 (base, 50 Hz)": (a, a * f / 3.0),
    }
    assert set(rules) == set(expected)
    for name, (acceleration, jerk) in expected.items():
        assert rules[name].acceleration == pytest.approx(acceleration), name
        assert rules[name].jerk == pytest.approx(jerk), name


@pytest.mark.parametrize(("acceleration", "jerk"), [(1.0, 25.0), (1.5, 50.0), (2.5, 1300.0)])
def test_a_row_is_judged_like_the_recommendation(acceleration: float, jerk: float) -> None:
    """If it failed, a rule would be called good that smaller moves, or the verdict, refuse."""
    machine = paper_machine()
    needs = replace(machine.requirements, every_size=True)
    machine = replace(machine, requirements=needs)
    tuned, limits = tune_loop(machine), MotionLimits(acceleration=acceleration, jerk=jerk)
    found = judge(Row(label=Message("x"), machine=machine, tuned=tuned, limits=limits))
    own = evaluate(machine, tuned, limits)
    assert found.settling_time == own.settling_time
    assert found.residual_deviation == own.residual_deviation
    assert found.assessment.is_met == own.assessment.is_met
    assert found.assessment.keeps_reserve == own.assessment.keeps_reserve
