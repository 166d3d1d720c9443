"""The dual of the time-optimal problem: maximise the time that multipliers prove to be needed.

For any multipliers c, no force below F_max reaches the target before the time T'(c) with

    F_max ∫_0^{T'} |σ_c| dτ = target,        σ_c = ψ - Σ c_i φ_i.

T' is quasi-concave in c, its maximum is t_f, and there sign σ_c is the optimal control.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.free.mesh import Mesh, build_mesh
from mtcommission.optimal.free.moments import MomentProblem
from mtcommission.optimal.free.switching import SAME, isolate_zeros, values_and_slopes

Array = NDArray[np.float64]

LEAST_DAMPING = 1e-9
DAMPING_LIMIT = 1e12
"""Levenberg damping, against the scaled Hessian: below the first it is dropped, beyond the
second no ascent is left (empirical)."""
FLATTEST = 1e-8
"""Least scale of a multiplier against that of the others (empirical)."""
LEVEL = 1e-15
"""Relative change of T' that rounding can feign."""
LENGTHENINGS = 40
"""Doublings of a mesh before a bound counts as unlimited."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DualPoint:
    """Multipliers and the time that they prove."""

    mesh: Mesh  # The mesh that σ was searched on; reaches beyond the bound
    multipliers: Array  # c, shape (size,)
    bound: float  # T'(c) [s]
    zeros: Array  # Sign changes of σ before the bound, ascending, shape (k,) [s]
    first_sign: float  # Sign of σ before the first zero
    end_value: float  # |σ(T')|
    doubt: float  # Part of ∫|σ| that rounding hides, at most

    def moments(self) -> Array:
        """Return ∫_0^{T'} sign(σ) φ, shape (size,); the gradient of T' up to 1/|σ(T')|."""
        integrals = self.mesh.problem.integrals(np.append(self.zeros, self.bound))
        return np.asarray(sign_jumps(self.zeros.size, first_sign=self.first_sign) @ integrals)


@lru_cache(maxsize=64)
def sign_jumps(count: int, *, first_sign: float) -> Array:
    """Return the weights w with ∫ sign f = Σ w_k P(end_k), P the primitive of f from 0.

    Examples
    --------
    >>> sign_jumps(2, first_sign=1.0)
    array([ 2., -2.,  1.])
    """
    jumps = np.full(count + 1, 2.0 * first_sign)
    jumps[1::2] *= -1.0
    jumps[-1] *= 0.5
    jumps.setflags(write=False)
    return jumps


def moment_norms(mesh: Mesh, horizon: float) -> Array:
    """Return ∫_0^horizon |φ| as a sum, to scale moments by, shape (size,)."""
    inside = int(mesh.nodes[:-1].searchsorted(horizon))
    return np.asarray(np.abs(mesh.values[:-1, :inside]).dot(mesh.lengths[:inside]))


def evaluate_dual(mesh: Mesh, multipliers: Array, *, span: float, near: float) -> DualPoint:
    """Return T'(c) with what a Newton step needs.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if T'(c) lies beyond 2^40 meshes.
    """
    problem = mesh.problem
    for _ in range(LENGTHENINGS):
        isolated = isolate_zeros(mesh, multipliers)
        zeros = isolated.tau
        ends = np.append(zeros, mesh.horizon)
        integrals = problem.integrals(ends)
        primitive = problem.target_integrals(ends) - integrals @ multipliers
        parts = np.abs(primitive)
        parts[1:] = np.abs(primitive[1:] - primitive[:-1])
        reached = parts.cumsum()
        if reached[-1] >= span:
            break
        mesh = build_mesh(problem, 2.0 * mesh.horizon)
    else:
        detail = Message("multipliers-prove-beyond", t_f=mesh.horizon)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    k = int(reached.searchsorted(span))
    start = float(zeros[k - 1]) if k else 0.0
    base = float(primitive[k - 1]) if k else 0.0
    missing = span - (float(reached[k - 1]) if k else 0.0)
    bound = _reach(problem, multipliers, (start, near, float(ends[k])), base, missing)
    _, end_value = problem.combination(multipliers, bound)
    return DualPoint(
        mesh=mesh,
        multipliers=multipliers,
        bound=bound,
        zeros=zeros[:k],
        first_sign=(1.0 if end_value >= 0.0 else -1.0) * (-1.0) ** k,
        end_value=abs(end_value),
        doubt=isolated.doubt,
    )


def _reach(
    problem: MomentProblem,
    multipliers: Array,
    guesses: tuple[float, float, float],
    base: float,
    missing: float,
) -> float:
    """Return τ between the first and last guess with ∫_first^τ |σ| = missing; σ keeps its sign."""
    low, tau, high = guesses
    tau = tau if low < tau < high else high
    for _ in range(100):
        primitive, sigma = problem.combination(multipliers, tau)
        excess = abs(primitive - base) - missing
        low, high = (low, tau) if excess > 0.0 else (tau, high)
        newton = tau - excess / abs(sigma) if sigma else low
        proposal = newton if low < newton < high else 0.5 * (low + high)
        if abs(proposal - tau) <= SAME * tau:
            return proposal
        tau = proposal
    return tau


def _residual(point: DualPoint) -> float:
    """Return the largest moment against ∫|φ|; 0 at the optimum."""
    return float(np.max(np.abs(point.moments()) / moment_norms(point.mesh, point.bound)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ascent:
    """Where an ascent stands."""

    point: DualPoint  # The best multipliers so far
    damping: float = 0.0  # Levenberg damping of the next step, against the scaled Hessian
    stalled: bool = False  # Whether rounding or curvature ends the ascent here


def ascend(ascent: Ascent, *, span: float) -> Ascent:
    """Return the ascent after one damped Newton step on T'(c).

    With the moments m and W = Σ 2 φ φ^T / |σ'| over the zeros, the step W^-1 m converges
    quadratically wherever all zeros are simple; damping makes every step an ascent, so births
    of arcs (double zeros) cost steps but not the result.

    Source: docs/optimal-control.md, section 3.
    """
    point = ascent.point
    functions = point.mesh.problem.joint_values(point.zeros)
    _, slopes = values_and_slopes(point.mesh.problem, point.multipliers, functions)
    weighted = functions[:-1] * np.sqrt(2.0 / np.maximum(np.abs(slopes), 1e-300))
    hessian = weighted @ weighted.T
    if not point.zeros.size:
        return Ascent(point=point, damping=ascent.damping, stalled=True)
    moments, norms = point.moments(), moment_norms(point.mesh, point.bound)
    residual = _residual(point)
    scale = np.sqrt(np.diag(hessian))
    # A φ that has decayed at all zeros has next to no curvature; its step would overflow.
    scale = np.maximum(scale, FLATTEST * norms * float((scale / norms).max()))
    values, vectors = np.linalg.eigh(hessian / scale[:, np.newaxis] / scale)
    along = vectors.T @ (moments / scale)
    values = np.maximum(values, 1e-15 * max(float(values[-1]), 1e-300))
    damping = ascent.damping
    while damping < DAMPING_LIMIT:
        step = vectors @ (along / (values + damping)) / scale
        trial = evaluate_dual(point.mesh, point.multipliers + step, span=span, near=point.bound)
        if trial.bound >= point.bound * (1.0 - LEVEL):
            eased = 0.1 * damping if damping == ascent.damping else damping
            level = trial.bound <= point.bound * (1.0 + LEVEL)
            return Ascent(
                point=trial,
                damping=eased if eased > LEAST_DAMPING else 0.0,
                stalled=level and _residual(trial) >= 0.5 * residual,
            )
        damping = max(4.0 * damping, 1e3 * LEAST_DAMPING)
    return Ascent(point=point, damping=damping, stalled=True)
