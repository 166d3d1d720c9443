"""Plant + move + t_f -> the damping-optimal control: the saturated linear-quadratic problem.

minimise ∫ F_set² + Σ c_i x_i² dt   subject to |F_set| <= F_max, from rest to the target

With x' = A x + B F_set the minimum principle gives, for W = diag(c),

    λ' = -2 W x - A' λ,   F_set = Proj(w),   w = -λB / 2,

so z = (x, λ) obeys a linear system on every arc, and for given arcs everything is one banded
system: z at the ends of pieces within which the flow grows little (multiple shooting; Ascher,
Mattheij & Russell 1995, ch. 4). Solve it, saturate wherever w exceeds the limit, repeat: this is
Newton's method for the control law, since the flow is differentiable across an edge where the law
holds. It converges quadratically in the end, and arcs may come and go on the way. It starts
without saturation; where the full step fails, the limit is lowered to F_max by degrees.

States are scaled by what F_max could cause, λ accordingly, the force by F_max; time is in seconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.control import (
    Arc,
    Bang,
    DampingOptimum,
    FollowedMotion,
    Interior,
    Law,
    Optimum,
    TimeOptimum,
    constant_arc,
    follow_control,
    terminal_target,
    unit_cubics,
)

Array = NDArray[np.float64]
Labels = NDArray[np.int64]

PIECE_ANGLE, CELLS = 4.0, 16
"""Longest piece times the fastest eigenvalue [-], within which the flow grows by at most e^4, and
its cells: cubic interpolation on a quarter radian isolates every crossing (empirical)."""
TERMS = 20
"""Of the power series of a flow over one cell: 1 / 20! leaves room for a norm four times as large
as the eigenvalues."""
LAW_TOLERANCE = 1e-6
"""Largest violation of the control law that counts as solved, in units of F_max [-]. Usually it
falls below ``LAW_GOAL``; close to t_f,min the multipliers grow and rounding stops it earlier."""
LAW_GOAL = 1e-10
"""Violation at which the iteration stops, in units of F_max [-]."""
DIVERGED = 1e3
"""Violation from which the iteration does not come back, in units of F_max [-] (empirical)."""
ITERATIONS = 100
"""Arc iterations for one limit before the step is halved (empirical)."""
STEPS = 120
"""Limits tried on the way to F_max (empirical; a move at 1.0001 t_f,min takes about fifteen, one
of 30 000 radians with five modes some seventy)."""
SHORTEST_ARC = 1e-12
"""Arcs shorter than this share of t_f are left out: rounding of the time decides about them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _SaturatedProblem:
    """The scaled problem; z is extended by the constant bound, N = 2 n + 1."""

    # Shape (3, N, N) [1/s]: of an arc inside, at the upper, at the lower limit (0, 1, -1).
    generators: Array
    control_row: Array  # w = control_row z, shape (N,)
    series: Array  # Terms of each flow's power series in τ ``rate``, shape (3, TERMS, N, N)
    target: Array  # Scaled terminal state, shape (n,)
    fixed: NDArray[np.bool_]  # Which states are prescribed at t_f, shape (n,)
    # state_scale, adjoint_scale: Physical = scale * scaled, shape (n,).
    state_scale: Array
    adjoint_scale: Array
    force_limit: float  # F_max, the unit of the scaled force [N]
    t_f: float  # [s]
    rate: float  # Largest modulus of the eigenvalues of all generators [1/s]

    def flows(self, labels: Labels, steps: Array) -> Array:
        """Return the flow of some arcs over steps of at most a cell [s], shape (k, N, N)."""
        powers = (steps[:, None] * self.rate) ** np.arange(TERMS)
        return np.asarray(np.einsum("kp,kpij->kij", powers, self.series[labels]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Iterate:
    """States and adjoints for given arcs, in pieces of ``CELLS`` cells each, and their worth."""

    bound: float  # Magnitude of the saturated control, in units of F_max
    # edges, arc_labels: Ends of the arcs from 0 to t_f [s]; -1 at the lower limit, 0 inside, +1.
    edges: Array
    arc_labels: Labels
    labels: Labels  # The same of each piece, shape (n_pieces,)
    step: Array  # Length of a piece's cells [s], shape (n_pieces,)
    t: Array  # Ends of the cells [s], shape (n_pieces, CELLS + 1)
    z: Array  # There, shape (n_pieces, CELLS + 1, N)
    control: Array  # w there
    violation: float  # Largest |F_set - Proj(w)|, in units of F_max


def state_scales(plant: Plant, *, force_limit: float, t_f: float) -> Array:
    """Return the magnitude of each state under the force limit."""
    scales = np.ones(plant.order)
    scales[plant.lagged] = force_limit
    scales[plant.velocity] = force_limit * t_f / plant.moving_mass
    scales[plant.position] = scales[plant.velocity] * t_f
    for mode in plant.modes:
        scales[mode.rate] = abs(mode.scale) * force_limit / mode.natural_frequency
        scales[mode.deflection] = scales[mode.rate] / mode.natural_frequency
    return scales


def _scale_problem(
    plant: Plant, move: Move, *, force_limit: float, t_f: float, weights: tuple[SignalValue, ...]
) -> _SaturatedProblem:
    n = plant.order
    # Any time will do as the unit of the adjoint; the lag makes that of the force one.
    T = plant.force_lag or 1.0 / plant.fastest_rate
    scales = state_scales(plant, force_limit=force_limit, t_f=t_f)
    A, B = plant.A * scales / scales[:, None], plant.B * force_limit / scales
    c = np.zeros(n)
    for weight in weights:
        c[plant.states.index(weight.name)] += weight.value
    generators = np.zeros((3, 2 * n + 1, 2 * n + 1))
    generators[:, :n, :n] = A
    generators[:, n : 2 * n, :n] = -2.0 / T * np.diag(c * (scales / force_limit) ** 2)
    generators[:, n : 2 * n, n : 2 * n] = -A.T
    generators[1, :n, -1], generators[-1, :n, -1] = B, -B
    control_row = np.zeros(2 * n + 1)
    control_row[n : 2 * n] = -0.5 * T * B
    generators[0, :n] += np.outer(B, control_row)
    rate = float(np.abs(np.linalg.eigvals(generators[:2])).max())
    series = np.empty((3, TERMS, 2 * n + 1, 2 * n + 1))
    series[:, 0] = np.eye(2 * n + 1)
    for power in range(1, TERMS):
        series[:, power] = series[:, power - 1] @ generators / (power * rate)
    target, fixed = terminal_target(plant, move)
    return _SaturatedProblem(
        generators=generators,
        control_row=control_row,
        series=series,
        target=target / scales,
        fixed=fixed,
        state_scale=scales,
        adjoint_scale=force_limit**2 * T / scales,
        force_limit=force_limit,
        t_f=t_f,
        rate=rate,
    )


def _follow(problem: _SaturatedProblem, edges: Array, labels: Labels, *, bound: float) -> _Iterate:
    """Return the states and adjoints that meet both ends of the move with the given arcs."""
    lengths = np.diff(edges)
    counts = np.maximum(1.0, np.ceil(lengths * (problem.rate / PIECE_ANGLE))).astype(np.int64)
    owner = np.repeat(np.arange(counts.size), counts)
    step = lengths / counts / CELLS
    powers = [problem.flows(labels, step)]  # over 1, 2, 4, 8 and 16 cells
    while 2 ** len(powers) <= CELLS:
        powers.append(powers[-1] @ powers[-1])
    z = _starts(problem, powers.pop(), owner, bound=bound)[:, None]
    arcs = np.split(z, np.cumsum(counts)[:-1])  # all pieces of an arc have the same flow
    for power in powers:
        arcs = [np.hstack([own, own @ flow.T]) for own, flow in zip(arcs, power, strict=True)]
    z = np.concatenate(
        [np.hstack([own, own[:, -1:] @ flow.T]) for own, flow in zip(arcs, powers[0], strict=True)]
    )
    piece = np.arange(owner.size) - np.repeat(np.cumsum(counts) - counts, counts)
    at = CELLS * piece[:, None] + np.arange(CELLS + 1)
    w, label = z @ problem.control_row, labels[owner]
    control = np.where(label[:, None] == 0, w, label[:, None] * bound)
    return _Iterate(
        bound=bound,
        edges=edges,
        arc_labels=labels,
        labels=label,
        step=step[owner],
        t=edges[owner, None] + at * step[owner, None],
        z=z,
        control=w,
        violation=float(np.abs(control - np.clip(w, -bound, bound)).max()),
    )


def _starts(problem: _SaturatedProblem, flow: Array, owner: Labels, *, bound: float) -> Array:
    """Return z at the start of each piece, given the flow over a piece of each arc, (n_pieces, N).

    What a stretch of pieces does is told from both of its ends, x_b and λ_a by x_a and λ_b:
    states are carried forwards and adjoints backwards, the directions in which each decays, so
    nothing grows with the length, and two stretches make one. Stretches of the same pieces do the
    same, and are joined once.
    """
    n, kind = problem.target.size, owner
    # From the second line of the flow, λ_a = S (λ_b - flow_21 x_a - offset_2).
    S = np.linalg.inv(flow[:, n:-1, n:-1])
    adjoint = np.concatenate([-S @ flow[:, n:-1, :n], S, -bound * S @ flow[:, n:-1, -1:]], axis=2)
    state = flow[:, :n, n:-1] @ adjoint
    state[:, :, :n] += flow[:, :n, :n]
    state[:, :, -1] += bound * flow[:, :n, -1]
    joints = []
    while len(kind) > 1:
        last = len(kind) // 2 * 2
        pairs = kind[:last:2] * len(state) + kind[1:last:2]
        distinct, same = np.unique(pairs, return_inverse=True)
        one, other = np.divmod(distinct, len(state))
        left, right = state[one], adjoint[other]
        mixed = left.copy()  # x in the middle: (1 - Q R) x = P x_a + Q (S λ_b + q) + r
        mixed[:, :, n:] = left[:, :, n:-1] @ right[:, :, n:]
        mixed[:, :, -1:] += left[:, :, -1:]
        x = np.linalg.solve(np.eye(n) - left[:, :, n:-1] @ right[:, :, :n], mixed)
        between = right[:, :, :n] @ x  # λ there
        between[:, :, n:] += right[:, :, n:]
        joints.append((np.concatenate([x, between], axis=1), same))
        joined = state[other, :, :n] @ x
        joined[:, :, n:] += state[other, :, n:]
        before = adjoint[one, :, n:-1] @ between
        before[:, :, :n] += adjoint[one, :, :n]
        before[:, :, -1:] += adjoint[one, :, -1:]
        state = np.concatenate([joined, state[kind[last:]]])
        adjoint = np.concatenate([before, adjoint[kind[last:]]])
        kind = np.append(same, np.arange(len(distinct), len(state)))
    # At t_f a state is prescribed, or its adjoint is 0.
    state, adjoint = state[kind[0]], adjoint[kind[0]]
    rows = np.where(problem.fixed[:, None], state[:, n:-1], np.eye(n))
    wanted = np.where(problem.fixed, problem.target - state[:, -1], 0.0)
    end = np.concatenate([np.zeros(n), np.linalg.solve(rows, wanted), [1.0]])
    z = np.array([[*np.zeros(n), *(adjoint @ end)], [*(state @ end), *end[n:-1]]])
    for joint, same in reversed(joints):
        ends = np.column_stack([z[: len(same), :n], z[1 : len(same) + 1, n:]])
        middle = np.empty_like(ends)
        for i, own in enumerate(joint):
            middle[same == i] = ends[same == i] @ own[:, :-1].T + own[:, -1]
        z = np.insert(z, np.arange(1, len(same) + 1), middle, axis=0)
    return np.column_stack([z[:-1], np.full(len(owner), bound)])


def _crossings(problem: _SaturatedProblem, now: _Iterate) -> tuple[Array, Labels]:
    """Return edges and labels of the arcs on which the unlimited control is beyond the limit."""
    rate = now.z @ (problem.control_row @ problem.generators[0])
    w = now.control
    cubics = unit_cubics(
        now.step[:, None], w[:, :-1], w[:, 1:], start_rate=rate[:, :-1], end_rate=rate[:, 1:]
    ).reshape(4, -1)
    starts, step = now.t[:, :-1].ravel(), np.repeat(now.step, CELLS)
    times = []
    for level in (-now.bound, now.bound):
        cells, places = _crossed(cubics, level)
        # The cubic is right to some 1e-5 of a cell; two steps of Newton's method with the flow.
        tau, farthest = places * step[cells], step[cells] / 10
        for _ in range(2):
            value, slope = _control_at(problem, now, cells, tau)
            with np.errstate(divide="ignore", invalid="ignore"):
                change = np.nan_to_num((value - level) / slope)
            tau = tau - np.clip(change, -farthest, farthest)
        times.append(np.clip(starts[cells] + tau, 0.0, problem.t_f))
    edges = np.concatenate([[0.0], np.sort(np.concatenate(times)), [problem.t_f]])
    middle = (edges[1:] + edges[:-1]) / 2
    cells = np.searchsorted(starts, middle, side="right") - 1
    value, _ = _control_at(problem, now, cells, middle - starts[cells])
    labels = np.where(np.abs(value) > now.bound, np.sign(value), 0.0).astype(np.int64)
    long = np.diff(edges) > SHORTEST_ARC * problem.t_f
    begins, labels = edges[:-1][long], labels[long]
    new = np.append(True, labels[1:] != labels[:-1])
    return np.concatenate([edges[:1], begins[new][1:], edges[-1:]]), labels[new]


def _crossed(cubics: Array, level: float) -> tuple[NDArray[np.intp], Array]:
    """Return the cells in which a cubic takes a value, and where in them, from 0 to 1."""
    c3, c2, c1, c0 = cubics
    # A cubic lies between its Bernstein coefficients.
    hull = np.stack([c0, c0 + c1 / 3, c0 + (2 * c1 + c2) / 3, c0 + c1 + c2 + c3]) - level
    cells = np.flatnonzero((hull.min(axis=0) <= 0.0) & (hull.max(axis=0) >= 0.0))
    if not cells.size:
        return cells, np.zeros(0)
    side_by_side = PPoly(cubics[:, cells], np.arange(cells.size + 1.0))
    roots = side_by_side.solve(level, discontinuity=False, extrapolate=False)
    roots = roots[np.isfinite(roots)]
    index = np.minimum(roots.astype(np.int64), cells.size - 1)
    return cells[index], roots - index


def _control_at(
    problem: _SaturatedProblem, now: _Iterate, cells: NDArray[np.intp], tau: Array
) -> tuple[Array, Array]:
    """Return w and its rate at times after the starts of cells [s]."""
    piece, cell = np.divmod(cells, CELLS)
    rows = (problem.control_row @ problem.series)[now.labels[piece]]
    terms = (rows @ now.z[piece, cell, :, None])[..., 0]
    powers = (tau[:, None] * problem.rate) ** np.arange(TERMS)
    slope = (terms[:, 1:] * powers[:, :-1]) @ np.arange(1.0, TERMS)
    return (terms * powers).sum(axis=1), problem.rate * slope


def _settle(problem: _SaturatedProblem, first: _Iterate, *, bound: float, goal: float) -> _Iterate:
    best = _follow(problem, first.edges, first.arc_labels, bound=bound)
    now = best
    for _ in range(ITERATIONS):
        if best.violation <= goal * bound or now.violation > DIVERGED:
            break
        try:
            now = _follow(problem, *_crossings(problem, now), bound=bound)
        except np.linalg.LinAlgError:
            break
        stagnant = best.violation <= LAW_TOLERANCE * bound and now.violation > best.violation / 4
        if now.violation < best.violation:
            best = now
        if stagnant:
            break
    return best


def _solve_saturated(problem: _SaturatedProblem, *, force_unit: str) -> _Iterate:
    """Return the solution, lowering the limit to F_max by degrees if one step will not do."""
    whole = np.array([0.0, problem.t_f])
    reached = _follow(problem, whole, np.zeros(1, dtype=np.int64), bound=1.0)
    limit = 1.0 + reached.violation
    trial, fraction = 1.0, 1.0
    for _ in range(STEPS):
        is_last = trial == 1.0
        goal = LAW_GOAL if is_last else LAW_TOLERANCE
        now = _settle(problem, reached, bound=trial, goal=goal)
        settled = now.violation <= LAW_TOLERANCE * trial
        if settled and is_last:
            return now
        if settled:
            limit, reached, fraction = trial, now, min(0.9, 1.5 * fraction)
        else:
            fraction /= 2.0
        trial = max(1.0, limit * (1.0 - fraction))
    detail = Message(
        "damping-not-solved",
        t_f=problem.t_f,
        force=problem.force_limit,
        solved=limit * problem.force_limit,
        unit=force_unit,
    )
    raise ComputationError(Outcome.NO_CONVERGENCE, detail)


MOST_RADIANS = 1e4
"""Of the fastest mode over the motion: a hundred thousand samples (empirical)."""


def solve_damping_optimal(
    plant: Plant, move: Move, *, force_limit: float, t_f: float, weights: tuple[SignalValue, ...]
) -> DampingOptimum:
    """Return the control that reaches the target at t_f with the least weighted squares.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE, also where t_f is below the shortest time.
    ValueError
        If a weight names no state of the plant.

    Source: Christiansen, Maurer & Zirn, eqs. (5) and (16); derived in
    docs/optimal-control.md, section 9.

    Examples
    --------
    >>> from mtcommission.machine.plant.plant import build_plant
    >>> from mtcommission.machine.profile.shipped import read_shipped
    >>> machine = read_shipped("milling-manipulator").machine
    >>> best = solve_damping_optimal(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     t_f=0.0522, weights=machine.damping_optimal.weights)
    >>> round(best.cost / 1e3), [arc.control for arc in best.arcs][:2]
    (449, [Bang(side=1), Interior()])
    """
    problem = _scale_problem(plant, move, force_limit=force_limit, t_f=t_f, weights=weights)
    found = _solve_saturated(problem, force_unit=plant.force_unit)
    arcs = _arcs(problem, found)
    target, fixed = terminal_target(plant, move)
    motion = follow_control(plant, arcs, rate=problem.rate)
    return Optimum(
        move=move,
        force_limit=force_limit,
        bounds=(),
        method="exact",
        t_f=t_f,
        weights=weights,
        arcs=arcs,
        cost_terms=cost_terms(plant, motion, weights),
        certificate=Law(
            adjoint_initial=found.z[0, 0, plant.order : -1] * problem.adjoint_scale,
            law_residual=found.violation,
        ),
        terminal_error=np.where(fixed, motion.final - target, 0.0),
        motion=motion,
    )


def _arcs(problem: _SaturatedProblem, found: _Iterate) -> tuple[Arc, ...]:
    """Return one arc where the force is saturated, and one for each piece where it is not."""
    F, width = problem.force_limit, 2 * problem.target.size
    generator, output = problem.generators[0, :width, :width], F * problem.control_row[:width]
    ends = np.append(found.t[1:, 0], problem.t_f).tolist()
    arcs: list[Arc] = []
    for label, start, end, z in zip(
        found.labels.tolist(), found.t[:, 0].tolist(), ends, found.z[:, 0, :width], strict=True
    ):
        if label and arcs and arcs[-1].control == Bang(label):
            start = arcs.pop().t_start
        if label:
            arcs.append(constant_arc(start, end, control=Bang(label), force=label * F))
        else:
            arcs.append(
                Arc(
                    t_start=start,
                    t_end=end,
                    control=Interior(),
                    generator=generator,
                    initial=z,
                    output=output,
                )
            )
    return tuple(arcs)


def cost_terms(plant: Plant, motion: FollowedMotion, weights: tuple[SignalValue, ...]) -> Array:
    """Return the parts of the cost of a motion: of F_set², then of each weight [N² s]."""
    squares = [one.value * motion.squares[plant.states.index(one.name)] for one in weights]
    return np.array([motion.effort, *squares])


def balanced_weights(plant: Plant, reference: TimeOptimum) -> tuple[SignalValue, ...]:
    """Return the weights with which all terms are equal along the time-optimal motion.

    c_i = ∫ F_set² dt / ∫ x_i² dt over the reference, for the deflection and the rate of each
    flexible mode. Along the damping-optimal motion itself the terms then differ: it is what
    the optimisation is free to change.

    Source: Christiansen, Maurer & Zirn, sec. 6: "all terms ... have the same magnitude". That
    the time-optimal solution of their sec. 5.1 is meant is inferred: it gives (17) to 1 ... 3 %,
    see docs/optimal-control.md, section 9.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG.
    """
    fastest = max(mode.natural_frequency for mode in plant.modes)
    radians = fastest * reference.t_f
    if radians > MOST_RADIANS:
        detail = Message("optimum-too-long", t_f=reference.t_f, radians=radians, most=MOST_RADIANS)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
    motion = follow_control(plant, reference.arcs)
    places = [mode.deflection for mode in plant.modes] + [mode.rate for mode in plant.modes]
    return tuple(
        SignalValue(name=plant.states[i], value=motion.effort / float(motion.squares[i]))
        for i in places
    )
