"""The moment functions tabulated over the remaining time, fine where fast poles are still alive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.moments import MomentProblem

Array = NDArray[np.float64]

RADIANS_PER_CELL = 0.4
"""Length of a cell against the fastest pole at τ = 0 (empirical: fastest search; accuracy does
not depend on it)."""
LEAST_CELLS = 56
"""Cells of a move that is shorter than the fastest mode (empirical)."""
DENSITY_NODES = np.linspace(0.0, 1.0, 49)
"""Where the density of nodes is tabulated, in the logarithm of τ."""
ROUNDOFF = float(np.finfo(np.float64).eps)


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
