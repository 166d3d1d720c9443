"""Limits for every smaller move: what is said of all sizes must hold for any of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mtcommission.controls.kind import TWO_AVERAGES
from mtcommission.limits.bench import build_bench
from mtcommission.limits.every_size import CLOSER, SizeCheck, judge_sizes
from mtcommission.limits.explore import explore
from mtcommission.limits.judge import evaluate, simulate_moves
from mtcommission.limits.requirements import CONTOUR_DEVIATION, RESIDUAL_DEVIATION, SET_FORCE
from mtcommission.loop.simulate import simulate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from mtcommission.setpoint.smaller_moves import SMALLEST, resize, size_of
from mtcommission.study.robustness import MoveSizes, compare_move_sizes
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine, random_modal_machine

MOVES: list[Move] = [
    VelocityStep(velocity_step=0.1),
    Positioning(distance=0.03, max_velocity=0.25),
    Positioning(distance=0.01),
]


def quiet_paper() -> Machine:
    return quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF)


def with_corners() -> Machine:
    machine = quiet_paper()
    needs = replace(machine.requirements, payload=(0.0, 100.0), frequency_spread=0.04)
    return replace(machine, requirements=needs, moves=(MOVES[1],))


def for_every_size(machine: Machine) -> Machine:
    return replace(machine, requirements=replace(machine.requirements, every_size=True))


MACHINES = {
    "velocity step": for_every_size(quiet_paper()),
    "positioning in corners": for_every_size(with_corners()),
    "four modes": for_every_size(
        replace(random_modal_machine(7, n_modes=4), moves=(MOVES[2],)),
    ),
}
FILTERS = {
    "none": None,
    "average": moving_average(0.019),
    "two averages": SetpointFilter(kind=TWO_AVERAGES, time=0.021, second_time=0.008),
    "shaper": SetpointFilter(kind="mzv", frequency_hz=31.0, damping_ratio=0.03),
}


def residual_of(machine: Machine, tuned: TunedLoop, limits: MotionLimits, size: float) -> float:
    """Worst corner of one size, by the full simulation behind Ruckig."""
    setpoint = plan_setpoint(resize(machine.moves[0], size), limits)
    drive = replace(machine.drive, max_force=1e12)
    band = machine.requirements.tcp_deviation
    found = [simulate(loop, setpoint, drive=drive, band=band) for loop in tuned.loops]
    return max(response.residual_deviation for response in found)


def check_of(checks: tuple[SizeCheck, ...], name: object) -> SizeCheck:
    return next(check for check in checks if check.requirement == name)


@pytest.mark.parametrize("filter_name", FILTERS)
@pytest.mark.parametrize("name", MACHINES)
def test_no_size_leaves_more_than_is_bounded(name, filter_name):
    """A jog of a size that nobody looked at would shake the tool out of the band."""
    machine = MACHINES[name]
    tuned = tune_loop(machine)
    limits = MotionLimits(acceleration=1.5, jerk=60.0, setpoint_filter=FILTERS[filter_name])
    seen = check_of(judge_sizes(machine, tuned, limits), RESIDUAL_DEVIATION)
    # Near its band a residual is known closely; far above it need not be.
    needs = replace(machine.requirements, tcp_deviation=seen.value)
    machine = replace(machine, requirements=needs)
    found = check_of(judge_sizes(machine, tuned, limits), RESIDUAL_DEVIATION)
    assert found.value == pytest.approx(seen.value, rel=CLOSER[0][0])
    listed = size_of(machine.moves[0])
    generator = np.random.default_rng(len(name) + len(filter_name))
    sizes = listed * SMALLEST ** generator.uniform(0.0, 1.0, 40)
    worst = max(residual_of(machine, tuned, limits, float(size)) for size in (*sizes, listed))
    band = machine.requirements.tcp_deviation
    assert worst <= found.bound + 1e-3 * band
    # Sizes are laid for a share of the band, but not more than some thousand of them.
    assert found.value <= found.bound <= found.value + max(0.011 * band, 0.015 * found.value)
    # The worst size is named, and is that bad.
    assert residual_of(machine, tuned, limits, found.size) == pytest.approx(found.value, rel=5e-3)
    assert 0.0 < found.size <= listed


@pytest.mark.parametrize(
    ("name", "average", "jerk_time"), [("honing-z", 0.032, 0.05), ("ball-screw", 0.0, 0.03)]
)
def test_ripple_within_a_position_cycle_counts_in_the_largest_force(name, average, jerk_time):
    """Limits that use all of the force were refused by the simulation: its top was missed."""
    machine = read_shipped(name).machine
    machine = replace(machine, requirements=replace(machine.requirements, every_size=False))
    tuned, heaviest = tune_loop(machine), moving_mass(machine) + machine.requirements.payload[1]
    a = 0.8 * machine.drive.motion_force / heaviest
    item = moving_average(average) if average else None
    limits = MotionLimits(acceleration=a, jerk=a / jerk_time, setpoint_filter=item)
    found = check_of(judge_sizes(machine, tuned, limits), SET_FORCE)
    moves = simulate_moves(machine, tuned, limits)
    stepped = max(response.max_force for move in moves for response in move.responses)
    assert found.value == pytest.approx(stepped, rel=1e-6)


def test_no_size_leaves_its_contour_further_than_is_said() -> None:
    """The size that is worst lay between two that were looked at, 2 % above both."""
    machine = read_shipped("mill-x").machine
    tuned, drive = tune_loop(machine), machine.drive
    item = SetpointFilter(kind=TWO_AVERAGES, time=0.016, second_time=0.016)
    limits = MotionLimits(acceleration=10.6, jerk=321.0, setpoint_filter=item)
    said = check_of(judge_sizes(machine, tuned, limits), CONTOUR_DEVIATION)
    move = CONTOUR_DEVIATION.judged(machine, machine.moves[0])
    loop = tuned.loops[tuned.corners.index(said.corner)]
    stepped = [
        simulate(loop, plan_setpoint(resize(move, size), limits), drive=drive, band=1e-6)
        for size in said.size * np.geomspace(0.8, 1.25, 46)
    ]
    assert said.value >= 0.995 * max(one.peak_deviation for one in stepped)


def test_nothing_on_a_grid_is_sooner():
    """Time would be given away at every move of the machine."""
    item = FILTERS["average"]
    machine = quiet_copy(MACHINES["velocity step"], setpoint_filter=item)
    tuned = tune_loop(machine)
    (move,), needs = machine.moves, machine.requirements
    found = explore(build_bench(machine, tuned))
    best = min(item.duration for item in found)
    a_max = machine.drive.motion_force / moving_mass(machine)
    sooner = []
    for a in a_max * np.geomspace(0.02, 1.0, 20):
        for t_j in np.geomspace(2e-3, 0.2, 20):
            limits = MotionLimits(acceleration=a, jerk=a / t_j, setpoint_filter=item)
            if plan_setpoint(move, limits).duration < best / 1.02:
                checks = judge_sizes(machine, tuned, limits)
                residual = check_of(checks, RESIDUAL_DEVIATION).value
                force = check_of(checks, SET_FORCE).value
                if residual <= needs.tcp_deviation and force <= machine.drive.motion_force:
                    sooner.append((a, t_j))
    assert not sooner


# From which step on limits hold, against the full simulation.


LIMITS = MotionLimits(acceleration=1.5, jerk=30.0)


def two_moves() -> Machine:
    machine = paper_machine()
    needs = replace(machine.requirements, payload=(0.0, 100.0), frequency_spread=0.02)
    moves = (machine.moves[0], Positioning(distance=0.02, max_velocity=0.3))
    return replace(machine, requirements=needs, moves=moves)


def judged(machine: Machine, tuned: TunedLoop, item: MoveSizes, index: int) -> float:
    """Residual of one size, by the full simulation in every corner."""
    move = resize(item.move, float(item.size[index]))
    one = replace(machine, moves=(move,))
    return evaluate(one, tuned, item.limits).residual_deviation


@pytest.mark.parametrize("average", [0.0, 0.0139])
def test_every_size_is_what_the_simulation_says(average):
    """If it failed, the sheet would promise limits for jogs that leave the band."""
    machine = two_moves()
    tuned = tune_loop(machine)
    limits = replace(LIMITS, setpoint_filter=moving_average(average))
    found = compare_move_sizes(machine, tuned, {"x": limits})
    assert [item.move for item in found] == list(machine.moves)
    for item in found:
        for index in (0, 50, 95):
            residual = judged(machine, tuned, item, index)
            assert item.residual_deviation[index] == pytest.approx(residual, rel=1e-4, abs=1e-10)
