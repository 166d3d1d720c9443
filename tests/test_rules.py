"""Each rule of thumb must be what its source states."""

from __future__ import annotations

from math import pi, sqrt

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.machine.plant.plant import build_plant
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
