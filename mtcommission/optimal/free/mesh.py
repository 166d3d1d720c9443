"""The moment functions tabulated over the remaining time, fine where fast poles are still alive."""

from __future__ import annotations

from dataclasses import dataclass
from math import log1p

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.optimal.free.moments import MomentProblem

Array = NDArray[np.float64]

RADIANS_PER_CELL = 0.3
"""Length of a cell against the fastest pole at τ = 0 (empirical: fastest search; accuracy does
not depend on it)."""
MOST_CELLS = 1_000_000
"""Of a mesh: some seconds and 200 MB; reached where a mode rings undamped for 50 000 periods."""
LEAST_RADIANS = 17.0
"""What a mesh counts at least, spread evenly: 56 cells of a move that is shorter than the fastest
mode, and some where all modes have decayed but a cell-wise constant force must still switch
(empirical)."""
DENSITY_NODES = np.linspace(0.0, 1.0, 49)
"""Where the density of nodes is tabulated, in the logarithm of τ."""


def graded_nodes(problem: MomentProblem, horizon: float, *, radians: float) -> Array:
    """Return nodes on [0, horizon], the finer the faster the poles that are alive there [s].

    The cubic through values and slopes at the ends of a cell errs by e^{Re p τ} (|p| h)⁴ / 384, so
    h grows like e^{-Re p τ / 4} while the pole p is the fastest; ``radians`` is |p| h at τ = 0 for
    the fastest one.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG where they would be more than ``MOST_CELLS``.
    """
    magnitudes = problem.magnitudes
    fastest = max(magnitudes.tolist())
    tau = np.expm1(DENSITY_NODES * log1p(horizon * fastest)) / fastest
    tau[-1] = horizon
    decay = np.exp(np.multiply.outer(0.25 * problem.rates.real, tau))
    density = np.maximum.reduce(magnitudes[:, np.newaxis] * decay)
    np.maximum(density, LEAST_RADIANS / horizon, out=density)
    passed = np.zeros(tau.size)
    (0.5 * (density[1:] + density[:-1]) * (tau[1:] - tau[:-1])).cumsum(out=passed[1:])
    total = float(passed[-1])
    if not total < radians * MOST_CELLS:
        detail = Message("optimum-too-long", t_f=horizon, radians=total, most=radians * MOST_CELLS)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
    count = int(total / radians) + 1
    nodes = np.interp(np.arange(count + 1) * (total / count), passed, tau)
    nodes[-1] = horizon
    return np.asarray(nodes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh:
    """Moment functions tabulated on [0, horizon]."""

    problem: MomentProblem  # The moment problem
    nodes: Array  # τ from 0 to the horizon, shape (n_cells + 1,) [s]
    lengths: Array  # Of the cells, shape (n_cells,) [s]
    values: Array  # φ and, last, ψ at the nodes, shape (size + 1, n_cells + 1)
    remainder: Array  # max |d⁴/dτ⁴ e^{pτ}| h⁴/384 on each cell, shape (n_rates, n_cells)

    @property
    def horizon(self) -> float:
        """Last node [s]."""
        return float(self.nodes[-1])

    def norms(self, horizon: float) -> Array:
        """Return ∫_0^horizon |φ| as a sum, to scale moments by, shape (size,)."""
        inside = int(self.nodes[:-1].searchsorted(horizon))
        return np.asarray(np.abs(self.values[:-1, :inside]).dot(self.lengths[:inside]))


def build_mesh(
    problem: MomentProblem, horizon: float, *, radians: float = RADIANS_PER_CELL
) -> Mesh:
    """Return the tables on graded nodes."""
    return tabulate(problem, graded_nodes(problem, horizon, radians=radians))


def tabulate(problem: MomentProblem, nodes: Array) -> Mesh:
    """Return the tables on given nodes."""
    lengths = nodes[1:] - nodes[:-1]
    squared = np.multiply.outer(problem.magnitudes, lengths) ** 2
    envelope = np.exp(np.multiply.outer(problem.rates.real, nodes[:-1]))
    return Mesh(
        problem=problem,
        nodes=nodes,
        lengths=lengths,
        values=problem.values(nodes),
        remainder=envelope * squared * (squared / 384.0),
    )
