"""Full precision: Newton on switching times, final time and multipliers together.

With the zeros of σ as unknowns of their own the equations stay smooth where two zeros meet, so
arcs of any length converge; the number of zeros is that of the start.
"""

from __future__ import annotations

from math import nan

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv
from scipy.sparse import csc_array, diags_array, hstack, vstack
from scipy.sparse.linalg import splu

from mtcommission.optimal.free.mesh import Mesh
from mtcommission.optimal.free.moments import TINY
from mtcommission.optimal.free.switching import Control

Array = NDArray[np.float64]

NEWTON_STEPS = 12
FINISHING_STEPS = 24
"""Five are usual; the second limit is for feasible controls, whose last digits may take their
time where hundreds of pairs of zeros nearly meet."""
HOPEFUL_STEPS = 5
HOPELESS = 0.5
"""Share of the first residual: what is above it after these steps never converged (empirical)."""
CONVERGED = 1e-14
"""Moments against ∫|φ| that count as zero (empirical: reaches 1e-16)."""
ON_ZERO = 1e-12
"""σ at the switches against its parts that counts as zero."""
FEASIBLE = 1e-10
"""Moments against ∫|φ| at which a control counts as feasible; the state follows to 1e-9 of its
peak, as the solver checks again."""
LARGEST_MULTIPLIER = 1e14
"""|c| ∫|φ| against ∫|σ| beyond which σ is nothing but rounding."""
MOST_DENSE = 500
"""Ends from which on the Jacobian is factorised as a sparse matrix: dense, a hundred thousand
switches of an undamped mode take 80 GB."""
SHORTEST_ARC = 1e-20
"""Against the final time; guards a division."""
TO_BOUNDARY = 0.9
"""Longest step, as a share of the one that closes an arc."""


def sign_jumps(count: int, *, first_sign: float) -> Array:
    """Return the weights w with ∫ sign f = Σ w_k P(end_k), P the primitive of f from 0."""
    jumps = np.full(count + 1, 2.0 * first_sign)
    jumps[1::2] *= -1.0
    jumps[-1] *= 0.5
    return jumps


def refine_control(mesh: Mesh, start: Control, *, span: float) -> Control | None:
    """Return the stationary control next to another; None where there is no feasible one.

    All functions are scaled by their moments' size: φ by ∫|φ|, ψ by the span. So σ / span is the
    sum of the scaled functions with weights of which the last is 1.

    Source: docs/optimal-control.md, section 3.
    """
    problem, k = mesh.problem, start.zeros.size
    jumps = sign_jumps(k, first_sign=start.first_sign)
    scale = np.concatenate((mesh.norms(start.horizon) + TINY, (span,)))
    inverse, target = 1.0 / scale, np.zeros(scale.size)
    target[-1] = 1.0
    differentiation = problem.differentiation * inverse * scale[:, np.newaxis]
    ends, weights = np.concatenate((start.zeros, (start.horizon,))), start.weights * scale / span
    best, first, least = None, nan, np.inf
    for steps in range(FINISHING_STEPS):
        if not _largest(weights) < LARGEST_MULTIPLIER:
            break
        functions, integrals = problem.values_and_integrals(ends)
        functions *= inverse[:, np.newaxis]
        missed = integrals.dot(jumps) * inverse - target
        sigma, residual = weights.dot(functions[:, :k]), _largest(missed)
        if not np.isfinite(residual):
            break
        first = residual if steps == 0 else first
        if residual < least:
            best, least = (ends, weights), residual
        size = abs(float(functions[-1, -1]))
        is_solved = residual <= CONVERGED and _largest(sigma) <= ON_ZERO * size
        is_lost = steps >= HOPEFUL_STEPS and least > HOPELESS * first
        if is_solved or is_lost or (steps >= NEWTON_STEPS and least > FEASIBLE):
            break
        slopes = differentiation.dot(weights).dot(functions[:, :k])
        solve = _solve_sparsely if ends.size > MOST_DENSE else _solve
        step = solve(slopes, functions, jumps, np.concatenate((sigma, missed)))
        step *= _share(ends.tolist(), step[: k + 1].tolist())
        ends, weights = ends - step[: k + 1], weights.copy()
        weights[:-1] -= step[k + 1 :]
    if best is None or least > FEASIBLE:
        return None
    ends, weights = best
    return Control(
        zeros=ends[:-1],
        horizon=float(ends[-1]),
        first_sign=start.first_sign,
        weights=weights * (span * inverse),
    )


def _solve(slopes: Array, functions: Array, jumps: Array, defects: Array) -> Array:
    """Return the Newton step of the ends and of all weights but the last."""
    k = slopes.size
    matrix = np.zeros((defects.size, defects.size), order="F")
    matrix[np.arange(k), np.arange(k)] = slopes
    matrix[:k, k + 1 :] = functions[:-1, :k].T
    np.multiply(functions, jumps, out=matrix[k:, : k + 1])
    _, _, step, info = dgesv(matrix, defects)
    if info:
        # Fewer switches than conditions leave multipliers undetermined: take the least step.
        return np.asarray(np.linalg.lstsq(matrix, defects, rcond=None)[0])
    return np.asarray(step)


def _solve_sparsely(slopes: Array, functions: Array, jumps: Array, defects: Array) -> Array:
    """Return the same where the diagonal is long: all but that and two edges is zero."""
    k = slopes.size
    edge = np.column_stack([np.zeros(k), functions[:-1, :k].T])
    bottom = functions * jumps
    corner = np.column_stack([bottom[:, k:], np.zeros((len(bottom), edge.shape[1] - 1))])
    above = hstack([diags_array(slopes), csc_array(edge)])
    matrix = vstack([above, csc_array(np.column_stack([bottom[:, :k], corner]))])
    try:
        return np.asarray(splu(csc_array(matrix)).solve(defects))
    except RuntimeError:  # singular; a least step would take the dense matrix
        return np.full(defects.size, nan)


def _share(ends: list[float], step: list[float]) -> float:
    """Return the share of a step that ends are to be lowered by so that no arc closes."""
    # An arc that Newton has closed to the last digit holds the others up no longer than that.
    least, closing = SHORTEST_ARC * ends[-1], TINY
    for start, end, first, last in zip([0.0, *ends], ends, [0.0, *step], step, strict=False):
        closing = max(closing, (last - first) / max(end - start, least))
    return min(1.0, TO_BOUNDARY / closing)


def _largest(values: Array) -> float:
    return float(np.maximum.reduce(np.abs(values), initial=0.0))
