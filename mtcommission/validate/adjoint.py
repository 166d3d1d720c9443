"""The adjoint equation by matrix exponentials, apart from the solvers."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import expm
from scipy.signal import lsim

from mtcommission.optimal.solution import DampingOptimum, Interior, sample_trajectory
from mtcommission.plant.plant import Plant
from mtcommission.validate.paper import FORCE_LAG, FORCE_LIMIT, MECHANICS, Array

DIFFERENCE_STEP = 1e-8
"""Step of a switching time for a difference quotient [s]; the quotient is right to 4 digits."""
GRID = 4000
"""Instants at which a sign of λ_F is looked at; a short arc of 0.3 ms is 30 of them."""


def printed_adjoint_matrix() -> Array:
    """Return the matrix M of the printed adjoint equations dλ/dt = M λ, λ as a column.

    Source: Christiansen, Maurer & Zirn, eq. (8), coefficient by coefficient.
    """
    m_b, m_s, J = MECHANICS.base_mass, MECHANICS.slider_mass, MECHANICS.rotary_inertia
    k_b, d_b = MECHANICS.base_stiffness, MECHANICS.base_damping
    k, d, r = MECHANICS.rotary_stiffness, MECHANICS.rotary_damping, MECHANICS.lever_arm
    M = np.zeros((7, 7))
    M[0, 3] = k_b / m_b
    M[2, 5] = k / J
    M[3, [0, 3]] = -1.0, d_b / m_b
    M[4, 1] = -1.0
    M[5, [2, 5]] = -1.0, d / J
    M[6, [3, 4, 5, 6]] = 1.0 / m_b, -1.0 / m_s, -r / J, 1.0 / FORCE_LAG
    return M


def adjoint_from_switches(plant: Plant, switching_times: Array) -> Array:
    """Return the λ(0) for which λ_F vanishes at five switching times and H = 0.

    Source: λ(t) = λ(0) e^{-At}, and H = 1 + λ(0) B F_max = 0 at rest.
    """
    unknown = np.arange(plant.order) != plant.position
    columns = [expm(-plant.A * t) @ plant.B for t in switching_times.tolist()]
    rows = np.array([*columns, plant.B])[:, unknown]
    scale = np.abs(rows).max(axis=0)
    right = np.append(np.zeros(switching_times.size), -1.0 / FORCE_LIMIT)
    found = np.zeros(plant.order)
    found[unknown] = np.linalg.solve(rows / scale, right) / scale
    return found


def adjoint_uncertainty(plant: Plant, switching_times: Array, *, accuracy: float) -> Array:
    """Return by how much λ(0) may err where each switching time errs by ``accuracy`` [s]."""
    base = adjoint_from_switches(plant, switching_times)
    moved = switching_times + DIFFERENCE_STEP * np.eye(switching_times.size)
    errors = [np.abs(adjoint_from_switches(plant, times) - base) for times in moved]
    return np.asarray(np.sum(errors, axis=0) * accuracy / DIFFERENCE_STEP)


def zeros(plant: Plant, initial: Array, *, t_f: float, way: Literal["on", "back"]) -> Array:
    """Return the zeros of λ_F, followed on from λ(0) or back from t_f with H = 0 there [s]."""
    values, row, step = np.empty(GRID + 1), initial, -t_f / GRID
    if way == "back":
        # At the target A x is λ_xs v_s = 0, so H = 1 + λ_F F_set / T with F_set = -F_max.
        row, step = initial @ expm(-plant.A * t_f), -step
        row[plant.force] = plant.force_lag / FORCE_LIMIT
    transition = expm(plant.A * step)
    for i in range(GRID + 1):
        values[i] = row[plant.force]
        row = row @ transition
    if way == "back":
        values = values[::-1]
    t = np.linspace(0.0, t_f, GRID + 1)
    at = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0.0)
    return np.asarray(t[at] + values[at] / (values[at] - values[at + 1]) * t_f / GRID)


def law_residual(plant: Plant, damping: DampingOptimum, *, samples: int) -> float:
    """Return the largest |F_set - Proj(-λ_F / 2T)| / F_max, with the adjoint that fits best.

    λ goes backward from t_f, as errors decay; λ(t_f) is fitted to the force on the interior
    arcs, so that nothing of the solver's own adjoint is used.

    Source: Christiansen, Maurer & Zirn, sec. 6, with dλ/dt = -2 D x - λ A.
    """
    n = plant.order
    motion = sample_trajectory(plant, damping.arcs, step=damping.t_f / samples)
    rate = motion.states @ plant.A.T + np.outer(motion.force, plant.B)
    states = CubicHermiteSpline(motion.t, motion.states, rate)
    remaining = np.linspace(0.0, damping.t_f, samples + 1)
    t = damping.t_f - remaining
    source = np.zeros((n, n))
    for weight in damping.weights:
        i = plant.states.index(weight.state)
        source[i, i] = 2.0 * weight.value
    backward = (plant.A.T, source, -plant.B[None] / 2.0, np.zeros((1, n)))
    _, offset, _ = lsim(backward, states(t), remaining)
    fitted = np.delete(np.eye(n), plant.position, axis=0)
    gain = np.array([lsim(backward, np.zeros((t.size, n)), remaining, X0=x)[1] for x in fitted]).T
    arcs = np.searchsorted([arc.t_end for arc in damping.arcs[:-1]], t)
    inside = np.array([isinstance(arc.control, Interior) for arc in damping.arcs])[arcs]
    force = np.interp(t, motion.t, motion.force)
    scale = np.abs(gain).max(axis=0)
    final = np.linalg.lstsq((gain / scale)[inside], (force - offset)[inside], rcond=None)[0]
    wanted = gain @ (final / scale) + offset
    law = np.clip(wanted, -FORCE_LIMIT, FORCE_LIMIT)
    return float(np.abs(force - law).max()) / FORCE_LIMIT
