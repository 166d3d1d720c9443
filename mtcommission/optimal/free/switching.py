"""The switching function σ = ψ - Σ c_i φ_i: all its zeros.

No zero may be missed, since every proof rests on them: an interval is settled only when a
rigorous error bound of the cubic that interpolates σ and σ' at its ends shows that σ has no
zero, or just one: σ is monotone there, or changes its sign and bends to one side only. Else it is
divided.

A cell is a column of seven rows: start, length, σ at both ends, length·σ' at both ends, bound of
the cubic's error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.free.mesh import ROUNDOFF, Mesh
from mtcommission.optimal.free.moments import MomentProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

PARTS = 4
SHARES = np.arange(PARTS) / PARTS
"""Parts that an unsettled cell is divided into, and where they start."""
MAX_DIVISIONS = 30
"""More than the bits of double precision: the search has always ended before."""
SLOPE_ERROR = 384.0 * float(np.sqrt(3.0)) / 216.0
"""Error of the cubic's slope times the length against that of its value."""
BEND_ERROR = 384.0 / 12.0
"""Error of its second derivative times the length squared."""
CUBIC_STEPS = 3
EXACT_STEPS = 10
"""Newton steps on the cubic, and at most on σ then: two are usual, more where two zeros nearly
meet (empirical)."""
SAME = 4.0 * ROUNDOFF
"""Relative distance at which two places are one."""


def values_and_slopes(
    problem: MomentProblem, multipliers: Array, functions: Array
) -> tuple[Array, Array]:
    """Return σ and dσ/dτ where φ and, last, ψ have the given values of shape (size + 1, k)."""
    phi = functions[:-1]
    slopes = problem.degree - problem.differentiation.dot(multipliers).dot(phi)
    return functions[-1] - multipliers.dot(phi), slopes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Brackets:
    """Cells with one sign change of σ each; none is elsewhere."""

    cells: Array  # In any order, shape (7, n_zeros)
    # ∫|σ| over the places where |σ| stays below its rounding error, so that pairs of zeros
    # there may have been left out, at most [s] or [s²].
    doubt: float

    def isolate(self, zeros: Array, horizon: float, end_value: float) -> bool:
        """Return whether given zeros of σ, ascending, are all before the horizon.

        ``end_value`` is σ there.
        """
        brackets = sorted(zip(*self.cells[:3].tolist(), strict=True))
        brackets = [bracket for bracket in brackets if bracket[0] < horizon]
        if len(brackets) > zeros.size and (brackets[-1][2] > 0.0) == (end_value > 0.0):
            # The last bracket reaches beyond the horizon and changes its sign there.
            brackets.pop()
        return len(brackets) == zeros.size and all(
            start <= zero <= start + length
            for (start, length, _), zero in zip(brackets, zeros.tolist(), strict=True)
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Zeros:
    """All sign changes of a switching function."""

    tau: Array  # Ascending, shape (n_zeros,) [s]
    doubt: float  # As in ``Brackets``


def isolate_zeros(mesh: Mesh, multipliers: Array) -> Zeros:
    """Return all sign changes of σ on [0, horizon]."""
    brackets = bracket_zeros(mesh, multipliers, horizon=mesh.horizon, settled=is_monotone)
    tau = _refine(mesh.problem, multipliers, brackets.cells)
    tau.sort()
    return Zeros(tau=tau[tau > 0.0], doubt=brackets.doubt)


def bracket_zeros(
    mesh: Mesh, multipliers: Array, *, horizon: float, settled: Callable[[Array], Mask]
) -> Brackets:
    """Return cells that hold the sign changes of σ up to a horizon, and perhaps some behind it.

    Source: Bernstein form of the cubic Hermite interpolant with remainder |σ⁗| h⁴/384 (its
    slope: √3 |σ⁗| h³/216, its second derivative: |σ⁗| h²/12); docs/optimal-control.md, section 3.
    """
    cells = _doubtful_cells(mesh, multipliers, horizon)
    found: list[Array] = []
    doubt = 0.0
    for _ in range(MAX_DIVISIONS):
        is_settled, crossing = settled(cells), crosses_zero(cells)
        found.append(_chosen(cells, is_settled & crossing))
        if all(is_settled.tolist()):
            break
        cells, crossing = cells[:, ~is_settled], crossing[~is_settled]
        rounding = rounding_bound(
            mesh.problem, mesh.problem.amplitudes(multipliers), multipliers, cells
        )
        noise = is_noise(cells, rounding)
        doubt += float(4.0 * cells[1, noise] @ rounding[noise])
        found.append(cells[:, noise & crossing])
        parts = _divide(mesh.problem, multipliers, cells[:, ~noise])
        cells = parts[:, may_vanish(parts)]
    else:
        # An unsettled cell may hide anything.
        doubt = inf
    return Brackets(
        cells=found[0] if len(found) == 1 else np.concatenate(found, axis=1), doubt=doubt
    )


def _chosen(cells: Array, mask: Mask) -> Array:
    """Return some of the cells; faster than the mask itself as an index."""
    return cells.take(mask.nonzero()[0], axis=1)


def may_vanish(cells: Array) -> Mask:
    """Return which cells may hold a zero."""
    return within(cells[2], cells[3], cells[4], cells[5], cells[6])


def within(left: Array, right: Array, left_slope: Array, right_slope: Array, bound: Array) -> Mask:
    """Return where the cubic's control polygon comes nearer to 0 than a bound."""
    inner, outer = left + left_slope / 3.0, right - right_slope / 3.0
    low = np.minimum(np.minimum(left, right), np.minimum(inner, outer))
    high = np.maximum(np.maximum(left, right), np.maximum(inner, outer))
    return np.asarray((low <= bound) & (high >= -bound))


def is_monotone(cells: Array) -> Mask:
    """Return on which cells σ is monotone for certain."""
    _, _, left, right, left_slope, right_slope, remainder = cells
    middle = 3.0 * (right - left) - left_slope - right_slope
    low = np.minimum(np.minimum(left_slope, right_slope), middle)
    high = np.maximum(np.maximum(left_slope, right_slope), middle)
    error = SLOPE_ERROR * remainder
    return np.asarray((low > error) | (high < -error))


def has_one_zero(cells: Array) -> Mask:
    """Return on which cells σ is monotone, or convex or concave with a sign change, for certain."""
    monotone = is_monotone(cells)
    if all(monotone.tolist()):
        return monotone
    _, _, left, right, left_slope, right_slope, remainder = cells
    # The second derivative of a cubic is linear: its ends tell all.
    chord, error = 3.0 * (right - left), 0.5 * BEND_ERROR * remainder
    start, end = chord - 2.0 * left_slope - right_slope, left_slope + 2.0 * right_slope - chord
    bends = (np.minimum(start, end) > error) | (np.maximum(start, end) < -error)
    return np.asarray((bends & crosses_zero(cells)) | monotone)


def is_noise(cells: Array, rounding: Array) -> Mask:
    """Return on which cells |σ| stays below its rounding error."""
    _, _, left, right, left_slope, right_slope, remainder = cells
    reach = np.maximum(np.abs(left), np.abs(right))
    reach += np.abs(left_slope) + np.abs(right_slope) + remainder
    return np.asarray(reach <= 4.0 * rounding)


def crosses_zero(cells: Array) -> Mask:
    """Return on which cells σ has different signs at the ends."""
    return np.asarray((cells[2] > 0.0) != (cells[3] > 0.0))


def inner_nodes(cells: Array) -> Array:
    """Return where cells are to be divided, shape (PARTS - 1, n_cells)."""
    return np.asarray(cells[0] + SHARES[1:, np.newaxis] * cells[1])


def divided(cells: Array, sigma: Array, slope: Array) -> Array:
    """Return the PARTS parts of all cells, given σ and σ' at ``inner_nodes``."""
    count = cells.shape[1]
    parts = np.empty((7, PARTS, count))
    parts[0] = cells[0] + SHARES[:, np.newaxis] * cells[1]
    parts[1] = cells[1] / PARTS
    parts[2, 0], parts[2, 1:] = cells[2], sigma
    parts[3, -1], parts[3, :-1] = cells[3], sigma
    slope = slope * parts[1, 0]
    parts[4, 0], parts[4, 1:] = cells[4] / PARTS, slope
    parts[5, -1], parts[5, :-1] = cells[5] / PARTS, slope
    parts[6] = cells[6] / PARTS**4
    return parts.reshape(7, -1)


def newton_quotient(value: Array, slope: Array) -> Array:
    """Return value / slope; 0 where the slope vanishes, at brackets of rounding level."""
    return np.divide(value, slope, out=np.zeros_like(value), where=slope != 0.0)


def rounding_bound(
    problem: MomentProblem, amplitudes: Array, multipliers: Array, cells: Array
) -> Array:
    """Return a bound of the rounding error of σ on cells, shape (n_cells,).

    Covers the products p τ inside the exponentials, the exponentials and the sum. The multipliers
    and their ``amplitudes`` are those of all cells, or one row for each cell.
    """
    start, end = cells[0], cells[0] + cells[1]
    envelope = np.exp(start[:, np.newaxis] * problem.rates.real) * amplitudes
    modal = (envelope * (1.0 + (0.25 * end)[:, np.newaxis] * problem.magnitudes)).sum(axis=1)
    constant = np.abs(multipliers[..., -1]) if problem.degree else 0.0
    return np.asarray(8.0 * ROUNDOFF * (modal + constant + problem.target_values(end)))


def _doubtful_cells(mesh: Mesh, multipliers: Array, horizon: float) -> Array:
    """Return the cells of the mesh that begin before the horizon and may hold a zero."""
    problem, last = mesh.problem, int(mesh.nodes[:-1].searchsorted(horizon))
    length = mesh.lengths[:last]
    sigma, slope = values_and_slopes(problem, multipliers, mesh.values[:, : last + 1])
    cells = np.empty((7, last))
    cells[0], cells[1], cells[2], cells[3] = mesh.nodes[:last], length, sigma[:-1], sigma[1:]
    np.multiply(slope[:-1], length, out=cells[4])
    np.multiply(slope[1:], length, out=cells[5])
    cells[6] = problem.amplitudes(multipliers).dot(mesh.remainder[:, :last])
    return _chosen(cells, may_vanish(cells))


def _divide(problem: MomentProblem, multipliers: Array, cells: Array) -> Array:
    tau = inner_nodes(cells)
    sigma, slope = values_and_slopes(problem, multipliers, problem.joint_values(tau.ravel()))
    return divided(cells, sigma.reshape(tau.shape), slope.reshape(tau.shape))


def _refine(problem: MomentProblem, multipliers: Array, brackets: Array) -> Array:
    start, length = brackets[:2]
    tau = start + cubic_zeros(*brackets[2:6], steps=CUBIC_STEPS) * length
    end = start + length
    for _ in range(EXACT_STEPS):
        sigma, slope = values_and_slopes(problem, multipliers, problem.joint_values(tau))
        before, tau = tau, np.minimum(np.maximum(tau - newton_quotient(sigma, slope), start), end)
        if all((np.abs(tau - before) <= SAME * tau).tolist()):
            break
    return np.asarray(tau)


def cubic_zeros(
    left: Array, right: Array, left_slope: Array, right_slope: Array, *, steps: int
) -> Array:
    """Return where the cubics of cells with a sign change vanish, from 0 to 1.

    Slopes are against the length of the cell; Newton steps from the chord.
    """
    quadratic = 3.0 * (right - left) - 2.0 * left_slope - right_slope
    cubic = left_slope + right_slope - 2.0 * (right - left)
    x = left / (left - right)
    for _ in range(steps):
        value = left + x * (left_slope + x * (quadratic + x * cubic))
        slope = left_slope + x * (2.0 * quadratic + 3.0 * x * cubic)
        x = np.minimum(np.maximum(x - newton_quotient(value, slope), 0.0), 1.0)
    return np.asarray(x)
