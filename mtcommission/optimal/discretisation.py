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
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.optimal.solution import Bound
from mtcommission.plant import Plant

Array = NDArray[np.float64]

REFINED_BARRIER = 1e-6
"""First barrier parameter, and distance from the bounds, on a refined grid (empirical)."""

LONGEST = 100.0
"""Longest final time that is searched, in units of its first guess."""


class Scheme(Enum):
    """Integration scheme of one interval."""

    EULER = "euler"
    TRAPEZOIDAL = "trapezoidal"
    GAUSS = "gauss"


@dataclass(frozen=True, slots=True, kw_only=True)
class TranscriptionSettings:
    """Numerical settings of a direct transcription.

    Parameters
    ----------
    scheme
        Integration scheme.
    intervals
        N, at least 2.
    tolerance
        IPOPT's tolerance on the scaled optimality conditions; a looser one blurs the switches
        over several intervals.
    max_iterations
        IPOPT's limit.
    """

    scheme: Scheme = Scheme.GAUSS
    intervals: int = 1000
    tolerance: float = 1e-11
    max_iterations: int = 3000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridProblem:
    """A move to be solved on a grid, in scaled quantities.

    Parameters
    ----------
    A, B
        Scaled plant, shapes (n, n), (n,) [1/s].
    target
        Scaled terminal state, shape (n,).
    fixed
        Which states are prescribed at t_f, shape (n,).
    t_guess
        Unit of time [s]: the final time itself where it is given.
    free_time
        Whether t_f is to be minimised.
    weights
        Scaled weights of the squared states, shape (n,); not used where t_f is minimised.
    rows
        Bounded signals, |rows x| <= 1 at the grid points, shape (k, n).
    start_states, start_control
        Where IPOPT starts, on an even grid of its own: shapes (k + 1, n), (k,).
    refined
        Whether the start is the solution on a coarser grid.
    """

    A: Array
    B: Array
    target: Array
    fixed: NDArray[np.bool_]
    t_guess: float
    free_time: bool
    weights: Array
    rows: Array
    start_states: Array
    start_control: Array
    refined: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridSolution:
    """What IPOPT found, in scaled quantities.

    Parameters
    ----------
    t_f
        [s].
    states
        At the grid points, shape (N + 1, n).
    control
        u of each interval, shape (N,).
    adjoint
        λ of each interval, shape (N, n) [s per scaled state].
    adjoint_initial
        λ(0), shape (n,), to the order of the grid.
    """

    t_f: float
    states: Array
    control: Array
    adjoint: Array
    adjoint_initial: Array


def bounded_rows(plant: Plant, bounds: tuple[Bound, ...], *, state_scale: Array) -> Array:
    """Return the bounded signals as rows on the scaled state, each divided by its bound.

    Parameters
    ----------
    plant
        Plant with n states.
    bounds
        By state or output.
    state_scale
        Physical per scaled state, shape (n,).

    Returns
    -------
    ndarray, shape (n_bounds, n)
    """
    rows = [plant.row(bound.name) * state_scale / bound.value for bound in bounds]
    return np.array(rows).reshape(len(bounds), plant.order)


def solve_grid(problem: GridProblem, settings: TranscriptionSettings) -> GridSolution:
    """Return the optimum of the discretised problem.

    Parameters
    ----------
    problem
        The scaled move.
    settings
        Grid and IPOPT.

    Returns
    -------
    GridSolution

    Raises
    ------
    ComputationError
        FINAL_TIME_TOO_SHORT if IPOPT finds a move with given t_f infeasible,
        BOUND_CANNOT_HOLD if one with free t_f, NO_CONVERGENCE for its other failures.
    """
    n, N = problem.target.size, settings.intervals
    x, u, time = ca.MX.sym("x", n, N + 1), ca.MX.sym("u", 1, N), ca.MX.sym("time")
    step = time * problem.t_guess / N if problem.free_time else ca.DM(problem.t_guess / N)
    defect = _defect(problem, settings.scheme).map(N)
    defects = defect(x[:, :-1], x[:, 1:], u, ca.repmat(step, 1, N))
    cost = time if problem.free_time else _cost(problem, settings.scheme, x, u)
    variables = [ca.vec(x), ca.vec(u), *([time] if problem.free_time else [])]
    bounded = ca.vec(ca.DM(problem.rows) @ x[:, 1:])
    program = {
        "x": ca.vertcat(*variables),
        "f": cost,
        "g": ca.vertcat(ca.vec(defects), bounded),
    }
    solver = ca.nlpsol("transcription", "ipopt", program, _options(problem, settings, program))
    low, high = _box(problem, N)
    limit = np.ones(problem.rows.shape[0] * N)
    answer = solver(
        x0=_start(problem, N),
        lbx=low,
        ubx=high,
        lbg=np.concatenate([np.zeros(n * N), -limit]),
        ubg=np.concatenate([np.zeros(n * N), limit]),
    )
    _check(problem, settings, solver.stats())
    point = np.asarray(answer["x"]).ravel()
    adjoint = -problem.t_guess * np.asarray(answer["lam_g"]).ravel()[: n * N].reshape(N, n)
    t_f = problem.t_guess * (point[-1] if problem.free_time else 1.0)
    _, E = _scheme_matrices(settings.scheme, t_f / N * problem.A)
    return GridSolution(
        t_f=float(t_f),
        states=point[: n * (N + 1)].reshape(N + 1, n),
        control=point[n * (N + 1) : n * (N + 1) + N],
        adjoint=adjoint,
        adjoint_initial=np.asarray(E.T @ adjoint[0]),
    )


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
        "ipopt.tol": settings.tolerance,
        "ipopt.max_iter": settings.max_iterations,
        "ipopt.acceptable_iter": 0,
        "ipopt.honor_original_bounds": "yes",
    }
    if problem.free_time:
        options["hess_lag"] = _no_curvature(program)
    else:
        constant = ("jac_c_constant", "jac_d_constant", "hessian_constant")
        options |= {f"ipopt.{name}": "yes" for name in constant}
    if problem.refined:
        close = ("mu_init", "bound_push", "bound_frac")
        options |= {f"ipopt.{name}": REFINED_BARRIER for name in close}
    return options


def _no_curvature(program: dict[str, Any]) -> Any:
    """Return a zero Hessian of the Lagrangian for the free-time problem.

    The true one is bilinear in t_f and the rest, hence indefinite, and IPOPT crawls under the
    regularisation that this calls for. A shortest move is a vertex of its constraints, as in
    a linear program, so that Newton's method on these alone converges as fast.
    """
    size, rows = program["x"].shape[0], program["g"].shape[0]
    arguments = [ca.MX.sym("x", size), ca.MX.sym("p", 0), ca.MX.sym("f"), ca.MX.sym("g", rows)]
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
    low[-1, problem.fixed] = high[-1, problem.fixed] = problem.target[problem.fixed]
    parts_low, parts_high = [low.ravel(), -np.ones(N)], [high.ravel(), np.ones(N)]
    if problem.free_time:
        parts_low.append(np.array([1e-3]))
        parts_high.append(np.array([LONGEST]))
    return np.concatenate(parts_low), np.concatenate(parts_high)


def _start(problem: GridProblem, N: int) -> Array:
    given = np.linspace(0.0, 1.0, problem.start_states.shape[0])
    wanted = np.linspace(0.0, 1.0, N + 1)
    states = np.column_stack([np.interp(wanted, given, x) for x in problem.start_states.T])
    control = problem.start_control[np.arange(N) * problem.start_control.size // N]
    time = np.ones(int(problem.free_time))
    return np.concatenate([states.ravel(), control, time])


def _check(problem: GridProblem, settings: TranscriptionSettings, stats: dict[str, Any]) -> None:
    status = str(stats["return_status"])
    if status == "Solve_Succeeded":
        return
    detail = (
        f"IPOPT ended with {status} after {stats['iter_count']} iterations, "
        f"{settings.scheme.value} scheme, {settings.intervals} intervals"
    )
    infeasible = status == "Infeasible_Problem_Detected"
    if not infeasible or (problem.free_time and not problem.rows.size):
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    if problem.free_time:
        raise ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)
    raise ComputationError(Outcome.FINAL_TIME_TOO_SHORT, f"t_f = {problem.t_guess:.6g} s: {detail}")
