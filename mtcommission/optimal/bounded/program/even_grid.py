"""An even grid of cells of constant force: what they do, as linear maps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz

from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.closed_form import step_response

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CellGrid:
    """Terminal state and levels as linear maps of the cells' relative forces."""

    # From the forces to the fixed states at the end, rows scaled, shape (n_fixed, n_cells).
    moments: Array
    target: Array  # Those states, scaled alike, shape (n_fixed,)
    # From the forces to c x at the ends of the cells, limit by limit, shape (n_limits
    # n_cells, n_cells).
    response: Array


def cell_grid(problem: BoundedProblem, t_f: float, *, cells: int) -> CellGrid:
    """Return the linear maps of an even grid."""
    F = problem.force_limit
    edges = np.linspace(0.0, t_f, cells + 1)
    final = step_response(problem.plant, t_f - edges)[:, problem.fixed] * F
    moments = (final[:-1] - final[1:]).T
    scale = 1.0 / np.maximum(np.abs(moments).sum(axis=1), np.abs(problem.target[problem.fixed]))
    steps = step_response(problem.plant, edges) @ problem.rows.T * F
    return CellGrid(
        moments=moments * scale[:, np.newaxis],
        target=problem.target[problem.fixed] * scale,
        response=np.vstack([toeplitz(column, np.zeros(cells)) for column in np.diff(steps.T)]),
    )
