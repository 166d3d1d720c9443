"""The plant's own motion over dyadic steps, from the state space alone, without its modes.

Checks of what was found in modal coordinates: where a bang-bang force ends, and which sign the
adjoint has on the way.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.free.moments import PLANTS, MomentProblem
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

UNIT = 1.6
"""Longest step of the power series against the fastest pole."""
TERMS = np.arange(22)
"""1.6^22 / 22! = 3e-17."""
FACTORIALS = np.cumprod(np.maximum(TERMS, 1.0))[:, np.newaxis, np.newaxis]
PIECES = 8
PIECES_POWERS = (np.arange(PIECES)[:, np.newaxis] / PIECES) ** TERMS
SHORT = 0.2
"""Parts of a unit at which the sign is checked: steps of at most ``SHORT`` of the fastest pole."""
DECAY = 41.0
"""e^-41 is below the unit roundoff: a mode is gone after DECAY times its time constant."""
TINY = 1e-300


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DyadicSteps:
    """The flow of (x, F_set) of a plant with n states over a step and its doubles."""

    series: Array  # Terms of the power series of the flow in τ / step, shape (TERMS, n + 1, n + 1)
    # Transposed flows over 1, 2, 4 ... steps, each of shape (n + 1, n + 1).
    doubles: tuple[Array, ...]
    # e^{Aτ} B at every ``PIECES``th part of a step, for 2^k steps with k half the number of
    # doublings, shape (PIECES 2^k, n).
    columns: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DyadicFlow:
    """The plant's own motion up to a final time."""

    plant: Plant  # Plant with n states
    t_f: float  # Final time [s]
    unit: float  # Length of a step [s]
    steps: DyadicSteps  # Their flow; the last double reaches the final time


def dyadic_flow(plant: Plant, problem: MomentProblem, *, t_f: float) -> DyadicFlow:
    """Return the flow up to a final time.

    Source: power series over the shortest step, then squaring; (x, F_set)' = [A B; 0 0] (x, F_set).
    """
    unit = UNIT / max(problem.magnitudes.tolist())
    bits = max(0, ceil(log2(t_f / unit)))
    return DyadicFlow(plant=plant, t_f=t_f, unit=unit, steps=_steps(plant, unit, bits))


@lru_cache(maxsize=PLANTS)
def _steps(plant: Plant, unit: float, bits: int) -> DyadicSteps:
    series = _series(plant, unit)
    doubles = [series.sum(axis=0).T]
    for _ in range(bits):
        doubles.append(doubles[-1].dot(doubles[-1]))
    n, count, halves = plant.order, PIECES, bits // 2
    columns = np.empty((PIECES << halves, n))
    PIECES_POWERS.dot(series[:, :n, :n].dot(plant.B), out=columns[:count])
    for double in doubles[:halves]:
        columns[:count].dot(double[:n, :n], out=columns[count : 2 * count])
        count *= 2
    return DyadicSteps(series=series, doubles=tuple(doubles), columns=columns)


def _series(plant: Plant, scale: float) -> Array:
    n = plant.order
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = scale * plant.A, scale * plant.B
    powers = np.empty((TERMS.size, n + 1, n + 1))
    powers[0], powers[1] = np.eye(n + 1), joint
    known = 1
    while known + 1 < TERMS.size:
        more = powers[known + 1 : 2 * known + 1].reshape(-1, n + 1)
        powers[1:].reshape(-1, n + 1)[: len(more)].dot(powers[known], out=more)
        known *= 2
    powers /= FACTORIALS
    return powers


def states_at(
    flow: DyadicFlow, instants: Array, *, switching_times: Array, first_force: float
) -> Array:
    """Return the states at some instants under a force that changes sign at the given times.

    Source: superposition of step responses Γ(τ) = ∫_0^τ e^{As} B ds, the last column of the flow.

    Examples
    --------
    >>> from mtcommission.machine.moves import Positioning
    >>> from mtcommission.optimal.free.moments import moment_problem
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> problem = moment_problem(plant, Positioning(distance=1.0))
    >>> flow = dyadic_flow(plant, problem, t_f=2.0)
    >>> t_f, half = np.array([2.0]), np.array([1.0])
    >>> (x,) = states_at(flow, t_f, switching_times=half, first_force=750.0)
    >>> [round(float(x[i]), 6) for i in (plant.position, plant.velocity)]
    [0.999994, 0.0025]
    """
    n, doubles = flow.plant.order, flow.steps.doubles
    starts = np.concatenate(((0.0,), switching_times))
    # A step that is still to come has age 0, and no response.
    ages = np.maximum(instants[:, np.newaxis] - starts, 0.0).ravel() / flow.unit
    whole = ages.astype(np.int64)
    rest = ages - whole
    response = (rest[:, np.newaxis] ** TERMS).dot(flow.steps.series[:, :, n])
    is_in = (whole & (1 << np.arange(len(doubles)))[:, np.newaxis]).astype(bool)
    for chosen, double in zip(is_in[:, :, np.newaxis], doubles, strict=True):
        np.copyto(response, response.dot(double), where=chosen)
    steps = np.full(starts.size, -2.0 * first_force)
    steps[0], steps[2::2] = first_force, 2.0 * first_force
    return np.asarray(steps.dot(response.reshape(instants.size, starts.size, n + 1))[:, :n])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AdjointSamples:
    """λ B along a move: the switching function, -λ_F/T behind a force lag."""

    tau: Array  # Remaining times, ascending from 0 to t_f, shape (k,) [s]
    along: Array  # λ B, shape (k,)


def adjoint_samples(flow: DyadicFlow, problem: MomentProblem, end: Array) -> AdjointSamples:
    """Return λ B at steps of at most ``SHORT`` against the fastest pole that has not decayed.

    Source: λ(τ) = λ(t_f) e^{Aτ}, integrated from t_f on, the stable direction. With τ = a + b,
    λ B is λ(t_f) e^{Aa} times e^{Ab} B: rows for some long steps a and columns
    for some short ones b make all samples. Once fast poles are gone, columns are left out.
    """
    columns = flow.steps.columns
    count, short = len(columns), flow.unit / PIECES
    rows = _adjoint_rows(flow, end, every=count // PIECES)
    taus, values = [], []
    for start, stop, stride in _strides(problem, len(rows), count * short, count):
        taus.append(np.arange(start * count, stop * count, stride) * short)
        values.append(rows[start:stop].dot(columns[::stride].T).ravel())
    inside = taus[-1].searchsorted(flow.t_f)
    taus[-1], values[-1] = taus[-1][:inside], values[-1][:inside]
    taus.append(np.array([flow.t_f]))
    values.append(np.array([_adjoint_at_end(flow, rows[-1], (len(rows) - 1) * count * short)]))
    return AdjointSamples(tau=np.concatenate(taus), along=np.concatenate(values))


def _adjoint_rows(flow: DyadicFlow, end: Array, *, every: int) -> Array:
    """Return λ(t_f) e^{Aa} for all a before t_f, ``every`` steps apart, a power of 2."""
    n, known = flow.plant.order, 1
    rows = np.empty((ceil(flow.t_f / (flow.unit * every)), n))
    rows[0] = end
    for double in flow.steps.doubles[every.bit_length() - 1 :]:
        if known >= len(rows):
            break
        more = rows[known : 2 * known]
        rows[: len(more)].dot(double[:n, :n].T, out=more)
        known *= 2
    return rows


def _adjoint_at_end(flow: DyadicFlow, row: Array, start: float) -> float:
    """Return λ B at τ = t_f, given λ at the last row's τ."""
    n, columns, series = flow.plant.order, flow.steps.columns, flow.steps.series
    pieces = PIECES * (flow.t_f - start) / flow.unit
    whole = min(int(pieces), len(columns) - 1)
    powers = ((pieces - whole) / PIECES) ** TERMS
    rest = powers.dot(series.reshape(TERMS.size, -1)).reshape(series.shape[1:])
    return float(row.dot(rest[:n, :n]).dot(columns[whole]))


def _strides(
    problem: MomentProblem, n_rows: int, length: float, n_columns: int
) -> list[tuple[int, int, int]]:
    """Return (first row, end, stride over the columns), coarser once a fast pole has decayed."""
    parts: list[tuple[int, int, int]] = []
    start = 0
    for pole in sorted(problem.rates.tolist(), key=abs, reverse=True):
        # Until the pole is gone it sets the step; a slower one that is gone before sets none.
        gone = min(n_rows, ceil(min(DECAY / max(-pole.real * length, TINY), n_rows)))
        if gone > start:
            allowed = max(1.0, SHORT * n_columns / (abs(pole) * length))
            stride = min(n_columns, 1 << int(log2(allowed)))
            parts.append((start, gone, stride))
            start = gone
    if start < n_rows:
        parts.append((start, n_rows, n_columns))
    return parts
