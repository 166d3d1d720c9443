from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.optimal.free.bound import prove_bound
from mtcommission.optimal.free.certificate import Claim, adjoint, certify, terminal_jacobian
from mtcommission.optimal.free.dual import DualPoint, evaluate_dual
from mtcommission.optimal.free.flow import adjoint_samples, dyadic_flow
from mtcommission.optimal.free.mesh import build_mesh
from mtcommission.optimal.free.moments import MomentProblem, moment_problem
from mtcommission.optimal.free.newton_refinement import BangBang
from mtcommission.optimal.free.search import find_bang_bang
from mtcommission.optimal.free.switching import bracket_zeros, has_one_zero, isolate_zeros
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import (
    Bang,
    Certificate,
    constant_arc,
    propagate,
    sample_trajectory,
)
from mtcommission.plant.plant import build_plant
from tests.machines import paper_machine, random_modal_machine
from tests.references_optimal import PAPER_ADJOINT, PAPER_SWITCHING_TIMES, PAPER_T_F

STEP = VelocityStep(velocity_step=0.1)
POSITIONING = Positioning(distance=0.02)
PAPER = build_plant(paper_machine())
FORCE = 2e3


@cache
def solved(move: Move) -> tuple[MomentProblem, BangBang]:
    problem = moment_problem(PAPER, move)
    return problem, find_bang_bang(problem, span=problem.target / FORCE).control


def certified(claim: Claim) -> Certificate:
    return certify(claim, dyadic_flow(PAPER, claim.point.mesh.problem, t_f=claim.t_f))


def claim_of(problem: MomentProblem, control: BangBang) -> Claim:
    return Claim(
        switching_times=control.horizon - control.zeros[::-1],
        t_f=control.horizon,
        first_force=control.first_sign * (-1.0) ** control.zeros.size * FORCE,
        point=point_of(problem, control.multipliers, near=control.horizon),
    )


def point_of(problem: MomentProblem, multipliers: np.ndarray, *, near: float) -> DualPoint:
    mesh = build_mesh(problem, 1.1 * near)
    return evaluate_dual(mesh, multipliers, span=problem.target / FORCE, near=near)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    noise=st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6),
    size=st.sampled_from([1e-6, 1e-3, 0.1, 3.0]),
    move=st.sampled_from([STEP, POSITIONING]),
)
def test_any_multipliers_prove_no_more_than_the_optimum(
    noise: list[float], size: float, move: Move
) -> None:
    # A bound above t_f would refute a control that exists.
    problem, control = solved(move)
    factors = 1.0 + size * np.array(noise[: problem.size])
    point = point_of(problem, control.multipliers * factors, near=control.horizon)
    bound = prove_bound(point, span=problem.target / FORCE)
    assert bound <= control.horizon


@pytest.mark.parametrize("move", [STEP, POSITIONING])
def test_bound_is_where_the_integral_of_sigma_reaches_the_span(move: Move) -> None:
    problem, control = solved(move)
    span = problem.target / FORCE
    bound = prove_bound(point_of(problem, control.multipliers, near=0.05), span=span)
    tau, weight = gauss_legendre(0.0, bound, pieces=4000)
    sigma = problem.target_values(tau) - problem.values(tau) @ control.multipliers
    # Pieces that hold a zero are off by the square of their length.
    assert weight @ np.abs(sigma) == pytest.approx(span, rel=1e-7)
    assert 0.0 <= control.horizon - bound < 1e-12 * control.horizon


def gauss_legendre(start: float, end: float, *, pieces: int) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(4)
    edges = np.linspace(start, end, pieces + 1)
    half = 0.5 * np.diff(edges)[:, np.newaxis]
    middle = 0.5 * (edges[1:] + edges[:-1])[:, np.newaxis]
    return (middle + half * nodes).ravel(), (half * weights).ravel()


def test_no_multipliers_prove_the_rigid_bound() -> None:
    # c = 0: m Δv / F_max for a velocity step, sqrt(2 m L / F_max) for positioning.
    for move, expected in ((STEP, 0.0375), (POSITIONING, np.sqrt(2.0 * 750.0 * 0.02 / FORCE))):
        problem = moment_problem(PAPER, move)
        point = point_of(problem, np.zeros(problem.size), near=0.05)
        bound = prove_bound(point, span=problem.target / FORCE)
        assert bound == pytest.approx(expected, rel=1e-13)
        assert bound < expected


@pytest.mark.parametrize("move", [STEP, POSITIONING])
def test_hamiltonian_vanishes_along_the_whole_move(move: Move) -> None:
    problem, control = solved(move)
    optimum = solve_time_optimal(PAPER, move, force_limit=FORCE)
    motion = sample_trajectory(PAPER, optimum.arcs, step=1e-3)
    for t, force, x in zip(motion.t, motion.force, motion.states, strict=True):
        row = adjoint(PAPER, claim_of(problem, control), tau=optimum.t_f - float(t))
        assert 1.0 + row @ (PAPER.A @ x + PAPER.B * force) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("move", [STEP, POSITIONING])
def test_adjoint_obeys_the_adjoint_equation(move: Move) -> None:
    problem, control = solved(move)
    claim = claim_of(problem, control)
    end = adjoint(PAPER, claim, tau=0.0)
    for tau in (1e-3, 0.01, control.horizon):
        row = adjoint(PAPER, claim, tau=tau)
        assert row == pytest.approx(end @ expm(PAPER.A * tau), rel=1e-9, abs=1e-14)
    if isinstance(move, VelocityStep):
        # The end position is free, so nothing is gained or lost by it.
        assert end[PAPER.position] == 0.0


@pytest.mark.parametrize("t_f", [0.04, 7.0])
def test_adjoint_samples_are_dense_where_poles_live_and_exact(t_f: float) -> None:
    # A gap would let a sign of λ B go unchecked; a wrong sample would refuse a true law.
    problem = moment_problem(PAPER, POSITIONING)
    end = np.array([0.3, -0.2, 0.5, 0.1, 1.0, -2.0, 0.4])
    samples = adjoint_samples(dyadic_flow(PAPER, problem, t_f=t_f), problem, end)
    assert samples.tau[0] == 0.0
    assert samples.tau[-1] == pytest.approx(t_f, rel=1e-14)
    for start, gap in zip(samples.tau[:-1], np.diff(samples.tau), strict=True):
        alive = -problem.rates.real * start < 36.0
        assert gap * np.max(np.abs(problem.rates) * alive, initial=0.0) <= 0.2 * (1.0 + 1e-12)
    assert samples.tau.size < 50.0 + t_f * 452.0 / 0.1
    chosen = np.arange(0, samples.tau.size, max(1, samples.tau.size // 23))
    exact = [(end @ expm(PAPER.A * tau)) @ PAPER.B for tau in samples.tau[chosen].tolist()]
    size = float(np.abs(samples.along).max())
    assert samples.along[chosen] == pytest.approx(np.array(exact), rel=1e-10, abs=1e-12 * size)


def test_paper_adjoint_belongs_to_the_paper_times() -> None:
    # λ(0) follows from the zeros of σ; from the printed, rounded times it comes out as printed.
    problem = moment_problem(PAPER, STEP)
    times = np.array(PAPER_SWITCHING_TIMES)
    c = np.linalg.solve(problem.values(PAPER_T_F - times), np.ones(problem.size))
    point = point_of(problem, c, near=PAPER_T_F)
    claim = Claim(switching_times=times, t_f=PAPER_T_F, first_force=FORCE, point=point)
    row = adjoint(PAPER, claim, tau=PAPER_T_F)
    assert row == pytest.approx(np.array(PAPER_ADJOINT), rel=0.015)
    # The exact times differ by 6e-5 s, and λ(0) by up to 7 %: it hangs on an arc of 0.3 ms.
    exact = solve_time_optimal(PAPER, STEP, force_limit=FORCE).certificate.adjoint_initial
    assert exact == pytest.approx(np.array(PAPER_ADJOINT), rel=0.07)
    assert exact[PAPER.force] == pytest.approx(-PAPER.force_lag / FORCE, rel=1e-12)


def test_slopes_are_those_of_the_switching_function() -> None:
    problem, control = solved(STEP)
    claim = claim_of(problem, control)
    certificate = certified(claim)
    step = 1e-7
    for t, slope in zip(claim.switching_times, certificate.switching_slopes, strict=True):
        before = adjoint(PAPER, claim, tau=claim.t_f - t + step)[PAPER.force]
        after = adjoint(PAPER, claim, tau=claim.t_f - t - step)[PAPER.force]
        difference = (after - before) / (2.0 * step * PAPER.force_lag)
        assert slope == pytest.approx(difference, rel=1e-5)


def test_wrong_claims_are_refused() -> None:
    problem, control = solved(STEP)
    claim = claim_of(problem, control)
    late = replace(claim, switching_times=claim.switching_times + 2e-4)
    assert not certified(late).switching_law_holds
    mirrored = replace(claim, first_force=-claim.first_force)
    assert not certified(mirrored).switching_law_holds
    fewer = replace(claim, switching_times=claim.switching_times[2:])
    assert not certified(fewer).switching_law_holds
    slow = replace(claim, t_f=1.01 * claim.t_f)
    assert certified(slow).relative_gap == pytest.approx(1 - 1 / 1.01, rel=1e-6)


def test_terminal_jacobian_is_that_of_the_states() -> None:
    problem, control = solved(STEP)
    claim = claim_of(problem, control)
    rows = [i for i in range(PAPER.order) if i != PAPER.position]
    times = np.append(claim.switching_times, claim.t_f)
    step = 1e-8
    columns = []
    for i in range(times.size):
        shift = step * (np.arange(times.size) == i)
        ahead, behind = final_state(times + shift), final_state(times - shift)
        columns.append((ahead - behind)[rows] / (2.0 * step))
    states = np.column_stack(columns)
    states /= np.linalg.norm(states, axis=1, keepdims=True)
    assert np.linalg.matrix_rank(states, tol=1e-6) == problem.size + 1
    ours = terminal_jacobian(problem, control.zeros, control.horizon)
    assert ours.shape == states.shape
    # Both are regular together: a direction that one maps to nothing would show in the other.
    assert np.linalg.svd(ours, compute_uv=False)[-1] > 1e-3


def final_state(times: np.ndarray) -> np.ndarray:
    edges = [0.0, *times]
    arcs = [
        constant_arc(start, end, control=Bang(1 if i % 2 == 0 else -1), force=FORCE * (-1.0) ** i)
        for i, (start, end) in enumerate(pairwise(edges))
    ]
    return propagate(PAPER, tuple(arcs))


def test_merged_switches_lower_the_rank() -> None:
    # Two equal switching times span one direction only, so the second-order test must fail.
    problem, control = solved(STEP)
    zeros = control.zeros.copy()
    zeros[2] = zeros[1]
    values = np.linalg.svd(terminal_jacobian(problem, zeros, control.horizon), compute_uv=False)
    assert np.sum(values > 1e-12 * values[0]) == problem.size


@pytest.mark.parametrize("seed", range(12))
def test_no_sign_change_is_missed(seed: int) -> None:
    plant = build_plant(random_modal_machine(seed, n_modes=1 + seed % 4))
    problem = moment_problem(plant, STEP if seed % 2 else POSITIONING)
    generator = np.random.default_rng(seed)
    mesh = build_mesh(problem, 0.3)
    c = generator.normal(size=problem.size) * 10.0 ** generator.uniform(-1, 1)
    tau = np.linspace(0.0, 0.3, 300_001)
    sigma = problem.target_values(tau) - problem.values(tau) @ c
    changes = np.flatnonzero(sigma[1:] * sigma[:-1] < 0.0)
    zeros = isolate_zeros(mesh, c).tau
    assert zeros.size == changes.size
    assert np.all((zeros >= tau[changes]) & (zeros <= tau[changes + 1]))


@pytest.mark.parametrize("seed", range(12))
def test_cells_that_bend_to_one_side_bracket_the_same_zeros(seed: int) -> None:
    # One zero too few or too many in a cell would let a wrong control pass for proved.
    plant = build_plant(random_modal_machine(seed, n_modes=1 + seed % 4))
    problem = moment_problem(plant, STEP if seed % 2 else POSITIONING)
    generator = np.random.default_rng(100 + seed)
    mesh, horizon = build_mesh(problem, 0.3), 0.2
    c = generator.normal(size=problem.size) * 10.0 ** generator.uniform(-1, 1)
    zeros = isolate_zeros(mesh, c).tau
    start, length = bracket_zeros(mesh, c, horizon=horizon, settled=has_one_zero).cells[:2]
    inside = (start[:, np.newaxis] <= zeros) & (zeros <= (start + length)[:, np.newaxis])
    assert np.all(inside.sum(axis=1) == 1)
    assert inside.any(axis=0)[zeros < horizon].all()


@pytest.mark.parametrize("offset", [0.0101, 0.0123, 0.0157])
@pytest.mark.parametrize("depth", [1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
def test_pair_of_zeros_between_mesh_nodes_is_found(depth: float, offset: float) -> None:
    # 1 - (1 + depth) cos ω(τ - τ0) dips below 0 for 2 sqrt(2 depth) / ω around each maximum.
    omega = 300.0
    problem = MomentProblem(rates=np.array([1j * omega, -1e5]), degree=0, target=1.0)
    c = (1.0 + depth) * np.array([np.cos(omega * offset), np.sin(omega * offset), 0.0])
    zeros = isolate_zeros(build_mesh(problem, 0.1), c).tau
    half_width = np.arccos(1.0 / (1.0 + depth)) / omega
    centres = offset + 2.0 * np.pi / omega * np.arange(5)
    centres = centres[centres < 0.1]
    expected = np.sort(np.concatenate([centres - half_width, centres + half_width]))
    assert zeros == pytest.approx(expected, abs=1e-16 / np.sqrt(depth) + 1e-15)


def test_constant_force_is_refused_by_its_bound_not_by_an_error() -> None:
    # A search that ends with no switch at all must end in a named outcome.
    problem = moment_problem(PAPER, STEP)
    span = problem.target / 2e3
    point = evaluate_dual(build_mesh(problem, 0.5), np.zeros(problem.size), span=span, near=0.1)
    claim = Claim(switching_times=np.empty(0), t_f=0.4, first_force=2e3, point=point)
    certificate = certify(claim, dyadic_flow(PAPER, problem, t_f=claim.t_f))
    assert point.zeros.size == 0
    assert certificate.t_f_lower_bound == pytest.approx(span, rel=1e-12)
    assert certificate.relative_gap > 0.9
    assert certificate.switching_slopes.size == 0
