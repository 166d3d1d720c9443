"""What the loop does beside following the setpoint: disturbances, and what feed-forward costs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from mtcommission.limits.judge import simulate_moves
from mtcommission.loop.analysis.disturbance import DisturbanceStep, simulate_disturbance
from mtcommission.loop.model.controller import Controller, feedforward_delay
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.loop_trials import LoopChoice

PUSH_TIME = 0.3
"""How long the response to a step of force is followed [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DisturbedTool:
    """The disturbance step response of the tool, nominal machine."""

    name: Message  # which loop
    step: DisturbanceStep


@dataclass(frozen=True, slots=True, kw_only=True)
class JerkFeedforward:
    """The recommended limits with some weight of the jerk feed-forward, worst case."""

    weight: float  # 1 cancels the drive lag [-]
    is_used: bool  # whether everything else in the record uses this weight
    reference_delay: float  # τ [s]
    max_force: float  # largest |F_set| that the loop asks for [N]
    settling_time: float  # [s]
    residual_deviation: float  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopStudy:
    """The response of the tool to a disturbance, and the effect of the jerk feed-forward."""

    disturbed: tuple[DisturbedTool, ...]
    """The loop without and with state feedback, or the one there is; empty where the motor follows
    its setpoint, whatever pushes."""
    jerk_feedforward: tuple[JerkFeedforward, ...]
    """Without, with, and as the profile has it; empty where the control has none."""


def study_loop(machine: Machine, loop: LoopChoice, limits: MotionLimits) -> LoopStudy:
    """Return the response to a disturbance and the effect of the jerk feed-forward.

    ``machine``: nominal; ``loop``: the loop that is used, and its variants; ``limits``: the
    recommended ones.
    """
    if machine.drive.follows:
        return LoopStudy(disturbed=(), jerk_feedforward=())
    shown = [(variant.name, variant.tuned) for variant in loop.variants]
    shown = shown or [(Message("loop-in-use"), loop.tuned)]
    used = loop.tuned.controller.jerk_feedforward
    weights = sorted({0.0, 1.0, used}) if machine.control.kind.jerk_feedforward else ()
    return LoopStudy(
        disturbed=tuple(
            DisturbedTool(name=name, step=simulate_disturbance(tuned.loops[0], duration=PUSH_TIME))
            for name, tuned in shown
        ),
        jerk_feedforward=tuple(
            _with_jerk_feedforward(machine, loop.tuned, limits, weight=weight) for weight in weights
        ),
    )


def _with_jerk_feedforward(
    machine: Machine, tuned: TunedLoop, limits: MotionLimits, *, weight: float
) -> JerkFeedforward:
    own = tuned.controller.jerk_feedforward
    if weight != own:
        controller = _reweighted(machine, tuned.controller, weight)
        tuned = close_loop(corner_plants(machine), controller)
    # Without a limit the force asked for is the linear one, which is what is compared.
    strong = replace(machine, drive=replace(machine.drive, max_force=inf))
    found = [
        response
        for result in simulate_moves(strong, tuned, limits)
        for response in result.responses
    ]
    return JerkFeedforward(
        weight=weight,
        is_used=weight == own,
        reference_delay=tuned.controller.reference_delay,
        max_force=max(response.max_force for response in found),
        settling_time=max(response.settling_time for response in found),
        residual_deviation=max(response.residual_deviation for response in found),
    )


def _reweighted(machine: Machine, controller: Controller, weight: float) -> Controller:
    """The same gains with another jerk feed-forward, and the delay that belongs to it."""
    tau = controller.reference_delay
    if machine.control.reference_delay is None:
        tau = feedforward_delay(
            handing_down=controller.handing_down_delay,
            velocity_cycle=controller.velocity_cycle,
            force_lag=controller.force_lag,
            jerk_feedforward=weight,
            force_filters=controller.force_filters,
        )
    return replace(controller, jerk_feedforward=weight, reference_delay=tau)
