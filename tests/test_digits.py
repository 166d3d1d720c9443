"""Limits as they are typed in, against decimal arithmetic."""

from __future__ import annotations

from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mtcommission.controls.kind import Jerk
from mtcommission.limits.typed import DIGITS, round_limits
from mtcommission.machine.machine import Machine
from tests.machines import paper_machine

ACCELERATIONS = st.integers(10**3, 10**9).map(lambda millionths: millionths / 1e6)
JERK_TIMES = st.integers(10**2, 10**6).map(lambda millionths: millionths / 1e6)


def machine_with(jerk: Jerk) -> Machine:
    machine = paper_machine()
    kind = replace(machine.control.kind, jerk=jerk)
    return replace(machine, control=replace(machine.control, kind=kind))


def rounded(value: float, rounding: str) -> float:
    exact = Decimal(f"{value:.11g}")  # as it would be read aloud, not as binary holds it
    step = Decimal(1).scaleb(exact.adjusted() - DIGITS + 1)
    return float((exact / step).to_integral_value(rounding) * step)


@given(ACCELERATIONS, JERK_TIMES)
def test_a_limit_of_the_jerk_is_rounded_down(a: float, t_j: float) -> None:
    """If it failed, what is typed in would be faster than what was searched."""
    found = round_limits(machine_with(Jerk.LIMIT), a, t_j)
    assert found.acceleration == pytest.approx(rounded(a, ROUND_FLOOR), rel=1e-12)
    assert found.jerk == pytest.approx(rounded(a / t_j, ROUND_FLOOR), rel=1e-12)


@given(ACCELERATIONS, JERK_TIMES)
def test_the_time_of_a_ramp_is_rounded_up(a: float, t_j: float) -> None:
    """If it failed, a control that takes a time would ramp sooner than was searched."""
    found = round_limits(machine_with(Jerk.TIME), a, t_j)
    assert found.acceleration == pytest.approx(rounded(a, ROUND_FLOOR), rel=1e-12)
    assert found.jerk_time == pytest.approx(rounded(t_j, ROUND_CEILING), rel=1e-12)
