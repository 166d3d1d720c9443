"""CasADi's Opti stack with Euler's method and IPOPT: the paper's own way, in today's idiom.

One matrix of states, one of controls, the dynamics as one vectorised constraint; IPOPT with
exact derivatives and its defaults. The free final time is a variable that scales the step.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from benchmarks.answer import Answer, grid_answer
from benchmarks.problems import Problem


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver of a program that is built once."""
    given, N = problem.scaled(), cells
    opti = ca.Opti()
    x, u = opti.variable(given.order, N + 1), opti.variable(1, N)
    time = opti.variable() if given.minimises_time else 1.0
    A, B = ca.sparsify(ca.DM(given.A)), ca.sparsify(ca.DM(given.B))
    opti.subject_to(x[:, 1:] == x[:, :-1] + time / N * (A @ x[:, :-1] + B @ u))
    opti.subject_to(opti.bounded(-1, u, 1))
    opti.subject_to(x[:, 0] == 0)
    ends = np.flatnonzero(given.fixed).tolist()
    opti.subject_to(x[ends, -1] == given.target[ends])
    for row in given.rows:
        opti.subject_to(opti.bounded(-1, ca.DM(row).T @ x[:, 1:], 1))
    if given.minimises_time:
        opti.subject_to(opti.bounded(0.1, time, 10))
        opti.set_initial(time, 1.0)
        opti.minimize(time)
    else:
        weighted = ca.DM(given.weights).T @ x[:, :-1] ** 2
        opti.minimize((ca.sumsqr(u) + ca.sum2(weighted)) / N)
    states, control = given.guess(N + 1)
    opti.set_initial(x, states.T)
    opti.set_initial(u, control[:-1])
    opti.solver("ipopt", {"print_time": False, "expand": True}, {"print_level": 0, "sb": "yes"})

    def solve() -> Answer:
        found = opti.solve()
        force = np.asarray(found.value(u)).reshape(N, 1)
        cost = np.nan if given.minimises_time else found.value(opti.f)
        return grid_answer(problem, force, time=found.value(time), cost=cost)

    return solve
