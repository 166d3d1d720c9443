""""""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from benchmarks.constrained_survey import cases, judge, largest_excess
from benchmarks.population import random_machine
from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.limits.optima import find_optima
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant, driven_at_once
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.control import (
    Boundary,
    TimeOptimum,
    balanced_expm,
    propagate,
    sample_trajectory,
)
from mtcommission.optimal.edits import solve_exactly
from mtcommission.optimal.modes import impulse_response, rows_after, step_response, transition
from mtcommission.optimal.newton import solve_sequence
from mtcommission.optimal.problem import Atom, BoundedProblem, bounded_problem
from mtcommission.optimal.proof import weigh
from mtcommission.optimal.sequence import Piece, Pieces
from tests.machines import paper_machine, random_modal_machine

PAPER_STEP = VelocityStep(velocity_step=0.1)


def bound(name: str, value: float) -> tuple[SignalValue, ...]:
    return (SignalValue(name=name, value=value),)


@cache
def paper_plant() -> Plant:
    return build_plant(paper_machine())


@cache
def paper_optimum(
    bounds: tuple[SignalValue, ...], move: VelocityStep | Positioning = PAPER_STEP
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


def test_christiansen_maurer_zirn_sec_5_2_bound_on_v_phi():
    optimum = paper_optimum(bound("v_phi", 0.005))
    assert round(optimum.t_f, 4) == 0.0523  # the paper prints 0.0522, found on a grid
    assert 1.20 < optimum.t_f / 0.043520364 < 1.21
    held = [arc.control for arc in optimum.arcs if isinstance(arc.control, Boundary)]
    assert held == [Boundary("v_phi", 1), Boundary("v_phi", -1)]
    assert [(at.signal, at.side) for at in optimum.touch_points] == [("v_phi", 1)]
    assert optimum.certificate.relative_gap < 1e-10
    assert optimum.certificate.switching_law_holds
    check_motion(paper_plant(), optimum)


@pytest.mark.parametrize(
    ("name", "value"),
    [("v_phi", 7e-4), ("F", 1500.0), ("v_b", 0.002)],
)
def test_bounds_of_order_one_and_two_are_solved_exactly(name, value):
    optimum = paper_optimum(bound(name, value))
    assert optimum.certificate.relative_gap < 1e-10
    assert optimum.certificate.switching_law_holds
    check_motion(paper_plant(), optimum)


@pytest.mark.parametrize(("name", "value", "gap"), [("phi", 5e-5, 1e-6), ("phi", 1e-5, 5e-4)])
def test_bound_of_order_three_is_enclosed(name, value, gap):
    """No finite sequence of arcs is optimal here; the gap says how much the mesh leaves."""
    optimum = paper_optimum(bound(name, value))
    assert optimum.certificate.relative_gap <= gap
    check_motion(paper_plant(), optimum)
    assert largest_excess(paper_plant(), optimum) < 1e-9


@pytest.mark.parametrize(
    ("move", "value"),
    [
        (PAPER_STEP, 100.0),
        (Positioning(distance=0.05, max_velocity=0.1), 100.0),
    ],
)
def test_tight_bound_on_the_force_is_solved_and_beats_a_lower_force_limit(move, value):
    """The force may be asked for beyond what it may become: a lower limit is slower."""
    plant, bounds = paper_plant(), bound("F", value)
    optimum = paper_optimum(bounds, move)
    assert optimum.certificate.relative_gap < 1e-9
    assert optimum.certificate.switching_law_holds
    check_motion(plant, optimum)
    slow = solve_bounded_time_optimal(plant, move, force_limit=value, bounds=())
    assert optimum.t_f < slow.t_f


def test_tighter_bound_never_means_less_time():
    times = [paper_optimum(bound("v_phi", value)).t_f for value in (0.03, 0.02, 0.01, 0.005)]
    assert times == sorted(times)


def test_scaling_force_step_and_bound_together_leaves_the_times():
    once = paper_optimum(bound("v_phi", 0.02))
    twice = solve_bounded_time_optimal(
        paper_plant(),
        VelocityStep(velocity_step=0.2),
        force_limit=4e3,
        bounds=bound("v_phi", 0.04),
    )
    assert_allclose(twice.switching_times, once.switching_times, rtol=1e-8)


@pytest.mark.parametrize(
    ("move", "name", "value", "least"),
    [
        (PAPER_STEP, "v_s", 0.099, "0.1"),
        (PAPER_STEP, "F", 0.0, "more than 0"),
        (Positioning(distance=0.02), "tcp", 0.019, "0.02"),
    ],
)
def test_impossible_bounds_are_named_with_the_least_possible(move, name, value, least):
    with pytest.raises(ComputationError, match=least) as caught:
        paper_optimum(bound(name, value), move)
    assert caught.value.outcome is Outcome.BOUND_CANNOT_HOLD


def test_least_travel_that_allows_a_velocity_step_is_named():
    """A user told to widen a bound must learn by how much: at 0.1 % more there is a control.

    The axis backs off by X and speeds up over 2 X: rigid, X would be m v² / (4 F).
    """
    with pytest.raises(ComputationError, match="smallest possible is about") as caught:
        paper_optimum(bound("x_s", 9e-4))
    assert caught.value.outcome is Outcome.BOUND_CANNOT_HOLD
    named = re.search(r"about (\S+) m:", str(caught.value))
    assert named is not None
    least, rigid = float(named.group(1)), paper_plant().moving_mass * 0.1**2 / (4.0 * 2e3)
    assert 1.0 < least / rigid < 1.1
    check_motion(paper_plant(), paper_optimum(bound("x_s", 1.001 * least)))


@pytest.mark.parametrize(
    ("value", "longer", "gap"),
    [(9.866e-4, 1.005, 1e-6), (9.864e-4, 1.005, 1e-6), (9.858e-4, 1.02, 1e-4)],
)
def test_bound_just_above_the_least_possible_is_met(value, longer, gap):
    """First cells are too long there: they called the bound impossible, or took thrice the time."""
    optimum = paper_optimum(bound("x_s", value))
    assert optimum.t_f < longer * paper_optimum(bound("x_s", 1e-3)).t_f
    assert optimum.certificate.relative_gap < gap
    check_motion(paper_plant(), optimum)


@pytest.mark.parametrize(
    "name", ["ball-screw", "mill-x", "mill-y", "rack-gantry", "rotary-table", "honing-z"]
)
def test_optimum_under_max_velocity_is_exact_on_shipped_machines(name):
    """Otherwise the screen lists some hundred arcs that stand for a dozen."""
    machine = read_shipped(name).machine
    found = solve_bounded_time_optimal(
        build_plant(machine), machine.moves[0], force_limit=machine.drive.motion_force, bounds=()
    )
    assert found.certificate.relative_gap < 1e-10
    assert found.certificate.switching_law_holds


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
def test_responses_agree_with_the_matrix_exponential(plant):
    """Every bound and every sign is read from these; the matrix exponential knows no modes."""
    size, joint = plant.order, np.zeros((plant.order + 1, plant.order + 1))
    joint[:size, :size], joint[:size, size] = plant.A, plant.B
    for tau in (1e-5, 3e-3, 0.2):
        flow, at = expm(joint * tau), np.array(tau)
        size_of = np.abs(flow).max(axis=1)[:size]
        assert np.all(np.abs(step_response(plant, at) - flow[:size, size]) < 1e-11 * size_of)
        assert_allclose(transition(plant, at), flow[:size, :size], atol=1e-11 * size_of.max())
        seen = rows_after(plant, np.eye(size), np.full(size, tau))
        assert_allclose(seen, flow[:size, :size], atol=1e-11 * size_of.max())
        assert_allclose(impulse_response(plant, at), flow[:size, :size] @ plant.B, rtol=1e-9)


def test_a_long_boundary_arc_keeps_its_digits():
    """Tight bounds were lost to this. Taylor steps with 64 bits of mantissa, one by one."""
    problem = paper_problem("v_phi", 7e-4)
    flow, scale = problem.limits[0].boundary_flow, problem.state_scale
    step = flow.matrix.astype(np.longdouble) * 0.05 / 4000
    term = short = np.eye(len(step), dtype=np.longdouble)
    for k in range(1, 14):
        term = term @ step / k
        short = short + term
    exact = short
    for _ in range(3999):
        exact = short @ exact
    for found, least in ((flow.over(0.05), 1e-11), (balanced_expm(flow.matrix * 0.05), 1e-10)):
        assert np.abs((found - exact) * scale / scale[:, np.newaxis]).max() < least


def touching_extremal() -> tuple[BoundedProblem, Pieces]:
    pieces = tuple(
        Piece(limit=limit, side=side, duration=duration * 1e-6)
        for limit, side, duration in [
            (-1, 1, 9270.0), (-1, -1, 332.0), (-1, 1, 26694.0), (-1, -1, 911.0),
            (-1, 1, 2100.0), (0, -1, 564.0), (-1, 1, 2273.0), (-1, -1, 1496.0),
        ]
    )  # fmt: skip
    return paper_problem("v_phi", 0.02), pieces


def test_a_bound_far_below_the_peak_without_it_is_solved_exactly():
    """In 0.1 ms the force moves the signal across it: cells of milliseconds part its arcs."""
    found = paper_optimum(bound("v_phi", 1e-4))
    assert found.certificate.relative_gap < 1e-10
    assert len(found.arcs) == 14


def test_an_arc_too_short_for_cells_is_found():
    """0.1 ms of it, born of a touch point: some hundred arcs and a gap of 9e-8 stood for it."""
    machine = read_shipped("ball-screw").machine
    found = solve_bounded_time_optimal(
        build_plant(machine), machine.moves[0], force_limit=25e3, bounds=()
    )
    assert found.certificate.relative_gap < 1e-10
    assert len(found.arcs) == 21
    check_motion(build_plant(machine), found)


def test_a_bound_is_left_where_holding_it_costs_time():
    """The sequence at 52.6 urad/s does not do at 52.3, where one arc turns back for a while."""
    pieces = tuple(
        Piece(limit=limit, side=side, duration=duration * 1e-7)
        for limit, side, duration in [
            (-1, 1, 1047.0), (-1, -1, 998.0), (0, 1, 1997669.0), (-1, -1, 1258.0),
            (-1, 1, 1666.0), (0, -1, 101148.0), (-1, 1, 1756.0), (-1, -1, 1185.0),
            (0, 1, 71555.0), (-1, -1, 1261.0), (-1, 1, 1661.0), (0, -1, 150448.0),
            (-1, 1, 1744.0), (-1, -1, 1193.0), (0, 1, 20064.0), (-1, -1, 1275.0),
            (-1, 1, 1642.0), (0, -1, 1836904.0), (-1, 1, 1045.0), (-1, -1, 1000.0),
        ]
    )  # fmt: skip
    found = solve_exactly(paper_problem("v_phi", 5.2311e-5), pieces)
    assert found is not None
    assert found.gap < 1e-9
    assert len(found.motion.arcs) > len(pieces)


@pytest.mark.parametrize("seed", range(3))
def test_any_multipliers_give_a_bound_below_the_optimum(seed):
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


def test_a_very_tight_bound_ends_with_a_named_outcome():
    # Otherwise the engineer reads "internal error", or what the simplex method says.
    with pytest.raises(ComputationError) as caught:
        paper_optimum(bound("phi", 5e-7))
    assert caught.value.outcome is Outcome.BEYOND_HORIZON
    assert "HiGHS" not in str(caught.value)


@pytest.mark.parametrize(
    ("seed", "gap"),
    [
        (8, 1e-10),  # deflection and force: a short arc of the force
        (16, 1e-10),  # force and rate: the bound on F is left and swings to its other side
        (14, 1e-6),  # velocity, three modes: no sequence is recognised
    ],
)
def test_random_axes_with_less_usual_sequences(seed, gap):
    judged = judge(*cases(1, first=seed))
    assert judged.outcome == "certified"
    assert judged.gap < gap
    assert judged.excess < 1e-9


# The reference of a move, where no sequence of arcs is recognised: kept, proved, and said.


def test_reference_on_cells_says_how_far_from_the_optimum_it_can_be():
    """A reader must see that the reference is not the optimum itself; somebody else integrates."""
    machine = random_machine(125)
    plant, move = build_plant(machine), machine.moves[0]
    assert isinstance(move, Positioning)
    found = find_optima(replace(machine, moves=(move,)), plant, move)
    optimum, gap = found.time, found.time.certificate.relative_gap
    assert 1e-6 < gap < 1e-2
    assert "Nothing is faster than" in Catalogue().say(found.remarks[0])
    assert largest_excess(plant, optimum) < 1e-9
    error = np.abs(propagate(plant, optimum.arcs))
    error[plant.position] = abs(error[plant.position] - move.distance)
    assert np.all(error < 1e-6 * optimum.peaks[: plant.order])
