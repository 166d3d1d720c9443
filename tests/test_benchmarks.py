"""The benchmarks in small: they fail on wrong results, never on slow ones."""

from __future__ import annotations

import importlib
from dataclasses import asdict, replace
from math import nan
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks import tools
from benchmarks.__main__ import with_row
from benchmarks.answer import Answer, grid_answer, judge
from benchmarks.child import Measurement, measure, read
from benchmarks.limits_quality import SEARCH, Score, rank, search_by_grid
from benchmarks.population import random_machine
from benchmarks.problems import MAIN, NAMES, find_problem
from benchmarks.race import Entry, entries, is_late, race, run
from benchmarks.report import compose_report
from benchmarks.tools import TOOLS, find_tool, is_installed, user_lines
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


def test_a_measurement_in_a_process_of_its_own_is_whole() -> None:
    row = run(Entry(tool=find_tool("mtcommission"), problem="P1", cells=0), seconds=10.0)
    assert not row.failure
    assert row.t_f == pytest.approx(solve("ours", "P1", 0).t_f, rel=1e-12)
    assert row.warm
    assert row.first > 0.0
    assert 20.0 < row.megabytes < 2000.0


def test_a_peer_that_is_missing_or_too_slow_is_shown_as_that() -> None:
    missing = replace(find_tool("gekko"), package="no_such_package")
    row = run(Entry(tool=missing, problem="P1", cells=100), seconds=1.0)
    assert row.failure == "not installed: pip install gekko"
    slow = replace(find_tool("CasADi/IPOPT, tuned"), cells=(10_000, 20_000))
    chain = [Entry(tool=slow, problem="P1", cells=cells) for cells in slow.cells]
    first, second = race(chain, seconds=2.0, workers=1, tell=lambda _: None)
    assert is_late(first)
    assert second.failure == "not tried: N = 10000 was too slow"


def test_a_failure_keeps_the_message_of_the_tool(tmp_path: Path) -> None:
    file = tmp_path / "row.json"
    tool = find_tool("HiGHS, linear programs").name
    measure(tool, "P3", cells=10, seconds=5.0, file=file)
    assert read(file).failure.startswith("NotImplementedError: linear programs only")


def test_every_tool_meets_every_problem() -> None:
    planned = {(entry.tool.name, entry.problem) for entry in entries(quick=False)}
    assert planned == {(tool.name, name) for tool in TOOLS for name in NAMES}


def test_lines_count_neither_documentation_nor_imports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = '"""What."""\n\nimport os\n\n# why\ndef f(\n    x,\n):\n    """Says."""\n    return x\n'
    (tmp_path / "ours.py").write_text(text, encoding="utf-8")
    monkeypatch.setattr(tools, "PEERS", tmp_path)
    assert user_lines(TOOLS[0]) == 4


def test_standings_count_only_machines_on_which_anything_meets() -> None:
    def score(seed: int, source: str, *, met: bool, time: float) -> Score:
        return Score(seed=seed, source=source, is_met=met, settling_time=time, seconds=0.0)

    scores = [
        score(0, SEARCH, met=True, time=1.0),
        score(0, "other", met=True, time=1.5),
        score(1, SEARCH, met=True, time=2.0),
        score(1, "other", met=False, time=1.0),
        score(2, SEARCH, met=False, time=2.0),
        score(2, "other", met=False, time=1.0),
    ]
    first, second = rank(scores)
    assert (first.source, first.machines, first.share_met) == (SEARCH, 2, 1.0)
    assert (second.share_met, second.ratio, second.sooner) == (0.5, 1.5, 0.0)


def test_a_plain_grid_never_finds_sooner_limits_than_the_search() -> None:
    machine = random_machine(2)
    plant, tuned = build_plant(machine), tune_loop(machine)
    brute = search_by_grid(machine, plant, tuned)
    found = choose_limits(machine, tuned).limits
    ours = evaluate(machine, tuned, found)
    assert brute.assessment.is_met
    assert ours.settling_time < 1.005 * brute.settling_time


def test_the_page_shows_ratios_failures_and_who_is_better() -> None:
    ours = Measurement(
        tool="mtcommission",
        problem="P1",
        cells=0,
        first=0.02,
        warm=(0.01, 0.012, 0.011),
        t_f=0.04,
        lower_bound=0.04,
        terminal_error=1e-14,
        residual=0.0,
        violation=0.0,
        megabytes=80.0,
    )
    faster = replace(ours, tool="gekko", cells=200, warm=(0.0055,), t_f=0.0404, lower_bound=nan)
    broken = Measurement(tool="dymos", problem="P1", cells=20, failure="ValueError: a | b")
    stamp = {"date": "", "commit": "", "machine": "", "load": [1.0], "versions": {"Python": "3"}}
    stamp |= {"seconds": 10.0, "workers": 1}
    section = {**stamp, "rows": [asdict(row) for row in (ours, faster, broken)]}
    page = compose_report({"race": section})
    assert "| gekko | 200 | 0.5 × | +1.0e-02 |" in page
    assert "| dymos | 20 | ValueError: a / b |" in page
    assert "Faster than this package: P1 (gekko, N = 200)" in page


def test_a_renewed_row_takes_the_place_of_the_old_one_and_the_page_says_so() -> None:
    old = Measurement(tool="mtcommission", problem="P1", cells=0, first=0.02, t_f=0.04)
    other = replace(old, tool="gekko", cells=200, first=0.2)
    rows = with_row([asdict(old), asdict(other)], asdict(replace(old, first=0.01)))
    assert [(row["tool"], row["first"]) for row in rows] == [("gekko", 0.2), ("mtcommission", 0.01)]
    begun = {"date": "monday", "commit": "c1", "machine": "", "load": [1.0], "versions": {}}
    begun |= {"seconds": 10.0, "workers": 1}
    renewed = [{**begun, "date": "tuesday", "commit": "c2", "tools": ["ours"], "problems": []}]
    page = compose_report({"race": {**begun, "rows": rows, "renewed": renewed}})
    assert "Renewed tuesday, commit c2, load 1.0, at most 10 s each: ours." in page
    assert "| gekko | 200 | 20 × |" in page
