"""What a bounded control is made of: bang arcs, boundary arcs and touch points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.closed_form import step_response, transition
from mtcommission.optimal.problem import Atom, BoundedProblem
from mtcommission.optimal.solution import Arc, Bang, Boundary, constant_arc

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A bang arc or a boundary arc."""

    limit: int  # Index of the bound held; -1 on a bang arc
    side: int  # Sign of the force, or of the bounded signal
    duration: float  # [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """A touch point inside a bang arc, or inside a boundary arc of order 1."""

    piece: int  # Index of the arc
    offset: float  # Time since its start [s]
    limit: int  # Index of the bound
    side: int  # +1 or -1


@dataclass(frozen=True, slots=True, kw_only=True)
class Sequence:
    """Pieces in order of time, with the touch points."""

    pieces: tuple[Piece, ...]  # Bang and boundary arcs
    touches: tuple[Touch, ...]  # Touch points

    @property
    def t_f(self) -> float:
        """Sum of the durations [s]."""
        return sum(piece.duration for piece in self.pieces)


def piece_end(problem: BoundedProblem, piece: Piece, state: Array) -> Array:
    """Return the state at the end of a piece that begins in a state."""
    if piece.limit >= 0:
        return problem.limits[piece.limit].boundary_flow.over(piece.duration) @ state
    since = np.array(piece.duration)
    push = step_response(problem.plant, since) * piece.side * problem.force_limit
    return np.asarray(transition(problem.plant, since) @ state + push)


def touch_points(sequence: Sequence) -> tuple[Atom, ...]:
    """Return the touch points of a sequence by remaining time."""
    ends = np.cumsum([piece.duration for piece in sequence.pieces])
    starts = ends - [piece.duration for piece in sequence.pieces]
    return tuple(
        Atom(
            remaining=float(ends[-1] - (starts[touch.piece] + touch.offset)),
            limit=touch.limit,
            weight=float(touch.side),
        )
        for touch in sequence.touches
    )


def sequence_arcs(problem: BoundedProblem, sequence: Sequence) -> tuple[Arc, ...]:
    """Return the arcs of a sequence of bang and boundary arcs."""
    state, start, arcs = np.zeros(problem.plant.order), 0.0, list[Arc]()
    for piece in sequence.pieces:
        end = start + piece.duration
        if piece.limit < 0:
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
