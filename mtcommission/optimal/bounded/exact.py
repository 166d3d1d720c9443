"""An exact sequence from a guess: solved, judged, and edited while its conditions call for it."""

from __future__ import annotations

from collections import Counter

from mtcommission.optimal.bounded.accept import Found, accepted
from mtcommission.optimal.bounded.arcs import Sequence
from mtcommission.optimal.bounded.dip import with_dip
from mtcommission.optimal.bounded.edit import (
    VANISHED,
    pruned,
    with_short_arc,
    with_switches,
    with_touch,
)
from mtcommission.optimal.bounded.layout import MOST_GROWTH
from mtcommission.optimal.bounded.newton import RESIDUAL, Extremal, solve_sequence
from mtcommission.optimal.bounded.problem import BoundedProblem

EDITS = 30
"""Changes of a sequence in one round: pieces taken out, dips and touch points put in."""
SHARP = 1e-9
"""Gap of an accepted sequence below which it is not edited any more."""
VISITS = 2
"""How often the same sequence is solved in one round: from durations of its own each time."""
SLIVER = 1e-6
"""Share of t_f of a piece that is taken out if the sequence can be solved without it."""


def holds_high_order(problem: BoundedProblem, guess: Sequence) -> bool:
    """Return whether a sequence holds a bound of an order above 2, for which it has no end."""
    return any(p.limit >= 0 and problem.limits[p.limit].order > 2 for p in guess.pieces)


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
    if holds_high_order(problem, guess) or guess.pieces[-1].limit >= 0:
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
    for edit in (with_dip, with_switches, with_short_arc, with_touch):
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
