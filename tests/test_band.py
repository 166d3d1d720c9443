"""The optimum with the band: kept for all time, proved, and found again by another program."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import inf

import numpy as np
import pytest
from scipy.linalg import expm

from mtcommission.limits.optima import find_optima, find_time_optimum, find_within_band
from mtcommission.machine.machine import Corner, Machine, vary
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.optimal.band import BandForce, find_band_optimum
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


def test_papers_step_with_the_band_of_5_um():
    """42.018 ms, found by an LP in scipy before; a page would promise a wrong least time."""
    machine = paper_machine()
    rest, found = optimum_of(machine, VelocityStep(velocity_step=0.1), band=5e-6)
    assert found.t_f == pytest.approx(42.018e-3, rel=2e-5)
    assert rest == pytest.approx(43.5204e-3, rel=1e-5)
    assert 0.0 <= found.gap < 2e-5
    worst, _ = follow(machine, found, after=0.6)
    assert 0.99 * 5e-6 < worst <= 5e-6


@pytest.mark.parametrize("seed", [1, 7])
@pytest.mark.parametrize("move", ["step", "free", "limited"])
def test_band_force_and_velocity_are_kept_when_somebody_else_integrates(seed, move):
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


def test_a_wider_band_never_takes_longer_and_a_narrow_one_is_exact_rest():
    machine, move = paper_machine(), VelocityStep(velocity_step=0.1)
    found = [optimum_of(machine, move, band=band) for band in (1e-9, 5e-6, 1e-4)]
    assert found[0][1].t_f == pytest.approx(found[0][0], rel=1e-4)
    for (_, earlier), (_, later) in pairwise(found):
        assert later.lower_bound < earlier.t_f


def test_robust_force_keeps_the_band_on_machines_that_it_never_saw():
    """Frequencies and damping ratios drawn from the spread, integrated by matrix exponentials."""
    machine = read_shipped("honing-z").machine
    move = machine.moves[-1]
    optima = find_optima(machine, build_plant(machine), move)
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


@pytest.mark.parametrize(
    ("name", "move", "band", "said"),
    [
        # Standing still keeps it: the least time is none, and is not searched for.
        ("modal-two-modes", Positioning(distance=5e-6), 1e-5, "band-wider-than-move"),
        # Hundreds of periods would take minutes for less than a hundredth of the move.
        ("printer-belt", Positioning(distance=1.0, max_velocity=0.2), 2e-5, "band-saves-nothing"),
    ],
)
def test_where_a_band_has_no_optimum_that_is_said(name, move, band, said):
    machine = read_shipped(name).machine
    needs = replace(machine.requirements, tcp_deviation=band)
    machine = replace(machine, moves=(move,), requirements=needs)
    found = find_within_band(machine, find_optima(machine, build_plant(machine), move))
    assert found.optimum is None
    assert [remark.kind for remark in found.remarks] == [said]
