"""The program on one mesh, with points put in wherever its motion breaks a bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mtcommission.optimal.bounded.breaches import BROKEN, breaches
from mtcommission.optimal.bounded.mesh import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.rows import Layout, off_cores

EXCHANGES = 6
"""Solutions of the program on one mesh, each with the points where the last broke a bound."""
STEADY = 2e-6
"""Change of the reach by new points below which others are left to the next mesh."""
LEAST_SLOPE = 0.3
"""Least dα/dlog t_f believed: the marginal vanishes where the first cell hides a switch."""
LARGEST_CHANGE = 0.02
"""Largest relative change of t_f on one mesh."""
LONG_WAY = 1e-3
"""Least such change that tells the slope better: points put in between lower the reach, too."""


def exchange(problem: BoundedProblem, layout: Layout) -> MeshOptimum | None:
    """Return the solution on the mesh with t_f such that the reach is 1."""
    found: MeshOptimum | None = None
    # While the mesh is coarse, more exactness at the bounds would be wasted.
    tolerance = max(BROKEN, 0.3 * float(np.diff(layout.mesh).min()) / layout.t_f)
    for _ in range(EXCHANGES):
        start = None if found is None else found.basis
        before, found = found, solve_mesh(problem, layout, relaxed=False, start=start)
        if found is None:
            return None
        if before is not None:
            found = steepened(before, found)
        over = [breach.contact for breach in breaches(problem, found, tolerance=tolerance)]
        worse = off_cores(problem, tuple(over), found.layout.cores)
        in_time = abs(found.reach - 1.0) < 1e-4
        if in_time and (not worse or _steady(before, found)):
            break
        layout = replace(layout, contacts=tuple(dict.fromkeys([*layout.contacts, *worse])))
        if not in_time:
            layout = layout.stretched(later(layout, found))
    return found


def _steady(before: MeshOptimum | None, after: MeshOptimum) -> bool:
    """Return whether the last points have hardly changed the reach."""
    if before is None or before.layout.t_f != after.layout.t_f:
        return False
    return before.reach - after.reach < STEADY


def steepened(before: MeshOptimum, found: MeshOptimum) -> MeshOptimum:
    """Return a solution with the slope of the way gone: the marginal knows one cell only."""
    gone = found.layout.t_f - before.layout.t_f
    if abs(gone) < LONG_WAY * found.layout.t_f:
        return found
    secant = (found.reach - before.reach) / gone
    return replace(found, slope=secant) if secant > 0.0 else found


def later(layout: Layout, found: MeshOptimum) -> float:
    """Return the t_f at which the reach should be 1, no further away than is safe."""
    change = (1.0 - found.reach) / max(found.slope * layout.t_f, LEAST_SLOPE)
    return layout.t_f * (1.0 + float(np.clip(change, -LARGEST_CHANGE, LARGEST_CHANGE)))
