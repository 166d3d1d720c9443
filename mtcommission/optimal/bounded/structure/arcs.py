"""From a sequence of pieces to the arcs of a control, and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.structure.sequence import Piece, Sequence
from mtcommission.optimal.closed_form import step_response, transition
from mtcommission.optimal.solution import Arc, Bang, Boundary, Interior, constant_arc

Array = NDArray[np.float64]


def arc_piece(problem: BoundedProblem, arc: Arc) -> Piece:
    """Return an arc of a control as a piece of a sequence."""
    names = [limit.bound.name for limit in problem.limits]
    held = names.index(arc.control.signal) if isinstance(arc.control, Boundary) else -1
    side = 1 if isinstance(arc.control, Interior) else arc.control.side
    return Piece(limit=held, side=side, duration=arc.t_end - arc.t_start)


def sequence_arcs(problem: BoundedProblem, sequence: Sequence) -> tuple[Arc, ...]:
    """Return the arcs of a sequence of bang and boundary arcs."""
    plant, F = problem.plant, problem.force_limit
    state, start, arcs = np.zeros(plant.order), 0.0, []
    for piece in sequence.pieces:
        end, since = start + piece.duration, np.array(piece.duration)
        if piece.limit < 0:
            control = Bang(piece.side)
            arcs.append(constant_arc(start, end, control=control, force=piece.side * F))
            push = step_response(plant, since) * piece.side * F
            state = transition(plant, since) @ state + push
        else:
            # As in Newton's method: what is missed at the entry would grow over the arc.
            held = problem.limits[piece.limit]
            state = state - held.impulses @ held.missed(state, piece.side)
            arcs.append(boundary_arc(problem, piece.limit, start, end, state=state))
            state = held.boundary_flow.over(piece.duration) @ state
        start = end
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
