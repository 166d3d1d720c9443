"""A start for the dual ascent: the same problem on a coarse mesh, a small linear program.

On nodes with weights w the dual is min_c Σ w |σ_c|; the horizon is moved until the minimum
equals the span.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.dual import MARGIN, DualPoint, evaluate_dual
from mtcommission.optimal.moments import MomentProblem
from mtcommission.optimal.switching import build_mesh, graded_nodes

Array = NDArray[np.float64]

LEAST_CELLS = 48
"""Cells where the whole move is shorter than the fastest mode (empirical)."""
INTERIOR_STEPS = 60
CENTRING = 0.1
BACK_OFF = 0.97
"""Usual settings of interior-point methods."""
HORIZON_STEPS = 30


@dataclass(frozen=True, slots=True, kw_only=True)
class Fineness:
    """How near to the optimum a start is sought.

    Parameters
    ----------
    radians
        Cells of the coarse mesh against the fastest live pole [rad].
    horizon_tolerance
        Relative distance of minimum and span.
    interior_tolerance
        Mean complementarity of the linear program against its start.
    """

    radians: float
    horizon_tolerance: float
    interior_tolerance: float


FINENESSES = (
    Fineness(radians=0.4, horizon_tolerance=0.03, interior_tolerance=1e-3),
    Fineness(radians=0.1, horizon_tolerance=1e-3, interior_tolerance=1e-5),
    Fineness(radians=0.02, horizon_tolerance=1e-5, interior_tolerance=1e-7),
)
"""The first serves 98 % of random machines; near births of several arcs the others are needed
(empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CoarseMinimum:
    """Minimum of Σ w |σ_c| at one horizon.

    Parameters
    ----------
    multipliers
        c, shape (size,).
    minimum
        Σ w |σ_c| [s] or [s²].
    end_value
        |σ_c| at the horizon, the slope of the minimum over the horizon.
    """

    multipliers: Array
    minimum: float
    end_value: float


def start_ascent(problem: MomentProblem, *, span: float, fineness: Fineness) -> DualPoint:
    """Return a dual point near the optimum.

    Parameters
    ----------
    problem
        The moment problem.
    span
        target / F_max [s] or [s²].
    fineness
        How near.

    Returns
    -------
    DualPoint
    """
    horizon = _guess_horizon(problem, span)
    low, high = 0.0, np.inf
    coarse = minimise_coarse(problem, horizon, fineness=fineness)
    for _ in range(HORIZON_STEPS):
        ratio = span / coarse.minimum
        if abs(ratio - 1.0) < fineness.horizon_tolerance:
            break
        low, high = (horizon, high) if ratio > 1.0 else (low, horizon)
        # The minimum grows like a power of the horizon, with this exponent here.
        exponent = max(horizon * coarse.end_value / coarse.minimum, 0.5)
        horizon *= float(np.clip(ratio ** (1.0 / exponent), 0.3, 3.0))
        if not low < horizon < high:
            horizon = 0.5 * (low + high)
        coarse = minimise_coarse(problem, horizon, fineness=fineness)
    mesh = build_mesh(problem, MARGIN * horizon)
    return evaluate_dual(mesh, coarse.multipliers, span=span)


def _guess_horizon(problem: MomentProblem, span: float) -> float:
    """Return where the distance in the mean square equals that of the span."""
    least = 2.0 * np.sqrt(span) if problem.degree else span
    longest = least + 1.5 * float(np.sum(2.0 * np.pi / np.abs(problem.rates)))
    horizons = np.geomspace(least, longest, 16)
    x = (np.arange(64) + 0.5) / 64
    best = least
    for horizon in horizons:
        tau = horizon * x
        phi = problem.values(tau)
        psi = problem.target_values(tau)
        scale = np.abs(phi).max(axis=0) + 1e-300
        orthonormal, _ = np.linalg.qr(phi / scale)
        distance = psi - orthonormal @ (orthonormal.T @ psi)
        if horizon * float(np.sqrt(np.mean(distance**2))) * 0.9 > span:
            break
        best = float(horizon)
    return best


def minimise_coarse(problem: MomentProblem, horizon: float, *, fineness: Fineness) -> CoarseMinimum:
    """Return the minimum of Σ w |σ_c| over the nodes of a coarse mesh.

    The linear program max Σ w ψ u, |u| <= 1, Σ w φ u = 0 by an interior-point method; its
    multipliers are c.

    Parameters
    ----------
    problem
        The moment problem.
    horizon
        [s].
    fineness
        Mesh and tolerance.

    Returns
    -------
    CoarseMinimum

    Source: Portnoy & Koenker 1997, the Frisch-Newton method for L1 regression.
    """
    nodes = graded_nodes(problem, horizon, radians=fineness.radians)
    if nodes.size <= LEAST_CELLS:
        nodes = np.linspace(0.0, horizon, LEAST_CELLS + 1)
    middle, weight = 0.5 * (nodes[1:] + nodes[:-1]), np.diff(nodes)
    phi, psi = problem.values(middle), problem.target_values(middle)
    scale = weight @ np.abs(phi) + 1e-300
    root = np.sqrt(weight)
    orthonormal, triangle = np.linalg.qr(phi / scale * root[:, np.newaxis])
    c = _l1_fit(
        orthonormal / root[:, np.newaxis], psi, weight, tolerance=fineness.interior_tolerance
    )
    multipliers = np.linalg.lstsq(triangle, c, rcond=None)[0] / scale
    end = np.array([horizon])
    end_value = (problem.target_values(end) - problem.values(end) @ multipliers)[0]
    return CoarseMinimum(
        multipliers=multipliers,
        minimum=float(weight @ np.abs(psi - phi @ multipliers)),
        end_value=abs(float(end_value)),
    )


def _l1_fit(basis: Array, psi: Array, weight: Array, *, tolerance: float) -> Array:
    """Return c that minimises Σ w |ψ - basis c|; basis orthonormal under the weights."""
    c = basis.T @ (weight * psi)
    u = np.zeros_like(psi)
    sigma = psi - basis @ c
    mean = float(weight @ np.abs(sigma)) / float(weight.sum()) + 1e-300
    above, below = np.maximum(sigma, 0.0) + mean, np.maximum(-sigma, 0.0) + mean
    for _ in range(INTERIOR_STEPS):
        room_above, room_below = 1.0 - u, 1.0 + u
        gap = float(weight @ (above * room_above + below * room_below)) / float(weight.sum())
        if gap < tolerance * mean:
            break
        centre = CENTRING * gap * 0.5
        stiffness = weight / (above / room_above + below / room_below)
        pull = sigma - centre / room_above + centre / room_below
        hessian = basis.T @ (basis * stiffness[:, np.newaxis])
        step = np.linalg.solve(hessian, basis.T @ (weight * u + stiffness * pull))
        change = -basis @ step
        du = stiffness / weight * (pull + change)
        d_above = (centre + above * du) / room_above - above
        d_below = (centre - below * du) / room_below - below
        primal = _longest(np.concatenate([-du / room_above, du / room_below]))
        dual = _longest(np.concatenate([d_above / above, d_below / below]))
        u = u + primal * du
        c, sigma = c + dual * step, sigma + dual * change
        above, below = above + dual * d_above, below + dual * d_below
    return np.asarray(c)


def _longest(relative: Array) -> float:
    """Return the step that keeps 1 + step * relative positive."""
    return min(1.0, BACK_OFF / max(float(-relative.min()), 1e-300))
