"""Linear programs by the simplex method of HiGHS, from a known basis: only door to HiGHS."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import highspy
import numpy as np
from highspy import HighsBasisStatus, HighsModelStatus, cb
from numpy.typing import NDArray

Array = NDArray[np.float64]
Basis = highspy.HighsBasis
"""Which unknowns and constraints, equations first, are at a bound: where a search starts."""

WAYS: tuple[dict[str, str | int], ...] = (
    # Forces and bounds are relative here. Scaled by their largest coefficients, short cells weigh
    # like long ones: bases become singular and the multipliers lose half their digits.
    {"solver": "simplex", "simplex_scale_strategy": 0},
    {"solver": "simplex"},
    {"solver": "ipm"},
)
"""Options of HiGHS for three ways to the same vertex: tried in this order, where one loses its
basis for rounding. (Its primal simplex method may turn in circles for ever.)"""
FINAL = (HighsModelStatus.kInfeasible, HighsModelStatus.kIterationLimit)
"""Verdicts after which no other way is tried, unless the program is known to have a solution."""
FORGIVING = 1e-8
"""Tolerance of the last way, if the first ones had a smaller one."""
CHECKS_PER_STEP = 3
"""Times that the simplex method may ask whether it shall go on, against the steps allowed: 1.1 to
1.3 where it ends (measured); one that turns in circles does so without counting steps."""
INTERIOR_STEPS = 500
"""Steps of the interior-point method at most; some dozens are usual."""
SMALLEST_COEFFICIENT = 1e-12
"""Coefficients left out: the least that HiGHS allows. Its default of 1e-9 drops what a short cell
does to a bound far away, and with it eight digits of the bound."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Program:
    """Minimise cost x: floors <= rows x <= rooms, equal x = right, lower <= x <= upper."""

    cost: Array  # Shape (n,)
    # rows, rooms, floors: Shapes (k, n), (k,) and (k,); no floors: minus infinity.
    rows: Array
    rooms: Array
    # equal, right: Shapes (l, n) and (l,).
    equal: Array
    right: Array
    # lower, upper: Bounds of each unknown, shapes (n,); infinite where there is none.
    lower: Array
    upper: Array
    floors: Array | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """The solution of a program and its multipliers."""

    unknowns: Array  # Shape (n,)
    # rows, equal, bounds: Change of the cost with ``rooms`` or ``floors``, with ``right``,
    # and with the bound at which an unknown is, shapes (k,), (l,) and (n,).
    rows: Array
    equal: Array
    bounds: Array
    basis: Basis  # Where a program like it may start


def solve_program(
    program: Program,
    *,
    steps: int,
    tolerance: float = 1e-7,
    start: Basis | None = None,
    is_solvable: bool = False,
) -> Solution | None:
    """Return the solution of a linear program, or None where the simplex method finds none."""
    count = program.right.size + program.rooms.size
    for way in WAYS:
        allowed = max(tolerance, FORGIVING) if way is WAYS[-1] else tolerance
        solver = _solver(way, steps=steps, tolerance=allowed)
        _stop_circles(solver, most=CHECKS_PER_STEP * steps)
        _pass_program(solver, program)
        if start is not None:
            solver.setBasis(_extended(start, rows=count))
        solver.run()
        status = solver.getModelStatus()
        if status == HighsModelStatus.kOptimal:
            return _solution(solver, equations=program.right.size)
        if not is_solvable and status in FINAL:
            return None
        start = None
    return None


def _pass_program(solver: highspy.Highs, program: Program) -> None:
    """Hand over arrays: as a model, whose fields are lists, it takes as long as the solution."""
    matrix = np.vstack([program.equal, program.rows])
    rows, columns = np.nonzero(matrix)
    starts = np.searchsorted(rows, np.arange(len(matrix)))
    floors = np.full(program.rooms.size, -np.inf) if program.floors is None else program.floors
    solver.passModel(
        program.cost.size,
        len(matrix),
        rows.size,
        int(highspy.MatrixFormat.kRowwise),
        int(highspy.ObjSense.kMinimize),
        0.0,
        program.cost,
        program.lower,
        program.upper,
        np.concatenate([program.right, floors]),
        np.concatenate([program.right, program.rooms]),
        starts.astype(np.int32),
        columns.astype(np.int32),
        matrix[rows, columns],
        np.zeros(program.cost.size, dtype=np.int32),
    )


class _SilentHighs(highspy.Highs):
    """HiGHS that never writes to standard output, where our JSON goes.

    From 1.16 on its constructor prints a banner when it makes callbacks possible, before anyone
    could set an option.
    """

    def enableCallbacks(self) -> None:
        self.setOptionValue("output_flag", False)
        super().enableCallbacks()  # type: ignore[no-untyped-call]


def _solver(way: Mapping[str, str | int], *, steps: int, tolerance: float) -> highspy.Highs:
    solver = _SilentHighs()  # type: ignore[no-untyped-call]
    options: dict[str, bool | int | float | str] = {
        "parallel": "off",
        # Presolving costs more here than it saves, and calls some feasible programs infeasible.
        "presolve": "off",
        "small_matrix_value": SMALLEST_COEFFICIENT,
        "simplex_iteration_limit": steps,
        "ipm_iteration_limit": INTERIOR_STEPS,
        "primal_feasibility_tolerance": tolerance,
        "dual_feasibility_tolerance": tolerance,
        **way,
    }
    for name, value in options.items():
        solver.setOptionValue(name, value)
    return solver


def _stop_circles(solver: highspy.Highs, *, most: int) -> None:
    """Stop a simplex method that has asked too often whether it shall go on.

    It asks at each step, and again at each new factorisation: one that turns in circles without
    counting its steps goes on asking.
    """
    checks = iter(range(most))

    def answer(
        kind: cb.HighsCallbackType,
        message: str,
        said: cb.HighsCallbackOutput,
        told: cb.HighsCallbackInput,
        data: object,
    ) -> None:
        told.user_interrupt = next(checks, None) is None

    solver.setCallback(answer, None)
    solver.startCallback(cb.HighsCallbackType.kCallbackSimplexInterrupt)


def _solution(solver: highspy.Highs, *, equations: int) -> Solution:
    solution = solver.getSolution()
    prices = np.array(solution.row_dual)
    return Solution(
        unknowns=np.array(solution.col_value),
        rows=prices[equations:],
        equal=prices[:equations],
        bounds=np.array(solution.col_dual),
        basis=solver.getBasis(),
    )


def _extended(start: Basis, *, rows: int) -> Basis:
    """Return a basis in which constraints that are new do not act."""
    basis = Basis()
    basis.col_status = start.col_status
    known = list(start.row_status)
    basis.row_status = known + [HighsBasisStatus.kBasic] * (rows - len(known))
    basis.valid = basis.alien = True
    return basis
