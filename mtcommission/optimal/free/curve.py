"""The time-optimal controls of one move for many forces, solved together and each one proved.

The moment problem does not depend on the force, only on span = target / F_max, so the optima of
all forces lie on one curve. From its ends inwards each control starts from its neighbours; one
Newton iteration and one search for zeros then serve all controls at once. What is not proved so is
solved alone, and what cannot be solved alone is left unproved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError
from mtcommission.optimal.free.curve_proof import prove_bounds
from mtcommission.optimal.free.dual import sign_jumps
from mtcommission.optimal.free.mesh import grade
from mtcommission.optimal.free.moments import MomentProblem
from mtcommission.optimal.free.newton_refinement import CONVERGED, TINY, TO_BOUNDARY
from mtcommission.optimal.free.search import AGREEMENT, find_bang_bang

Array = NDArray[np.float64]

NEWTON_STEPS = 8
"""From a neighbour four are usual."""
FEASIBLE = 1e-12
"""Moments against ∫|φ|; a hundredth of what the solver for one force accepts."""
FINE = 0.05
"""|p| h of the sums for ∫|φ|, which only scale the equations [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CurvePoint:
    """A bang-bang control on the curve."""

    zeros: Array  # Remaining times of the switches, ascending, shape (k,) [s]
    t_f: float  # Final time [s]
    lower_bound: float  # Proved: no admissible force needs less [s]; 0 where nothing is proved
    first_sign: float  # Sign of the force at the end of the move
    multipliers: Array  # c, shape (size,)

    @property
    def is_proved(self) -> bool:
        """Whether t_f is its own lower bound up to 1e-12."""
        return self.t_f - self.lower_bound <= AGREEMENT * self.t_f

    @property
    def switching_times(self) -> Array:
        """Ascending, shape (k,) [s]."""
        return self.t_f - self.zeros[::-1]


def solve_curve(problem: MomentProblem, spans: Array) -> tuple[CurvePoint, ...]:
    """Return the time-optimal controls for many spans.

    Source: docs/optimal-control.md, sections 2 and 3.

    Examples
    --------
    >>> from mtcommission.optimal.free.moments import moment_problem
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> machine = read_shipped("milling-manipulator").machine
    >>> problem = moment_problem(build_plant(machine), machine.moves[0])
    >>> points = solve_curve(problem, problem.target / np.array([1e3, 2e3, 4e3]))
    >>> [(round(point.t_f, 6), point.is_proved) for point in points]
    [(0.082396, True), (0.04352, True), (0.026324, True)]
    """
    order = np.argsort(spans, kind="stable")
    ascending = spans[order]
    last = ascending.size - 1
    known: dict[int, CurvePoint] = {}
    level = [(0, 0, 0), (last, last, last)][: last + 1]
    while level:
        starts = [_start(ascending, known, left, middle, right) for left, middle, right in level]
        wanted = ascending[[middle for _, middle, _ in level]]
        found = _solve_level(problem, wanted, starts)
        known |= {middle: point for (_, middle, _), point in zip(level, found, strict=True)}
        level = _next_level(level, last)
    points = [known[i] for i in range(ascending.size)]
    return tuple(points[i] for i in np.argsort(order, kind="stable"))


def _next_level(level: list[tuple[int, int, int]], last: int) -> list[tuple[int, int, int]]:
    """Return (left, middle, right) of the halves that still have a middle."""
    first = level[0][0] == level[0][2]
    gaps = (
        [(0, last)]
        if first
        else [gap for left, middle, right in level for gap in ((left, middle), (middle, right))]
    )
    return [(left, (left + right) // 2, right) for left, right in gaps if right - left > 1]


def _start(
    spans: Array, known: dict[int, CurvePoint], left: int, middle: int, right: int
) -> CurvePoint | None:
    """Return a guess from the neighbours; None where there is none."""
    near = [known[i] for i in (left, right) if i in known and known[i].is_proved]
    if len(near) < 2:
        return near[0] if near else None
    a, b = near
    share = (
        0.5
        if spans[left] == spans[right]
        else float((spans[middle] - spans[left]) / (spans[right] - spans[left]))
    )
    if a.zeros.size != b.zeros.size or a.first_sign != b.first_sign:
        return a if share < 0.5 else b
    return CurvePoint(
        zeros=a.zeros + share * (b.zeros - a.zeros),
        t_f=a.t_f + share * (b.t_f - a.t_f),
        lower_bound=0.0,
        first_sign=a.first_sign,
        multipliers=a.multipliers + share * (b.multipliers - a.multipliers),
    )


def _solve_level(
    problem: MomentProblem, spans: Array, starts: Sequence[CurvePoint | None]
) -> list[CurvePoint]:
    found: list[CurvePoint | None] = [None] * spans.size
    groups: dict[tuple[int, float], list[int]] = {}
    for i, start in enumerate(starts):
        if start is not None:
            groups.setdefault((start.zeros.size, start.first_sign), []).append(i)
    for members in groups.values():
        chosen = [start for i in members if (start := starts[i]) is not None]
        for i, point in zip(members, _refined(problem, spans[members], chosen), strict=True):
            found[i] = point
    attempts = _proved(problem, spans, found)
    alone = [point if point and point.is_proved else None for point in attempts]
    for i, point in enumerate(alone):
        if point is None:
            alone[i] = _solve_alone(problem, float(spans[i]))
    return [point for point in alone if point is not None]


def _solve_alone(problem: MomentProblem, span: float) -> CurvePoint:
    try:
        control = find_bang_bang(problem, span=span).control
    except ComputationError:
        return CurvePoint(
            zeros=np.empty(0),
            t_f=1.0,
            lower_bound=0.0,
            first_sign=1.0,
            multipliers=np.zeros(problem.size),
        )
    point = CurvePoint(
        zeros=control.zeros,
        t_f=control.horizon,
        lower_bound=0.0,
        first_sign=control.first_sign,
        multipliers=control.multipliers,
    )
    return _proved(problem, np.array([span]), [point])[0] or point


def _proved(
    problem: MomentProblem, spans: Array, points: Sequence[CurvePoint | None]
) -> list[CurvePoint | None]:
    """Return the points with their lower bounds."""
    places = [i for i, point in enumerate(points) if point is not None]
    result: list[CurvePoint | None] = [None] * len(points)
    if not places:
        return result
    given = [point for point in points if point is not None]
    times = np.array([point.t_f for point in given])
    multipliers = np.array([point.multipliers for point in given])
    bounds = prove_bounds(problem, multipliers, spans[places], times)
    for i, point, bound in zip(places, given, bounds.tolist(), strict=True):
        result[i] = CurvePoint(
            zeros=point.zeros,
            t_f=point.t_f,
            lower_bound=min(bound, point.t_f),
            first_sign=point.first_sign,
            multipliers=point.multipliers,
        )
    return result


def _refined(
    problem: MomentProblem, spans: Array, starts: Sequence[CurvePoint]
) -> list[CurvePoint | None]:
    """Return Newton's result for each start of one structure; None where it did not converge."""
    ends = np.array([[*point.zeros, point.t_f] for point in starts])
    c = np.array([point.multipliers for point in starts])
    sign = starts[0].first_sign
    jumps = sign_jumps(ends.shape[1] - 1, first_sign=sign)
    scale = np.column_stack([_norms(problem, ends[:, -1]), spans])
    residual = np.full(spans.size, np.inf)
    best_ends, best_c = ends, c
    for _ in range(NEWTON_STEPS):
        defect = _defect(problem, ends, jumps, spans) / scale
        size = np.where(np.isfinite(defect), np.abs(defect), np.inf).max(axis=1)
        better = size < residual
        best_ends = np.where(better[:, np.newaxis], ends, best_ends)
        best_c = np.where(better[:, np.newaxis], c, best_c)
        residual = np.where(better, size, residual)
        if not better.any() or residual.max() <= 0.1 * CONVERGED:
            break
        try:
            ends, c = _step(problem, ends, c, jumps=jumps, defect=defect, scale=scale)
        except np.linalg.LinAlgError:
            break
    rising = np.all(np.diff(best_ends, axis=1, prepend=0.0) > 0.0, axis=1)
    return [
        CurvePoint(
            zeros=row[:-1],
            t_f=float(row[-1]),
            lower_bound=0.0,
            first_sign=sign,
            multipliers=multipliers,
        )
        if is_good
        else None
        for row, multipliers, is_good in zip(
            best_ends, best_c, (rising & (residual <= FEASIBLE)).tolist(), strict=True
        )
    ]


def _norms(problem: MomentProblem, horizons: Array) -> Array:
    """Return ∫|φ| up to each horizon, shape (n, size), by a sum."""
    longest = float(horizons.max())
    nodes = grade(problem, longest).nodes(longest, radians=FINE)
    sums = np.cumsum(np.abs(problem.values(nodes[:-1])) * np.diff(nodes)[:, np.newaxis], axis=0)
    return np.column_stack([np.interp(horizons, nodes[1:], column) for column in sums.T])


def _defect(problem: MomentProblem, ends: Array, jumps: Array, spans: Array) -> Array:
    """Return the moments of the signs and the missing target, shape (n, size + 1)."""
    flat = ends.ravel()
    functions = np.column_stack([problem.integrals(flat), problem.target_integrals(flat)])
    defect = np.einsum("e,nef->nf", jumps, functions.reshape(*ends.shape, -1))
    defect[:, -1] -= spans
    return np.asarray(defect)


def _step(
    problem: MomentProblem, ends: Array, c: Array, *, jumps: Array, defect: Array, scale: Array
) -> tuple[Array, Array]:
    """Return ends and multipliers after one Newton step, with ``refine_control``'s equations."""
    n, k, size = ends.shape[0], ends.shape[1] - 1, problem.size
    phi, slope = (
        values.reshape(n, k + 1, size) for values in problem.values_and_slopes(ends.ravel())
    )
    psi = problem.target_values(ends)
    sigma = psi[:, :k] - np.einsum("nki,ni->nk", phi[:, :k], c)
    slopes = problem.degree - np.einsum("nki,ni->nk", slope[:, :k], c)
    matrix = np.zeros((n, k + size + 1, k + size + 1))
    at = np.arange(k)
    matrix[:, at, at] = slopes
    matrix[:, :k, k + 1 :] = -phi[:, :k] / scale[:, np.newaxis, :-1]
    functions = np.concatenate([phi, psi[:, :, np.newaxis]], axis=2) * jumps[:, np.newaxis]
    matrix[:, k:, : k + 1] = (functions / scale[:, np.newaxis]).transpose(0, 2, 1)
    right = -np.concatenate([sigma, defect], axis=1)
    step = np.linalg.solve(matrix, right[:, :, np.newaxis])[:, :, 0]
    # An arc may have closed altogether.
    lengths = np.maximum(np.diff(ends, axis=1, prepend=0.0), TINY)
    closing = -np.diff(step[:, : k + 1], axis=1, prepend=0.0)
    most = np.maximum((closing / lengths).max(axis=1), TINY)
    share = np.minimum(1.0, TO_BOUNDARY / most)[:, np.newaxis]
    return ends + share * step[:, : k + 1], c + share * step[:, k + 1 :] / scale[:, :-1]
