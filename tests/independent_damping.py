"""A damping-optimal control integrated again, by another method and without the solver's adjoint.

The states are followed from rest under the published force, the adjoint backwards from t_f,
both by Gauss collocation with three stages (order 6) in steps of a sixteenth of a radian. λ(t_f)
is fitted to the force where it is not saturated, so that nothing of the solver's own λ is used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import Arc, DampingOptimum, Interior, terminal_target

Array = NDArray[np.float64]

STEP_ANGLE = 1.0 / 16.0
"""Step times the fastest eigenvalue, of the plant or of an arc [-]."""
ROOT = np.sqrt(15.0)
NODES = np.array([0.5 - ROOT / 10, 0.5, 0.5 + ROOT / 10])
SHARES = np.array([5 / 18, 4 / 9, 5 / 18])
STAGES = np.array(
    [
        [5 / 36, 2 / 9 - ROOT / 15, 5 / 36 - ROOT / 30],
        [5 / 36 + ROOT / 24, 2 / 9, 5 / 36 - ROOT / 24],
        [5 / 36 + ROOT / 30, 2 / 9 + ROOT / 15, 5 / 36],
    ]
)
"""Kuntzmann & Butcher, three stages: Hairer, Norsett & Wanner, Solving ODEs I, table II.7.4."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Followed:
    """A published control, integrated again."""

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Rule:
    """One step of x' = A x + G w: x_after = flow x + gain w, stages = inner x + share w."""

    flow: Array
    gain: Array
    inner: Array
    share: Array


def _rule(A: Array, G: Array, h: float) -> _Rule:
    """``w`` holds the inputs at the three stages one after the other."""
    n, k = G.shape
    solve = np.linalg.inv(np.eye(3 * n) - h * np.kron(STAGES, A))
    inner = solve @ np.kron(np.ones((3, 1)), np.eye(n))
    share = solve @ (h * np.kron(STAGES, G))
    total = h * np.kron(SHARES, np.eye(n))
    slopes = np.kron(np.eye(3), A)
    return _Rule(
        flow=np.eye(n) + total @ slopes @ inner,
        gain=total @ (slopes @ share + np.kron(np.eye(3), G)),
        inner=inner,
        share=share.reshape(3 * n, 3 * k),
    )


def follow(plant: Plant, best: DampingOptimum) -> Followed:
    """Return what the published arcs do, and whether an adjoint fits them."""
    n, F = plant.order, best.force_limit
    size = best.peaks[:n]
    A, B = plant.A * size / size[:, None], (plant.B / size)[:, None]
    weights = np.zeros(n)
    for weight in best.weights:
        weights[plant.states.index(weight.name)] += weight.value
    price = np.diag(2.0 * weights * size**2)
    target, fixed = terminal_target(plant, best.move)

    h, nodes, forces, inside = _sampled(plant, best)
    kinds = {step: _rule(A, B, step) for step in set(h.tolist())}
    back = {step: _rule(A.T, price, step) for step in kinds}

    x, cost, stages = np.zeros(n), 0.0, []
    for step, force in zip(h.tolist(), nodes, strict=True):
        rule = kinds[step]
        X = (rule.inner @ x + rule.share @ force).reshape(3, n)
        x = rule.flow @ x + rule.gain @ force
        cost += step * float((force**2 + (X * size) ** 2 @ weights) @ SHARES)
        stages.append(X)
    offset, gain, forced, free = _adjoint_backwards(h, stages, back, B[:, 0])
    final = _fit(gain[:, fixed], (forces - offset), inside)
    wanted = offset + gain[:, fixed] @ final
    slack = 2.0 * (forces - wanted)
    saved = np.asarray(slack * forces + F * np.abs(slack))
    return Followed(
        cost=cost,
        cost_gap=float(h @ (saved[:-1] + saved[1:])) / 2.0 / cost,
        law=float(np.abs(forces - np.clip(wanted, -F, F)).max()) / F,
        terminal_error=np.where(fixed, x - target / size, 0.0),
        adjoint_initial=(forced + free[:, fixed] @ final) / size,
    )


def _adjoint_backwards(
    h: Array, stages: list[Array], back: dict[float, _Rule], B: Array
) -> tuple[Array, Array, Array, Array]:
    """Return -λB/2 at the grid points as offset + gain λ(t_f), and λ(0) likewise."""
    n = B.size
    forced, free, push = np.zeros(n), np.eye(n), -B / 2.0
    offsets, gains = [0.0], [push]
    for step, X in zip(h[::-1].tolist(), reversed(stages), strict=True):
        rule = back[step]
        forced = rule.flow @ forced + rule.gain @ X[::-1].ravel()
        free = rule.flow @ free
        offsets.append(float(push @ forced))
        gains.append(push @ free)
    return np.array(offsets[::-1]), np.array(gains[::-1]), forced, free


def _fit(gain: Array, wanted: Array, inside: NDArray[np.bool_]) -> Array:
    scale = np.abs(gain).max(axis=0)
    solved = np.linalg.lstsq(gain[inside] / scale, wanted[inside], rcond=None)
    return np.asarray(solved[0] / scale)


def _sampled(plant: Plant, best: DampingOptimum) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """Return steps, the force at their stages and at the grid points, and where it is inside."""
    steps: list[float] = []
    nodes: list[list[float]] = []
    forces: list[float] = []
    inside: list[bool] = []
    rates = [float(np.abs(np.linalg.eigvals(plant.A)).max())]
    rates += [
        float(np.abs(np.linalg.eigvals(arc.generator)).max()) for arc in _first_interior(best)
    ]
    end = 0.0
    flows: dict[float, list[Array]] = {}
    for arc in best.arcs:
        length = arc.t_end - arc.t_start
        count = max(1, int(np.ceil(length * max(rates) / STEP_ANGLE)))
        h = float(f"{length / count:.13g}")
        is_interior = isinstance(arc.control, Interior)
        if is_interior and h not in flows:
            flows[h] = [expm(arc.generator * share * h) for share in (*NODES, 1.0)]
        z = arc.initial
        for _ in range(count):
            steps.append(h)
            forces.append(float(arc.output @ z))
            inside.append(is_interior)
            if is_interior:
                nodes.append([float(arc.output @ E @ z) for E in flows[h][:3]])
                z = flows[h][3] @ z
            else:
                nodes.append([float(arc.output @ z)] * 3)
        end = float(arc.output @ z)
    return (
        np.array(steps),
        np.array(nodes),
        np.array([*forces, end]),
        np.array([*inside, isinstance(best.arcs[-1].control, Interior)]),
    )


def _first_interior(best: DampingOptimum) -> list[Arc]:
    return [arc for arc in best.arcs if isinstance(arc.control, Interior)][:1]
