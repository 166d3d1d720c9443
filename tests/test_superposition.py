"""The fast judgement of the search must be the slow one of the sheet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import TWO_AVERAGES, PositionLoop
from mtcommission.loop.batch.extremes import REMEMBERED, find_extremes
from mtcommission.loop.batch.settling import settle
from mtcommission.loop.batch.tables import build_tables, sketch_tables
from mtcommission.loop.simulate.response import LoopResponse, simulate
from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.control import TcpSensor
from mtcommission.machine.machine import Machine, Move, Positioning, VelocityStep, moving_mass
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import (
    JerkSteps,
    filter_steps,
    jerk_steps,
    plan_within,
)
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine, random_modal_machine

Array = NDArray[np.float64]

MOVES: list[Move] = [
    VelocityStep(velocity_step=0.1, dwell=0.02),
    VelocityStep(velocity_step=5e-4),  # a is never reached
    Positioning(distance=0.01, max_velocity=0.2, dwell=0.1),
    Positioning(distance=2e-4),
]
MACHINES = {
    "paper": paper_machine(),
    "filtered": quiet_copy(paper_machine(), setpoint_filter=moving_average(17e-3)),
    "two averages": quiet_copy(
        paper_machine(),
        setpoint_filter=SetpointFilter(kind=TWO_AVERAGES, time=17e-3, second_time=6e-3),
    ),
    "shaped": quiet_copy(
        paper_machine(),
        setpoint_filter=SetpointFilter(kind="2hump_ei", frequency_hz=31.0, damping_ratio=0.02),
    ),
    "two encoders": quiet_copy(paper_machine(), tcp_sensor=TcpSensor.POSITION),
    "interpolated": quiet_copy(paper_machine(), position_loop=PositionLoop.INTERPOLATED),
    "drive": quiet_copy(
        paper_machine(), position_loop=PositionLoop.DRIVE, setpoint_filter=moving_average(7e-3)
    ),
    "short delay": quiet_copy(paper_machine(), reference_delay=0.6e-3),
    "four modes": random_modal_machine(7, n_modes=4),
}


def limits(machine: Machine, count: int) -> tuple[Array, Array]:
    generator = np.random.default_rng(count)
    a_max = machine.drive.motion_force / moving_mass(machine)
    a = a_max * generator.uniform(0.1, 1.0, count)
    return a, a / np.exp(generator.uniform(np.log(5e-4), np.log(0.04), count))


def steps_of(machine: Machine, move: Move, a: Array, j: Array) -> JerkSteps:
    steps = jerk_steps(move, acceleration=a, jerk=j)
    return filter_steps(steps, machine.control.setpoint_filter)


def linear_response(
    machine: Machine, tuned: TunedLoop, move: Move, a: float, j: float
) -> LoopResponse:
    strong = replace(machine.drive, max_force=1e12)
    return simulate(
        tuned.loops[0],
        plan_within(machine, MotionLimits(acceleration=a, jerk=j))(move),
        drive=strong,
        band=machine.requirements.tcp_deviation,
    )


@pytest.mark.parametrize("name", MACHINES)
def test_settling_and_residual_agree_with_the_full_simulation(name: str) -> None:
    """The search would recommend limits that the sheet then judges otherwise."""
    machine = MACHINES[name]
    tuned = tune_loop(machine)
    checked = 0
    for move in MOVES:
        a, j = limits(machine, 4)
        steps = steps_of(machine, move, a, j)
        tables = build_tables(
            tuned.loops[0],
            longest=float(np.max(steps.duration)),
            order=steps.order,
        )
        band = machine.requirements.tcp_deviation
        found = settle(tables, steps, band=band)
        rough = settle(sketch_tables(tables, tuned.loops[0].plant), steps, band=band)
        for i in range(len(a)):
            full = linear_response(machine, tuned, move, a[i], j[i])
            assert found.residual_deviation[i] == pytest.approx(full.residual_deviation, rel=1e-6)
            # A first look may miss part of a peak; it adds at most what a chord at t_e + τ does.
            assert 0.8 < rough.residual_deviation[i] / full.residual_deviation < 1.0 + 1e-3
            if np.isfinite(found.settling_time[i]):
                assert found.settling_time[i] == pytest.approx(full.settling_time, rel=1e-6)
                checked += 1
    assert checked >= 12


@pytest.mark.parametrize(
    "name", ["paper", "filtered", "two averages", "shaped", "drive", "four modes"]
)
def test_peaks_and_forces_agree_with_the_full_simulation(name: str) -> None:
    """Limits beyond the force or a bounded peak would be recommended."""
    machine = MACHINES[name]
    tuned = tune_loop(machine)
    plant = tuned.loops[0].plant
    n = plant.order
    watched = [mode.rate for mode in plant.modes]
    signals = np.eye(n + 3)[[2, *(3 + i for i in watched)]]
    for move in MOVES:
        a, j = limits(machine, 3)
        found = find_extremes(
            tuned.loops[0],
            steps_of(machine, move, a, j),
            signals=signals,
            dwell=move.dwell,
            tail=0.3,
            static_load=machine.drive.static_load,
            with_deviation=True,
        )
        for i in range(len(a)):
            full = linear_response(machine, tuned, move, a[i], j[i])
            assert found.peaks[i, 0] == pytest.approx(full.max_force, rel=1e-6)
            assert found.peaks[i, 1:] == pytest.approx(full.peaks[watched], rel=1e-6)
            assert found.rms_force[i] == pytest.approx(full.rms_force, rel=1e-6)
            assert found.deviation[i] == pytest.approx(full.peak_deviation, rel=1e-6)


def test_doubling_every_limit_and_the_move_doubles_the_deviation() -> None:
    """A linear loop: anything else means that a table belongs to other units."""
    machine = paper_machine()
    tuned = tune_loop(machine)
    tables = build_tables(tuned.loops[0], longest=0.3)
    a, j = limits(machine, 20)
    single = jerk_steps(VelocityStep(velocity_step=0.05), acceleration=a, jerk=j)
    double = jerk_steps(VelocityStep(velocity_step=0.1), acceleration=2 * a, jerk=2 * j)
    one = settle(tables, single, band=5e-6)
    two = settle(tables, double, band=10e-6)
    assert np.allclose(two.residual_deviation, 2 * one.residual_deviation, rtol=1e-9)
    assert np.allclose(two.settling_time, one.settling_time, rtol=1e-9)


def test_a_slow_tail_is_not_taken_for_settled() -> None:
    """A deviation inside the band at the end of a short look may leave it again later."""
    soft = quiet_copy(paper_machine(), position_gain=4.0, integral_time=0.4, feedforward_mass=600.0)
    tuned = tune_loop(soft)
    move = VelocityStep(velocity_step=0.1)
    steps = jerk_steps(move, acceleration=np.array([1.0]), jerk=np.array([50.0]))
    tables = build_tables(tuned.loops[0], longest=0.3)
    found = settle(tables, steps, band=soft.requirements.tcp_deviation).settling_time[0]
    full = linear_response(soft, tuned, move, 1.0, 50.0).settling_time
    assert full > 0.7
    assert found == pytest.approx(full, rel=1e-6)


@pytest.mark.parametrize("move", [VelocityStep(velocity_step=0.1), Positioning(distance=0.1)])
def test_tables_of_a_slow_move_end_where_the_loop_has_forgotten(move: Move) -> None:
    """A very small force would fill the memory with zeros, or a cut would change the verdict."""
    machine = paper_machine()
    tuned = tune_loop(machine)
    a, j = np.array([0.02]), np.array([1.0])
    steps = jerk_steps(move, acceleration=a, jerk=j)
    longest = float(np.max(steps.duration))
    assert longest > 4.0
    tables = build_tables(tuned.loops[0], longest=longest)
    assert len(tables.transients) * tables.dt < 3.0
    assert not tables.transients[-1].any()
    found = settle(tables, steps, band=1e-10)
    full = linear_response(machine, tuned, move, 0.02, 1.0)
    assert found.residual_deviation[0] == pytest.approx(full.residual_deviation, rel=1e-6)


def test_setpoint_longer_than_the_tables_is_an_error() -> None:
    """Its early steps would count as if they had just been forgotten."""
    tuned = tune_loop(paper_machine())
    tables = build_tables(tuned.loops[0], longest=0.1)
    steps = jerk_steps(
        VelocityStep(velocity_step=0.1), acceleration=np.array([0.2]), jerk=np.array([5.0])
    )
    with pytest.raises(IndexError):
        settle(tables, steps, band=5e-6)


@pytest.mark.parametrize("name", ["paper", "two averages", "shaped"])
@pytest.mark.parametrize("move", [VelocityStep(velocity_step=2.0), Positioning(distance=12.0)])
def test_a_long_move_leaps_to_where_simulating_every_cycle_ends(name: str, move: Move) -> None:
    """Its force and its path would otherwise be those of another move."""
    machine = MACHINES[name]
    tuned = tune_loop(machine)
    loop = tuned.loops[0]
    steps = steps_of(machine, move, np.array([0.5, 2.0]), np.array([20.0, 200.0]))
    found = find_extremes(
        loop,
        steps,
        signals=np.eye(loop.plant.order + 3)[[2]],
        dwell=0.2,
        tail=0.3,
        static_load=machine.drive.static_load,
        with_deviation=True,
    )
    slowest = np.log(np.abs(np.linalg.eigvals(loop.lifted.A)).max()) / loop.lifted.dt
    assert np.diff(steps.times, axis=1).max() > 1.2 * np.log(REMEMBERED) / slowest
    for i, (a, j) in enumerate([(0.5, 20.0), (2.0, 200.0)]):
        full = linear_response(machine, tuned, replace(move, dwell=0.2), a, j)
        assert found.peaks[i, 0] == pytest.approx(full.max_force, rel=1e-6)
        assert found.rms_force[i] == pytest.approx(full.rms_force, rel=1e-5)
        assert found.deviation[i] == pytest.approx(full.peak_deviation, rel=1e-6)
