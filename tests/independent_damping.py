"""A damping-optimal control followed again, without the solver's adjoint.

States from rest under the published force, the adjoint backwards from t_f, cost and all by matrix
exponentials of the joint system (Van Loan 1978). λ(t_f) is fitted to the force where it is not
saturated, so that nothing of the solver's own λ is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, expm

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import DampingOptimum, Interior, terminal_target

Array = NDArray[np.float64]

STEP_ANGLE = 1.0 / 16.0
"""Step times the fastest eigenvalue, of the plant or of an arc [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Followed:
    """A published control, followed again."""

    # cost: the functional (5) [N² s]. cost_gap: by how much of itself it can at most exceed the
    # least one [-]: J is convex, so no admissible force v that reaches the target saves more than
    # ∫ s (F_set - v) dt with s = 2 F_set + λ_F / T, and |v| <= F_max.
    # law: largest |F_set - Proj(-λ_F / (2 T))| over F_max [-].
    # terminal_error: x(t_f) less the target over the peak, prescribed states only, shape (n,) [-].
    cost: float
    cost_gap: float
    law: float
    terminal_error: Array
    adjoint_initial: Array


def follow(plant: Plant, best: DampingOptimum) -> Followed:
    """Return what the published arcs do, and whether an adjoint fits them."""
    n, F, size = plant.order, best.force_limit, best.peaks[: plant.order]
    A, B = plant.A * size / size[:, None], plant.B / size
    weights = np.zeros(n)
    for weight in best.weights:
        weights[plant.states.index(weight.name)] += weight.value
    weights *= size**2
    target, fixed = terminal_target(plant, best.move)
    x, cost = np.zeros(n), 0.0
    h, forces, inside, pieces = [], [], [], []
    for arc in best.arcs:
        is_interior = isinstance(arc.control, Interior)
        generator, out, z = arc.generator, arc.output, arc.initial
        if not is_interior:
            generator, out, z = np.zeros((1, 1)), np.ones(1), np.array([out @ z])
        k = len(z)
        G = np.block([[generator, np.zeros((k, n))], [np.outer(B, out), A]])
        rate = max(np.abs(np.linalg.eigvals(matrix)).max() for matrix in (A, generator))
        count = max(1, ceil((arc.t_end - arc.t_start) * rate / STEP_ANGLE))
        step = (arc.t_end - arc.t_start) / count
        price = np.hstack([np.zeros((n, k)), np.diag(2.0 * weights)])
        joint = expm(step * np.block([[G, np.zeros((k + n, n))], [-price, -A.T]]))
        Q = block_diag(np.outer(out, out), np.diag(weights))
        paid = expm(step * np.block([[-G.T, Q], [np.zeros((k + n, k + n)), G]]))
        paid = paid[k + n :, k + n :].T @ paid[: k + n, k + n :]
        w = np.concatenate([z, x])
        for _ in range(count):
            h.append(step)
            forces.append(float(out @ w[:k]))
            inside.append(is_interior)
            pieces.append((joint[k + n :, : k + n] @ w, joint[k + n :, k + n :]))
            cost += float(w @ paid @ w)
            w = joint[: k + n, : k + n] @ w
        x = w[k:]
    forces.append(float(out @ w[:k]))
    inside.append(is_interior)
    # -λB/2 at the grid points as offset + gain λ(t_f), and λ(0) likewise.
    forced, free, push = np.zeros(n), np.eye(n), -B / 2.0
    offsets, gains = [0.0], [push]
    for pushed, ahead in reversed(pieces):
        forced, free = np.linalg.solve(ahead, forced - pushed), np.linalg.solve(ahead, free)
        offsets.append(float(push @ forced))
        gains.append(push @ free)
    offset, gain = np.array(offsets[::-1]), np.array(gains[::-1])[:, fixed]
    force, scale = np.array(forces), np.abs(gain).max(axis=0)
    open_ = np.array(inside)
    final = np.linalg.lstsq(gain[open_] / scale, (force - offset)[open_], rcond=None)[0] / scale
    wanted = offset + gain @ final
    slack = 2.0 * (force - wanted)
    saved = slack * force + F * np.abs(slack)
    return Followed(
        cost=cost,
        cost_gap=float(np.array(h) @ (saved[:-1] + saved[1:])) / 2.0 / cost,
        law=float(np.abs(force - np.clip(wanted, -F, F)).max()) / F,
        terminal_error=np.where(fixed, x - target / size, 0.0),
        adjoint_initial=(forced + free[:, fixed] @ final) / size,
    )
