"""The verdict must name every requirement, its worst place and the one in the way."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.quantities import THIN_SPACE
from mtcommission.limits.judge import Assessment, Check, assess, simulate_moves
from mtcommission.limits.requirements import CONTOUR_DEVIATION, requirements_of
from mtcommission.loop.simulate import LoopResponse
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import NOMINAL, Corner, Machine
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.requirements import Peak
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from tests.machines import paper_machine


def unspaced(text: str) -> str:
    return text.replace(THIN_SPACE, " ")


LIMITS = MotionLimits(acceleration=1.5, jerk=50.0)


def response(**changes: object) -> LoopResponse:
    """A response within all requirements, but for the changes."""
    still = LoopResponse(
        setpoint=plan_setpoint(VelocityStep(velocity_step=0.1), LIMITS),
        t=np.zeros(1),
        deviation=np.zeros(1),
        force=np.zeros(1),
        states=np.zeros((1, 7)),
        t_end=0.08,
        settling_time=0.1,
        residual_deviation=4e-6,
        peak_deviation=2e-5,
        mode_amplitudes=np.zeros(2),
        peaks=np.full(10, 1e-3),
        max_force=1500.0,
        rms_force=700.0,
        saturated=False,
    )
    return replace(still, **changes)  # type: ignore[arg-type]


def demanding(**changes: object) -> Machine:
    machine = paper_machine()
    needs = replace(
        machine.requirements,
        max_settling_time=0.2,
        contour_deviation=3e-5,
        peaks=(Peak(name="v_phi", bound=5e-3),),
    )
    drive = replace(machine.drive, continuous_force=1000.0)
    return replace(machine, requirements=needs, drive=drive, **changes)  # type: ignore[arg-type]


def verdict(machine: Machine, *row: LoopResponse) -> Assessment:
    corners = (NOMINAL, Corner(payload=100.0, frequency_factor=0.95))[: len(row)]
    return assess(machine, build_plant(machine), corners, [values_of(machine, *row)])


def values_of(machine: Machine, *row: LoopResponse) -> np.ndarray:
    plant, required = build_plant(machine), requirements_of(machine)
    return np.array([[item.value(one, plant) for one in row] for item in required])


def named(assessment: Assessment, name: str) -> Check:
    return next(check for check in assessment.checks if check.name == name)


def test_every_requirement_has_a_check_with_its_limit() -> None:
    found = verdict(demanding(), response())
    limits = {check.name: (check.limit, check.unit) for check in found.checks}
    assert limits == {
        "residual deviation": (5e-6, "m"),
        "settling time": (0.2, "s"),
        "contour deviation": (3e-5, "m"),
        "peak v_phi": (5e-3, "rad/s"),
        "set force": (2000.0, "N"),
        "RMS force": (1000.0, "N"),
    }
    assert found.is_met
    assert found.limiting_requirement is None


peaks = np.full(10, 1e-3)
peaks[5] = 6e-3


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"residual_deviation": 5.1e-6}, "residual deviation"),
        ({"settling_time": 0.21}, "settling time"),
        ({"settling_time": inf}, "settling time"),
        ({"peak_deviation": 3.1e-5}, "contour deviation"),
        ({"peaks": peaks}, "peak v_phi"),
        ({"max_force": 2001.0}, "set force"),
        ({"rms_force": 1001.0}, "RMS force"),
    ],
)
def test_each_missed_requirement_is_the_limiting_one(changes: dict[str, object], name: str) -> None:
    found = verdict(demanding(), response(), response(**changes))
    assert not found.is_met
    assert [check.name for check in found.checks if not check.is_met] == [name]
    limiting = found.limiting_requirement
    assert limiting is not None
    assert limiting.key == name
    where = unspaced(Catalogue().say(named(found, name).where))
    assert where == "payload 100 kg, frequencies × 0.95"


def test_the_worst_move_counts_and_is_named() -> None:
    machine = demanding(moves=paper_machine().moves * 2)
    values = [values_of(machine, one) for one in (response(), response(settling_time=0.15))]
    found = assess(machine, build_plant(machine), (NOMINAL,), values)
    check = named(found, "settling time")
    assert (check.value, Catalogue().say(check.where)) == (0.15, "move 2, nominal")


def test_a_contour_is_judged_at_its_feed_and_the_rest_at_the_velocity_of_the_move() -> None:
    """A rapid move would be slowed down to keep a contour that nobody cuts at that velocity."""
    machine = paper_machine()
    needs = replace(machine.requirements, contour_deviation=1e-3, contour_feed=0.01)
    machine = replace(machine, requirements=needs)
    tuned = tune_loop(machine)
    (fast,) = simulate_moves(machine, tuned, LIMITS)
    (slow,) = simulate_moves(
        replace(machine, moves=(VelocityStep(velocity_step=0.01),)), tuned, LIMITS
    )
    found = assess(machine, build_plant(machine), tuned.corners, [fast.values])
    worst = max(response.peak_deviation for response in slow.responses)
    assert worst < 0.9 * max(response.peak_deviation for response in fast.responses)
    assert found.check_of(CONTOUR_DEVIATION).value == worst
