"""Multipliers of the bounded problem, and the bound on t_f that they prove.

Let the remaining time be τ = t_f - t. Choose any row Λ for the terminal state and any signed
measure μ_k for each bound; with the impulse response g of the state,

    σ(τ) = Λ g(τ) - Σ_k ∫ c_k g(τ - τ') dμ_k(τ')

every admissible motion that reaches the target x_f at t_f obeys

    Λ x_f = ∫ σ F_set dτ + Σ_k ∫ c_k x dμ_k <= F ∫ |σ| dτ + Σ_k |μ_k|.

Whatever Λ and μ are: where the right side is smaller, t_f is too short. The best choice makes
both sides equal; then σ switches the force and μ lives where a bound is touched: atoms at touch
points and ends of boundary arcs, a density along the arcs, where σ = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.proof.dual_point import (
    Atom,
    Measure,
    Stretch,
    adjoint_before,
    stretches,
)
from mtcommission.optimal.bounded.proof.sigma import integrate_sigma, sigma_magnitude
from mtcommission.optimal.exponential import balanced_expm

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Integral:
    """An upper bound of an integral of |σ|."""

    value: float  # The integral [s/kg and the like: the unit of Λ g times s]
    allowance: float  # Included for zeros that could not be excluded
    zeros: Array  # Remaining times where σ changes sign, ascending, shape (n_zeros,) [s]


def dual_value(
    problem: BoundedProblem, parts: tuple[Stretch, ...], atoms: tuple[Atom, ...]
) -> Integral:
    """Return an upper bound of F ∫|σ| + Σ|μ|, with the zeros of σ off the interiors.

    Source: weak duality; zeros isolated by the largest possible |σ''| in each cell.
    """
    adjoints = np.array([part.adjoint for part in parts]).reshape(-1, problem.plant.order)
    lengths = np.array([part.length for part in parts])
    off = np.array([part.limit < 0 for part in parts], dtype=bool)
    found = integrate_sigma(problem, adjoints[off], lengths[off])
    held = [_density(problem, part) for part in parts if part.limit >= 0]
    F, ends = problem.force_limit, np.array([part.end for part in parts])[off]
    value = F * found.value + sum(share.value for share in held)
    value += sum(abs(atom.weight) for atom in atoms) + sum(part.slack for part in parts)
    return Integral(
        value=value
        + problem.settings.proof.rounding
        * (value + F * sigma_magnitude(problem, adjoints, lengths)),
        allowance=F * found.allowance + sum(share.allowance for share in held),
        zeros=np.sort(ends[found.stretch] + found.zeros),
    )


def _density(problem: BoundedProblem, part: Stretch) -> Integral:
    """Return |μ| of an interior plus F ∫|σ| on it, which is a polynomial of degree r - 1."""
    limit = problem.limits[part.limit]
    left_over = sum(
        abs(float(part.adjoint @ limit.force_chain[:, j]))
        * problem.rate**j
        * part.length ** (j + 1)
        / factorial(j + 1)
        for j in range(limit.order)
    )
    density, primitive = _densities(problem, part)
    count = density.size - 1
    changes = np.abs(np.diff(np.sign(density))) == 2.0
    # Where the density changes sign, its swing bounds what the difference of primitives hides.
    swing = np.abs(np.diff(density))[changes].sum() * part.length / count
    value = float(np.abs(np.diff(primitive)).sum() + 2.0 * swing)
    return Integral(
        value=value + problem.force_limit * left_over,
        allowance=problem.force_limit * left_over + 2.0 * float(swing),
        zeros=np.empty(0),
    )


def _densities(problem: BoundedProblem, part: Stretch) -> tuple[Array, Array]:
    """Return the density of an interior and its primitive at even distances from its end."""
    limit, n = problem.limits[part.limit], problem.plant.order
    held = limit.adjoint_flow
    to_density = limit.density_column @ held.inverse
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[n, :n] = held.generator, to_density
    count = (
        int(np.ceil(part.length * problem.rate * problem.settings.proof.density_cells_per_radian))
        + 1
    )
    flow = balanced_expm(joint * (part.length / count))
    rows = [np.append(held.chart @ part.adjoint, 0.0)]
    for _ in range(count):
        rows.append(flow @ rows[-1])
    followed = np.array(rows)
    return followed[:, :n] @ to_density, followed[:, n]


@dataclass(frozen=True, slots=True, kw_only=True)
class DensityZone:
    """Where the density of a multiplier has the wrong sign on an interior."""

    # start, end: Remaining times, start > end [s].
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
        density = side * _densities(problem, part)[0]
        tau = np.linspace(part.end, part.start, density.size)
        wrong = np.concatenate(
            [
                [False],
                density < -problem.settings.proof.small_density * np.abs(density).max(),
                [False],
            ]
        )
        edges = np.nonzero(np.diff(wrong.astype(np.int8)))[0]
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


def _crossing(tau: Array, density: Array, wrong: int, right: int) -> float:
    """Return where the density changes sign between two samples; the first where there is one."""
    if not 0 <= right < tau.size:
        return float(tau[wrong])
    share = density[wrong] / (density[wrong] - density[right])
    return float(tau[wrong] + np.clip(share, 0.0, 1.0) * (tau[right] - tau[wrong]))


def lower_bound(problem: BoundedProblem, measure: Measure) -> float:
    """Return a time before which no admissible control reaches the target.

    The measure is cut off at the start until the dual value falls below Λ x_f; since waiting
    at rest is always possible, every shorter time is excluded as well.
    """
    return excluded_time(problem, measure, claim=float(measure.terminal @ problem.target))


def excluded_time(problem: BoundedProblem, measure: Measure, *, claim: float) -> float:
    """Return a time by which Λ x of no admissible motion reaches a value."""
    settings = problem.settings.proof
    claim -= settings.rounding * float(np.abs(measure.terminal) @ np.abs(problem.target))
    parts = stretches(problem, measure)
    for place, part in enumerate(parts):
        atoms = tuple(atom for atom in measure.atoms if atom.remaining <= part.end)
        room = claim - dual_value(problem, parts[place + 1 :], atoms).value
        if room > 0.0:
            return part.start - _least_cut(
                problem, part, room, first=settings.first_cut * measure.t_f
            )
    return 0.0


def _least_cut(problem: BoundedProblem, part: Stretch, room: float, *, first: float) -> float:
    """Return about the least time cut off the start of a stretch that leaves it worth < room."""

    def fits(cut: float) -> bool:
        return dual_value(problem, (replace(part, start=part.start - cut),), ()).value < room

    # From the slope of the worth, F |σ| at the start, the cut is known to a few per cent.
    tolerance = problem.settings.proof.cut_tolerance
    slope = problem.force_limit * abs(float(adjoint_before(problem, part) @ problem.plant.B))
    excess = dual_value(problem, (part,), ()).value - room
    guess = max(excess / slope, 0.0) if slope > 0.0 else 0.0
    low, high = 0.0, first
    if first < guess and (1.0 + tolerance) * guess < part.length:
        low, high = (1.0 - tolerance) * guess, (1.0 + tolerance) * guess
    if low == 0.0 or fits(low):
        low, high = 0.0, first
    while not fits(high):
        low, high = high, 2.0 * high
        if high > part.length:
            return part.length
    while low > 0.0 and high - low > 2.0 * tolerance * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high
