"""rockit (KU Leuven): an optimal control problem in a few readable lines, on CasADi and IPOPT.

Its multiple shooting with the fourth-order Runge-Kutta step that it takes by default; the
free time is its ``FreeTime``. It gets the same rigid motion as a first guess as the others: without
one IPOPT ends far from the optimum, or nowhere, on some machines. rockit takes a guess point by
point, in a time that grows with the square of N (5 s with N = 200), so finer grids go without.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
from rockit import FreeTime, MultipleShooting, Ocp

from benchmarks.answer import Answer, grid_answer
from benchmarks.problems import Problem

GUESSED_CELLS = 200
"""Finest grid for which a guess costs less than the solve."""


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver; rockit transcribes inside the first solve."""
    given = problem.scaled()
    ocp = Ocp(T=FreeTime(1.0) if given.minimises_time else 1.0)
    x, u = ocp.state(given.order), ocp.control()
    ocp.set_der(x, ca.sparsify(ca.DM(given.A)) @ x + ca.sparsify(ca.DM(given.B)) @ u)
    ocp.subject_to(-1 <= (u <= 1))  # noqa: SIM300 - rockit reads it so
    ocp.subject_to(ocp.at_t0(x) == 0)
    ends = np.flatnonzero(given.fixed).tolist()
    ocp.subject_to(ocp.at_tf(x)[ends] == given.target[ends])
    for row in given.rows:
        ocp.subject_to(-1 <= (ca.DM(row).T @ x <= 1))  # noqa: SIM300
    if given.minimises_time:
        ocp.add_objective(ocp.T)
    else:
        ocp.add_objective(ocp.integral(u**2 + ca.DM(given.weights).T @ x**2))
    if cells <= GUESSED_CELLS:
        states, control = given.guess(cells + 1)
        ocp.set_initial(x, states.T)
        ocp.set_initial(u, control[:-1])
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
    ocp.solver("ipopt", {"expand": True, **quiet})
    ocp.method(MultipleShooting(N=cells, M=1, intg="rk"))

    def solve() -> Answer:
        found = ocp.solve()
        times, force = found.sample(u, grid="control")
        cost = np.nan if given.minimises_time else found.value(ocp.objective)
        return grid_answer(problem, force[:-1].reshape(-1, 1), time=times[-1], cost=cost)

    return solve
