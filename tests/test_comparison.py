"""The paper's comparison: setpoints in the loop beside the optimum on the plant."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.optimal.control import TimeOptimum
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.optimum import ComparedControl, compare_controls
from tests.machines import paper_machine

LIMITS = MotionLimits(acceleration=1.94, jerk=41.2)


@pytest.fixture(scope="module")
def machine() -> Machine:
    made = paper_machine()
    return replace(made, control=replace(made.control, state_feedback=StateFeedback.OFF))


@pytest.fixture(scope="module")
def plant(machine: Machine) -> Plant:
    return build_plant(machine)


@pytest.fixture(scope="module")
def tuned(machine: Machine) -> TunedLoop:
    return tune_loop(machine)


@pytest.fixture(scope="module")
def optimum(plant: Plant, machine: Machine) -> TimeOptimum:
    return solve_time_optimal(plant, machine.moves[0], force_limit=2e3)


@pytest.fixture(scope="module")
def rows(
    machine: Machine, plant: Plant, tuned: TunedLoop, optimum: TimeOptimum
) -> tuple[ComparedControl, ...]:
    move = machine.moves[0]
    return compare_controls(machine, tuned, move, limits=LIMITS, optima=[optimum])


def test_the_papers_two_claims_hold(rows: tuple[ComparedControl, ...]) -> None:
    """Sec. 3: terminal overshoot, and a transfer time much larger than the least."""
    rectangular, trapezoidal, optimal = rows
    assert rectangular.overshoot > 0.05
    assert rectangular.transfer_time > 2.0 * optimal.transfer_time
    assert trapezoidal.transfer_time > 2.0 * optimal.transfer_time
    assert optimal.overshoot < 1e-9
