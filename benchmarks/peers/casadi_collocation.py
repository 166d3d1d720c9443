"""CasADi with direct collocation (three Radau points, order 5) and IPOPT.

Follows CasADi's own direct collocation example, with its helper for the coefficients and the
intervals mapped rather than looped over; the control is constant on each interval.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from benchmarks.answer import Answer, grid_answer
from benchmarks.problems import Problem

DEGREE = 3


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver of a program that is built once."""
    given, N, n = problem.scaled(), cells, problem.plant.order
    C, D, quadrature = ca.collocation_coeff(ca.collocation_points(DEGREE, "radau"))
    A, B = ca.sparsify(ca.DM(given.A)), ca.sparsify(ca.DM(given.B))
    start, inner = ca.SX.sym("start", n), ca.SX.sym("inner", n, DEGREE)
    force, step = ca.SX.sym("force"), ca.SX.sym("step")
    nodes = ca.horzcat(start, inner)
    defect = nodes @ C - step * (A @ inner + ca.repmat(B * force, 1, DEGREE))
    squares = force**2
    if given.weights.size:
        squares += (ca.DM(given.weights).T @ inner**2) @ quadrature
    cell = ca.Function(
        "cell", [start, inner, force, step], [ca.vec(defect), nodes @ D, step * squares]
    )
    opti = ca.Opti()
    x, points = opti.variable(n, N + 1), opti.variable(n, DEGREE * N)
    u = opti.variable(1, N)
    time = opti.variable() if given.minimises_time else ca.MX(1.0)
    defects, end, terms = cell.map(N)(x[:, :-1], points, u, ca.repmat(time / N, 1, N))
    opti.subject_to(ca.vec(defects) == 0)
    opti.subject_to(ca.vec(x[:, 1:] - end) == 0)
    opti.subject_to(opti.bounded(-1, u, 1))
    opti.subject_to(x[:, 0] == 0)
    ends = np.flatnonzero(given.fixed).tolist()
    opti.subject_to(x[ends, -1] == given.target[ends])
    for row in given.rows:
        opti.subject_to(opti.bounded(-1, ca.DM(row).T @ points, 1))
    if given.minimises_time:
        opti.subject_to(opti.bounded(0.1, time, 10))
        opti.set_initial(time, 1.0)
    opti.minimize(time if given.minimises_time else ca.sum2(terms))
    states, control = given.guess(N + 1)
    opti.set_initial(x, states.T)
    opti.set_initial(points, np.repeat(states[1:], DEGREE, axis=0).T)
    opti.set_initial(u, control[:-1])
    opti.solver("ipopt", {"print_time": False, "expand": True}, {"print_level": 0, "sb": "yes"})

    def solve() -> Answer:
        found = opti.solve()
        force = np.asarray(found.value(u)).reshape(N, 1)
        cost = np.nan if given.minimises_time else found.value(opti.f)
        return grid_answer(problem, force, time=found.value(time), cost=cost)

    return solve
