"""An exact sequence from a guess: solved, judged, and edited while its conditions call for it."""

from __future__ import annotations

from collections import Counter

from mtcommission.optimal.bounded.newton.edits import (
    pruned,
    with_short_arc,
    with_switches,
    with_touch,
)
from mtcommission.optimal.bounded.newton.extremal import Extremal, solve_sequence
from mtcommission.optimal.bounded.newton.off_boundary import with_subarc
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.proof.accepted import Found, proved
from mtcommission.optimal.bounded.proof.motion import follow_control
from mtcommission.optimal.bounded.structure.arcs import sequence_arcs
from mtcommission.optimal.bounded.structure.sequence import Sequence, touch_points


def holds_high_order(problem: BoundedProblem, guess: Sequence) -> bool:
    """Return whether a sequence holds a bound of an order above 2, for which it has no end."""
    return any(p.limit >= 0 and problem.limits[p.limit].order > 2 for p in guess.pieces)


def solve_exactly(problem: BoundedProblem, guess: Sequence) -> Found | None:
    """Return the accepted extremal of a sequence, edited while its conditions call for it."""
    settings = problem.settings.newton
    seen: Counter[tuple[tuple[int, ...], ...]] = Counter()
    best: Found | None = None
    for _ in range(settings.edits):
        # An edit may lead back to a sequence with better durations, but not in circles.
        seen[_shape(guess)] += 1
        if seen[_shape(guess)] > settings.visits or not _may_be_solved(problem, guess):
            break
        extremal = solve_sequence(problem, guess)
        found = accepted(problem, extremal)
        if found is not None and (best is None or found.gap < best.gap):
            best = _simplest(problem, extremal, found)
        # An accepted sequence with a gap left still breaks a condition, if by little.
        edited = (
            _edited(problem, extremal) if found is None or found.gap > settings.closed_gap else None
        )
        if edited is None:
            break
        guess = edited
    return best


def _may_be_solved(problem: BoundedProblem, guess: Sequence) -> bool:
    """Return whether there are equations for all pieces, and digits enough to solve them."""
    if holds_high_order(problem, guess) or guess.pieces[-1].limit >= 0:
        return False
    arcs = [piece for piece in guess.pieces if piece.limit >= 0]
    return all(
        problem.limits[p.limit].growth * p.duration <= problem.settings.structure.most_growth
        for p in arcs
    )


def _shape(sequence: Sequence) -> tuple[tuple[int, ...], ...]:
    """Return what tells two sequences apart, the durations left out."""
    pieces = tuple((piece.limit, piece.side) for piece in sequence.pieces)
    touches = tuple((touch.piece, touch.limit, touch.side) for touch in sequence.touches)
    return (*pieces, (-2, -2), *touches)


def _edited(problem: BoundedProblem, extremal: Extremal) -> Sequence | None:
    settings = problem.settings.newton
    edited = pruned(problem, extremal, least=settings.vanished)
    if edited is not None or extremal.residual > settings.residual:
        return edited
    # What the multipliers call for comes first: the motion is that of another sequence then.
    for edit in (with_subarc, with_switches, with_short_arc, with_touch):
        edited = edit(problem, extremal)
        if edited is not None:
            return edited
    return None


def _simplest(problem: BoundedProblem, extremal: Extremal, found: Found) -> Found:
    """Return the same optimum without slivers, which a sequence may hold at no cost."""
    guess = pruned(problem, extremal, least=problem.settings.newton.sliver)
    if guess is None:
        return found
    simpler = accepted(problem, solve_sequence(problem, guess))
    return found if simpler is None else simpler


def accepted(problem: BoundedProblem, extremal: Extremal) -> Found | None:
    """Return the control of a solved sequence with its proof, or None."""
    sequence = extremal.sequence
    if (
        extremal.residual > problem.settings.newton.residual
        or min(p.duration for p in sequence.pieces) <= 0.0
    ):
        return None
    arcs = sequence_arcs(problem, sequence)
    motion = follow_control(problem.plant, arcs, rate=problem.rate, settings=problem.settings.proof)
    return proved(problem, motion, extremal.measure, touch_points(sequence), exact=True)
