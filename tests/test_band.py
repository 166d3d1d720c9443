"""The optimum with the band: kept for all time, proved, and found again by another program."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import inf

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linprog

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.limits.optima import find_optima, find_time_optimum, find_within_band
from mtcommission.machine.machine import Corner, Machine, vary
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.optimal.band import BandForce, find_band_optimum
from mtcommission.optimal.modes import free_peaks
from tests.machines import paper_machine, random_modal_machine


def optimum_of(machine: Machine, move: Move, *, band: float) -> tuple[float, BandForce]:
    """The optimum with exact rest, and that with the band."""
    plant, force = build_plant(machine), machine.drive.motion_force
    rest = find_time_optimum(plant, move, force_limit=force, bounds=()).t_f
    return rest, find_band_optimum(plant, move, force_limit=force, band=band, at_rest=rest)


def follow(machine: Machine, force: BandForce, *, after: float) -> tuple[float, float]:
    """Largest deviation after the end and largest velocity, by matrix exponentials alone."""
    plant = build_plant(machine)
    x, fastest = np.zeros(plant.order), 0.0
    for arc in force.arcs:
        u = float(arc.output @ arc.initial)
        assert abs(u) <= force.force_limit * (1.0 + 1e-12)
        count = 40
        step = np.zeros((plant.order + 1, plant.order + 1))
        step[:-1, :-1], step[:-1, -1] = plant.A, plant.B * u
        step = expm(step * (arc.t_end - arc.t_start) / count)
        for _ in range(count):
            x = (step @ np.append(x, 1.0))[:-1]
            fastest = max(fastest, abs(x[plant.velocity]))
    m, T = plant.moving_mass, plant.force_lag
    # What the momentum of the dying motor force adds: T F / m, and T times it in position.
    speed = x[plant.velocity] + T * x[plant.force] / m
    place = x[plant.position] + T * x[plant.velocity]
    if isinstance(force.move, VelocityStep):
        assert speed == pytest.approx(force.move.velocity_step, rel=1e-9)
        place -= T * speed
    else:
        assert abs(speed) < 1e-9 * force.t_f * force.force_limit / m
        assert place + force.offset == pytest.approx(force.move.distance, rel=1e-9)
        speed = 0.0
    dt = after / 40_000
    step = expm(plant.A * dt)
    worst = 0.0
    for i in range(40_001):
        reference = place + force.offset + speed * i * dt
        worst = max(worst, abs(float(plant.row("tcp") @ x) - reference))
        x = step @ x
    return worst, fastest


def test_papers_step_with_the_band_of_5_um() -> None:
    """42.018 ms, found by an LP in scipy before; a page would promise a wrong least time."""
    machine = paper_machine()
    rest, found = optimum_of(machine, VelocityStep(velocity_step=0.1), band=5e-6)
    assert found.t_f == pytest.approx(42.018e-3, rel=2e-5)
    assert rest == pytest.approx(43.5204e-3, rel=1e-5)
    assert 0.0 <= found.gap < 2e-5
    worst, _ = follow(machine, found, after=0.6)
    assert 0.99 * 5e-6 < worst <= 5e-6


@pytest.mark.parametrize("seed", [1, 4, 7, 12])
@pytest.mark.parametrize("move", ["step", "free", "limited"])
def test_band_force_and_velocity_are_kept_when_somebody_else_integrates(
    seed: int, move: str
) -> None:
    machine = random_modal_machine(seed, n_modes=1 + seed % 3)
    a = machine.drive.motion_force / build_plant(machine).moving_mass
    moves: dict[str, Move] = {
        "step": VelocityStep(velocity_step=0.05 * a),
        "free": Positioning(distance=1e-3 * a),
        "limited": Positioning(distance=1e-3 * a, max_velocity=0.02 * a),
    }
    band = 1e-5
    rest, found = optimum_of(machine, moves[move], band=band)
    slowest = min(-mode.pole.real for mode in build_plant(machine).modes)
    worst, fastest = follow(machine, found, after=min(3.0 / slowest, 2.0))
    assert worst <= band * (1.0 + 1e-9)
    assert found.lower_bound <= found.t_f <= rest * (1.0 + 1e-6)
    assert found.gap < (1e-3 if move == "limited" else 3e-5)
    limit = moves[move].max_velocity if isinstance(moves[move], Positioning) else inf
    assert fastest <= limit


def reach_of(machine: Machine, move: Move, t_f: float, *, band: float, cells: int = 300) -> float:
    """Share of the target that forces on cells reach with the band, in states and with scipy."""
    plant, F = build_plant(machine), machine.drive.motion_force
    n, h = plant.order, t_f / cells
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = plant.A, plant.B
    one = expm(joint * h)
    columns = [one[:n, n]]
    for _ in range(cells - 1):
        columns.append(one[:n, :n] @ columns[-1])
    X = np.array(columns[::-1]).T * F
    longest = 2.0 / min(-mode.pole.real for mode in plant.modes)
    s = np.linspace(0.0, longest, 1200)
    flow, rows = expm(plant.A * s[1]), [plant.row("tcp")]
    for _ in s[1:]:
        rows.append(rows[-1] @ flow)
    T, m = plant.force_lag, plant.moving_mass
    momentum = np.zeros(n)
    momentum[plant.velocity], momentum[plant.force] = 1.0, T / m
    # e(s) = row x(s) - place, where the steady motion of momentum is taken out.
    E = np.array(rows) @ X - np.outer(s, momentum @ X)
    target = move.velocity_step if isinstance(move, VelocityStep) else move.distance
    A = np.hstack([E, -np.ones((s.size, 1))]) / band
    is_step = isinstance(move, VelocityStep)
    cost = -np.append(momentum @ X, 0.0) if is_step else np.append(np.zeros(cells), -1.0)
    found = linprog(
        cost / target,
        A_ub=np.vstack([A, -A]),
        b_ub=np.ones(2 * s.size),
        A_eq=None if is_step else np.append(momentum @ X, 0.0)[np.newaxis] / 1e-3,
        b_eq=None if is_step else [0.0],
        bounds=[(-1.0, 1.0)] * cells + [(None, None)],
    )
    return float(-found.fun)


@pytest.mark.parametrize(
    "move",
    [VelocityStep(velocity_step=0.1), Positioning(distance=0.02)],
    ids=["step", "positioning"],
)
def test_another_program_needs_just_the_time_that_is_proved(move: Move) -> None:
    machine = paper_machine()
    _, found = optimum_of(machine, move, band=5e-6)
    assert reach_of(machine, move, 1.002 * found.t_f, band=5e-6) > 1.0
    assert reach_of(machine, move, 0.998 * found.lower_bound, band=5e-6) < 1.0


def test_a_wider_band_never_takes_longer_and_a_narrow_one_is_exact_rest() -> None:
    machine, move = paper_machine(), VelocityStep(velocity_step=0.1)
    times = [optimum_of(machine, move, band=band)[1] for band in (1e-9, 1e-6, 5e-6, 2e-5, 1e-4)]
    rest, _ = optimum_of(machine, move, band=5e-6)
    assert times[0].t_f == pytest.approx(rest, rel=1e-4)
    assert all(later.lower_bound < earlier.t_f for earlier, later in pairwise(times))


def test_a_motion_that_rings_for_ever_is_a_named_outcome() -> None:
    rates = np.array([[200j, 300j, -400.0]])
    with pytest.raises(ComputationError) as caught:
        free_peaks(rates, np.ones((1, 3), dtype=complex), offset=0.0)
    assert caught.value.outcome is Outcome.NO_CONVERGENCE


@pytest.mark.parametrize("name", ["milling-manipulator", "honing-z"])
def test_robust_force_keeps_the_band_on_machines_that_it_never_saw(name: str) -> None:
    """Frequencies and damping ratios drawn from the spread, integrated by matrix exponentials."""
    machine = read_shipped(name).machine
    plant = build_plant(machine)
    move = machine.moves[-1]
    optima = find_optima(machine, plant, move)
    found = find_within_band(replace(machine, moves=(move,)), optima)
    assert found.robust is not None
    assert found.optimum is not None
    assert found.remarks == ()
    needs, force = machine.requirements, found.robust
    assert found.robust.peak <= needs.tcp_deviation
    assert force.t_f > found.optimum.t_f
    generator = np.random.default_rng(11)
    for _ in range(6):
        corner = Corner(
            frequency_factor=1.0 + needs.frequency_spread * generator.uniform(-1.0, 1.0),
            damping_factor=1.0 + needs.damping_spread * generator.uniform(-1.0, 1.0),
        )
        worst, _ = follow(vary(machine, corner), force, after=0.6)
        assert worst <= needs.tcp_deviation
    # The nominal optimum does not: else the robust one would be slower for nothing.
    off = vary(machine, Corner(frequency_factor=1.0 - needs.frequency_spread))
    assert follow(off, found.optimum, after=0.6)[0] > needs.tcp_deviation


def test_damping_known_to_a_spread_alone_asks_for_a_robust_force() -> None:
    """Three machines are fewer than are looked at first otherwise."""
    machine = paper_machine()
    needs = replace(machine.requirements, frequency_spread=0.0, damping_spread=0.3)
    machine = replace(machine, requirements=needs)
    optima = find_optima(machine, build_plant(machine), machine.moves[0])
    found = find_within_band(machine, optima)
    assert found.robust is not None
    for factor in (0.7, 1.0, 1.3):
        moved = vary(machine, Corner(damping_factor=factor))
        assert follow(moved, found.robust, after=0.6)[0] <= needs.tcp_deviation


def test_a_band_wider_than_the_move_has_no_optimum() -> None:
    """Standing still keeps it: the least time is none, and is not searched for."""
    machine = read_shipped("modal-two-modes").machine
    move = replace(machine.moves[0], distance=5e-6)
    needs = replace(machine.requirements, tcp_deviation=1e-5)
    machine = replace(machine, moves=(move,), requirements=needs)
    plant = build_plant(machine)
    optima = find_optima(machine, plant, move)
    found = find_within_band(machine, optima)
    assert found.optimum is None
    assert found.robust is None
    assert [remark.kind for remark in found.remarks] == ["band-wider-than-move"]


def test_what_a_band_saves_is_not_asked_of_a_move_of_hundreds_of_periods() -> None:
    """It would take minutes for less than a hundredth of the move."""
    machine = read_shipped("printer-belt").machine
    long = Positioning(distance=1.0, max_velocity=0.2)
    machine = replace(machine, moves=(long,))
    plant = build_plant(machine)
    optima = find_optima(machine, plant, long)
    found = find_within_band(machine, optima)
    assert [remark.kind for remark in found.remarks] == ["band-saves-nothing"]
    assert found.optimum is None
    assert optima.time.t_f < 1.01 * (1.0 / 0.2 + 0.2 / machine.drive.motion_force)
