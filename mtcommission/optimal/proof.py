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
    step_response,
    transition,
)
from mtcommission.optimal.problem import ArcInterior, Atom, BoundedProblem

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

GAP = 1e-6
"""Largest relative distance of t_f from its proved lower bound for arcs found exactly; a control on
cells is returned with the gap that it has."""
EXCESS = 1e-9
"""Largest relative excess over a bound or the force limit."""
TERMINAL = 1e-9
"""Largest terminal error of a state against its peak."""
ROUNDING = 1e-13
"""Allowance for rounding, relative to the sum of the magnitudes of all terms: some hundred
operations of 1.1e-16 each."""
FIRST_CUT = 1e-12
"""Smallest gap that is tried, as a share of t_f: about the rounding of the integrals."""
CUT_TOLERANCE = 0.05
"""Relative width to which the smallest provable gap is halved."""
CELLS_PER_RADIAN, DENSITY_CELLS_PER_RADIAN = 4, 16
"""First cells of the integral of |σ|, and samples of a density."""
HALVINGS = 14
"""Of a cell that may hide a zero of σ."""
BISECTIONS, POLISHES = 10, 3
"""Of a cell with a zero, and Newton steps to it: off by δ it misses σ' δ² of the integral."""
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
    weights = adjoint @ limit.impulses
    worth = np.append(1.0, largest_outputs(problem, limit.output_chain[1:], t_f=t_f))
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DualValue:
    """Upper bounds of F ∫|σ| + |μ| on each stretch, atoms left out, and the zeros of σ."""

    values: Array  # Shape (n_stretches,)
    zeros: Array  # Remaining times where σ changes sign off the interiors, ascending [s]


def dual_value(problem: BoundedProblem, parts: tuple[Stretch, ...]) -> DualValue:
    """Return what the stretches of an adjoint are worth at most.

    Source: weak duality; zeros isolated by the largest possible |σ''| in each cell.
    """
    adjoints = np.array([part.adjoint for part in parts]).reshape(-1, problem.plant.order)
    lengths, ends = np.array([[part.length, part.end] for part in parts]).T
    off = np.array([part.limit < 0 for part in parts], dtype=bool)
    values = np.array([part.slack for part in parts])
    sigma, stretch, zeros = _integrate_sigma(problem, adjoints[off], lengths[off])
    values[off] += problem.force_limit * sigma
    for i in np.flatnonzero(~off).tolist():
        values[i] += _density_value(problem, parts[i])
    magnitude = problem.force_limit * _integrals_of_sizes(problem, adjoints, lengths)
    return DualValue(
        values=values + ROUNDING * (values + magnitude),
        zeros=np.sort(ends[off][stretch] + zeros),
    )


def _density_value(problem: BoundedProblem, part: Stretch) -> float:
    """Return |μ| of an interior plus F ∫|σ| on it, which is a polynomial of degree r - 1."""
    limit = problem.limits[part.limit]
    left_over = sum(
        abs(float(part.adjoint @ limit.force_chain[:, j]))
        * problem.rate**j
        * part.length ** (j + 1)
        / factorial(j + 1)
        for j in range(limit.order)
    )
    density, primitive = densities(problem, part)
    changes = np.abs(np.diff(np.sign(density))) == 2.0
    # Where the density changes sign, its swing bounds what the difference of primitives hides.
    swing = np.abs(np.diff(density))[changes].sum() * part.length / (density.size - 1)
    value = float(np.abs(np.diff(primitive)).sum() + 2.0 * swing)
    return value + problem.force_limit * left_over


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Cells:
    """Cells [left, right] of stretches, with σ and dσ/dτ at both ends."""

    stretch: Indices
    left: Array
    right: Array
    values: Array
    slopes: Array


def _integrate_sigma(
    problem: BoundedProblem, adjoints: Array, lengths: Array
) -> tuple[Array, Indices, Array]:
    """Return upper bounds of ∫|σ| over stretches off the arcs, and the zeros with their stretches.

    Each stretch is cut into cells; one that may hide a pair of zeros (by a bound of |σ''| over its
    stretch) is halved, and what is left is added as an allowance.
    """
    modal, powers = _sizes(problem, adjoints)
    rates = in_moments(problem.plant).functions.magnitudes
    bend = modal @ rates**2 + powers[:, 2:].sum(axis=1)
    cells = _first_cells(problem, adjoints, lengths)
    for _ in range(HALVINGS):
        unsure = _may_hide_zeros(cells, bend)
        if not unsure.any():
            break
        cells = _halved(problem, adjoints, cells, unsure)
    unsure = _may_hide_zeros(cells, bend)
    hidden = bend[cells.stretch] * (cells.right - cells.left) ** 3 / 4.0
    value = np.zeros(lengths.size)
    np.add.at(value, cells.stretch, hidden * unsure)
    stretch, zeros = _sign_changes(problem, adjoints, cells)
    index = np.concatenate([np.tile(np.arange(lengths.size), 2), stretch])
    points = np.concatenate([np.zeros(lengths.size), lengths, zeros])
    order = np.lexsort((points, index))
    index, points = index[order], points[order]
    primitive = np.sum(step_response(problem.plant, points) * adjoints[index], axis=1)
    same = index[1:] == index[:-1]
    steps = np.abs(np.diff(primitive)) * same
    np.add.at(value, index[1:], steps)
    return value, stretch, zeros


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


def largest_outputs(problem: BoundedProblem, rows: Array, *, t_f: float) -> Array:
    """Return bounds of |row x| over all motions of a duration from rest, for rows of shape (k, n).

    The rows are 0 for the position.
    """
    sizes = _integrals_of_sizes(problem, rows, np.full(len(rows), t_f))
    return np.asarray(problem.force_limit * sizes)


def _sizes(problem: BoundedProblem, adjoint: Array) -> tuple[Array, Array]:
    """Return what each exponential and what 1, τ and τ²/2 have in σ, in magnitude, at most."""
    known = in_moments(problem.plant)
    sizes = np.abs(adjoint) @ np.abs(known.back)
    return np.abs(known.functions.modal(sizes)), sizes[..., known.functions.one :]


def _sigma(
    problem: BoundedProblem, adjoints: Array, stretch: Indices, tau: Array
) -> tuple[Array, Array]:
    """Return σ and dσ/dτ at times before the ends of stretches."""
    response, adjoint = impulse_response(problem.plant, tau), adjoints[stretch]
    slopes = np.sum(response * (adjoint @ problem.plant.A), axis=1)
    return np.sum(response * adjoint, axis=1), slopes


def _first_cells(problem: BoundedProblem, adjoints: Array, lengths: Array) -> _Cells:
    counts = np.ceil(lengths * problem.rate * CELLS_PER_RADIAN).astype(np.intp) + 1
    stretch = np.repeat(np.arange(lengths.size), counts + 1)
    number = np.arange(stretch.size) - np.repeat(np.cumsum(counts + 1) - counts - 1, counts + 1)
    nodes = lengths[stretch] * number / counts[stretch]
    values, slopes = _sigma(problem, adjoints, stretch, nodes)
    first = np.nonzero(stretch[1:] == stretch[:-1])[0]
    pairs = np.column_stack([first, first + 1])
    return _Cells(
        stretch=stretch[first],
        left=nodes[first],
        right=nodes[first + 1],
        values=values[pairs],
        slopes=slopes[pairs],
    )


def _halved(
    problem: BoundedProblem, adjoints: Array, cells: _Cells, unsure: NDArray[np.bool_]
) -> _Cells:
    stretch, left, right = cells.stretch[unsure], cells.left[unsure], cells.right[unsure]
    middle = 0.5 * (left + right)
    value, slope = _sigma(problem, adjoints, stretch, middle)

    def joined(known: Array, inside: Array) -> Array:
        first, last = known[unsure].T
        halves = np.column_stack([first, inside]), np.column_stack([inside, last])
        return np.vstack([known[~unsure], *halves])

    return _Cells(
        stretch=np.concatenate([cells.stretch[~unsure], stretch, stretch]),
        left=np.concatenate([cells.left[~unsure], left, middle]),
        right=np.concatenate([cells.right[~unsure], middle, right]),
        values=joined(cells.values, value),
        slopes=joined(cells.slopes, slope),
    )


def _may_hide_zeros(cells: _Cells, bend: Array) -> NDArray[np.bool_]:
    """Return which cells may hold zeros that the signs at their ends do not show."""
    widths, most = cells.right - cells.left, bend[cells.stretch]
    monotone = np.abs(cells.slopes).max(axis=1) >= most * widths
    # Between its ends σ deviates from the chord by at most bend widths² / 8.
    clear = np.abs(cells.values).min(axis=1) >= most * widths**2 / 8.0
    return np.asarray(~monotone & ~(clear & (cells.values.prod(axis=1) > 0.0)))


def _sign_changes(problem: BoundedProblem, adjoints: Array, cells: _Cells) -> tuple[Indices, Array]:
    """Return the zeros of σ with their stretches."""
    signs = np.sign(cells.values)
    where = signs[:, 0] * signs[:, 1] < 0.0
    stretch, low, high = cells.stretch[where], cells.left[where], cells.right[where]
    sign, adjoint = signs[where, 0], adjoints[stretch]
    for _ in range(BISECTIONS):
        at = 0.5 * (low + high)
        same = np.sign(np.sum(impulse_response(problem.plant, at) * adjoint, axis=1)) == sign
        low, high = np.where(same, at, low), np.where(same, high, at)
    at = 0.5 * (low + high)
    for _ in range(POLISHES):
        value, slope = _sigma(problem, adjoints, stretch, at)
        step = np.divide(value, slope, out=np.zeros_like(at), where=slope != 0.0)
        at = np.clip(at - step, low, high)
    return stretch, at


def lower_bound(problem: BoundedProblem, measure: Measure) -> float:
    """Return a time before which no admissible control reaches the target [s]; 0 if none is proved.

    The measure is cut off at the start until the dual value falls below Λ x_f; since waiting
    at rest is always possible, every shorter time is excluded as well.
    """
    claim = float(measure.terminal @ problem.target) - measure.spent
    claim -= ROUNDING * float(np.abs(measure.terminal) @ np.abs(problem.target))
    parts = stretches(problem, measure)
    values = dual_value(problem, parts).values
    later = np.append(np.cumsum(values[::-1])[::-1], 0.0)
    places = np.array([atom.remaining for atom in measure.atoms])
    weights = np.array([abs(atom.weight) for atom in measure.atoms])
    for i, part in enumerate(parts):
        room = claim - float(later[i + 1]) - float(weights[places <= part.end].sum())
        if room > 0.0:
            return part.start - _least_cut(problem, part, room, first=FIRST_CUT * measure.t_f)
    return 0.0


def _least_cut(problem: BoundedProblem, part: Stretch, room: float, *, first: float) -> float:
    """Return about the least time cut off the start of a stretch that leaves it worth < room."""

    def fits(cut: float) -> bool:
        shorter = replace(part, start=part.start - cut)
        return float(dual_value(problem, (shorter,)).values[0]) < room

    # From the slope of the worth, F |σ| at the start, the cut is known to a few per cent.
    worth = float(dual_value(problem, (part,)).values[0])
    slope = problem.force_limit * abs(float(part.before @ problem.plant.B))
    guess = max((worth - room) / slope, 0.0) if slope > 0.0 else 0.0
    if first < guess and (1.0 + CUT_TOLERANCE) * guess < part.length:
        low, high = (1.0 - CUT_TOLERANCE) * guess, (1.0 + CUT_TOLERANCE) * guess
        low = 0.0 if fits(low) else low
    else:
        low, high = 0.0, first
    while not fits(high):
        low, high = high, 2.0 * high
        if high > part.length:
            return part.length
    while low > 0.0 and high - low > 2.0 * CUT_TOLERANCE * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high


def require_followable(time: float, rate: float, *, most: float = MOST_RADIANS) -> None:
    """Raise MOVE_TOO_LONG where a time [s] at the fastest rate takes too many samples to follow."""
    if time * rate > most:
        detail = Message("optimum-too-long", t_f=time, radians=time * rate, most=most)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """An accepted control with its proof."""

    motion: FollowedMotion
    measure: Measure
    t_lower: float  # Excluded time [s]
    touches: tuple[Atom, ...]
    is_exact: bool  # Whether the arcs are exact; otherwise they are cells

    @property
    def t_f(self) -> float:
        """Final time [s]."""
        return self.motion.arcs[-1].t_end

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
    motion = follow_control(problem.plant, arcs)
    error = np.abs(motion.final - problem.target)[problem.fixed]
    share = error / motion.peaks[: problem.plant.order][problem.fixed]
    if peak_level(problem, motion) > 1.0 + EXCESS or float(share.max()) > TERMINAL:
        return None
    t_f = arcs[-1].t_end
    # In remaining time a dual point knows no horizon: it may prove more than the time it is from.
    measure = replace(measure, t_f=t_f)
    lower = min(lower_bound(problem, measure), t_f)
    found = Found(motion=motion, measure=measure, t_lower=lower, touches=touches, is_exact=is_exact)
    return found if found.gap <= GAP or not is_exact else None


def peak_level(problem: BoundedProblem, motion: FollowedMotion) -> float:
    """Return the largest peak of the bounded signals and of the force, relative to its bound."""
    signals = problem.plant.signals
    peaks = [
        float(motion.peaks[signals.index(limit.bound.name)]) / limit.bound.value
        for limit in problem.limits
    ]
    return max(*peaks, motion.force_peak / problem.force_limit)
