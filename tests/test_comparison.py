"""The paper's comparison: setpoints in the loop beside the optimum on the plant."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.messages.quantities import THIN_SPACE
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import TimeOptimum
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.optimum import ComparedControl, compare_controls, state_claims
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


def compared(transfer: float, overshoot: float) -> ComparedControl:
    return ComparedControl(
        name=Message("way-recommended"),
        transfer_time=transfer,
        overshoot=overshoot,
        peaks=np.zeros(1),
        max_force=1.0,
        heat=1.0,
        work=1.0,
    )


def test_claims_are_written_without_powers_of_ten() -> None:
    """A slow move of a soft axis read 'takes 1.235e+04 ms'."""
    controls = [compared(12.3456, 31.4), compared(inf, 1e-5), compared(0.010001, 0.0)]
    said = map(Catalogue().say, state_claims(controls))
    first, second = (sentence.replace(THIN_SPACE, " ") for sentence in said)
    assert first == (
        "The rectangular acceleration setpoint overshoots by 3140 % and takes 12.35 s, "
        "1234 times the least time of 10 ms."
    )
    assert second.endswith("does not settle, where the least time is 10 ms.")
