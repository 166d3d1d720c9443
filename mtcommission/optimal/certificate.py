"""The proof of a time-optimal control, from its multipliers alone.

What is proved, and what each number means, is derived in docs/optimal-control.md, section 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.optimal.bound import prove_bound
from mtcommission.optimal.dual import DualPoint
from mtcommission.optimal.mesh import ROUNDOFF, uniform_pieces
from mtcommission.optimal.moments import MomentProblem, moment_rows
from mtcommission.optimal.solution import Certificate
from mtcommission.optimal.switching import values_and_slopes
from mtcommission.plant import Plant

Array = NDArray[np.float64]

CHECK_RADIANS = 0.2
"""Distance of the checks of the switching law against the fastest pole (empirical)."""
SIGN_TOLERANCE = 1e-9
"""|λ_F| against its largest value below which a sign is not judged: there the control switches."""
SIGN_ROUNDING = 1e3 * ROUNDOFF
"""The same against the sum of the magnitudes that λ_F is composed of: rounding of the matrix
exponential and its powers (empirical)."""
RANK_TOLERANCE = 1e-12
"""Singular value against the largest below which the terminal Jacobian counts as singular."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Claim:
    """A bang-bang control that is claimed to be time-optimal.

    Parameters
    ----------
    switching_times
        Ascending, shape (n_switches,) [s].
    t_f
        Final time [s].
    first_force
        Set force on the first arc, ±F_max [N].
    point
        The multipliers, with all zeros of their switching function.
    """

    switching_times: Array
    t_f: float
    first_force: float
    point: DualPoint

    @property
    def adjoint_factor(self) -> float:
        """Factor between -λ_F/T and σ that makes the Hamiltonian vanish at t = 0."""
        _, start = self.point.mesh.problem.combination(self.point.multipliers, self.t_f)
        return 1.0 / (abs(self.first_force) * abs(start))


def certify(plant: Plant, claim: Claim) -> Certificate:
    """Return what the multipliers of a control prove about it.

    The switching times enter only the comparisons; the bound comes from the multipliers.

    Parameters
    ----------
    plant
        The plant.
    claim
        Control and multipliers.

    Returns
    -------
    Certificate

    Source: Pontryagin's principle as in Christiansen, Maurer & Zirn, eq. (7)-(9); the bound:
    docs/optimal-control.md, section 2.

    Examples
    --------
    Multipliers that are a little off still prove a bound, only a weaker one:

    >>> from mtcommission.machine import Positioning
    >>> from mtcommission.optimal.dual import evaluate_dual
    >>> from mtcommission.optimal.mesh import build_mesh
    >>> from mtcommission.optimal.moments import moment_problem
    >>> from mtcommission.plant import build_plant
    >>> from tests.machines import paper_machine
    >>> plant = build_plant(paper_machine())
    >>> problem = moment_problem(plant, Positioning(distance=0.1))
    >>> point = evaluate_dual(build_mesh(problem, 0.5), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.19]),
    ...     span=problem.target / 2e3, near=0.4)
    >>> claim = Claim(switching_times=np.array([0.2]), t_f=0.4, first_force=2e3, point=point)
    >>> round(certify(plant, claim).t_f_lower_bound, 6)
    0.387231
    """
    problem, multipliers = claim.point.mesh.problem, claim.point.multipliers
    # The claim meets its target only to rounding, so the bound may exceed it by as little; what is
    # less is still a bound.
    span = problem.target / abs(claim.first_force)
    bound = min(prove_bound(claim.point, span=span), claim.t_f)
    zeros = claim.t_f - claim.switching_times
    at_switches, slopes, _ = values_and_slopes(problem, multipliers, zeros)
    factor, rank, condition = claim.adjoint_factor, -1, nan
    rows = moment_rows(plant, problem)
    end = _adjoint_weights(claim, 0.0) @ rows
    if zeros.size == problem.size:
        values = np.linalg.svd(terminal_jacobian(problem, zeros, claim.t_f), compute_uv=False)
        rank = int(np.sum(values > RANK_TOLERANCE * values[0]))
        condition = float(values[0] / values[-1])
    return Certificate(
        t_f_lower_bound=bound,
        relative_gap=(claim.t_f - bound) / claim.t_f,
        adjoint_initial=_adjoint_weights(claim, claim.t_f) @ rows,
        switching_slopes=factor * slopes,
        switching_law_holds=_law_holds(plant, claim, end, factor * at_switches),
        terminal_jacobian_rank=rank,
        terminal_jacobian_condition=condition,
    )


def adjoint(plant: Plant, claim: Claim, *, tau: float) -> Array:
    """Return λ at the remaining time τ, in the states of the plant.

    Parameters
    ----------
    plant, claim
        The claimed control.
    tau
        t_f - t [s].

    Returns
    -------
    ndarray, shape (n,)
        Normalised by 1 + λ(Ax + B F_set) = 0.

    Source: λ(τ) B = -factor σ(τ) with the rows of ``moment_rows``, each of which evolves by its
    own e^{pτ}.
    """
    rows = moment_rows(plant, claim.point.mesh.problem)
    return np.asarray(_adjoint_weights(claim, tau) @ rows)


def _adjoint_weights(claim: Claim, tau: float) -> Array:
    """Return the weights of ``moment_rows`` in λ."""
    problem, multipliers = claim.point.mesh.problem, claim.point.multipliers
    n_modal = 2 * problem.rates.size - 2
    complex_c = multipliers[0:n_modal:2] - 1j * multipliers[1:n_modal:2]
    turned = complex_c * np.exp(problem.rates[:-1] * tau)
    weights = np.append(multipliers, -1.0)
    weights[0:n_modal:2], weights[1:n_modal:2] = turned.real, -turned.imag
    weights[n_modal] *= np.exp(problem.rates[-1].real * tau)
    if problem.degree:
        # ψ = τ belongs to a Jordan block: its row gains τ times the row of φ = 1.
        weights[-2] -= tau
    return np.asarray(claim.adjoint_factor * weights)


def terminal_jacobian(problem: MomentProblem, zeros: Array, horizon: float) -> Array:
    """Return the scaled Jacobian of the terminal conditions over switching times and t_f.

    Parameters
    ----------
    problem
        The moment problem.
    zeros
        Remaining times of the switches, shape (k,) [s].
    horizon
        t_f [s].

    Returns
    -------
    ndarray, shape (size + 1, k + 1)
        In moment coordinates, a regular linear map of the states, with rows and then columns
        scaled to length 1 (signs of columns left out); rank as in the states.

    Source: Christiansen, Maurer & Zirn, sec. 5.1.
    """
    at = np.append(zeros, horizon)
    functions = np.empty((problem.size + 1, at.size))
    functions[:-1], functions[-1] = problem.values(at).T, problem.target_values(at)
    by_row = functions / np.maximum(np.sqrt((functions**2).sum(axis=1, keepdims=True)), 1e-300)
    return np.asarray(by_row / np.sqrt((by_row**2).sum(axis=0)))


def _law_holds(plant: Plant, claim: Claim, row: Array, at_switches: Array) -> bool:
    """Check F_set = -sign(λ_F) F_max with the adjoint equation integrated on A from λ(t_f) on."""
    problem = claim.point.mesh.problem
    tau, lambda_force = [], []
    for piece in uniform_pieces(problem, claim.t_f, radians=CHECK_RADIANS):
        rows = _march(row, expm(plant.A * piece.step), piece.count + 1)
        row = rows[-1]
        tau.append(piece.start + piece.step * np.arange(piece.count + 1))
        lambda_force.append(rows[:, plant.force])
    values = np.concatenate(lambda_force)
    arcs = claim.switching_times.searchsorted(claim.t_f - np.concatenate(tau))
    force = np.where(arcs % 2, -claim.first_force, claim.first_force)
    composed = np.sum(problem.amplitudes(claim.point.multipliers)) + claim.t_f**problem.degree
    composed *= claim.adjoint_factor * plant.force_lag
    zero = SIGN_TOLERANCE * np.max(np.abs(values)) + SIGN_ROUNDING * composed
    vanishes = np.all(np.abs(at_switches) * plant.force_lag <= zero)
    return bool(vanishes and np.all((force * values < 0.0) | (np.abs(values) <= zero)))


def _march(row: Array, transition: Array, count: int) -> Array:
    """Return row, row E, row E², ..., shape (count, n), by doubling."""
    rows = np.empty((count, row.size))
    rows[0], done = row, 1
    while done < count:
        more = min(done, count - done)
        np.matmul(rows[:more], transition, out=rows[done : done + more])
        done, transition = done + more, transition @ transition
    return rows
