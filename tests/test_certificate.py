from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import build_plant
from mtcommission.optimal.bang_bang import find_bang_bang
from mtcommission.optimal.control import Certificate, sample_trajectory
from mtcommission.optimal.free import BangBangMotion, certify, solve_time_optimal
from mtcommission.optimal.modes import MomentProblem, moment_problem, moment_rows
from mtcommission.optimal.switching import Control, build_mesh, isolate_zeros, prove_time
from tests.machines import paper_machine, random_modal_machine

STEP = VelocityStep(velocity_step=0.1)
POSITIONING = Positioning(distance=0.02)
PAPER = build_plant(paper_machine())
FORCE = 2e3


@cache
def solved(move: Move) -> tuple[MomentProblem, Control]:
    problem = moment_problem(PAPER, move)
    return problem, find_bang_bang(problem, span=problem.target / FORCE).control


def proved(problem: MomentProblem, weights: np.ndarray, *, near: float) -> Control:
    start = Control(zeros=np.empty(0), horizon=near, first_sign=1.0, weights=weights)
    return prove_time(build_mesh(problem, 1.1 * near), start, span=problem.target / FORCE)


def motion_of(problem: MomentProblem, control: Control) -> BangBangMotion:
    return BangBangMotion(
        plant=PAPER,
        problem=problem,
        switching_times=control.horizon - control.zeros[::-1],
        t_f=control.horizon,
        first_force=control.first_sign * (-1.0) ** control.zeros.size * FORCE,
    )


def certified(motion: BangBangMotion, weights: np.ndarray) -> Certificate:
    mesh = build_mesh(motion.problem, 1.1 * motion.t_f)
    return certify(motion, proved(motion.problem, weights, near=motion.t_f), nodes=mesh.nodes)


def final_adjoint(problem: MomentProblem, control: Control) -> np.ndarray:
    """λ(t_f), scaled by H = 0 at t = 0: |λ B| F_max = 1 there."""
    sigma = control.weights @ problem.values(np.array([control.horizon]))
    return -control.weights @ moment_rows(PAPER, problem) / (FORCE * abs(sigma[0]))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    noise=st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6),
    size=st.sampled_from([1e-6, 1e-3, 0.1, 3.0]),
    move=st.sampled_from([STEP, POSITIONING]),
)
def test_any_multipliers_prove_no_more_than_the_optimum(noise, size, move):
    # A bound above t_f would refute a control that exists.
    problem, control = solved(move)
    factors = 1.0 + size * np.array(noise[: problem.size])
    weights = control.weights * np.append(factors, 1.0)
    assert proved(problem, weights, near=control.horizon).horizon <= control.horizon


def test_no_multipliers_prove_the_rigid_bound():
    # c = 0: m Δv / F_max for a velocity step, sqrt(2 m L / F_max) for positioning.
    for move, expected in ((STEP, 0.0375), (POSITIONING, np.sqrt(2.0 * 750.0 * 0.02 / FORCE))):
        problem = moment_problem(PAPER, move)
        weights = np.append(np.zeros(problem.size), 1.0)
        bound = proved(problem, weights, near=0.05).horizon
        assert bound == pytest.approx(expected, rel=2e-13)
        assert bound < expected


@pytest.mark.parametrize("move", [STEP, POSITIONING])
def test_hamiltonian_vanishes_along_the_whole_move(move):
    problem, control = solved(move)
    optimum = solve_time_optimal(PAPER, move, force_limit=FORCE)
    end = final_adjoint(problem, control)
    motion = sample_trajectory(PAPER, optimum.arcs, step=1e-3)
    for t, force, x in zip(motion.t, motion.force, motion.states, strict=True):
        row = end @ expm(PAPER.A * (optimum.t_f - float(t)))
        assert 1.0 + row @ (PAPER.A @ x + PAPER.B * force) == pytest.approx(0.0, abs=1e-9)


def test_wrong_claims_are_refused():
    problem, control = solved(STEP)
    motion, weights = motion_of(problem, control), control.weights
    assert certified(motion, weights).switching_law_holds
    late = replace(motion, switching_times=motion.switching_times + 2e-4)
    assert not certified(late, weights).switching_law_holds
    mirrored = replace(motion, first_force=-motion.first_force)
    assert not certified(mirrored, weights).switching_law_holds
    fewer = replace(motion, switching_times=motion.switching_times[2:])
    assert not certified(fewer, weights).switching_law_holds
    slow = replace(motion, t_f=1.01 * motion.t_f)
    assert certified(slow, weights).relative_gap == pytest.approx(1 - 1 / 1.01, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_no_sign_change_is_missed(seed):
    plant = build_plant(random_modal_machine(seed, n_modes=1 + seed % 4))
    problem = moment_problem(plant, STEP if seed % 2 else POSITIONING)
    generator = np.random.default_rng(seed)
    mesh = build_mesh(problem, 0.3)
    c = generator.normal(size=problem.size) * 10.0 ** generator.uniform(-1, 1)
    weights = np.append(-c, 1.0)
    tau = np.linspace(0.0, 0.3, 300_001)
    sigma = weights @ problem.values(tau)
    changes = np.flatnonzero(sigma[1:] * sigma[:-1] < 0.0)
    zeros = isolate_zeros(mesh, weights).tau
    assert zeros.size == changes.size
    assert np.all((zeros >= tau[changes]) & (zeros <= tau[changes + 1]))


@pytest.mark.parametrize("offset", [0.0101, 0.0157])
@pytest.mark.parametrize("depth", [1e-4, 1e-8, 1e-12])
def test_pair_of_zeros_between_mesh_nodes_is_found(depth, offset):
    # 1 - (1 + depth) cos ω(τ - τ0) dips below 0 for 2 sqrt(2 depth) / ω around each maximum.
    omega = 300.0
    problem = MomentProblem(rates=np.array([1j * omega, -1e5]), degree=0, target=1.0)
    c = (1.0 + depth) * np.array([np.cos(omega * offset), np.sin(omega * offset), 0.0])
    zeros = isolate_zeros(build_mesh(problem, 0.1), np.append(-c, 1.0)).tau
    half_width = np.arccos(1.0 / (1.0 + depth)) / omega
    centres = offset + 2.0 * np.pi / omega * np.arange(5)
    centres = centres[centres < 0.1]
    expected = np.sort(np.concatenate([centres - half_width, centres + half_width]))
    assert zeros == pytest.approx(expected, abs=1e-16 / np.sqrt(depth) + 1e-15)
