"""The search: first features, adapted mesh, detected structure, exact sequence, proof.

Every round solves the program on a finer mesh, detects the structure in its multipliers and
tries to solve that structure exactly. A sequence is accepted on its merits alone: the motion
keeps force, bounds and target, and the multipliers prove that no control is faster.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from mtcommission.optimal.bounded.mesh.exchange import exchange, later
from mtcommission.optimal.bounded.mesh.finish import on_mesh
from mtcommission.optimal.bounded.mesh.forms import MeshOptimum, solve_mesh, solve_relaxation
from mtcommission.optimal.bounded.mesh.observe import Observation, observe
from mtcommission.optimal.bounded.mesh.plan import Features, plan_mesh
from mtcommission.optimal.bounded.mesh.refinement import refined
from mtcommission.optimal.bounded.mesh.rows import MeshPlan
from mtcommission.optimal.bounded.newton.edits import pruned
from mtcommission.optimal.bounded.newton.exact import holds_high_order, solve_exactly
from mtcommission.optimal.bounded.newton.extremal import Extremal
from mtcommission.optimal.bounded.places import ArcInterior
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.proof.accepted import Found
from mtcommission.optimal.bounded.proof.dual_point import stretches
from mtcommission.optimal.bounded.proof.dual_value import dual_value, lower_bound


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Enclosure:
    """The two forms of one program and the relative distance of the times that they give."""

    restriction: MeshOptimum
    relaxation: MeshOptimum
    gap: float


def search(problem: BoundedProblem, features: Features) -> Found | None:
    """Return the best accepted control, or None."""
    settings, allowed = problem.settings.search, problem.settings.proof.gap
    seen: list[_Enclosure] = []
    left = settings.effort
    for _ in range(settings.rounds):
        most = left / (settings.programs + settings.finishing)
        restriction = _restriction(problem, features, most=most, first=not seen)
        if restriction is None:
            break
        left -= settings.programs * restriction.plan.effort
        relaxation = solve_relaxation(problem, restriction)
        if relaxation is None:
            break
        coarse = relaxation
        now, exact = _observed(problem, restriction, relaxation, unsplit=coarse.plan)
        if exact is not None:
            return exact
        gap = _enclosed_gap(problem, now.dual_value, restriction, relaxation)
        if seen or gap > settings.hopeless:
            restriction, relaxation = refined(
                problem, restriction, relaxation, largest=settings.split_largest
            )
        if relaxation is not coarse:
            now, exact = _observed(problem, restriction, relaxation, unsplit=coarse.plan)
            if exact is not None:
                return exact
            gap = _enclosed_gap(problem, now.dual_value, restriction, relaxation)
        crowded = problem.has_high_order and any(one.gap < gap for one in seen)
        features = replace(now.features, room=features.room * (settings.wider if crowded else 1.0))
        seen.append(_Enclosure(restriction=restriction, relaxation=relaxation, gap=gap))
        # Arcs of low order are exact, once they are detected rightly: that is worth one mesh more.
        fine = sum(one.gap < settings.enough * allowed for one in seen)
        settled = fine > 1 or holds_high_order(problem, now.guess)
        if gap < settings.enough * allowed and settled:
            found = on_mesh(problem, restriction, relaxation)
            if found is not None and found.gap <= allowed:
                return found
    return _best_on_mesh(problem, seen)


def _observed(
    problem: BoundedProblem, restriction: MeshOptimum, relaxation: MeshOptimum, *, unsplit: MeshPlan
) -> tuple[Observation, Found | None]:
    """Return what a mesh shows, and the extremal of it, or of the same without ripples."""
    now = observe(problem, restriction, relaxation, unsplit=unsplit)
    exact = solve_exactly(problem, now.guess)
    if exact is None:
        seen = Extremal(sequence=now.guess, measure=relaxation.measure, residual=inf)
        plainer = pruned(problem, seen, least=problem.settings.search.splinter)
        exact = None if plainer is None else solve_exactly(problem, plainer)
    return now, exact


def _enclosed_gap(
    problem: BoundedProblem, value: float, restriction: MeshOptimum, relaxation: MeshOptimum
) -> float:
    """Return the relative distance of the times of the two forms, given the dual value."""
    along = float(relaxation.measure.terminal @ problem.target)
    if along == 0.0:
        return inf  # multipliers that do not weigh the move prove nothing of it
    reach = value / along
    slope = restriction.slope * restriction.plan.t_f
    return (reach - restriction.reach) / max(slope, problem.settings.mesh.least_slope)


def _best_on_mesh(problem: BoundedProblem, seen: list[_Enclosure]) -> Found | None:
    """Return the best mesh control that can be finished; the best multipliers prove them all."""
    best: Found | None = None
    if not seen:
        return None
    seen = [*seen, _split_on(problem, min(seen, key=lambda one: abs(one.gap)))]
    proof = max(
        (one.relaxation for one in seen), key=lambda form: lower_bound(problem, form.measure)
    )
    for one in sorted(seen, key=lambda one: abs(one.gap))[: problem.settings.search.finished]:
        found = on_mesh(problem, one.restriction, proof)
        if found is not None and (best is None or found.gap < best.gap):
            best = found
        if best is not None and best.gap <= problem.settings.proof.gap:
            break
    return best


def _split_on(problem: BoundedProblem, last: _Enclosure) -> _Enclosure:
    """Return an enclosure whose cells were split as long as that brings its two times closer."""
    settings = problem.settings.search
    for _ in range(settings.last_splits):
        timely = _retimed(problem, last)
        forms = timely.restriction, timely.relaxation
        restriction, relaxation = refined(problem, *forms, largest=settings.split_largest)
        measure = relaxation.measure
        value = dual_value(problem, stretches(problem, measure), measure.atoms).value
        gap = _enclosed_gap(problem, value, restriction, relaxation)
        is_idle = timely is last and gap > settings.worthwhile * last.gap
        if relaxation is last.relaxation or is_idle:
            break
        last = _Enclosure(restriction=restriction, relaxation=relaxation, gap=gap)
    return last


def _retimed(problem: BoundedProblem, one: _Enclosure) -> _Enclosure:
    """Return an enclosure at the t_f that it calls for, where that moves its switches notably."""
    if abs(one.restriction.reach - 1.0) < problem.settings.search.timely:
        return one
    t_f = later(problem, one.restriction.plan, one.restriction)
    restriction, relaxation = (
        solve_mesh(
            problem,
            form.plan.stretched(t_f),
            relaxed=form is one.relaxation,
            start=form.basis,
            solvable=True,
        )
        for form in (one.restriction, one.relaxation)
    )
    if restriction is None or relaxation is None:
        return one
    restriction = replace(restriction, slope=one.restriction.slope)
    return _Enclosure(restriction=restriction, relaxation=relaxation, gap=inf)


def _restriction(
    problem: BoundedProblem, features: Features, *, most: float, first: bool
) -> MeshOptimum | None:
    """Return the restriction on the first mesh on which there is one, at most of a given effort.

    Where the interiors reach beyond the arcs, they get more room; or there are fewer of them.
    """
    settings = problem.settings.search
    largest = settings.first_largest if first else min(settings.largest, most)
    few = problem.has_high_order and not first
    tried: list[tuple[ArcInterior, ...]] = []
    for room, share in settings.fewer_interiors if few else settings.interiors:
        spaced = replace(features, room=features.room * room, least_interior=share)
        plan = _planned(problem, spaced, largest)
        if (plan.effort > most and not first) or plan.interiors in tried:
            continue
        tried.append(plan.interiors)
        restriction = exchange(problem, plan)
        if restriction is not None and (first or restriction.reach > 1.0 - settings.setback):
            return restriction
    return None


def _planned(problem: BoundedProblem, features: Features, largest: float) -> MeshPlan:
    """Return the finest plan of at most some effort, or the coarsest there is."""
    for ease in problem.settings.search.eases:
        plan = plan_mesh(problem, replace(features, ease=ease))
        if plan.effort < largest:
            break
    return plan
