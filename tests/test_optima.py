"""The reference of a move, exact where it can be had and honest where it is composed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks.fuzz import call
from mtcommission.errors import ComputationError, Outcome
from mtcommission.limits.optima import find_optima
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.composed import compose_time_optimum
from mtcommission.plant.plant import Plant, build_plant
from tests.machines import paper_machine, random_modal_machine

PROFILES = Path(__file__).parent.parent / "profiles"


def rigid_end(plant: Plant, move: Move) -> NDArray[np.float64]:
    target = np.zeros(plant.order)
    if isinstance(move, Positioning):
        target[plant.position] = move.distance
    else:
        target[plant.velocity] = move.velocity_step
    return target


@pytest.mark.parametrize("seed", [2, 3, 11])
@pytest.mark.parametrize(
    "move",
    [
        Positioning(distance=0.5, max_velocity=0.3),
        Positioning(distance=2e-4, max_velocity=0.3),
        Positioning(distance=0.05),
        VelocityStep(velocity_step=0.1),
    ],
    ids=["cruise", "shorter than a period", "no max_velocity", "velocity step"],
)
def test_composed_move_rests_at_its_target_when_somebody_else_integrates_it(
    seed: int, move: Move
) -> None:
    """A stand-in for the optimum must at least be a control that does the move."""
    machine = random_modal_machine(seed, n_modes=2)
    plant = build_plant(machine)
    force = machine.drive.motion_force
    found = compose_time_optimum(plant, move, force_limit=force)
    state = np.zeros(plant.order)
    fastest = most = 0.0
    for arc in found.arcs:
        u = float(arc.output @ arc.initial)
        solved = solve_ivp(
            lambda _, x, u=u: plant.A @ x + plant.B * u,
            (arc.t_start, arc.t_end),
            state,
            method="DOP853",
            rtol=1e-10,
            atol=1e-13,
            max_step=2e-3,
        )
        fastest = max(fastest, float(np.max(np.abs(solved.y[plant.velocity]))))
        most = max(most, abs(u))
        state = solved.y[:, -1]
    error = np.abs(state - rigid_end(plant, move))
    if isinstance(move, VelocityStep):
        error[plant.position] = 0.0  # where it ends is free
    assert np.all(error < 1e-6 * found.peaks[: plant.order])
    assert most <= force * (1.0 + 1e-12)
    assert found.certificate.t_f_lower_bound < found.t_f
    if isinstance(move, Positioning):
        assert fastest <= move.max_velocity * (1.0 + 1e-6)


def test_exact_optimum_is_between_composed_time_and_its_bound() -> None:
    """The bound must hold for the certified optimum, and composing must not beat it."""
    machine = paper_machine()
    plant = build_plant(machine)
    move = Positioning(distance=0.012, max_velocity=0.1)
    composed = compose_time_optimum(plant, move, force_limit=2e3)
    exact = solve_bounded_time_optimal(plant, move, force_limit=2e3, bounds=())
    assert composed.certificate.t_f_lower_bound <= exact.certificate.t_f_lower_bound
    assert exact.t_f <= composed.t_f * (1.0 + 1e-9)


def test_reference_that_had_to_be_composed_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reader must see that the reference is not the optimum itself, and how far it can be."""

    def gives_up(*_: object, **__: object) -> None:
        raise ComputationError(Outcome.NO_CONVERGENCE, Message("foreign", text="exact search"))

    monkeypatch.setattr("mtcommission.limits.optima.solve_bounded_time_optimal", gives_up)
    machine = paper_machine()
    move = Positioning(distance=0.2, max_velocity=0.1)
    machine = replace(machine, moves=(move,))
    found = find_optima(machine, build_plant(machine), move)
    assert found.time.method == "composed"
    assert "Nothing is faster than" in Catalogue().say(found.remarks[0])
    code, said = call("optimal", str(PROFILES / "rack-gantry.toml"), "--kind", "time")
    assert code == 0
    assert "The time-optimal control was not found" in said
    assert "Switching law" not in said
