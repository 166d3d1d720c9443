"""The saturated linear-quadratic problem as a linear boundary value problem for given arcs.

With x' = A x + B F_set and the functional ∫ F_set² + x' W x dt, the minimum principle gives

    λ' = -2 W x - A' λ,   F_set = Proj(-λ_F / (2 T)),

so the pair z = (x, λ) obeys a linear system on every arc: the Hamiltonian system where the
force is inside its limits, the plant with a constant force beside the adjoint equation where
it is saturated. For a given sequence of arcs everything is then one linear system.

The Hamiltonian flow grows as fast as it decays, so shooting over the whole interval loses
digits; here each arc is told from both of its ends (two_point.py), which costs as little for
thousands of oscillations as for ten, and z at the ends of short pieces follows from there.

All quantities of this module are scaled: states by what F_max could cause, λ accordingly,
the force by F_max; time stays in seconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Weight
from mtcommission.machine.moves import Move, Positioning
from mtcommission.optimal.damping.two_point import (
    Middle,
    TwoPoint,
    chain_ends,
    doubled,
    inner_nodes,
    middle,
    two_point,
)
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
Labels = NDArray[np.int64]

PIECE_ANGLE = 4.0
"""Longest piece times the fastest eigenvalue [-]: within it the flow grows by at most e^4, which
costs two of sixteen digits."""

TERMS = 20
"""Of the power series of a flow over one sample, a quarter radian of the fastest eigenvalue at
most: 1 / 20! leaves room for a norm four times as large."""

SAMPLES_PER_PIECE = 16
"""Samples inside a piece: at most a quarter radian of the fastest eigenvalue apart, so that
cubic interpolation between them isolates every crossing (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SaturatedProblem:
    """The scaled problem; z is extended by the constant bound, N = 2 n + 1."""

    # Shape (3, N, N) [1/s]: of an arc at the lower limit, inside, at the upper limit.
    generators: Array
    # control_row, control_rate_row: Shape (N,): the unlimited control w = control_row z, and
    # its derivative [1/s].
    control_row: Array
    control_rate_row: Array
    # Terms of the power series of the flow of each generator in τ ``rate``, shape (3, TERMS,
    # N, N).
    series: Array
    target: Array  # Scaled terminal state, shape (n,)
    fixed: NDArray[np.bool_]  # Which states are prescribed at t_f, shape (n,)
    # state_scale, adjoint_scale: Physical = scale * scaled, shape (n,).
    state_scale: Array
    adjoint_scale: Array
    force_limit: float  # F_max, the unit of the scaled force [N]
    force_unit: str  # N, or N·m on a rotary axis; for messages
    t_f: float  # [s]
    rate: float  # Largest modulus of the eigenvalues of all generators [1/s]

    @property
    def order(self) -> int:
        """Number n of plant states."""
        return self.target.size

    def flows(self, labels: Labels, steps: Array) -> Array:
        """Return the flow of some arcs over steps of at most a sample [s], shape (k, N, N)."""
        powers = (steps[:, None] * self.rate) ** np.arange(TERMS)
        return np.asarray(np.einsum("kp,kpij->kij", powers, self.series[labels + 1]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ArcSequence:
    """Where the force is saturated."""

    edges: Array  # Ends of the arcs from 0 to t_f, shape (n_arcs + 1,) [s]
    labels: Labels  # -1 at the lower limit, 0 inside, +1 at the upper limit, shape (n_arcs,)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PiecewiseFlow:
    """States and adjoints of a given arc sequence, in pieces short enough to be accurate."""

    bound: float  # Magnitude of the saturated control, in units of F_max
    labels: Labels  # Shape (n_pieces,), as in ``ArcSequence``
    owner: NDArray[np.intp]  # Arc of each piece, shape (n_pieces,)
    powers: Array  # Flow of each arc over 0 ... SAMPLES_PER_PIECE steps, shape (n_arcs, ..., N, N).
    t: Array  # Shape (n_pieces, SAMPLES_PER_PIECE + 1) [s]; first and last column end the piece
    starts: Array  # z at the start of each piece, shape (n_pieces, N)
    end: Array  # z at t_f, shape (N,)
    # control, control_rate: Unlimited control w and its derivative at the samples, same shape
    # as ``t``.
    control: Array
    control_rate: Array


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


def terminal_target(plant: Plant, move: Move) -> tuple[Array, NDArray[np.bool_]]:
    """Return the state at the end of a move, and which of its entries are prescribed.

    Source: Christiansen, Maurer & Zirn, eq. (3).
    """
    target, fixed = np.zeros(plant.order), np.ones(plant.order, dtype=np.bool_)
    if isinstance(move, Positioning):
        target[plant.position] = move.distance
    else:
        target[plant.velocity] = move.velocity_step
        fixed[plant.position] = False
    return target, fixed


def scale_problem(
    plant: Plant, move: Move, *, force_limit: float, t_f: float, weights: tuple[Weight, ...]
) -> SaturatedProblem:
    """Return the scaled problem of eq. (5)."""
    n = plant.order
    # Any time will do as the unit of the adjoint; the lag makes that of the force one.
    T = plant.force_lag or 1.0 / plant.fastest_rate
    scales = state_scales(plant, force_limit=force_limit, t_f=t_f)
    A, B = plant.A * scales / scales[:, None], plant.B * force_limit / scales
    c = np.zeros(n)
    for weight in weights:
        c[plant.states.index(weight.state)] += weight.value
    c = c * (scales / force_limit) ** 2
    generators = np.zeros((3, 2 * n + 1, 2 * n + 1))
    generators[:, :n, :n] = A
    generators[:, n : 2 * n, :n] = -2.0 / T * np.diag(c)
    generators[:, n : 2 * n, n : 2 * n] = -A.T
    generators[0, :n, -1], generators[2, :n, -1] = -B, B
    control_row = np.zeros(2 * n + 1)
    control_row[n : 2 * n] = -0.5 * T * B
    generators[1, :n] += np.outer(B, control_row)
    target, fixed = terminal_target(plant, move)
    rate = float(np.abs(np.linalg.eigvals(generators[1:])).max())
    return SaturatedProblem(
        generators=generators,
        control_row=control_row,
        control_rate_row=control_row @ generators[1],
        series=_power_series(generators / rate),
        target=target / scales,
        fixed=fixed,
        state_scale=scales,
        adjoint_scale=force_limit**2 * T / scales,
        force_limit=force_limit,
        force_unit=plant.force_unit,
        t_f=t_f,
        rate=rate,
    )


def _power_series(generators: Array) -> Array:
    """Return G^p / p! of each generator, shape (k, TERMS, N, N)."""
    k, N = generators.shape[:2]
    series = np.empty((k, TERMS, N, N))
    series[:, 0] = np.eye(N)
    for power in range(1, TERMS):
        series[:, power] = series[:, power - 1] @ generators / power
    return series


def solve_arcs(problem: SaturatedProblem, arcs: ArcSequence, *, bound: float) -> PiecewiseFlow:
    """Return the states and adjoints that meet both ends of the move with the given arcs.

    Raises
    ------
    numpy.linalg.LinAlgError
        If these arcs leave too little freedom to reach the target.
    """
    lengths = np.diff(arcs.edges)
    halvings = np.maximum(0.0, np.ceil(np.log2(lengths * (problem.rate / PIECE_ANGLE))))
    halvings = halvings.astype(np.int64)
    counts = 2**halvings
    step = lengths / counts / SAMPLES_PER_PIECE
    powers = matrix_powers(problem.flows(arcs.labels, step), SAMPLES_PER_PIECE)
    nodes = _solve_nodes(problem, powers[:, -1], halvings, bound=bound)
    starts = np.concatenate([piece[:-1] for piece in nodes])
    starts = np.column_stack([starts, np.full(counts.sum(), bound)])
    rows = np.array([problem.control_row, problem.control_rate_row])
    owner = np.repeat(np.arange(counts.size), counts)
    piece = np.arange(owner.size) - np.repeat(np.cumsum(counts) - counts, counts)
    begin = arcs.edges[owner] + piece * (lengths / counts)[owner]
    sampled = _at_samples(rows @ powers, starts, counts)
    return PiecewiseFlow(
        bound=bound,
        labels=arcs.labels[owner],
        owner=owner,
        powers=powers,
        t=begin[:, None] + step[owner, None] * np.arange(SAMPLES_PER_PIECE + 1),
        starts=starts,
        end=np.append(nodes[-1][-1], bound),
        control=sampled[:, :, 0],
        control_rate=sampled[:, :, 1],
    )


def _at_samples(rows: Array, starts: Array, counts: Labels) -> Array:
    """Return rows of z at the samples of all pieces, shape (n_pieces, samples, n_rows).

    ``rows`` take z at the start of a piece there, shape (n_arcs, samples, n_rows, N).
    """
    k, samples, count, N = rows.shape
    flat = rows.reshape(k, samples * count, N).transpose(0, 2, 1)
    parts = np.split(starts, np.cumsum(counts)[:-1])
    found = np.concatenate([part @ row for part, row in zip(parts, flat, strict=True)])
    return found.reshape(-1, samples, count)


def matrix_powers(E: Array, last: int) -> Array:
    """Return E^0 ... E^last of a stack of matrices.

    Examples
    --------
    >>> matrix_powers(np.full((1, 1, 1), 3.0), 4).ravel()
    array([ 1.,  3.,  9., 27., 81.])
    """
    k, N = E.shape[:2]
    powers = np.empty((k, last + 1, N, N))
    powers[:, 0] = np.eye(N)
    powers[:, 1] = E
    done = 1
    while done < last:
        more = min(done, last - done)
        powers[:, done + 1 : done + more + 1] = powers[:, done : done + 1] @ powers[:, 1 : more + 1]
        done += more
    return powers


def _solve_nodes(
    problem: SaturatedProblem, flow: Array, halvings: Labels, *, bound: float
) -> list[Array]:
    """Return z at the ends of the pieces of each arc, each of shape (n_pieces + 1, 2 n)."""
    n = problem.order
    width = 2 * n
    whole = two_point(flow[:, :width, :width], flow[:, :width, width] * bound).form
    levels: list[list[tuple[Middle, int]]] = [[] for _ in halvings]
    for level in range(int(halvings.max())):
        index = np.flatnonzero(halvings > level)
        between = middle(TwoPoint(form=whole[index]))
        for place, arc in enumerate(index.tolist()):
            levels[arc].append((between, place))
        whole[index] = doubled(between).form
    rows = np.concatenate([np.flatnonzero(problem.fixed), n + np.flatnonzero(~problem.fixed)])
    values = np.concatenate([problem.target[problem.fixed], np.zeros(rows.size)])[: rows.size]
    ends = chain_ends(TwoPoint(form=whole), rows, values)
    return [
        inner_nodes(level, start, end)
        for level, start, end in zip(levels, ends[:-1], ends[1:], strict=True)
    ]
