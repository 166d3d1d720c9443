"""The commissioning rule: average, jerk and acceleration for every move, with a pocket calculator.

In one sentence: average one period of the softest mode, let the band set the jerk, and the force
the acceleration. Three facts carry it (derivation and validation: ``docs/commissioning-rule.md``):

1. A jerk step j leaves a vibration of amplitude j m |g|/ω³ in a mode. Among all moves there is one
   whose ramps all add, so a velocity step leaves four of these, positioning eight: no acceleration
   helps, only the jerk, or a moving average, which leaves W of it.
2. The same step leaves a following-error transient j C_S, because the feed-forward force comes
   through a lag and the encoder sees the modes, and j C_P, because the payload is not known.
3. The parts differ in phase and in time, so their squares are added.

So the band gives the jerk, whatever the acceleration; the force, and what a move reaches, give the
acceleration; without an average, or with one, whichever moves sooner.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cbrt, hypot, inf, sqrt

from mtcommission.control_kinds.kind import MOVING_AVERAGE, Jerk
from mtcommission.limits.commissioning_rule.by_hand import (
    RuleFormula,
    RuleStep,
    Tried,
    calculate_by_hand,
    formulas_for,
)
from mtcommission.limits.commissioning_rule.estimate import (
    AxisEstimate,
    count_ramps,
    duration,
    estimate_axis,
    force_acceleration,
    jerk_force,
    passed_by_average,
    servo_sensitivity,
)
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits

REACHED = 0.999
"""Share of the acceleration at which the phase of constant acceleration vanishes: on that
border itself the generator's arithmetic is degenerate."""

RESERVE = 1.25
"""Factor on the estimated residual (fitted, see the docs)."""

JERK_SHARE = 0.5
"""Of the force that the jerk may take where it is fed forward (design choice)."""

MOST_SEEN = 1.0
"""Largest m c of a mode that was tried: beyond it the held encoder is much too careful."""

DESCRIPTION, ADVICE = Message("rule-description"), Message("rule-advice")
VALIDITY = Message("rule-validity")
"""The rule in words, what to try, and where it holds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleResult:
    """The rule applied to a machine."""

    best: Tried  # what has the shortest motion
    tried: tuple[Tried, ...]
    predicted_settling_time: float  # t_e + τ of the slowest move [s]
    formulas: tuple[RuleFormula, ...]
    steps: tuple[RuleStep, ...]  # the hand calculation, in order
    warnings: tuple[Message, ...]
    """Why it may not hold for this machine; empty inside its range of validity."""

    @property
    def limits(self) -> MotionLimits:
        """Acceleration, jerk and filter that the rule gives."""
        return self.best.limits


def apply_commissioning_rule(machine: Machine, plant: Plant, tuned: TunedLoop) -> RuleResult:
    """Return limits and filter by the commissioning rule, with the hand calculation.

    Machine and plant are nominal; of ``tuned`` only the gains are used: Kv, Kp, Tn, cycles and
    feed-forward.

    Source: derived and validated in ``docs/commissioning-rule.md``.

    Examples
    --------
    >>> from mtcommission.loop.tuning.tuning import tune_loop
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> machine = read_shipped("modal-two-modes").machine
    >>> found = apply_commissioning_rule(machine, build_plant(machine), tune_loop(machine))
    >>> found.best.residual_deviation <= machine.requirements.tcp_deviation
    True
    """
    axis = estimate_axis(machine, plant, tuned.controller)
    tried = tuple(_try_filter(axis, item) for item in _filters(axis))
    best = min(tried, key=lambda item: item.duration)
    return RuleResult(
        best=best,
        tried=tried,
        predicted_settling_time=best.duration + tuned.controller.reference_delay,
        formulas=formulas_for(machine.moves),
        steps=calculate_by_hand(axis, best),
        warnings=_warn_outside_validity(axis),
    )


def _filters(axis: AxisEstimate) -> list[SetpointFilter | None]:
    """No filter, and an average of one period of the softest mode as long as it can be typed in."""
    control = axis.machine.control
    if not control.seeks_setpoint_filter:
        return [control.setpoint_filter]
    choice = control.kind.find_filter(MOVING_AVERAGE)
    if choice is None:
        return [None]
    softest = max(axis.modes, key=lambda mode: mode.jerk_sensitivity)
    least, most = choice.times(control.position_cycle)
    step = choice.unit(control.position_cycle)
    time = max(round(min(max(1.0 / softest.middle_hz, least), most) / step), 1) * step
    return [None, moving_average(time)] if least <= time <= most else [None]


def _try_filter(axis: AxisEstimate, item: SetpointFilter | None) -> Tried:
    control, moves = axis.machine.control, axis.machine.moves
    average = item.time if item and item.kind == MOVING_AVERAGE else 0.0
    each = 2.0 * count_ramps(moves)
    parts = [servo_sensitivity(axis, average), axis.servo.drag]
    parts += [
        each * mode.jerk_sensitivity * passed_by_average(mode, average) for mode in axis.modes
    ]
    jerk = axis.machine.requirements.tcp_deviation / (RESERVE * hypot(*parts))
    if fed := jerk_force(axis.controller):
        jerk = min(jerk, JERK_SHARE * axis.machine.drive.motion_force / fed)
    bounds = {
        "rule-force": force_acceleration(axis, jerk),
        "rule-reach": max(_reach(move, jerk) for move in moves),
    }
    bound_by = min(bounds, key=lambda key: bounds[key])
    acceleration = bounds[bound_by]
    limits = MotionLimits(
        acceleration=acceleration,
        # No control sends a ramp that is shorter than its cycle.
        jerk=min(jerk, acceleration / control.position_cycle),
        setpoint_filter=item if control.seeks_setpoint_filter else None,
    )
    name = Message("rule-average", time=average) if average else Message("rule-no-average")
    longest = max(duration(move, limits) for move in moves)
    return Tried(
        name=name,
        limits=limits,
        average=average,
        allowed_jerk=jerk,
        by_force=bounds["rule-force"],
        bound_by=Message(bound_by),
        duration=longest + (item.duration if item else 0.0),
        residual_deviation=limits.jerk * hypot(*parts),
    )


def _reach(move: Move, jerk: float) -> float:
    """Largest acceleration that a move reaches with ramps of this jerk [m/s²].

    Of several moves the largest counts: those that do not reach it have the same jerk.
    """
    if isinstance(move, VelocityStep):
        return REACHED * sqrt(move.velocity_step * jerk)
    return REACHED * min(sqrt(move.max_velocity * jerk), cbrt(move.distance * jerk**2 / 2.0))


def _warn_outside_validity(axis: AxisEstimate) -> tuple[Message, ...]:
    """Why the rule may not hold for a machine; empty inside its range of validity."""
    machine, controller = axis.machine, axis.controller
    needs, control, found = machine.requirements, machine.control, []
    if controller.velocity_feedforward != 1.0:
        found.append(Message("rule-needs-velocity-feedforward"))
    if control.reference_delay is not None:
        found.append(Message("rule-needs-automatic-delay"))
    if control.setpoint_filter is not None and control.setpoint_filter.kind != MOVING_AVERAGE:
        found.append(Message("rule-knows-averages-only"))
    if control.kind.jerk is Jerk.NONE:
        found.append(Message("rule-needs-jerk-limit"))
    if needs.peaks or min(machine.drive.continuous_force, needs.contour_deviation) < inf:
        found.append(Message("rule-knows-no-peaks"))
    for mode in axis.plant.modes:
        share = controller.feedforward_mass * abs(mode.measured_gain)
        if share > MOST_SEEN:
            found.append(Message("rule-careful-with-seen-mode", mode=mode.name, share=share))
    return tuple(found)
