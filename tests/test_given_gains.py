"""What the profile gives is used as given, judged, and warned about; the rest follows the rules."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import pytest

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.loop.tuning.family import cascade_family, propose_cascades
from mtcommission.loop.tuning.tuning import check_loop, tune_loop
from mtcommission.machine.control import ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.study.loops import LoopChoice, settle_on_loop
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine

ENGLISH = Catalogue()


def cascade(**changes: object) -> Machine:
    return quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF, **changes)


@pytest.mark.parametrize(
    "given",
    [{"position_gain": 4000.0 / 60.0}, {"velocity_gain": 200e3}],  # 4 (m/min)/mm
)
def test_one_given_gain_is_kept_and_the_largest_good_one_named(given):
    """A user who typed one gain would find another machine's gains, or no result at all."""
    tuned = tune_loop(cascade(**given))
    gains = tuned.controller
    ((key, value),) = given.items()
    assert getattr(gains, key) == value
    if key == "velocity_gain":
        assert gains.integral_time == pytest.approx(4.0 * 750.0 / value)
        assert gains.position_gain == 66.66  # 200e3/(4 x 750), in four digits, down
    (warning,) = tuned.warnings
    assert warning.kind == "loop-given-gains-poor"
    best = named_in(warning).values["value"]
    assert tune_loop(cascade(**{key: best})).warnings == ()
    more = {"velocity_gain": gains.velocity_gain, key: 1.03 * best}
    assert not tune_loop(cascade(**more)).keeps_margins


def named_in(warning: Message) -> Message:
    """The gains that a warning names as a cure."""
    cure = warning.values["cure"]
    assert isinstance(cure, Message)
    named = cure.values["gains"]
    assert isinstance(named, Message)
    return named


def test_gains_that_no_single_change_cures_are_said_so():
    tuned = tune_loop(cascade(position_gain=95.0, velocity_gain=150e3, integral_time=15e-3))
    assert Message("loop-no-cure") in [item.values.get("cure") for item in tuned.warnings]


@pytest.mark.parametrize(
    ("gains", "cured"),
    [
        ({"position_gain": 50.0, "velocity_gain": 1.1e5, "integral_time": 10e-3}, "loop-cure-tn"),
        (
            {"position_gain": 1e3, "velocity_gain": 194800.0, "integral_time": 62.09e-3},
            "loop-cure-kv",
        ),
    ],
)
def test_a_single_change_that_cures_is_found_however_far_it_is(gains, cured):
    """None was said to be found where a tenth of Kv, or another Tn, does."""
    machine = quiet_copy(read_shipped("ball-screw").machine, **gains)
    with pytest.raises(ComputationError) as caught:
        tune_loop(machine)
    named = named_in(caught.value.detail)
    assert named.kind == cured
    key = {"loop-cure-kv": "position_gain", "loop-cure-tn": "integral_time"}[cured]
    assert tune_loop(quiet_copy(machine, **{key: named.values["value"]})).warnings == ()


def test_bandwidth_that_given_gains_miss_is_a_warning_and_not_an_end():
    tuned = tune_loop(cascade(velocity_gain=30e3, minimum_bandwidth_hz=15.0))
    assert tuned.controller.velocity_gain == 30e3
    (warning,) = tuned.warnings
    reached = tuned.least_bandwidth_hz
    assert warning == Message("loop-given-gains-slow", reached=reached, wanted=15.0)
    assert f"{reached:.3g} Hz in its worst corner" in ENGLISH.say(warning)


def choose(machine: Machine) -> LoopChoice:
    return settle_on_loop(machine)


def test_state_feedback_is_tried_where_the_cascade_is_too_slow():
    """A machine that state feedback makes fast enough would be refused."""
    fastest = propose_cascades(cascade_family(cascade())).fastest_hz
    least = 1.02 * fastest
    machine = quiet_copy(paper_machine(), minimum_bandwidth_hz=least)
    choice = choose(machine)
    assert choice.tuned.controller.state_gains.any()
    assert choice.tuned.least_bandwidth_hz >= least
    assert choice.tuned.keeps_margins
    assert choice.remarks[-1] == Message("control-needs-state-feedback")
    assert check_loop(machine) == ()  # no word of a bandwidth out of reach
    with pytest.raises(ComputationError, match="the fastest loop with the margins has") as end:
        choose(cascade(minimum_bandwidth_hz=least))
    assert end.value.outcome is Outcome.BANDWIDTH_OUT_OF_REACH
    assert check_loop(cascade(minimum_bandwidth_hz=least)) != ()


def test_only_what_is_not_given_is_searched():
    """Given gains stay as given, and the others are those that suit the moves best."""
    free = choose(cascade()).tuned.controller
    chosen = choose(cascade(position_gain=0.8 * free.position_gain)).tuned.controller
    assert chosen.position_gain == 0.8 * free.position_gain
    assert chosen.integral_time != pytest.approx(4.0 * 750.0 / chosen.velocity_gain)
    fixed = {
        "position_gain": 20.0, "velocity_gain": 60e3, "integral_time": 0.1
    }  # fmt: skip
    whole = choose(cascade(**fixed))
    assert {key: getattr(whole.tuned.controller, key) for key in fixed} == fixed


def low_pass(frequency_hz: float) -> ForceFilter:
    return ForceFilter(kind="low_pass", natural_frequency=2 * pi * frequency_hz, damping=0.7)


def test_filters_that_soften_the_loop_or_shake_a_mode_are_warned_about():
    """A 30 Hz low-pass makes every setpoint look gentle, the tool soft, and the base ring."""
    tuned = tune_loop(cascade(force_filters=(low_pass(30.0),)))
    plain = tune_loop(cascade())
    ring, softness = tuned.warnings
    assert softness == Message(
        "loop-filters-soften",
        filtered=tuned.least_bandwidth_hz,
        unfiltered=plain.least_bandwidth_hz,
    )
    assert (ring.kind, ring.values["mode"]) == ("loop-takes-damping", "base")
    assert tuned.least_damping[0] < 0.5 * 0.0301
    assert tune_loop(cascade(force_filters=(low_pass(600.0),))).warnings == ()


def test_check_says_what_run_would_say():
    """`check` is where one looks before a long run."""
    poor = cascade(position_gain=95.0, velocity_gain=150e3, integral_time=15e-3)
    assert check_loop(poor) == choose(poor).tuned.warnings != ()
    assert check_loop(paper_machine()) == ()
    (unstable,) = check_loop(cascade(position_gain=400.0, velocity_gain=600e3))
    assert unstable.kind == Outcome.UNSTABLE_LOOP.value
    (short,) = check_loop(cascade(minimum_bandwidth_hz=200.0))
    assert short.kind == Outcome.BANDWIDTH_OUT_OF_REACH.value


def test_a_mode_out_of_reach_and_without_damping_has_its_own_name():
    """ "Lower minimum_bandwidth" would be no remedy for a mode that rings for ever."""
    tower = FlexibleMode(
        name="tower", natural_frequency=2 * pi * 70.0, damping_ratio=0.0, tcp_gain=1e-3
    )
    machine = replace(cascade(), mechanics=Modal(moving_mass=750.0, modes=(tower,)))
    with pytest.raises(ComputationError, match=r"tower \(70 Hz\).*damping_ratio") as end:
        tune_loop(machine)
    assert end.value.outcome is Outcome.UNDAMPED_MODE
    damped = replace(tower, damping_ratio=0.002)
    tuned = tune_loop(replace(machine, mechanics=Modal(moving_mass=750.0, modes=(damped,))))
    assert tuned.keeps_margins
