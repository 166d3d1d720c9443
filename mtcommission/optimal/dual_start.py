"""A start for the search: the best force that is constant on cells, by an interior-point method.

The end of the move floats: at every step it is where ∫|σ| reaches the span, so one run finds
multipliers and final time together. Where the result is not near enough to the optimum, cells in
which σ may change sign are divided, and the run goes on from where it was.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, log, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgeqrf, dgesv, dtrtri

from mtcommission.optimal.mesh import Mesh, build_mesh, tabulate
from mtcommission.optimal.moments import MomentProblem

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
"""Interior-point steps; some ten are usual."""
CENTRING = 0.2
"""Aim of a step, as a share of the mean complementarity (usual for such methods)."""
RECENTRING = 0.5
LONG_STEP = 0.3
"""The aim after a step shorter than this share of a full one (empirical)."""
BACK_OFF = 0.99
"""Longest step, as a share of the one that makes a force reach its limit (empirical)."""
FIRST_BARRIER = 0.25
"""Where the central path is entered, against the mean of |σ| (empirical: fewest steps)."""
SHRINKING = 0.9
"""Least horizon after a step against that before (empirical)."""
SIDES = np.array([[1.0], [-1.0]])
"""Two rows each: what is left to u = 1 and u = -1, and the parts of σ above and below 0."""
GUESS_NODES = 64
GUESS_TOLERANCE = 0.1
"""Error of the logarithm of the span (empirical)."""
GUESS_STEPS = 8
MEAN_TO_SQUARE = 0.9
"""Mean magnitude against root mean square of a sine."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CellForce:
    """A force that is constant on cells, on its way to the best one.

    Parameters
    ----------
    mesh
        Its cells are those of the force; reaches beyond the horizon.
    psi
        Means of ψ over the cells, shape (n_cells,).
    basis
        Means of combinations of φ that are orthonormal on the mesh, shape (n_cells, size).
    transform
        Multipliers = transform @ coefficients, shape (size, size).
    coefficients
        Of the basis in σ, shape (size,).
    force
        In units of F_max, shape (n_cells,).
    part
        Parts of σ above and below 0, both positive, their difference σ; shape (2, n_cells).
    horizon
        Where ∫|σ| reaches the span [s].
    """

    mesh: Mesh
    psi: Array
    basis: Array
    transform: Array
    coefficients: Array
    force: Array
    part: Array
    horizon: float

    @property
    def multipliers(self) -> Array:
        """Return c, shape (size,)."""
        return np.asarray(self.transform @ self.coefficients)


def start_force(problem: MomentProblem, *, span: float, tolerance: float) -> CellForce:
    """Return a force that is near the best one on cells of the first, coarse mesh.

    Parameters
    ----------
    problem
        The moment problem.
    span
        target / F_max [s] or [s²].
    tolerance
        Mean complementarity against the mean of |σ|.

    Returns
    -------
    CellForce
    """
    guess = guess_horizon(problem, span=span)
    for _ in range(REBUILDS):
        mesh = build_mesh(problem, MARGIN * guess)
        found = improve(_fit_squares(mesh, guess), span=span, tolerance=tolerance)
        if LEAST_SHARE * mesh.horizon < found.horizon < mesh.horizon:
            break
        guess = found.horizon
    return found


def refine_cells(coarse: CellForce) -> CellForce:
    """Return the force on divided cells, where σ may change sign.

    Parameters
    ----------
    coarse
        The force so far; its σ is off by about the curvature of σ over a cell.

    Returns
    -------
    CellForce
        Not improved yet.
    """
    mesh, c = coarse.mesh, coarse.multipliers
    sigma = mesh.problem.target_values(mesh.nodes) - mesh.values @ c
    bend = mesh.envelope * (mesh.problem.magnitudes * mesh.lengths[:, np.newaxis]) ** 2
    low = np.minimum(np.abs(sigma[:-1]), np.abs(sigma[1:]))
    divided = (low <= bend @ mesh.problem.amplitudes(c)) | (sigma[:-1] * sigma[1:] <= 0.0)
    parts = np.where(divided, PARTS, 1)
    index = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    starts = np.repeat(mesh.nodes[:-1], parts) + index * np.repeat(mesh.lengths / parts, parts)
    fine = tabulate(mesh.problem, np.append(starts, mesh.nodes[-1]))
    phi, psi = _means(fine)
    basis = phi @ coarse.transform
    force, part = _central(fine, psi - basis @ coarse.coefficients, coarse.horizon)
    return replace(coarse, mesh=fine, psi=psi, basis=basis, force=force, part=part)


def guess_horizon(problem: MomentProblem, *, span: float) -> float:
    """Return where the distance of ψ from the φ in the mean square is that of the span [s].

    Parameters
    ----------
    problem
        The moment problem.
    span
        target / F_max [s] or [s²].

    Returns
    -------
    float
        Mostly within a tenth of the final time.
    """
    least = 2.0 * sqrt(span) if problem.degree else span
    longest = least + 1.5 * float(np.sum(2.0 * np.pi / problem.magnitudes))
    low, high = log(least), log(longest)
    x = (np.arange(GUESS_NODES) + 0.5) / GUESS_NODES
    columns = np.empty((GUESS_NODES, problem.size + 1), order="F")
    guess, known = 0.5 * (low + high), [False, False]
    error = [0.0, 0.0]
    for _ in range(GUESS_STEPS):
        tau = exp(guess) * x
        columns[:, :-1] = problem.values(tau)
        columns[:, -1] = problem.target_values(tau)
        triangle = dgeqrf(columns)[0]
        distance = abs(float(triangle[problem.size, -1])) * exp(guess) / sqrt(GUESS_NODES)
        now = log(max(MEAN_TO_SQUARE * distance, 1e-300) / span)
        side = now > 0.0
        known[side], error[side] = True, now
        low, high = (low, guess) if side else (guess, high)
        if abs(now) < GUESS_TOLERANCE or high - low < 0.5 * GUESS_TOLERANCE:
            break
        share = error[0] / (error[0] - error[1]) if all(known) else 0.5
        guess = low + min(max(share, 0.05), 0.95) * (high - low)
    return exp(guess)


def _means(mesh: Mesh) -> tuple[Array, Array]:
    """Return the means of φ and ψ over the cells; those of φ by Hermite's rule."""
    values, slopes, nodes = mesh.values, mesh.slopes, mesh.nodes
    bent = (slopes[:-1] - slopes[1:]) * (mesh.lengths / 12.0)[:, np.newaxis]
    phi = 0.5 * (values[:-1] + values[1:]) + bent
    return phi, mesh.problem.target_values(0.5 * (nodes[:-1] + nodes[1:]))


def _fit_squares(mesh: Mesh, horizon: float) -> CellForce:
    """Return the force that follows σ of the fit in the mean square up to the horizon."""
    phi, psi = _means(mesh)
    scale = np.abs(phi).max(axis=0) + 1e-300
    root = np.sqrt(mesh.lengths)[:, np.newaxis]
    reflectors = dgeqrf(phi * (root / scale))[0]
    transform = np.triu(dtrtri(reflectors[: mesh.problem.size])[0])
    transform /= scale[:, np.newaxis]
    basis = phi @ transform
    weighted = basis.T * _weights(mesh, horizon)
    coefficients = dgesv(weighted @ basis, weighted @ psi)[2]
    force, part = _central(mesh, psi - basis @ coefficients, horizon)
    return CellForce(
        mesh=mesh,
        psi=psi,
        basis=basis,
        transform=transform,
        coefficients=coefficients,
        force=force,
        part=part,
        horizon=horizon,
    )


def _weights(mesh: Mesh, horizon: float) -> Array:
    """Return the lengths of the cells as far as they are before the horizon."""
    return np.minimum(np.maximum(horizon - mesh.nodes[:-1], 0.0), mesh.lengths)


def _central(mesh: Mesh, sigma: Array, horizon: float) -> tuple[Array, Array]:
    """Return force and parts of σ on the central path, near its beginning."""
    mean = float(_weights(mesh, horizon) @ np.abs(sigma)) / horizon
    barrier = FIRST_BARRIER * mean + 1e-300
    root = np.sqrt(barrier * barrier + sigma * sigma) + barrier
    return sigma / root, 0.5 * (root + SIDES * sigma)


def improve(begun: CellForce, *, span: float, tolerance: float) -> CellForce:
    """Return the force after enough steps along the central path.

    Parameters
    ----------
    begun
        Any force within the limits.
    span
        target / F_max [s] or [s²].
    tolerance
        Mean complementarity against the mean of |σ| at which to stop.

    Returns
    -------
    CellForce

    Source: Portnoy & Koenker 1997, the interior-point method for L1 regression; with a
    floating end.
    """
    nodes, lengths, basis = begun.mesh.nodes, begun.mesh.lengths, begun.basis
    c, part, room = begun.coefficients, begun.part.copy(), 1.0 - SIDES * begun.force
    sigma, across = begun.psi - basis @ c, np.ascontiguousarray(basis.T)
    horizon, proved, share = begun.horizon, 0.0, 1.0
    for _ in range(STEPS):
        reached = (lengths * np.abs(sigma)).cumsum()
        # Any c proves its time; one that is far from the best may prove next to nothing.
        proved = max(proved, _crossing(nodes, reached, span))
        horizon = max(proved, SHRINKING * horizon)
        k = int(nodes.searchsorted(horizon))
        weight = lengths[:k].copy()
        weight[-1] = horizon - nodes[k - 1]
        left, half = room[:, :k], part[:, :k]
        product = left * half
        gap = sum((product @ weight).tolist())
        if gap < tolerance * min(span, float(reached[k - 1])):
            break
        aim = CENTRING if share > LONG_STEP else RECENTRING
        relative = (0.5 * aim * gap / horizon) / product
        ratio, barrier = half / left, relative * half
        stiffness = 1.0 / (ratio[0] + ratio[1])
        pull = sigma[:k] - barrier[0] + barrier[1]
        pressed = weight * stiffness
        hessian = (across[:, :k] * pressed) @ basis[:k]
        right = across[:, :k] @ (weight * (left[1] - 1.0) + pressed * pull)
        _, _, step, info = dgesv(hessian, right)
        if info:
            break
        change = basis @ step
        spent = (stiffness * (pull - change[:k])) * SIDES
        used = spent / left
        lost = 1.0 - used - relative
        primal, dual = _longest(used), _longest(lost)
        share = min(primal, dual)
        left -= primal * spent
        half *= 1.0 - dual * lost
        c, sigma = c + dual * step, sigma - dual * change
    return replace(begun, coefficients=c, force=room[1] - 1.0, part=part, horizon=horizon)


def _crossing(nodes: Array, reached: Array, span: float) -> float:
    """Return where a sum over cells reaches the span, the last node where it does not."""
    i = int(reached.searchsorted(span))
    if i == reached.size:
        return float(nodes[-1])
    before = float(reached[i - 1]) if i else 0.0
    start, end = float(nodes[i]), float(nodes[i + 1])
    return start + (end - start) * (span - before) / (float(reached[i]) - before)


def _longest(used: Array) -> float:
    """Return the step that leaves some of everything, at most 1."""
    return min(1.0, BACK_OFF / max(float(used.max()), 1e-300))
