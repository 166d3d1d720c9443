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
from scipy.sparse import csc_array, diags_array, hstack, vstack
from scipy.sparse.linalg import splu

from mtcommission.optimal.free.dual import moment_norms, sign_jumps
from mtcommission.optimal.free.mesh import Mesh
from mtcommission.optimal.free.moments import MomentProblem

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
TINY = 1e-300
SHORTEST_ARC = 1e-20
"""Against the final time; guards a division."""
TO_BOUNDARY = 0.9
"""Longest step, as a share of the one that closes an arc."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BangBang:
    """A bang-bang force in the remaining time, with its multipliers."""

    zeros: Array  # Remaining times of the switches, ascending, shape (k,) [s]
    horizon: float  # t_f [s]
    first_sign: float  # Sign of the force before the first zero, i.e. at the end of the move.
    multipliers: Array  # c, shape (size,)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RefinedControl:
    """What Newton made of a control."""

    control: BangBang  # The best one on the way
    residual: float  # Largest violated moment against ∫|φ|, and of the target against itself
    end_value: float  # σ at the final time
    # ∫ sign σ up to the final time less the span, with the signs of the control [s] or [s²].
    excess: float


def refine_control(mesh: Mesh, start: BangBang, *, span: float) -> RefinedControl:
    """Return the stationary control next to another.

    Source: docs/optimal-control.md, section 3.
    """
    system = _system(mesh, start, span)
    ends = np.concatenate((start.zeros, (start.horizon,)))
    weights = np.ones(system.scale.size)
    np.multiply(start.multipliers, system.scale[:-1] / -span, out=weights[:-1])
    best, first = None, 0.0
    for steps in range(FINISHING_STEPS):
        if not _largest(weights) < LARGEST_MULTIPLIER:
            break
        here = _point(system, ends, weights)
        if not isfinite(here.residual):
            break
        if best is None or here.residual < best.residual:
            best = here
        first = first or here.residual
        if here.is_solved or _is_lost(steps, first, best.residual):
            break
        ends, weights = _step(system, here)
    if best is None:
        return RefinedControl(control=start, residual=inf, end_value=nan, excess=nan)
    return RefinedControl(
        control=BangBang(
            zeros=best.ends[:-1],
            horizon=float(best.ends[-1]),
            first_sign=start.first_sign,
            multipliers=best.weights[:-1] * (-span * system.inverse[:-1]),
        ),
        residual=best.residual,
        end_value=span * float(best.functions[-1] @ best.weights),
        excess=span * float(best.defects[start.zeros.size :] @ best.weights),
    )


def _is_lost(steps: int, first: float, least: float) -> bool:
    """Return whether Newton leads nowhere, given the first residual and the least so far."""
    if steps >= NEWTON_STEPS:
        return least > FEASIBLE
    return steps >= HOPEFUL_STEPS and least > HOPELESS * first


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _System:
    """What stays the same from one Newton step to the next.

    All functions are scaled by their moments' size: φ by ∫|φ|, ψ by the span. So σ / span is the
    sum of the scaled functions with the weights -c ∫|φ| / span and 1.
    """

    problem: MomentProblem  # The moment problem
    jumps: Array  # Weights of the primitives at the k switches and the final time, shape (k + 1,)
    # scale, inverse: ∫|φ| and, last, the span, and what functions are multiplied by, shape
    # (size + 1,).
    scale: Array
    inverse: Array
    differentiation: Array  # Takes the weights to those of dσ/dτ, shape (size + 1, size + 1) [1/s]
    # evaluation, integration: As those of the moment problem for the scaled functions, shape
    # (one + 3, size + 1).
    evaluation: Array
    integration: Array
    target: Array  # Wanted moments of the scaled functions: 0, and last 1; shape (size + 1,)


def _system(mesh: Mesh, start: BangBang, span: float) -> _System:
    problem, count = mesh.problem, mesh.problem.size + 1
    scale, target = np.empty(count), np.zeros(count)
    scale[:-1], scale[-1] = moment_norms(mesh, start.horizon) + TINY, span
    target[-1] = 1.0
    inverse = 1.0 / scale
    differentiation = problem.joint_differentiation[:count, :count] * inverse
    differentiation *= scale[:, np.newaxis]
    return _System(
        problem=problem,
        jumps=sign_jumps(start.zeros.size, first_sign=start.first_sign),
        scale=scale,
        inverse=inverse,
        differentiation=differentiation,
        evaluation=problem.joint_evaluation * inverse,
        integration=problem.joint_integration * inverse,
        target=target,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Point:
    """Unknowns of Newton's method and what they leave over."""

    ends: Array  # Switches and final time, shape (k + 1,) [s]
    weights: Array  # Of the scaled functions in σ / span, shape (size + 1,); the last is 1
    functions: Array  # Scaled φ and ψ at the ends, shape (k + 1, size + 1)
    # What must vanish: σ / span at the k switches, moments and missing target of the scaled
    # functions; shape (k + size + 1,).
    defects: Array
    residual: float  # Largest magnitude of the moments and the target among them; nan if one is

    @property
    def is_solved(self) -> bool:
        """Whether only rounding is left."""
        at_switches = self.defects[: self.ends.size - 1]
        return self.residual <= CONVERGED and _largest(at_switches) <= ON_ZERO * float(
            self.functions[-1, -1]
        )


def _point(system: _System, ends: Array, weights: Array) -> _Point:
    k, table = ends.size - 1, system.problem.table(ends)
    functions = table.dot(system.evaluation)
    defects = np.empty(k + weights.size)
    functions[:k].dot(weights, out=defects[:k])
    moments = system.jumps.dot(table).dot(system.integration)
    np.subtract(moments, system.target, out=defects[k:])
    return _Point(
        ends=ends,
        weights=weights,
        functions=functions,
        defects=defects,
        residual=_largest(defects[k:]),
    )


def _step(system: _System, here: _Point) -> tuple[Array, Array]:
    """Return ends and weights after a Newton step that closes no arc."""
    count = here.ends.size
    if count > MOST_DENSE:
        step = _solve_sparsely(_sparse_jacobian(system, here), here.defects)
    else:
        step = _solve(_jacobian(system, here), here.defects)
    share = _share(here.ends.tolist(), step[:count].tolist())
    step *= share
    weights = here.weights.copy()
    weights[:-1] -= step[count:]
    return here.ends - step[:count], weights


def _jacobian(system: _System, here: _Point) -> Array:
    """Return the derivatives of the defects by the ends and all weights but the last."""
    k, order = here.ends.size - 1, here.defects.size
    matrix = np.zeros((order, order), order="F")
    diagonal = matrix.reshape(-1, order="F")[: k * (order + 1) : order + 1]
    diagonal[:] = here.functions[:k].dot(system.differentiation.dot(here.weights))
    matrix[:k, k + 1 :] = here.functions[:k, :-1]
    np.multiply(here.functions.T, system.jumps, out=matrix[k:, : k + 1])
    return matrix


def _sparse_jacobian(system: _System, here: _Point) -> csc_array:
    """Return the same where its diagonal is long: all but that and two edges is zero."""
    k = here.ends.size - 1
    diagonal = here.functions[:k].dot(system.differentiation.dot(here.weights))
    edge = np.column_stack([np.zeros(k), here.functions[:k, :-1]])
    bottom = here.functions.T * system.jumps
    corner = np.column_stack([bottom[:, k:], np.zeros((len(bottom), edge.shape[1] - 1))])
    above = hstack([diags_array(diagonal), csc_array(edge)])
    return csc_array(vstack([above, csc_array(np.column_stack([bottom[:, :k], corner]))]))


def _solve_sparsely(matrix: csc_array, right: Array) -> Array:
    try:
        return np.asarray(splu(matrix).solve(right))
    except RuntimeError:  # singular; a least step would take the dense matrix
        return np.full(right.size, nan)


def _largest(values: Array) -> float:
    """Return the largest magnitude, nan if one is, 0 of none."""
    sizes = np.abs(values)
    return float(sizes[sizes.argmax()]) if sizes.size else 0.0


def _solve(matrix: Array, right: Array) -> Array:
    _, _, step, info = dgesv(matrix, right)
    if info:
        # Fewer switches than conditions leave multipliers undetermined: take the least step.
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])
    return np.asarray(step)


def _share(ends: list[float], step: list[float]) -> float:
    """Return the share of a step that ends are to be lowered by so that no arc closes."""
    # An arc that Newton has closed to the last digit holds the others up no longer than that.
    least = SHORTEST_ARC * ends[-1]
    end, moved, closing = 0.0, 0.0, TINY
    for next_end, next_moved in zip(ends, step, strict=True):
        if next_moved > moved:
            closing = max(closing, (next_moved - moved) / max(next_end - end, least))
        end, moved = next_end, next_moved
    return min(1.0, TO_BOUNDARY / closing)
