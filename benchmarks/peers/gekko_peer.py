"""gekko (BYU): equations as text, orthogonal collocation, its own solver programs on this machine.

The final time is a fixed value that scales the derivatives and is minimised at the last point, as
in gekko's minimum-time examples. IPOPT (SOLVER 3), three nodes a step, the force held on each step
(MV_TYPE 0) and its first value free; the values that gekko reports hold from their instant on.
``fix_final`` states the end; the equation that its forum prefers ends with "Solution Not Found".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from gekko import GEKKO

from benchmarks.answer import Answer, grid_answer
from benchmarks.problems import Problem, Scaled

NODES = 3


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver; a model that was solved would start from its solution, one step on."""

    def solve() -> Answer:
        given = problem.scaled()
        m, x, u, time = _model(given, cells)
        m.solve(disp=False)
        force = np.array(list(u.value))[:-1].reshape(-1, 1)
        squares = np.array(list(u.value))[1:] ** 2
        for weight, state in zip(given.weights, x, strict=False):
            squares = squares + weight * np.array(list(state.value))[1:] ** 2
        cost = np.nan if given.minimises_time else squares.mean()
        return grid_answer(problem, force, time=time.value[0], cost=cost)

    return solve


def _model(given: Scaled, cells: int) -> tuple[Any, list[Any], Any, Any]:
    """Return the model, its states, control and final time."""
    n = given.order
    m = GEKKO(remote=False)
    m.time = np.linspace(0.0, 1.0, cells + 1)
    states, control = given.guess(cells + 1)
    u = m.MV(value=control, lb=-1, ub=1, fixed_initial=False)
    u.STATUS, u.DCOST = 1, 0
    x = [m.Var(value=column) for column in states.T]
    time = m.FV(value=1.0, lb=0.1, ub=10)
    time.STATUS = int(given.minimises_time)
    last = m.Param(value=np.append(np.zeros(cells), 1.0))
    for i in range(n):
        terms = [float(given.A[i, k]) * x[k] for k in range(n) if given.A[i, k]]
        if given.B[i]:
            terms.append(float(given.B[i]) * u)
        m.Equation(x[i].dt() == time * sum(terms))
        if given.fixed[i]:
            m.fix_final(x[i], val=float(given.target[i]))
    for row in given.rows:
        signal = m.Var(value=0.0, lb=-1, ub=1)
        m.Equation(signal == sum(float(row[i]) * x[i] for i in range(n) if row[i]))
    if given.minimises_time:
        m.Minimize(time * last)
    else:
        weighted = sum(float(given.weights[i]) * x[i] ** 2 for i in range(n) if given.weights[i])
        m.Minimize((u**2 + weighted) / cells)
    m.options.IMODE, m.options.NODES, m.options.SOLVER, m.options.MV_TYPE = 6, NODES, 3, 0
    m.options.MAX_ITER = 3000
    return m, x, u, time
