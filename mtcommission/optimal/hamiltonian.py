"""The saturated linear-quadratic problem as a linear boundary value problem for given arcs.

With x' = A x + B F_set and the functional ∫ F_set² + x' W x dt, the minimum principle gives

    λ' = -2 W x - A' λ,   F_set = Proj(-λ_F / (2 T)),

so the pair z = (x, λ) obeys a linear system on every arc: the Hamiltonian system where the
force is inside its limits, the plant with a constant force beside the adjoint equation where
it is saturated. For a given sequence of arcs everything is then one linear system.

The Hamiltonian flow grows as fast as it decays, so shooting over the whole interval loses
digits; here z at the start of every short piece is an unknown (multiple shooting), and the
banded system of matching conditions is solved at once.

All quantities of this module are scaled: states by what F_max could cause, λ accordingly,
the force by F_max; time stays in seconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_banded

from mtcommission.machine import Move, Positioning, Weight
from mtcommission.plant import Plant

Array = NDArray[np.float64]
Labels = NDArray[np.int64]

PIECE_ANGLE = 4.0
"""Longest piece times the fastest eigenvalue [-]: within it the flow grows by at most e^4, which
costs two of sixteen digits."""

SAMPLES_PER_PIECE = 16
"""Samples inside a piece: at most a quarter radian of the fastest eigenvalue apart, so that
cubic interpolation between them isolates every crossing (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SaturatedProblem:
    """The scaled problem; z is extended by the constant bound, N = 2 n + 1.

    Parameters
    ----------
    generators
        Shape (3, N, N) [1/s]: of an arc at the lower limit, inside, at the upper limit.
    control_row, control_rate_row
        Shape (N,): the unlimited control w = control_row z, and its derivative [1/s].
    target
        Scaled terminal state, shape (n,).
    fixed
        Which states are prescribed at t_f, shape (n,).
    state_scale, adjoint_scale
        Physical = scale * scaled, shape (n,).
    force_limit
        F_max, the unit of the scaled force [N].
    t_f
        [s].
    rate
        Largest modulus of the eigenvalues of all generators [1/s].
    """

    generators: Array
    control_row: Array
    control_rate_row: Array
    target: Array
    fixed: NDArray[np.bool_]
    state_scale: Array
    adjoint_scale: Array
    force_limit: float
    t_f: float
    rate: float

    @property
    def order(self) -> int:
        """Number n of plant states."""
        return self.target.size


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ArcSequence:
    """Where the force is saturated.

    Parameters
    ----------
    edges
        Ends of the arcs from 0 to t_f, shape (n_arcs + 1,) [s].
    labels
        -1 at the lower limit, 0 inside, +1 at the upper limit, shape (n_arcs,).
    """

    edges: Array
    labels: Labels


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PiecewiseFlow:
    """States and adjoints of a given arc sequence, in pieces short enough to be accurate.

    Parameters
    ----------
    bound
        Magnitude of the saturated control, in units of F_max.
    labels
        Shape (n_pieces,), as in ``ArcSequence``.
    t
        Shape (n_pieces, SAMPLES_PER_PIECE + 1) [s]; first and last column end the piece.
    z
        Shape (n_pieces, SAMPLES_PER_PIECE + 1, N).
    """

    bound: float
    labels: Labels
    t: Array
    z: Array

    def joined(self) -> tuple[Array, Array]:
        """Return t and z of all pieces in one row, shapes (k,) and (k, N)."""
        t = np.append(self.t[:, :-1].ravel(), self.t[-1, -1])
        z = np.concatenate([self.z[:, :-1].reshape(-1, self.z.shape[-1]), self.z[-1, -1:]])
        return t, z


def state_scales(plant: Plant, *, force_limit: float, t_f: float) -> Array:
    """Return the magnitude of each state under the force limit.

    Parameters
    ----------
    plant
        Plant with n states.
    force_limit
        [N].
    t_f
        [s].

    Returns
    -------
    ndarray, shape (n,)
        Static deflection and its rate at resonance for a mode, rigid motion otherwise.
    """
    scales = np.ones(plant.order)
    scales[plant.force] = force_limit
    scales[plant.velocity] = force_limit * t_f / plant.moving_mass
    scales[plant.position] = scales[plant.velocity] * t_f
    for mode in plant.modes:
        scales[mode.rate] = abs(mode.scale) * force_limit / mode.natural_frequency
        scales[mode.deflection] = scales[mode.rate] / mode.natural_frequency
    return scales


def terminal_target(plant: Plant, move: Move) -> tuple[Array, NDArray[np.bool_]]:
    """Return the state at the end of a move, and which of its entries are prescribed.

    Parameters
    ----------
    plant
        Plant with n states.
    move
        Velocity step (the end position is free) or positioning move.

    Returns
    -------
    target, fixed
        Both of shape (n,).

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
    """Return the scaled problem of eq. (5).

    Parameters
    ----------
    plant
        Plant with n states.
    move
        Velocity step or positioning move.
    force_limit
        Force left for motion [N].
    t_f
        Final time [s].
    weights
        c_i by state [N² per squared unit].

    Returns
    -------
    SaturatedProblem
    """
    n, T = plant.order, plant.force_lag
    scales = state_scales(plant, force_limit=force_limit, t_f=t_f)
    A = plant.A * scales / scales[:, None]
    c = np.zeros(n)
    for weight in weights:
        c[plant.states.index(weight.state)] += weight.value
    c = c * (scales / force_limit) ** 2
    generators = np.zeros((3, 2 * n + 1, 2 * n + 1))
    generators[:, :n, :n] = A
    generators[:, n : 2 * n, :n] = -2.0 / T * np.diag(c)
    generators[:, n : 2 * n, n : 2 * n] = -A.T
    force = plant.force
    generators[0, force, -1], generators[2, force, -1] = -1.0 / T, 1.0 / T
    generators[1, force, n + force] = -0.5 / T
    control_row = np.zeros(2 * n + 1)
    control_row[n + force] = -0.5
    target, fixed = terminal_target(plant, move)
    return SaturatedProblem(
        generators=generators,
        control_row=control_row,
        control_rate_row=control_row @ generators[1],
        target=target / scales,
        fixed=fixed,
        state_scale=scales,
        adjoint_scale=force_limit**2 * T / scales,
        force_limit=force_limit,
        t_f=t_f,
        rate=float(np.abs(np.linalg.eigvals(generators[1:])).max()),
    )


def solve_arcs(problem: SaturatedProblem, arcs: ArcSequence, *, bound: float) -> PiecewiseFlow:
    """Return the states and adjoints that meet both ends of the move with the given arcs.

    Parameters
    ----------
    problem
        The scaled problem.
    arcs
        Arcs of any lengths.
    bound
        Magnitude of the saturated control, in units of F_max.

    Returns
    -------
    PiecewiseFlow
        The control law need not hold: that is for the caller to judge.

    Raises
    ------
    numpy.linalg.LinAlgError
        If these arcs leave too little freedom to reach the target.
    """
    lengths = np.diff(arcs.edges)
    counts = np.maximum(1, np.ceil(lengths * (problem.rate / PIECE_ANGLE)).astype(np.int64))
    owner = np.repeat(np.arange(counts.size), counts)
    piece = np.arange(owner.size) - np.repeat(np.cumsum(counts) - counts, counts)
    piece_length = (lengths / counts)[owner]
    start = arcs.edges[owner] + piece * piece_length
    fraction = np.linspace(0.0, 1.0, SAMPLES_PER_PIECE + 1)
    step = lengths / counts / SAMPLES_PER_PIECE
    powers = matrix_powers(
        expm(problem.generators[arcs.labels + 1] * step[:, None, None]), SAMPLES_PER_PIECE
    )
    nodes = _solve_nodes(problem, powers[owner, -1], bound=bound)
    return PiecewiseFlow(
        bound=bound,
        labels=arcs.labels[owner],
        t=start[:, None] + piece_length[:, None] * fraction,
        z=(powers[owner] @ nodes[:, None, :, None])[..., 0],
    )


def matrix_powers(E: Array, last: int) -> Array:
    """Return E^0 ... E^last of a stack of matrices.

    Parameters
    ----------
    E
        Shape (k, N, N).
    last
        Highest power, >= 1.

    Returns
    -------
    ndarray, shape (k, last + 1, N, N)

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


def _solve_nodes(problem: SaturatedProblem, flow: Array, *, bound: float) -> Array:
    """Return z at the start of every piece from the matching and end conditions, (k, N)."""
    n = problem.order
    k, width = flow.shape[0], 2 * n
    last = np.concatenate([np.flatnonzero(problem.fixed), n + np.flatnonzero(~problem.fixed)])
    end_value = np.concatenate(
        [problem.target[problem.fixed], np.zeros(int((~problem.fixed).sum()))]
    )
    right = np.concatenate(
        [
            np.zeros(n),
            (flow[:-1, :width, width] * bound).ravel(),
            end_value - flow[-1, last, width] * bound,
        ]
    )
    lower, upper = 3 * n - 1, n
    band = np.zeros((lower + upper + 1, k * width))
    row, column = np.arange(n), np.arange(n)
    band[upper + row - column, column] = 1.0
    start = width * np.arange(k - 1)[:, None, None]
    i, j = np.arange(width)[:, None], np.arange(width)
    band[upper + n + i - j, start + j] = -flow[:-1, :width, :width]
    band[0, width:] = 1.0
    i = np.arange(n)[:, None]
    band[upper + n + i - j, width * (k - 1) + j] = flow[-1][last, :width]
    nodes = solve_banded((lower, upper), band, right, check_finite=False).reshape(k, width)
    return np.column_stack([nodes, np.full(k, bound)])
