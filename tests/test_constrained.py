from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import sparse
from scipy.linalg import expm
from scipy.optimize import linprog

from benchmarks.constrained_survey import cases, judge, largest_excess
from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant, driven_at_once
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.control import Bound, Boundary, TimeOptimum, propagate, sample_trajectory
from mtcommission.optimal.edits import solve_exactly
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.optimal.modes import impulse_response, step_response, transition
from mtcommission.optimal.newton import solve_sequence
from mtcommission.optimal.problem import Atom, BoundedProblem, bounded_problem
from mtcommission.optimal.proof import Measure, weigh
from mtcommission.optimal.sequence import Piece, Pieces
from tests.machines import paper_machine, random_modal_machine

PAPER_STEP = VelocityStep(velocity_step=0.1)


def bound(name: str, value: float) -> tuple[Bound, ...]:
    return (Bound(name=name, value=value),)


@cache
def paper_plant() -> Plant:
    return build_plant(paper_machine())


@cache
def paper_optimum(
    bounds: tuple[Bound, ...], move: VelocityStep | Positioning = PAPER_STEP
) -> TimeOptimum:
    return solve_bounded_time_optimal(paper_plant(), move, force_limit=2e3, bounds=bounds)


def check_motion(plant: Plant, optimum: TimeOptimum) -> None:
    """Follow the arcs by the matrix exponential and look at every promise of the result."""
    F = optimum.force_limit
    target = np.zeros(plant.order)
    if isinstance(optimum.move, VelocityStep):
        target[plant.velocity] = optimum.move.velocity_step
    else:
        target[plant.position] = optimum.move.distance
    error = propagate(plant, optimum.arcs) - target
    if isinstance(optimum.move, VelocityStep):
        error[plant.position] = 0.0
    # One exponential over a boundary arc of 60 ms is itself right to some 1e-9 only.
    assert np.all(np.abs(error) <= 2e-9 * optimum.peaks[: plant.order])
    for before, after in pairwise(optimum.arcs):
        assert before.t_end == after.t_start
    path = sample_trajectory(plant, optimum.arcs, step=min(optimum.t_f / 5000, 3e-5))
    assert np.abs(path.force).max() <= F * (1.0 + 1e-9)
    for limit in optimum.bounds:
        assert np.abs(path.states @ plant.row(limit.name)).max() <= limit.value * (1.0 + 1e-9)
    rows = np.array([plant.row(signal) for signal in plant.signals])
    assert_allclose(np.abs(path.states @ rows.T).max(axis=0), optimum.peaks, rtol=1e-4)


def reach(bounds: tuple[Bound, ...], t_f: float, *, n: int) -> float:
    """Reachable multiple of the paper's step on n even cells, the states being unknowns.

    An interior-point method on the sparse recursion x_(k+1) = Phi x_k + Gamma u_k.
    """
    plant = paper_plant()
    size, joint = plant.order, np.zeros((plant.order + 1, plant.order + 1))
    joint[:size, :size], joint[:size, size] = plant.A, plant.B * 2e3
    scale = paper_optimum(()).peaks[:size]
    flow = expm(joint * (t_f / n))
    step = flow[:size, :size] * scale / scale[:, np.newaxis]
    push = (flow[:size, size] / scale)[:, np.newaxis]
    fixed = np.delete(np.eye(size), plant.position, axis=0)
    goal = fixed[:, plant.velocity] * 0.1 / scale[plant.velocity]
    shift = sparse.diags_array(np.ones(n - 1), offsets=-1, shape=(n, n))
    recursion = sparse.hstack(
        [
            sparse.eye_array(n * size) - sparse.kron(shift, step),
            -sparse.kron(sparse.eye_array(n), push),
            sparse.csr_array((n * size, 1)),
        ]
    )
    ends = len(fixed)
    last = sparse.hstack(
        [
            sparse.csr_array((ends, (n - 1) * size)),
            sparse.csr_array(fixed),
            sparse.csr_array((ends, n)),
            sparse.csr_array(-goal[:, np.newaxis]),
        ]
    )
    rows = np.array([plant.row(limit.name) * scale / limit.value for limit in bounds])
    levels = sparse.hstack(
        [sparse.kron(sparse.eye_array(n), rows), sparse.csr_array((n * len(bounds), n + 1))]
    )
    result = linprog(
        np.append(np.zeros(n * (size + 1)), -1.0),
        A_ub=sparse.vstack([levels, -levels]).tocsc(),
        b_ub=np.ones(2 * n * len(bounds)),
        A_eq=sparse.vstack([recursion, last]).tocsc(),
        b_eq=np.zeros(n * size + ends),
        bounds=[(None, None)] * (n * size) + [(-1.0, 1.0)] * n + [(0.0, None)],
        method="highs-ipm",
        # Presolve ends without an answer at every other t_f.
        options={"presolve": False},
    )
    assert result.x is not None
    return float(result.x[-1])


def test_christiansen_maurer_zirn_sec_5_2_bound_on_v_phi() -> None:
    optimum = paper_optimum(bound("v_phi", 0.005))
    assert round(optimum.t_f, 4) == 0.0523  # the paper prints 0.0522, found on a grid
    assert 1.20 < optimum.t_f / 0.043520364 < 1.21
    held = [arc.control for arc in optimum.arcs if isinstance(arc.control, Boundary)]
    assert held == [Boundary("v_phi", 1), Boundary("v_phi", -1)]
    assert [(at.signal, at.side) for at in optimum.touch_points] == [("v_phi", 1)]
    assert optimum.certificate.relative_gap < 1e-10
    assert optimum.certificate.switching_law_holds
    check_motion(paper_plant(), optimum)


@pytest.mark.parametrize(("name", "value"), [("v_phi", 0.005), ("phi", 5e-5)])
def test_time_lies_where_an_independent_program_tends_to(name: str, value: float) -> None:
    """The program's time falls as 1/n²: extrapolated, it must be ours, or ours is no optimum."""
    optimum, times = paper_optimum(bound(name, value)), []
    for n in (250, 500):
        here, there = optimum.t_f, optimum.t_f * 1.001
        low, high = (reach(optimum.bounds, t, n=n) for t in (here, there))
        times.append(here + (there - here) * (1.0 - low) / (high - low))
    coarse, fine = times
    assert abs(coarse / optimum.t_f - 1.0) < 2e-4
    assert abs((4.0 * fine - coarse) / 3.0 / optimum.t_f - 1.0) < 1e-5


@pytest.mark.parametrize(
    ("name", "value"),
    [("v_phi", 0.02), ("v_phi", 0.01), ("F", 1500.0), ("v_b", 0.002)],
)
def test_bounds_of_order_one_and_two_are_solved_exactly(name: str, value: float) -> None:
    optimum = paper_optimum(bound(name, value))
    assert optimum.certificate.relative_gap < 1e-10
    assert optimum.certificate.switching_law_holds
    check_motion(paper_plant(), optimum)


@pytest.mark.parametrize(
    ("name", "value", "gap"), [("phi", 5e-5, 1e-6), ("phi", 1e-5, 5e-4), ("x_b", 3e-5, 1e-6)]
)
def test_bound_of_order_three_is_enclosed(name: str, value: float, gap: float) -> None:
    """No finite sequence of arcs is optimal here; the gap says how much the mesh leaves."""
    optimum = paper_optimum(bound(name, value))
    assert optimum.certificate.relative_gap <= gap
    check_motion(paper_plant(), optimum)
    assert largest_excess(paper_plant(), optimum) < 1e-9


@pytest.mark.parametrize(
    ("move", "value"),
    [
        (PAPER_STEP, 100.0),
        (Positioning(distance=0.02), 100.0),
        (Positioning(distance=0.02), 300.0),
        (Positioning(distance=0.05, max_velocity=0.1), 100.0),
    ],
)
def test_tight_bound_on_the_force_is_solved_and_lies_between_two_free_optima(
    move: VelocityStep | Positioning, value: float
) -> None:
    """Force that small may follow at once or with its lag: the bounded optimum lies between."""
    plant, bounds = paper_plant(), bound("F", value)
    optimum = paper_optimum(bounds, move)
    assert optimum.certificate.relative_gap < 1e-9
    assert optimum.certificate.switching_law_holds
    check_motion(plant, optimum)
    slow = solve_bounded_time_optimal(plant, move, force_limit=value, bounds=())
    assert optimum.t_f < slow.t_f
    at_once = 1e-3 * plant.force_lag
    A = plant.A.copy()
    A[plant.force] *= plant.force_lag / at_once
    swift = replace(plant, force_lag=at_once, A=A, B=plant.B * (plant.force_lag / at_once))
    fastest = solve_bounded_time_optimal(swift, move, force_limit=value, bounds=())
    assert fastest.t_f < optimum.t_f


def test_tighter_bound_never_means_less_time() -> None:
    times = [paper_optimum(bound("v_phi", value)).t_f for value in (0.03, 0.02, 0.01, 0.005)]
    assert times == sorted(times)


def test_scaling_force_step_and_bound_together_leaves_the_times() -> None:
    once = paper_optimum(bound("v_phi", 0.02))
    twice = solve_bounded_time_optimal(
        paper_plant(),
        VelocityStep(velocity_step=0.2),
        force_limit=4e3,
        bounds=bound("v_phi", 0.04),
    )
    assert_allclose(twice.switching_times, once.switching_times, rtol=1e-8)


def test_bound_that_the_free_optimum_keeps_changes_nothing() -> None:
    free = solve_time_optimal(paper_plant(), PAPER_STEP, force_limit=2e3)
    loose = paper_optimum(bound("v_phi", 0.05))
    assert (loose.t_f, loose.switching_times) == (free.t_f, free.switching_times)
    assert loose.bounds == bound("v_phi", 0.05)


def test_positioning_keeps_its_max_velocity() -> None:
    move = Positioning(distance=0.02, max_velocity=0.2)
    optimum = paper_optimum((), move)
    assert optimum.bounds == bound("v_s", 0.2)
    assert optimum.t_f > solve_time_optimal(paper_plant(), move, force_limit=2e3).t_f
    assert optimum.certificate.relative_gap < 1e-10
    check_motion(paper_plant(), optimum)


@pytest.mark.parametrize(
    ("move", "name", "value", "least"),
    [
        (PAPER_STEP, "v_s", 0.099, "0.1"),
        (PAPER_STEP, "F", 0.0, "more than 0"),
        (Positioning(distance=0.02), "tcp", 0.019, "0.02"),
    ],
)
def test_impossible_bounds_are_named_with_the_least_possible(
    move: VelocityStep | Positioning, name: str, value: float, least: str
) -> None:
    with pytest.raises(ComputationError, match=least) as caught:
        paper_optimum(bound(name, value), move)
    assert caught.value.outcome is Outcome.BOUND_CANNOT_HOLD


def test_least_travel_that_allows_a_velocity_step_is_named() -> None:
    """A user told to widen a bound must learn by how much; here the grid of the test judges.

    The axis backs off by X and speeds up over 2 X: rigid, X would be m v² / (4 F).
    """
    with pytest.raises(ComputationError, match="smallest possible is about") as caught:
        paper_optimum(bound("x_s", 9e-4))
    assert caught.value.outcome is Outcome.BOUND_CANNOT_HOLD
    named = re.search(r"about (\S+) m:", str(caught.value))
    assert named is not None
    least, rigid = float(named.group(1)), paper_plant().moving_mass * 0.1**2 / (4.0 * 2e3)
    assert 1.0 < least / rigid < 1.1
    for factor, reached in ((0.998, False), (1.001, True)):
        assert (reach(bound("x_s", factor * least), 0.11, n=600) >= 1.0) is reached


def paper_problem(name: str, value: float) -> BoundedProblem:
    return bounded_problem(
        paper_plant(), PAPER_STEP, force_limit=2e3, bounds=bound(name, value), horizon=0.05
    )


@pytest.mark.parametrize(
    "plant",
    [
        build_plant(random_modal_machine(3, n_modes=4)),
        build_plant(read_shipped("printer-belt").machine),  # the input is a jerk
        driven_at_once(build_plant(read_shipped("printer-belt").machine)),
    ],
    ids=["behind a lag", "jerk", "at once"],
)
def test_responses_agree_with_the_matrix_exponential(plant: Plant) -> None:
    """Every bound and every sign is read from these; the matrix exponential knows no modes."""
    size, joint = plant.order, np.zeros((plant.order + 1, plant.order + 1))
    joint[:size, :size], joint[:size, size] = plant.A, plant.B
    for tau in (1e-5, 3e-3, 0.2):
        flow, at = expm(joint * tau), np.array(tau)
        size_of = np.abs(flow).max(axis=1)[:size]
        assert np.all(np.abs(step_response(plant, at) - flow[:size, size]) < 1e-11 * size_of)
        assert_allclose(transition(plant, at), flow[:size, :size], atol=1e-11 * size_of.max())
        assert_allclose(impulse_response(plant, at), flow[:size, :size] @ plant.B, rtol=1e-9)


def dual_total(problem: BoundedProblem, measure: Measure) -> float:
    values = weigh(problem, measure).values
    return float(values.sum()) + sum(abs(atom.weight) for atom in measure.atoms)


def touching_extremal() -> tuple[BoundedProblem, Pieces]:
    pieces = tuple(
        Piece(limit=limit, side=side, duration=duration * 1e-6)
        for limit, side, duration in [
            (-1, 1, 9270.0), (-1, -1, 332.0), (-1, 1, 26694.0), (-1, -1, 911.0),
            (-1, 1, 2100.0), (0, -1, 564.0), (-1, 1, 2273.0), (-1, -1, 1496.0),
        ]
    )  # fmt: skip
    return paper_problem("v_phi", 0.02), pieces


@pytest.mark.parametrize("seed", range(6))
def test_any_multipliers_give_a_bound_below_the_optimum(seed: int) -> None:
    problem, guess = touching_extremal()
    found = solve_sequence(problem, guess)
    generator = np.random.default_rng(seed)
    size = 10.0 ** generator.uniform(-7.0, -4.0)
    noise = 1.0 + size * generator.standard_normal(found.measure.terminal.size)
    atoms = tuple(
        replace(atom, weight=atom.weight * (1.0 + size * float(generator.standard_normal())))
        for atom in found.measure.atoms
    )
    extra = Atom(remaining=float(generator.uniform(0.01, 0.04)), limit=0, weight=size)
    measure = replace(
        found.measure, terminal=found.measure.terminal * noise, atoms=(*atoms, extra), interiors=()
    )
    assert weigh(problem, measure).lower_bound < found.measure.t_f


def test_dual_value_is_the_integral_of_the_switching_function() -> None:
    problem, guess = touching_extremal()
    measure = replace(solve_sequence(problem, guess).measure, interiors=())
    t = np.linspace(0.0, measure.t_f, 40001)
    sigma = impulse_response(problem.plant, t) @ measure.terminal
    for atom in measure.atoms:
        since = np.maximum(t - atom.remaining, 0.0)
        response = impulse_response(problem.plant, since) @ problem.limits[0].row
        sigma -= atom.weight * np.where(t >= atom.remaining, response, 0.0)
    expected = 2e3 * float(np.trapezoid(np.abs(sigma), t))
    expected += sum(abs(atom.weight) for atom in measure.atoms)
    value = dual_total(problem, measure)
    assert value == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "value", "outcome"),
    [
        ("v_phi", 1e-6, Outcome.BEYOND_HORIZON),
        ("phi", 5e-7, Outcome.BEYOND_HORIZON),
    ],
)
def test_very_tight_bounds_end_with_a_named_outcome(
    name: str, value: float, outcome: Outcome
) -> None:
    # Otherwise the engineer reads "internal error", or what the simplex method says.
    with pytest.raises(ComputationError) as caught:
        paper_optimum(bound(name, value))
    assert caught.value.outcome is outcome
    assert "HiGHS" not in str(caught.value)


@pytest.mark.parametrize(
    ("seed", "what", "gap"),
    [
        (
            7,
            "force bound, three modes",
            1e-10,
        ),
        (8, "deflection and force: a short arc of the force", 1e-10),
        (16, "force and rate: the bound on F is left and swings to its other side", 1e-10),
        (14, "velocity, three modes: no sequence is recognised", 1e-6),
    ],
)
def test_random_axes_with_less_usual_sequences(seed: int, what: str, gap: float) -> None:
    (case,) = cases(1, first=seed)
    judged = judge(case)
    assert judged.outcome == "certified", what
    assert judged.gap < gap, what
    assert judged.excess < 1e-9, what


def test_a_signal_that_cannot_be_held_for_long_is_no_internal_error() -> None:
    """Opposite gains at the tool: zeros in the right half-plane, and the held motion explodes."""
    text = """schema = 1
machine = {name = "opposite gains", axis = "X", source = "made up"}
drive = {force_lag = "0.92 ms", max_force = "73 N"}
moves = [{velocity_step = "0.03 m/s"}]
requirements = {tcp_deviation = "5 um"}
[plant]
kind = "modal"
moving_mass = "94 kg"
modes = [
  {name = "m1", frequency = "27.6 Hz", damping_ratio = 0.0043, tcp_gain = -0.002215},
  {name = "m2", frequency = "271 Hz", damping_ratio = 0.0099, tcp_gain = 0.002242},
]
"""
    machine = parse_profile(text, where="a test")
    plant, limit = build_plant(machine), (Bound(name="tcp_vibration", value=1.5e-6),)
    problem = bounded_problem(plant, machine.moves[0], force_limit=73.0, bounds=limit, horizon=0.05)
    # q1 + q2 = (g1 / (s² + 2 z1 w1 s + w1²) + g2 / (s² + 2 z2 w2 s + w2²)) F: its numerator
    w1, w2 = 2.0 * np.pi * 27.6, 2.0 * np.pi * 271.0
    first = np.array([1.0, 2.0 * 0.0043 * w1, w1**2])
    second = np.array([1.0, 2.0 * 0.0099 * w2, w2**2])
    zeros = np.roots(-0.002215 * second + 0.002242 * first)
    assert problem.limits[0].growth == pytest.approx(zeros.real.max(), rel=1e-6)
    pieces = (Piece(limit=-1, side=1, duration=1e-3), Piece(limit=0, side=1, duration=0.05))
    held = (*pieces, Piece(limit=-1, side=-1, duration=1e-3))
    assert solve_exactly(problem, held) is None
