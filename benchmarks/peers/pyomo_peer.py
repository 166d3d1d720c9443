"""pyomo.dae: collocation on Radau points by its own transformation, solved by IPOPT.

The control is held on each interval, as its documentation advises. pyomo talks to solvers
through AMPL's .nl files: an ``ipopt`` program if there is one on the path, else the IPOPT inside
CasADi, which reads the same file.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pyomo.dae as dae
import pyomo.environ as pyo

from benchmarks.answer import Answer, grid_answer
from benchmarks.problems import Problem, Scaled

POINTS = 3


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver of a model that is discretised once."""
    given = problem.scaled()
    model = _model(given, cells)
    unknowns = list(model.component_data_objects(pyo.Var))
    guess = [unknown.value for unknown in unknowns]

    def solve() -> Answer:
        for unknown, value in zip(unknowns, guess, strict=True):
            unknown.set_value(value, skip_validation=True)
        if pyo.SolverFactory("ipopt").available(exception_flag=False):
            pyo.SolverFactory("ipopt").solve(model, load_solutions=True)
        else:
            _solve_by_casadi(model)
        edges = list(model.tau.get_finite_elements())
        force = np.array([[pyo.value(model.u[edge])] for edge in edges[1:]])
        cost = np.nan if given.minimises_time else pyo.value(model.aim)
        return grid_answer(problem, force, time=pyo.value(model.time), cost=cost)

    return solve


def _model(given: Scaled, cells: int) -> Any:
    model, n = pyo.ConcreteModel(), given.order
    model.tau, model.i = dae.ContinuousSet(bounds=(0, 1)), pyo.RangeSet(0, n - 1)
    model.x = pyo.Var(model.i, model.tau, initialize=lambda m, i, t: t * given.target[i])
    model.u = pyo.Var(model.tau, bounds=(-1, 1), initialize=0.5)
    model.dx = dae.DerivativeVar(model.x, wrt=model.tau)
    model.time = pyo.Var(bounds=(0.1, 10), initialize=1.0)
    if not given.minimises_time:
        model.time.fix(1.0)

    def motion(m: Any, i: int, t: float) -> Any:
        terms = [given.A[i, k] * m.x[k, t] for k in range(n) if given.A[i, k]]
        if given.B[i]:
            terms.append(given.B[i] * m.u[t])
        return m.dx[i, t] == m.time * sum(terms)

    def bounded(m: Any, k: int, t: float) -> Any:
        row = given.rows[k]
        return -1, sum(row[i] * m.x[i, t] for i in range(n) if row[i]), 1

    model.motion = pyo.Constraint(model.i, model.tau, rule=motion)
    if given.rows.size:
        rows = range(given.rows.shape[0])
        model.bounded = pyo.Constraint(rows, model.tau, rule=bounded)
    for i in range(n):
        model.x[i, 0].fix(0.0)
        if given.fixed[i]:
            model.x[i, 1].fix(given.target[i])
    if given.minimises_time:
        model.aim = pyo.Objective(expr=model.time)
    else:
        weighted = [i for i in range(n) if given.weights[i]]
        model.squares = dae.Integral(
            model.tau,
            wrt=model.tau,
            rule=lambda m, t: (
                m.u[t] ** 2 + sum(given.weights[i] * m.x[i, t] ** 2 for i in weighted)
            ),
        )
        model.aim = pyo.Objective(expr=model.squares)
    method = pyo.TransformationFactory("dae.collocation")
    method.apply_to(model, nfe=cells, ncp=POINTS, scheme="LAGRANGE-RADAU", wrt=model.tau)
    method.reduce_collocation_points(model, var=model.u, ncp=1, contset=model.tau)
    return model


def _solve_by_casadi(model: Any) -> None:
    """Solve through the .nl file with CasADi's IPOPT and write the solution back."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.nl"
        _, key = model.write(str(path), format="nl")
        program = ca.NlpBuilder()
        program.import_nl(str(path))
        names = model.solutions.symbol_map[key].bySymbol
    nlp = {"x": ca.vertcat(*program.x), "f": program.f, "g": ca.vertcat(*program.g)}
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
    solver = ca.nlpsol("pyomo", "ipopt", nlp, {**quiet, "error_on_fail": True, "expand": True})
    bounds = {"lbx": program.x_lb, "ubx": program.x_ub, "lbg": program.g_lb, "ubg": program.g_ub}
    found = np.asarray(solver(x0=program.x_init, **bounds)["x"]).ravel()
    for i, value in enumerate(found.tolist()):
        names[f"v{i}"].set_value(value, skip_validation=True)
