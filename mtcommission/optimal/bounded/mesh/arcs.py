"""The arcs of a control on a mesh."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from mtcommission.optimal.bounded.mesh.forms import MeshOptimum
from mtcommission.optimal.bounded.mesh.rows import Segment
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.structure.arcs import boundary_arc
from mtcommission.optimal.solution import Arc, ArcControl, Bang, Interior, constant_arc


def mesh_arcs(problem: BoundedProblem, found: MeshOptimum) -> tuple[Arc, ...]:
    """Return the arcs of a control on a mesh, scaled so that it reaches the target once."""
    F, t_f, arcs = problem.force_limit, found.plan.t_f, list[Arc]()
    for group in _groups(problem, found):
        start, end = t_f - group[0].start, t_f - group[-1].end
        if group[0].limit >= 0:
            state = group[0].first / found.reach
            arcs.append(boundary_arc(problem, group[0].limit, start, end, state=state))
            continue
        lengths = np.array([cell.start - cell.end for cell in group])
        share = float(found.unknowns[[cell.column for cell in group]] @ lengths / lengths.sum())
        full = abs(share) > 1.0 - problem.settings.mesh.same_force
        control: ArcControl = Bang(1 if share > 0.0 else -1) if full else Interior()
        arcs.append(constant_arc(start, end, control=control, force=share * F / found.reach))
    return tuple(arcs)


def _groups(problem: BoundedProblem, found: MeshOptimum) -> list[list[Segment]]:
    groups = [[found.segments[0]]]
    for before, after in pairwise(found.segments):
        both = before.limit < 0 and after.limit < 0
        if (
            both
            and abs(found.unknowns[before.column] - found.unknowns[after.column])
            < problem.settings.mesh.same_force
        ):
            groups[-1].append(after)
        else:
            groups.append([after])
    return groups
