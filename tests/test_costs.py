"""What `check` accepts ends soon and in little memory: an answer, or a named outcome."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from mtcommission.base.errors import ComputationError, InputError, Outcome
from mtcommission.commission.recommend import recommend
from mtcommission.limits.optima import find_time_optimum
from mtcommission.loop.simulate import simulate_corners
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.moves import Positioning, VelocityStep, least_motion_time
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from tests.machines import paper_machine

STEP = VelocityStep(velocity_step=0.1)


def undamped() -> Plant:
    mode = FlexibleMode(
        name="bell", natural_frequency=2 * pi * 50.0, damping_ratio=0.0, tcp_gain=1e-3
    )
    machine = read_shipped("milling-manipulator").machine
    return build_plant(replace(machine, mechanics=Modal(moving_mass=100.0, modes=(mode,))))


def gantry() -> Machine:
    return read_shipped("modal-two-modes").machine


def test_a_tiny_force_on_an_undamped_mode_is_refused():
    """It once asked for 481 GiB."""
    with pytest.raises(ComputationError) as end:
        solve_time_optimal(undamped(), STEP, force_limit=1e-4)
    assert end.value.outcome is Outcome.MOVE_TOO_LONG


def test_a_stroke_of_thirty_metres_has_its_optimum():
    """Cells over all of it took 80 s and 2.8 GB."""
    machine = gantry()
    move = Positioning(distance=30.0, max_velocity=0.5)
    found = find_time_optimum(build_plant(machine), move, force_limit=3200.0, bounds=())
    assert found.method == "exact"
    assert found.certificate.relative_gap < 1e-4
    far = replace(move, distance=3e4)
    with pytest.raises(ComputationError) as end:
        find_time_optimum(build_plant(machine), far, force_limit=3200.0, bounds=())
    assert end.value.outcome is Outcome.MOVE_TOO_LONG


@pytest.mark.parametrize(
    "move", [STEP, *(Positioning(distance=size, max_velocity=1.0) for size in (0.4, 0.01))]
)
def test_least_time_is_that_of_a_setpoint_with_endless_jerk(move):
    """If it failed, moves would be refused or begun by a wrong duration."""
    planned = plan_setpoint(move, MotionLimits(acceleration=2.0, jerk=2e6))
    assert least_motion_time(move, 2.0) == pytest.approx(planned.duration, rel=1e-4)


def with_force(force: float) -> Machine:
    machine = paper_machine()
    return replace(machine, drive=replace(machine.drive, max_force=force))


@pytest.mark.parametrize("force", [0.5, 1e-300])
def test_too_small_a_force_is_refused_at_once_with_reason_and_remedy(force):
    """If it failed, the user would wait for hours instead of checking the unit of the force."""
    with np.errstate(all="raise"), pytest.raises(ComputationError) as caught:
        recommend(with_force(force))
    assert caught.value.outcome is Outcome.MOVE_TOO_LONG
    assert "velocity cycles of 125\u202fµs, followed are 5×10⁵ at most" in str(caught.value)
    assert "check the unit of max_force" in str(caught.value)


def test_a_long_move_takes_no_more_instants_and_is_judged_alike():
    """A cruise of a minute once asked for gigabytes; it leaves no vibration of its own."""
    machine = gantry()
    tuned, limits = tune_loop(machine), MotionLimits(acceleration=2.0, jerk=50.0)
    short, far = (
        simulate_corners(
            tuned.loops,
            plan_setpoint(Positioning(distance=distance, max_velocity=0.5), limits),
            drive=machine.drive,
            band=machine.requirements.tcp_deviation,
        )
        for distance in (5.0, 30.0)
    )
    for one, other in zip(short, far, strict=True):
        assert len(other.t) < 1.2 * len(one.t)
        late = one.settling_time - one.t_end
        assert other.settling_time - other.t_end == pytest.approx(late, abs=1e-4)
        assert other.residual_deviation == pytest.approx(one.residual_deviation, rel=1e-3)
        assert other.peak_deviation == pytest.approx(one.peak_deviation, rel=1e-3)
        assert other.max_force == pytest.approx(one.max_force, rel=1e-3)
        energies = [each.rms_force**2 * each.t_end for each in (one, other)]
        assert energies[1] == pytest.approx(energies[0], rel=0.01)


SLOW_NOTCH = """
force_filters = [{ kind = "notch", frequency = "0.1 Hz", damping = 0.06, width = 0.2 }]
"""


def test_a_setpoint_that_waits_for_thousands_of_cycles_is_refused_by_the_line():
    """A filter of 0.1 Hz, where 100 Hz was meant, kept `check` busy for minutes."""
    text = read_shipped("milling-manipulator").text.replace('"2 ms"', '"0.5 ms"')
    with pytest.raises(InputError) as caught:
        parse_profile(text + SLOW_NOTCH, where="late.toml")
    place = f"late.toml:{len(text.splitlines()) + 2}: control.force_filters[1].frequency: "
    assert place in str(caught.value)
    assert "which is 896 position cycles of 500\u202fµs; must be at most 500" in str(caught.value)


def test_a_long_wait_makes_no_larger_loop():
    """What is kept of the setpoint was a state of the loop: 200 cycles took 37 times as long."""
    machine = gantry()
    waits = (
        replace(machine, control=replace(machine.control, reference_delay=delay))
        for delay in (20e-3, 0.4)
    )
    short, long = (tune_loop(one).loops[0] for one in waits)
    assert (short.kept, long.kept) == (20, 400)
    assert short.states == long.states
