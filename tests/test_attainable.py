"""Which requirement is in the way, and what could be met instead: each answer simulated."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.commission.recommend import recommend
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.judge import evaluate
from mtcommission.limits.requirements import RESIDUAL_DEVIATION
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.readers import SignalValue
from mtcommission.machine.requirements import Modes
from mtcommission.study.attainable import Attainable, find_attainable, find_limits_by_mode
from tests.machines import paper_machine


def asked(
    *, band: float = 5e-6, settling: float = 1.0, peaks: tuple[SignalValue, ...] = ()
) -> Machine:
    machine = paper_machine()
    needs = replace(
        machine.requirements, tcp_deviation=band, max_settling_time=settling, peaks=peaks
    )
    return replace(machine, requirements=needs)


def attainable(machine: Machine) -> dict[str, Attainable]:
    tuned = tune_loop(machine)
    choice = choose_limits(machine, tuned)
    assert not choice.meets_requirements
    found = find_attainable(machine, tuned, choice)
    return {item.requirement: item for item in found}


def is_met(machine: Machine, item: Attainable) -> bool:
    tuned = tune_loop(machine)
    return evaluate(machine, tuned, item.limits).assessment.is_met


def test_impossible_settling_time():
    """If it failed, the user would not learn what settling time, or what band, to ask for."""
    machine = asked(settling=0.087)
    found = attainable(machine)
    assert set(found) == {"settling time", "residual deviation"}
    slower, wider = found["settling time"], found["residual deviation"]
    assert slower.limit == 0.087
    assert slower.value > 0.087
    assert is_met(asked(settling=1.0001 * slower.value), slower)
    assert wider.value > 5e-6
    assert is_met(asked(settling=0.087, band=1.0001 * wider.value), wider)


def test_two_requirements_must_give_way_together():
    """If it failed, relaxing one would be promised to help, or nothing be said at all."""
    bound = SignalValue(name="v_s", value=0.05)
    found = attainable(asked(settling=0.02, peaks=(bound,)))
    time, peak = found["settling time"], found["peak v_s"]
    assert time.together_with == ("peak v_s",)
    assert peak.together_with == ("settling time",)
    assert (time.limit, peak.limit) == (0.02, 0.05)
    assert time.limits == peak.limits
    eased = replace(bound, value=1.0001 * peak.value)
    assert is_met(asked(settling=1.0001 * time.value, peaks=(eased,)), time)
    assert not is_met(asked(settling=1.0001 * time.value, peaks=(bound,)), time)
    # The move reaches 0.1 m/s, so no limits keep the peak: what is asked for instead is close.
    assert 0.1 < peak.value < 0.12


def test_a_machining_mode_with_a_wider_band_settles_no_later_and_keeps_its_own():
    """If it failed, roughing would be told to go more slowly than finishing, or out of its band."""
    machine = asked()
    modes = Modes(surface=2e-6, accuracy=5e-6, speed=20e-6)
    machine = replace(machine, requirements=replace(machine.requirements, modes=modes))
    tuned = tune_loop(machine)
    choice = choose_limits(machine, tuned)
    found = find_limits_by_mode(machine, tuned, choice)
    times = [mode.settling_time for mode in found]
    assert times == sorted(times, reverse=True)
    assert (found[1].acceleration, found[1].jerk) == (
        choice.limits.acceleration,
        choice.limits.jerk,
    )
    for mode in found:
        own = RESIDUAL_DEVIATION.with_bound(machine, mode.band)
        limits = replace(choice.limits, acceleration=mode.acceleration, jerk=mode.jerk)
        judged = evaluate(own, tuned, limits)
        assert judged.assessment.keeps_reserve
        assert judged.settling_time == mode.settling_time


def test_roughing_has_ramps_far_shorter_than_the_recommended_ones_where_these_serve():
    """A search that looks too near told roughing to go as slowly as everything else."""
    found = recommend(read_shipped("ball-screw").machine)
    *_, speed = find_limits_by_mode(found.machine, found.loop.tuned, found.choice)
    assert speed.settling_time < 0.985 * found.choice.candidate.settling_time
    assert speed.jerk_time < 0.3 * found.choice.limits.jerk_time
