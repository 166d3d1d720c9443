"""From which step on limits hold, against the full simulation, and the filter as the cure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mtcommission.limits.judge import evaluate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import Control, StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT, MotionLimits
from mtcommission.setpoint.smaller_moves import resize
from mtcommission.study.robustness import MoveSizes, compare_move_sizes
from tests.machines import paper_machine

LIMITS = MotionLimits(acceleration=1.5, jerk=30.0)


def two_moves() -> Machine:
    machine = paper_machine()
    needs = replace(machine.requirements, payload=(0.0, 100.0), frequency_spread=0.02)
    moves = (machine.moves[0], Positioning(distance=0.02, max_velocity=0.3))
    return replace(machine, requirements=needs, moves=moves)


def judged(machine: Machine, tuned: TunedLoop, item: MoveSizes, index: int) -> tuple[float, float]:
    """Settling time and residual of one size, by the full simulation in every corner."""
    move = resize(item.move, float(item.size[index]))
    one = replace(machine, moves=(move,))
    candidate = evaluate(one, tuned, item.limits)
    return candidate.settling_time, candidate.residual_deviation


@pytest.mark.parametrize("average", [0.0, 0.0139])
def test_every_size_is_what_the_simulation_says(average: float) -> None:
    """If it failed, the sheet would promise limits for jogs that leave the band."""
    machine = two_moves()
    tuned = tune_loop(machine)
    limits = replace(LIMITS, setpoint_filter=moving_average(average))
    found = compare_move_sizes(machine, tuned, {"x": limits})
    assert [item.move for item in found] == list(machine.moves)
    for item in found:
        for index in (0, 50, 95):
            settling, residual = judged(machine, tuned, item, index)
            assert item.residual_deviation[index] == pytest.approx(residual, rel=1e-4, abs=1e-10)
            assert item.settling_time[index] == pytest.approx(settling, abs=2e-6)


def test_only_the_filter_keeps_whole_periods_on_small_steps() -> None:
    """If it failed, the reason given for the filter would be wrong."""
    mode = FlexibleMode(
        name="m",
        natural_frequency=2 * np.pi * 20.0,
        damping_ratio=0.005,
        tcp_gain=1e-3,
        measured_gain=0.0,
    )
    machine = replace(
        paper_machine(),
        mechanics=Modal(moving_mass=800.0, modes=(mode,)),
        control=Control(state_feedback=StateFeedback.OFF),
        moves=(VelocityStep(velocity_step=0.1),),
    )
    ramps = MotionLimits(acceleration=1.0, jerk=20.0)
    average = MotionLimits(
        acceleration=1.0, jerk=1.0 / NO_JERK_LIMIT, setpoint_filter=moving_average(0.05)
    )
    named = {"j = a f": ramps, "way-recommended": average}
    limited, filtered = compare_move_sizes(machine, tune_loop(machine), named)
    small = filtered.size < 0.04  # a²/j = 0.05 m/s
    assert limited.residual_deviation[small].max() > 3.0 * limited.residual_deviation[~small].max()
    assert filtered.residual_deviation.max() < 1.1 * limited.residual_deviation[~small].max()
