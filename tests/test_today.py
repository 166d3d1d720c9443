"""Today's values: the same loop and judgement as the recommendation, and never a silent guess."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.limits.judge import evaluate
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import Today
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.rules import TodaysValues, judge_today
from tests.machines import paper_machine


def judged(machine: Machine, today: Today | None) -> TodaysValues | None:
    stated = replace(machine, today=today)
    return judge_today(stated, tune_loop(stated))


def test_given_gains_give_the_loop_that_a_profile_with_these_gains_gets():
    """A second way to the same loop: the profile that states today's gains as its own."""
    machine = paper_machine()
    today = Today(
        acceleration=1.2, jerk=30.0, position_gain=12.0, velocity_gain=9e4, integral_time=0.05
    )
    found = judged(machine, today)
    assert found is not None
    assert found.judged is not None
    assert found.basis == Message("today-in-own-loop")
    own = replace(
        machine.control,
        position_gain=12.0,
        velocity_gain=9e4,
        integral_time=0.05,
        state_feedback=type(machine.control.state_feedback).OFF,
    )
    other = replace(machine, control=own)
    limits = MotionLimits(acceleration=1.2, jerk=30.0)
    twin = evaluate(other, tune_loop(other), limits)
    assert found.judged.settling_time == pytest.approx(twin.settling_time, rel=1e-9)
    assert found.judged.residual_deviation == pytest.approx(twin.residual_deviation, rel=1e-6)


def test_a_filter_of_today_lengthens_the_move_by_its_time():
    """The recommended setpoint has none: it must not be forgotten, nor stay for the others."""
    machine, today = paper_machine(), Today(acceleration=1.2, jerk=30.0)
    filtered = replace(today, setpoint_filter=moving_average(0.1))
    plain, behind = (judged(machine, one).judged for one in (today, filtered))
    assert behind.settling_time > plain.settling_time + 0.05


def test_an_unstable_loop_is_told_with_its_gains_and_has_no_result():
    found = judged(paper_machine(), Today(acceleration=1.2, jerk=30.0, velocity_gain=9e6))
    assert found is not None
    assert found.judged is None
    assert found.frequency_error is None
    assert found.failure is not None
    assert "unstable with today's Kv" in Catalogue().say(found.failure)
    assert found.failure.values["Kp"] == 9e6


def test_values_that_make_endless_moves_are_told_and_stop_nothing():
    """A wrong unit in [today] must not cost the user the recommendation."""
    found = judged(paper_machine(), Today(acceleration=1e-6, jerk=1e-6))
    assert found is not None
    assert found.judged is None
    assert "[today]" in Catalogue().say(found.failure or Message("none"))
    assert found.limits.jerk_time < inf
