"""What the values now in the control do, judged alike: whether typing in new ones pays."""

from __future__ import annotations

from dataclasses import dataclass, replace

from mtcommission.errors import ComputationError
from mtcommission.limits.judge import Candidate, describe_place, evaluate
from mtcommission.loop.model.controller import Controller, no_observer
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.machine.control import Today
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.duration import require_short_moves
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.study.robustness import FrequencyError, find_frequency_error
from mtcommission.study.settings import RobustnessSettings

SYMBOLS = {"position_gain": "Kv", "velocity_gain": "Kp", "integral_time": "Tn"}
"""Gains as engineers write them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TodaysValues:
    """The values now in the control, judged like the recommended ones."""

    today: Today  # as stated
    limits: MotionLimits  # of the setpoint; without a jerk limit, the shortest ramp
    controller: Controller  # the loop that they are judged in
    judged: Candidate | None  # None where ``failure`` says why that cannot be told
    frequency_error: FrequencyError | None  # likewise: where they keep every requirement
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


def judge_today(
    machine: Machine, plant: Plant, tuned: TunedLoop, settings: RobustnessSettings
) -> TodaysValues | None:
    """Return what today's values do, or None where the profile states none.

    Whatever is not known of today's loop is taken from the recommended one. With one gain of
    today's it is a cascade without state feedback, which was made for other gains.
    """
    today = machine.today
    if today is None:
        return None
    limits = (
        without_jerk_limit(machine, today.acceleration)
        if today.jerk is None
        else MotionLimits(acceleration=today.acceleration, jerk=today.jerk)
    )
    gains = {name: value for name in SYMBOLS if (value := getattr(today, name)) is not None}
    controller = _with_gains(tuned.controller, gains)
    control = replace(machine.control, setpoint_filter=today.setpoint_filter)
    filtered = replace(machine, control=control)
    candidate, error, failure = None, None, None
    try:
        require_short_moves(filtered, acceleration=limits.acceleration)
        loop = close_loop(corner_plants(machine), controller) if gains else tuned
        failure = _find_instability(loop)
        if failure is None:
            candidate = evaluate(filtered, plant, loop, limits)
            error = find_frequency_error(filtered, plant, loop, limits, settings=settings)
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


def _with_gains(controller: Controller, gains: dict[str, float]) -> Controller:
    if not gains:
        return controller
    return replace(
        controller,
        **gains,  # type: ignore[arg-type]
        state_gains=0.0 * controller.state_gains,
        observer=no_observer(n_sensors=len(controller.sensors)),
    )


def _find_instability(loop: TunedLoop) -> Message | None:
    corners = zip(loop.corners, loop.analyses, strict=True) if loop.analyses else ()
    for corner, analysis in corners:
        if not analysis.is_stable:
            return Message(
                "today-unstable",
                Kv=loop.controller.position_gain,
                Kp=loop.controller.velocity_gain,
                Tn=loop.controller.integral_time,
                corner=describe_place(1, corner, 1),
            )
    return None
