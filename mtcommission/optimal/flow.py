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

from mtcommission.optimal.dual import sign_jumps
from mtcommission.optimal.moments import MomentProblem
from mtcommission.plant import Plant

Array = NDArray[np.float64]

UNIT = 1.6
"""Longest step of the power series against the fastest pole."""
TERMS = np.arange(22)
"""1.6^22 / 22! = 3e-17."""
FACTORIALS = np.cumprod(np.maximum(TERMS, 1.0))[:, np.newaxis, np.newaxis]
PIECES = np.arange(8) / 8
SHORT = 0.2
"""Parts of a unit at which the sign is checked: steps of at most ``SHORT`` of the fastest pole."""
DECAY = 41.0
"""e^-41 is below the unit roundoff: a mode is gone after DECAY times its time constant."""
LEAST = 8
"""Samples that are kept when all modes are gone."""
PLANTS = 32
"""Plants whose power series are kept."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DyadicFlow:
    """The flow of (x, F_set) over a step and its doubles up to the final time.

    Parameters
    ----------
    plant
        Plant with n states.
    unit
        Step [s]; the last double is the final time.
    series
        Terms of the power series of the flow in τ / ``scale``, shape (TERMS, n + 1, n + 1).
    scale
        [s].
    doubles
        Transposed flows over unit, 2 unit, 4 unit ..., each of shape (n + 1, n + 1).
    """

    plant: Plant
    unit: float
    series: Array
    scale: float
    doubles: tuple[Array, ...]


def dyadic_flow(plant: Plant, problem: MomentProblem, *, t_f: float) -> DyadicFlow:
    """Return the flow up to a final time.

    Parameters
    ----------
    plant
        Plant with n states.
    problem
        Tells how fast its poles are.
    t_f
        [s].

    Returns
    -------
    DyadicFlow

    Source: power series over the shortest step, then squaring; (x, F_set)' = [A B; 0 0] (x, F_set).
    """
    scale = 1.0 / float(problem.magnitudes.max())
    series = _series(plant, scale)
    bits = max(0, ceil(log2(t_f / (scale * UNIT))))
    unit = t_f / 2.0**bits
    powers = (unit / scale) ** TERMS
    flow = (powers @ series.reshape(TERMS.size, -1)).reshape(series.shape[1:]).T
    doubles = [flow]
    for _ in range(bits):
        flow = flow @ flow
        doubles.append(flow)
    return DyadicFlow(plant=plant, unit=unit, series=series, scale=scale, doubles=tuple(doubles))


@lru_cache(maxsize=PLANTS)
def _series(plant: Plant, scale: float) -> Array:
    n = plant.order
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = scale * plant.A, scale * plant.B
    powers = np.empty((TERMS.size, n + 1, n + 1))
    powers[0], powers[1] = np.eye(n + 1), joint
    known = 1
    while known + 1 < TERMS.size:
        more = powers[known + 1 : 2 * known + 1]
        np.matmul(powers[1 : len(more) + 1], powers[known], out=more)
        known *= 2
    return np.asarray(powers / FACTORIALS)


def final_state(flow: DyadicFlow, switching_times: Array, *, first_force: float) -> Array:
    """Return the state at t_f under a force that changes sign at the given times.

    Parameters
    ----------
    flow
        Of a plant with n states, up to t_f; at rest at t = 0.
    switching_times
        Ascending, shape (n_switches,) [s].
    first_force
        F_set on the first arc [N].

    Returns
    -------
    ndarray, shape (n,)

    Source: superposition of step responses Γ(τ) = ∫_0^τ e^{As} B ds, the last column of the flow.

    Examples
    --------
    >>> from mtcommission.machine import Positioning
    >>> from mtcommission.optimal.moments import moment_problem
    >>> from mtcommission.plant import build_plant
    >>> from tests.machines import paper_machine
    >>> plant = build_plant(paper_machine())
    >>> problem = moment_problem(plant, Positioning(distance=1.0))
    >>> flow = dyadic_flow(plant, problem, t_f=2.0)
    >>> x = final_state(flow, np.array([1.0]), first_force=750.0)
    >>> [round(float(x[i]), 6) for i in (plant.position, plant.velocity)]
    [0.999994, 0.0025]
    """
    n, bits = flow.plant.order, len(flow.doubles) - 1
    t_f = flow.unit * 2.0**bits
    ends = np.append(t_f - switching_times[::-1], t_f)
    whole = np.floor(ends / flow.unit).astype(np.int64)
    rest = (ends - whole * flow.unit) / flow.scale
    response = (rest[:, np.newaxis] ** TERMS) @ flow.series[:, :, n]
    is_in = (whole[:, np.newaxis] >> np.arange(bits + 1) & 1).astype(bool)
    for bit, double in enumerate(flow.doubles):
        np.copyto(response, response @ double, where=is_in[:, bit, np.newaxis])
    last_sign = (-1.0) ** switching_times.size
    jumps = sign_jumps(switching_times.size, first_sign=last_sign)
    return np.asarray(first_force * (jumps @ response[:, :n]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AdjointSamples:
    """λ_F along a move.

    Parameters
    ----------
    tau
        Remaining times, ascending from 0 to t_f, shape (k,) [s].
    force
        λ_F, shape (k,).
    """

    tau: Array
    force: Array


def adjoint_samples(flow: DyadicFlow, problem: MomentProblem, end: Array) -> AdjointSamples:
    """Return λ_F at steps of at most ``SHORT`` against the fastest pole that has not decayed.

    Parameters
    ----------
    flow
        Of a plant with n states, up to t_f.
    problem
        Its poles.
    end
        λ(t_f), shape (n,).

    Returns
    -------
    AdjointSamples

    Source: λ(τ) = λ(t_f) e^{Aτ}, integrated from t_f on, the stable direction. Each doubling takes
    all samples so far over as long again, and drops every second one once fast poles are gone.
    """
    n, force = flow.plant.order, flow.plant.force
    poles, unit = problem.rates.tolist(), flow.unit
    tau, step, length = PIECES * unit, unit / PIECES.size, unit
    rows = (tau / flow.scale)[:, np.newaxis] ** TERMS @ (end @ flow.series[:, :n, :n])
    taus, values = [tau], [rows[:, force]]
    for double in flow.doubles[:-1]:
        fastest = max((abs(p) for p in poles if -p.real * length < DECAY), default=0.0)
        while 2.0 * step * fastest <= SHORT and tau.size > LEAST:
            rows, tau, step = rows[::2], tau[::2], 2.0 * step
        taus.append(tau + length)
        values.append(rows @ double[force, :n])
        length *= 2.0
        if double is not flow.doubles[-2]:
            rows = np.concatenate((rows, rows @ double[:n, :n].T))
            tau = np.concatenate((tau, taus[-1]))
    taus.append(np.array([length]))
    values.append(np.array([end @ flow.doubles[-1][force, :n]]))
    return AdjointSamples(tau=np.concatenate(taus), force=np.concatenate(values))
