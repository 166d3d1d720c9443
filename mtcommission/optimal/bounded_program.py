"""Linear programs by the simplex method, tried another way where it gives up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, linprog

Array = NDArray[np.float64]

INFEASIBLE, DOUBTFUL = 2, 4
"""Statuses of ``linprog``: no point keeps all constraints; numerical difficulties."""
FORGIVING = 1e-8
"""Tolerance of the second attempt, if the first one had a smaller one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Program:
    """Minimise cost x under rows x <= rooms, equal x = right, and bounds on each unknown.

    Parameters
    ----------
    cost
        Shape (n,).
    rows, rooms
        Shapes (k, n) and (k,).
    equal, right
        Shapes (l, n) and (l,).
    bounds
        Lower and upper bound of each unknown; None where there is none.
    """

    cost: Array
    rows: Array
    rooms: Array
    equal: Array
    right: Array
    bounds: list[tuple[float | None, float | None]]


def solve_program(program: Program, *, steps: int, tolerance: float = 1e-7) -> OptimizeResult:
    """Return the solution of a linear program; where presolving fails, without it.

    HiGHS' presolve ends without an answer in some programs with coefficients many decades apart,
    or calls them infeasible where they are not; the simplex method on the program as it stands
    then mostly finds one, within a larger tolerance.

    Parameters
    ----------
    program
        What to solve.
    steps
        Of the simplex method, at most.
    tolerance
        Of primal and dual feasibility; the default is that of HiGHS.

    Returns
    -------
    OptimizeResult
        ``x`` is None where there is none.

    Examples
    --------
    >>> one = np.ones((1, 1))
    >>> program = Program(cost=-one[0], rows=one, rooms=np.array([2.0]), equal=np.empty((0, 1)),
    ...     right=np.empty(0), bounds=[(0.0, None)])
    >>> float(solve_program(program, steps=10).x[0])
    2.0
    """
    for presolve, allowed in ((True, tolerance), (False, max(tolerance, FORGIVING))):
        result = linprog(
            program.cost,
            A_ub=program.rows,
            b_ub=program.rooms,
            A_eq=program.equal,
            b_eq=program.right,
            bounds=program.bounds,
            method="highs",
            options={
                "presolve": presolve,
                "maxiter": steps,
                "primal_feasibility_tolerance": allowed,
                "dual_feasibility_tolerance": allowed,
            },
        )
        said_by_presolve = result.status == INFEASIBLE and result.nit == 0
        if result.status != DOUBTFUL and not said_by_presolve:
            break
    return result
