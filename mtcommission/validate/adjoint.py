"""The adjoint equation by matrix exponentials, apart from the solvers."""

from __future__ import annotations

from math import inf
from typing import Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import expm
from scipy.signal import lsim

from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import DampingOptimum, Interior, powers_of, sample_trajectory
from mtcommission.validate.cases import Array
from mtcommission.validate.paper import FORCE_LIMIT

DIFFERENCE_STEP = 1e-8
"""Step of a switching time for a difference quotient [s]; the quotient is right to 4 digits."""
GRID = 4000
"""Instants at which a sign of λ_F is looked at; a short arc of 0.3 ms is 30 of them."""


def printed_adjoint_matrix(m: Manipulator, *, force_lag: float) -> Array:
    """Return the matrix M of the printed adjoint equations dλ/dt = M λ, λ as a column.

    Source: Christiansen, Maurer & Zirn, eq. (8), coefficient by coefficient.
    """
    M, J = np.zeros((7, 7)), m.rotary_inertia
    M[0, 3] = m.base_stiffness / m.base_mass
    M[2, 5] = m.rotary_stiffness / J
    M[3, [0, 3]] = -1.0, m.base_damping / m.base_mass
    M[4, 1] = -1.0
    M[5, [2, 5]] = -1.0, m.rotary_damping / J
    M[6, 3:] = 1.0 / m.base_mass, -1.0 / m.slider_mass, -m.lever_arm / J, 1.0 / force_lag
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


def follow_adjoint(
    plant: Plant, initial: Array, *, t_f: float, way: Literal["on", "back"]
) -> tuple[Array, Array]:
    """Return times and λ_F, followed on from λ(0) or back from t_f with H = 0 there."""
    row, step, t = initial, t_f / GRID, np.linspace(0.0, t_f, GRID + 1)
    if way == "on":
        return t, powers_of(expm(-plant.A * step).T, row, GRID)[:, plant.force]
    # At the target A x is λ_xs v_s = 0, so H = 1 + λ_F F_set / T with F_set = -F_max.
    row = initial @ expm(-plant.A * t_f)
    row[plant.force] = plant.force_lag / FORCE_LIMIT
    return t, powers_of(expm(plant.A * step).T, row, GRID)[::-1, plant.force]


def zeros(plant: Plant, initial: Array, *, t_f: float, way: Literal["on", "back"]) -> Array:
    """Return the zeros of λ_F so followed [s]."""
    t, values = follow_adjoint(plant, initial, t_f=t_f, way=way)
    at = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0.0)
    return np.asarray(t[at] + values[at] / (values[at] - values[at + 1]) * t_f / GRID)


def largest_distance(found: Array, times: tuple[float, ...]) -> float:
    """Return the largest distance of a zero from its switch [s]; inf if the numbers differ."""
    return float(np.abs(found - times).max()) if found.size == len(times) else inf


def law_residual(plant: Plant, damping: DampingOptimum, *, samples: int) -> float:
    """Return the largest |F_set - Proj(-λ_F / 2T)| / F_max, with the adjoint that fits best.

    λ goes backward from t_f, as errors decay; λ(t_f) is fitted to the force on the interior
    arcs, so that nothing of the solver's own adjoint is used.

    Source: Christiansen, Maurer & Zirn, sec. 6, with dλ/dt = -2 D x - λ A.
    """
    step = damping.t_f / samples
    motion = sample_trajectory(plant, damping.arcs, step=step)
    rates = motion.states @ plant.A.T + np.outer(motion.force, plant.B)
    remaining = np.linspace(0.0, damping.t_f, samples + 1)
    t = damping.t_f - remaining
    source = np.zeros((plant.order, plant.order))
    for weight in damping.weights:
        i = plant.states.index(weight.name)
        source[i, i] = 2.0 * weight.value
    backward = (plant.A.T, source, -plant.B[None] / 2.0, np.zeros((1, plant.order)))
    _, offset, _ = lsim(backward, CubicHermiteSpline(motion.t, motion.states, rates)(t), remaining)
    gain = -0.5 * powers_of(expm(plant.A * step), plant.B, samples)
    gain = np.delete(gain, plant.position, axis=1)
    gain /= np.abs(gain).max(axis=0)
    arcs = np.searchsorted([arc.t_end for arc in damping.arcs[:-1]], t)
    inside = np.array([isinstance(arc.control, Interior) for arc in damping.arcs])[arcs]
    force = np.interp(t, motion.t, motion.force)
    final = np.linalg.lstsq(gain[inside], (force - offset)[inside], rcond=None)[0]
    law = np.clip(gain @ final + offset, -FORCE_LIMIT, FORCE_LIMIT)
    return float(np.abs(force - law).max()) / FORCE_LIMIT
