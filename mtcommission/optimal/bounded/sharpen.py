"""One mesh sharpened: its cells split where σ changes sign in them.

The program on a mesh sees |∫σ| of a cell, the proof ∫|σ|. A cell split at the zero of σ hides
nothing any more, and the force may switch there. The zeros move a little when the program is solved
again, so what is hidden falls by a factor of three to ten each time, as in Remez' exchange.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import repeat

import numpy as np
from highspy import HighsBasisStatus
from numpy.typing import NDArray

from mtcommission.optimal.bounded.breaches import breaches
from mtcommission.optimal.bounded.dual import dual_value
from mtcommission.optimal.bounded.measure import stretches
from mtcommission.optimal.bounded.mesh import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.program import Basis
from mtcommission.optimal.bounded.rows import Contact, Layout, off_cores
from mtcommission.optimal.bounded.sight import hidden, steepness_of_zeros

Array = NDArray[np.float64]

SPLITS = 3
"""Times a mesh is split; what is still hidden is left to the next mesh."""
HIDDEN_ENOUGH = 2e-7
"""What all cells may hide of the time, relative to it."""
LARGE_SHARE = 1e-2
"""Share of the largest loss from which on a zero splits its cell."""
LEAST_LOSS = 1e-9
"""Loss of a zero below which it never does."""
MOST_SPLIT = 300
"""Cells split at once at most, those that hide most."""
MIDDLE = 0.02
"""Share of its cell that a zero keeps from the ends: closer ones hide nothing."""


def sharpened(
    problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum, *, largest: float
) -> tuple[MeshOptimum, MeshOptimum]:
    """Return both forms of a program on a mesh that hides less than they are apart.

    Parameters
    ----------
    problem
        The bounded problem.
    kept, relaxed
        The two forms on one mesh.
    largest
        ``Layout.effort`` of a program at most.

    Returns
    -------
    tuple of MeshOptimum and MeshOptimum
        As they were where nothing is hidden, or the finer program is too large or finds no
        solution.
    """
    for _ in range(SPLITS):
        measure = relaxed.measure
        parts = stretches(problem, measure)
        zeros = dual_value(problem, parts, measure.atoms).zeros
        lost = hidden(steepness_of_zeros(problem, measure, parts, zeros), zeros, _ends(relaxed))
        apart = relaxed.reach - kept.reach
        if lost.sum() < max(apart, HIDDEN_ENOUGH):
            break
        worst = np.sort(np.argsort(lost)[-MOST_SPLIT:])
        large = worst[lost[worst] > max(LEAST_LOSS, LARGE_SHARE * lost.max())]
        places = _inside(relaxed, zeros[large])
        over = breaches(problem, relaxed, tolerance=float(lost.sum()) + apart)
        contacts = (*_beside(kept, places), *(breach.contact for breach in over))
        layouts = [_split(problem, form.layout, places, contacts) for form in (kept, relaxed)]
        if layouts[0].effort > largest:
            break
        finer_kept, finer = (
            solve_mesh(
                problem,
                layout,
                relaxed=form is relaxed,
                start=_inherited(form, places),
                solvable=True,
            )
            for form, layout in zip((kept, relaxed), layouts, strict=True)
        )
        if finer_kept is None or finer is None:
            break
        kept, relaxed = replace(finer_kept, slope=kept.slope), finer
    return kept, relaxed


def _split(
    problem: BoundedProblem, layout: Layout, places: Array, contacts: tuple[Contact, ...]
) -> Layout:
    """Return a layout with cells split at some places and with further points."""
    new = off_cores(problem, contacts, layout.cores)
    return replace(
        layout,
        mesh=np.unique(np.concatenate([layout.mesh, places])),
        contacts=tuple(dict.fromkeys([*layout.contacts, *new])),
    )


def _inherited(found: MeshOptimum, places: Array) -> Basis:
    """Return the basis in which the parts of a cell are what the cell was.

    One part only of a cell in the basis is in it, so that the basis keeps its size.
    """
    cells = [segment for segment in found.segments if segment.limit < 0]
    unknowns: list[HighsBasisStatus] = []
    for cell, was in zip(cells, found.basis.unknowns, strict=False):
        more = int(((cell.end < places) & (places < cell.start)).sum())
        other = HighsBasisStatus.kUpper if was == HighsBasisStatus.kBasic else was
        unknowns += [was, *repeat(other, more)]
    return replace(found.basis, unknowns=(*unknowns, *found.basis.unknowns[len(cells) :]))


def _ends(found: MeshOptimum) -> Array:
    """Return the ends of all cells and cores, ascending remaining times [s]."""
    return np.array([0.0, *(segment.start for segment in reversed(found.segments))])


def _inside(found: MeshOptimum, zeros: Array) -> Array:
    """Return the zeros that are well inside their cells."""
    ends = _ends(found)
    after = np.clip(np.searchsorted(ends, zeros), 1, ends.size - 1)
    low, high = ends[after - 1], ends[after]
    return np.asarray(zeros[np.minimum(zeros - low, high - zeros) > MIDDLE * (high - low)])


def _beside(found: MeshOptimum, places: Array) -> list[Contact]:
    """Return points at the places whose cells have points at an end.

    Without them the motion would exceed the bound between the finer cells.
    """
    ends = _ends(found)
    sides: dict[float, list[Contact]] = {}
    for contact in found.layout.contacts:
        sides.setdefault(contact.remaining, []).append(contact)
    after = np.searchsorted(ends, places)
    return [
        replace(beside, remaining=place)
        for place, i in zip(places.tolist(), after.tolist(), strict=True)
        for end in (float(ends[i - 1]), float(ends[i]))
        for beside in sides.get(end, [])
    ]
