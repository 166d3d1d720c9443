"""From a sequence of pieces to the arcs of a control, and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.structure.sequence import Piece, Sequence
from mtcommission.optimal.closed_form import step_response, transition
from mtcommission.optimal.solution import Arc, constant_arc

Array = NDArray[np.float64]


def arc_piece(problem: BoundedProblem, arc: Arc) -> Piece:
    """Return an arc of a control as a piece of a sequence, by its label.

    Parameters
    ----------
    problem
        Holds the bound that the label names.
    arc
        Bang or boundary arc.

    Returns
    -------
    Piece
    """
    kind, _, rest = arc.control.partition(":")
    names = [limit.bound.name for limit in problem.limits]
    return Piece(
        limit=names.index(rest.partition(":")[0]) if kind == "boundary" else -1,
        side=-1 if arc.control.endswith("-") or arc.control.startswith("-") else 1,
        duration=arc.t_end - arc.t_start,
    )


def sequence_arcs(problem: BoundedProblem, sequence: Sequence) -> tuple[Arc, ...]:
    """Return the arcs of a sequence of bang and boundary arcs.

    Parameters
    ----------
    problem
        The bounded problem.
    sequence
        All durations >= 0.

    Returns
    -------
    tuple of Arc
    """
    plant, F = problem.plant, problem.force_limit
    state, start, arcs = np.zeros(plant.order), 0.0, []
    for piece in sequence.pieces:
        end, since = start + piece.duration, np.array(piece.duration)
        if piece.limit < 0:
            label = "+F_max" if piece.side > 0 else "-F_max"
            arcs.append(constant_arc(start, end, control=label, force=piece.side * F))
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
    side = "+" if float(limit.row @ state) > 0.0 else "-"
    return Arc(
        t_start=start,
        t_end=end,
        control=f"boundary:{limit.bound.name}:{side}",
        generator=flow.generator,
        initial=flow.chart @ state,
        output=limit.feedback @ flow.inverse,
    )
