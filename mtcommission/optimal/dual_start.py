"""A start for the dual ascent: forces that are constant on cells, a small linear program.

With the exact moments of each cell the program is the original problem for fewer forces. Its
multipliers are near those of the optimum; where that is not near enough, cells in which σ may
change sign are divided, and no others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.moments import MomentProblem
from mtcommission.optimal.switching import graded_nodes

Array = NDArray[np.float64]

RADIANS_PER_CELL = 0.4
"""First cells against the fastest live pole (empirical)."""
LEAST_CELLS = 48
"""Cells where the whole move is shorter than the fastest mode (empirical)."""
PARTS = 4
"""Cells into which one is divided."""
INTERIOR_STEPS = 60
INTERIOR_TOLERANCE = 1e-3
"""Mean complementarity at which the first program is solved; a refinement squares the cells'
share of it (empirical)."""
CENTRING = 0.1
BACK_OFF = 0.97
"""Usual settings of interior-point methods."""
HORIZON_STEPS = 30
HORIZON_TOLERANCE = 0.2
"""Error of the horizon against the shorter of horizon and fastest period (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CellSolution:
    """The best force that is constant on cells, at the horizon where it reaches the target.

    Parameters
    ----------
    nodes
        Ends of the cells, from 0 to the horizon, shape (n_cells + 1,) [s].
    multipliers
        c of the program, shape (size,).
    minimum
        Σ |∫_cell σ_c| [s] or [s²].
    end_value
        |σ_c| at the horizon, the slope of the minimum over the horizon.
    level
        Number of refinements.
    """

    nodes: Array
    multipliers: Array
    minimum: float
    end_value: float
    level: int

    @property
    def horizon(self) -> float:
        """Last node [s]."""
        return float(self.nodes[-1])


def first_cells(problem: MomentProblem, *, span: float) -> CellSolution:
    """Return the solution on the first, coarse cells.

    Parameters
    ----------
    problem
        The moment problem.
    span
        target / F_max [s] or [s²].

    Returns
    -------
    CellSolution
    """
    horizon = _guess_horizon(problem, span)
    return _fit_horizon(problem, _coarse_nodes(problem, horizon), span=span, level=0)


def refine_cells(problem: MomentProblem, coarse: CellSolution, *, span: float) -> CellSolution:
    """Return the solution after dividing the cells in which σ may change sign.

    Parameters
    ----------
    problem
        The moment problem.
    coarse
        The solution so far; its σ is off by about the curvature of σ over a cell.
    span
        target / F_max [s] or [s²].

    Returns
    -------
    CellSolution
    """
    nodes, length = coarse.nodes, np.diff(coarse.nodes)
    sigma = problem.target_values(nodes) - problem.values(nodes) @ coarse.multipliers
    start = nodes[:-1, np.newaxis]
    bend = np.exp(start * problem.rates.real) * (np.abs(problem.rates) * length[:, np.newaxis]) ** 2
    doubt = bend @ problem.amplitudes(coarse.multipliers)
    low = np.minimum(np.abs(sigma[:-1]), np.abs(sigma[1:]))
    divided = (low <= doubt) | (sigma[:-1] * sigma[1:] <= 0.0)
    parts = np.where(divided, PARTS, 1)
    index = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    cells = np.repeat(nodes[:-1], parts) + index * np.repeat(length / parts, parts)
    return _fit_horizon(problem, np.append(cells, nodes[-1]), span=span, level=coarse.level + 1)


def _coarse_nodes(problem: MomentProblem, horizon: float) -> Array:
    nodes = graded_nodes(problem, horizon, radians=RADIANS_PER_CELL)
    return nodes if nodes.size > LEAST_CELLS else np.linspace(0.0, horizon, LEAST_CELLS + 1)


def _fit_horizon(problem: MomentProblem, nodes: Array, *, span: float, level: int) -> CellSolution:
    """Return the solution on the nodes, cut or continued until its minimum equals the span."""
    fastest = 2.0 * np.pi / float(np.max(np.abs(problem.rates)))
    low, high = 0.0, np.inf
    cells = _solve_cells(problem, nodes, level=level)
    for _ in range(HORIZON_STEPS):
        horizon, ratio = cells.horizon, span / cells.minimum
        error = abs(span - cells.minimum) / max(cells.end_value, cells.minimum / horizon)
        if error <= HORIZON_TOLERANCE * PARTS**-level * min(horizon, fastest):
            break
        low, high = (horizon, high) if ratio > 1.0 else (low, horizon)
        # The minimum grows like a power of the horizon, with this exponent here.
        exponent = max(horizon * cells.end_value / cells.minimum, 0.5)
        wanted = horizon * float(np.clip(ratio ** (1.0 / exponent), 0.3, 3.0))
        if not low < wanted < high:
            wanted = 0.5 * (low + high)
        cells = _solve_cells(problem, _resize(problem, cells.nodes, wanted), level=level)
    return cells


def _resize(problem: MomentProblem, nodes: Array, horizon: float) -> Array:
    if nodes.size <= LEAST_CELLS + 1:
        return _coarse_nodes(problem, horizon)
    kept = nodes[nodes < horizon * (1.0 - 1e-9)]
    if horizon <= nodes[-1]:
        return np.append(kept, horizon)
    fresh = _coarse_nodes(problem, horizon)
    return np.append(kept, fresh[fresh > kept[-1] * (1.0 + 1e-9)])


def _guess_horizon(problem: MomentProblem, span: float) -> float:
    """Return where the distance in the mean square equals that of the span."""
    least = 2.0 * np.sqrt(span) if problem.degree else span
    longest = least + 1.5 * float(np.sum(2.0 * np.pi / np.abs(problem.rates)))
    x = (np.arange(64) + 0.5) / 64
    horizons = np.geomspace(least, longest, 17)
    low, high = 0, 16
    while high - low > 1:
        middle = (low + high) // 2
        horizon = float(horizons[middle])
        phi, psi = problem.values(horizon * x), problem.target_values(horizon * x)
        orthonormal, _ = np.linalg.qr(phi / (np.abs(phi).max(axis=0) + 1e-300))
        distance = psi - orthonormal @ (orthonormal.T @ psi)
        # 0.9: mean magnitude against root mean square of a sine.
        reached = horizon * float(np.sqrt(np.mean(distance**2))) * 0.9
        low, high = (low, middle) if reached > span else (middle, high)
    return float(horizons[low])


def _solve_cells(problem: MomentProblem, nodes: Array, *, level: int) -> CellSolution:
    """Return the multipliers of max Σ ∫_cell ψ u, |u| <= 1, Σ u ∫_cell φ = 0."""
    length = np.diff(nodes)
    phi = np.diff(problem.integrals(nodes), axis=0) / length[:, np.newaxis]
    psi = np.diff(problem.target_integrals(nodes)) / length
    scale = length @ np.abs(phi) + 1e-300
    root = np.sqrt(length)
    orthonormal, triangle = np.linalg.qr(phi / scale * root[:, np.newaxis])
    tolerance = INTERIOR_TOLERANCE * float(PARTS) ** (-2 * level)
    c = _l1_fit(orthonormal / root[:, np.newaxis], psi, length, tolerance=tolerance)
    multipliers = np.linalg.lstsq(triangle, c, rcond=None)[0] / scale
    end = nodes[-1:]
    end_value = (problem.target_values(end) - problem.values(end) @ multipliers)[0]
    return CellSolution(
        nodes=nodes,
        multipliers=multipliers,
        minimum=float(length @ np.abs(psi - phi @ multipliers)),
        end_value=abs(float(end_value)),
        level=level,
    )


def _l1_fit(basis: Array, psi: Array, weight: Array, *, tolerance: float) -> Array:
    """Return c that minimises Σ w |ψ - basis c|; basis orthonormal under the weights.

    Source: Portnoy & Koenker 1997, the interior-point method for L1 regression.
    """
    c = basis.T @ (weight * psi)
    sigma = psi - basis @ c
    total = float(weight.sum())
    mean = float(weight @ np.abs(sigma)) / total + 1e-300
    # Two rows each: what is left to u = 1 and u = -1, and the parts of σ above and below 0.
    side = np.array([[1.0], [-1.0]])
    room = np.ones((2, psi.size))
    part = np.maximum(side * sigma, 0.0) + mean
    u = np.zeros_like(psi)
    for _ in range(INTERIOR_STEPS):
        gap = float((part * room).sum(axis=0) @ weight) / total
        if gap < tolerance * mean:
            break
        ratio = part / room
        barrier = 0.5 * CENTRING * gap / room
        stiffness = weight / (ratio[0] + ratio[1])
        pull = sigma - barrier[0] + barrier[1]
        hessian = basis.T @ (basis * stiffness[:, np.newaxis])
        step = np.linalg.solve(hessian, basis.T @ (weight * u + stiffness * pull))
        change = basis @ step
        du = stiffness / weight * (pull - change)
        d_room = -side * du
        d_part = barrier - ratio * d_room - part
        primal, dual = _longest(d_room / room), _longest(d_part / part)
        u += primal * du
        room += primal * d_room
        c += dual * step
        sigma -= dual * change
        part += dual * d_part
    return np.asarray(c)


def _longest(relative: Array) -> float:
    """Return the step that keeps 1 + step * relative positive."""
    return min(1.0, BACK_OFF / max(-float(relative.min()), 1e-300))
