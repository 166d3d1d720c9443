"""From which step on limits hold, against the full simulation."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mtcommission.limits.judge import evaluate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Positioning
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
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
