"""The commissioning rule: acceleration and jerk with a pocket calculator.

Three facts carry it (derivation and validation: ``docs/commissioning-rule.md``):

1. A jerk step j leaves a vibration of amplitude j m |g|/ω³ in a mode. A ramp of length t_j
   multiplies it by R = |1 - exp(p t_j)|, which is small only near whole periods of the mode;
   the earlier ramps add their decayed echo.
2. The same step leaves a servo tail j c_S, because the feed-forward force comes through a lag
   and the encoder sees the modes, and j c_P, because the payload is not known. These have no
   zeros: they bound the jerk itself.
3. The parts differ in phase and in time, so their squares are added.

So each candidate t_j has one largest a, by force, by reach, or by the band; the candidate with
the shortest motion wins.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf, sqrt

from mtcommission.limits.commissioning_rule.estimate import (
    AxisEstimate,
    duration,
    echo,
    estimate_axis,
    force_acceleration,
    servo_parts,
    vibrations,
)
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, VelocityStep
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


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStep:
    """One line of the hand calculation.

    Parameters
    ----------
    name
        What is computed.
    formula
        How, as text.
    value
        Result.
    unit
        SI unit of the result.
    """

    name: str
    formula: str
    value: float
    unit: str


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
        ``force``, ``reach`` (a is just reached) or ``band``.
    duration
        Of the slowest move, t_e [s].
    residual_deviation
        Predicted by the rule, worst corner [m].
    """

    name: str
    limits: MotionLimits
    bound_by: str
    duration: float
    residual_deviation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleResult:
    """The rule applied to a machine.

    Parameters
    ----------
    limits
        Acceleration and jerk that the rule gives.
    chosen
        Name of the candidate.
    bound_by
        What bounds its acceleration.
    predicted_settling_time
        t_e + τ of the slowest move [s].
    predicted_residual
        Worst corner [m].
    steps
        The hand calculation, in order.
    candidates
        All jerk times tried.
    formula
        The rule in one paragraph.
    validity
        Where it holds.
    warnings
        Why it may not hold for this machine; empty inside its range of validity.
    """

    limits: MotionLimits
    chosen: str
    bound_by: str
    predicted_settling_time: float
    predicted_residual: float
    steps: tuple[RuleStep, ...]
    candidates: tuple[TriedRamp, ...]
    formula: str
    validity: str
    warnings: tuple[str, ...]


ECHO = "V = R(f t_j) (1 + exp(-omega zeta v/a))"

FORMULA = (
    "1.25 j root(C_S^2 + C_P^2 + sum (C_i V_i)^2) <= band, with C_i = m |g_i|/omega_i^3, "
    f"{ECHO} and R(x) = |1 - exp(2 pi x (i - zeta))| within the "
    "spread; a (1.17 m + Kp (T_p/2 + sum m c_i/omega_i min(1, 2/(omega_i t_j)))) <= F; "
    "v/a >= t_j. Try t_j = 1, 2, 3 periods of each mode, and the t_j that needs no cancelling "
    "(R = 2); take the shortest motion; j = a/t_j."
)
"""For a velocity step, whose two ramps are v/a apart."""


def formula_for(moves: Sequence[Move]) -> str:
    """Return the rule's formulas for some moves.

    Parameters
    ----------
    moves
        Velocity steps, positioning moves, or both.

    Returns
    -------
    str
        With the echo of four ramps and the distance where there is a positioning move.

    Examples
    --------
    >>> from mtcommission.machine.machine import Positioning
    >>> formula_for([VelocityStep(velocity_step=0.1)]) == FORMULA
    True
    >>> "L >= 2 a t_j^2" in formula_for([Positioning(distance=0.02, max_velocity=0.5)])
    True
    """
    if all(isinstance(move, VelocityStep) for move in moves):
        return FORMULA
    both = f"{ECHO} for a velocity step, {ECHO} (1 + exp(-omega zeta L/v)) for positioning"
    reach = "v/a >= t_j; L >= 2 a t_j^2 for positioning."
    return FORMULA.replace(ECHO, both).replace("v/a >= t_j.", reach)


VALIDITY = (
    "Rigid axis with lag and weakly damped modes (15 to 200 Hz, damping 0.5 to 10 %), cascade "
    "with full velocity feed-forward and automatic reference delay, spread up to 10 %, payload "
    "up to 30 % of the moving mass, band 2 to 50 um; no setpoint filter, no bounds on peaks or "
    "RMS force. The band is met in most machines, not in all: simulate before use."
)


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
    >>> from benchmarks.population import random_machine
    >>> machine = random_machine(1)
    >>> found = apply_commissioning_rule(machine, build_plant(machine), tune_loop(machine))
    >>> found.predicted_residual <= 1.001 * machine.requirements.tcp_deviation
    True
    """
    controller = tuned.controller
    axis = estimate_axis(machine, plant, controller)
    candidates = _candidates(axis)
    best = min(candidates, key=lambda item: item.duration)
    return RuleResult(
        limits=best.limits,
        chosen=best.name,
        bound_by=best.bound_by,
        predicted_settling_time=best.duration + controller.reference_delay,
        predicted_residual=best.residual_deviation,
        steps=_hand_calculation(axis, best),
        candidates=candidates,
        formula=formula_for(machine.moves),
        validity=VALIDITY,
        warnings=_warnings(machine, controller),
    )


def _candidates(axis: AxisEstimate) -> tuple[TriedRamp, ...]:
    times = [("no cancelling", _jerk_limited_time(axis))]
    times += [
        (f"{_periods(k)} of {mode.name}", k / mode.frequency_hz)
        for mode in axis.modes
        for k in PERIODS
    ]
    return tuple(_candidate(axis, name=name, jerk_time=jerk_time) for name, jerk_time in times)


def _periods(count: int) -> str:
    return f"{count} period{'s' if count > 1 else ''}"


def _candidate(axis: AxisEstimate, *, name: str, jerk_time: float) -> TriedRamp:
    by_force = force_acceleration(axis, jerk_time)
    compliance = _compliance(axis, jerk_time, largest=by_force)
    bounds = {
        "force": by_force,
        "reach": min(_reach(move, jerk_time) for move in axis.machine.moves),
        "band": axis.band * jerk_time / (RESERVE * compliance),
    }
    bound_by = min(bounds, key=lambda key: bounds[key])
    acceleration = bounds[bound_by]
    limits = MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
    return TriedRamp(
        name=name,
        limits=limits,
        bound_by=bound_by,
        duration=max(duration(move, limits) for move in axis.machine.moves),
        residual_deviation=limits.jerk * compliance,
    )


def _compliance(axis: AxisEstimate, jerk_time: float, *, largest: float) -> float:
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


def _hand_calculation(axis: AxisEstimate, best: TriedRamp) -> tuple[RuleStep, ...]:
    controller, limits = axis.controller, best.limits
    tail, drag = servo_parts(axis, limits.jerk_time)
    omega_v = controller.velocity_gain / controller.feedforward_mass
    lines = [
        ("speed loop omega_v", "Kp / m", omega_v, "1/s"),
        (
            "servo compliance C_S",
            "(max(0.4 T^2, 0.18 T_p^2) + 0.8 sum m c/omega^2) min(1.5/omega_v, t_j)",
            tail,
            "s^3",
        ),
        ("unknown share of the mass eps", "|m_ff - m| / m", axis.servo.missing, "1"),
        (
            "payload compliance C_P",
            "eps min(Tn/(omega_v Kv), 1.3 t_j/(omega_v (Kv + 1/Tn)))",
            drag,
            "s^3",
        ),
    ]
    by_force = force_acceleration(axis, limits.jerk_time)
    left = vibrations(axis, limits.jerk_time, largest=by_force)
    for mode, vibration in zip(axis.modes, left, strict=True):
        lines.append(
            (f"compliance C of mode {mode.name}", "m |g| / omega^3", mode.jerk_sensitivity, "s^3")
        )
        widened = mode.spread - axis.machine.requirements.frequency_spread
        if widened > 0.0:
            name = f"spread of mode {mode.name} beyond the stated one"
            lines.append((name, "m |c| min(1, omega_v/omega)", widened, "1"))
        share = vibration / mode.jerk_sensitivity if mode.jerk_sensitivity else 0.0
        lines.append(
            (f"vibration V of mode {mode.name}", "R(f t_j) x echo of the ramps before", share, "1")
        )
    lines.append(("jerk time t_j", best.name, limits.jerk_time, "s"))
    lines.append(("acceleration within the force", "see the formula", by_force, "m/s^2"))
    lines.append(("acceleration a", f"bound by {best.bound_by}", limits.acceleration, "m/s^2"))
    lines.append(("jerk j", "a / t_j", limits.jerk, "m/s^3"))
    lines.append(
        ("predicted residual", "j root(C_S^2 + C_P^2 + sum (C V)^2)", best.residual_deviation, "m")
    )
    return tuple(
        RuleStep(name=name, formula=formula, value=value, unit=unit)
        for name, formula, value, unit in lines
    )


def _warnings(machine: Machine, controller: Controller) -> tuple[str, ...]:
    needs, found = machine.requirements, []
    if controller.velocity_feedforward != 1.0:
        found.append("velocity_feedforward is not 1: the following error is not in the rule")
    if machine.control.reference_delay is not None:
        found.append("reference_delay is given: the rule counts on the automatic one")
    if machine.control.moving_average_time > 0.0:
        found.append("a setpoint filter is on: the rule does not count its smoothing")
    if needs.peaks or machine.drive.continuous_force < inf:
        found.append("bounds on peaks or RMS force are not in the rule")
    return tuple(found)
