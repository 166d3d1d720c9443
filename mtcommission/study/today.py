"""What the values now in the control do: the same machine, moves and judgement."""

from __future__ import annotations

from dataclasses import dataclass, replace

from mtcommission.errors import ComputationError
from mtcommission.loop.model.controller import Controller, no_observer
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.machine.control import Today
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.study.kept_range import FrequencyError, find_frequency_error
from mtcommission.study.settings import RobustnessSettings
from mtcommission.verdict.assess import describe_place
from mtcommission.verdict.evaluate import Candidate, evaluate

SYMBOLS = {"position_gain": "Kv", "velocity_gain": "Kp", "integral_time": "Tn"}
"""Gains as engineers write them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TodaysValues:
    """The values now in the control, judged like the recommended ones.

    Parameters
    ----------
    today
        As stated.
    limits
        What the setpoint is planned with; without a jerk limit, the shortest ramp.
    controller
        The loop that they are judged in.
    judged
        What they do; None where ``failure`` says why that cannot be told.
    frequency_error
        Between which frequency errors they keep every requirement; None likewise.
    stated
        Those of Kv, Kp and Tn that are today's; the others are those of the recommendation.
    failure
        The loop is unstable, or the moves take too long; None otherwise.
    """

    today: Today
    limits: MotionLimits
    controller: Controller
    judged: Candidate | None
    frequency_error: FrequencyError | None
    stated: tuple[str, ...]
    failure: Message | None

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

    Parameters
    ----------
    machine, plant
        Nominal.
    tuned
        The recommended loop: whatever is not known of today's is taken from it. With one gain of
        today's it is a cascade without state feedback, which was made for other gains.
    settings
        How closely the range of frequencies is looked at.
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
        loop = close_loop(corner_plants(machine), controller) if gains else tuned
        failure = _find_instability(loop) if loop.analyses else None
        if failure is None:
            candidate = evaluate(filtered, plant, loop, limits)
            error = find_frequency_error(filtered, plant, loop, limits, settings=settings)
    except ComputationError as fault:
        failure = fault.message
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
    for corner, analysis in zip(loop.corners, loop.analyses, strict=True):
        if not analysis.is_stable:
            return Message(
                "today-unstable",
                Kv=loop.controller.position_gain,
                Kp=loop.controller.velocity_gain,
                Tn=loop.controller.integral_time,
                corner=describe_place(1, corner, 1),
            )
    return None
