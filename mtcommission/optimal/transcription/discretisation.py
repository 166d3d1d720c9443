"""The moves on a grid, and IPOPT: only door to CasADi's nonlinear programming.

The control is constant on each of N equal intervals of length h = t_f / N. With Z = h A every
scheme here is one linear relation between the ends of an interval,

    D(Z) x_{k+1} = E(Z) x_k + h B u_k,

    Euler               D = I                     E = I + Z                 order 1
    trapezoidal         D = I - Z / 2             E = I + Z / 2             order 2
    Gauss, two stages   D = I - Z / 2 + Z² / 12   E = I + Z / 2 + Z² / 12   order 4

States are scaled by what F_max could cause, the force by F_max, time by a first guess of t_f.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import nan
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import Bound
from mtcommission.optimal.transcription.settings import Scheme, TranscriptionSettings
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

LONGEST = 100.0
"""Longest final time that is searched, in units of its first guess."""


class Aim(Enum):
    """What is optimised: of these the second and third are convex."""

    TIME = "least final time"
    FUNCTIONAL = "least functional by a given time"
    REACH = "largest multiple of the target by a given time"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridProblem:
    """A move to be solved on a grid, in scaled quantities."""

    # A, B: Scaled plant, shapes (n, n), (n,) [1/s].
    A: Array
    B: Array
    target: Array  # Scaled terminal state, shape (n,)
    fixed: NDArray[np.bool_]  # Which states are prescribed at t_f, shape (n,)
    t_guess: float  # Unit of time [s]: the final time itself where it is given
    aim: Aim  # What is optimised
    weights: Array  # Scaled weights of the squared states, shape (n,); for the functional
    rows: Array  # Bounded signals, |rows x| <= 1 at the grid points, shape (k, n)
    # start_states, start_control: Where IPOPT starts: shapes (N + 1, n), (N,).
    start_states: Array
    start_control: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridSolution:
    """What IPOPT found, in scaled quantities."""

    t_f: float  # [s]
    states: Array  # At the grid points, shape (N + 1, n)
    control: Array  # u of each interval, shape (N,)
    # λ of each interval, shape (N, n), for ∫ 1 dt or the functional [s per scaled state].
    adjoint: Array
    adjoint_initial: Array  # λ(0), shape (n,), to the order of the grid
    # reach, reach_rate: Multiple of the target that is reached, and its increase per time [-,
    # 1/s]; 1 and nan where the target itself is.
    reach: float
    reach_rate: float


def bounded_rows(plant: Plant, bounds: tuple[Bound, ...], *, state_scale: Array) -> Array:
    """Return the bounded signals as rows on the scaled state, each divided by its bound."""
    rows = [plant.row(bound.name) * state_scale / bound.value for bound in bounds]
    return np.array(rows).reshape(len(bounds), plant.order)


def solve_grid(problem: GridProblem, settings: TranscriptionSettings) -> GridSolution:
    """Return the optimum of the discretised problem.

    Raises
    ------
    ComputationError
        FINAL_TIME_TOO_SHORT if IPOPT finds a move with given t_f infeasible,
        BOUND_CANNOT_HOLD if one with free t_f, NO_CONVERGENCE for its other failures.
    """
    n, N = problem.target.size, settings.intervals
    program = _program(problem, settings)
    options = _options(problem, settings, program)
    solver = ca.nlpsol("transcription", "ipopt", program, options)
    low, high = _box(problem, N)
    equal = np.zeros(n * N + _end_rows(problem).size)
    limit = np.ones(problem.rows.shape[0] * N)
    answer = solver(
        x0=_start(problem),
        p=problem.t_guess,
        lbx=low,
        ubx=high,
        lbg=np.concatenate([equal, -limit]),
        ubg=np.concatenate([equal, limit]),
    )
    stats = solver.stats()
    _check(problem, settings, stats)
    point = np.asarray(answer["x"]).ravel()
    last, reach_rate, unit = float(point[-1]), nan, 1.0 / _weight(problem, N)
    t_f = problem.t_guess * (last if problem.aim is Aim.TIME else 1.0)
    if problem.aim is Aim.REACH:
        reach_rate = float(answer["lam_p"]) * unit
        unit /= reach_rate * t_f
    multipliers = np.asarray(answer["lam_g"]).ravel()[: n * N].reshape(N, n)
    adjoint = -problem.t_guess * unit * multipliers
    _, E = _scheme_matrices(settings.scheme, t_f / N * problem.A)
    return GridSolution(
        t_f=t_f,
        states=point[: n * (N + 1)].reshape(N + 1, n),
        control=point[n * (N + 1) : n * (N + 1) + N],
        adjoint=adjoint,
        adjoint_initial=np.asarray(E.T @ adjoint[0]),
        reach=last if problem.aim is Aim.REACH else 1.0,
        reach_rate=reach_rate,
    )


def _program(problem: GridProblem, settings: TranscriptionSettings) -> dict[str, Any]:
    """Return the program over states, controls, and the final time or the multiple."""
    n, N = problem.target.size, settings.intervals
    x, u, last = ca.MX.sym("x", n, N + 1), ca.MX.sym("u", 1, N), ca.MX.sym("last")
    unit = ca.MX.sym("unit")  # of time: a parameter, for the sensitivity to the final time
    step = unit * (last if problem.aim is Aim.TIME else 1.0) / N
    defect = _defect(problem, settings.scheme).map(N)
    defects = defect(x[:, :-1], x[:, 1:], u, ca.repmat(step, 1, N))
    ends = _end_rows(problem).tolist()
    missed = x[ends, -1] - last * ca.DM(problem.target[ends])
    if problem.aim is Aim.FUNCTIONAL:
        cost, variables = _cost(problem, settings.scheme, x, u), [ca.vec(x), ca.vec(u)]
    else:
        sign = 1.0 if problem.aim is Aim.TIME else -1.0
        cost, variables = sign * last, [ca.vec(x), ca.vec(u), last]
    bounded = ca.vec(ca.DM(problem.rows) @ x[:, 1:])
    return {
        "x": ca.vertcat(*variables),
        "p": unit,
        "f": _weight(problem, N) * cost,
        "g": ca.vertcat(ca.vec(defects), missed, bounded),
    }


def _weight(problem: GridProblem, N: int) -> float:
    """Return the factor on the objective.

    The multipliers of a force or a bound on one interval are about 1/N of the objective. N times
    it makes them about 1, where IPOPT's barrier begins and ends; with multipliers of 1e-4
    it loses the centre under bounds, and takes hundreds of steps of 1e-3 (N = 10 000). With an
    unknown t_f the program is solved on coarse grids alone, and the factor gains nothing.
    """
    return 1.0 if problem.aim is Aim.TIME else float(N)


def _end_rows(problem: GridProblem) -> NDArray[np.intp]:
    """Return the states of which a multiple is to be reached."""
    return np.flatnonzero(problem.fixed & (problem.aim is Aim.REACH))


def _scheme_matrices(scheme: Scheme, Z: Any) -> tuple[Any, Any]:
    one = np.eye(Z.shape[0])
    if scheme is Scheme.EULER:
        return one, one + Z
    second = Z @ Z / 12 if scheme is Scheme.GAUSS else 0.0
    return one - Z / 2 + second, one + Z / 2 + second


def _defect(problem: GridProblem, scheme: Scheme) -> Any:
    n = problem.target.size
    x, x_next = ca.SX.sym("x", n), ca.SX.sym("x_next", n)
    u, step = ca.SX.sym("u"), ca.SX.sym("step")
    # sparsified, so that the derivatives carry only the plant's own couplings
    D, E = _scheme_matrices(scheme, step * ca.SX(ca.sparsify(ca.DM(problem.A))))
    return ca.Function("defect", [x, x_next, u, step], [D @ x_next - E @ x - step * problem.B * u])


def _cost(problem: GridProblem, scheme: Scheme, x: Any, u: Any) -> Any:
    """Return the functional divided by F_max² t_f, with a quadrature of the scheme's order."""
    weights = ca.DM(problem.weights).T
    N = u.shape[1]
    if scheme is Scheme.EULER:
        squares = ca.sum2(weights @ x[:, :-1] ** 2)
    else:
        ends = ca.sum2(weights @ (x[:, :-1] ** 2 + x[:, 1:] ** 2))
        squares = ends / 2
        if scheme is Scheme.GAUSS:
            Z = problem.A * (problem.t_guess / N)
            middle = (x[:, :-1] + x[:, 1:]) / 2 + ca.DM(Z) @ (x[:, :-1] - x[:, 1:]) / 8
            squares = ends / 6 + ca.sum2(weights @ middle**2) * (2 / 3)
    return (ca.sumsqr(u) + squares) / N


def _options(
    problem: GridProblem, settings: TranscriptionSettings, program: dict[str, Any]
) -> dict[str, Any]:
    options: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.max_iter": settings.max_iterations,
        "ipopt.tol": settings.tolerance * _weight(problem, settings.intervals),
        # not scaled with the objective: errors of all intervals add up at t_f
        "ipopt.constr_viol_tol": settings.tolerance,
        "ipopt.acceptable_iter": 0,
        "ipopt.honor_original_bounds": "yes",
    }
    if problem.aim is Aim.TIME:
        options["hess_lag"] = _no_curvature(program)
    else:
        constant = ("jac_c_constant", "jac_d_constant", "hessian_constant")
        options |= {f"ipopt.{name}": "yes" for name in constant}
        options["ipopt.nlp_scaling_method"] = "none"  # it would undo the factor
    return options


def _no_curvature(program: dict[str, Any]) -> Any:
    """Return a zero Hessian of the Lagrangian for the free-time problem.

    The true one is bilinear in t_f and the rest, hence indefinite, and IPOPT crawls under the
    regularisation that this calls for. A shortest move is a vertex of its constraints, as in
    a linear program, so that Newton's method on these alone converges as fast.
    """
    size, rows = program["x"].shape[0], program["g"].shape[0]
    arguments = [ca.MX.sym("x", size), ca.MX.sym("p"), ca.MX.sym("f"), ca.MX.sym("g", rows)]
    return ca.Function(
        "no_curvature",
        arguments,
        [ca.MX(ca.Sparsity(size, size))],
        ["x", "p", "lam_f", "lam_g"],
        ["triu_hess_gamma_x_x"],
    )


def _box(problem: GridProblem, N: int) -> tuple[Array, Array]:
    n = problem.target.size
    low, high = np.full((N + 1, n), -np.inf), np.full((N + 1, n), np.inf)
    low[0] = high[0] = 0.0
    if problem.aim is not Aim.REACH:
        low[-1, problem.fixed] = high[-1, problem.fixed] = problem.target[problem.fixed]
    parts_low, parts_high = [low.ravel(), -np.ones(N)], [high.ravel(), np.ones(N)]
    if problem.aim is not Aim.FUNCTIONAL:
        least, most = (1e-3, LONGEST) if problem.aim is Aim.TIME else (-np.inf, np.inf)
        parts_low.append(np.array([least]))
        parts_high.append(np.array([most]))
    return np.concatenate(parts_low), np.concatenate(parts_high)


def _start(problem: GridProblem) -> Array:
    last = np.ones(int(problem.aim is not Aim.FUNCTIONAL))
    return np.concatenate([problem.start_states.ravel(), problem.start_control, last])


def _check(problem: GridProblem, settings: TranscriptionSettings, stats: dict[str, Any]) -> None:
    status = str(stats["return_status"])
    if status == "Solve_Succeeded":
        return
    detail = Message(
        "ipopt-ended",
        status=status,
        iterations=int(stats["iter_count"]),
        scheme=settings.scheme.value,
        intervals=settings.intervals,
    )
    infeasible = status == "Infeasible_Problem_Detected"
    free_time = problem.aim is Aim.TIME
    if problem.aim is Aim.REACH or not infeasible or (free_time and not problem.rows.size):
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    if free_time:
        raise ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)
    raise ComputationError(
        Outcome.FINAL_TIME_TOO_SHORT,
        Message("ipopt-ended-at", t_f=problem.t_guess, ended=detail),
    )
