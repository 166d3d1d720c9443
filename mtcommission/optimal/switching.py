"""The switching function σ = ψ - Σ c_i φ_i: all its zeros, and exact integrals between them.

No zero may be missed, since every proof rests on them: an interval is settled only when a
rigorous error bound of the cubic that interpolates σ and σ' at its ends shows that σ has no
zero, or that σ is monotone there; else it is halved.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.moments import MomentProblem

Array = NDArray[np.float64]

DECAY = 41.0
"""e^-41 is below the unit roundoff: a mode is gone after DECAY times its time constant."""
RADIANS_PER_CELL = 0.5
"""First mesh against the fastest live pole (empirical: fastest search; accuracy does not depend
on it)."""
MAX_HALVINGS = 60
"""More than the bits of double precision: the search has always ended before."""
ROUNDOFF = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh:
    """Moment functions tabulated on [0, horizon], fine where fast poles are still alive.

    Parameters
    ----------
    problem
        The moment problem.
    nodes
        τ from 0 to the horizon, shape (n_cells + 1,) [s].
    values, slopes
        φ and dφ/dτ at the nodes, shape (n_cells + 1, size).
    remainder
        max |d⁴/dτ⁴ e^{pτ}| h⁴/384 on each cell, shape (n_cells, n_rates).
    rounding
        Bound of the rounding error of e^{pτ} on each cell, shape (n_cells, n_rates).
    """

    problem: MomentProblem
    nodes: Array
    values: Array
    slopes: Array
    remainder: Array
    rounding: Array

    @property
    def horizon(self) -> float:
        """Last node [s]."""
        return float(self.nodes[-1])


@dataclass(frozen=True, slots=True, kw_only=True)
class UniformPiece:
    """Equal cells one after the other.

    Parameters
    ----------
    start
        First node [s].
    step
        Length of a cell [s].
    count
        Number of cells.
    """

    start: float
    step: float
    count: int


def graded_nodes(problem: MomentProblem, horizon: float, *, radians: float) -> Array:
    """Return nodes on [0, horizon] whose spacing follows the fastest pole still alive.

    Parameters
    ----------
    problem
        The moment problem.
    horizon
        Last node [s].
    radians
        Largest |p| h on a cell, over the poles p that have not decayed [rad].

    Returns
    -------
    ndarray, shape (n_nodes,)
    """
    pieces = graded_pieces(problem, horizon, radians=radians)
    nodes = [piece.start + piece.step * np.arange(piece.count) for piece in pieces]
    return np.concatenate([*nodes, [horizon]])


def graded_pieces(
    problem: MomentProblem, horizon: float, *, radians: float
) -> tuple[UniformPiece, ...]:
    """Return the pieces of ``graded_nodes``, each with equal cells."""
    magnitude = np.abs(problem.rates)
    with np.errstate(divide="ignore"):
        life = np.minimum(DECAY / np.abs(problem.rates.real), horizon)
    edges = [0.0, *sorted({float(end) for end in life if end < horizon}), horizon]
    pieces = []
    for start, end in pairwise(edges):
        alive = magnitude[life > start]
        fastest = float(alive.max()) if alive.size else 0.0
        count = max(4, int(np.ceil((end - start) * fastest / radians)))
        pieces.append(UniformPiece(start=start, step=(end - start) / count, count=count))
    return tuple(pieces)


def build_mesh(problem: MomentProblem, horizon: float) -> Mesh:
    """Return the tables that the search for zeros starts from.

    Parameters
    ----------
    problem
        The moment problem.
    horizon
        Where the search ends [s].

    Returns
    -------
    Mesh
    """
    nodes = graded_nodes(problem, horizon, radians=RADIANS_PER_CELL)
    values, slopes = problem.values_and_slopes(nodes)
    start, length = nodes[:-1, np.newaxis], np.diff(nodes)[:, np.newaxis]
    magnitude = np.abs(problem.rates)
    envelope = np.exp(start * problem.rates.real)
    return Mesh(
        problem=problem,
        nodes=nodes,
        values=values,
        slopes=slopes,
        remainder=envelope * (magnitude * length) ** 4 / 384.0,
        rounding=envelope * (8.0 + 2.0 * magnitude * (start + length)) * ROUNDOFF,
    )


def rounding_bound(mesh: Mesh, multipliers: Array) -> Array:
    """Return a bound of the rounding error of σ on each cell, shape (n_cells,).

    Covers the products p τ inside the exponentials, the exponentials and the sum.
    """
    problem = mesh.problem
    polynomial = abs(problem.constant(multipliers)) + problem.target_values(mesh.nodes[1:])
    modal = mesh.rounding @ problem.amplitudes(multipliers)
    return np.asarray(modal + 8.0 * ROUNDOFF * polynomial)


def values_and_slopes(
    problem: MomentProblem, multipliers: Array, tau: Array
) -> tuple[Array, Array, Array]:
    """Return σ, dσ/dτ and φ at remaining times τ; shapes (k,), (k,), (k, size)."""
    phi, slope = problem.values_and_slopes(tau)
    sigma = problem.target_values(tau) - phi @ multipliers
    return sigma, problem.degree - slope @ multipliers, phi


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Zeros:
    """All sign changes of a switching function.

    Parameters
    ----------
    tau
        Ascending, shape (n_zeros,) [s].
    doubt
        ∫|σ| over the places where |σ| stays below its rounding error, so that pairs of zeros
        there may have been left out, at most [s] or [s²].
    """

    tau: Array
    doubt: float


def isolate_zeros(mesh: Mesh, multipliers: Array) -> Zeros:
    """Return all sign changes of σ on [0, horizon].

    Parameters
    ----------
    mesh
        Tables on [0, horizon].
    multipliers
        c, shape (size,).

    Returns
    -------
    Zeros

    Source: Bernstein form of the cubic Hermite interpolant with remainder |σ⁗| h⁴/384 (its
    slope: √3 |σ⁗| h³/216); docs/optimal-control.md, section 3.
    """
    cells = _first_cells(mesh, multipliers)
    found, doubt = [], 0.0
    for _ in range(MAX_HALVINGS):
        cells = cells[:, _may_vanish(cells)]
        if not cells.shape[1]:
            break
        monotone = _is_monotone(cells)
        noise = _is_noise(cells) & ~monotone
        settled = monotone | noise
        doubt += float(4.0 * cells[1, noise] @ cells[7, noise])
        found.append(cells[:, settled & ((cells[2] > 0.0) != (cells[3] > 0.0))])
        cells = _halve(mesh.problem, multipliers, cells[:, ~settled])
    if not found:
        return Zeros(tau=np.empty(0), doubt=doubt)
    tau = np.sort(_refine(mesh.problem, multipliers, np.concatenate(found, axis=1)))
    return Zeros(tau=tau[tau > 0.0], doubt=doubt)


def _first_cells(mesh: Mesh, multipliers: Array) -> Array:
    # Rows: start, length, σ at both ends, length·σ' at both ends, remainder, rounding.
    problem = mesh.problem
    sigma = problem.target_values(mesh.nodes) - mesh.values @ multipliers
    slope = problem.degree - mesh.slopes @ multipliers
    length = np.diff(mesh.nodes)
    return np.array(
        [
            mesh.nodes[:-1],
            length,
            sigma[:-1],
            sigma[1:],
            slope[:-1] * length,
            slope[1:] * length,
            mesh.remainder @ problem.amplitudes(multipliers),
            rounding_bound(mesh, multipliers),
        ]
    )


def _may_vanish(cells: Array) -> NDArray[np.bool_]:
    _, _, left, right, left_slope, right_slope, remainder, _ = cells
    control = np.array([left, left + left_slope / 3.0, right - right_slope / 3.0, right])
    return np.asarray((control.min(axis=0) <= remainder) & (control.max(axis=0) >= -remainder))


def _is_monotone(cells: Array) -> NDArray[np.bool_]:
    _, _, left, right, left_slope, right_slope, remainder, _ = cells
    control = np.array([left_slope, 3.0 * (right - left) - left_slope - right_slope, right_slope])
    error = 384.0 * np.sqrt(3.0) / 216.0 * remainder
    return np.asarray((control.min(axis=0) > error) | (control.max(axis=0) < -error))


def _is_noise(cells: Array) -> NDArray[np.bool_]:
    _, _, left, right, left_slope, right_slope, remainder, rounding = cells
    reach = np.maximum(np.abs(left), np.abs(right))
    reach += np.abs(left_slope) + np.abs(right_slope) + remainder
    return np.asarray(reach <= 4.0 * rounding)


def _halve(problem: MomentProblem, multipliers: Array, cells: Array) -> Array:
    start, length, left, right, left_slope, right_slope, remainder, rounding = cells
    half = 0.5 * length
    middle = start + half
    sigma, slope, _ = values_and_slopes(problem, multipliers, middle)
    slope = slope * half
    first = np.array(
        [start, half, left, sigma, 0.5 * left_slope, slope, remainder / 16.0, rounding]
    )
    second = np.array(
        [middle, half, sigma, right, slope, 0.5 * right_slope, remainder / 16.0, rounding]
    )
    return np.concatenate([first, second], axis=1)


def _refine(problem: MomentProblem, multipliers: Array, brackets: Array) -> Array:
    start, length, left, right, left_slope, right_slope, _, _ = brackets
    quadratic = 3.0 * (right - left) - 2.0 * left_slope - right_slope
    cubic = left_slope + right_slope - 2.0 * (right - left)
    x = left / (left - right)
    for _ in range(3):
        value = left + x * (left_slope + x * (quadratic + x * cubic))
        slope = left_slope + x * (2.0 * quadratic + 3.0 * x * cubic)
        x = np.clip(x - _quotient(value, slope), 0.0, 1.0)
    tau = start + x * length
    for _ in range(3):
        sigma, slope, _ = values_and_slopes(problem, multipliers, tau)
        tau = np.clip(tau - _quotient(sigma, slope), start, start + length)
    return np.asarray(tau)


def _quotient(value: Array, slope: Array) -> Array:
    # A vanishing slope means a bracket at rounding level: stay where we are.
    return np.divide(value, slope, out=np.zeros_like(value), where=slope != 0.0)
