"""A first sequence where the force itself is bounded tightly.

If |F| <= f with f well below the force limit, F is all but bang-bang between ±f: it swings from
one bound to the other within T ln((F_max + f)/(F_max - f)), a fraction of the force lag. So the
sequence is that of the problem with force limit f and half that swing as force lag, with each
bang arc replaced by a boundary arc of F and each switch by the swing.
"""

from __future__ import annotations

from dataclasses import replace
from math import log

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.polish.sequence import Piece, Sequence
from mtcommission.optimal.problem import BoundedProblem
from mtcommission.optimal.solution import Arc, Boundary, Interior

TIGHT = 0.97
"""Share of the force limit below which a bound on F counts as tight (empirical)."""
PASSING = 1.5
"""Length of an arc, in force lags of the swift plant, up to which it only moves the force."""


def tight_force_bound(problem: BoundedProblem) -> int:
    """Return the index of a tight bound on a force behind a lag; -1 if there is none."""
    force = problem.plant.states[problem.plant.lagged]
    for index, limit in enumerate(problem.limits):
        if limit.bound.name in force and limit.bound.value < TIGHT * problem.force_limit:
            return index
    return -1


def swift_plant(problem: BoundedProblem, index: int) -> Plant:
    """Return the plant whose force lag is half the swing from one bound of F to the other."""
    plant, f = problem.plant, problem.limits[index].bound.value
    lag = 0.5 * _ramp(problem, -f, f)
    A = plant.A.copy()
    A[plant.force] *= plant.force_lag / lag
    return replace(plant, force_lag=lag, A=A, B=plant.B * (plant.force_lag / lag))


def force_sequence(problem: BoundedProblem, index: int, arcs: tuple[Arc, ...]) -> Sequence:
    """Return the sequence that follows the arcs of the swift plant."""
    f = problem.limits[index].bound.value
    short = PASSING * 0.5 * _ramp(problem, -f, f)
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
    return Sequence(pieces=(*pieces, *_swing(problem, level, 0.0)), touches=())


def _piece(problem: BoundedProblem, arc: Arc) -> Piece:
    names = [limit.bound.name for limit in problem.limits]
    held = names.index(arc.control.signal) if isinstance(arc.control, Boundary) else -1
    side = 1 if isinstance(arc.control, Interior) else arc.control.side
    return Piece(limit=held, side=side, duration=arc.t_end - arc.t_start)


def _ramp(problem: BoundedProblem, start: float, end: float) -> float:
    """Return the time in which full force takes F from start to end [s]."""
    full = problem.force_limit if end > start else -problem.force_limit
    return problem.plant.force_lag * log((full - start) / (full - end))


def _swing(problem: BoundedProblem, start: float, end: float) -> list[Piece]:
    if start == end:
        return []
    side = 1 if end > start else -1
    return [Piece(limit=-1, side=side, duration=_ramp(problem, start, end))]
