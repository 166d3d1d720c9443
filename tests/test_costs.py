"""What `check` accepts ends soon and in little memory: an answer, or a named outcome."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from mtcommission.errors import ComputationError, Outcome
from mtcommission.limits.optima import find_time_optimum
from mtcommission.loop.simulation_budget import (
    count_cycles,
    remark_on_cost,
    require_affordable,
)
from mtcommission.machine.machine import Machine, Positioning, VelocityStep
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.optimal.bounded.proof.motion import follow_control
from mtcommission.optimal.exponential import balanced_expm
from mtcommission.optimal.free import newton_refinement
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import joint_system
from mtcommission.plant.modal import Modal
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.profile.shipped import read_shipped, shipped_names

STEP = VelocityStep(velocity_step=0.1)


def undamped() -> Plant:
    mode = FlexibleMode(
        name="bell", natural_frequency=2 * pi * 50.0, damping_ratio=0.0, tcp_gain=1e-3
    )
    machine = read_shipped("milling-manipulator").machine
    return build_plant(replace(machine, mechanics=Modal(moving_mass=100.0, modes=(mode,))))


def gantry() -> Machine:
    return read_shipped("modal-two-modes").machine


def test_a_tiny_force_on_an_undamped_mode_is_refused() -> None:
    """It once asked for 481 GiB."""
    with pytest.raises(ComputationError) as end:
        solve_time_optimal(undamped(), STEP, force_limit=1e-4)
    assert end.value.outcome is Outcome.MOVE_TOO_LONG


def test_many_switches_are_the_same_by_a_sparse_jacobian(monkeypatch: pytest.MonkeyPatch) -> None:
    dense = solve_time_optimal(undamped(), STEP, force_limit=20.0)
    assert len(dense.arcs) > 2
    monkeypatch.setattr(newton_refinement, "MOST_DENSE", 2)
    sparse = solve_time_optimal(undamped(), STEP, force_limit=20.0)
    assert sparse.switching_times == pytest.approx(dense.switching_times, rel=1e-12)


def test_a_stroke_of_thirty_metres_is_composed() -> None:
    """A mesh over all of it took 80 s and 2.8 GB."""
    machine = gantry()
    move = Positioning(distance=30.0, max_velocity=0.5)
    found = find_time_optimum(build_plant(machine), move, force_limit=3200.0, bounds=())
    assert found.method == "composed"
    assert found.certificate.relative_gap < 1e-2
    far = replace(move, distance=3e4)
    with pytest.raises(ComputationError) as end:
        find_time_optimum(build_plant(machine), far, force_limit=3200.0, bounds=())
    assert end.value.outcome is Outcome.MOVE_TOO_LONG


def test_a_motion_followed_in_blocks_is_the_one_followed_at_once() -> None:
    """The other way: each arc's end by one exponential."""
    plant = build_plant(gantry())
    found = solve_time_optimal(plant, STEP, force_limit=200.0)
    motion = follow_control(plant, found.arcs, rate=20.0 * plant.fastest_rate)
    state = np.zeros(plant.order)
    for arc in found.arcs:
        joint = np.concatenate([state, arc.initial])
        length = arc.t_end - arc.t_start
        state = (balanced_expm(joint_system(plant, arc) * length) @ joint)[: plant.order]
    assert np.all(np.abs(motion.final - state) <= 1e-10 * motion.peaks[: plant.order])
    assert motion.peaks == pytest.approx(found.peaks, rel=1e-7)


def test_a_dear_machine_says_so_beforehand_and_no_other_does() -> None:
    """Minutes of silence look like a hang; a line for every machine would not be read."""
    shipped = [read_shipped(name).machine for name in shipped_names()]
    assert [remark_on_cost(machine) for machine in shipped] == [()] * len(shipped)
    many = replace(gantry(), moves=gantry().moves * 12)
    (remark,) = remark_on_cost(many)
    assert remark.values["moves"] == len(many.moves)
    assert remark.values["cycles"] == pytest.approx(12 * count_cycles(gantry()))
    require_affordable(many)
    beyond = replace(gantry(), moves=gantry().moves * 1000)
    assert remark_on_cost(beyond) == ()  # it ends at once
    with pytest.raises(ComputationError, match="velocity cycles"):
        require_affordable(beyond)
