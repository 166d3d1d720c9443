"""The arcs of the saturated linear-quadratic problem, found by iteration.

The control law F_set = Proj(-λ_F / (2 T)) is known, the arcs on which the projection acts are
not. Solve the linear boundary value problem of the present arcs (hamiltonian.py), saturate
wherever its unlimited control exceeds the limit, repeat: this is Newton's method for the
control law, since the flow is differentiable across an edge where the law holds. It converges
quadratically in the end, and arcs may come and go on the way. It starts without saturation;
where the full step fails, the limit is lowered to F_max by degrees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.damping.hamiltonian import (
    TERMS,
    ArcSequence,
    Labels,
    PiecewiseFlow,
    SaturatedProblem,
    solve_arcs,
)
from mtcommission.optimal.peaks import unit_cubics

Array = NDArray[np.float64]

LAW_TOLERANCE = 1e-6
"""Largest violation of the control law that counts as solved, in units of F_max [-]. Usually it
falls below ``LAW_GOAL``; close to t_f,min the multipliers grow and rounding stops it earlier."""

LAW_GOAL = 1e-10
"""Violation at which the iteration stops, in units of F_max [-]."""

DIVERGED = 1e3
"""Violation from which the iteration does not come back, in units of F_max [-] (empirical)."""

NEAR_ENOUGH = 1e-2
"""Violation at which a limit on the way to F_max has done its work, to start the next one, in
units of the limit [-] (empirical: with 0.1 some moves get stuck, with less all take longer)."""

ITERATIONS = 100
"""Arc iterations for one limit before the step is halved (empirical)."""

STEPS = 120
"""Limits tried on the way to F_max (empirical; a move at 1.0001 t_f,min takes about fifteen, one
of 30 000 radians with five modes some seventy)."""

SHORTEST_ARC = 1e-12
"""Arcs shorter than this share of t_f are left out: rounding of the time decides about them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Iterate:
    """One linear solve, judged."""

    arcs: ArcSequence  # Arcs that were assumed
    flow: PiecewiseFlow  # States and adjoints that follow
    violation: float  # Largest |u - Proj(w)|, in units of F_max


def crossings(problem: SaturatedProblem, flow: PiecewiseFlow) -> ArcSequence:
    """Return the arcs on which the unlimited control of a flow is beyond the limit."""
    w, rate = flow.control, flow.control_rate
    cubics = unit_cubics(
        np.diff(flow.t), w[:, :-1], w[:, 1:], start_rate=rate[:, :-1], end_rate=rate[:, 1:]
    ).reshape(4, -1)
    t = np.append(flow.t[:, :-1], flow.t[-1, -1])
    found = [_crossing_times(cubics, t, level=side * flow.bound) for side in (-1.0, 1.0)]
    levels = np.repeat([-flow.bound, flow.bound], [times.size for times in found])
    edges = _refine(problem, flow, np.concatenate(found), levels=levels)
    edges = np.concatenate([[0.0], np.sort(edges), [problem.t_f]])
    middle = _evaluate(cubics, t, (edges[1:] + edges[:-1]) / 2)
    labels = np.where(np.abs(middle) > flow.bound, np.sign(middle), 0.0).astype(np.int64)
    return _without_slivers(edges, labels)


def _crossing_times(cubics: Array, t: Array, *, level: float) -> Array:
    """Return where the interpolated control takes a value, shape (k,) [s]."""
    hull = _hull(cubics) - level
    cells = np.flatnonzero((hull.min(axis=0) <= 0.0) & (hull.max(axis=0) >= 0.0))
    if not cells.size:
        return np.zeros(0)
    side_by_side = PPoly(cubics[:, cells], np.arange(cells.size + 1.0))
    roots = side_by_side.solve(level, discontinuity=False, extrapolate=False)
    roots = roots[np.isfinite(roots)]
    index = np.minimum(roots.astype(np.int64), cells.size - 1)
    cell = cells[index]
    return np.asarray(t[cell] + (roots - index) * (t[cell + 1] - t[cell]))


def _evaluate(cubics: Array, t: Array, at: Array) -> Array:
    cell = np.clip(np.searchsorted(t, at, side="right") - 1, 0, t.size - 2)
    s = (at - t[cell]) / (t[cell + 1] - t[cell])
    c3, c2, c1, c0 = cubics[:, cell]
    return np.asarray(((c3 * s + c2) * s + c1) * s + c0)


def _without_slivers(edges: Array, labels: Labels) -> ArcSequence:
    """Return the arcs without those too short to be sampled; equal neighbours are joined."""
    long = np.diff(edges) > SHORTEST_ARC * edges[-1]
    starts, labels = edges[:-1][long], labels[long]
    new = np.append(True, labels[1:] != labels[:-1])
    inner = starts[new][1:]
    return ArcSequence(edges=np.concatenate([edges[:1], inner, edges[-1:]]), labels=labels[new])


def _refine(
    problem: SaturatedProblem, flow: PiecewiseFlow, edges: Array, *, levels: Array
) -> Array:
    if not edges.size:
        return edges
    per_piece = flow.t.shape[1] - 1
    starts = flow.t[:, :-1].ravel()
    cell = np.searchsorted(starts, edges, side="right") - 1
    piece, sample = cell // per_piece, cell % per_piece
    z = flow.powers[flow.owner[piece], sample] @ flow.starts[piece][..., None]
    farthest = (flow.t[piece, sample + 1] - starts[cell]) / 10
    tau = edges - starts[cell]
    rows = np.array([problem.control_row, problem.control_rate_row]) @ problem.series
    terms = (rows[flow.labels[piece] + 1] @ z[:, None])[..., 0]
    for _ in range(2):
        powers = (tau[:, None] * problem.rate) ** np.arange(TERMS)
        now = (powers[:, :, None] * terms).sum(axis=1)
        excess, slope = now[:, 0] - levels, now[:, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            tau = tau - np.clip(np.nan_to_num(excess / slope), -farthest, farthest)
    return np.clip(starts[cell] + tau, 0.0, problem.t_f)


def _judge(problem: SaturatedProblem, arcs: ArcSequence, *, bound: float) -> Iterate:
    flow = solve_arcs(problem, arcs, bound=bound)
    w = flow.control
    control = np.where(flow.labels[:, None] == 0, w, flow.labels[:, None] * bound)
    violation = float(np.abs(control - np.clip(w, -bound, bound)).max())
    return Iterate(arcs=arcs, flow=flow, violation=violation)


def _settle(problem: SaturatedProblem, arcs: ArcSequence, *, bound: float, goal: float) -> Iterate:
    """Return the first iterate of the arc iteration within the goal, else the best one."""
    best = _judge(problem, arcs, bound=bound)
    now = best
    for _ in range(ITERATIONS):
        if best.violation <= goal * bound or now.violation > DIVERGED:
            break
        try:
            now = _judge(problem, crossings(problem, now.flow), bound=bound)
        except np.linalg.LinAlgError:
            break
        stagnant = best.violation <= LAW_TOLERANCE * bound and now.violation > best.violation / 4
        if now.violation < best.violation:
            best = now
        if stagnant:
            break
    return best


def _hull(cubics: Array) -> Array:
    """Return the Bernstein coefficients of cubics on the unit interval: they enclose the values."""
    c3, c2, c1, c0 = cubics
    return np.stack([c0, c0 + c1 / 3, c0 + (2 * c1 + c2) / 3, c0 + c1 + c2 + c3])


def solve_saturated(problem: SaturatedProblem) -> Iterate:
    """Return the solution, lowering the limit to F_max by degrees if one step will not do.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE, also where t_f is below the shortest time.
    """
    free = ArcSequence(edges=np.array([0.0, problem.t_f]), labels=np.zeros(1, dtype=np.int64))
    reached = _judge(problem, free, bound=1.0)
    limit = 1.0 + reached.violation
    trial, fraction = 1.0, 1.0
    for _ in range(STEPS):
        is_last = trial == 1.0
        goal = LAW_GOAL if is_last else NEAR_ENOUGH
        now = _settle(problem, reached.arcs, bound=trial, goal=goal)
        settled = now.violation <= (LAW_TOLERANCE if is_last else NEAR_ENOUGH) * trial
        if settled and is_last:
            return now
        if settled:
            limit, reached, fraction = trial, now, min(0.9, 1.5 * fraction)
        else:
            fraction /= 2.0
            # a better start of the next step, before steps get small
            reached = _settle(problem, reached.arcs, bound=limit, goal=LAW_GOAL)
        trial = max(1.0, limit * (1.0 - fraction))
    detail = Message(
        "damping-not-solved",
        t_f=problem.t_f,
        force=problem.force_limit,
        solved=limit * problem.force_limit,
        unit=problem.force_unit,
    )
    raise ComputationError(Outcome.NO_CONVERGENCE, detail)
