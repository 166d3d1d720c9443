"""The verdict must name every requirement, its worst place and the one in the way."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf

import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.quantities import THIN_SPACE
from mtcommission.limits.judge import MoveResult, assess, evaluate_moves, simulate_moves
from mtcommission.limits.requirements import (
    CONTOUR_DEVIATION,
    SETTLING_TIME,
    requirements_of,
)
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.readers import SignalValue
from mtcommission.setpoint.motion_limits import MotionLimits
from tests.machines import paper_machine

LIMITS = MotionLimits(acceleration=1.0, jerk=10.0)


def demanding() -> Machine:
    """Everything that can be asked for, in five corners."""
    machine = paper_machine()
    needs = replace(
        machine.requirements,
        max_settling_time=0.5,
        contour_deviation=3e-4,
        peaks=(SignalValue(name="v_phi", value=5e-3),),
        payload=(0.0, 100.0),
        frequency_spread=0.05,
    )
    drive = replace(machine.drive, continuous_force=1500.0)
    moves = (*machine.moves, Positioning(distance=0.02, max_velocity=0.1))
    return replace(machine, requirements=needs, drive=drive, moves=moves)


@cache
def simulated() -> tuple[TunedLoop, tuple[MoveResult, ...]]:
    tuned = tune_loop(demanding())
    return tuned, simulate_moves(demanding(), tuned, LIMITS)


def test_every_requirement_has_a_check_with_its_limit():
    found = evaluate_moves(demanding(), *simulated()).assessment
    limits = {check.name: (check.limit, check.unit) for check in found.checks}
    assert limits == {
        "residual deviation": (5e-6, "m"),
        "settling time": (0.5, "s"),
        "contour deviation": (3e-4, "m"),
        "peak v_phi": (5e-3, "rad/s"),
        "set force": (2000.0, "N"),
        "RMS force": (1500.0, "N"),
    }
    assert found.is_met
    assert found.limiting_requirement is None


@pytest.mark.parametrize("requirement", requirements_of(demanding()), ids=lambda item: item.key)
def test_each_missed_requirement_is_the_limiting_one(requirement):
    machine, (tuned, moves) = demanding(), simulated()
    reached = evaluate_moves(machine, tuned, moves).assessment.check_of(requirement).value
    row = requirements_of(machine).index(requirement)
    assert reached == max(move.values[row].max() for move in moves)
    strict = requirement.with_bound(machine, 0.999 * reached)
    found = evaluate_moves(strict, tuned, moves).assessment
    assert [check.requirement for check in found.checks if not check.is_met] == [requirement]
    assert found.limiting_requirement == requirement


def test_what_does_not_settle_misses_at_the_place_that_is_named():
    machine, (tuned, moves) = demanding(), simulated()
    values = [move.values.copy() for move in moves]
    values[1][requirements_of(machine).index(SETTLING_TIME), 3] = inf
    check = assess(machine, tuned.plant, tuned.corners, values).check_of(SETTLING_TIME)
    assert (check.value, check.is_met) == (inf, False)
    said = Catalogue().say(check.where).replace(THIN_SPACE, " ").replace("\xa0", " ")
    assert said == "move 2, payload 100 kg, frequencies × 0.95"


def test_a_contour_is_judged_at_its_feed_and_the_rest_at_the_velocity_of_the_move():
    """A rapid move would be slowed down to keep a contour that nobody cuts at that velocity."""
    machine = paper_machine()
    needs = replace(machine.requirements, contour_deviation=1e-3, contour_feed=0.01)
    machine = replace(machine, requirements=needs)
    tuned = tune_loop(machine)
    (fast,) = simulate_moves(machine, tuned, LIMITS)
    slowed = replace(machine, moves=(VelocityStep(velocity_step=0.01),))
    (slow,) = simulate_moves(slowed, tuned, LIMITS)
    found = evaluate_moves(machine, tuned, [fast]).assessment
    worst = max(response.peak_deviation for response in slow.responses)
    assert worst < 0.9 * max(response.peak_deviation for response in fast.responses)
    assert found.check_of(CONTOUR_DEVIATION).value == worst
