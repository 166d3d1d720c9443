"""The search: first sight, adapted mesh, reading, exact sequence, proof.

Every round solves the program on a finer mesh, reads the structure from its multipliers and
tries to solve that structure exactly. A sequence is accepted on its merits alone: the motion
keeps force, bounds and target, and the multipliers prove that no control is faster.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.accept import GAP, Found, on_mesh
from mtcommission.optimal.bounded.dual import dual_value, lower_bound
from mtcommission.optimal.bounded.edit import pruned
from mtcommission.optimal.bounded.exact import holds_high_order, solve_exactly
from mtcommission.optimal.bounded.exchange import LEAST_SLOPE, exchange, later
from mtcommission.optimal.bounded.layout import Sight, lay_out
from mtcommission.optimal.bounded.measure import Core, stretches
from mtcommission.optimal.bounded.mesh import MeshOptimum, solve_mesh, solve_relaxation
from mtcommission.optimal.bounded.newton import Extremal
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.rows import Layout
from mtcommission.optimal.bounded.sharpen import sharpened
from mtcommission.optimal.bounded.sight import Look, look

Array = NDArray[np.float64]

ROUNDS = 8
"""Meshes tried; each is five times as fine at the features as the one before."""
EFFORT = 3e10
"""Sum of the efforts of all programs of a search: some 20 s of computing time."""
PROGRAMS, FINISHING = 3, 4
"""Programs of a round, and programs that finish its control."""
CORES = ((1.0, 0.0), (2.0, 0.0), (4.0, 0.0), (8.0, 0.0), (1.0, 0.06))
"""Factors tried on the distance between a core and the ends of its arc, with the least share of
t_f of an arc that gets a core."""
FEWER_CORES = ((1.0, 0.02), (1.0, 0.06), (8.0, 0.06))
"""The same on finer meshes where an order above 2 is among the bounds: what looks like a short
arc may be touch points that crowd."""
WIDER = 4.0
"""Factor on the distance of cores from the ends of their arcs after a mesh that proves less than
those before, with an order above 2 among the bounds: on smaller cells touch points that crowd
towards an arc look like its end."""
EASES = (1.0, 1.7, 2.5, 3.5, 5.0, 7.0)
"""Factors tried on the cells wanted until a program is small enough."""
FIRST_LARGEST, LARGEST, SPLIT_LARGEST = 1.5e9, 3e9, 1.2e10
"""Effort of a program that the simplex method ends within some seconds, for the first mesh, where
many of the features are none, for others, and for one with a basis to start from."""
SETBACK = 1e-3
"""Reach below 1 on a finer mesh that betrays a core where the bound is not held."""
SPLINTER = 2e-4
"""Share of t_f of a piece that may be the ripple of a mesh: left out where it leads nowhere."""
FINISHED = 2
"""Mesh controls that are finished at most; one with long cores may not reach full precision."""
LAST_SPLITS, WORTHWHILE = 3, 0.7
"""Times the cells of the best mesh are split once more at the end, and the share to which the gap
falls at least if it is to be done again."""
TIMELY = 1e-5
"""Distance of the reach from 1 up to which switches stay where the cells were split."""
HOPELESS = 0.3
"""Gap of a first mesh that is split at once; from others the next mesh is found at less cost."""
ENOUGH = 0.7
"""Share of the gap at which a mesh is fine enough: finishing it costs a little."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Enclosure:
    """The two forms of one program and the relative distance of the times that they give."""

    kept: MeshOptimum
    relaxed: MeshOptimum
    gap: float


def search(problem: BoundedProblem, sight: Sight) -> Found | None:
    """Return the best accepted control, or None.

    Parameters
    ----------
    problem
        The bounded problem.
    sight
        Where to start.

    Returns
    -------
    Found or None
        With a gap of at most ``GAP``, or ``LOOSE_GAP`` where only the mesh could be solved.
    """
    seen: list[_Enclosure] = []
    left = EFFORT
    for _ in range(ROUNDS):
        kept = _kept(problem, sight, most=left / (PROGRAMS + FINISHING), first=not seen)
        if kept is None:
            break
        left -= PROGRAMS * kept.layout.effort
        relaxed = solve_relaxation(problem, kept)
        if relaxed is None:
            break
        coarse = relaxed
        now, exact = _read(problem, kept, relaxed, unsplit=coarse.layout)
        if exact is not None:
            return exact
        gap = _enclosed_gap(problem, now.dual_value, kept, relaxed)
        if seen or gap > HOPELESS:
            kept, relaxed = sharpened(problem, kept, relaxed, largest=SPLIT_LARGEST)
        if relaxed is not coarse:
            now, exact = _read(problem, kept, relaxed, unsplit=coarse.layout)
            if exact is not None:
                return exact
            gap = _enclosed_gap(problem, now.dual_value, kept, relaxed)
        crowded = problem.has_high_order and any(one.gap < gap for one in seen)
        sight = replace(now.sight, room=sight.room * (WIDER if crowded else 1.0))
        seen.append(_Enclosure(kept=kept, relaxed=relaxed, gap=gap))
        # Arcs of low order are exact, once they are read rightly: that is worth one mesh more.
        fine = sum(one.gap < ENOUGH * GAP for one in seen)
        if gap < ENOUGH * GAP and (fine > 1 or holds_high_order(problem, now.guess)):
            found = on_mesh(problem, kept, relaxed)
            if found is not None and found.gap <= GAP:
                return found
    return _best_on_mesh(problem, seen)


def _read(
    problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum, *, unsplit: Layout
) -> tuple[Look, Found | None]:
    """Return what a mesh shows, and the extremal of it, or of the same without ripples."""
    now = look(problem, kept, relaxed, unsplit=unsplit)
    exact = solve_exactly(problem, now.guess)
    if exact is None:
        read = Extremal(sequence=now.guess, measure=relaxed.measure, residual=inf)
        plainer = pruned(problem, read, least=SPLINTER)
        exact = None if plainer is None else solve_exactly(problem, plainer)
    return now, exact


def _enclosed_gap(
    problem: BoundedProblem, value: float, kept: MeshOptimum, relaxed: MeshOptimum
) -> float:
    """Return the relative distance of the times of the two forms, given the dual value."""
    along = float(relaxed.measure.terminal @ problem.target)
    if along == 0.0:
        return inf  # multipliers that do not weigh the move prove nothing of it
    reach = value / along
    return (reach - kept.reach) / max(kept.slope * kept.layout.t_f, LEAST_SLOPE)


def _best_on_mesh(problem: BoundedProblem, seen: list[_Enclosure]) -> Found | None:
    """Return the best mesh control that can be finished; the best multipliers prove them all."""
    best: Found | None = None
    if not seen:
        return None
    seen = [*seen, _split_on(problem, min(seen, key=lambda one: abs(one.gap)))]
    proof = max((one.relaxed for one in seen), key=lambda form: lower_bound(problem, form.measure))
    for one in sorted(seen, key=lambda one: abs(one.gap))[:FINISHED]:
        found = on_mesh(problem, one.kept, proof)
        if found is not None and (best is None or found.gap < best.gap):
            best = found
        if best is not None and best.gap <= GAP:
            break
    return best


def _split_on(problem: BoundedProblem, last: _Enclosure) -> _Enclosure:
    """Return an enclosure whose cells were split as long as that brings its two times closer."""
    for _ in range(LAST_SPLITS):
        timely = _retimed(problem, last)
        kept, relaxed = sharpened(problem, timely.kept, timely.relaxed, largest=SPLIT_LARGEST)
        measure = relaxed.measure
        value = dual_value(problem, stretches(problem, measure), measure.atoms).value
        gap = _enclosed_gap(problem, value, kept, relaxed)
        if relaxed is last.relaxed or (timely is last and gap > WORTHWHILE * last.gap):
            break
        last = _Enclosure(kept=kept, relaxed=relaxed, gap=gap)
    return last


def _retimed(problem: BoundedProblem, one: _Enclosure) -> _Enclosure:
    """Return an enclosure at the t_f that it calls for, where that moves its switches notably."""
    if abs(one.kept.reach - 1.0) < TIMELY:
        return one
    t_f = later(one.kept.layout, one.kept)
    kept, relaxed = (
        solve_mesh(
            problem,
            form.layout.stretched(t_f),
            relaxed=form is one.relaxed,
            start=form.basis,
            solvable=True,
        )
        for form in (one.kept, one.relaxed)
    )
    if kept is None or relaxed is None:
        return one
    return _Enclosure(kept=replace(kept, slope=one.kept.slope), relaxed=relaxed, gap=inf)


def _kept(problem: BoundedProblem, sight: Sight, *, most: float, first: bool) -> MeshOptimum | None:
    """Return the restriction on the first mesh on which there is one, at most of a given effort.

    Where the cores reach beyond the arcs, they get more room; or there are fewer of them.
    """
    largest = FIRST_LARGEST if first else min(LARGEST, most)
    few = problem.has_high_order and not first
    tried: list[tuple[Core, ...]] = []
    for room, share in FEWER_CORES if few else CORES:
        spaced = replace(sight, room=sight.room * room, least_core=share)
        layout = _laid_out(problem, spaced, largest)
        if (layout.effort > most and not first) or layout.cores in tried:
            continue
        tried.append(layout.cores)
        kept = exchange(problem, layout)
        if kept is not None and (first or kept.reach > 1.0 - SETBACK):
            return kept
    return None


def _laid_out(problem: BoundedProblem, sight: Sight, largest: float) -> Layout:
    """Return the finest layout of at most some effort, or the coarsest there is."""
    for ease in EASES:
        layout = lay_out(problem, replace(sight, ease=ease))
        if layout.effort < largest:
            break
    return layout
