"""Work that grows with the length of the moves is counted before it is begun."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mtcommission.commission import commission
from mtcommission.errors import ComputationError, Outcome
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.commissioning_rule.rule import apply_commissioning_rule
from mtcommission.loop.simulation_budget import (
    MOST_CYCLES,
    count_cycles,
    longest_affordable,
    require_affordable,
)
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, Positioning, VelocityStep
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.messages.quantities import Formatter
from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import read_profile
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from mtcommission.study.rules import evaluate_rules
from tests.machines import paper_machine

PROFILES = sorted((Path(__file__).parent.parent / "profiles").glob("*.toml"))


def with_force(force: float) -> Machine:
    machine = paper_machine()
    return replace(machine, drive=replace(machine.drive, max_force=force))


@pytest.mark.parametrize(
    "move",
    [
        VelocityStep(velocity_step=0.1),
        Positioning(distance=0.4, max_velocity=1.0),
        Positioning(distance=0.01, max_velocity=1.0),
    ],
)
def test_least_time_is_that_of_a_setpoint_with_endless_jerk(move: VelocityStep) -> None:
    """If it failed, moves would be refused or begun by a wrong count."""
    planned = plan_setpoint(move, MotionLimits(acceleration=2.0, jerk=2e6))
    assert least_motion_time(move, 2.0) == pytest.approx(planned.duration, rel=1e-4)


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.stem)
def test_no_shipped_machine_comes_near_the_cap(path: Path) -> None:
    """If it failed, an ordinary machine would get no limits."""
    assert count_cycles(read_profile(path)) < MOST_CYCLES / 5.0


@pytest.mark.parametrize("force", [0.5, 1e-3, 1e-300])
def test_too_small_a_force_is_refused_at_once_with_reason_and_remedy(force: float) -> None:
    """If it failed, the user would wait for hours instead of checking the unit of the force."""
    machine = with_force(force)
    with np.errstate(all="raise"), pytest.raises(ComputationError) as caught:
        commission(machine)
    assert caught.value.outcome is Outcome.MOVE_TOO_LONG
    text = str(caught.value)
    assert f"with {Formatter().number(force)} N on 750 kg" in text
    assert "velocity cycles of 125 µs, followed are 6×10⁵ at most" in text
    assert "check the unit of max_force, or state a shorter move" in text


def test_search_alone_refuses_too() -> None:
    """If it failed, a sweep over limits would hang where a run does not."""
    machine = with_force(1e-3)
    with pytest.raises(ComputationError) as caught:
        choose_limits(machine, build_plant(machine), tune_loop(machine))
    assert caught.value.outcome is Outcome.MOVE_TOO_LONG


def test_remedy_helps() -> None:
    """If it failed, the message would send the user into the next refusal."""
    machine = with_force(1.0)
    short = replace(machine, moves=(VelocityStep(velocity_step=0.01),))
    require_affordable(short)


def test_a_band_that_no_move_can_keep_is_told_without_following_it() -> None:
    """If it failed, a wrong unit of the band would end in hours of simulation."""
    machine = paper_machine()
    tight = replace(machine, requirements=replace(machine.requirements, tcp_deviation=1e-12))
    plant, tuned = build_plant(tight), tune_loop(tight)
    settling_time = choose_limits(tight, plant, tuned).candidate.settling_time
    assert 60.0 < settling_time < 2.0 * longest_affordable(tight)
    with pytest.raises(ComputationError) as caught:
        evaluate_rules(tight, tuned, apply_commissioning_rule(tight, plant, tuned))
    assert caught.value.outcome is Outcome.MOVE_TOO_LONG
    assert "to keep a band of 1×10⁻¹² m it takes" in str(caught.value)
    assert "check the unit of tcp_deviation" in str(caught.value)
