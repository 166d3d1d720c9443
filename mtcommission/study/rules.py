"""What stands beside the recommendation, judged alike in the same loop.

The rules of makers and textbooks and the shapers of the control: which value of a manual or a menu
may be kept. The values now in the control: whether typing in new ones pays.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from mtcommission.base.errors import ComputationError
from mtcommission.base.messages.message import Message
from mtcommission.limits.commissioning_rule import RuleResult
from mtcommission.limits.judge import Candidate, describe_place
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.loop.model.controller import NO_OBSERVER, Controller
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.machine.control import Today
from mtcommission.machine.machine import Machine, largest_acceleration
from mtcommission.machine.plant.plant import build_plant, dominant_mode
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.duration import require_short_moves
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.study.robustness import KeptRange, find_frequency_error
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

SYMBOLS = {"position_gain": "Kv", "velocity_gain": "Kp", "integral_time": "Tn"}
"""Gains as engineers write them."""


def evaluate_rules(machine: Machine, tuned: TunedLoop, rule: RuleResult) -> tuple[Candidate, ...]:
    """Return what the commissioning rule, then the rules of makers and textbooks do."""
    own = Row(
        label=Message("commissioning-rule-with", chosen=rule.best.name),
        source=Message("source-commissioning-rule"),
        machine=machine,
        tuned=tuned,
        limits=rule.limits,
    )
    known = apply_rules_of_thumb(machine, build_plant(machine))
    judged: dict[MotionLimits, Candidate] = {}  # some rules give the same limits
    for item in known:
        if item.limits not in judged:
            judged[item.limits] = judge(replace(own, limits=item.limits))
    others = (replace(judged[item.limits], name=item.name, source=item.source) for item in known)
    return (judge(own), *others)


def compare_shapers(machine: Machine, tuned: TunedLoop) -> tuple[Candidate, ...]:
    """Return the shapers that the control has, set to the dominant mode, with the best limits each.

    What Klipper's calibrate_shaper would choose comes first, where the machine was measured so.
    """
    return tuple(map(judge, (*_of_klipper(machine, tuned), *_of_control(machine, tuned))))


def _of_control(machine: Machine, tuned: TunedLoop) -> Iterator[Row]:
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TodaysValues:
    """The values now in the control, judged like the recommended ones."""

    today: Today  # as stated
    limits: MotionLimits  # of the setpoint; without a jerk limit, the shortest ramp
    controller: Controller  # the loop that they are judged in
    judged: Candidate | None  # None where ``failure`` says why that cannot be told
    frequency_error: KeptRange | None  # likewise: where they keep every requirement
    stated: tuple[str, ...]  # those of Kv, Kp and Tn that are today's, the others the recommended
    failure: Message | None  # the loop is unstable, or the moves take too long

    @property
    def basis(self) -> Message:
        """Which gains the loop has."""
        others = tuple(symbol for symbol in SYMBOLS.values() if symbol not in self.stated)
        if not self.stated:
            return Message("today-in-recommended-loop")
        if not others:
            return Message("today-in-own-loop")
        return Message("today-in-mixed-loop", stated=self.stated, others=others)


def judge_today(machine: Machine, tuned: TunedLoop) -> TodaysValues | None:
    """Return what today's values do, or None where the profile states none.

    Whatever is not known of today's loop is taken from the recommended one. With one gain of
    today's it is a cascade without state feedback, which was made for other gains.
    """
    today, controller = machine.today, tuned.controller
    if today is None:
        return None
    limits = without_jerk_limit(machine, today.acceleration)
    if today.jerk is not None:
        limits = MotionLimits(acceleration=today.acceleration, jerk=today.jerk)
    gains = {name: value for name in SYMBOLS if (value := getattr(today, name)) is not None}
    if gains:
        controller = replace(
            controller,
            **gains,
            state_gains=0.0 * controller.state_gains,
            observer=NO_OBSERVER,
        )
    control = replace(machine.control, setpoint_filter=today.setpoint_filter)
    filtered = replace(machine, control=control)
    candidate, error, failure = None, None, None
    try:
        require_short_moves(filtered, acceleration=limits.acceleration)
        loop = close_loop(corner_plants(machine), controller) if gains else tuned
        each = zip(loop.corners, loop.analyses, strict=False)  # none where the motor follows
        unstable = [corner for corner, analysis in each if not analysis.is_stable]
        if unstable:
            place = describe_place(1, unstable[0], 1)
            gained = {symbol: getattr(loop.controller, name) for name, symbol in SYMBOLS.items()}
            failure = Message("today-unstable", **gained, corner=place)
        else:
            candidate = judge(Row(machine=filtered, tuned=loop, limits=limits))
            error = find_frequency_error(filtered, loop, limits)
    except ComputationError as fault:
        failure = Message("today-not-judged", why=fault.message)
    return TodaysValues(
        today=today,
        limits=limits,
        controller=controller,
        judged=candidate,
        frequency_error=error,
        stated=tuple(symbol for name, symbol in SYMBOLS.items() if name in gains),
        failure=failure,
    )
