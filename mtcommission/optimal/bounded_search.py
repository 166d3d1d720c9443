"""The search: grid, adapted mesh, reading, exact sequence, proof.

Every round solves the program on a finer mesh, reads the structure from its multipliers and
tries to solve that structure exactly. A sequence is accepted on its merits alone: the motion
keeps force, bounds and target, and the multipliers prove that no control is faster.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded_arcs import (
    RESIDUAL,
    Extremal,
    Piece,
    Sequence,
    Touch,
    piece_states,
    solve_sequence,
)
from mtcommission.optimal.bounded_dual import (
    Core,
    Measure,
    dual_value,
    lower_bound,
    stretches,
)
from mtcommission.optimal.bounded_grid import SATURATED, GridOptimum
from mtcommission.optimal.bounded_mesh import (
    Contact,
    Layout,
    MeshOptimum,
    off_cores,
    settled,
    solve_mesh,
)
from mtcommission.optimal.bounded_motion import Motion, follow, mesh_arcs, sequence_arcs
from mtcommission.optimal.bounded_problem import BoundedProblem, step_response, transition
from mtcommission.optimal.bounded_reading import (
    Reading,
    place_touches,
    read_contacts,
    read_sequence,
)

Array = NDArray[np.float64]

ROUNDS = 5
"""Meshes tried; each is five times as fine at the features as the one before."""
SHRINK = 5.0
"""Factor between the finest cells of two rounds."""
BACKGROUND = 80
"""Cells of the background mesh."""
GROWTH = 1.7
"""Ratio of neighbouring cells away from a feature."""
CORE_MARGINS = (3.0, 15.0)
"""Distance of a core from the ends of its arc, in finest cells of the round before: for orders 1
and 2, and for higher orders, where touch points that crowd towards an arc look like its end."""
EXCHANGES = 6
"""Solutions of the program in one round, each with the points where the last broke a bound."""
MARGIN = 1e-9
"""Relative distance from the bounds kept on a mesh."""
BROKEN = 1e-6
"""Relative excess over a bound that calls for another point of the program; what is left is
covered by a margin."""
LEAST_SLOPE = 0.3
"""Least dα/dlog t_f believed: the marginal vanishes where the first cell hides a switch."""
LARGEST_CHANGE = 0.02
"""Largest relative change of t_f on one mesh."""
SHORT_ARC_POINTS = 60
"""Most points on an arc too short for a core."""
SHARPENINGS = 5
"""Solutions of the relaxation with the zeros of the last one as mesh points."""
VANISHED = 1e-8
"""Share of t_f below which a piece is taken out."""
EDITS = 6
"""Changes of a sequence in one round: pieces taken out, touch points put in."""
RADIANS_PER_SAMPLE = 0.05
"""Samples that look for excesses of a solved sequence."""
SLIVER = 1e-6
"""The same for a piece of a solved sequence, if the sequence can be solved without it."""
GAP = 1e-6
"""Largest relative distance of t_f from its proved lower bound."""
LOOSE_GAP = 1e-4
"""The same for a control on a mesh, which is returned with the gap that it has."""
ENOUGH = 0.7
"""Share of the gap at which a mesh is fine enough: finishing it costs a little."""
EXCESS = 1e-9
"""Largest relative excess over a bound or the force limit."""
TERMINAL = 1e-9
"""Largest terminal error of a state against its peak."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """An accepted control with its proof.

    Parameters
    ----------
    motion
        The control and what it does.
    measure
        The dual point that proves it.
    t_f, t_lower
        Achieved and excluded time [s].
    touches
        Touch points.
    exact
        Whether the arcs are exact; otherwise they are cells of a mesh.
    """

    motion: Motion
    measure: Measure
    t_f: float
    t_lower: float
    touches: tuple[Contact, ...]
    exact: bool

    @property
    def gap(self) -> float:
        """(t_f - t_lower) / t_f."""
        return (self.t_f - self.t_lower) / self.t_f


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Sight:
    """What one round has seen: features by remaining time."""

    t_f: float
    finest: float
    reading: Reading
    switches: Array


def search(problem: BoundedProblem, grid: GridOptimum) -> Found | None:
    """Return the best accepted control, or None.

    Parameters
    ----------
    problem
        The bounded problem.
    grid
        Where to start.

    Returns
    -------
    Found or None
        With a gap of at most ``GAP``, or ``LOOSE_GAP`` where only the mesh could be solved.
    """
    sight = _first_sight(problem, grid)
    nearest: _Enclosure | None = None
    for _ in range(ROUNDS):
        kept = _exchange(problem, _layout(problem, sight))
        if kept is None:
            # The cores reach beyond the arcs: look again with more room at their ends.
            sight = replace(sight, reading=_narrowed(problem, sight))
            continue
        relaxed = solve_mesh(problem, replace(kept.layout, margin=0.0), relaxed=True)
        if relaxed is None:
            break
        sight, guess = _look(problem, kept, relaxed, sight.finest / SHRINK)
        exact = _solve_exactly(problem, guess)
        if exact is not None:
            return exact
        if _has_high_order(problem, guess):
            relaxed = _sharpened(problem, relaxed)
        enclosure = _Enclosure(
            kept=kept, relaxed=relaxed, gap=_enclosed_gap(problem, kept, relaxed)
        )
        if nearest is None or enclosure.gap < nearest.gap:
            nearest = enclosure
        if enclosure.gap < ENOUGH * GAP and _has_high_order(problem, guess):
            found = _on_mesh(problem, kept, relaxed)
            if found is not None and found.gap <= GAP:
                return found
    return None if nearest is None else _on_mesh(problem, nearest.kept, nearest.relaxed)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Enclosure:
    """The two forms of one program and the relative distance of the times that they give."""

    kept: MeshOptimum
    relaxed: MeshOptimum
    gap: float


def _enclosed_gap(problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum) -> float:
    measure = relaxed.measure
    value = dual_value(problem, stretches(problem, measure), measure.atoms).value
    reach = value / float(measure.terminal @ problem.target)
    return (reach - kept.reach) / max(kept.slope * kept.layout.t_f, LEAST_SLOPE)


def _sharpened(problem: BoundedProblem, relaxed: MeshOptimum) -> MeshOptimum:
    """Return the relaxation on a mesh that has a point at each zero of its own σ.

    In a cell where σ changes sign the program sees less than ∫|σ|; with the zeros as mesh points
    the loss vanishes quadratically. No contacts are added, so it stays a relaxation.
    """
    for _ in range(SHARPENINGS):
        measure = relaxed.measure
        integral = dual_value(problem, stretches(problem, measure), measure.atoms)
        claim = float(measure.terminal @ problem.target)
        if integral.value / claim - relaxed.reach < 0.1 * GAP:
            break
        mesh = np.union1d(relaxed.layout.mesh, integral.zeros)
        apart = np.append(True, np.diff(mesh) > VANISHED * relaxed.layout.t_f)
        finer = solve_mesh(problem, replace(relaxed.layout, mesh=mesh[apart]), relaxed=True)
        if finer is None:
            break
        relaxed = finer
    return relaxed


def _has_high_order(problem: BoundedProblem, guess: Sequence) -> bool:
    return any(p.limit >= 0 and problem.limits[p.limit].order > 2 for p in guess.pieces)


def _first_sight(problem: BoundedProblem, grid: GridOptimum) -> _Sight:
    cell = grid.t_f / grid.force.size
    remaining = grid.t_f - cell * np.arange(1, grid.force.size + 1)
    active = [
        Contact(remaining=float(remaining[i]), limit=k, side=int(np.sign(levels[i])), weight=1.0)
        for k, levels in enumerate(grid.levels)
        for i in np.nonzero(np.abs(levels) > 1.0 - SATURATED)[0]
    ]
    reading = read_contacts(active, np.append(remaining[::-1], grid.t_f))
    loose = np.abs(grid.force) < 1.0 - SATURATED
    turning = np.append(False, grid.force[1:] * grid.force[:-1] < 0.0)
    switches = (remaining + 0.5 * cell)[loose | turning]
    return _Sight(
        t_f=grid.t_f,
        finest=cell,
        reading=reading,
        switches=_off_arcs(switches, reading, cell),
    )


def _off_arcs(switches: Array, reading: Reading, room: float) -> Array:
    inside = [(arc.end - room < switches) & (switches < arc.start + room) for arc in reading.arcs]
    return np.asarray(switches[~np.any([np.zeros(switches.size, dtype=bool), *inside], axis=0)])


def _narrowed(problem: BoundedProblem, sight: _Sight) -> Reading:
    arcs = tuple(
        replace(arc, start=arc.start - room, end=arc.end + room)
        for arc in sight.reading.arcs
        if arc.start - arc.end > 3.0 * (room := _room(problem, arc, sight))
    )
    return replace(sight.reading, arcs=arcs)


def _layout(problem: BoundedProblem, sight: _Sight) -> Layout:
    finest, background = sight.finest / SHRINK, sight.t_f / BACKGROUND
    cores = tuple(
        replace(arc, start=arc.start - room, end=arc.end + room)
        for arc in sight.reading.arcs
        if arc.start - arc.end > 2.0 * (room := _room(problem, arc, sight)) + 4.0 * finest
    )
    points = [np.arange(1, BACKGROUND) * background]
    ends = [end for arc in sight.reading.arcs for end in (arc.start, arc.end)]
    centres = [*sight.switches, *ends, *(touch.remaining for touch in sight.reading.touches)]
    points += [_graded(centre, finest, background) for centre in centres]
    for arc in sight.reading.arcs:
        if not any(core.start < arc.start and core.end > arc.end for core in cores):
            count = min(int((arc.start - arc.end) / (2.0 * finest)) + 3, SHORT_ARC_POINTS)
            points.append(np.linspace(arc.end, arc.start, count))
    mesh = _thinned(np.concatenate(points), 0.4 * finest, sight.t_f)
    near = 0.3 * finest
    clear = [(mesh < core.end - near) | (mesh > core.start + near) for core in cores]
    mesh = mesh[np.all([np.ones(mesh.size, dtype=bool), *clear], axis=0)]
    return Layout(
        t_f=sight.t_f,
        mesh=mesh,
        cores=cores,
        contacts=_contacts(problem, sight, mesh, cores),
        margin=MARGIN,
    )


def _room(problem: BoundedProblem, arc: Core, sight: _Sight) -> float:
    """Return the distance of a core from the ends of its arc [s]."""
    if problem.limits[arc.limit].order <= 2:
        return CORE_MARGINS[0] * sight.finest
    return min(CORE_MARGINS[1] * sight.finest, 0.25 * (arc.start - arc.end))


def _graded(centre: float, finest: float, background: float) -> Array:
    count = int(np.ceil(np.log(2.4 * background / finest) / np.log(GROWTH)))
    offsets = 0.5 * finest * GROWTH ** np.arange(count)
    return np.concatenate([centre - offsets, centre + offsets])


def _thinned(points: Array, distance: float, t_f: float) -> Array:
    ordered = np.unique(points[(points > distance) & (points < t_f - distance)])
    kept = [float(ordered[0])]
    for point in ordered[1:].tolist():
        if point - kept[-1] > distance:
            kept.append(point)
    return np.array(kept)


def _contacts(
    problem: BoundedProblem, sight: _Sight, mesh: Array, cores: tuple[Core, ...]
) -> tuple[Contact, ...]:
    """Return the mesh points where a bound may act: near arcs and touch points, ends of cores."""
    zones = [(arc.end, arc.start, 6.0, arc.limit, arc.side) for arc in sight.reading.arcs]
    zones += [
        (touch.remaining, touch.remaining, 4.0, touch.limit, touch.side)
        for touch in sight.reading.touches
    ]
    contacts = [
        Contact(remaining=t, limit=limit, side=side)
        for low, high, cells, limit, side in zones
        for t in mesh[(mesh > low - cells * sight.finest) & (mesh < high + cells * sight.finest)]
    ]
    contacts += [
        Contact(remaining=end, limit=core.limit, side=core.side)
        for core in cores
        for end in (core.start, core.end)
    ]
    return off_cores(problem, tuple(dict.fromkeys(contacts)), cores)


def _exchange(problem: BoundedProblem, layout: Layout) -> MeshOptimum | None:
    """Return the solution on the mesh with t_f such that the reach is 1."""
    found: MeshOptimum | None = None
    # While the mesh is coarse, more exactness at the bounds would be wasted.
    tolerance = max(BROKEN, 0.3 * float(np.diff(layout.mesh).min()) / layout.t_f)
    for _ in range(EXCHANGES):
        found = solve_mesh(problem, layout, relaxed=False)
        if found is None:
            return None
        broken = _broken(problem, found, tolerance=tolerance)
        in_time = abs(found.reach - 1.0) < 1e-4
        if not broken and in_time:
            break
        contacts = tuple(dict.fromkeys([*layout.contacts, *broken]))
        t_f = layout.t_f
        if not in_time:
            t_f = _later(layout, found)
        last = float(layout.mesh[-1]) if layout.mesh.size else 0.0
        layout = replace(layout, contacts=contacts, t_f=max(t_f, last * (1.0 + 1e-6)))
    return found


def _later(layout: Layout, found: MeshOptimum) -> float:
    """Return the t_f at which the reach should be 1, no further away than is safe."""
    change = (1.0 - found.reach) / max(found.slope * layout.t_f, LEAST_SLOPE)
    return layout.t_f * (1.0 + float(np.clip(change, -LARGEST_CHANGE, LARGEST_CHANGE)))


def _broken(problem: BoundedProblem, found: MeshOptimum, *, tolerance: float) -> list[Contact]:
    """Return where the motion of a mesh solution exceeds a bound by a relative tolerance."""
    plant, rows = problem.plant, problem.rows
    cells = [segment for segment in found.segments if segment.limit < 0]
    starts = np.array([found.state(cell.first) for cell in cells])
    force = found.unknowns[[cell.column for cell in cells]] * problem.force_limit
    lengths = np.array([cell.start - cell.end for cell in cells])
    shares = np.linspace(0.0, 1.0, 9)
    tau = lengths[:, np.newaxis] * shares
    states = np.einsum("ctij,cj->cti", transition(plant, tau), starts)
    states += step_response(plant, tau) * force[:, np.newaxis, np.newaxis]
    levels = states @ rows.T
    worst = np.abs(levels).argmax(axis=1)
    broken = []
    for cell, k in zip(*np.nonzero(np.abs(levels).max(axis=1) > 1.0 + tolerance), strict=True):
        at = worst[cell, k]
        t = _peak_time(levels[cell, :, k], int(at)) * lengths[cell] / (shares.size - 1)
        side = int(np.sign(levels[cell, at, k]))
        remaining = max(float(cells[cell].start - t), cells[cell].end)
        broken.append(Contact(remaining=remaining, limit=int(k), side=side))
    return list(off_cores(problem, tuple(broken), found.layout.cores))


def _peak_time(levels: Array, at: int) -> float:
    """Return the vertex of the parabola through the largest sample and its neighbours."""
    if at in (0, levels.size - 1):
        return float(at)
    before, here, after = levels[at - 1 : at + 2]
    bend = before - 2.0 * here + after
    return float(at + 0.5 * (before - after) / bend) if bend else float(at)


def _look(
    problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum, finest: float
) -> tuple[_Sight, Sequence]:
    layout = relaxed.layout
    parts = stretches(problem, relaxed.measure)
    zeros = dual_value(problem, parts, relaxed.measure.atoms).zeros
    ends = [end for core in layout.cores for end in (core.start, core.end)]
    mesh = np.unique(np.concatenate([[0.0, layout.t_f], layout.mesh, ends]))
    active = [contact for contact in relaxed.contacts if contact.weight > 0.0]
    dense: list[Array] = [mesh]
    for core in layout.cores:
        inner = np.linspace(core.end, core.start, int((core.start - core.end) / finest) + 2)
        dense.append(inner[1:-1])
        active += [
            Contact(remaining=float(t), limit=core.limit, side=core.side, weight=1.0) for t in inner
        ]
    mesh = np.unique(np.concatenate(dense))
    reading = read_contacts(active, mesh)
    guess = read_sequence(problem, reading, parts, zeros, mesh)
    switches = _off_arcs(zeros, reading, 1.5 * finest)
    apart = np.append(True, np.diff(switches) > finest / SHRINK)[: switches.size]
    t_f = _later(layout, kept)
    sight = _Sight(t_f=t_f, finest=finest, reading=reading, switches=switches[apart])
    return sight, guess


def _solve_exactly(problem: BoundedProblem, guess: Sequence) -> Found | None:
    """Return the accepted extremal of a sequence, vanishing pieces taken out, or None."""
    for _ in range(EDITS):
        if _has_high_order(problem, guess) or guess.pieces[-1].limit >= 0:
            return None
        extremal = solve_sequence(problem, guess)
        found = _accepted(problem, extremal)
        if found is not None:
            return _simplest(problem, extremal, found)
        guess, changed = _pruned(problem, extremal, least=VANISHED)
        if not changed and extremal.residual < RESIDUAL:
            guess, changed = _with_touches(problem, extremal.sequence)
        if not changed:
            return None
    return None


def _with_touches(problem: BoundedProblem, sequence: Sequence) -> tuple[Sequence, bool]:
    """Return the sequence with a touch point wherever it runs through a bound."""
    rows, state = problem.rows, np.zeros(problem.plant.order)
    touches = list(sequence.touches)
    for index, piece in enumerate(sequence.pieces):
        count = int(np.ceil(piece.duration * problem.rate / RADIANS_PER_SAMPLE)) + 4
        tau = np.linspace(0.0, piece.duration, count)
        states = piece_states(problem, piece, state, tau)
        levels, state = states @ rows.T, states[-1]
        magnitude = np.abs(levels)
        inner = magnitude[1:-1]
        peaks = (inner > 1.0 + EXCESS) & (inner >= magnitude[:-2]) & (inner > magnitude[2:])
        for at, k in zip(*np.nonzero(peaks), strict=True):
            if k != piece.limit:
                side = int(np.sign(levels[at + 1, k]))
                offset = float(tau[at + 1])
                touches.append(Touch(piece=index, offset=offset, limit=int(k), side=side))
    added = len(touches) > len(sequence.touches)
    return Sequence(pieces=sequence.pieces, touches=tuple(touches)), added


def _simplest(problem: BoundedProblem, extremal: Extremal, found: Found) -> Found:
    """Return the same optimum without slivers, which a sequence may hold at no cost."""
    guess, changed = _pruned(problem, extremal, least=SLIVER)
    if not changed:
        return found
    simpler = _accepted(problem, solve_sequence(problem, guess))
    return found if simpler is None else simpler


def _pruned(problem: BoundedProblem, extremal: Extremal, *, least: float) -> tuple[Sequence, bool]:
    sequence = extremal.sequence
    pieces: list[Piece] = []
    for piece in sequence.pieces:
        if piece.duration <= least * sequence.t_f:
            continue
        same = pieces and (pieces[-1].limit, pieces[-1].side) == (piece.limit, piece.side)
        if same:
            whole = pieces[-1].duration + piece.duration
            pieces[-1] = replace(pieces[-1], duration=whole)
        else:
            pieces.append(piece)
    contacts = _touch_contacts(sequence)
    weights = {atom.remaining: atom.weight for atom in extremal.measure.atoms}
    wanted = tuple(at for at in contacts if weights.get(at.remaining, 0.0) * at.side >= 0.0)
    t_f = sum(piece.duration for piece in pieces)
    inside = tuple(at for at in wanted if 0.0 < at.remaining < t_f)
    pruned = Sequence(pieces=tuple(pieces), touches=place_touches(problem, tuple(pieces), inside))
    return pruned, len(pieces) < len(sequence.pieces) or len(inside) < len(contacts)


def _touch_contacts(sequence: Sequence) -> tuple[Contact, ...]:
    ends = np.cumsum([piece.duration for piece in sequence.pieces])
    return tuple(
        Contact(
            remaining=float(
                ends[-1]
                - (ends[touch.piece] - sequence.pieces[touch.piece].duration + touch.offset)
            ),
            limit=touch.limit,
            side=touch.side,
        )
        for touch in sequence.touches
    )


def _accepted(problem: BoundedProblem, extremal: Extremal) -> Found | None:
    sequence = extremal.sequence
    if extremal.residual > RESIDUAL or min(p.duration for p in sequence.pieces) <= 0.0:
        return None
    motion = follow(problem.plant, sequence_arcs(problem, sequence), rate=problem.rate)
    return _proved(problem, motion, extremal.measure, _touch_contacts(sequence), exact=True)


def _on_mesh(problem: BoundedProblem, kept: MeshOptimum, relaxed: MeshOptimum) -> Found | None:
    """Return the mesh control itself, slowed down until it keeps the bounds everywhere."""
    layout, found = kept.layout, kept
    for attempt in range(EXCHANGES + 2):
        motion = _followed(problem, found)
        # A reach short of 1 has raised all levels by its inverse: that is lateness, not excess.
        excess = max(_levels(problem, motion)[:-1]) * found.reach - 1.0
        late = 1.0 - found.reach
        if excess < EXCESS and -1e-8 < late <= 0.0:
            touches = tuple(at for at in found.contacts if at.weight > 0.0)
            return _proved(problem, motion, relaxed.measure, touches, exact=False)
        t_f = _later(layout, found) + 2e-10 / max(found.slope, LEAST_SLOPE / layout.t_f)
        broken = _broken(problem, found, tolerance=BROKEN)
        margin = layout.margin + (1.1 * excess if excess > 0.0 and (attempt or not broken) else 0.0)
        contacts = tuple(dict.fromkeys([*layout.contacts, *broken]))
        layout = replace(layout, t_f=t_f, contacts=contacts, margin=margin)
        following = solve_mesh(problem, layout, relaxed=False)
        if following is None:
            return None
        found = following
    return None


def _followed(problem: BoundedProblem, found: MeshOptimum) -> Motion:
    """Return the motion of a mesh control whose terminal error is taken back once."""
    miss = np.zeros(problem.fixed.size)
    for _ in range(2):
        exact = settled(problem, found, miss=miss)
        motion = follow(problem.plant, mesh_arcs(problem, exact), rate=problem.rate)
        miss += (motion.final - problem.target)[problem.fixed]
    return motion


def _levels(problem: BoundedProblem, motion: Motion) -> list[float]:
    """Return the peaks of the bounded signals and of the force, relative to their bounds."""
    signals = problem.plant.signals
    peaks = [
        float(motion.peaks[signals.index(limit.bound.name)]) / limit.bound.value
        for limit in problem.limits
    ]
    return [*peaks, motion.force_peak / problem.force_limit]


def _proved(
    problem: BoundedProblem,
    motion: Motion,
    measure: Measure,
    touches: tuple[Contact, ...],
    *,
    exact: bool,
) -> Found | None:
    """Return the control with its proof if the motion keeps everything, else None."""
    error = np.abs(motion.final - problem.target)[problem.fixed]
    share = error / motion.peaks[: problem.plant.order][problem.fixed]
    if max(_levels(problem, motion)) > 1.0 + EXCESS or float(share.max()) > TERMINAL:
        return None
    t_f = motion.arcs[-1].t_end
    found = Found(
        motion=motion,
        measure=measure,
        t_f=t_f,
        t_lower=min(lower_bound(problem, measure), t_f),
        touches=touches,
        exact=exact,
    )
    return found if found.gap <= (GAP if exact else LOOSE_GAP) else None
