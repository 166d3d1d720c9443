"""The proof where a bound of order 3 is held: points of contact instead of whole arcs.

The relaxation of ``bounded_mesh`` lets the state jump onto a core. For order 3 that is cheap near
the ends of an arc, where the true control touches the bound more and more often. So the cores
are cut down to the middle of their arcs; beside them the bound is imposed at single instants, and
wherever the relaxed motion exceeds it another instant is put in (exchange, semi-infinite
programming). With mesh points at the zeros of σ the multipliers prove more with every step; what
is left falls with the third power of the distance of the instants.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded_dual import dual_value, stretches
from mtcommission.optimal.bounded_exchange import LEAST_SLOPE, broken
from mtcommission.optimal.bounded_mesh import Contact, Layout, MeshOptimum, off_cores, solve_mesh
from mtcommission.optimal.bounded_problem import BoundedProblem

Array = NDArray[np.float64]

CUT = 0.3
"""Share of an arc of order 3 taken from the core at each end."""
INSTANTS = 20
"""First instants of contact on each of these shares."""
EXCHANGES = 7
"""Programs at most."""
MOST_CELLS = 2200
"""Cells above which no further program is solved (some seconds)."""
BROKEN = 2e-7
"""Relative excess of the relaxed motion that calls for another instant."""
CLOSE = 1e-8
"""Share of t_f below which two points of the mesh are one."""


def prove_by_contacts(problem: BoundedProblem, kept: MeshOptimum, *, goal: float) -> MeshOptimum:
    """Return a relaxation whose multipliers prove the time of the restriction as nearly as may be.

    Parameters
    ----------
    problem
        The bounded problem.
    kept
        The restriction.
    goal
        Relative gap at which the search for better multipliers ends.

    Returns
    -------
    MeshOptimum
        The best of the programs solved; its gap is that of ``enclosed_gap``.

    Source: exchange method of semi-infinite programming; the mesh plays no part in the proof.
    """
    layout, best, least = _opened(problem, kept.layout), kept, np.inf
    for _ in range(EXCHANGES):
        relaxed = solve_mesh(problem, layout, relaxed=True)
        if relaxed is None:
            break
        gap = enclosed_gap(problem, kept, relaxed)
        if gap < least:
            best, least = relaxed, gap
        measure = relaxed.measure
        zeros = dual_value(problem, stretches(problem, measure), measure.atoms).zeros
        mesh = _apart(np.concatenate([layout.mesh, zeros]), layout.t_f)
        if least < goal or mesh.size > MOST_CELLS:
            break
        over = broken(problem, relaxed, tolerance=BROKEN)
        contacts = tuple(dict.fromkeys([*layout.contacts, *over]))
        layout = replace(layout, mesh=mesh, contacts=contacts)
    return best


def enclosed_gap(problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum) -> float:
    """Return the relative distance of the times that the two forms of a program give."""
    measure = relaxed.measure
    value = dual_value(problem, stretches(problem, measure), measure.atoms).value
    reach = value / float(measure.terminal @ problem.target)
    return (reach - kept.reach) / max(kept.slope * kept.layout.t_f, LEAST_SLOPE)


def _opened(problem: BoundedProblem, layout: Layout) -> Layout:
    """Return the layout with the cores of high order cut down, and contacts in their place."""
    cores, points, contacts = [], [layout.mesh], list(layout.contacts)
    for core in layout.cores:
        if problem.limits[core.limit].order <= 2:
            cores.append(core)
            continue
        cut = CUT * (core.start - core.end)
        inner = replace(core, start=core.start - cut, end=core.end + cut)
        cores.append(inner)
        for low, high in ((core.end, inner.end), (inner.start, core.start)):
            instants = np.linspace(low, high, INSTANTS + 1)
            points += [instants, 0.5 * (instants[1:] + instants[:-1])]
            contacts += [
                Contact(remaining=t, limit=core.limit, side=core.side) for t in instants.tolist()
            ]
    mesh = _apart(np.concatenate(points), layout.t_f)
    room = CLOSE * layout.t_f
    for core in cores:
        mesh = mesh[(mesh < core.end - room) | (mesh > core.start + room)]
    kept = off_cores(problem, tuple(dict.fromkeys(contacts)), tuple(cores))
    return replace(layout, mesh=mesh, cores=tuple(cores), contacts=kept, margin=0.0)


def _apart(points: Array, t_f: float) -> Array:
    ordered = np.unique(points)
    return np.asarray(ordered[np.append(True, np.diff(ordered) > CLOSE * t_f)])
