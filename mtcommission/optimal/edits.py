"""A solved sequence without what its conditions do not call for, and with its proof.

A piece that shrank to nothing, or a touch point with a multiplier of the wrong sign, is taken out;
a bound of order 1 exceeded where the force turns is held there for a while; one of order 2 is left
where its multiplier has the wrong sign. What a sequence lacks besides is not searched for: finer
cells show it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import groupby, pairwise
from math import log

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import Arc, Boundary, Interior
from mtcommission.optimal.newton import RESIDUAL, Extremal, solve_sequence
from mtcommission.optimal.problem import BoundedProblem
from mtcommission.optimal.proof import EXCESS, Found, held_with, prove, stretches
from mtcommission.optimal.sequence import (
    Piece,
    Pieces,
    final_time,
    piece_end,
    sequence_arcs,
    touch_points,
    with_touches,
)
from mtcommission.optimal.settings import SETTINGS

Array = NDArray[np.float64]


def holds_high_order(problem: BoundedProblem, guess: Pieces) -> bool:
    """Return whether a sequence holds a bound of an order above 2, for which it has no end."""
    return any(p.limit >= 0 and problem.limits[p.limit].order > 2 for p in guess)


def solve_exactly(problem: BoundedProblem, guess: Pieces) -> Found | None:
    """Return the accepted extremal of a sequence, edited while its conditions call for it."""
    best: Found | None = None
    # A guess may drive arcs over each other, as where a force turns before it is on its bound.
    following: Pieces | None = with_touches(problem, _shared(_whole(guess)), touch_points(guess))
    for _ in range(SETTINGS.edits):
        if following is None or not _may_be_solved(problem, following):
            break
        extremal = solve_sequence(problem, following)
        found = _accepted(problem, extremal)
        best = found or best
        following = _pruned(problem, extremal)
        if following is None and extremal.residual <= RESIDUAL:
            following = _with_short_arc(problem, extremal)
            if following is None and best is None:
                held = _with_held_touch(problem, extremal)
                following = held or _with_turn(problem, extremal)
    return best


def _may_be_solved(problem: BoundedProblem, guess: Pieces) -> bool:
    """Return whether there are equations for all pieces, and digits enough to solve them."""
    if holds_high_order(problem, guess) or guess[-1].limit >= 0:
        return False
    arcs = [piece for piece in guess if piece.limit >= 0]
    conditions = problem.fixed.size + sum(problem.limits[piece.limit].order for piece in arcs)
    if len(guess) < conditions or len(guess) > SETTINGS.most_pieces:
        return False
    return all(problem.limits[p.limit].growth * p.duration <= SETTINGS.most_growth for p in arcs)


def _accepted(problem: BoundedProblem, extremal: Extremal) -> Found | None:
    """Return the control of a solved sequence with its proof, or None."""
    pieces = extremal.pieces
    if extremal.residual > RESIDUAL or min(p.duration for p in _whole(pieces)) <= 0.0:
        return None
    arcs = sequence_arcs(problem, pieces)
    return prove(problem, arcs, extremal.measure, touch_points(pieces), is_exact=True)


def _pruned(problem: BoundedProblem, extremal: Extremal) -> Pieces | None:
    """Return the sequence without vanishing pieces and wrong touch points; None if it has none."""
    pieces, near = extremal.pieces, SETTINGS.vanished * final_time(extremal.pieces)
    whole, points = _whole(pieces), touch_points(pieces)
    weights = {atom.remaining: atom.weight for atom in extremal.measure.atoms}
    beside = [
        min(abs(one.duration), abs(two.duration)) for one, two in pairwise(pieces) if two.touch
    ]
    # A touch point that has come to an end of its piece is the atom of an arc there.
    right = tuple(
        point
        for point, room in zip(points, beside, strict=True)
        if weights.get(point.remaining, 0.0) * point.side >= 0.0 and room > near
    )
    kept = _whole(piece for piece in _shared(whole) if piece.duration > near)
    if len(kept) == len(whole) and len(right) == len(points):
        return None
    return with_touches(problem, kept, right)


def _shared(pieces: Pieces) -> Pieces:
    """Return the pieces with half of each negative duration taken from the pieces beside it."""
    spans = [piece.duration for piece in pieces]
    for i in range(1, len(spans) - 1):
        half = 0.5 * spans[i]
        if half < 0.0 and min(spans[i - 1], spans[i + 1]) > -half:
            spans[i - 1], spans[i], spans[i + 1] = spans[i - 1] + half, 0.0, spans[i + 1] + half
    shared = zip(pieces, spans, strict=True)
    return _whole(replace(piece, duration=span) for piece, span in shared if span != 0.0)


def _with_short_arc(problem: BoundedProblem, extremal: Extremal) -> Pieces | None:
    """Return the sequence with an arc where a bound of order 1 is exceeded most; None if nowhere.

    Such a bound cannot be touched by a smooth motion: it is exceeded where the force turns, and
    must be held there, however short.
    """
    plant, pieces = problem.plant, list(_whole(extremal.pieces))
    first = np.array([limit.order for limit in problem.limits]) == 1
    state, worst, most = np.zeros(plant.order), None, 1.0 + EXCESS
    for index, (piece, after) in enumerate(pairwise(pieces)):
        state = piece_end(problem, piece, state)
        levels = problem.rows @ state
        k = int(np.where(first, np.abs(levels), 0.0).argmax())
        size, side = abs(float(levels[k])), int(np.sign(levels[k]))
        if first[k] and max(piece.limit, after.limit) < 0 and size > most:
            rate = plant.A @ state + plant.B * piece.side * problem.force_limit
            speed = side * float(problem.rows[k] @ rate)
            half = min((size - 1.0) / speed, 0.5 * piece.duration, 0.5 * after.duration)
            worst, most = (index, half, k, side), size
    if worst is None:
        return None
    index, half, k, side = worst
    before, after = pieces[index], pieces[index + 1]
    pieces[index : index + 2] = [
        replace(before, duration=before.duration - half),
        Piece(limit=k, side=side, duration=2.0 * half),
        replace(after, duration=after.duration - half),
    ]
    return with_touches(problem, tuple(pieces), touch_points(extremal.pieces))


def _with_held_touch(problem: BoundedProblem, extremal: Extremal) -> Pieces | None:
    """Return the sequence with an arc for a touch point at which the force drives beyond the bound.

    There the signal is least, and beyond its bound before and after: an arc too short for cells.
    """
    pieces = extremal.pieces
    for index, (before, piece) in enumerate(pairwise(pieces)):
        touch = piece.touch
        if touch is None or piece.limit >= 0:
            continue
        limit = problem.limits[touch.limit]
        if limit.order == 2 and piece.side == int(np.sign(limit.gain)) * touch.side:
            span = before.duration + piece.duration
            arc = Piece(limit=touch.limit, side=touch.side, duration=span)
            return (*pieces[:index], arc, *pieces[index + 2 :])
    return None


def _with_turn(problem: BoundedProblem, extremal: Extremal) -> Pieces | None:
    """Return the sequence that leaves an arc of order 2 where holding it costs most; None if none.

    There the motion swings to the other side of the bound and holds that or, where too little
    time is left, turns back.
    """
    pieces = list(_whole(extremal.pieces))
    most, worst, end = 0.0, None, final_time(extremal.pieces)
    for index, piece in enumerate(pieces):
        end, middle = end - piece.duration, end - 0.5 * piece.duration
        if piece.limit < 0 or problem.limits[piece.limit].order != 2:
            continue
        for part in stretches(problem, extremal.measure):
            if part.end < middle < part.start:
                for start, stop, cost in held_with(problem, part, -piece.side):
                    if cost > most:
                        most, worst = cost, (index, stop - end, start - stop)
    if worst is None:
        return None
    index, late, length = worst
    held = pieces[index]
    limit = problem.limits[held.limit]
    towards = int(np.sign(limit.gain)) * held.side
    # Full force moves the signal from one bound to the other in twice this time.
    swing = (2.0 / (problem.force_limit * abs(limit.gain) * problem.rate)) ** 0.5
    swing = min(swing, 0.25 * length)
    away, back = (Piece(limit=-1, side=side, duration=swing) for side in (-towards, towards))
    other = Piece(limit=held.limit, side=-held.side, duration=length - 4.0 * swing)
    pieces[index : index + 1] = [
        replace(held, duration=held.duration - length - late),
        *([away, back, other, back, away] if other.duration > 0.0 else [away, back, back, away]),
        replace(held, duration=late),
    ]
    return with_touches(problem, _whole(pieces), touch_points(extremal.pieces))


def _whole(pieces: Iterable[Piece]) -> Pieces:
    """Return the pieces without touch points, those in a row that do the same as one."""
    runs = [tuple(run) for _, run in groupby(pieces, key=lambda piece: (piece.limit, piece.side))]
    return tuple(replace(run[0], duration=final_time(run), touch=None) for run in runs)


def tight_force_bound(problem: BoundedProblem) -> int:
    """Return the index of a tight bound on a force behind a lag; -1 if there is none."""
    force = problem.plant.states[problem.plant.lagged]
    for index, limit in enumerate(problem.limits):
        if limit.bound.name in force and limit.bound.value < SETTINGS.tight * problem.force_limit:
            return index
    return -1


def swift_plant(problem: BoundedProblem, index: int) -> Plant:
    """Return the plant whose force lag is half the swing from one bound of F to the other."""
    plant, f = problem.plant, problem.limits[index].bound.value
    lag = 0.5 * _ramp(problem, -f, f)
    A = plant.A.copy()
    A[plant.force] *= plant.force_lag / lag
    return replace(plant, force_lag=lag, A=A, B=plant.B * (plant.force_lag / lag))


def force_sequence(problem: BoundedProblem, index: int, arcs: tuple[Arc, ...]) -> Pieces:
    """Return the sequence that follows the arcs of the swift plant."""
    f = problem.limits[index].bound.value
    short = SETTINGS.passing * 0.5 * _ramp(problem, -f, f)
    level, pieces = 0.0, list[Piece]()
    for arc, following in zip(arcs, (*arcs[1:], None), strict=True):
        piece = _piece(problem, arc)
        is_bang = piece.limit < 0
        to_rest = following is None or isinstance(following.control, Boundary)
        if is_bang and to_rest and piece.duration < short:
            continue
        target = piece.side * f if is_bang else 0.0
        ramp = _swing(problem, level, target)
        hold = index if is_bang else piece.limit
        span = sum(swing.duration for swing in ramp)
        pieces += [*ramp, replace(piece, limit=hold, duration=piece.duration - span)]
        level = target
    return (*pieces, *_swing(problem, level, 0.0))


def _piece(problem: BoundedProblem, arc: Arc) -> Piece:
    names = [limit.bound.name for limit in problem.limits]
    held = names.index(arc.control.signal) if isinstance(arc.control, Boundary) else -1
    side = 1 if isinstance(arc.control, Interior) else arc.control.side
    return Piece(limit=held, side=side, duration=arc.t_end - arc.t_start)


def _ramp(problem: BoundedProblem, start: float, end: float) -> float:
    full = problem.force_limit if end > start else -problem.force_limit
    return problem.plant.force_lag * log((full - start) / (full - end))


def _swing(problem: BoundedProblem, start: float, end: float) -> list[Piece]:
    if start == end:
        return []
    side = 1 if end > start else -1
    return [Piece(limit=-1, side=side, duration=_ramp(problem, start, end))]
