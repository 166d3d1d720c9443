"""The bang-bang control of least time: a start by a primal-dual method, then Newton's method.

The start is the best force that is constant on cells. The end of the move floats: at every step it
is where ∫|σ| reaches the span, so one run finds multipliers and final time together. Where the
result is not near enough to the optimum, cells in which σ may change sign are divided, and the run
goes on from where it was. Newton's method then has the zeros of σ as unknowns of their own, beside
final time and multipliers: the equations stay smooth where two zeros meet, so arcs of any length
converge.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, log, nan, pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgeqrf, dgesv
from scipy.sparse import csc_array, diags_array, hstack, vstack
from scipy.sparse.linalg import splu

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.optimal.modes import TINY, MomentProblem
from mtcommission.optimal.switching import ROUNDOFF, Control, Mesh, build_mesh, prove_time, tabulate

Array = NDArray[np.float64]

MARGIN = 1.3
"""Length of the mesh against the guessed final time (empirical)."""
REBUILDS = 8
"""Meshes tried; one is usual."""
LEAST_SHARE = 0.6
"""Final time against the mesh below which the mesh is too coarse (empirical)."""
PARTS = 4
"""Cells into which one is divided."""
START_STEPS = 100
"""Newton steps; six are usual."""
SMOOTHING = 0.5
"""Width over which the sign of σ is smoothed, against the mean gap (empirical)."""
BACK_OFF = 0.99
"""Longest step, as a share of the one that makes a force reach its limit (empirical)."""
FARTHEST = 1.0 + ROUNDOFF
"""Limit of a force on its way to 1: always some room is left."""
FIRST_SMOOTHING = 3.0
"""The same against the mean of |σ|, at the beginning (empirical: fewest steps)."""
SHRINKING = 0.9
"""Least horizon after a step against that before (empirical)."""
GUESS_NODES = (np.arange(64) + 0.5) / 64
FIRST_GUESS = 0.12
"""Between the least and the longest time thought of (empirical: the median)."""
GUESS_TOLERANCE = 0.1
"""Error of the logarithm of the span (empirical)."""
GUESS_STEPS = 8
MEAN_TO_SQUARE = 0.9
"""Mean magnitude against root mean square of a sine."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _CellForce:
    """A force that is constant on cells, on its way to the best one."""

    mesh: Mesh  # Its cells are those of the force; reaches beyond the horizon
    psi: Array  # Means of ψ over the cells, shape (n_cells,)
    # Means of combinations of φ that are orthonormal up to the guess, shape (size, n_cells).
    basis: Array
    inverse: Array  # basis = inverse^T @ φ, upper triangular, shape (size, size)
    coefficients: Array  # Of the basis in -σ, shape (size,)
    force: Array  # In units of F_max, shape (n_cells,)
    horizon: float  # Where ∫|σ| reaches the span [s]

    @property
    def weights(self) -> Array:
        """Of σ, shape (size + 1,)."""
        return np.append(-self.inverse @ self.coefficients, 1.0)

    @property
    def control(self) -> Control:
        """The sign changes of σ between nodes; pairs inside a cell are left out."""
        nodes, weights = self.mesh.nodes, self.weights
        sigma = weights.dot(self.mesh.values[:, : int(nodes.searchsorted(self.horizon)) + 1])
        positive = sigma > 0.0
        at = (positive[1:] != positive[:-1]).nonzero()[0]
        zeros = nodes[at] + self.mesh.lengths[at] * (sigma[at] / (sigma[at] - sigma[at + 1]))
        return Control(
            zeros=zeros[zeros < self.horizon],
            horizon=self.horizon,
            first_sign=1.0 if positive[0] else -1.0,
            weights=weights,
        )


def _start_force(problem: MomentProblem, *, span: float, tolerance: float) -> _CellForce:
    """Return a force that is near the best one on cells of the first, coarse mesh."""
    guess = guess_horizon(problem, span=span)
    for _ in range(REBUILDS):
        mesh = build_mesh(problem, MARGIN * guess)
        found = _improve(_fit_squares(mesh, guess), span=span, tolerance=tolerance)
        if LEAST_SHARE * mesh.horizon < found.horizon < mesh.horizon:
            break
        guess = found.horizon
    return found


def guess_horizon(problem: MomentProblem, *, span: float) -> float:
    """Return where the distance of ψ from the φ in the mean square is that of the span [s]."""
    least = 2.0 * sqrt(span) if problem.degree else span
    longest = least + 3.0 * pi * float((1.0 / problem.magnitudes).sum())
    low, high = log(least), log(longest)
    guess, error = log(least + FIRST_GUESS * (longest - least)), [0.0, 0.0]
    for _ in range(GUESS_STEPS):
        triangle = dgeqrf(problem.values(exp(guess) * GUESS_NODES).T, overwrite_a=1)[0]
        distance = abs(float(triangle[problem.size, -1])) * exp(guess) / sqrt(GUESS_NODES.size)
        now = log(max(MEAN_TO_SQUARE * distance, TINY) / span)
        error[now > 0.0] = now
        low, high = (low, guess) if now > 0.0 else (guess, high)
        if abs(now) < GUESS_TOLERANCE or high - low < 0.5 * GUESS_TOLERANCE:
            break
        share = error[0] / (error[0] - error[1]) if all(error) else 0.5
        guess = low + min(max(share, 0.05), 0.95) * (high - low)
    return exp(guess)


def _improve(begun: _CellForce, *, span: float, tolerance: float) -> _CellForce:
    """Return the force after enough Newton steps.

    At the optimum the force is the sign of σ, and its moments vanish. The sign is smoothed over a
    width in proportion to the gap that is left, so both shrink together. Newton's equations are
    those of force · √(σ² + width²) = σ: unlike those of force = σ / √(σ² + width²) they hold
    far from the solution, too.

    Source: Chan, Golub & Mulet 1999, there for total variation; with a floating end.
    """
    mesh, basis = begun.mesh, begun.basis
    c, force, horizon, proved = begun.coefficients, begun.force, begun.horizon, 0.0
    sigma, reached = begun.psi - c.dot(basis), np.zeros(mesh.nodes.size)
    for _ in range(START_STEPS):
        size = np.abs(sigma)
        (mesh.lengths * size).cumsum(out=reached[1:])
        # Any c proves its time; one that is far from the best may prove next to nothing.
        proved = max(proved, float(np.interp(span, reached, mesh.nodes)))
        horizon = max(proved, SHRINKING * horizon)
        weight = _weights(mesh, horizon)
        gap = float(weight.dot(size - force * sigma))
        if gap < tolerance * min(span, float(reached[-1])):
            break
        width = SMOOTHING * gap / horizon
        root = np.sqrt(sigma * sigma + width * width)
        sign = sigma / root
        stiffness = (1.0 - force * sign) / root
        hessian = (basis * (weight * stiffness)).dot(basis.T)
        _, _, step, info = dgesv(hessian, basis.dot(weight * sign))
        if info:
            break
        change = step.dot(basis)
        c, sigma = c + step, sigma - change
        move = sign - stiffness * change - force
        used = move / (np.copysign(FARTHEST, move) - force)
        force = force + min(1.0, BACK_OFF / max(float(used.max()), TINY)) * move
    return replace(begun, coefficients=c, force=force, horizon=horizon)


def _refine_cells(coarse: _CellForce) -> _CellForce:
    """Return the force on divided cells, where σ may change sign."""
    mesh, problem = coarse.mesh, coarse.mesh.problem
    sigma = coarse.weights @ mesh.values
    low = np.minimum(np.abs(sigma[:-1]), np.abs(sigma[1:]))
    turn = np.multiply.outer(problem.magnitudes, mesh.lengths)
    bend = problem.amplitudes(coarse.weights) @ (384.0 * mesh.remainder / turn**2)
    parts = np.where((low <= bend) | (sigma[:-1] * sigma[1:] <= 0.0), PARTS, 1)
    index = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    starts = np.repeat(mesh.nodes[:-1], parts) + index * np.repeat(mesh.lengths / parts, parts)
    fine = tabulate(problem, np.append(starts, mesh.nodes[-1]))
    means = _means(fine)
    psi, basis = means[-1], coarse.inverse.T @ means[:-1]
    force = _smooth_sign(psi - coarse.coefficients @ basis, fine, coarse.horizon)
    return replace(coarse, mesh=fine, psi=psi, basis=basis, force=force)


def _means(mesh: Mesh) -> Array:
    """Return the means of φ and, last, ψ over the cells by Hermite's rule, (size + 1, n_cells)."""
    values = mesh.values
    slopes = mesh.problem.differentiation.T.dot(values)
    bent = (slopes[:, :-1] - slopes[:, 1:]) * (mesh.lengths / 12.0)
    return np.asarray(0.5 * (values[:, :-1] + values[:, 1:]) + bent)


def _fit_squares(mesh: Mesh, horizon: float) -> _CellForce:
    """Return the force that follows σ of the fit in the mean square up to the horizon."""
    means = _means(mesh)
    size, weight = mesh.problem.size, _weights(mesh, horizon)
    reflectors = dgeqrf((means * np.sqrt(weight)).T, overwrite_a=1)[0]
    triangle, coefficients = np.triu(reflectors[:size, :size]), reflectors[:size, size]
    # No triangular solver: BLAS would set up threads for it, which take longer than all the rest.
    inverse = dgesv(triangle, np.eye(size))[2]
    psi, basis = means[-1], inverse.T.dot(means[:-1])
    return _CellForce(
        mesh=mesh,
        psi=psi,
        basis=basis,
        inverse=inverse,
        coefficients=coefficients,
        force=_smooth_sign(psi - coefficients.dot(basis), mesh, horizon),
        horizon=horizon,
    )


def _weights(mesh: Mesh, horizon: float) -> Array:
    inside = np.minimum(mesh.nodes, horizon)
    return np.asarray(inside[1:] - inside[:-1])


def _smooth_sign(sigma: Array, mesh: Mesh, horizon: float) -> Array:
    mean = float(_weights(mesh, horizon) @ np.abs(sigma)) / horizon
    return np.asarray(sigma / (np.hypot(sigma, FIRST_SMOOTHING * mean) + TINY))


NEWTON_STEPS = 24
"""Five are usual; the last digits may take their time where hundreds of pairs of zeros nearly
meet."""
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


def _sign_jumps(count: int, *, first_sign: float) -> Array:
    """Return the weights w with ∫ sign f = Σ w_k P(end_k), P the primitive of f from 0."""
    jumps = np.full(count + 1, 2.0 * first_sign)
    jumps[1::2] *= -1.0
    jumps[-1] *= 0.5
    return jumps


def _refine_control(mesh: Mesh, start: Control, *, span: float) -> Control | None:
    """Return the stationary control next to another; None where there is no feasible one.

    All functions are scaled by their moments' size: φ by ∫|φ|, ψ by the span. So σ / span is the
    sum of the scaled functions with weights of which the last is 1.

    Source: docs/optimal-control.md, section 3.
    """
    problem, k = mesh.problem, start.zeros.size
    jumps = _sign_jumps(k, first_sign=start.first_sign)
    scale = np.concatenate((mesh.norms(start.horizon) + TINY, (span,)))
    inverse, target = 1.0 / scale, np.zeros(scale.size)
    target[-1] = 1.0
    differentiation = problem.differentiation * inverse * scale[:, np.newaxis]
    ends, weights = np.concatenate((start.zeros, (start.horizon,))), start.weights * scale / span
    best, least = None, np.inf
    for _ in range(NEWTON_STEPS):
        if not _largest(weights) < LARGEST_MULTIPLIER:
            break
        functions, integrals = problem.values_and_integrals(ends)
        functions *= inverse[:, np.newaxis]
        missed = integrals.dot(jumps) * inverse - target
        sigma, residual = weights.dot(functions[:, :k]), _largest(missed)
        if not np.isfinite(residual):
            break
        if residual < least:
            best, least = (ends, weights), residual
        size = abs(float(functions[-1, -1]))
        if residual <= CONVERGED and _largest(sigma) <= ON_ZERO * size:
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


AGREEMENT = 1e-11
"""Relative distance of time and bound at which the search ends: some digits above rounding."""
EXCHANGES = 4
"""Changes of structure in a row; one is usual next to the birth of an arc."""
WHOLE = 3
TOLERANCES = (5e-3, 1e-4, *(1e-6 / PARTS**k for k in range(9)))
"""Gaps of the starts, of which so many are on the first cells: with two modes five of six attempts
succeed from the first, the next ones show the structure where pairs of zeros are close; the last
one has cells of 1e-5 of the fastest period where σ is near zero (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attempt:
    """A feasible control, and the sign of its σ up to the time that this proves."""

    control: Control
    proved: Control
    mesh: Mesh  # That σ was looked at on

    @property
    def gap(self) -> float:
        """Relative distance of both times."""
        return abs(1.0 - self.proved.horizon / self.control.horizon)


def find_bang_bang(problem: MomentProblem, *, span: float) -> Attempt:
    """Return the time-optimal control as signs over the remaining time.

    Starts of rising accuracy are refined, the last ones on finer cells. An attempt is accepted when
    the bound that its multipliers prove equals the time that it takes.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if no attempt is feasible; how far the bound stays behind is left to the
        certificate.
    """
    cells = _start_force(problem, span=span, tolerance=TOLERANCES[0])
    best = attempt(cells.mesh, cells.control, span=span)
    for number, tolerance in enumerate(TOLERANCES[1:], start=1):
        if best and best.gap <= AGREEMENT:
            break
        cells = cells if number < WHOLE else _refine_cells(cells)
        cells = _improve(cells, span=span, tolerance=tolerance)
        best = _better(best, attempt(cells.mesh, cells.control, span=span))
    if best is None:
        detail = Message("no-control-reaches-rest", span=span, t_f=cells.horizon)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return best


def _better(one: Attempt | None, other: Attempt | None) -> Attempt | None:
    if one is None or other is None:
        return one or other
    return one if one.gap <= other.gap else other


def attempt(mesh: Mesh, start: Control, *, span: float) -> Attempt | None:
    """Return the stationary control next to another with what it proves, if there is a feasible.

    Where its multipliers show other zeros than it has, as next to the birth of an arc, those are
    the start of the next one.
    """
    best = None
    for _ in range(EXCHANGES):
        control = _refine_control(mesh, start, span=span)
        if control is None:
            break
        start = prove_time(mesh, control, span=span)
        best = _better(best, Attempt(control=control, proved=start, mesh=mesh))
        if start.zeros.size == control.zeros.size:
            break
    return best
