"""Lower bounds of many final times at once: ``bound.prove_bound`` over cases side by side.

The same enclosure of zeros and the same allowance for rounding as for one case, with the cells of
all cases in one array; ``owner`` says whose a column is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.free.bound import EXTENDED_ROUNDOFF
from mtcommission.optimal.free.mesh import ROUNDOFF, Mesh, build_mesh
from mtcommission.optimal.free.moments import MomentProblem
from mtcommission.optimal.free.switching import (
    MAX_DIVISIONS,
    PARTS,
    crosses_zero,
    divided,
    inner_nodes,
    is_monotone,
    is_noise,
    may_vanish,
    newton_quotient,
    rounding_bound,
)

Array = NDArray[np.float64]
Index = NDArray[np.intp]

RADIANS_PER_CELL = 0.4
"""Length of a cell against the fastest pole at τ = 0 (empirical: with many cases at once each cell
costs, more than for one alone)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OwnedZeros:
    """Zeros of many switching functions, sorted by owner and then by τ."""

    owner: Index  # Case of each zero, shape (n_zeros,)
    tau: Array  # Shape (n_zeros,) [s]
    doubt: Array  # As ``switching.Zeros.doubt``, shape (n_cases,)


def prove_bounds(problem: MomentProblem, multipliers: Array, spans: Array, times: Array) -> Array:
    """Return times before which no admissible force reaches the target.

    Source: docs/optimal-control.md, section 2.
    """
    mesh = build_mesh(problem, float(times.max()), radians=RADIANS_PER_CELL)
    zeros = isolate_owned_zeros(mesh, multipliers, times)
    doubt = zeros.doubt + 2.0 * ROUNDOFF * spans
    bounds = times
    for attempt in (1.0, 2.0, 0.0):
        value, allowance, end_value = _integrate(problem, multipliers, zeros, bounds)
        excess = (value - spans).astype(np.float64) + allowance + doubt
        if attempt:
            step = np.maximum(excess, 0.0) / np.maximum(end_value, 1e-300)
            lower = bounds - attempt * step - ROUNDOFF * bounds
            bounds = np.where(excess > 0.0, np.maximum(lower, 0.5 * bounds), bounds)
    return np.where(excess <= 0.0, bounds * (1.0 - 4.0 * ROUNDOFF), 0.0)


def isolate_owned_zeros(mesh: Mesh, multipliers: Array, times: Array) -> OwnedZeros:
    """Return all sign changes of each σ before its time; as ``switching.isolate_zeros``."""
    cells, owner = _first_cells(mesh, multipliers, times)
    doubt = np.zeros(times.size)
    found, owners = [np.empty((7, 0))], [np.empty(0, dtype=np.intp)]
    for _ in range(MAX_DIVISIONS):
        live = may_vanish(cells)
        cells, owner = cells[:, live], owner[live]
        if not owner.size:
            break
        settled, crossing = is_monotone(cells), crosses_zero(cells)
        found.append(cells[:, settled & crossing])
        owners.append(owner[settled & crossing])
        cells, owner, crossing = cells[:, ~settled], owner[~settled], crossing[~settled]
        c = multipliers[owner]
        rounding = rounding_bound(mesh.problem, mesh.problem.amplitudes(c), c, cells)
        noise = is_noise(cells, rounding)
        np.add.at(doubt, owner[noise], 4.0 * cells[1, noise] * rounding[noise])
        found.append(cells[:, noise & crossing])
        owners.append(owner[noise & crossing])
        cells, owner = _divide(mesh.problem, multipliers, cells[:, ~noise], owner[~noise])
    else:
        # An unsettled cell may hide anything: nothing is proved for its owner.
        doubt[owner] = np.inf
    whose = np.concatenate(owners)
    tau = _refine(mesh.problem, multipliers[whose], np.concatenate(found, axis=1))
    inside = (tau > 0.0) & (tau < times[whose])
    whose, tau = whose[inside], tau[inside]
    order = np.lexsort((tau, whose))
    return OwnedZeros(owner=whose[order], tau=tau[order], doubt=doubt)


def _first_cells(mesh: Mesh, multipliers: Array, times: Array) -> tuple[Array, Index]:
    """Return the cells of all cases, rows as in ``switching``, and whose they are."""
    problem, nodes = mesh.problem, mesh.nodes[:, np.newaxis]
    phi = mesh.values[:-1].T
    sigma = problem.target_values(nodes) - phi @ multipliers.T
    slope = problem.degree - phi @ (problem.differentiation @ multipliers.T)
    length = np.diff(nodes, axis=0)
    amplitudes = problem.amplitudes(multipliers).T
    remainder = mesh.remainder.T @ amplitudes
    starts = np.broadcast_to(nodes[:-1], remainder.shape)
    cells = np.array(
        [
            starts,
            np.broadcast_to(length, remainder.shape),
            sigma[:-1],
            sigma[1:],
            slope[:-1] * length,
            slope[1:] * length,
            remainder,
        ]
    )
    inside = starts < times
    owner = np.broadcast_to(np.arange(times.size), inside.shape)[inside]
    return cells[:, inside], owner


def _values_and_slopes(
    problem: MomentProblem, multipliers: Array, tau: Array
) -> tuple[Array, Array]:
    """Return σ and dσ/dτ at τ, each with multipliers of its own."""
    phi, slope = problem.values_and_slopes(tau)
    sigma = problem.target_values(tau) - np.einsum("ij,ij->i", phi, multipliers)
    return sigma, problem.degree - np.einsum("ij,ij->i", slope, multipliers)


def _divide(
    problem: MomentProblem, multipliers: Array, cells: Array, owner: Index
) -> tuple[Array, Index]:
    tau = inner_nodes(cells)
    c = multipliers[np.tile(owner, len(tau))]
    sigma, slope = _values_and_slopes(problem, c, tau.ravel())
    parts = divided(cells, sigma.reshape(tau.shape), slope.reshape(tau.shape))
    return parts, np.tile(owner, PARTS)


def _refine(problem: MomentProblem, multipliers: Array, brackets: Array) -> Array:
    start, length, left, right = brackets[:4]
    tau = start + length * left / np.where(left == right, 1.0, left - right)
    for _ in range(6):
        sigma, slope = _values_and_slopes(problem, multipliers, tau)
        tau = np.clip(tau - newton_quotient(sigma, slope), start, start + length)
    return np.asarray(tau)


def _integrate(
    problem: MomentProblem, multipliers: Array, zeros: OwnedZeros, ends: Array
) -> tuple[NDArray[np.longdouble], Array, Array]:
    """Return ∫|σ| up to each end, its allowance, and |σ| there; as ``integrate_switching``."""
    n = ends.size
    owner = np.concatenate([zeros.owner, np.arange(n)])
    # An end is appended behind the zeros of its case; a zero beyond it counts as the end.
    order = np.argsort(owner, kind="stable")
    owner = owner[order]
    tau = np.concatenate([np.minimum(zeros.tau, ends[zeros.owner]), ends])[order]
    last = np.flatnonzero(np.append(np.diff(owner) > 0, True))
    first = np.append(0, last[:-1] + 1)
    c = multipliers[owner]
    t = tau.astype(np.longdouble)
    rates = problem.rates.astype(np.clongdouble)
    less_one = np.expm1(t[:, np.newaxis] * rates)
    weights = problem.weights(c)
    constant = (c[:, -1] if problem.degree else np.zeros(t.size)).astype(np.longdouble)
    power = 0.5 * t * t if problem.degree else t
    primitive = power - constant * t - ((less_one / rates) * weights).sum(axis=1).real
    value = (
        (t if problem.degree else 1.0) - constant - ((less_one + 1.0) * weights).sum(axis=1).real
    )
    slope = problem.degree - ((less_one + 1.0) * rates * weights).sum(axis=1).real
    least = np.maximum(np.abs(value) / t, np.finfo(np.float64).tiny)
    hidden = value**2 / np.maximum(np.abs(slope), least)
    hidden[last] = 0.0
    decay = np.abs(less_one + 1.0)
    columns = t[:, np.newaxis]
    sizes = (6.0 + problem.size) * np.minimum(columns, (1.0 + decay) / np.abs(rates))
    terms = ((sizes + columns * decay) * np.abs(weights)).sum(axis=1)
    terms += (2.0 + problem.size) * (np.abs(constant) * t + power)
    before = np.append(np.longdouble(0.0), primitive[:-1])
    before[first] = 0.0
    allowance = EXTENDED_ROUNDOFF * np.add.reduceat(terms, first)
    allowance += 2.0 * np.add.reduceat(hidden, first)
    return (
        np.add.reduceat(np.abs(primitive - before), first),
        allowance.astype(np.float64),
        np.abs(value[last]).astype(np.float64),
    )
