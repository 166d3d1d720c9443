"""A start for the search: the best force that is constant on cells, by a primal-dual method.

The end of the move floats: at every step it is where ∫|σ| reaches the span, so one run finds
multipliers and final time together. Where the result is not near enough to the optimum, cells in
which σ may change sign are divided, and the run goes on from where it was.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgeqrf, dgesv

from mtcommission.optimal.free.mesh import Mesh, build_mesh, tabulate
from mtcommission.optimal.free.moments import TINY, MomentProblem
from mtcommission.optimal.free.switching import ROUNDOFF, Control

Array = NDArray[np.float64]

MARGIN = 1.3
"""Length of the mesh against the guessed final time (empirical)."""
REBUILDS = 8
"""Meshes tried; one is usual."""
LEAST_SHARE = 0.6
"""Final time against the mesh below which the mesh is too coarse (empirical)."""
PARTS = 4
"""Cells into which one is divided."""
STEPS = 100
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
class CellForce:
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


def start_force(problem: MomentProblem, *, span: float, tolerance: float) -> CellForce:
    """Return a force that is near the best one on cells of the first, coarse mesh."""
    guess = guess_horizon(problem, span=span)
    for _ in range(REBUILDS):
        mesh = build_mesh(problem, MARGIN * guess)
        found = improve(_fit_squares(mesh, guess), span=span, tolerance=tolerance)
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


def improve(begun: CellForce, *, span: float, tolerance: float) -> CellForce:
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
    for _ in range(STEPS):
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


def refine_cells(coarse: CellForce) -> CellForce:
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


def _fit_squares(mesh: Mesh, horizon: float) -> CellForce:
    """Return the force that follows σ of the fit in the mean square up to the horizon."""
    means = _means(mesh)
    size, weight = mesh.problem.size, _weights(mesh, horizon)
    reflectors = dgeqrf((means * np.sqrt(weight)).T, overwrite_a=1)[0]
    triangle, coefficients = np.triu(reflectors[:size, :size]), reflectors[:size, size]
    # No triangular solver: BLAS would set up threads for it, which take longer than all the rest.
    inverse = dgesv(triangle, np.eye(size))[2]
    psi, basis = means[-1], inverse.T.dot(means[:-1])
    return CellForce(
        mesh=mesh,
        psi=psi,
        basis=basis,
        inverse=inverse,
        coefficients=coefficients,
        force=_smooth_sign(psi - coefficients.dot(basis), mesh, horizon),
        horizon=horizon,
    )


def _weights(mesh: Mesh, horizon: float) -> Array:
    """Return the lengths of the cells as far as they are before the horizon."""
    inside = np.minimum(mesh.nodes, horizon)
    return np.asarray(inside[1:] - inside[:-1])


def _smooth_sign(sigma: Array, mesh: Mesh, horizon: float) -> Array:
    mean = float(_weights(mesh, horizon) @ np.abs(sigma)) / horizon
    return np.asarray(sigma / (np.hypot(sigma, FIRST_SMOOTHING * mean) + TINY))
