"""A requirement that the package has never heard of, registered from outside.

Judge, search, Monte Carlo and page know no requirement by name: if one of these tests failed, a new
requirement would need more than its object, its line in the register and the key of the profile.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import inf

import numpy as np
import pytest

from mtcommission.base.messages.message import Message, parts_of
from mtcommission.limits import requirements as register
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.every_size import judge_sizes
from mtcommission.limits.judge import simulate_moves
from mtcommission.limits.requirements import Requirement, Swing, Yields
from mtcommission.loop.respond import Signal, output_of_states
from mtcommission.loop.simulate import LoopResponse
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.keys import keyed
from mtcommission.machine.machine import Corner, Machine
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.readers import VELOCITIES
from mtcommission.machine.requirements import Requirements
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import sample_setpoint
from mtcommission.setpoint.smaller_moves import resize, size_of
from tests import test_what_if as page


def tool_velocity(plant: Plant) -> np.ndarray:
    return plant.row("tcp") @ plant.A


def ripple(response: LoopResponse, plant: Plant) -> float:
    """Largest |velocity of the tool - velocity of the setpoint| after the move [m/s]."""
    end = np.array([response.setpoint.duration])
    velocity = response.states[response.t >= response.t_end] @ tool_velocity(plant)
    return float(np.abs(velocity - sample_setpoint(response.setpoint, end)[0, 1]).max())


@dataclass(frozen=True, slots=True, kw_only=True)
class Needs(Requirements):
    velocity_ripple: float = keyed(VELOCITIES, "Allowed ripple.", "1 mm/s", default=inf)


def with_ripple(machine: Machine, bound: float) -> Machine:
    own = {one.name: getattr(machine.requirements, one.name) for one in fields(Requirements)}
    return replace(machine, requirements=Needs(**own, velocity_ripple=bound))


RIPPLE = Requirement(
    key="velocity ripple",
    message=Message("requirement-peak", signal="v"),
    unit=lambda machine, _: machine.axis_units.velocity.si,
    bound=lambda machine: getattr(machine.requirements, "velocity_ripple", inf),
    with_bound=with_ripple,
    share=lambda reserve: reserve.band,
    value=ripple,
    by_poles=lambda plant: Swing(
        signal=Signal(row=output_of_states(tool_velocity(plant)), less=1), is_after=True
    ),
    yields=Yields.FIRST,
)
AXIS, BOUND = "honing-z", 0.2e-3


@pytest.fixture
def axis(monkeypatch):
    monkeypatch.setattr(register, "REGISTER", (*register.REGISTER, RIPPLE))
    return with_ripple(read_shipped(AXIS).machine, BOUND)


def test_the_search_keeps_it_with_its_reserve_and_names_it(axis):
    """It holds the limits back, more than without it, and the sheet says so."""
    tuned = tune_loop(axis)
    choice = choose_limits(axis, tuned)
    check = choice.candidate.assessment.check_of(RIPPLE)
    assert choice.meets_requirements
    assert (check.unit, check.limit) == ("m/s", BOUND)
    assert 0.7 < check.value / BOUND <= axis.requirements.reserve.band
    assert RIPPLE.message in parts_of(choice.bound_by)
    free = choose_limits(with_ripple(axis, inf), tuned)
    assert free.candidate.settling_time < choice.candidate.settling_time
    assert [item.key for item in register.requirements_of(with_ripple(axis, inf))] == [
        item.requirement.key for item in free.candidate.assessment.checks
    ]


def test_no_size_in_no_corner_leaves_its_bound(axis):
    """The bound between two sizes that were looked at is derived for any signal."""
    tuned = tune_loop(axis)
    limits = MotionLimits(acceleration=9.0, jerk=280.0)
    checks = judge_sizes(axis, tuned, limits)
    found = next(item for item in checks if item.requirement == RIPPLE)
    worst = 0.0
    for share in np.geomspace(0.003, 1.0, 60):
        moves = tuple(resize(move, size_of(move) * share) for move in axis.moves)
        for result in simulate_moves(replace(axis, moves=moves), tuned, limits):
            worst = max(worst, result.values[-1].max())
    assert 0.5 * found.value < worst <= found.bound


@page.needs_browser
def test_the_page_judges_it_without_a_line_of_its_own(axis, tmp_path, monkeypatch):
    """What is tried on the page would be called met where the program says missed."""
    monkeypatch.setattr(page, "read_machine", lambda _: axis)
    bench = page.build_bench(AXIS)
    cases, seen = page.draw_cases(bench, seed=5), 0
    for case, found in zip(cases, page.run_in_page(bench, cases, tmp_path), strict=True):
        check = next(one for one in found["checks"] if one["name"] == RIPPLE.key)
        if case.place != Corner() or any(one["saturated"] for one in found["responses"]):
            continue
        seen += 1
        (result,) = simulate_moves(replace(axis, moves=(case.move,)), bench.tuned, case.limits)
        assert check["limit"] == BOUND
        assert check["value"] == pytest.approx(result.values[-1].max(), rel=1e-2, abs=0.01 * BOUND)
    assert seen > 2
