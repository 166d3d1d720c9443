"""What a bounded control is made of: bang arcs, boundary arcs and touch points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.places import ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.closed_form import step_response, transition

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


def piece_states(problem: BoundedProblem, piece: Piece, state: Array, tau: Array) -> Array:
    """Return the states on a piece."""
    if piece.limit < 0:
        pushes = step_response(problem.plant, tau) * piece.side * problem.force_limit
        return np.asarray(transition(problem.plant, tau) @ state + pushes)
    flow = problem.limits[piece.limit].boundary_flow.over(float(tau[1] - tau[0]))
    states = [state]
    for _ in tau[1:]:
        states.append(flow @ states[-1])
    return np.array(states)


def peaks_above(levels: Array, least: float) -> list[tuple[int, int]]:
    """Return (sample, signal) of the inner peaks of magnitude above a level.

    Examples
    --------
    >>> peaks_above(np.array([[0.0], [-2.0], [0.0], [1.0], [0.5]]), 1.5)
    [(1, 0)]
    """
    size = np.abs(levels)
    inner = size[1:-1]
    peaks = (inner > least) & (inner >= size[:-2]) & (inner > size[2:])
    return [(int(at) + 1, int(k)) for at, k in zip(*np.nonzero(peaks), strict=True)]


def flow_bang(problem: BoundedProblem, state: Array, side: int, span: float) -> Array:
    """Return the state after a bang arc, or before it where the span is negative."""
    plant, push = problem.plant, side * problem.force_limit
    flow = transition(plant, np.array(span))
    if span >= 0.0:
        return np.asarray(flow @ state + step_response(plant, np.array(span)) * push)
    # The response to a step is 0 before it: run it backwards from the state before.
    return np.asarray(flow @ (state - step_response(plant, np.array(-span)) * push))


def touch_points(sequence: Sequence) -> tuple[ConstraintPoint, ...]:
    """Return the touch points of a sequence by remaining time."""
    ends = np.cumsum([piece.duration for piece in sequence.pieces])
    starts = ends - [piece.duration for piece in sequence.pieces]
    return tuple(
        ConstraintPoint(
            remaining=float(ends[-1] - (starts[touch.piece] + touch.offset)),
            limit=touch.limit,
            side=touch.side,
        )
        for touch in sequence.touches
    )
