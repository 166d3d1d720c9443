"""What the sheet says about disturbances must be so."""

from __future__ import annotations

import numpy as np
import pytest

from mtcommission.loop.disturbance import simulate_disturbance
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine
from tests.independent_loop import Profile, quiet_copy, run
from tests.machines import paper_machine, random_modal_machine

REST = Profile(knots=(0.0,), jerks=(0.0,))


def loops() -> list[tuple[Machine, TunedLoop]]:
    cascade = quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF)
    machines = [paper_machine(), cascade, random_modal_machine(3, n_modes=2)]
    return [(machine, tune_loop(machine)) for machine in machines]


@pytest.mark.parametrize("case", loops(), ids=["state feedback", "cascade", "random"])
def test_pushed_tool_moves_as_in_a_second_program(case: tuple[Machine, TunedLoop]) -> None:
    """The disturbance curve would belong to another loop, or to another line of force."""
    machine, tuned = case
    ours = simulate_disturbance(tuned.loops[0], duration=0.2)
    theirs = run(machine, tuned.controller, REST, nominal=machine, samples=len(ours.t), push=100.0)
    assert np.allclose(100.0 * ours.deflection, theirs.tool, atol=1e-7 * 100.0 * ours.peak)


def test_no_sine_moves_the_tool_more_than_the_dynamic_stiffness_says() -> None:
    """The stiffness in the table and the curve beside it would contradict each other."""
    tuned = tune_loop(paper_machine())
    answer = simulate_disturbance(tuned.loops[0], duration=1.0)
    # The step's derivative is the impulse response; its transform is the compliance.
    T_v = tuned.controller.velocity_cycle
    impulse = np.diff(answer.deflection) / T_v
    omega = 2 * np.pi * tuned.nominal.weakest_frequency_hz
    compliance = abs(np.sum(impulse * np.exp(-1j * omega * answer.t[1:])) * T_v)
    assert compliance == pytest.approx(1.0 / tuned.nominal.dynamic_stiffness, rel=0.01)
