"""∫|σ| off the boundary arcs, bounded from above: a sum of exponentials between its zeros.

All stretches are treated at once: each is cut into cells, and a cell that may hide a pair of
zeros (by a bound of |σ''| over its stretch) is halved; what is left is added as an allowance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.closed_form import impulse_response, step_response

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SigmaIntegral:
    """∫|σ| over some stretches."""

    value: float  # Upper bound of the integral
    allowance: float  # Included for zeros that could not be excluded
    stretch: NDArray[np.intp]  # Index of the stretch of each zero, shape (n_zeros,)
    zeros: Array  # Times before the end of that stretch where σ changes sign, shape (n_zeros,) [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Cells:
    """Cells [left, right] of stretches, with σ and dσ/dτ at both ends."""

    stretch: NDArray[np.intp]
    left: Array
    right: Array
    values: Array
    slopes: Array


def integrate_sigma(problem: BoundedProblem, adjoints: Array, lengths: Array) -> SigmaIntegral:
    """Return an upper bound of ∫|σ| over stretches off the boundary arcs.

    Source: zeros isolated by the largest possible |σ''| in each cell.
    """
    plant = problem.plant
    rates = np.abs([*(mode.pole for mode in plant.modes), *plant.lag_rates])
    bend = _terms(problem, adjoints) @ rates**2 + _powers(problem, adjoints)[:, 2]
    cells = _first_cells(problem, adjoints, lengths)
    for _ in range(problem.settings.proof.halvings):
        unsure = _may_hide_zeros(cells, bend)
        if not unsure.any():
            break
        cells = _halved(problem, adjoints, cells, unsure)
    unsure = _may_hide_zeros(cells, bend)
    widths = (cells.right - cells.left)[unsure]
    allowance = float(np.sum(bend[cells.stretch[unsure]] * widths**3) / 4.0)
    stretch, zeros = _sign_changes(problem, adjoints, cells)
    index = np.concatenate([np.tile(np.arange(lengths.size), 2), stretch])
    points = np.concatenate([np.zeros(lengths.size), lengths, zeros])
    order = np.lexsort((points, index))
    index, points = index[order], points[order]
    primitive = np.sum(step_response(plant, points) * adjoints[index], axis=1)
    same = index[1:] == index[:-1]
    value = float(np.abs(np.diff(primitive))[same].sum())
    return SigmaIntegral(
        value=value + allowance,
        allowance=allowance,
        stretch=stretch,
        zeros=zeros,
    )


def sigma_magnitude(problem: BoundedProblem, adjoints: Array, lengths: Array) -> float:
    """Return ∫ of the summed magnitudes of the terms of σ: what rounding is relative to."""
    powers = _powers(problem, adjoints) * lengths[:, np.newaxis] ** (1, 2, 3) / (1, 2, 6)
    return float(_terms(problem, adjoints).sum(axis=1) @ lengths + powers.sum())


def largest_outputs(problem: BoundedProblem, rows: Array, *, t_f: float) -> Array:
    """Return bounds of |row x| over all motions from rest within the force limit.

    Source: F ∫|row g| ds <= F Σ (magnitude of each exponential) · min(t_f, its time constant), and
    for powers their integrals.
    """
    plant = problem.plant
    decays = -np.real([*(mode.pole for mode in plant.modes), *plant.lag_rates])
    spans = 1.0 / np.maximum(decays, 1.0 / t_f)
    powers = _powers(problem, rows) @ (t_f ** np.array([1, 2, 3]) / (1, 2, 6))
    return np.asarray(problem.force_limit * (_terms(problem, rows) @ spans + powers))


def _terms(problem: BoundedProblem, adjoint: Array) -> Array:
    """Return the largest magnitude of each exponential in σ; shape (..., n_rates)."""
    plant = problem.plant
    rigid, columns = _powers(problem, adjoint)[..., 0], []
    for mode in plant.modes:
        p = mode.pole
        passed = p if plant.follows else plant.force_lag * p + 1.0
        to_pole = 2.0 * mode.scale / ((p - p.conjugate()) * passed)
        d, v = adjoint[..., mode.deflection], adjoint[..., mode.rate]
        columns.append(np.abs(to_pole * (d + p * v)))
    for lag in plant.lag_rates:
        force = np.abs(adjoint[..., plant.force]) * -lag + 2.0 * rigid
        for mode in plant.modes:
            to_lag = mode.scale / (lag**2 - 2.0 * mode.pole.real * lag + abs(mode.pole) ** 2)
            d, v = adjoint[..., mode.deflection], adjoint[..., mode.rate]
            force = force + np.abs(lag * to_lag * (d + lag * v))
        columns.append(force)
    return np.stack(columns, axis=-1)


def _powers(problem: BoundedProblem, adjoint: Array) -> Array:
    """Return the largest magnitudes of what 1, τ and τ²/2 have in σ; shape (..., 3)."""
    plant, m = problem.plant, problem.plant.moving_mass
    x, v = np.abs(adjoint[..., plant.position]) / m, np.abs(adjoint[..., plant.velocity]) / m
    if not plant.follows:
        return np.stack([v + x * plant.force_lag, x, np.zeros_like(x)], axis=-1)
    still = np.abs(adjoint[..., plant.force])
    for mode in plant.modes:
        bent = mode.scale / mode.natural_frequency**2
        still = still + np.abs(bent * adjoint[..., mode.deflection])
    return np.stack([still, v, x], axis=-1)


def _sigma(
    problem: BoundedProblem, adjoints: Array, stretch: NDArray[np.intp], tau: Array
) -> tuple[Array, Array]:
    """Return σ and dσ/dτ at times before the ends of stretches."""
    response, adjoint = impulse_response(problem.plant, tau), adjoints[stretch]
    slopes = np.sum(response * (adjoint @ problem.plant.A), axis=1)
    return np.sum(response * adjoint, axis=1), slopes


def _first_cells(problem: BoundedProblem, adjoints: Array, lengths: Array) -> _Cells:
    counts = (
        np.ceil(lengths * problem.rate * problem.settings.proof.cells_per_radian).astype(np.intp)
        + 1
    )
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
    values, slopes, sure = cells.values[unsure], cells.slopes[unsure], ~unsure
    return _Cells(
        stretch=np.concatenate([cells.stretch[sure], stretch, stretch]),
        left=np.concatenate([cells.left[sure], left, middle]),
        right=np.concatenate([cells.right[sure], middle, right]),
        values=np.vstack(
            [
                cells.values[sure],
                np.column_stack([values[:, 0], value]),
                np.column_stack([value, values[:, 1]]),
            ]
        ),
        slopes=np.vstack(
            [
                cells.slopes[sure],
                np.column_stack([slopes[:, 0], slope]),
                np.column_stack([slope, slopes[:, 1]]),
            ]
        ),
    )


def _may_hide_zeros(cells: _Cells, bend: Array) -> NDArray[np.bool_]:
    """Return which cells may hold zeros that the signs at their ends do not show."""
    widths, most = cells.right - cells.left, bend[cells.stretch]
    monotone = np.abs(cells.slopes).max(axis=1) >= most * widths
    # Between its ends σ deviates from the chord by at most bend widths² / 8.
    clear = np.abs(cells.values).min(axis=1) >= most * widths**2 / 8.0
    return np.asarray(~monotone & ~(clear & (cells.values.prod(axis=1) > 0.0)))


def _sign_changes(
    problem: BoundedProblem, adjoints: Array, cells: _Cells
) -> tuple[NDArray[np.intp], Array]:
    """Return the zeros of σ with their stretches."""
    signs = np.sign(cells.values)
    where = signs[:, 0] * signs[:, 1] < 0.0
    stretch, low, high = cells.stretch[where], cells.left[where], cells.right[where]
    sign, adjoint = signs[where, 0], adjoints[stretch]
    for _ in range(problem.settings.proof.bisections):
        at = 0.5 * (low + high)
        same = np.sign(np.sum(impulse_response(problem.plant, at) * adjoint, axis=1)) == sign
        low, high = np.where(same, at, low), np.where(same, high, at)
    at = 0.5 * (low + high)
    for _ in range(problem.settings.proof.polishes):
        value, slope = _sigma(problem, adjoints, stretch, at)
        step = np.divide(value, slope, out=np.zeros_like(at), where=slope != 0.0)
        at = np.clip(at - step, low, high)
    return stretch, at
