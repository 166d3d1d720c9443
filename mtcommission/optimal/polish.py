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
from mtcommission.optimal.dual import (
    MARGIN,
    Ascent,
    DualPoint,
    ascend,
    evaluate_dual,
    sign_jumps,
)
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
LARGEST_MULTIPLIER = 1e14
"""|c| ∫|φ| against ∫|σ| beyond which σ is nothing but rounding."""
EXCHANGES = 4
"""Changes of structure in a row; one is usual next to the birth of an arc."""
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
    defect
        Moments of the signs and the missing target, shape (size + 1,).
    residual
        Largest violated moment against ∫|φ|, and of the target against itself.
    """

    zeros: Array
    horizon: float
    first_sign: float
    multipliers: Array
    defect: Array
    residual: float


def moment_defect(
    problem: MomentProblem, zeros: Array, horizon: float, *, first_sign: float, span: float
) -> Array:
    """Return the moments of the signs and the missing target, shape (size + 1,)."""
    ends = np.append(zeros, horizon)
    jumps = sign_jumps(zeros.size, first_sign=first_sign)
    reached = jumps @ problem.target_integrals(ends) - span
    return np.append(jumps @ problem.integrals(ends), reached)


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
        defect=np.append(point.moments, 0.0),
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
    jumps = sign_jumps(k, first_sign=current.first_sign)
    matrix = np.zeros((k + n + 1, k + n + 1))
    matrix[np.arange(k), np.arange(k)] = slopes
    matrix[:k, k + 1 :] = -phi / scale[:-1]
    matrix[k:, : k + 1] = (functions * jumps[:, np.newaxis] / scale).T
    right = -np.concatenate([sigma, current.defect / scale])
    step = _solve(matrix, right)
    share = _share(ends, step[: k + 1])
    zeros = zeros + share * step[:k]
    horizon = current.horizon + share * float(step[k])
    left = moment_defect(problem, zeros, horizon, first_sign=current.first_sign, span=span)
    scaled = current.multipliers * scale[:-1] / span + share * step[k + 1 :] / span
    usable = bool(np.all(np.abs(scaled) < LARGEST_MULTIPLIER))
    return BangBang(
        zeros=zeros,
        horizon=horizon,
        first_sign=current.first_sign,
        multipliers=current.multipliers + share * step[k + 1 :] / scale[:-1],
        defect=left,
        residual=float(np.max(np.abs(left / scale))) if usable else inf,
    )


def _solve(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        # Fewer switches than conditions leave multipliers undetermined: take the least step.
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])


def _share(ends: Array, step: Array) -> float:
    lengths = ends - np.append(0.0, ends[:-1])
    closing = np.append(0.0, step[:-1]) - step
    return min(1.0, TO_BOUNDARY / max(float((closing / lengths).max()), 1e-300))


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
    cells = first_cells(problem, span=span)
    ascent = Ascent(point=_dual_start(problem, cells, span))
    attempts = []
    for _ in range(REFINEMENTS):
        for _ in range(ASCENT_STEPS):
            attempts.append(_exchange(ascent.point, span))
            if attempts[-1].gap <= AGREEMENT or ascent.stalled:
                break
            ascent = ascend(ascent, span=span)
        best = min(attempts, key=lambda attempt: attempt.gap)
        if best.gap <= SUFFICIENT:
            return best.control
        cells = refine_cells(problem, cells, span=span)
        fresh = _dual_start(problem, cells, span)
        if fresh.bound > ascent.point.bound:
            ascent = Ascent(point=fresh)
    if best.gap < inf:
        return best.control
    point = ascent.point
    detail = (
        f"bound {point.bound:.9g} s for span {span:.6g}, {point.zeros.size} switches, "
        f"largest relative moment {point.residual:.2g}"
    )
    raise ComputationError(Outcome.NO_CONVERGENCE, detail)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attempt:
    """A polished control and how far its time is from the time that its multipliers prove.

    Parameters
    ----------
    control
        The control.
    gap
        Relative distance; inf for a control that is not feasible.
    """

    control: BangBang
    gap: float


def _exchange(point: DualPoint, span: float) -> Attempt:
    """Polish; where the multipliers then show other zeros than the control has, do so with those.

    Next to the birth of an arc this is what adds or drops the two zeros.
    """
    best = Attempt(control=polish(point, span=span), gap=inf)
    control = best.control
    for _ in range(EXCHANGES):
        if control.residual > FEASIBLE:
            break
        proof = evaluate_dual(point.mesh, control.multipliers, span=span)
        gap = abs(control.horizon - proof.bound) / control.horizon
        best = Attempt(control=control, gap=gap) if gap < best.gap else best
        if gap <= AGREEMENT or proof.zeros.size == control.zeros.size:
            break
        control = polish(proof, span=span)
    return best


def _dual_start(problem: MomentProblem, cells: CellSolution, span: float) -> DualPoint:
    mesh = build_mesh(problem, MARGIN * cells.horizon)
    return evaluate_dual(mesh, cells.multipliers, span=span)
