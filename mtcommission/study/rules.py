"""What the rules of makers and textbooks, and the shapers of the control, do in the same loop.

Which value of a manual or a menu may be kept: each stands beside the recommendation, judged alike.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from mtcommission.limits.commissioning_rule.rule import RuleResult
from mtcommission.limits.judge import Candidate
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb, apply_slower_ramps
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, largest_acceleration
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message
from mtcommission.plant.plant import build_plant, dominant_mode
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.study.variations import Row, judge

SOURCES = {
    "zv": "source-singer",
    "mzv": "source-klipper",
    "zvd": "source-singer",
    "ei": "source-klipper",
}
"""Shapers that are compared, by rising duration, and who says so."""

DESIGN_DAMPING = 0.1
"""Damping ratio that Klipper's shapers are set to unless told otherwise [-]."""


def evaluate_rules(machine: Machine, tuned: TunedLoop, rule: RuleResult) -> tuple[Candidate, ...]:
    """Return what the commissioning rule, then the rules of makers and textbooks do."""
    plant = build_plant(machine)
    own = Row(
        label=Message("commissioning-rule-with", chosen=rule.best.name),
        source=Message("source-commissioning-rule"),
        machine=machine,
        tuned=tuned,
        limits=rule.limits,
    )
    known = (*apply_rules_of_thumb(machine, plant), *apply_slower_ramps(machine, plant))
    rows = (replace(own, label=item.name, source=item.source, limits=item.limits) for item in known)
    return tuple(map(judge, (own, *rows)))


def compare_shapers(
    machine: Machine, tuned: TunedLoop, *, near: MotionLimits
) -> tuple[Candidate, ...]:
    """Return the shapers that the control has, set to the dominant mode, with the best limits each.

    What Klipper's calibrate_shaper would choose comes first, where the machine was measured so.
    ``near``: the recommendation; limits of a shaper lie about it.
    """
    return tuple(map(judge, (*_of_klipper(machine, tuned), *_of_control(machine, tuned, near))))


def _of_control(machine: Machine, tuned: TunedLoop, near: MotionLimits) -> Iterator[Row]:
    mode = dominant_mode(build_plant(machine))
    f, zeta = mode.frequency_hz, mode.damping_ratio
    for kind, source in SOURCES.items():
        if machine.control.kind.find_filter(kind) is None:
            continue
        item = SetpointFilter(kind=kind, frequency_hz=f, damping_ratio=zeta)
        control = replace(machine.control, setpoint_filter=item, seeks_setpoint_filter=False)
        yield Row(
            label=Message("shaper-for-mode", shaper=kind.upper(), mode=mode.name, frequency=f),
            source=Message(source),
            machine=replace(machine, control=control),
            tuned=tuned,
            near=replace(near, setpoint_filter=item),
        )


def _of_klipper(machine: Machine, tuned: TunedLoop) -> Iterator[Row]:
    """What calibrate_shaper recommends for the same measurement, at its max_accel.

    Where that is more than the motor follows, or than is looked at, at that.
    """
    identified = machine.identified
    for one in identified.proposals if identified else ():
        if not one.is_recommended:
            continue
        item = SetpointFilter(
            kind=one.shaper, frequency_hz=one.frequency_hz, damping_ratio=DESIGN_DAMPING
        )
        a = min(one.max_acceleration, largest_acceleration(machine))
        yield Row(
            label=Message(
                "shaper-of-calibration", shaper=one.shaper.upper(), frequency=one.frequency_hz
            ),
            source=Message("source-calibrate-shaper"),
            machine=machine,
            tuned=tuned,
            limits=replace(without_jerk_limit(machine, a), setpoint_filter=item),
        )
