"""Off-boundary subarcs: a bound is left where its multiplier has a density of the wrong sign.

There it pays to leave the bound for a while: away from it, towards it, and (order 2) away again. A
subarc that would go beyond the bound on the other side holds that one instead, over the zone: there
its multiplier has the right sign.

How long a subarc is follows from the multipliers alone. Inside it μ = 0, so σ^(r) is the density ν
that the arc would have, ν ∝ s² - z² about the middle of the wrong zone of half-width z. For
order 2 the force is turned at a quarter and three quarters of the subarc, and σ = 0 there and at
its ends: its length is sqrt(19.2) z. For order 1 it is turned in the middle: sqrt(12) z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.polish.newton import Extremal
from mtcommission.optimal.polish.sequence import Piece, Sequence, piece_states
from mtcommission.optimal.problem import BoundedProblem
from mtcommission.optimal.proof import Measure, densities, stretches

Array = NDArray[np.float64]


SUBARC_LENGTH = {1: sqrt(12.0), 2: sqrt(19.2)}
"""Length of a subarc over half the width of the zone of wrong density, by order."""
SUBARC_PATTERN = {1: (-1, 1), 2: (-1, 1, -1)}
"""Directions of the force in a subarc: +1 is towards the bound."""
SWING_PATTERN = {1: (1,), 2: (1, -1)}
"""Directions of the force from one side of a bound to the other: +1 is towards where it goes."""


SMALL_DENSITY = 1e-8
"""Share of the largest density below which a wrong sign is rounding."""
ROOM, SHORTEST = 0.95, 1e-8
"""Largest share of a boundary arc beside the middle of a zone that half a subarc may take, and the
share of t_f below which there is no room for one."""
LONGEST_SWING = 5.0
"""Longest way from one side of a bound to the other, in what the force alone would take for it."""
STEPS, DIFFERENCE, SAMPLES = 8, 1e-6, 9
"""Newton steps for the durations, relative step of their difference quotients, and samples of each
bang arc that look for the other side."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DensityZone:
    """Where a density has the wrong sign, between remaining times start > end [s]."""

    start: float
    end: float
    lowest: float  # Where it is most wrong [s]
    depth: float  # The density there, negative


def negative_zones(problem: BoundedProblem, measure: Measure) -> tuple[DensityZone, ...]:
    """Return where holding a bound costs time: the density has the wrong sign."""
    zones: list[DensityZone] = []
    for part in stretches(problem, measure):
        if part.limit < 0:
            continue
        middle = 0.5 * (part.start + part.end)
        side = next(interior.side for interior in measure.interiors if interior.holds(middle))
        density = side * densities(problem, part)[0]
        tau = np.linspace(part.end, part.start, density.size)
        wrong = density < -SMALL_DENSITY * np.abs(density).max()
        edges = np.flatnonzero(np.diff(np.pad(wrong.astype(np.int8), 1)))
        for first, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            low = first + int(np.argmin(density[first:stop]))
            zones.append(
                DensityZone(
                    start=_crossing(tau, density, stop - 1, stop),
                    end=_crossing(tau, density, first, first - 1),
                    lowest=float(tau[low]),
                    depth=float(density[low]),
                )
            )
    return tuple(zones)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    """Index and start of a piece, middle and half-length of the subarc in it [s]."""

    index: int
    start: float
    middle: float
    half: float


def _crossing(tau: Array, density: Array, wrong: int, right: int) -> float:
    """Return where the density changes sign between two samples; the first where there is one."""
    if not 0 <= right < tau.size:
        return float(tau[wrong])
    share = density[wrong] / (density[wrong] - density[right])
    return float(tau[wrong] + np.clip(share, 0.0, 1.0) * (tau[right] - tau[wrong]))


def with_subarc(problem: BoundedProblem, extremal: Extremal) -> Sequence | None:
    """Return the sequence with a subarc where the density of a multiplier is most wrong."""
    zones = negative_zones(problem, extremal.measure)
    if not zones:
        return None
    worst = min(zones, key=lambda zone: zone.depth)
    place = _place(problem, extremal.sequence, worst)
    if place is None:
        return None
    piece = extremal.sequence.pieces[place.index]
    state = _state_at(problem, extremal.sequence, place.middle - place.half)
    subarc = _subarc(problem, piece, state, 2.0 * place.half)
    if subarc is None or not _crosses(problem, piece, state, subarc):
        return None if subarc is None else _inserted(extremal.sequence, place, subarc)
    return _with_excursion(problem, extremal.sequence, place, worst)


def _crosses(problem: BoundedProblem, held: Piece, state: Array, subarc: tuple[Piece, ...]) -> bool:
    """Return whether a subarc goes beyond the bound on the other side."""
    row = problem.limits[held.limit].row * held.side
    for piece in subarc:
        states = piece_states(
            problem,
            piece,
            state,
            np.linspace(0.0, piece.duration, SAMPLES),
        )
        if float((states @ row).min()) < -1.0:
            return True
        state = states[-1]
    return False


def _with_excursion(
    problem: BoundedProblem, sequence: Sequence, place: _Place, zone: DensityZone
) -> Sequence | None:
    """Return the sequence with the bound on the other side held over a zone, or None."""
    piece, t_f = sequence.pieces[place.index], sequence.t_f
    other = replace(piece, side=-piece.side)
    middle, width = t_f - 0.5 * (zone.start + zone.end), zone.start - zone.end
    way = _swing(problem, other, _state_at(problem, sequence, middle - 0.5 * width))
    if way is None:
        return None
    taken = sum(span.duration for span in way)
    start = middle - 0.5 * (width + taken)
    if taken >= width or start < place.start:
        return None
    there = _swing(problem, other, _state_at(problem, sequence, start))
    if there is None:
        return None
    hold = replace(other, duration=width - sum(span.duration for span in there))
    state = _state_at(problem, sequence, start)
    for part in (*there, hold):
        state = piece_states(problem, part, state, np.array([0.0, part.duration]))[-1]
    back = _swing(problem, piece, state)
    if back is None:
        return None
    parts = (*there, hold, *back)
    half = 0.5 * sum(part.duration for part in parts)
    if start + 2.0 * half > place.start + piece.duration:
        return None
    moved = replace(place, middle=start + half, half=half)
    return _inserted(sequence, moved, parts)


def _swing(problem: BoundedProblem, goal: Piece, state: Array) -> tuple[Piece, ...] | None:
    """Return the bang arcs from one side of a bound to the other, where it is to be held."""
    limit = problem.limits[goal.limit]
    sides = [goal.side * int(np.sign(limit.gain)) * way for way in SWING_PATTERN[limit.order]]

    def miss(spans: Array) -> Array:
        after = state
        for side, span in zip(sides, spans.tolist(), strict=True):
            after = _driven(problem, after, side, span)
        return limit.missed(after, goal.side)

    # Two of the bound by the force alone: once or twice integrated.
    rate = abs(limit.gain) * problem.force_limit * problem.rate ** (limit.order - 1)
    first = np.full(limit.order, (2.0 / rate) ** (1.0 / limit.order))
    spans = _spans(
        miss,
        first,
        longest=LONGEST_SWING * float(first.sum()),
    )
    return None if spans is None else _bangs(sides, spans)


def _bangs(sides: list[int], spans: Array) -> tuple[Piece, ...] | None:
    """Return bang arcs; None unless all of them have a length."""
    if not np.all(spans > 0.0):
        return None
    return tuple(
        Piece(limit=-1, side=side, duration=span)
        for side, span in zip(sides, spans.tolist(), strict=True)
    )


def _place(problem: BoundedProblem, sequence: Sequence, zone: DensityZone) -> _Place | None:

    ends = np.cumsum([piece.duration for piece in sequence.pieces])
    middle = float(ends[-1]) - zone.lowest
    index = int(np.searchsorted(ends, middle))
    piece = sequence.pieces[index]
    start = float(ends[index]) - piece.duration
    order = 0 if piece.limit < 0 else problem.limits[piece.limit].order
    if order not in SUBARC_LENGTH:
        return None
    room = ROOM * min(middle - start, float(ends[index]) - middle)
    half = min(0.25 * SUBARC_LENGTH[order] * (zone.start - zone.end), room)
    if half < SHORTEST * float(ends[-1]):
        return None
    return _Place(index=index, start=start, middle=middle, half=half)


def _state_at(problem: BoundedProblem, sequence: Sequence, t: float) -> Array:
    state, left = np.zeros(problem.plant.order), t
    for piece in sequence.pieces:
        span = min(piece.duration, left)
        state = piece_states(problem, piece, state, np.array([0.0, span]))[-1]
        left -= span
        if left <= 0.0:
            break
    return state


def _subarc(
    problem: BoundedProblem, piece: Piece, state: Array, length: float
) -> tuple[Piece, ...] | None:
    """Return the bang arcs of a subarc of given length that ends on the bound, or None."""
    limit = problem.limits[piece.limit]
    sides = [piece.side * int(np.sign(limit.gain)) * way for way in SUBARC_PATTERN[limit.order]]

    def miss(first: Array) -> Array:
        after = state
        for side, span in zip(sides, [*first.tolist(), length - float(first.sum())], strict=True):
            after = _driven(problem, after, side, span)
        return limit.missed(after, piece.side)

    shares = np.full(len(sides), 0.5)
    shares[[0, -1]] = 0.5 / limit.order
    spans = _spans(miss, shares[:-1] * length, longest=length)
    return None if spans is None else _bangs(sides, np.append(spans, length - float(spans.sum())))


def _spans(miss: Callable[[Array], Array], first: Array, *, longest: float) -> Array | None:
    """Return the durations without a miss by Newton's method, or None where one is too long."""
    step = DIFFERENCE * longest
    for _ in range(STEPS):
        value = miss(first)
        columns = [(miss(first + step * unit) - value) / step for unit in np.eye(first.size)]
        first = first - np.linalg.lstsq(np.column_stack(columns), value, rcond=None)[0]
        if not np.abs(first).max() < longest:
            return None
    return first


def _inserted(sequence: Sequence, place: _Place, parts: tuple[Piece, ...]) -> Sequence:
    """Return the sequence with pieces put into a boundary arc."""
    piece, added = sequence.pieces[place.index], 1 + len(parts)
    before = place.middle - place.half - place.start
    after = piece.duration - before - sum(part.duration for part in parts)
    pieces = [replace(piece, duration=before), *parts, replace(piece, duration=after)]
    return Sequence(
        pieces=(*sequence.pieces[: place.index], *pieces, *sequence.pieces[place.index + 1 :]),
        touches=tuple(
            replace(touch, piece=touch.piece + added) if touch.piece > place.index else touch
            for touch in sequence.touches
            if touch.piece != place.index
        ),
    )


def _driven(problem: BoundedProblem, state: Array, side: int, span: float) -> Array:
    """Return the state after a bang arc."""
    piece = Piece(limit=-1, side=side, duration=span)
    return np.asarray(piece_states(problem, piece, state, np.array([0.0, span]))[-1])
