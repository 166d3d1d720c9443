"""Wrong gains would make a loop that the tables call best by a rule it does not follow."""

from __future__ import annotations

from pathlib import Path

import control
import numpy as np
import pytest

from benchmarks.population import random_machine
from mtcommission.loop.tuning import gains
from mtcommission.loop.tuning.gains import observer_gains, regulator_gains
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.profile.read import read_profile
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine, random_modal_machine

MACHINES = {
    "paper": paper_machine(),
    "two encoders": quiet_copy(paper_machine(), has_tcp_sensor=True),
    "belt": read_profile(Path("tests/data/belt-servo.toml")),
    "one mode": random_modal_machine(3, n_modes=1),
    "population": random_machine(3),
}


@pytest.mark.parametrize("name", MACHINES)
def test_gains_are_those_of_python_control(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every equation of a whole tuning, solved by a second program."""
    asked = []

    def regulator(A: np.ndarray, B: np.ndarray, Q: np.ndarray) -> np.ndarray:
        ours = regulator_gains(A, B, Q)
        theirs, _, _ = control.lqr(A, B[:, None], Q, np.eye(1))
        asked.append(np.max(np.abs(ours - theirs[0])) / np.max(np.abs(theirs)))
        return ours

    def observer(A: np.ndarray, G: np.ndarray, C: np.ndarray) -> np.ndarray:
        ours = observer_gains(A, G, C)
        theirs, _, _ = control.dlqe(A, G, C, np.eye(G.shape[1]), np.eye(len(C)))
        asked.append(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))
        return ours

    monkeypatch.setattr(gains, "regulator_gains", regulator)
    monkeypatch.setattr(gains, "observer_gains", observer)
    auto = quiet_copy(MACHINES[name], state_feedback=StateFeedback.AUTO)
    tune_loop(auto)
    assert len(asked) >= 3  # the observer and both weights
    assert max(asked) < 1e-8


def test_what_nothing_damps_has_no_gains() -> None:
    """An oscillator beside the drive would get gains that leave it ringing, without a word."""
    A = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    B, Q = np.array([0.0, 0.0, 1.0]), np.eye(3)
    with pytest.raises(np.linalg.LinAlgError, match="damps every state"):
        regulator_gains(A, B, Q)
    with pytest.raises(np.linalg.LinAlgError, match="not finite"):
        regulator_gains(A, B, np.diag([1.0, np.inf, 1.0]))
