"""What a bounded control is made of, and how multipliers show it.

Points where a bound acts and that follow each other cell by cell are a boundary arc, single
ones a touch point; between the arcs the force switches at the zeros of σ. Two facts of the
theory fill in what the mesh may hide: an arc of order 2 is entered and left by braking away
from the bound, an arc of order 1 is entered by driving towards it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.control import Arc, Bang, Boundary, constant_arc
from mtcommission.optimal.modes import driven
from mtcommission.optimal.problem import ArcInterior, Atom, BoundedProblem
from mtcommission.optimal.proof import Dual, Stretch, sigma_sign
from mtcommission.optimal.settings import SETTINGS

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Touch:
    """A bound that is touched and left at once."""

    limit: int  # Index of the bound
    side: int  # +1 or -1


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A bang arc or a boundary arc, or what is left of it from a touch point on."""

    limit: int  # Index of the bound held; -1 on a bang arc
    side: int  # Sign of the force, or of the bounded signal
    duration: float  # [s]
    touch: Touch | None = None  # Where it begins, if it goes on as the piece before


Pieces = tuple[Piece, ...]
"""Of a control, in order of time."""


def final_time(pieces: Pieces) -> float:
    """Return the sum of the durations [s]."""
    return sum(piece.duration for piece in pieces)


def piece_end(problem: BoundedProblem, piece: Piece, state: Array) -> Array:
    """Return the state at the end of a piece that begins in a state."""
    if piece.limit >= 0:
        return problem.limits[piece.limit].boundary_flow.over(piece.duration) @ state
    force, since = np.array(piece.side * problem.force_limit), np.array(piece.duration)
    return driven(problem.plant, state, force, since)


def touch_points(pieces: Pieces) -> tuple[Atom, ...]:
    """Return the touch points of a control by remaining time."""
    remaining = np.cumsum([piece.duration for piece in reversed(pieces)])[::-1].tolist()
    return tuple(
        Atom(remaining=at, limit=piece.touch.limit, weight=float(piece.touch.side))
        for at, piece in zip(remaining, pieces, strict=True)
        if piece.touch
    )


def sequence_arcs(problem: BoundedProblem, pieces: Pieces) -> tuple[Arc, ...]:
    """Return the bang and boundary arcs of a control; a touch point lies inside of one."""
    state, start, arcs = np.zeros(problem.plant.order), 0.0, list[Arc]()
    for piece in pieces:
        end = start + piece.duration
        if piece.touch:
            arcs[-1] = replace(arcs[-1], t_end=end)
        elif piece.limit < 0:
            force = piece.side * problem.force_limit
            arcs.append(constant_arc(start, end, control=Bang(piece.side), force=force))
        else:
            # As in Newton's method: what is missed at the entry would grow over the arc.
            held = problem.limits[piece.limit]
            state = state - held.impulses @ held.missed(state, piece.side)
            arcs.append(boundary_arc(problem, piece.limit, start, end, state=state))
        state, start = piece_end(problem, piece, state), end
    return tuple(arcs)


def boundary_arc(
    problem: BoundedProblem, index: int, start: float, end: float, *, state: Array
) -> Arc:
    """Return the arc that holds a bound from a state on it: F_set = K expm((A + B K) t) x."""
    limit, flow = problem.limits[index], problem.limits[index].boundary_flow
    side = 1 if float(limit.row @ state) > 0.0 else -1
    return Arc(
        t_start=start,
        t_end=end,
        control=Boundary(limit.bound.name, side),
        generator=flow.generator,
        initial=flow.chart @ state,
        output=limit.feedback @ flow.inverse,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """Arcs and touch points seen on a mesh."""

    arcs: tuple[ArcInterior, ...]  # Boundary arcs in order of time
    touches: tuple[Atom, ...]  # Single points, one for each cluster


def detect_structure(
    active: Sequence[Atom], mesh: Array, held: Sequence[ArcInterior] = ()
) -> Structure:
    """Return the arcs and touch points that active points form, with the interiors held."""
    arcs: list[ArcInterior] = []
    touches: list[Atom] = []
    every: list[Atom | ArcInterior] = [*active, *held]
    ordered = sorted(every, key=lambda at: (at.limit, at.side, _span(at)))
    for (limit, side), group in groupby(ordered, key=lambda at: (at.limit, at.side)):
        for chain in _chains(list(group), mesh):
            low, high = _span(chain[0])[0], _span(chain[-1])[1]
            wide = high - low >= 0.75 * SETTINGS.chain_points * local_cell(mesh, low)
            if any(isinstance(at, ArcInterior) for at in chain) or (
                len(chain) >= SETTINGS.chain_points and wide
            ):
                arcs.append(ArcInterior(start=high, end=low, limit=limit, side=side))
                continue
            points = [at for at in chain if isinstance(at, Atom)]
            weight = sum(at.weight for at in points)
            centre = sum(at.weight * at.remaining for at in points) / weight
            touches.append(Atom(remaining=centre, limit=limit, weight=weight))
    apart: list[ArcInterior] = []
    for arc in sorted(arcs, key=lambda arc: -arc.start):
        if not apart or arc.start < apart[-1].end:
            apart.append(arc)
            continue
        # The force holds one bound at a time: beside it the other is touched.
        touches += [
            Atom(remaining=end, limit=arc.limit, weight=float(arc.side))
            for end in (arc.start, arc.end)
        ]
    return Structure(arcs=tuple(apart), touches=tuple(touches))


def _span(at: Atom | ArcInterior) -> tuple[float, float]:
    """Return from which to which remaining time a bound is known to act [s]."""
    return (at.end, at.start) if isinstance(at, ArcInterior) else (at.remaining, at.remaining)


def _chains(points: list[Atom | ArcInterior], mesh: Array) -> list[list[Atom | ArcInterior]]:
    chains = [[points[0]]]
    for before, after in pairwise(points):
        low, high = _span(before)[1], _span(after)[0]
        # Beside a large cell, a touch point would become the end of an arc that is not there.
        if high - low <= SETTINGS.chain_gap * min(local_cell(mesh, at) for at in (low, high)):
            chains[-1].append(after)
        else:
            chains.append([after])
    return chains


def local_cell(mesh: Array, remaining: float) -> float:
    """Return the larger of the two cells beside a remaining time [s]."""
    i = int(np.clip(np.searchsorted(mesh, remaining), 1, mesh.size - 1))
    after = mesh[min(i + 1, mesh.size - 1)] - mesh[i]
    return float(max(after, mesh[i] - mesh[i - 1]))


def detect_sequence(
    problem: BoundedProblem,
    structure: Structure,
    dual: Dual,
    mesh: Array,
) -> Pieces:
    """Return the pieces that a dual point shows."""
    pieces: list[Piece] = []
    for way in _ways(problem, structure.arcs, dual.parts[0].start):
        edges = _edges(dual.zeros, way.start, way.end, mesh, first=not pieces)
        pieces += _bang_pieces(problem, dual.parts, edges, after=way.after, before=way.before)
        pieces += way.arc
    return with_touches(problem, tuple(pieces), structure.touches)


def plainest_sequence(problem: BoundedProblem, structure: Structure, dual: Dual) -> Pieces:
    """Return the fewest pieces that lead from arc to arc.

    Cells that are long against the time in which the force moves a signal across its bounds
    part arcs and turn the force more often than the optimum does.
    """
    arcs: list[ArcInterior] = []
    for arc in structure.arcs:
        if arcs and (arcs[-1].limit, arcs[-1].side) == (arc.limit, arc.side):
            arcs[-1] = replace(arcs[-1], end=arc.end)
        else:
            arcs.append(arc)
    pieces: list[Piece] = []
    for way in _ways(problem, arcs, dual.parts[0].start):
        edge = 0.01 * (way.start - way.end)
        first = way.after or sigma_sign(problem, dual.parts, way.start - edge)
        last = way.before or sigma_sign(problem, dual.parts, way.end + edge)
        sides = (first,) if first == last else (first, last)
        duration = (way.start - way.end) / len(sides)
        pieces += [Piece(limit=-1, side=side, duration=duration) for side in sides]
        pieces += way.arc
    return tuple(pieces)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Way:
    """What lies before an arc or, last, before the end."""

    start: float  # Remaining times start > end [s]
    end: float
    after: int  # Sign of the force that leaves the arc before, 0 at rest
    before: int  # And of the one that enters the next
    arc: tuple[Piece, ...]  # The arc, if any


def _ways(problem: BoundedProblem, arcs: Sequence[ArcInterior], start: float) -> Iterator[_Way]:
    after = 0
    for arc in arcs:
        towards = int(np.sign(problem.limits[arc.limit].gain)) * arc.side
        before = towards if problem.limits[arc.limit].order % 2 else -towards
        piece = Piece(limit=arc.limit, side=arc.side, duration=arc.start - arc.end)
        yield _Way(start=start, end=arc.start, after=after, before=before, arc=(piece,))
        start, after = arc.end, -towards
    yield _Way(start=start, end=0.0, after=after, before=0, arc=())


def _edges(zeros: Array, start: float, end: float, mesh: Array, *, first: bool) -> Array:
    """Return start, the zeros of σ between two arcs, end; zeros at the arcs' ends are noise."""
    high = start if first else start - local_cell(mesh, start)
    low = end + local_cell(mesh, end) if end > 0.0 else 0.0
    inner = zeros[(zeros > low) & (zeros < high)]
    return np.concatenate([[start], inner[::-1], [end]])


def _bang_pieces(
    problem: BoundedProblem, parts: tuple[Stretch, ...], edges: Array, *, after: int, before: int
) -> list[Piece]:
    sign = sigma_sign(problem, parts, 0.5 * (edges[0] + edges[1]))
    pieces = []
    for start, end in pairwise(edges.tolist()):
        pieces.append(Piece(limit=-1, side=sign, duration=start - end))
        sign = -sign
    short = 0.02 * float(edges[0] - edges[-1])
    if after and pieces[0].side != after:
        pieces.insert(0, Piece(limit=-1, side=after, duration=min(short, 1e-3 * parts[0].start)))
    if before and pieces[-1].side != before:
        pieces.append(Piece(limit=-1, side=before, duration=min(short, 1e-3 * parts[0].start)))
    return pieces


def with_touches(problem: BoundedProblem, pieces: Pieces, points: tuple[Atom, ...]) -> Pieces:
    """Return the pieces, parted at those points that can be touched inside of them."""
    for point in points:
        ends = np.cumsum([piece.duration for piece in pieces])
        t = float(ends[-1]) - point.remaining
        i = min(int(np.searchsorted(ends, t)), len(pieces) - 1)
        one, after = pieces[i], float(ends[i]) - t
        # An atom of order 1 would turn the force; inside an arc it may not disturb σ = 0.
        least = 1 if one.limit < 0 else problem.limits[one.limit].order
        if problem.limits[point.limit].order > least:
            touch = Touch(point.limit, point.side)
            first = replace(one, duration=one.duration - after)
            second = replace(one, duration=after, touch=touch)
            pieces = (*pieces[:i], first, second, *pieces[i + 1 :])
    return pieces
