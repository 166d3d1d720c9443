"""Full precision: Newton on switching times, final time and multipliers together.

With the zeros of σ as unknowns of their own the equations stay smooth where two zeros meet, so
arcs of any length converge; the number of zeros is that of the start.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.optimal.dual import MARGIN, Ascent, DualPoint, ascend, evaluate_dual
from mtcommission.optimal.dual_start import CellSolution, first_cells, refine_cells
from mtcommission.optimal.moments import MomentProblem
from mtcommission.optimal.switching import build_mesh, values_and_slopes

Array = NDArray[np.float64]

NEWTON_STEPS = 12
CONVERGED = 1e-14
"""Moments against ∫|φ| that count as zero; one more step follows (empirical: reaches 1e-16)."""
FEASIBLE = 1e-10
"""Moments against ∫|φ| at which a control counts as feasible; the state follows to 1e-9 of its
peak, as the solver checks again."""
AGREEMENT = 1e-12
"""Relative distance of time and bound at which the search ends at once."""
SUFFICIENT = 1e-10
"""Distance that no finer start is tried for: rounding, not the start, is what is left."""
ASCENT_STEPS = 6
"""From each start; mostly the first attempt succeeds."""
REFINEMENTS = 8
"""Starts; the last has cells of 1e-5 of the fastest period where σ is near zero."""
TO_BOUNDARY = 0.9
"""Longest step, as a share of the one that closes an arc."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BangBang:
    """A bang-bang force in the remaining time, with its multipliers.

    Parameters
    ----------
    zeros
        Remaining times of the switches, ascending, shape (k,) [s].
    horizon
        t_f [s].
    first_sign
        Sign of the force before the first zero, i.e. at the end of the move.
    multipliers
        c, shape (size,).
    residual
        Largest violated moment against ∫|φ|, and of the target against itself.
    """

    zeros: Array
    horizon: float
    first_sign: float
    multipliers: Array
    residual: float


def signs_between(count: int, first_sign: float) -> Array:
    """Return the signs of the force on the arcs between ``count`` zeros, shape (count + 1,)."""
    return np.asarray(first_sign * (-1.0) ** np.arange(count + 1))


def moment_defect(
    problem: MomentProblem, zeros: Array, horizon: float, *, first_sign: float, span: float
) -> Array:
    """Return the moments of the signs and the missing target, shape (size + 1,)."""
    ends = np.append(zeros, horizon)
    primitive = np.column_stack([problem.integrals(ends), problem.target_integrals(ends)])
    signs = signs_between(zeros.size, first_sign)
    defect = signs @ np.diff(primitive, axis=0, prepend=0.0)
    defect[-1] -= span
    return np.asarray(defect)


def polish(point: DualPoint, *, span: float) -> BangBang:
    """Return the stationary control next to a dual point.

    Parameters
    ----------
    point
        Gives the zeros, the multipliers and the horizon to start from.
    span
        target / F_max.

    Returns
    -------
    BangBang
        Its ``residual`` tells whether Newton converged.

    Source: docs/optimal-control.md, section 3.
    """
    problem = point.mesh.problem
    scale = np.append(point.norms, span)
    current = BangBang(
        zeros=point.zeros,
        horizon=point.bound,
        first_sign=point.first_sign,
        multipliers=point.multipliers,
        residual=point.residual,
    )
    last = False
    for _ in range(NEWTON_STEPS):
        following = _step(problem, current, scale=scale, span=span)
        if last or not np.isfinite(following.residual):
            return current if current.residual <= following.residual else following
        last = following.residual <= CONVERGED
        current = following
    return current


def _step(problem: MomentProblem, current: BangBang, *, scale: Array, span: float) -> BangBang:
    zeros, n, k = current.zeros, problem.size, current.zeros.size
    sigma, slopes, phi = values_and_slopes(problem, current.multipliers, zeros)
    ends = np.append(zeros, current.horizon)
    functions = np.column_stack([problem.values(ends), problem.target_values(ends)])
    signs = signs_between(k, current.first_sign)
    jumps = np.append(2.0 * signs[:-1], signs[-1])
    defect = moment_defect(
        problem, zeros, current.horizon, first_sign=current.first_sign, span=span
    )
    matrix = np.zeros((k + n + 1, k + n + 1))
    matrix[np.arange(k), np.arange(k)] = slopes
    matrix[:k, k + 1 :] = -phi / scale[:-1]
    matrix[k:, : k + 1] = (functions * jumps[:, np.newaxis] / scale).T
    right = -np.concatenate([sigma, defect / scale])
    step = _solve(matrix, right)
    share = _share(ends, step[: k + 1])
    zeros = zeros + share * step[:k]
    horizon = current.horizon + share * float(step[k])
    left = moment_defect(problem, zeros, horizon, first_sign=current.first_sign, span=span)
    return BangBang(
        zeros=zeros,
        horizon=horizon,
        first_sign=current.first_sign,
        multipliers=current.multipliers + share * step[k + 1 :] / scale[:-1],
        residual=float(np.max(np.abs(left / scale))),
    )


def _solve(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        # Fewer switches than conditions leave multipliers undetermined: take the least step.
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])


def _share(ends: Array, step: Array) -> float:
    lengths = np.diff(ends, prepend=0.0)
    closing = -np.diff(step, prepend=0.0)
    return min(1.0, TO_BOUNDARY / max(float(np.max(closing / lengths)), 1e-300))


def find_bang_bang(problem: MomentProblem, *, span: float) -> BangBang:
    """Return the time-optimal control as signs over the remaining time.

    From a coarse start, Newton steps on the dual bound alternate with attempts to polish; an
    attempt is accepted when the bound that its multipliers prove equals the time that it takes.

    Parameters
    ----------
    problem
        The moment problem.
    span
        target / F_max [s] or [s²].

    Returns
    -------
    BangBang

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if no attempt is feasible to ``FEASIBLE``; how far the bound stays behind
        is left to the certificate.
    """
    best, best_gap = None, inf
    cells = first_cells(problem, span=span)
    ascent = Ascent(point=_dual_start(problem, cells, span))
    for _ in range(REFINEMENTS):
        for _ in range(ASCENT_STEPS):
            candidate = polish(ascent.point, span=span)
            if candidate.residual <= FEASIBLE:
                proof = evaluate_dual(ascent.point.mesh, candidate.multipliers, span=span)
                gap = abs(candidate.horizon - proof.bound) / candidate.horizon
                best, best_gap = (candidate, gap) if gap < best_gap else (best, best_gap)
            if best is not None and best_gap <= AGREEMENT:
                return best
            if ascent.stalled:
                break
            ascent = ascend(ascent, span=span)
        if best is not None and best_gap <= SUFFICIENT:
            return best
        cells = refine_cells(problem, cells, span=span)
        fresh = _dual_start(problem, cells, span)
        if fresh.bound > ascent.point.bound:
            ascent = Ascent(point=fresh)
    if best is None:
        point = ascent.point
        detail = (
            f"bound {point.bound:.9g} s for span {span:.6g}, {point.zeros.size} switches, "
            f"largest relative moment {point.residual:.2g}"
        )
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return best


def _dual_start(problem: MomentProblem, cells: CellSolution, span: float) -> DualPoint:
    mesh = build_mesh(problem, MARGIN * cells.horizon)
    return evaluate_dual(mesh, cells.multipliers, span=span)
