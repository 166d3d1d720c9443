"""Full precision: Newton on switching times, final time and multipliers together.

With the zeros of σ as unknowns of their own the equations stay smooth where two zeros meet, so
arcs of any length converge; the number of zeros is that of the start.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, nan

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

from mtcommission.errors import ComputationError, Outcome
from mtcommission.optimal.dual import (
    Ascent,
    DualPoint,
    ascend,
    evaluate_dual,
    moment_norms,
    sign_jumps,
)
from mtcommission.optimal.dual_start import PARTS, CellForce, improve, refine_cells, start_force
from mtcommission.optimal.mesh import ROUNDOFF, Mesh
from mtcommission.optimal.moments import MomentProblem, independence
from mtcommission.optimal.switching import bracket_zeros, cubic_zeros, has_one_zero

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

NEWTON_STEPS = 12
FINISHING_STEPS = 24
"""Five are usual; the second limit is for feasible controls, whose last digits may take their
time where hundreds of pairs of zeros nearly meet."""
CONVERGED = 1e-14
"""Moments against ∫|φ| that count as zero (empirical: reaches 1e-16)."""
ON_ZERO = 1e-12
"""σ at the switches against its parts that counts as zero."""
FEASIBLE = 1e-10
"""Moments against ∫|φ| at which a control counts as feasible; the state follows to 1e-9 of its
peak, as the solver checks again."""
AGREEMENT = 1e-12
"""Relative distance of time and bound at which the search ends at once."""
SUFFICIENT = 1e-10
"""Distance that no finer start is tried for: rounding, not the start, is what is left."""
ROUNDING = 1e-9
"""Doubt about t_f that rounding alone may leave for a refinement to be tried."""
LARGEST_MULTIPLIER = 1e14
"""|c| ∫|φ| against ∫|σ| beyond which σ is nothing but rounding."""
EXCHANGES = 4
"""Changes of structure in a row; one is usual next to the birth of an arc."""
TOLERANCES = (3e-3, 1e-4, 1e-6)
"""Complementarity of the starts on the first cells: nine of ten attempts succeed from the first,
the next one gives the structure where pairs of zeros are close (empirical)."""
ASCENT_STEPS = 6
"""From each later start."""
REFINEMENTS = 8
"""Divisions; the last has cells of 1e-5 of the fastest period where σ is near zero."""
SHORTEST_ARC = 1e-20
"""Against the final time; guards a division."""
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
    """

    zeros: Array
    horizon: float
    first_sign: float
    multipliers: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Polished:
    """What Newton made of a control.

    Parameters
    ----------
    control
        The best one on the way.
    residual
        Largest violated moment against ∫|φ|, and of the target against itself.
    end_value
        σ at the final time.
    excess
        ∫ sign σ up to the final time less the span, with the signs of the control [s] or [s²].
    """

    control: BangBang
    residual: float
    end_value: float
    excess: float


def polish(mesh: Mesh, start: BangBang, *, span: float) -> Polished:
    """Return the stationary control next to another.

    Parameters
    ----------
    mesh
        Reaches beyond the final time; scales the equations only.
    start
        Zeros, final time and multipliers to start from.
    span
        target / F_max.

    Returns
    -------
    Polished
        Its ``residual`` tells whether Newton converged.

    Source: docs/optimal-control.md, section 3.
    """
    problem = mesh.problem
    scale = np.append(moment_norms(mesh, start.horizon), span) + 1e-300
    jumps = sign_jumps(start.zeros.size, first_sign=start.first_sign)
    k = start.zeros.size
    ends, c = np.append(start.zeros, start.horizon), start.multipliers
    best, best_ends, best_c, least = None, ends, c, inf
    for steps in range(FINISHING_STEPS):
        if steps >= NEWTON_STEPS and least > FEASIBLE:
            break
        if not _largest(c * scale[:-1]) < LARGEST_MULTIPLIER * span:
            break
        here = _defects(problem, ends, c, jumps=jumps, scale=scale)
        residual = _largest(here.right[k:])
        if not isfinite(residual):
            break
        if residual < least:
            best, best_ends, best_c, least = here, ends, c, residual
        if residual <= CONVERGED and _largest(here.right[:k]) <= ON_ZERO * float(here.psi[-1]):
            break
        step = _solve(_jacobian(problem, here, c, jumps=jumps, scale=scale), here.right)
        share = _share(ends.tolist(), step[: k + 1].tolist())
        ends = ends + share * step[: k + 1]
        c = c - share * step[k + 1 :] / scale[:-1]
    control = BangBang(
        zeros=best_ends[:-1],
        horizon=float(best_ends[-1]),
        first_sign=start.first_sign,
        multipliers=best_c,
    )
    if best is None:
        return Polished(control=control, residual=inf, end_value=nan, excess=nan)
    missing = best.right[k:] * scale
    return Polished(
        control=control,
        residual=least,
        end_value=float(best.psi[-1] - best.phi[-1] @ best_c),
        excess=float(missing[:-1] @ best_c - missing[-1]),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Defects:
    """What a Newton step is to remove.

    Parameters
    ----------
    phi, psi
        At the switches and the final time, shapes (k + 1, size), (k + 1,).
    right
        Minus what must vanish: σ at the k switches, moments and the missing target against
        their scales; shape (k + size + 1,).
    """

    phi: Array
    psi: Array
    right: Array


def _defects(
    problem: MomentProblem, ends: Array, multipliers: Array, *, jumps: Array, scale: Array
) -> _Defects:
    k, size = jumps.size - 1, problem.size
    less_one: Complex = np.expm1(ends[:, np.newaxis] * problem.rates)
    phi, psi = problem.columns(less_one + 1.0, 1.0), problem.target_values(ends)
    summed = (jumps @ less_one.view(np.float64)).view(np.complex128) / problem.rates
    right = np.empty(k + size + 1)
    np.subtract(phi[:k] @ multipliers, psi[:k], out=right[:k])
    right[k:-1] = summed.view(np.float64)[:size]
    if problem.degree:
        right[-2] = jumps @ ends
    right[-1] = jumps @ problem.target_integrals(ends) - scale[-1]
    right[k:] /= -scale
    return _Defects(phi=phi, psi=psi, right=right)


def _jacobian(
    problem: MomentProblem, here: _Defects, multipliers: Array, *, jumps: Array, scale: Array
) -> Array:
    """Return the derivatives by switches, final time and minus the scaled multipliers."""
    k, size = jumps.size - 1, problem.size
    matrix = np.zeros((k + size + 1, k + size + 1), order="F")
    diagonal = matrix.reshape(-1, order="F")[: k * (k + size + 2) : k + size + 2]
    slopes = here.phi[:k] @ problem.slope_multipliers(multipliers)
    np.subtract(problem.degree, slopes, out=diagonal)
    relative = here.phi / scale[:-1]
    matrix[:k, k + 1 :] = relative[:k]
    matrix[k:-1, : k + 1] = relative.T * jumps
    matrix[-1, : k + 1] = here.psi * (jumps / scale[-1])
    return matrix


def _largest(values: Array) -> float:
    """Return the largest magnitude, nan if one is; of a handful, for which numpy is slow."""
    sizes = [abs(value) for value in values.tolist()]
    return max(sizes, default=0.0) if isfinite(sum(sizes)) else nan


def _solve(matrix: Array, right: Array) -> Array:
    _, _, step, info = dgesv(matrix, right)
    if info:
        # Fewer switches than conditions leave multipliers undetermined: take the least step.
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])
    return np.asarray(step)


def _share(ends: list[float], step: list[float]) -> float:
    # An arc that Newton has closed to the last digit holds the others up no longer than that.
    least = SHORTEST_ARC * ends[-1]
    end, moved, closing = 0.0, 0.0, 1e-300
    for next_end, next_moved in zip(ends, step, strict=True):
        closing = max(closing, (moved - next_moved) / max(next_end - end, least))
        end, moved = next_end, next_moved
    return min(1.0, TO_BOUNDARY / closing)


def confirm(mesh: Mesh, polished: Polished, *, span: float) -> DualPoint:
    """Return the multipliers of a control with all zeros of their σ and the time they prove.

    Usually the zeros are just the switches, known to full precision, and ∫|σ| up to the final time
    differs from the span by what is left of the moments; else T' is found anew.

    Parameters
    ----------
    mesh
        Reaches beyond the final time.
    polished
        A control next to which Newton ended.
    span
        target / F_max.

    Returns
    -------
    DualPoint
    """
    control, end_value = polished.control, polished.end_value
    c, horizon = control.multipliers, control.horizon
    brackets = bracket_zeros(mesh, c, horizon=horizon, settled=has_one_zero)
    sign = control.first_sign * (-1.0) ** control.zeros.size
    if sign * end_value <= 0.0 or not brackets.isolate(control.zeros, horizon, end_value):
        return evaluate_dual(mesh, c, span=span, near=horizon)
    return DualPoint(
        mesh=mesh,
        multipliers=c,
        bound=horizon - polished.excess / abs(end_value),
        zeros=control.zeros,
        first_sign=control.first_sign,
        end_value=abs(end_value),
        doubt=brackets.doubt,
    )


def find_bang_bang(problem: MomentProblem, *, span: float) -> Attempt:
    """Return the time-optimal control as signs over the remaining time.

    Starts of rising accuracy are polished; the last ones take turns with Newton steps on the dual
    bound. An attempt is accepted when the bound that its multipliers prove equals the time that
    it takes.

    Parameters
    ----------
    problem
        The moment problem.
    span
        target / F_max [s] or [s²].

    Returns
    -------
    Attempt

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if no attempt is feasible to ``FEASIBLE``; how far the bound stays behind
        is left to the certificate.
    """
    cells = start_force(problem, span=span, tolerance=TOLERANCES[0])
    best = _exchange(cells.mesh, _seen_control(cells), span)
    for tolerance in TOLERANCES[1:]:
        if best and best.gap <= AGREEMENT:
            return best
        cells = improve(cells, span=span, tolerance=tolerance)
        best = _better(best, _exchange(cells.mesh, _seen_control(cells), span))
    if best and best.gap <= AGREEMENT:
        return best
    # Finer starts help the structure, not the digits that nearly dependent functions cost.
    is_worth = ROUNDING * independence(problem, cells.horizon) > ROUNDOFF
    for refinement in range(REFINEMENTS if is_worth else 0):
        best = _better(best, _climb(cells, span))
        if best and best.gap <= SUFFICIENT:
            return best
        tolerance = TOLERANCES[-1] * PARTS ** -(refinement + 1)
        cells = improve(refine_cells(cells), span=span, tolerance=tolerance)
    if best is None:
        detail = f"no control for span {span:.6g} next to {cells.horizon:.9g} s reaches rest"
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return best


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attempt:
    """A feasible control with the time that its multipliers prove.

    Parameters
    ----------
    control
        The control.
    point
        Its multipliers with all zeros of their σ and the time that they prove.
    """

    control: BangBang
    point: DualPoint

    @property
    def gap(self) -> float:
        """Relative distance of both times."""
        return abs(self.control.horizon - self.point.bound) / self.control.horizon


def _better(one: Attempt | None, other: Attempt | None) -> Attempt | None:
    if one is None or other is None:
        return one or other
    return one if one.gap <= other.gap else other


def _climb(cells: CellForce, span: float) -> Attempt | None:
    """Polish from the cells' multipliers and from better ones that Newton steps lead to."""
    point = evaluate_dual(cells.mesh, cells.multipliers, span=span, near=cells.horizon)
    ascent, best = Ascent(point=point), None
    for _ in range(ASCENT_STEPS):
        best = _better(best, _exchange(point.mesh, _proved_control(ascent.point), span))
        if ascent.stalled or (best and best.gap <= AGREEMENT):
            break
        ascent = ascend(ascent, span=span)
    return best


def _exchange(mesh: Mesh, start: BangBang, span: float) -> Attempt | None:
    """Polish; where the multipliers then show other zeros than the control has, do so with those.

    Next to the birth of an arc this is what adds or drops the two zeros.
    """
    best = None
    for _ in range(EXCHANGES):
        polished = polish(mesh, start, span=span)
        if polished.residual > FEASIBLE:
            break
        point = confirm(mesh, polished, span=span)
        attempt = Attempt(control=polished.control, point=point)
        best = _better(best, attempt)
        if attempt.gap <= AGREEMENT or point.zeros.size == polished.control.zeros.size:
            break
        start = _proved_control(point)
    return best


def _proved_control(point: DualPoint) -> BangBang:
    return BangBang(
        zeros=point.zeros,
        horizon=point.bound,
        first_sign=point.first_sign,
        multipliers=point.multipliers,
    )


def _seen_control(cells: CellForce) -> BangBang:
    """Return the sign changes of σ between nodes; pairs inside a cell are left out."""
    mesh, c = cells.mesh, cells.multipliers
    problem, last = mesh.problem, int(mesh.nodes.searchsorted(cells.horizon))
    nodes, values = mesh.nodes[: last + 1], mesh.values
    sigma = problem.target_values(nodes) - values[: last + 1] @ c
    positive = sigma > 0.0
    at = (positive[1:] != positive[:-1]).nonzero()[0]
    length, slopes = mesh.lengths[at], problem.slope_multipliers(c)
    left_slope = (problem.degree - values[at] @ slopes) * length
    right_slope = (problem.degree - values[at + 1] @ slopes) * length
    share = cubic_zeros(sigma[at], sigma[at + 1], left_slope, right_slope, steps=1)
    zeros = nodes[at] + length * share
    inside = zeros < cells.horizon
    return BangBang(
        zeros=zeros[inside],
        horizon=cells.horizon,
        first_sign=1.0 if sigma[0] > 0.0 else -1.0,
        multipliers=c,
    )
