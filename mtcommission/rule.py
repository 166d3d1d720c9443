"""The commissioning rule: acceleration and jerk with a pocket calculator.

Three facts carry it (derivation and validation: ``docs/commissioning-rule.md``):

1. A jerk step j leaves a vibration of amplitude j m |g|/ω³ in a mode. A setpoint is a jerk
   step behind moving averages of length a/j, v/a and L/v, and each of them multiplies it by
   R = |1 - exp(p t)|, which is small only near whole periods of the mode.
2. The same step leaves a servo tail j c_S, because the feed-forward force comes through a lag
   and the encoder sees the modes, and j c_P, because the payload is not known. These have no
   zeros: they bound the jerk itself.
3. The parts differ in phase and in time, so their squares are added.

So each candidate t_j has one largest a, by force, by reach, or by the band; the candidate with
the shortest motion wins.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, hypot, inf, sqrt

from mtcommission.estimate import (
    AxisEstimate,
    averages,
    duration,
    echo,
    estimate_axis,
    force_acceleration,
    ramp_vibration,
    servo_parts,
    vibrations,
)
from mtcommission.limits import MotionLimits
from mtcommission.loop.controller import Controller
from mtcommission.loop.tuning import TunedLoop
from mtcommission.machine import Machine, Move, VelocityStep
from mtcommission.plant import Plant

REACHED = 0.999
"""Share of the acceleration at which the phase of constant acceleration vanishes: on that
border itself the generator's arithmetic is degenerate."""

PERIODS = (1, 2, 3)
"""Ramps of so many periods of a mode are tried; longer ones are never the shortest motion."""


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
class RuleCandidate:
    """One jerk time with the largest acceleration that it allows.

    Parameters
    ----------
    name
        Where the jerk time comes from.
    limits
        Acceleration and jerk.
    bound_by
        ``force``, ``reach`` (a is just reached), ``band`` or ``second zero`` (v/a cancels).
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
    candidates: tuple[RuleCandidate, ...]
    formula: str
    validity: str
    warnings: tuple[str, ...]


FORMULA = (
    "e = j root(c_S^2 + c_P^2 + sum (c_i V_i)^2) <= band with V = R(f t_j) R(f v/a) [R(f L/v)] and "
    "R(x) = |1 - exp(2 pi x (i - zeta))| within the spread; "
    "a (1.1 m + Kp (T_p/2 + sum m c_i/omega_i min(1, 2/(omega_i t_j)))) <= F; v/a >= t_j. "
    "Try t_j = 1, 2, 3 periods of each mode, and v/a a whole number of periods, and the t_j that "
    "needs no cancelling (R = 2); take the shortest motion."
)

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
    >>> from mtcommission.loop.tuning import tune_loop
    >>> from mtcommission.plant import build_plant
    >>> from mtcommission.population import random_machine
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
        formula=FORMULA,
        validity=VALIDITY,
        warnings=_warnings(machine, controller),
    )


def _candidates(axis: AxisEstimate) -> tuple[RuleCandidate, ...]:
    times = [("no cancelling", _jerk_limited_time(axis))]
    times += [
        (f"t_j = {_periods(k)} of {mode.name}", k / mode.frequency_hz)
        for mode in axis.modes
        for k in PERIODS
    ]
    found = []
    for name, jerk_time in times:
        found.append(_largest(axis, name=name, jerk_time=jerk_time))
        found.extend(_second_zeros(axis, name=name, jerk_time=jerk_time))
    return tuple(found)


def _periods(count: int) -> str:
    return f"{count} period{'s' if count > 1 else ''}"


def _largest(axis: AxisEstimate, *, name: str, jerk_time: float) -> RuleCandidate:
    """The largest acceleration at a jerk time, whatever the distance of the ramps."""
    by_force = force_acceleration(axis, jerk_time)
    open_phase = servo_parts(axis, jerk_time) + [
        mode.compliance
        * ramp_vibration(mode.frequency_hz * jerk_time, damping=mode.damping, spread=mode.spread)
        * echo(axis.machine, mode, by_force)
        for mode in axis.modes
    ]
    bounds = {
        "force": by_force,
        "reach": _acceleration_over(axis.machine, jerk_time, jerk_time),
        "band": axis.band * jerk_time / hypot(*open_phase),
    }
    bound_by = min(bounds, key=lambda key: bounds[key])
    return _candidate(
        axis, name=name, jerk_time=jerk_time, acceleration=bounds[bound_by], bound_by=bound_by
    )


def _second_zeros(axis: AxisEstimate, *, name: str, jerk_time: float) -> list[RuleCandidate]:
    """Accelerations at which v/a cancels a mode, too, as far as force and band allow."""
    by_force = force_acceleration(axis, jerk_time)
    shortest = _shortest_distance(axis.machine, by_force, jerk_time)
    found = []
    for mode in axis.modes:
        first = ceil(mode.frequency_hz * shortest - 1e-9)
        for n in (first, first + 1):
            apart = max(n, 1) / mode.frequency_hz
            acceleration = _acceleration_over(axis.machine, apart, jerk_time)
            candidate = _candidate(
                axis,
                name=f"{name}, v/a = {_periods(max(n, 1))} of {mode.name}",
                jerk_time=jerk_time,
                acceleration=acceleration,
                bound_by="second zero",
            )
            if acceleration <= by_force and candidate.residual_deviation <= axis.band:
                found.append(candidate)
    return found


def _shortest_distance(machine: Machine, acceleration: float, jerk_time: float) -> float:
    """Least v/a of a motion within the force, at least t_j [s]."""
    limits = MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
    return max(jerk_time, *(averages(move, limits)[1] for move in machine.moves))


def _candidate(
    axis: AxisEstimate, *, name: str, jerk_time: float, acceleration: float, bound_by: str
) -> RuleCandidate:
    limits = MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
    servo = servo_parts(axis, jerk_time)
    moves = axis.machine.moves
    return RuleCandidate(
        name=name,
        limits=limits,
        bound_by=bound_by,
        duration=max(duration(move, limits) for move in moves),
        residual_deviation=limits.jerk
        * max(hypot(*servo, *vibrations(axis, averages(move, limits))) for move in moves),
    )


def _acceleration_over(machine: Machine, apart: float, jerk_time: float) -> float:
    """Largest acceleration at which every move has v/a of at least so much [m/s²].

    With v/a = t_j the acceleration is just reached.
    """

    def of(move: Move) -> float:
        if isinstance(move, VelocityStep):
            return move.velocity_step / apart
        return min(move.max_velocity / apart, move.distance / (apart * (apart + jerk_time)))

    return REACHED * min(of(move) for move in machine.moves)


def _jerk_limited_time(axis: AxisEstimate) -> float:
    """Jerk time at which the band holds whatever the phases: every ramp counts twice a step."""
    largest = force_acceleration(axis, inf)
    worst = [axis.servo.compliance, axis.servo.missing * axis.servo.ramp_drag]
    worst += [2.0 * mode.compliance * echo(axis.machine, mode, largest) for mode in axis.modes]
    jerk = axis.band / hypot(*worst)
    times = [largest / jerk]
    for move in axis.machine.moves:
        if isinstance(move, VelocityStep):
            times.append(sqrt(move.velocity_step / jerk))
        else:
            times.append(sqrt(move.max_velocity / jerk))
            times.append((move.distance / (2.0 * jerk)) ** (1.0 / 3.0))
    return min(times)


def _hand_calculation(axis: AxisEstimate, best: RuleCandidate) -> tuple[RuleStep, ...]:
    controller, limits = axis.controller, best.limits
    drag = servo_parts(axis, limits.jerk_time)[1]
    omega_v = controller.velocity_gain / controller.feedforward_mass
    lines = [
        ("speed loop omega_v", "Kp / m", omega_v, "1/s"),
        (
            "servo compliance c_S",
            "(max(0.4 T^2, 0.18 T_p^2) + 0.8 sum m c/omega^2) / omega_v + T_v/(2 Kv^2)",
            axis.servo.compliance,
            "s^3",
        ),
        ("unknown share of the mass eps", "|m_ff - m| / m", axis.servo.missing, "1"),
        (
            "payload compliance c_P",
            "eps min(Tn/(omega_v Kv), 1.3 t_j/(omega_v (Kv + 1/Tn)))",
            drag,
            "s^3",
        ),
    ]
    slowest = max(axis.machine.moves, key=lambda move: duration(move, limits))
    left = vibrations(axis, averages(slowest, limits))
    for mode, vibration in zip(axis.modes, left, strict=True):
        lines.append(
            (f"compliance c of mode {mode.name}", "m |g| / omega^3", mode.compliance, "s^3")
        )
        share = vibration / mode.compliance if mode.compliance else 0.0
        lines.append(
            (f"vibration V of mode {mode.name}", "R(f t_j) R(f v/a) [R(f L/v)]", share, "1")
        )
    by_force = force_acceleration(axis, limits.jerk_time)
    lines.append(("jerk time t_j", best.name, limits.jerk_time, "s"))
    lines.append(("acceleration within the force", "see the formula", by_force, "m/s^2"))
    lines.append(("acceleration a", f"bound by {best.bound_by}", limits.acceleration, "m/s^2"))
    lines.append(("jerk j", "a / t_j", limits.jerk, "m/s^3"))
    lines.append(
        ("predicted residual", "j root(c_S^2 + c_P^2 + sum (c V)^2)", best.residual_deviation, "m")
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
