"""Linear programs with HiGHS: the force held on N intervals, exactly discretised, and the shortest
final time found by bracketing.

For a given time, the largest multiple of the target that can be reached is a linear program; it
reaches 1 just when the time is long enough. Without bounds the states are eliminated, which
leaves one row for each end condition; with bounds they stay, which keeps the matrix sparse.
Brent's method needs fewer programs than bisection. HiGHS is the one inside SciPy.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import OptimizeResult, brentq, linprog

from benchmarks.answer import Answer, grid_answer
from benchmarks.problems import Problem, Scaled

Array = NDArray[np.float64]


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver; the program depends on the time and is built inside."""
    given = problem.scaled()
    if not given.minimises_time:
        raise NotImplementedError("linear programs only: a quadratic functional is beyond them")
    program = _with_states if given.rows.size else _condensed

    def solve() -> Answer:
        time = 1.0
        while _largest(program(given, cells, time)) < 1.0:
            time *= 1.5
        t_f = brentq(
            lambda t: _largest(program(given, cells, t)) - 1.0, time / 4.0, time, xtol=1e-12
        )
        found = program(given, cells, t_f)
        return grid_answer(problem, _control(found, cells), time=t_f)

    return solve


def _largest(found: OptimizeResult) -> float:
    if found.status:
        raise RuntimeError(found.message)
    return -float(found.fun)


def _control(found: OptimizeResult, cells: int) -> Array:
    return np.asarray(found.x)[:cells].reshape(-1, 1)


def _held(given: Scaled, step: float) -> tuple[Array, Array]:
    n = given.order
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = given.A, given.B
    whole = expm(joint * step)
    return whole[:n, :n], whole[:n, n]


def _condensed(given: Scaled, cells: int, time: float) -> OptimizeResult:
    """Variables: the controls, last the multiple of the target."""
    transition, push = _held(given, time / cells)
    columns = np.empty((given.order, cells + 1))
    for k in range(cells - 1, -1, -1):
        columns[:, k] = push
        push = transition @ push
    columns[:, cells] = -given.target
    return linprog(
        np.append(np.zeros(cells), -1.0),
        A_eq=columns[given.fixed],
        b_eq=np.zeros(int(given.fixed.sum())),
        bounds=[(-1.0, 1.0)] * cells + [(0.0, None)],
        method="highs",
    )


def _with_states(given: Scaled, cells: int, time: float) -> OptimizeResult:
    """Variables: the controls, the states at the ends of all intervals, the multiple."""
    n, N = given.order, cells
    transition, push = _held(given, time / N)
    one = sp.identity(N, format="csr")
    ahead = sp.diags_array([np.ones(N - 1)], offsets=[-1], shape=(N, N), format="csr")
    states = sp.kron(one, np.eye(n)) - sp.kron(ahead, transition)
    dynamics = sp.hstack([-sp.kron(one, push[:, None]), states, sp.csr_array((n * N, 1))])
    ends = np.flatnonzero(given.fixed)
    last = sp.csr_array(
        (np.ones(ends.size), (np.arange(ends.size), n * (N - 1) + ends)), shape=(ends.size, n * N)
    )
    end = sp.hstack([sp.csr_array((ends.size, N)), last, -given.target[ends, None]])
    bounded = sp.hstack(
        [
            sp.csr_array((given.rows.shape[0] * N, N)),
            sp.kron(one, given.rows),
            sp.csr_array((given.rows.shape[0] * N, 1)),
        ]
    )
    limit = np.ones(bounded.shape[0])
    return linprog(
        np.append(np.zeros(N + n * N), -1.0),
        A_eq=sp.vstack([dynamics, end]),
        b_eq=np.zeros(n * N + ends.size),
        A_ub=sp.vstack([bounded, -bounded]),
        b_ub=np.concatenate([limit, limit]),
        bounds=[(-1.0, 1.0)] * N + [(None, None)] * (n * N) + [(0.0, None)],
        method="highs",
    )
