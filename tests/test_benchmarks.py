"""The benchmarks in small: they fail on wrong results, never on slow ones."""

from __future__ import annotations

import importlib
from dataclasses import replace

import pytest

from benchmarks.answer import Answer, judge
from benchmarks.problems import MAIN, find_problem
from mtcommission.optimal.control import Bang, constant_arc


def solve(module: str, problem: str, cells: int) -> Answer:
    prepare = importlib.import_module(f"benchmarks.peers.{module}").prepare
    answer = prepare(find_problem(problem), cells)()
    assert isinstance(answer, Answer)
    return answer


@pytest.mark.parametrize("name", [*MAIN, "F_max = 0.5 kN", "4 modes", "rest to rest"])
def test_our_control_is_exact_by_a_judgement_that_shares_nothing_with_the_solver(name):
    worth = judge(find_problem(name), solve("ours", name, 0))
    assert worth.terminal_error < 1e-9
    assert worth.violation < 1e-8
    assert worth.residual < 1e-12


def test_the_judgement_sees_a_control_that_is_a_little_wrong():
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
