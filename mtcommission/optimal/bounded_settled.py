"""The equations of a mesh control, closed to rounding instead of to a solver's tolerance.

What the simplex method leaves open is tiny, but the smallest change of the forces that closes it
may lift the motion over a bound by 1e-5. So of all changes the one is taken that disturbs the
points where a bound acts least.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from mtcommission.optimal.bounded_mesh import MeshOptimum
from mtcommission.optimal.bounded_problem import BoundedProblem
from mtcommission.optimal.bounded_rows import (
    LOOSE,
    bound_rows,
    entry_rows,
    terminal_rows,
    terminal_scale,
)

Array = NDArray[np.float64]

ACTIVE = 1e-4
"""Room at a point below which it is kept where it is."""

SOFT = 1e-6
"""Disturbance of a bound that weighs as much as the change of a force by all of its room."""


def settled(problem: BoundedProblem, found: MeshOptimum, *, miss: Array) -> MeshOptimum:
    """Return the solution with its equations fulfilled to rounding, not to a solver's tolerance.

    Parameters
    ----------
    problem
        The bounded problem.
    found
        Solution of the kept form.
    miss
        Terminal error of its motion as it was followed, to be taken back, shape (n_fixed,).

    Returns
    -------
    MeshOptimum
        Only the forces of cells within the force limit are changed, so that the points where a
        bound acts stay where they are as far as possible.
    """
    equal, right = terminal_rows(problem, found.segments)
    held, levels = entry_rows(problem, found.layout, found.segments)
    taken = right - terminal_scale(problem, found.segments) * miss * found.reach
    rows, rest = np.vstack([equal, held]), np.append(taken, levels)
    bounded, rooms = bound_rows(problem, found.layout, found.segments)
    unknowns = np.append(found.unknowns, found.reach)
    acts = rooms - bounded @ unknowns < ACTIVE
    room = 1.0 - np.abs(found.unknowns)
    free = np.nonzero(room > LOOSE)[0]
    # Of all corrections that disturb the points where a bound acts by little, the smallest.
    soft = np.vstack([bounded[acts][:, free], np.diag(SOFT / room[free])])
    for _ in range(2):
        error = rest - rows @ unknowns
        sizes = np.linalg.norm(rows[:, free], axis=1) + 1e-300
        unknowns[free] += _least_disturbing(rows[:, free] / sizes[:, None], error / sizes, soft)
    return replace(found, unknowns=unknowns[:-1])


def _least_disturbing(rows: Array, error: Array, soft: Array) -> Array:
    """Return x with rows x = error and the least norm of soft x, by the null space of the rows."""
    first = np.linalg.lstsq(rows, error, rcond=1e-13)[0]
    null = null_space(rows, rcond=1e-13)
    return np.asarray(first - null @ np.linalg.lstsq(soft @ null, soft @ first, rcond=None)[0])
