"""The program on one mesh, with points put in wherever its motion breaks a bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mtcommission.optimal.bounded.mesh.forms import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded.mesh.rows import MeshPlan, off_interiors
from mtcommission.optimal.bounded.mesh.violations import violations
from mtcommission.optimal.bounded.problem import BoundedProblem


def exchange(problem: BoundedProblem, plan: MeshPlan) -> MeshOptimum | None:
    """Return the solution on the mesh with t_f such that the reach is 1."""
    settings = problem.settings.mesh
    found: MeshOptimum | None = None
    # While the mesh is coarse, more exactness at the bounds would be wasted.
    tolerance = max(settings.broken, 0.3 * float(np.diff(plan.mesh).min()) / plan.t_f)
    for _ in range(settings.exchanges):
        start = None if found is None else found.basis
        before, found = found, solve_mesh(problem, plan, relaxed=False, start=start)
        if found is None:
            return None
        if before is not None:
            found = _steepened(problem, before, found)
        over = [violation.point for violation in violations(problem, found, tolerance=tolerance)]
        worse = off_interiors(problem, tuple(over), found.plan.interiors)
        in_time = abs(found.reach - 1.0) < 1e-4
        if in_time and (not worse or _is_steady(problem, before, found)):
            break
        plan = replace(plan, points=tuple(dict.fromkeys([*plan.points, *worse])))
        if not in_time:
            plan = plan.stretched(later(problem, plan, found))
    return found


def _is_steady(problem: BoundedProblem, before: MeshOptimum | None, after: MeshOptimum) -> bool:
    """Return whether the last points have hardly changed the reach."""
    if before is None or before.plan.t_f != after.plan.t_f:
        return False
    return before.reach - after.reach < problem.settings.mesh.steady


def _steepened(problem: BoundedProblem, before: MeshOptimum, found: MeshOptimum) -> MeshOptimum:
    """Return a solution with the slope of the way gone: the marginal knows one cell only."""
    gone = found.plan.t_f - before.plan.t_f
    if abs(gone) < problem.settings.mesh.long_way * found.plan.t_f:
        return found
    secant = (found.reach - before.reach) / gone
    return replace(found, slope=secant) if secant > 0.0 else found


def later(problem: BoundedProblem, plan: MeshPlan, found: MeshOptimum) -> float:
    """Return the t_f at which the reach should be 1, no further away than is safe."""
    settings = problem.settings.mesh
    change = (1.0 - found.reach) / max(found.slope * plan.t_f, settings.least_slope)
    most = settings.largest_change
    return plan.t_f * (1.0 + float(np.clip(change, -most, most)))
