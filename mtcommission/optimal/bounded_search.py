"""The search: first sight, adapted mesh, reading, exact sequence, proof.

Every round solves the program on a finer mesh, reads the structure from its multipliers and
tries to solve that structure exactly. A sequence is accepted on its merits alone: the motion
keeps force, bounds and target, and the multipliers prove that no control is faster.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded_accept import GAP, Found, accepted, on_mesh
from mtcommission.optimal.bounded_arcs import Sequence
from mtcommission.optimal.bounded_dip import with_dip
from mtcommission.optimal.bounded_dual import (
    Measure,
    Stretch,
    dual_value,
    negative_zones,
    stretches,
)
from mtcommission.optimal.bounded_edit import VANISHED, pruned, with_switches, with_touch
from mtcommission.optimal.bounded_exchange import LEAST_SLOPE, exchange, later, untenable
from mtcommission.optimal.bounded_layout import MOST_GROWTH, SHRINK, Sight, lay_out, off_arcs
from mtcommission.optimal.bounded_mesh import MeshOptimum, solve_mesh
from mtcommission.optimal.bounded_newton import RESIDUAL, Extremal, solve_sequence
from mtcommission.optimal.bounded_problem import BoundedProblem, impulse_response
from mtcommission.optimal.bounded_reading import Reading, local_cell, read_contacts, read_sequence
from mtcommission.optimal.bounded_rows import Contact, Layout

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
SETBACK = 1e-3
"""Reach below 1 on a finer mesh that betrays a core where the bound is not held."""
MOST_FILLED = 2000
"""Most points with which a core is read."""
EDITS = 30
"""Changes of a sequence in one round: pieces taken out, dips and touch points put in."""
SHARP = 1e-9
"""Gap of an accepted sequence below which it is not edited any more."""
VISITS = 2
"""How often the same sequence is solved in one round: from durations of its own each time."""
HIDDEN = 1e-8
"""What one cell may hide of the time, relative to it: a hundredth of the gap allowed."""
AGREED = 1e-6
"""Distance of the reaches of both forms from which on what is hidden is the rest of the gap."""
SPLINTER = 2e-4
"""Share of t_f of a piece that may be the ripple of a mesh: left out where it leads nowhere."""
SLIVER = 1e-6
"""Share of t_f of a piece that is taken out if the sequence can be solved without it."""
FINISHED = 2
"""Mesh controls that are finished at most; one with long cores may not reach full precision."""
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
        relaxed = solve_mesh(problem, replace(kept.layout, margin=0.0), relaxed=True)
        if relaxed is None:
            break
        sight, guess = _look(problem, kept, relaxed)
        exact = _exactly(problem, guess, relaxed.measure)
        if exact is not None:
            return exact
        gap = _enclosed_gap(problem, kept, relaxed)
        seen.append(_Enclosure(kept=kept, relaxed=relaxed, gap=gap))
        if gap < ENOUGH * GAP and _has_high_order(problem, guess):
            found = on_mesh(problem, kept, relaxed)
            if found is not None and found.gap <= GAP:
                return found
    return _best_on_mesh(problem, seen)


def _exactly(problem: BoundedProblem, guess: Sequence, measure: Measure) -> Found | None:
    """Return the extremal of what was read, or of the same without what a mesh makes up."""
    exact = solve_exactly(problem, guess)
    if exact is not None:
        return exact
    read = Extremal(sequence=guess, measure=measure, residual=inf)
    plainer = pruned(problem, read, least=SPLINTER)
    return None if plainer is None else solve_exactly(problem, plainer)


def _enclosed_gap(problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum) -> float:
    """Return the relative distance of the times that the two forms of a program give."""
    measure = relaxed.measure
    value = dual_value(problem, stretches(problem, measure), measure.atoms).value
    along = float(measure.terminal @ problem.target)
    if along == 0.0:
        return inf  # multipliers that do not weigh the move prove nothing of it
    reach = value / along
    return (reach - kept.reach) / max(kept.slope * kept.layout.t_f, LEAST_SLOPE)


def _best_on_mesh(problem: BoundedProblem, seen: list[_Enclosure]) -> Found | None:
    """Return the best mesh control that can be finished; the best multipliers prove them all."""
    best: Found | None = None
    if not seen:
        return None
    relaxed = min(seen, key=lambda one: abs(one.gap)).relaxed
    for one in sorted(seen, key=lambda one: abs(one.gap))[:FINISHED]:
        found = on_mesh(problem, one.kept, relaxed)
        if found is not None and (best is None or found.gap < best.gap):
            best = found
        if best is not None and best.gap <= GAP:
            break
    return best


def _kept(problem: BoundedProblem, sight: Sight, *, most: float, first: bool) -> MeshOptimum | None:
    """Return the restriction on the first mesh on which there is one, at most of a given effort.

    Where the cores reach beyond the arcs, they get more room; or there are fewer of them.
    """
    high = max(limit.order for limit in problem.limits) > 2
    for room, share in CORES if first or not high else FEWER_CORES:
        layout = lay_out(problem, replace(sight, room=room, least_core=share))
        if layout.effort > most and not first:
            continue
        kept = exchange(problem, layout)
        if kept is not None and (first or kept.reach > 1.0 - SETBACK):
            return kept
    return None


def _has_high_order(problem: BoundedProblem, guess: Sequence) -> bool:
    return any(p.limit >= 0 and problem.limits[p.limit].order > 2 for p in guess.pieces)


def _look(
    problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum
) -> tuple[Sight, Sequence]:
    """Return where the next mesh should be fine, and the sequence that the multipliers show."""
    measure = relaxed.measure
    parts = stretches(problem, measure)
    zeros = dual_value(problem, parts, measure.atoms).zeros
    mesh = _filled(relaxed.layout)
    reading = _read(relaxed, mesh, [])
    guess = read_sequence(problem, reading, parts, zeros, mesh)
    # A core is opened where holding the bound costs time, or cannot be done.
    zones = [(zone.end, zone.start) for zone in negative_zones(problem, measure)]
    split = _read(relaxed, mesh, [*zones, *untenable(problem, kept)])
    cells = np.array([local_cell(mesh, zero) for zero in zeros.tolist()])
    switches = off_arcs(zeros, split, room=1.5 * cells)
    if relaxed.reach - kept.reach < AGREED:
        # Near the end of an arc a zero is its ripple, unless much of σ hides in its cell.
        much = _hidden(problem, measure, parts, zeros, mesh) > HIDDEN
        switches = zeros[np.isin(zeros, switches) | much]
    apart = [
        t
        for i, t in enumerate(switches.tolist())
        if not i or t - switches[i - 1] > local_cell(mesh, t) / SHRINK
    ]
    t_f = kept.layout.t_f
    sight = Sight(t_f=t_f, mesh=mesh, reading=split, switches=np.array(apart))
    return sight.stretched(later(kept.layout, kept)), guess


def _hidden(
    problem: BoundedProblem,
    measure: Measure,
    parts: tuple[Stretch, ...],
    zeros: Array,
    mesh: Array,
) -> Array:
    """Return what the program misses of the time for each zero of σ: it sees |∫ σ| of a cell only.

    In relative terms, from the slope of σ at the zero: the smaller part of its cell counts twice.
    """
    starts = np.array([part.start for part in parts])[::-1]
    missed = []
    for zero in zeros.tolist():
        part = parts[len(parts) - 1 - min(int(np.searchsorted(starts, zero)), len(parts) - 1)]
        motion = impulse_response(problem.plant, np.array(zero - part.end))
        slope = abs(float(part.adjoint @ problem.plant.A @ motion))
        after = min(max(int(np.searchsorted(mesh, zero)), 1), mesh.size - 1)
        missed.append(slope * min(zero - mesh[after - 1], mesh[after] - zero) ** 2)
    along = abs(float(measure.terminal @ problem.target))
    return np.array(missed) * problem.force_limit / along


def _filled(layout: Layout) -> Array:
    """Return the mesh with even points in the cores, as close as the cells beside them."""
    ends = [end for core in layout.cores for end in (core.start, core.end)]
    mesh = np.unique(np.concatenate([[0.0, layout.t_f], layout.mesh, ends]))
    inner = [mesh]
    for core in layout.cores:
        at = np.searchsorted(mesh, [core.end, core.start])
        cell = min(mesh[at[0]] - mesh[at[0] - 1], mesh[at[1] + 1] - mesh[at[1]])
        count = int((core.start - core.end) / cell) + 2
        inner.append(np.linspace(core.end, core.start, min(count, MOST_FILLED))[1:-1])
    return np.unique(np.concatenate(inner))


def _read(relaxed: MeshOptimum, mesh: Array, zones: list[tuple[float, float]]) -> Reading:
    """Return arcs and touch points, zones of cores (remaining times of end and start) left out."""
    active = [contact for contact in relaxed.contacts if contact.weight > 0.0]
    for core in relaxed.layout.cores:
        active += [
            Contact(remaining=t, limit=core.limit, side=core.side, weight=1.0)
            for t in mesh[(mesh >= core.end) & (mesh <= core.start)].tolist()
            if not any(end <= t <= start for end, start in zones)
        ]
    return read_contacts(active, mesh)


def solve_exactly(problem: BoundedProblem, guess: Sequence) -> Found | None:
    """Return the accepted extremal of a sequence, edited while its conditions call for it.

    Parameters
    ----------
    problem
        The bounded problem.
    guess
        Sequence with approximate durations.

    Returns
    -------
    Found or None
    """
    seen: Counter[tuple[tuple[int, ...], ...]] = Counter()
    best: Found | None = None
    for _ in range(EDITS):
        # An edit may lead back to a sequence with better durations, but not in circles.
        seen[_shape(guess)] += 1
        if seen[_shape(guess)] > VISITS or not _may_be_solved(problem, guess):
            break
        extremal = solve_sequence(problem, guess)
        found = accepted(problem, extremal)
        if found is not None and (best is None or found.gap < best.gap):
            best = _simplest(problem, extremal, found)
        # An accepted sequence with a gap left still breaks a condition, if by little.
        edited = _edited(problem, extremal) if found is None or found.gap > SHARP else None
        if edited is None:
            break
        guess = edited
    return best


def _may_be_solved(problem: BoundedProblem, guess: Sequence) -> bool:
    """Return whether there are equations for all pieces, and digits enough to solve them."""
    if _has_high_order(problem, guess) or guess.pieces[-1].limit >= 0:
        return False
    arcs = [piece for piece in guess.pieces if piece.limit >= 0]
    return all(problem.limits[p.limit].growth * p.duration <= MOST_GROWTH for p in arcs)


def _shape(sequence: Sequence) -> tuple[tuple[int, ...], ...]:
    """Return what tells two sequences apart, the durations left out."""
    pieces = tuple((piece.limit, piece.side) for piece in sequence.pieces)
    touches = tuple((touch.piece, touch.limit, touch.side) for touch in sequence.touches)
    return (*pieces, (-2, -2), *touches)


def _edited(problem: BoundedProblem, extremal: Extremal) -> Sequence | None:
    edited = pruned(problem, extremal, least=VANISHED)
    if edited is not None or extremal.residual > RESIDUAL:
        return edited
    # What the multipliers call for comes first: the motion is that of another sequence then.
    for edit in (with_dip, with_switches, with_touch):
        edited = edit(problem, extremal)
        if edited is not None:
            return edited
    return None


def _simplest(problem: BoundedProblem, extremal: Extremal, found: Found) -> Found:
    """Return the same optimum without slivers, which a sequence may hold at no cost."""
    guess = pruned(problem, extremal, least=SLIVER)
    if guess is None:
        return found
    simpler = accepted(problem, solve_sequence(problem, guess))
    return found if simpler is None else simpler
