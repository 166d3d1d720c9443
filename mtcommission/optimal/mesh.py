"""The moment functions tabulated over the remaining time, fine where fast poles are still alive."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.moments import MomentProblem

Array = NDArray[np.float64]

DECAY = 41.0
"""e^-41 is below the unit roundoff: a mode is gone after DECAY times its time constant."""
RADIANS_PER_CELL = 0.4
"""Length of a cell against the fastest pole at τ = 0 (empirical: fastest search; accuracy does
not depend on it)."""
LEAST_CELLS = 56
"""Cells of a move that is shorter than the fastest mode (empirical)."""
DENSITY_NODES = np.linspace(0.0, 1.0, 49)
"""Where the density of nodes is tabulated, in the logarithm of τ."""
ROUNDOFF = float(np.finfo(np.float64).eps)


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


def uniform_pieces(
    problem: MomentProblem, horizon: float, *, radians: float
) -> tuple[UniformPiece, ...]:
    """Return pieces of equal cells that reach from 0 to the horizon, one more as each pole dies.

    Parameters
    ----------
    problem
        The moment problem.
    horizon
        End of the last piece [s].
    radians
        Largest |p| h on a cell, over the poles p that have not decayed [rad].

    Returns
    -------
    tuple of UniformPiece
    """
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


def graded_nodes(
    problem: MomentProblem, horizon: float, *, radians: float, least: int = 4
) -> Array:
    """Return nodes on [0, horizon] between which cubics err equally, the faster a pole the finer.

    The cubic through values and slopes at the ends of a cell errs by e^{Re p τ} (|p| h)⁴ / 384, so
    h grows like e^{-Re p τ / 4} while the pole p is the fastest.

    Parameters
    ----------
    problem
        The moment problem.
    horizon
        Last node [s].
    radians
        |p| h at τ = 0 for the fastest pole [rad].
    least
        Least number of cells.

    Returns
    -------
    ndarray, shape (n_nodes,)
    """
    magnitude = problem.magnitudes
    fastest = float(magnitude.max())
    tau = np.expm1(DENSITY_NODES * np.log1p(horizon * fastest)) / fastest
    density = (magnitude * np.exp(tau[:, np.newaxis] * (0.25 * problem.rates.real))).max(axis=1)
    wanted = np.zeros(tau.size)
    np.cumsum((density[1:] + density[:-1]) * (tau[1:] - tau[:-1]), out=wanted[1:])
    count = max(least, int(0.5 * wanted[-1] / radians) + 1)
    nodes = np.interp(np.arange(count + 1) * (wanted[-1] / count), wanted, tau)
    nodes[-1] = horizon
    return np.asarray(nodes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh:
    """Moment functions tabulated on [0, horizon].

    Parameters
    ----------
    problem
        The moment problem.
    nodes
        τ from 0 to the horizon, shape (n_cells + 1,) [s].
    lengths
        Of the cells, shape (n_cells,) [s].
    values, slopes
        φ and dφ/dτ at the nodes, shape (n_cells + 1, size).
    remainder
        max |d⁴/dτ⁴ e^{pτ}| h⁴/384 on each cell, shape (n_cells, n_rates).
    envelope
        max |e^{pτ}| on each cell, shape (n_cells, n_rates).
    """

    problem: MomentProblem
    nodes: Array
    lengths: Array
    values: Array
    slopes: Array
    remainder: Array
    envelope: Array

    @property
    def horizon(self) -> float:
        """Last node [s]."""
        return float(self.nodes[-1])


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
    nodes = graded_nodes(problem, horizon, radians=RADIANS_PER_CELL, least=LEAST_CELLS)
    return tabulate(problem, nodes)


def tabulate(problem: MomentProblem, nodes: Array) -> Mesh:
    """Return the tables on given nodes.

    Parameters
    ----------
    problem
        The moment problem.
    nodes
        Ascending from 0, shape (n_cells + 1,) [s].

    Returns
    -------
    Mesh
    """
    values, slopes = problem.values_and_slopes(nodes)
    lengths = nodes[1:] - nodes[:-1]
    envelope = np.exp(nodes[:-1, np.newaxis] * problem.rates.real)
    squared = (lengths[:, np.newaxis] * problem.magnitudes) ** 2
    return Mesh(
        problem=problem,
        nodes=nodes,
        lengths=lengths,
        values=values,
        slopes=slopes,
        remainder=envelope * squared * squared / 384.0,
        envelope=envelope,
    )
