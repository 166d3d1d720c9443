"""Many machines at once against one at a time, and the ranges that are kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.population import random_machine
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.quantities import THIN_SPACE
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.judge import evaluate
from mtcommission.limits.requirements import RESIDUAL_DEVIATION, SET_FORCE, peak_of
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import Control, StateFeedback
from mtcommission.machine.machine import Machine, corners
from mtcommission.machine.moves import Positioning
from mtcommission.machine.readers import SignalValue
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study import robustness
from mtcommission.study.robustness import (
    KeptRange,
    find_damping_range,
    find_frequency_error,
    respond_varied,
    warn_of_narrow_range,
)
from mtcommission.study.settings import STUDY
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine, slowly_decaying_machine


def spread_paper_machine() -> Machine:
    machine = paper_machine()
    spreads = {"frequency_spread": 0.05, "damping_spread": 0.2, "payload": (0.0, 100.0)}
    needs = replace(machine.requirements, payload_radius=0.3, **spreads)
    control = Control(state_feedback=StateFeedback.OFF)
    moves = (*machine.moves, Positioning(distance=0.01, max_velocity=0.2))
    return replace(machine, requirements=needs, control=control, moves=moves)


def demanding() -> Machine:
    """Every requirement that there is."""
    machine = spread_paper_machine()
    peaks = (SignalValue(name="v_phi", value=2e-3),)
    contour = {"contour_deviation": 3e-4, "contour_feed": 0.08}
    needs = replace(machine.requirements, peaks=peaks, **contour)
    drive = replace(machine.drive, continuous_force=900.0, encoder_resolution=5e-7)
    return replace(machine, requirements=needs, drive=drive)


@pytest.mark.parametrize(
    ("machine", "a", "j"),
    [
        (demanding(), 1.3, 30.0),
        (quiet_copy(demanding(), state_feedback=StateFeedback.AUTO), 2.0, 150.0),
        (quiet_copy(random_machine(6), setpoint_filter=moving_average(0.015)), 0.8, 100.0),
        (slowly_decaying_machine(), 1.12, 2250.0),
    ],
    ids=["demanding", "state feedback", "modal, filtered", "decays slowly"],
)
def test_all_at_once_are_judged_as_one_by_one(machine, a, j):
    """If it failed, the ranges that are kept would be those of other machines."""
    needs = replace(machine.requirements, every_size=False)
    drive = replace(machine.drive, max_force=1e9)  # all at once nothing saturates
    machine = replace(machine, requirements=needs, drive=drive)
    tuned = tune_loop(machine)
    limits = MotionLimits(acceleration=a, jerk=j)
    found = respond_varied(machine, tuned, limits, corners(machine))
    alone = evaluate(machine, tuned, limits)
    checks = alone.assessment.checks
    # Peaks of swings are met by 24 samples to a period.
    for check, values in zip(checks, found.values.T, strict=True):
        assert values.max() == pytest.approx(check.value, rel=5e-3), check.name
    assert found.settling_time.max() == pytest.approx(alone.settling_time, rel=1e-4)
    for number, check in enumerate(checks):
        strict = check.requirement.with_bound(machine, 0.9 * check.value)
        missed = respond_varied(strict, tuned, limits, corners(machine)).is_missed
        assert missed[:, number].any(), check.name


def test_frequency_error_names_the_range_that_is_kept(monkeypatch):
    """If it failed, the sheet would promise a margin of frequency that is not there."""
    machine = spread_paper_machine()
    machine = replace(machine, requirements=replace(machine.requirements, frequency_spread=0.0))
    tuned = tune_loop(machine)
    limits = MotionLimits(acceleration=0.9, jerk=15.0)
    monkeypatch.setattr(robustness, "STUDY", replace(STUDY, frequency_range=0.3))
    found = find_frequency_error(machine, tuned, limits)
    factor, residual = np.array(found.factor), np.array(found.residual_deviation, dtype=np.float64)
    assert factor[[0, 15, 30]] == pytest.approx([0.7, 1.0, 1.3])
    nominal = evaluate(machine, tuned, limits)
    assert nominal.assessment.is_met
    assert residual[15] == pytest.approx(nominal.residual_deviation, rel=1e-6)
    kept = residual <= machine.requirements.tcp_deviation
    inside = (factor >= found.kept_from) & (factor <= found.kept_to)
    assert inside[15]
    assert kept[inside].all()
    assert not kept[factor < found.kept_from][-1:].any()
    assert not kept[factor > found.kept_to][:1].any()


def test_damping_range_is_kept_and_not_beyond():
    """If it failed, the sheet would promise limits on a machine that swings longer."""
    machine = spread_paper_machine()
    needs = replace(machine.requirements, frequency_spread=0.02, damping_spread=0.0)
    machine = replace(machine, requirements=needs)
    tuned = tune_loop(machine)
    limits = choose_limits(machine, tuned).limits
    found = find_damping_range(machine, tuned, limits)
    assert 0.3 < found.kept_from <= 1.0 <= found.kept_to
    for factor, is_kept in ((found.kept_from, True), (found.kept_from - 0.1, False)):
        places = [replace(one, damping_factor=factor) for one in corners(machine)]
        one = respond_varied(machine, tuned, limits, places)
        assert one.is_missed.any() != is_kept


def test_limits_that_hang_on_an_exact_frequency_are_called_so():
    """Otherwise "all requirements met" would be read as true of a machine half a per cent off."""
    machine = paper_machine()
    kept = KeptRange(
        factor=(0.9, 0.995, 1.0, 1.1),
        settling_time=(0.1,) * 4,
        residual_deviation=(1e-6,) * 4,
        kept_from=0.995,
        kept_to=1.1,
        lost_below=(RESIDUAL_DEVIATION.key,),
        lost_above=(SET_FORCE.key, peak_of("v_phi").key),
    )
    (warning,) = warn_of_narrow_range(machine, kept)
    lost = (
        "residual deviation (where they are lower) and set force (where they are higher) and "
        "peak v_φ (where they are higher)"
    )
    said = Catalogue().say(warning).replace(THIN_SPACE, " ")
    assert f"by −0.5 % to at least +10 %. Missed outside this range: {lost}. State a f" in said
    needs = replace(machine.requirements, frequency_spread=0.03)
    assert warn_of_narrow_range(replace(machine, requirements=needs), kept) == ()
