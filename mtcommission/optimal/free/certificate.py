"""The proof of a time-optimal control, from its multipliers alone.

What is proved, and what each number means, is derived in docs/optimal-control.md, section 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import nan

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesdd

from mtcommission.optimal.free.bound import prove_bound
from mtcommission.optimal.free.dual import DualPoint
from mtcommission.optimal.free.flow import DyadicFlow, adjoint_samples
from mtcommission.optimal.free.mesh import ROUNDOFF
from mtcommission.optimal.free.moments import MomentProblem, moment_rows
from mtcommission.optimal.free.switching import values_and_slopes
from mtcommission.optimal.solution import Certificate
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

SIGN_TOLERANCE = 1e-9
"""|λ B| against its largest value below which a sign is not judged: there the control switches."""
SIGN_ROUNDING = 1e3 * ROUNDOFF
"""The same against the sum of the magnitudes that λ B is composed of: rounding of the matrix
exponential and its powers (empirical)."""
RANK_TOLERANCE = 1e-12
"""Singular value against the largest below which the terminal Jacobian counts as singular."""
TINY = 1e-300


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Claim:
    """A bang-bang control that is claimed to be time-optimal."""

    switching_times: Array  # Ascending, shape (n_switches,) [s]
    t_f: float  # Final time [s]
    first_force: float  # Set force on the first arc, ±F_max [N]
    point: DualPoint  # The multipliers, with all zeros of their switching function

    @property
    def adjoint_factor(self) -> float:
        """Factor between -λ B and σ that makes the Hamiltonian vanish at t = 0."""
        _, start = self.point.mesh.problem.combination(self.point.multipliers, self.t_f)
        return 1.0 / (abs(self.first_force) * abs(start))


def certify(claim: Claim, flow: DyadicFlow) -> Certificate:
    """Return what the multipliers of a control prove about it.

    The switching times enter only the comparisons; the bound comes from the multipliers.

    Source: Pontryagin's principle as in Christiansen, Maurer & Zirn, eq. (7)-(9); the bound:
    docs/optimal-control.md, section 2.

    Examples
    --------
    Multipliers that are a little off still prove a bound, only a weaker one:

    >>> from mtcommission.machine.moves import Positioning
    >>> from mtcommission.optimal.free.dual import evaluate_dual
    >>> from mtcommission.optimal.free.flow import dyadic_flow
    >>> from mtcommission.optimal.free.mesh import build_mesh
    >>> from mtcommission.optimal.free.moments import moment_problem
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> problem = moment_problem(plant, Positioning(distance=0.1))
    >>> point = evaluate_dual(build_mesh(problem, 0.5), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.19]),
    ...     span=problem.target / 2e3, near=0.4)
    >>> claim = Claim(switching_times=np.array([0.2]), t_f=0.4, first_force=2e3, point=point)
    >>> flow = dyadic_flow(plant, problem, t_f=0.4)
    >>> round(certify(claim, flow).t_f_lower_bound, 6)
    0.387231
    """
    problem, multipliers = claim.point.mesh.problem, claim.point.multipliers
    # The claim meets its target only to rounding, so the bound may exceed it by as little; what is
    # less is still a bound.
    span = problem.target / abs(claim.first_force)
    bound = min(prove_bound(claim.point, span=span), claim.t_f)
    # In the order of time, so those at t = 0 come first.
    remaining = claim.t_f - np.concatenate(((0.0,), claim.switching_times))
    functions = problem.joint_values(remaining)
    sigma, slopes = values_and_slopes(problem, multipliers, functions)
    factor, rank, condition = 1.0 / abs(claim.first_force * float(sigma[0])), -1, nan
    rows = factor * moment_rows(flow.plant, problem)
    end = multipliers.dot(rows[:-1]) - rows[-1]
    if remaining.size == problem.size + 1:
        values = dgesdd(_scaled(functions), compute_uv=0)[1].tolist()
        rank = sum(value > RANK_TOLERANCE * values[0] for value in values)
        condition = values[0] / max(values[-1], TINY)
    return Certificate(
        t_f_lower_bound=bound,
        relative_gap=(claim.t_f - bound) / claim.t_f,
        adjoint_initial=_adjoint_weights(claim, claim.t_f).dot(rows),
        switching_slopes=factor * slopes[1:],
        switching_law_holds=_law_holds(
            claim, flow, end, unit=factor, at_switches=factor * np.abs(sigma[1:])
        ),
        terminal_jacobian_rank=rank,
        terminal_jacobian_condition=condition,
    )


def adjoint(plant: Plant, claim: Claim, *, tau: float) -> Array:
    """Return λ at the remaining time τ, in the states of the plant.

    Source: λ(τ) B = -factor σ(τ) with the rows of ``moment_rows``, each of which evolves by its
    own e^{pτ}.
    """
    rows = moment_rows(plant, claim.point.mesh.problem)
    return np.asarray(claim.adjoint_factor * _adjoint_weights(claim, tau) @ rows)


def _adjoint_weights(claim: Claim, tau: float) -> Array:
    """Return the weights of ``moment_rows`` in λ, but for the adjoint factor."""
    problem, multipliers = claim.point.mesh.problem, claim.point.multipliers
    n_modes = problem.n_modes
    weights = np.empty(multipliers.size + 1)
    weights[:-1], weights[-1] = multipliers, -1.0
    pairs = weights[: 2 * n_modes].view(np.complex128)
    # Conjugate: Re C e^{pτ} with C = c_1 - i c_2.
    pairs *= np.exp(problem.rates[:n_modes] * tau).conj()
    weights[problem.lag] *= np.exp(problem.rates[n_modes:].real * tau)
    if problem.degree:
        # ψ = τ belongs to a Jordan block: its row gains τ times the row of φ = 1.
        weights[-2] -= tau
    return weights


def terminal_jacobian(problem: MomentProblem, zeros: Array, horizon: float) -> Array:
    """Return the scaled Jacobian of the terminal conditions over switching times and t_f.

    Source: Christiansen, Maurer & Zirn, sec. 5.1.
    """
    return _scaled(problem.joint_values(np.append(zeros, horizon)))


def _scaled(functions: Array) -> Array:
    """Return functions with rows and then columns of length 1."""
    lengths = np.sqrt(np.add.reduce(functions * functions, axis=1))
    by_row = functions / np.maximum(lengths, TINY)[:, np.newaxis]
    return np.asarray(by_row / np.sqrt(np.add.reduce(by_row * by_row)))


def _law_holds(
    claim: Claim, flow: DyadicFlow, end: Array, *, unit: float, at_switches: Array
) -> bool:
    """Check F_set = -sign(λ B) F_max with the adjoint equation integrated on A from λ(t_f) on.

    ``unit`` is |λ B| per σ, ``at_switches`` |λ B| there.
    """
    problem = claim.point.mesh.problem
    samples = adjoint_samples(flow, problem, end)
    edges = samples.tau.searchsorted(claim.t_f - claim.switching_times[::-1]).tolist()
    counts = [stop - start for start, stop in pairwise([0, *edges, samples.tau.size])]
    last = (1.0 if claim.first_force > 0.0 else -1.0) * (-1.0) ** len(edges)
    signs = np.array([last, -last] * len(counts))[: len(counts)].repeat(counts)
    composed = sum(problem.amplitudes(claim.point.multipliers).tolist()) + claim.t_f**problem.degree
    signed = signs * samples.along
    against, largest = float(signed[signed.argmax()]), -float(signed[signed.argmin()])
    zero = SIGN_TOLERANCE * max(against, largest) + SIGN_ROUNDING * unit * composed
    return bool(max([against, *at_switches.tolist()]) <= zero)
