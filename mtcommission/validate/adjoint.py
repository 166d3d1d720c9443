"""The adjoint equation by matrix exponentials, apart from the solvers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.optimal.solution import Arc, DampingOptimum, Interior
from mtcommission.plant.plant import Plant
from mtcommission.validate.paper import FORCE_LAG, FORCE_LIMIT, MECHANICS

Array = NDArray[np.float64]

DIFFERENCE_STEP = 1e-8
"""Step of a switching time for a difference quotient [s]; the quotient is right to 4 digits."""
GRID = 4000
"""Instants at which a sign of λ_F is looked at; a short arc of 0.3 ms is 30 of them."""


def printed_adjoint_matrix() -> Array:
    """Return the matrix M of the printed adjoint equations dλ/dt = M λ, λ as a column.

    Source: Christiansen, Maurer & Zirn, eq. (8), coefficient by coefficient.

    Examples
    --------
    >>> printed_adjoint_matrix()[3]
    array([-1.        ,  0.        ,  0.        , 18.88888889,  0.        ,
            0.        ,  0.        ])
    """
    m_b, m_s, J = MECHANICS.base_mass, MECHANICS.slider_mass, MECHANICS.rotary_inertia
    k_b, d_b = MECHANICS.base_stiffness, MECHANICS.base_damping
    k, d, r, T = (
        MECHANICS.rotary_stiffness,
        MECHANICS.rotary_damping,
        MECHANICS.lever_arm,
        FORCE_LAG,
    )
    M = np.zeros((7, 7))
    M[0, 3] = k_b / m_b
    M[2, 5] = k / J
    M[3, [0, 3]] = -1.0, d_b / m_b
    M[4, 1] = -1.0
    M[5, [2, 5]] = -1.0, d / J
    M[6, [3, 4, 5, 6]] = 1.0 / m_b, -1.0 / m_s, -r / J, 1.0 / T
    return M


def adjoint_from_switches(plant: Plant, switching_times: Array) -> Array:
    """Return the λ(0) for which λ_F vanishes at five switching times and H = 0.

    Source: λ(t) = λ(0) e^{-At}, and H = 1 + λ(0) B F_max = 0 at rest.

    Examples
    --------
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.validate.paper import SWITCHING_TIMES, paper_machine
    >>> plant = build_plant(paper_machine())
    >>> round(float(adjoint_from_switches(plant, np.array(SWITCHING_TIMES))[0]), 3)
    -11.889
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
    total = np.zeros(plant.order)
    for i in range(switching_times.size):
        moved = switching_times.copy()
        moved[i] += DIFFERENCE_STEP
        total += np.abs(adjoint_from_switches(plant, moved) - base) / DIFFERENCE_STEP
    return total * accuracy


def zeros_forward(plant: Plant, initial: Array, *, t_f: float) -> Array:
    """Return the zeros of λ_F if λ(0) is integrated forward."""
    t, transition = np.linspace(0.0, t_f, GRID + 1), expm(-plant.A * (t_f / GRID))
    values, row = np.empty(GRID + 1), initial
    for i in range(GRID + 1):
        values[i] = row[plant.force]
        row = row @ transition
    return _zeros(t, values)


def zeros_backward(plant: Plant, initial: Array, *, t_f: float) -> Array:
    """Return the zeros of λ_F with λ_F(t_f) from H = 0, the other components from λ(0)."""
    end = initial @ expm(-plant.A * t_f)
    # At the target A x is λ_xs v_s = 0, so H = 1 + λ_F F_set / T with F_set = -F_max.
    end[plant.force] = plant.force_lag / FORCE_LIMIT
    values, row, transition = np.empty(GRID + 1), end, expm(plant.A * (t_f / GRID))
    for i in range(GRID, -1, -1):
        values[i] = row[plant.force]
        row = row @ transition
    return _zeros(np.linspace(0.0, t_f, GRID + 1), values)


def _zeros(t: Array, values: Array) -> Array:
    i = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0.0)
    share = values[i] / (values[i] - values[i + 1])
    return np.asarray(t[i] + share * (t[i + 1] - t[i]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowedLaw:
    """The adjoint that fits a damping-optimal control best, found from the control alone."""

    t: Array  # Shape (n_samples,) [s]
    force: Array  # F_set of the arcs, shape (n_samples,) [N]
    wanted: Array  # -λ_F / 2T, shape (n_samples,) [N]
    adjoint_initial: Array  # λ(0), shape (n,)

    @property
    def residual(self) -> float:
        """Largest |F_set - Proj(-λ_F / 2T)| / F_max."""
        law = np.clip(self.wanted, -FORCE_LIMIT, FORCE_LIMIT)
        return float(np.abs(self.force - law).max()) / FORCE_LIMIT


def follow_law(plant: Plant, damping: DampingOptimum, *, samples: int) -> FollowedLaw:
    """Return the adjoint with which the control law (16) fits a control best.

    States go forward and the adjoint backward from t_f, as errors decay. λ(t_f) is fitted to
    the force on the interior arcs, so nothing of the solver's own adjoint is used.

    Source: Christiansen, Maurer & Zirn, sec. 6, with dλ/dt = -2 D x - λ A.
    """
    n = plant.order
    steps = _steps(plant, damping, samples)
    # λ(t) = free λ(t_f) + forced, both backward from t_f
    free, forced = np.eye(n), np.zeros(n)
    row = -plant.B / 2.0
    gains, offsets = [row @ free], [float(row @ forced)]
    for step in reversed(steps):
        back = expm(plant.A.T * step.length)
        free, forced = back @ free, back @ (forced - step.source)
        gains.append(row @ free)
        offsets.append(float(row @ forced))
    gain, offset = np.array(gains[::-1]), np.array(offsets[::-1])
    force = np.array([*(step.force for step in steps), _last_force(damping)])
    inside = np.array([*(step.is_interior for step in steps), False])
    fitted = np.arange(n) != plant.position
    scale = np.abs(gain[:, fitted]).max(axis=0)
    final = np.zeros(n)
    solved = np.linalg.lstsq(gain[inside][:, fitted] / scale, (force - offset)[inside], rcond=None)
    final[fitted] = solved[0] / scale
    return FollowedLaw(
        t=np.append(np.cumsum([0.0, *(step.length for step in steps)])[:-1], damping.t_f),
        force=force,
        wanted=gain @ final + offset,
        adjoint_initial=free @ final + forced,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Step:
    """A step of time: what state and force on it add to the adjoint at its end."""

    length: float
    force: float
    is_interior: bool
    source: Array


def _steps(plant: Plant, damping: DampingOptimum, samples: int) -> list[_Step]:
    n, steps = plant.order, []
    x = np.zeros(n)
    for arc in damping.arcs:
        length = arc.t_end - arc.t_start
        count = max(1, int(np.ceil(samples * length / damping.t_f)))
        transition = expm(_state_and_adjoint(plant, damping, arc) * (length / count))
        inner = arc.initial
        for _ in range(count):
            after = transition @ np.concatenate([x, np.zeros(n), inner])
            steps.append(
                _Step(
                    length=length / count,
                    force=float(arc.output @ inner),
                    is_interior=isinstance(arc.control, Interior),
                    source=after[n : 2 * n],
                )
            )
            x, inner = after[:n], after[2 * n :]
    return steps


def _last_force(damping: DampingOptimum) -> float:
    arc = damping.arcs[-1]
    return float(arc.output @ expm(arc.generator * (arc.t_end - arc.t_start)) @ arc.initial)


def _state_and_adjoint(plant: Plant, damping: DampingOptimum, arc: Arc) -> Array:
    """Return the generator of (x, λ, input of the arc)."""
    n, k = plant.order, arc.initial.size
    system = np.zeros((2 * n + k, 2 * n + k))
    system[:n, :n], system[:n, 2 * n :] = plant.A, np.outer(plant.B, arc.output)
    system[n : 2 * n, n : 2 * n] = -plant.A.T
    for weight in damping.weights:
        i = plant.states.index(weight.state)
        system[n + i, i] = -2.0 * weight.value
    system[2 * n :, 2 * n :] = arc.generator
    return system
