"""The commissioning rule: acceleration and jerk with a pocket calculator.

Three facts carry it (derivation and validation: ``docs/commissioning-rule.md``):

1. A jerk step j leaves a vibration of amplitude j m |g|/ω³ in a mode. A ramp of length t_j
   multiplies it by R = |1 - exp(p t_j)|, which is small only near whole periods of the mode;
   the earlier ramps add their decayed echo.
2. The same step leaves a following-error transient j C_S, because the feed-forward force comes
   through a lag and the encoder sees the modes, and j C_P, because the payload is not known.
   These have no zeros: they bound the jerk itself.
3. The parts differ in phase and in time, so their squares are added.

So each t_j tried has one largest a, by force, by reach, or by the band; the ramp with the
shortest motion wins.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, sqrt

from mtcommission.limits.commissioning_rule.by_hand import (
    RuleFormula,
    RuleStep,
    calculate_by_hand,
    formulas_for,
    warn_outside_validity,
)
from mtcommission.limits.commissioning_rule.estimate import (
    AxisEstimate,
    duration,
    echo,
    estimate_axis,
    force_acceleration,
    servo_parts,
    vibrations,
)
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits

REACHED = 0.999
"""Share of the acceleration at which the phase of constant acceleration vanishes: on that
border itself the generator's arithmetic is degenerate."""

RESERVE = 1.25
"""Factor on the estimated residual (fitted: without it five points more machines miss)."""

PERIODS = (1, 2, 3)
"""Ramps of so many periods of a mode are tried (more would save over 4 % of time on one machine
in twenty, see the docs)."""

DESCRIPTION, ADVICE = Message("rule-description"), Message("rule-advice")
VALIDITY = Message("rule-validity")
"""The rule in words, what to try, and where it holds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TriedRamp:
    """One jerk time with the largest acceleration that it allows.

    Parameters
    ----------
    name
        Where the jerk time comes from.
    limits
        Acceleration and jerk.
    bound_by
        What bounds the acceleration: the force, the reach (a is just reached), or the band.
    duration
        Of the slowest move, t_e [s].
    residual_deviation
        Predicted by the rule, worst corner [m].
    """

    name: Message
    limits: MotionLimits
    bound_by: Message
    duration: float
    residual_deviation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleResult:
    """The rule applied to a machine.

    Parameters
    ----------
    best
        The ramp with the shortest motion.
    tried
        All ramps.
    predicted_settling_time
        t_e + τ of the slowest move [s].
    formulas
        The rule.
    steps
        The hand calculation, in order.
    warnings
        Why it may not hold for this machine; empty inside its range of validity.
    """

    best: TriedRamp
    tried: tuple[TriedRamp, ...]
    predicted_settling_time: float
    formulas: tuple[RuleFormula, ...]
    steps: tuple[RuleStep, ...]
    warnings: tuple[Message, ...]

    @property
    def limits(self) -> MotionLimits:
        """Acceleration and jerk that the rule gives."""
        return self.best.limits


def apply_commissioning_rule(machine: Machine, plant: Plant, tuned: TunedLoop) -> RuleResult:
    """Return acceleration and jerk by the commissioning rule, with the hand calculation.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Only its gains are used: Kv, Kp, Tn, cycles and feed-forward.

    Returns
    -------
    RuleResult

    Source: derived and validated in ``docs/commissioning-rule.md``.

    Examples
    --------
    >>> from mtcommission.loop.tuning.tuning import tune_loop
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> machine = read_shipped("modal-two-modes").machine
    >>> found = apply_commissioning_rule(machine, build_plant(machine), tune_loop(machine))
    >>> found.best.residual_deviation <= 1.001 * machine.requirements.tcp_deviation
    True
    """
    axis = estimate_axis(machine, plant, tuned.controller)
    tried = _try_ramps(axis)
    best = min(tried, key=lambda ramp: ramp.duration)
    return RuleResult(
        best=best,
        tried=tried,
        predicted_settling_time=best.duration + tuned.controller.reference_delay,
        formulas=formulas_for(machine.moves),
        steps=calculate_by_hand(
            axis,
            best.limits,
            ramp=best.name,
            bound_by=best.bound_by,
            residual=best.residual_deviation,
        ),
        warnings=warn_outside_validity(machine, tuned.controller),
    )


def _try_ramps(axis: AxisEstimate) -> tuple[TriedRamp, ...]:
    times = [(Message("rule-no-cancelling"), _jerk_limited_time(axis))]
    times += [
        (Message("rule-periods", count=k, mode=mode.name), k / mode.frequency_hz)
        for mode in axis.modes
        for k in PERIODS
    ]
    return tuple(_try_ramp(axis, name=name, jerk_time=jerk_time) for name, jerk_time in times)


def _try_ramp(axis: AxisEstimate, *, name: Message, jerk_time: float) -> TriedRamp:
    by_force = force_acceleration(axis, jerk_time)
    sensitivity = _jerk_sensitivity(axis, jerk_time, largest=by_force)
    bounds = {
        "rule-force": by_force,
        "rule-reach": min(_reach(move, jerk_time) for move in axis.machine.moves),
        "rule-band": axis.band * jerk_time / (RESERVE * sensitivity),
    }
    bound_by = min(bounds, key=lambda key: bounds[key])
    acceleration = bounds[bound_by]
    limits = MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
    return TriedRamp(
        name=name,
        limits=limits,
        bound_by=Message(bound_by),
        duration=max(duration(move, limits) for move in axis.machine.moves),
        residual_deviation=limits.jerk * sensitivity,
    )


def _jerk_sensitivity(axis: AxisEstimate, jerk_time: float, *, largest: float) -> float:
    """All parts of the residual per jerk [s³]; their squares are added."""
    parts = servo_parts(axis, jerk_time) + vibrations(axis, jerk_time, largest=largest)
    return hypot(*parts)


def _reach(move: Move, jerk_time: float) -> float:
    """Largest acceleration that a move still reaches with ramps of this length [m/s²]."""
    if isinstance(move, VelocityStep):
        return REACHED * move.velocity_step / jerk_time
    return REACHED * min(move.max_velocity / jerk_time, move.distance / (2.0 * jerk_time**2))


def _jerk_limited_time(axis: AxisEstimate) -> float:
    """Jerk time at which the band holds whatever the phases: every ramp counts twice a step."""
    largest = force_acceleration(axis, inf)
    worst = [axis.servo.jerk_sensitivity, axis.servo.missing * axis.servo.ramp_drag]
    worst += [
        2.0 * mode.jerk_sensitivity * echo(axis.machine, mode, largest) for mode in axis.modes
    ]
    jerk = axis.band / (RESERVE * hypot(*worst))
    times = [largest / jerk]
    for move in axis.machine.moves:
        if isinstance(move, VelocityStep):
            times.append(sqrt(move.velocity_step / jerk))
        else:
            times.append(sqrt(move.max_velocity / jerk))
            times.append((move.distance / (2.0 * jerk)) ** (1.0 / 3.0))
    return min(times)
