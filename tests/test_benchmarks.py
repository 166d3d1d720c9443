"""The benchmarks in small: they fail on wrong results, never on slow ones."""

from __future__ import annotations

import importlib
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.answer import Answer, grid_answer, judge
from benchmarks.limits_quality import search_by_grid
from benchmarks.population import random_machine
from benchmarks.problems import MAIN, find_problem
from benchmarks.tools import find_tool, is_installed
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.judge import evaluate
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.plant.plant import build_plant
from mtcommission.optimal.control import Bang, constant_arc


def solve(module: str, problem: str, cells: int) -> Answer:
    prepare = importlib.import_module(f"benchmarks.peers.{module}").prepare
    answer = prepare(find_problem(problem), cells)()
    assert isinstance(answer, Answer)
    return answer


@pytest.mark.parametrize("name", [*MAIN, "F_max = 0.5 kN", "4 modes", "rest to rest"])
def test_our_control_is_exact_by_a_judgement_that_shares_nothing_with_the_solver(name: str) -> None:
    worth = judge(find_problem(name), solve("ours", name, 0))
    assert worth.terminal_error < 1e-9
    assert worth.violation < 1e-8
    assert worth.residual < 1e-12


def test_linear_programs_come_near_the_certified_time_and_never_below_its_bound() -> None:
    # Force held on a grid and integrated exactly: admissible, so it cannot beat a true bound.
    ours, peer = solve("ours", "P1", 0), solve("highs_reach", "P1", 300)
    assert ours.lower_bound * (1.0 - 1e-9) <= peer.t_f < ours.t_f * (1.0 + 1e-4)
    assert judge(find_problem("P1"), peer).terminal_error < 1e-6


def test_linear_programs_under_a_bound_agree_with_the_certified_time() -> None:
    ours, peer = solve("ours", "P2", 0), solve("highs_reach", "P2", 100)
    assert peer.t_f == pytest.approx(ours.t_f, rel=3e-3)
    assert judge(find_problem("P2"), peer).violation < 0.05


def test_linear_programs_refuse_a_quadratic_functional_rather_than_answer_something_else() -> None:
    with pytest.raises(NotImplementedError, match="linear programs only"):
        solve("highs_reach", "P3", 50)


@pytest.mark.parametrize(
    ("module", "error"), [("casadi_euler", 1e-2), ("casadi_collocation", 1e-3)]
)
def test_transcriptions_with_ipopt_agree_with_the_damping_optimum(
    module: str, error: float
) -> None:
    ours, peer = solve("ours", "P3", 0), solve(module, "P3", 150)
    assert peer.cost == pytest.approx(ours.cost, rel=error)


def test_collocation_with_ipopt_agrees_with_the_time_optimum() -> None:
    ours, peer = solve("ours", "P1", 0), solve("casadi_collocation", "P1", 100)
    assert peer.t_f == pytest.approx(ours.t_f, rel=1e-3)
    assert judge(find_problem("P1"), peer).terminal_error < 1e-5


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("name", "cells", "error"),
    [("rockit", 30, 5e-3), ("pyomo.dae", 30, 5e-3), ("gekko", 60, 5e-3), ("dymos", 12, 2e-2)],
)
def test_optional_peers_agree_with_the_time_optimum(name: str, cells: int, error: float) -> None:
    if not is_installed(find_tool(name)):
        pytest.skip(f"{name} is not installed: pip install '.[peers]'")
    peer = solve(find_tool(name).module, "P1", cells)
    assert peer.t_f == pytest.approx(solve("ours", "P1", 0).t_f, rel=error)


def test_the_judgement_integrates_like_an_ordinary_integrator() -> None:
    problem = find_problem("P2")
    coefficients = np.array([[0.5, 0.2], [-0.9, 1.2], [0.1, -0.6]])
    answer = grid_answer(problem, coefficients, time=0.8)
    length = answer.t_f / 3
    x, largest = np.zeros(problem.plant.order), 0.0
    for start, slope in coefficients:
        force = lambda t, a=start, b=slope: 2e3 * (a + b * t / length)  # noqa: E731
        motion = solve_ivp(
            lambda t, x, u=force: problem.plant.A @ x + problem.plant.B * u(t),
            (0.0, length),
            x,
            method="DOP853",
            rtol=1e-11,
            atol=1e-18,
            max_step=length / 400,
        )
        x = motion.y[:, -1]
        largest = max(largest, float(np.abs(motion.y[5]).max()))
    expected = np.abs(x / problem.state_scale - problem.scaled().target)[problem.scaled().fixed]
    worth = judge(problem, answer)
    assert worth.terminal_error == pytest.approx(expected.max(), rel=1e-8)
    assert worth.violation == pytest.approx(largest / 0.005 - 1.0, rel=1e-4)


def test_the_judgement_sees_a_control_that_is_a_little_wrong() -> None:
    ours, problem = solve("ours", "P1", 0), find_problem("P1")
    first, second, *rest = ours.arcs
    late = first.t_end + 1e-5
    shifted = Answer(
        t_f=ours.t_f,
        arcs=(replace(first, t_end=late), replace(second, t_start=late), *rest),
    )
    assert judge(problem, shifted).terminal_error > 1e-4
    strong = constant_arc(0.0, ours.t_f, control=Bang(1), force=2.2e3)
    assert judge(problem, Answer(t_f=ours.t_f, arcs=(strong,))).violation == pytest.approx(0.1)


def test_residual_is_the_amplitude_with_which_the_tool_swings_on() -> None:
    # Cut off before its end, the move leaves a vibration; the true one is sampled over a period.
    problem = find_problem("P1")
    held = grid_answer(problem, np.ones((1, 1)), time=0.3)
    plant = problem.plant
    rest = solve_ivp(
        lambda _, x: plant.A @ x + plant.B * 2e3, (0.0, held.t_f), np.zeros(plant.order), rtol=1e-10
    ).y[:, -1]
    total = 0.0
    for mode in plant.modes:
        omega, zeta = mode.natural_frequency, mode.damping_ratio
        q, rate = rest[mode.deflection] / mode.scale, rest[mode.rate] / mode.scale
        free = solve_ivp(
            lambda _, z, w=omega, d=zeta: [z[1], -2 * d * w * z[1] - w**2 * z[0]],
            (0.0, 4 * np.pi / omega),
            [q, rate],
            rtol=1e-9,
            atol=1e-15,
            max_step=0.01 / omega,
        )
        envelope = free.y[0] * np.exp(zeta * omega * free.t)
        total += abs(mode.tcp_gain) * np.abs(envelope).max()
    assert judge(problem, held).residual == pytest.approx(total, rel=1e-3)


def test_a_plain_grid_never_finds_sooner_limits_than_the_search() -> None:
    machine = random_machine(2)
    plant, tuned = build_plant(machine), tune_loop(machine)
    brute = search_by_grid(machine, plant, tuned)
    found = choose_limits(machine, tuned).limits
    ours = evaluate(machine, tuned, found)
    assert brute.assessment.is_met
    assert ours.settling_time < 1.005 * brute.settling_time
