"""A control on a mesh finished: slowed down until it keeps everything between the points, too."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.optimal.bounded.mesh.arcs import mesh_arcs
from mtcommission.optimal.bounded.mesh.exchange import later
from mtcommission.optimal.bounded.mesh.forms import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded.mesh.rows import MeshPlan
from mtcommission.optimal.bounded.mesh.violations import saturations, violations
from mtcommission.optimal.bounded.places import FORCE, ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.proof.accepted import Found, peak_levels, proved
from mtcommission.optimal.bounded.proof.motion import follow_control


def on_mesh(
    problem: BoundedProblem, restriction: MeshOptimum, relaxation: MeshOptimum
) -> Found | None:
    """Return the mesh control itself, slowed down until it keeps the bounds everywhere."""
    plan, found, slope = restriction.plan, restriction, restriction.slope
    sizes = restriction.sizes[problem.fixed]
    settings, tolerance = problem.settings.mesh, problem.settings.proof.excess
    for attempt in range(settings.finishing_steps):
        over = [
            *violations(problem, found, tolerance=tolerance),
            *saturations(problem, found, tolerance=tolerance),
        ]
        excess = max((violation.excess for violation in over), default=0.0)
        late = 1.0 - found.reach
        if not over and -settings.lateness < late <= 0.0:
            arcs = mesh_arcs(problem, found)
            motion = follow_control(
                problem.plant, arcs, rate=problem.rate, settings=problem.settings.proof
            )
            excess = max(peak_levels(problem, motion)) - 1.0
            if excess < tolerance:
                acting = (at for at in found.points if at.weight > 0.0)
                touches = tuple(at for at in acting if at.limit != FORCE)
                return proved(problem, motion, relaxation.measure, touches, exact=False)
        found = replace(found, slope=slope)
        # Another point costs less time than a margin kept everywhere; the last bit is the margin's.
        by_points = attempt < settings.point_steps and excess > settings.margin_excess
        fine = [one.point for one in over if one.excess > settings.point_excess and by_points]
        worse = [at for at in fine if not _is_held(plan, at)]
        more = 1.1 * excess if excess > 0.0 and not worse else 0.0
        margin = plan.margin + more
        expected = replace(found, reach=found.reach - more * found.held)
        least_slope = settings.least_slope / plan.t_f
        t_f = later(problem, plan, expected) + 2e-10 / max(slope, least_slope)
        points = tuple(dict.fromkeys([*plan.points, *worse]))
        plan = replace(plan, points=points, margin=margin).stretched(t_f)
        # A control like this one exists, or nearly: a verdict against it is rounding.
        following = solve_mesh(
            problem, plan, relaxed=False, start=found.basis, solvable=True, sizes=sizes
        )
        if following is None:
            return None
        slope = _slope(found, following) if attempt else following.slope
        found = following
    return None


def _is_held(plan: MeshPlan, point: ConstraintPoint) -> bool:
    """Return whether an interior holds the very bound of a point: then no point can help."""
    return any(
        interior.limit == point.limit and interior.holds(point.remaining)
        for interior in plan.interiors
    )


def _slope(before: MeshOptimum, after: MeshOptimum) -> float:
    """Return dα/dt_f: of the way gone if that tells, else the marginal, which knows one cell only.

    Points put in on the way lower the reach; a step that went too far tells nevertheless.
    """
    gone = after.plan.t_f - before.plan.t_f
    secant = (after.reach - before.reach) / gone if gone else 0.0
    same = len(after.plan.points) == len(before.plan.points)
    too_far = (after.reach - 1.0) * (before.reach - 1.0) < 0.0
    return secant if secant > 0.0 and (same or too_far) else max(after.slope, before.slope)
