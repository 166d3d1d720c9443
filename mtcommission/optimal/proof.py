"""What multipliers prove of a move under bounds, and what the motion under a control really does.

Let the remaining time be τ = t_f - t. Choose any row Λ for the terminal state and any signed
measure μ_k for each bound; with the impulse response g of the state,

    σ(τ) = Λ g(τ) - Σ_k ∫ c_k g(τ - τ') dμ_k(τ')

every admissible motion that reaches the target x_f at t_f obeys

    Λ x_f = ∫ σ F_set dτ + Σ_k ∫ c_k x dμ_k <= F ∫ |σ| dτ + Σ_k |μ_k|.

Whatever Λ and μ are: where the right side is smaller, t_f is too short. The best choice makes
both sides equal; then σ switches the force and μ lives where a bound is touched: atoms at touch
points and ends of boundary arcs, a density along the arcs ("interiors"), where σ = 0.

Nothing here knows how controls or multipliers were found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.optimal.control import (
    Arc,
    FollowedMotion,
    balanced_expm,
    follow_control,
    powers_of,
)
from mtcommission.optimal.modes import (
    impulse_response,
    in_moments,
    transition,
)
from mtcommission.optimal.problem import ArcInterior, Atom, BoundedProblem
from mtcommission.optimal.switching import Mesh, build_mesh, integral_of_size, time_within

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

GAP = 1e-6
"""Largest relative distance of t_f from its proved lower bound for arcs found exactly; a control on
cells is returned with the gap that it has."""
EXCESS = 1e-9
"""Largest relative excess over a bound or the force limit."""
TERMINAL, TERMINAL_ON_CELLS = 1e-9, 1e-8
"""Largest terminal error of a state against its peak; the linear program knows no more digits."""
ROUNDING = 1e-13
"""Allowance for rounding, relative to the sum of the magnitudes of all terms: some hundred
operations of 1.1e-16 each."""
DENSITY_CELLS_PER_RADIAN = 16
"""Samples of a density."""
MOST_RADIANS = 2e6
"""Fastest rate times duration of what is followed at all: some fifteen seconds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measure:
    """A dual point."""

    t_f: float  # Horizon [s]
    terminal: Array  # Λ, shape (n,)
    atoms: tuple[Atom, ...]
    interiors: tuple[ArcInterior, ...]  # Where the measure has the density that keeps σ = 0
    # What the end may be worth at most, beside Λ x_f: that of a band; 0 at exact rest.
    spent: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stretch:
    """A piece of the adjoint without jumps, between remaining times start > end [s]."""

    start: float
    end: float
    adjoint: Array  # Λ at its end, shape (n,)
    limit: int  # Index of the bound held on it; -1 off the interiors
    before: Array  # Λ at its start, shape (n,)
    slack: float = 0.0  # What putting Λ on σ = 0 at its end may cost

    @property
    def length(self) -> float:
        """Duration [s]."""
        return self.start - self.end


def stretches(problem: BoundedProblem, measure: Measure) -> tuple[Stretch, ...]:
    """Return the adjoint, stretch by stretch in order of time.

    Source: docs/optimal-control.md, section 8.
    """
    events = _events(problem, measure)
    stops = np.array([stop for stop, *_ in events])
    flows = transition(problem.plant, np.diff(stops, prepend=0.0))
    done: list[Stretch] = []
    end, adjoint = 0.0, measure.terminal
    for (stop, interior, jump), flow in zip(events, flows, strict=True):
        if stop > end:
            limit, slack = -1, 0.0
            before = adjoint @ flow
            if interior is not None:
                limit = interior.limit
                adjoint, slack = _settled(problem, adjoint, limit, t_f=measure.t_f)
                before = problem.limits[limit].adjoint_flow.over(stop - end) @ adjoint
            done.append(
                Stretch(
                    start=stop, end=end, adjoint=adjoint, limit=limit, before=before, slack=slack
                )
            )
            adjoint, end = before, stop
        adjoint = adjoint - jump
    return tuple(reversed(done))


def _settled(
    problem: BoundedProblem, adjoint: Array, index: int, *, t_f: float
) -> tuple[Array, float]:
    """Return Λ with σ = σ' = ... = 0, which the multipliers miss by rounding, and what that costs.

    A miss grows over the interior like (rate · length)^(r-1), and with it over all before. The
    step of Λ by w_j c (A/rate)^j that removes it is worth w_j c (A/rate)^j x of the motion; for
    j = 0 it is an atom, for the others its largest value over all motions is the slack.
    """
    limit = problem.limits[index]
    weights, higher = adjoint @ limit.impulses, limit.output_chain[1:]
    sizes = _integrals_of_sizes(problem, higher, np.full(len(higher), t_f))
    worth = np.append(1.0, problem.force_limit * sizes)
    return adjoint - weights @ limit.output_chain, float(np.abs(weights) @ worth)


def _events(
    problem: BoundedProblem, measure: Measure
) -> list[tuple[float, ArcInterior | None, Array]]:
    """Return (end of a stretch, interior that covers it, jump there), by remaining time."""
    still = np.zeros(problem.plant.order)
    events: list[tuple[float, int, ArcInterior | None, Array]] = [(measure.t_f, 2, None, still)]
    for interior in measure.interiors:
        events += [(interior.end, 1, None, still), (interior.start, -1, interior, still)]
    for atom in measure.atoms:
        # At the late end of an interior the atom acts before it, at the early end after it.
        jump = atom.weight * problem.limits[atom.limit].row
        inside = next(
            (interior for interior in measure.interiors if interior.holds(atom.remaining)), None
        )
        events.append((atom.remaining, 0, inside, jump))
    ordered = sorted(events, key=lambda event: (event[0], event[1]))
    return [(stop, interior, jump) for stop, _, interior, jump in ordered]


def sigma_sign(problem: BoundedProblem, parts: tuple[Stretch, ...], remaining: float) -> int:
    """Return the sign of σ at a remaining time off the interiors."""
    part = next(part for part in parts if part.end <= remaining <= part.start)
    value = float(part.adjoint @ impulse_response(problem.plant, np.array(remaining - part.end)))
    return 1 if value > 0.0 else -1


def slopes(problem: BoundedProblem, parts: tuple[Stretch, ...], remaining: Array) -> Array:
    """Return dσ/dτ at remaining times [s]."""
    ordered = parts[::-1]
    ends = np.array([part.end for part in ordered])
    index = np.searchsorted(ends, remaining, side="right") - 1
    adjoints = np.array([part.adjoint for part in ordered])[index]
    responses = impulse_response(problem.plant, remaining - ends[index])
    return np.asarray(np.sum(adjoints @ problem.plant.A * responses, axis=1))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Dual:
    """What a dual point is worth at most, and what that proves."""

    parts: tuple[Stretch, ...]  # Its adjoint, in order of time
    values: Array  # Upper bounds of F ∫|σ| + |μ| on each stretch, atoms left out
    zeros: Array  # Remaining times where σ changes sign off the interiors, ascending [s]
    lower_bound: float  # Before it no admissible control reaches the target [s]; 0: not proved


def weigh(problem: BoundedProblem, measure: Measure) -> Dual:
    """Return what a dual point is worth at most, and the time that it excludes.

    The measure is cut off at the start until the dual value falls below Λ x_f; since waiting
    at rest is always possible, every shorter time is excluded as well.

    Source: weak duality.
    """
    parts, zeros = stretches(problem, measure), [np.zeros(0)]
    values = np.array([part.slack for part in parts])
    mesh, back = _mesh(problem, parts), in_moments(problem.plant).back
    for i, part in enumerate(parts):
        if part.limit < 0:
            size = integral_of_size(mesh.until(part.length), part.adjoint @ back, part.length)
            values[i] += problem.force_limit * size.most
            zeros.append(part.end + size.zeros)
        else:
            values[i] += _worth_along_arc(problem, part)[-1]
    values = values * (1.0 + ROUNDING) + _rounding(problem, parts)
    return Dual(
        parts=parts,
        values=values,
        zeros=np.sort(np.concatenate(zeros)),
        lower_bound=_excluded(problem, measure, parts, values),
    )


def _excluded(
    problem: BoundedProblem, measure: Measure, parts: tuple[Stretch, ...], values: Array
) -> float:
    claim = float(measure.terminal @ problem.target) - measure.spent
    claim -= ROUNDING * float(np.abs(measure.terminal) @ np.abs(problem.target))
    later = np.append(np.cumsum(values[::-1])[::-1], 0.0)
    places = np.array([atom.remaining for atom in measure.atoms])
    weights = np.array([abs(atom.weight) for atom in measure.atoms])
    for i, part in enumerate(parts):
        room = claim - float(later[i + 1]) - float(weights[places <= part.end].sum())
        if room > 0.0:
            return part.end + _time_within(problem, part, room)
    return 0.0


def _mesh(problem: BoundedProblem, parts: tuple[Stretch, ...]) -> Mesh:
    longest = max(part.length for part in parts)
    return build_mesh(in_moments(problem.plant).functions, longest)


def _rounding(problem: BoundedProblem, parts: tuple[Stretch, ...]) -> Array:
    adjoints = np.array([part.adjoint for part in parts])
    sizes = _integrals_of_sizes(problem, adjoints, np.array([part.length for part in parts]))
    return np.asarray(ROUNDING * problem.force_limit * sizes)


def _worth_along_arc(problem: BoundedProblem, part: Stretch) -> Array:
    """Return |μ| of an interior up to even distances from its end, plus F ∫|σ| on all of it.

    There σ is a polynomial of degree r - 1.
    """
    limit = problem.limits[part.limit]
    left_over = sum(
        abs(float(part.adjoint @ limit.force_chain[:, j]))
        * problem.rate**j
        * part.length ** (j + 1)
        / factorial(j + 1)
        for j in range(limit.order)
    )
    density, primitive = densities(problem, part)
    # Where the density changes sign, its swing bounds what the difference of primitives hides.
    swings = np.abs(np.diff(density)) * (np.abs(np.diff(np.sign(density))) == 2.0)
    hidden = 2.0 * swings * part.length / (density.size - 1)
    worth = np.cumsum(np.abs(np.diff(primitive)) + hidden)
    return np.append(0.0, worth) + problem.force_limit * left_over


def densities(problem: BoundedProblem, part: Stretch) -> tuple[Array, Array]:
    """Return the density of an interior and its primitive at even distances from its end."""
    limit, n = problem.limits[part.limit], problem.plant.order
    held = limit.adjoint_flow
    to_density = limit.density_column @ held.inverse
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[n, :n] = held.generator, to_density
    count = int(np.ceil(part.length * problem.rate * DENSITY_CELLS_PER_RADIAN)) + 1
    flow = balanced_expm(joint * (part.length / count))
    followed = powers_of(flow, np.append(held.chart @ part.adjoint, 0.0), count)
    return followed[:, :n] @ to_density, followed[:, n]


def held_with(
    problem: BoundedProblem, part: Stretch, sign: int
) -> Iterator[tuple[float, float, float]]:
    """Yield where the density of an interior has a sign, as start > end, and its integral there."""
    density = sign * densities(problem, part)[0]
    tau = np.linspace(part.end, part.start, density.size)
    turns = np.flatnonzero(np.diff(np.pad((density >= 0.0).astype(np.int8), 1)))
    for first, stop in zip(turns[::2].tolist(), turns[1::2].tolist(), strict=True):
        if stop - first > 1:
            worth = float(density[first:stop].sum()) * part.length / (density.size - 1)
            yield float(tau[stop - 1]), float(tau[first]), worth


def _integrals_of_sizes(problem: BoundedProblem, rows: Array, lengths: Array) -> Array:
    """Return ∫ of the summed magnitudes of the terms of each row's σ over a length.

    An exponential lasts no longer than its time constant.
    """
    modal, powers = _sizes(problem, rows)
    decays = -in_moments(problem.plant).functions.rates.real
    spans = 1.0 / np.maximum(decays, 1.0 / lengths[:, np.newaxis])
    grown = lengths[:, np.newaxis] ** (1, 2, 3) / (1, 2, 6)
    each = (modal * spans).sum(axis=1) + (powers * grown[:, : powers.shape[1]]).sum(axis=1)
    return np.asarray(each)


def _sizes(problem: BoundedProblem, adjoint: Array) -> tuple[Array, Array]:
    """Return what each exponential and what 1, τ and τ²/2 have in σ, in magnitude, at most."""
    known = in_moments(problem.plant)
    sizes = np.abs(adjoint) @ np.abs(known.back)
    return np.abs(known.functions.modal(sizes)), sizes[..., known.functions.one :]


def _time_within(problem: BoundedProblem, part: Stretch, room: float) -> float:
    """Return for how long before its end a stretch is worth less than some room."""
    room = room / (1.0 + ROUNDING) - part.slack - float(_rounding(problem, (part,))[0])
    if part.limit >= 0:
        worth = _worth_along_arc(problem, part)
        return part.length * max(int(worth.searchsorted(room)) - 1, 0) / (worth.size - 1)
    if room <= 0.0:
        return 0.0
    weights, span = part.adjoint @ in_moments(problem.plant).back, room / problem.force_limit
    return time_within(_mesh(problem, (part,)), weights, span, end=part.length)


def require_followable(time: float, rate: float, *, most: float = MOST_RADIANS) -> None:
    """Raise MOVE_TOO_LONG where a time [s] at the fastest rate takes too many samples to follow."""
    if time * rate > most:
        detail = Message("optimum-too-long", t_f=time, radians=time * rate, most=most)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """An accepted control with its proof."""

    motion: FollowedMotion
    dual: Dual  # Of multipliers that belong to it
    touches: tuple[Atom, ...]
    is_exact: bool  # Whether the arcs are exact; otherwise they are cells

    @property
    def t_f(self) -> float:
        """Final time [s]."""
        return self.motion.arcs[-1].t_end

    @property
    def t_lower(self) -> float:
        """Excluded time: a dual point knows no horizon, it may prove more than it is from [s]."""
        return min(self.dual.lower_bound, self.t_f)

    @property
    def gap(self) -> float:
        """(t_f - t_lower) / t_f."""
        return (self.t_f - self.t_lower) / self.t_f


def prove(
    problem: BoundedProblem,
    arcs: tuple[Arc, ...],
    measure: Measure,
    touches: tuple[Atom, ...],
    *,
    is_exact: bool,
) -> Found | None:
    """Return the control with its proof if the motion keeps everything, else None."""
    t_f = arcs[-1].t_end
    dual = weigh(problem, replace(measure, t_f=t_f))
    # To follow a long move costs far more than to weigh its multipliers.
    if is_exact and t_f - dual.lower_bound > GAP * t_f:
        return None
    motion = follow_control(problem.plant, arcs)
    error = np.abs(motion.final - problem.target)[problem.fixed]
    share = error / motion.peaks[: problem.plant.order][problem.fixed]
    missed = TERMINAL if is_exact else TERMINAL_ON_CELLS
    if _peak_level(problem, motion) > 1.0 + EXCESS or float(share.max()) > missed:
        return None
    return Found(motion=motion, dual=dual, touches=touches, is_exact=is_exact)


def _peak_level(problem: BoundedProblem, motion: FollowedMotion) -> float:
    """Return the largest peak of the bounded signals and of the force, relative to its bound."""
    signals = problem.plant.signals
    peaks = [
        float(motion.peaks[signals.index(limit.bound.name)]) / limit.bound.value
        for limit in problem.limits
    ]
    return max(*peaks, motion.force_peak / problem.force_limit)
