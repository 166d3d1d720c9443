"""One mesh refined: its cells split where σ changes sign in them.

The program on a mesh sees |∫σ| of a cell, the proof ∫|σ|. A cell split at the zero of σ hides
nothing any more, and the force may switch there. The zeros move a little when the program is solved
again, so what is hidden falls by a factor of three to ten each time, as in Remez' exchange.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.mesh.forms import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded.mesh.observe import hidden, steepness_of_zeros
from mtcommission.optimal.bounded.mesh.rows import MeshPlan, off_interiors
from mtcommission.optimal.bounded.mesh.violations import violations
from mtcommission.optimal.bounded.places import ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.program.linear_program import Basis
from mtcommission.optimal.bounded.proof.dual_point import stretches
from mtcommission.optimal.bounded.proof.dual_value import dual_value

Array = NDArray[np.float64]


def refined(
    problem: BoundedProblem, restriction: MeshOptimum, relaxation: MeshOptimum, *, largest: float
) -> tuple[MeshOptimum, MeshOptimum]:
    """Return both forms of a program on a mesh that hides less than they are apart."""
    settings = problem.settings.mesh
    for _ in range(settings.splits):
        measure = relaxation.measure
        parts = stretches(problem, measure)
        zeros = dual_value(problem, parts, measure.atoms).zeros
        lost = hidden(steepness_of_zeros(problem, measure, parts, zeros), zeros, _ends(relaxation))
        apart = relaxation.reach - restriction.reach
        if lost.sum() < max(apart, settings.hidden_enough):
            break
        worst = np.sort(np.argsort(lost)[-settings.most_split :])
        large = worst[lost[worst] > max(settings.least_loss, settings.large_share * lost.max())]
        places = _inside(relaxation, zeros[large], apart=settings.middle)
        over = violations(problem, relaxation, tolerance=float(lost.sum()) + apart)
        points = (*_beside(restriction, places), *(violation.point for violation in over))
        plans = [_split(problem, form.plan, places, points) for form in (restriction, relaxation)]
        if plans[0].effort > largest:
            break
        finer_restriction, finer = (
            solve_mesh(
                problem,
                plan,
                relaxed=form is relaxation,
                start=_inherited(form, places),
                solvable=True,
            )
            for form, plan in zip((restriction, relaxation), plans, strict=True)
        )
        if finer_restriction is None or finer is None:
            break
        restriction, relaxation = replace(finer_restriction, slope=restriction.slope), finer
    return restriction, relaxation


def _split(
    problem: BoundedProblem, plan: MeshPlan, places: Array, points: tuple[ConstraintPoint, ...]
) -> MeshPlan:
    """Return a plan with cells split at some places and with further points."""
    new = off_interiors(problem, points, plan.interiors)
    return replace(
        plan,
        mesh=np.unique(np.concatenate([plan.mesh, places])),
        points=tuple(dict.fromkeys([*plan.points, *new])),
    )


def _inherited(found: MeshOptimum, places: Array) -> Basis:
    """Return the basis in which the parts of a cell are what the cell was."""
    cells = [segment for segment in found.segments if segment.limit < 0]
    return found.basis.split(
        [1 + int(((cell.end < places) & (places < cell.start)).sum()) for cell in cells]
    )


def _ends(found: MeshOptimum) -> Array:
    """Return the ends of all cells and interiors, ascending remaining times [s]."""
    return np.array([0.0, *(segment.start for segment in reversed(found.segments))])


def _inside(found: MeshOptimum, zeros: Array, *, apart: float) -> Array:
    """Return the zeros that are well inside their cells."""
    ends = _ends(found)
    after = np.clip(np.searchsorted(ends, zeros), 1, ends.size - 1)
    low, high = ends[after - 1], ends[after]
    return np.asarray(zeros[np.minimum(zeros - low, high - zeros) > apart * (high - low)])


def _beside(found: MeshOptimum, places: Array) -> list[ConstraintPoint]:
    """Return points at the places whose cells have points at an end.

    Without them the motion would exceed the bound between the finer cells.
    """
    ends = _ends(found)
    sides: dict[float, list[ConstraintPoint]] = {}
    for point in found.plan.points:
        sides.setdefault(point.remaining, []).append(point)
    after = np.searchsorted(ends, places)
    return [
        replace(beside, remaining=place)
        for place, i in zip(places.tolist(), after.tolist(), strict=True)
        for end in (float(ends[i - 1]), float(ends[i]))
        for beside in sides.get(end, [])
    ]
