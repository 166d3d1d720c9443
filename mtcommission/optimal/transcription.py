"""Plant + move -> optimal control on a grid, by direct transcription and IPOPT.

This is the paper's own method. It needs no knowledge of the structure, takes any bounds, and
serves as an independent check of the exact solutions; it is neither exact nor certified.
Every number of a result but t_f and the adjoint belongs to the *exact* motion of the plant
under the control that was found, so the discretisation shows as a terminal error.

The control is constant on each of N equal intervals of length h = t_f / N. With Z = h A every
scheme here is one linear relation between the ends of an interval,

    D(Z) x_{k+1} = E(Z) x_k + h B u_k,

    Euler               D = I                     E = I + Z                 order 1
    trapezoidal         D = I - Z / 2             E = I + Z / 2             order 2
    Gauss, two stages   D = I - Z / 2 + Z² / 12   E = I + Z / 2 + Z² / 12   order 4

States are scaled by what F_max could cause, the force by F_max. For a given t_f the program is
convex: it has the least functional, or reaches the largest multiple of the target. The shortest
t_f is where that multiple is 1, which Newton's method finds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, nan, sqrt
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move, least_motion_time
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.control import (
    ArcControl,
    Bang,
    Certificate,
    DampingOptimum,
    Interior,
    Law,
    Optimum,
    Proof,
    TimeOptimum,
    constant_arc,
    follow_control,
    terminal_target,
)
from mtcommission.optimal.damping import cost_terms, state_scales
from mtcommission.optimal.problem import all_bounds, describe_bounds
from mtcommission.optimal.transcription_settings import Scheme, TranscriptionSettings

Array = NDArray[np.float64]

LONGEST = 100.0
"""Longest final time that is searched, in units of its first guess."""
COARSEST = 500
"""Intervals up to which a grid is the first; before a finer one comes one four times coarser."""
STEEPEST = 4.0
"""Most that a step of Newton's method may lengthen the final time, as a factor."""
MOST_TIMES = 20
"""Final times that Newton's method may try (empirical: two to six are enough)."""
REACHED = 0.5
"""Distance from 1, in tolerances of all intervals added, at which the target counts as reached:
IPOPT leaves each force a gap of up to its tolerance, and the multiple errs by their sum."""
ROUGHLY = 1e-4
"""The same on coarser grids."""
NO_GAIN = 1e-6
"""Growth of the multiple with the logarithm of t_f below which more time does not help."""
TINY = 1e-300
SATURATED = 1e-5
"""Distance from the limit, in units of F_max, below which an interval counts as saturated:
IPOPT ends at most about its tolerance over the multiplier inside the limit."""
LAW_TOLERANCE = 1e-5
"""Largest violation of the switching law, weighted with |λ_F| / max |λ_F| [-]."""


def transcribe_time_optimal(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    bounds: tuple[SignalValue, ...],
    settings: TranscriptionSettings,
) -> TimeOptimum:
    """Return the shortest move on a grid.

    Raises
    ------
    ComputationError
        BOUND_CANNOT_HOLD if more time does not help, BEYOND_HORIZON if t_f reaches the end of the
        search, NO_CONVERGENCE for IPOPT's failures.
    KeyError
        If a bound names no signal of the plant.

    Source: Christiansen, Maurer & Zirn, secs. 5 and 5.2.
    """
    problem = _Problem(
        plant=plant,
        move=move,
        force_limit=force_limit,
        bounds=bounds,
        t_f=_guess_time(plant, move, force_limit=force_limit),
    )
    found = _shortest(problem, settings)
    return _optimum(problem, found, _certificate(plant, found))


def transcribe_damping_optimal(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    t_f: float,
    weights: tuple[SignalValue, ...],
    bounds: tuple[SignalValue, ...],
    settings: TranscriptionSettings,
) -> DampingOptimum:
    """Return the move with the least weighted squares on a grid.

    Raises
    ------
    ComputationError
        FINAL_TIME_TOO_SHORT if there is no such move; NO_CONVERGENCE for IPOPT's other failures.
    KeyError
        If a bound names no signal of the plant.
    ValueError
        If a weight names no state.

    Source: Christiansen, Maurer & Zirn, sec. 6.
    """
    problem = _Problem(
        plant=plant,
        move=move,
        force_limit=force_limit,
        bounds=bounds,
        t_f=t_f,
        weights=weights,
    )
    found = _solve(problem, settings)
    wanted = np.clip(-found.adjoint @ plant.B / 2.0 / force_limit, -1.0, 1.0)
    law = Law(
        adjoint_initial=found.adjoint_initial,
        law_residual=float(np.abs(_snap(found.control) - wanted).max()),
    )
    return _optimum(problem, found, law)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Problem:
    """A move by a given time, to be solved on a grid."""

    plant: Plant
    move: Move
    force_limit: float  # [N]
    bounds: tuple[SignalValue, ...]
    t_f: float  # [s]
    # Of the functional; None: the largest multiple of the target is wanted.
    weights: tuple[SignalValue, ...] | None = None

    @property
    def every_bound(self) -> tuple[SignalValue, ...]:
        """The bounds, that on the velocity of the move among them."""
        return all_bounds(self.plant, self.move, self.bounds)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Solution:
    t_f: float  # [s]
    control: Array  # u of each interval in units of F_max, shape (N,)
    adjoint: Array  # λ of each interval, shape (N, n), for ∫ 1 dt or the functional
    adjoint_initial: Array  # λ(0), shape (n,), to the order of the grid
    reach: float  # Multiple of the target that is reached; 1 for the functional
    reach_rate: float  # Its increase per time [1/s]


def _shortest(problem: _Problem, settings: TranscriptionSettings) -> _Solution:
    """Return the move whose time just reaches the target, on coarser grids first."""
    grids, longest = [settings.intervals], LONGEST * problem.t_f
    while grids[-1] > COARSEST:
        grids.append(grids[-1] // 4)
    for intervals in reversed(grids):
        used = replace(settings, intervals=intervals)
        near = max(
            REACHED * settings.tolerance * intervals, 0.0 if intervals == grids[0] else ROUGHLY
        )
        low, high = 0.0, inf
        for _ in range(MOST_TIMES):
            found = _solve(problem, used)
            if abs(found.reach - 1.0) < near:
                break
            low, high = (found.t_f, high) if found.reach < 1.0 else (low, found.t_f)
            if high == inf:
                _require_gain(problem, found, longest=longest)
            problem = replace(problem, t_f=_next_time(found, low, high))
        else:
            detail = Message("target-not-reached", reach=found.reach, t_f=found.t_f)
            raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return found


def _require_gain(problem: _Problem, found: _Solution, *, longest: float) -> None:
    if found.t_f > longest:
        raise ComputationError(Outcome.BEYOND_HORIZON, Message("ipopt-went-far", t_f=found.t_f))
    if problem.every_bound and found.reach_rate * found.t_f < NO_GAIN:
        detail = Message("target-not-reached", reach=found.reach, t_f=found.t_f)
        raise ComputationError(Outcome.BOUND_CANNOT_HOLD, detail)


def _next_time(found: _Solution, low: float, high: float) -> float:
    newton = found.t_f + (1.0 - found.reach) / max(found.reach_rate, TINY)
    low, high = max(low, found.t_f / STEEPEST), min(high, STEEPEST * found.t_f)
    return newton if low < newton < high else sqrt(low * high)


def _guess_time(plant: Plant, move: Move, *, force_limit: float) -> float:
    slowest = max(2.0 * np.pi / mode.natural_frequency for mode in plant.modes)
    rigid = least_motion_time(move, force_limit / plant.moving_mass)
    return float(rigid + slowest / 2.0 + 4.0 * plant.force_lag)


def _solve(problem: _Problem, settings: TranscriptionSettings) -> _Solution:
    """Return the optimum of the discretised problem.

    N times the objective makes the multipliers of a force or a bound on one interval about 1,
    where IPOPT's barrier begins and ends; with multipliers of 1e-4 it loses the centre under
    bounds, and takes hundreds of steps of 1e-3 (N = 10 000).
    """
    plant, F, t_f, N = problem.plant, problem.force_limit, problem.t_f, settings.intervals
    n, scales = plant.order, state_scales(plant, force_limit=F, t_f=t_f)
    A, B = plant.A * scales / scales[:, None], plant.B * F / scales
    target, fixed = terminal_target(plant, problem.move)
    rows = [plant.row(bound.name) * scales / bound.value for bound in problem.every_bound]
    x, u, reach = ca.MX.sym("x", n, N + 1), ca.MX.sym("u", 1, N), ca.MX.sym("reach")
    step = ca.MX.sym("step")  # A parameter, for the sensitivity to the final time.
    defect = _defect(A, B, settings.scheme).map(N)
    defects = defect(x[:, :-1], x[:, 1:], u, ca.repmat(step, 1, N))
    ends = np.flatnonzero(fixed).tolist()
    missed = x[ends, -1] - reach * ca.DM((target / scales)[fixed])
    bounded = ca.vec(ca.DM(np.array(rows).reshape(-1, n)) @ x[:, 1:])
    if problem.weights is None:
        cost, most = -reach, inf
    else:
        most, weights = 1.0, np.zeros(n)
        for weight in problem.weights:
            i = plant.states.index(weight.name)
            weights[i] += weight.value * (scales[i] / F) ** 2
        cost = _functional(weights, A * (t_f / N), settings.scheme, x, u)
    program = {
        "x": ca.vertcat(ca.vec(x), ca.vec(u), reach),
        "p": step,
        "f": N * cost,
        "g": ca.vertcat(ca.vec(defects), missed, bounded),
    }
    solver = ca.nlpsol("transcription", "ipopt", program, _options(settings))
    free = np.full(n * N, inf)
    equal, limit = np.zeros(n * N + len(ends)), np.ones(len(rows) * N)
    answer = solver(
        x0=np.append(np.zeros(n * (N + 1) + N), 1.0),
        p=t_f / N,
        lbx=np.concatenate([np.zeros(n), -free, -np.ones(N), [1.0 if most == 1.0 else -inf]]),
        ubx=np.concatenate([np.zeros(n), free, np.ones(N), [most]]),
        lbg=np.concatenate([equal, -limit]),
        ubg=np.concatenate([equal, limit]),
    )
    _check(problem, settings, solver.stats())
    point = np.asarray(answer["x"]).ravel()
    multipliers = np.asarray(answer["lam_g"]).ravel()[: n * N].reshape(N, n)
    rate = float(answer["lam_p"]) / N**2
    # Of the functional, divided by F² t_f; or of the time that a multiple of the target takes.
    unit = -t_f * F**2 / N if problem.weights is not None else -1.0 / (N * rate)
    adjoint = unit * multipliers
    _, E = _scheme_matrices(settings.scheme, t_f / N * A)
    return _Solution(
        t_f=t_f,
        control=point[n * (N + 1) : -1],
        adjoint=adjoint / scales,
        adjoint_initial=np.asarray(E.T @ adjoint[0]) / scales,
        reach=float(point[-1]),
        reach_rate=rate,
    )


def _scheme_matrices(scheme: Scheme, Z: Any) -> tuple[Any, Any]:
    one = np.eye(Z.shape[0])
    if scheme is Scheme.EULER:
        return one, one + Z
    second = Z @ Z / 12 if scheme is Scheme.GAUSS else 0.0
    return one - Z / 2 + second, one + Z / 2 + second


def _defect(A: Array, B: Array, scheme: Scheme) -> Any:
    x, x_next = ca.SX.sym("x", B.size), ca.SX.sym("x_next", B.size)
    u, step = ca.SX.sym("u"), ca.SX.sym("step")
    # sparsified, so that the derivatives carry only the plant's own couplings
    D, E = _scheme_matrices(scheme, step * ca.SX(ca.sparsify(ca.DM(A))))
    return ca.Function("defect", [x, x_next, u, step], [D @ x_next - E @ x - step * B * u])


def _functional(c: Array, Z: Array, scheme: Scheme, x: Any, u: Any) -> Any:
    """Return the functional divided by F_max² t_f, with a quadrature of the scheme's order."""
    weights, start, end = ca.DM(c).T, x[:, :-1], x[:, 1:]
    if scheme is Scheme.EULER:
        squares = weights @ start**2
    elif scheme is Scheme.TRAPEZOIDAL:
        squares = weights @ (start**2 + end**2) / 2
    else:
        middle = (start + end) / 2 + ca.DM(Z) @ (start - end) / 8
        squares = weights @ (start**2 + 4 * middle**2 + end**2) / 6
    return (ca.sumsqr(u) + ca.sum2(squares)) / u.shape[1]


def _options(settings: TranscriptionSettings) -> dict[str, Any]:
    return {
        "print_time": False,
        "error_on_fail": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.max_iter": settings.max_iterations,
        "ipopt.tol": settings.tolerance * settings.intervals,
        # not scaled with the objective: errors of all intervals add up at t_f
        "ipopt.constr_viol_tol": settings.tolerance,
        "ipopt.acceptable_iter": 0,
        "ipopt.honor_original_bounds": "yes",
        "ipopt.jac_c_constant": "yes",
        "ipopt.jac_d_constant": "yes",
        "ipopt.hessian_constant": "yes",
        "ipopt.nlp_scaling_method": "none",  # it would undo the factor
    }


def _check(problem: _Problem, settings: TranscriptionSettings, stats: dict[str, Any]) -> None:
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
    if status != "Infeasible_Problem_Detected" or problem.weights is None:
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    ended = Message("ipopt-ended-at", t_f=problem.t_f, ended=detail)
    if problem.every_bound:
        told = describe_bounds(problem.plant, problem.every_bound)
        ended = Message("bounds-need-longer", t_f=problem.t_f, bounds=told)
    raise ComputationError(Outcome.FINAL_TIME_TOO_SHORT, ended)


def _snap(control: Array) -> Array:
    return np.where(np.abs(control) > 1.0 - SATURATED, np.sign(control), control)


def _optimum(problem: _Problem, found: _Solution, certificate: Proof) -> Optimum[Proof]:
    """Return what was found, neighbours of the same full force as one arc, by its exact motion."""
    plant, control = problem.plant, _snap(found.control)
    edges = np.linspace(0.0, found.t_f, control.size + 1)
    joined: NDArray[np.bool_] = (np.abs(control[1:]) == 1.0) & (control[1:] == control[:-1])
    starts = [0, *(np.flatnonzero(~joined) + 1).tolist(), control.size]
    arcs = []
    for start, end in pairwise(starts):
        force = float(control[start])
        kind: ArcControl = Bang(1 if force > 0.0 else -1) if abs(force) == 1.0 else Interior()
        span = float(edges[start]), float(edges[end])
        arcs.append(constant_arc(*span, control=kind, force=force * problem.force_limit))
    motion, weights = follow_control(plant, tuple(arcs)), problem.weights
    target, fixed = terminal_target(plant, problem.move)
    return Optimum(
        move=problem.move,
        force_limit=problem.force_limit,
        bounds=problem.bounds,
        method="transcription",
        t_f=found.t_f,
        arcs=tuple(arcs),
        weights=weights or (),
        cost_terms=np.zeros(0) if weights is None else cost_terms(plant, motion, weights),
        terminal_error=np.where(fixed, motion.final - target, 0.0),
        motion=motion,
        certificate=certificate,
    )


def _certificate(plant: Plant, found: _Solution) -> Certificate:
    switching = found.adjoint @ plant.B
    changes = np.flatnonzero(np.sign(switching[1:]) != np.sign(switching[:-1]))
    step = found.t_f / found.control.size
    violation = np.abs(found.control + np.sign(switching)) * np.abs(switching)
    return Certificate(
        t_f_lower_bound=nan,
        relative_gap=nan,
        adjoint_initial=found.adjoint_initial,
        switching_slopes=(switching[changes + 1] - switching[changes]) / step,
        switching_law_holds=bool(violation.max() <= LAW_TOLERANCE * np.abs(switching).max()),
        terminal_jacobian_rank=-1,
        terminal_jacobian_condition=nan,
    )
