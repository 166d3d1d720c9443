"""The commissioning rule: acceleration and jerk with a pocket calculator.

Three facts carry it (derivation and validation: ``docs/commissioning-rule.md``):

1. Every jerk step j leaves a vibration of amplitude j m |g|/ω³ in a mode; a ramp of length t_j
   begins and ends with one, so it leaves the fraction |1 - exp(p t_j)|, which is small only
   near whole periods.
2. The same steps leave a servo tail j c_S, because the feed-forward force comes through a lag,
   the encoder sees the modes, and the payload is not known. It has no zeros.
3. Both are proportional to a at a given t_j. So each candidate t_j has one largest a, by force,
   by reach, or by the band, and the candidate with the shortest motion wins.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, floor, inf, pi, sin, sqrt

from mtcommission.limits import MotionLimits
from mtcommission.loop.controller import Controller, filter_delay
from mtcommission.loop.tuning import TunedLoop
from mtcommission.machine import Machine, Move, VelocityStep, corners, moving_mass, vary
from mtcommission.plant import Plant, PlantMode
from mtcommission.setpoint import plan_setpoint

LAG_SHARE = 0.4
"""Servo tail of a jerk step behind a force lag, times ω_v/(j T²) (fitted, see the docs)."""

HOLD_SHARE = 0.18
"""The same for the hold of the position cycle, times ω_v/(j T_p²) (fitted, see the docs)."""

DEFLECTION_SHARE = 0.8
"""The same for the encoder's share in the static deflection, times ω_v ω²/(j m c) (two thirds
to one of the peak of the loop's impulse response, as for the lag)."""

OVERSHOOT = 1.3
"""Peak deviation after a step of missing force over its value without overshoot (fitted)."""

EARLY_CYCLES = 0.5
"""By how many velocity cycles the held velocity setpoint is compared too early: its hold is
sampled at the velocity cycle, so it delays by (T_p - T_v)/2."""

FORCE_RESERVE = 1.1
"""Factor on the inertial force for what the loop adds (fitted: exceeded by 1 % of machines)."""

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
        ``force``, ``reach`` or ``band``.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class _ModeNumbers:
    """A mode as the hand calculation needs it: f [Hz], spread and ζ [-], compliance [s³]."""

    name: str
    frequency_hz: float
    spread: float
    damping: float
    compliance: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _ServoNumbers:
    """Tail of a jerk step [s³], missing share of force [-], and what each [1] of it costs.

    ``ramp_drag`` [s³] counts per jerk, ``step_drag`` [s²] per acceleration; the smaller holds.
    """

    compliance: float
    missing: float
    ramp_drag: float
    step_drag: float


FORMULA = (
    "t_j: one to three periods of each mode, or as short as e = j c allows without cancelling; "
    "a = min(F / (1.1 m + Kp (T_p/2 + sum m c_i/omega_i min(1, 2/(omega_i t_j)))), v/t_j, "
    "e t_j / (c_S + sum c_i V_i(t_j))); j = a/t_j; take the t_j with the shortest motion."
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
    modes = tuple(_mode_numbers(machine, controller, mode) for mode in plant.modes)
    servo = _servo_numbers(machine, plant, controller)
    candidates = _candidates(machine, plant, controller, modes, servo)
    best = min(candidates, key=lambda item: item.duration)
    return RuleResult(
        limits=best.limits,
        chosen=best.name,
        bound_by=best.bound_by,
        predicted_settling_time=best.duration + controller.reference_delay,
        predicted_residual=best.residual_deviation,
        steps=_hand_calculation(machine, plant, controller, modes, servo, best),
        candidates=candidates,
        formula=FORMULA,
        validity=VALIDITY,
        warnings=_warnings(machine, controller),
    )


def ramp_vibration(cycles: float, *, damping: float, spread: float) -> float:
    """Return the vibration that one acceleration ramp leaves, in units of one jerk step's.

    |1 - exp(p t_j)| with the eigenfrequency anywhere within its spread: an upper bound, exact
    without damping or without spread.

    Parameters
    ----------
    cycles
        f t_j, length of the ramp in periods of the mode [-].
    damping
        ζ [-].
    spread
        Relative uncertainty of f [-].

    Returns
    -------
    float
        0 ... 2.

    Source: rule 2 of the residual of one ramp; ``docs/commissioning-rule.md``, eq. (3).

    Examples
    --------
    >>> [round(ramp_vibration(x, damping=0.0, spread=0.0), 3) for x in (0.5, 0.75, 1.0)]
    [2.0, 1.414, 0.0]
    >>> round(ramp_vibration(1.0, damping=0.02, spread=0.05), 3)
    0.32
    """
    low, high = cycles * (1.0 - spread), cycles * (1.0 + spread)
    spans_peak = floor(high - 0.5) > floor(low - 0.5)
    swing = 2.0 if spans_peak else 2.0 * max(abs(sin(pi * low)), abs(sin(pi * high)))
    longest, shortest = exp(-2.0 * pi * damping * low), exp(-2.0 * pi * damping * high)
    return min(1.0 + longest, sqrt((1.0 - shortest) ** 2 + longest * swing**2))


def _mode_numbers(machine: Machine, controller: Controller, mode: PlantMode) -> _ModeNumbers:
    """A visible mode is pulled down by the loop, by μ/2 where the loop holds the encoder still."""
    omega, m = mode.natural_frequency, controller.feedforward_mass
    omega_v = controller.velocity_gain / m
    pull = 0.5 * m * abs(mode.measured_gain) * min(1.0, omega_v / omega)
    spread = machine.requirements.frequency_spread
    gain = max(abs(mode.tcp_gain), abs(mode.tcp_gain - mode.measured_gain))
    return _ModeNumbers(
        name=mode.name,
        frequency_hz=mode.frequency_hz,
        spread=min(spread + pull, 0.5),
        damping=mode.damping_ratio * (1.0 - machine.requirements.damping_spread),
        compliance=m * gain / (omega * (1.0 - spread)) ** 3,
    )


def _servo_numbers(machine: Machine, plant: Plant, controller: Controller) -> _ServoNumbers:
    m, Kv, Tn = controller.feedforward_mass, controller.position_gain, controller.integral_time
    masses = [moving_mass(vary(machine, corner)) for corner in corners(machine)]
    omega_v = controller.velocity_gain / max(masses)
    left = 1.0 - controller.jerk_feedforward
    lag = controller.force_lag + sum(filter_delay(item) for item in controller.force_filters)
    seen = sum(m * abs(mode.measured_gain) / mode.natural_frequency**2 for mode in plant.modes)
    tail = max(LAG_SHARE * left * (2.0 - left) * lag**2, HOLD_SHARE * controller.position_cycle**2)
    pushed = controller.acceleration_feedforward * m
    return _ServoNumbers(
        compliance=(tail + DEFLECTION_SHARE * seen) / omega_v
        + EARLY_CYCLES * controller.velocity_cycle / Kv**2,
        missing=max(abs(pushed - mass) / mass for mass in masses),
        ramp_drag=Tn / (omega_v * Kv),
        step_drag=OVERSHOOT / (omega_v * (Kv + 1.0 / Tn)),
    )


def _candidates(
    machine: Machine,
    plant: Plant,
    controller: Controller,
    modes: tuple[_ModeNumbers, ...],
    servo: _ServoNumbers,
) -> tuple[RuleCandidate, ...]:
    times = [("no cancelling", _jerk_limited_time(machine, plant, controller, modes, servo))]
    for mode in modes:
        for k in PERIODS:
            name = f"{k} period{'s' if k > 1 else ''} of mode {mode.name}"
            times.append((name, k / mode.frequency_hz))
    return tuple(
        _candidate(machine, plant, controller, modes, servo, name=name, jerk_time=time)
        for name, time in times
    )


def _candidate(
    machine: Machine,
    plant: Plant,
    controller: Controller,
    modes: tuple[_ModeNumbers, ...],
    servo: _ServoNumbers,
    *,
    name: str,
    jerk_time: float,
) -> RuleCandidate:
    by_force = _force_acceleration(machine, plant, controller, jerk_time)
    compliance = _compliance(machine, modes, servo, jerk_time=jerk_time, largest=by_force)
    bounds = {
        "force": by_force,
        "reach": min(_reach(move, jerk_time) for move in machine.moves),
        "band": machine.requirements.tcp_deviation * jerk_time / compliance,
    }
    bound_by = min(bounds, key=lambda key: bounds[key])
    acceleration = bounds[bound_by]
    limits = MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
    return RuleCandidate(
        name=name,
        limits=limits,
        bound_by=bound_by,
        duration=max(plan_setpoint(move, limits).duration for move in machine.moves),
        residual_deviation=limits.jerk * compliance,
    )


def _force_acceleration(
    machine: Machine, plant: Plant, controller: Controller, jerk_time: float
) -> float:
    """Largest acceleration within the force: inertia, ripple of the held velocity, modes.

    The velocity setpoint is held for T_p, so it is off by a T_p/2, and a visible mode adds its
    rate; the velocity controller answers both with Kp.
    """
    m, Kp = controller.feedforward_mass, controller.velocity_gain
    heaviest = max(moving_mass(vary(machine, corner)) for corner in corners(machine))
    rates = 0.0
    for mode in plant.modes:
        omega = mode.natural_frequency * (1.0 - machine.requirements.frequency_spread)
        rates += m * abs(mode.measured_gain) / omega * min(1.0, 2.0 / (omega * jerk_time))
    inertia = max(heaviest, m) * FORCE_RESERVE
    inertia += controller.jerk_feedforward * m * controller.force_lag / jerk_time
    return machine.drive.motion_force / (inertia + Kp * (controller.position_cycle / 2.0 + rates))


def _compliance(
    machine: Machine,
    modes: tuple[_ModeNumbers, ...],
    servo: _ServoNumbers,
    *,
    jerk_time: float,
    largest: float,
) -> float:
    """Residual deviation per jerk at a jerk time [s³]."""
    total = servo.compliance
    total += servo.missing * min(servo.ramp_drag, servo.step_drag * jerk_time)
    for mode in modes:
        ramp = ramp_vibration(
            mode.frequency_hz * jerk_time, damping=mode.damping, spread=mode.spread
        )
        total += mode.compliance * ramp * _echo(machine, mode, largest)
    return total


def _echo(machine: Machine, mode: _ModeNumbers, largest: float) -> float:
    """What the earlier ramps of a motion add to the last one's vibration, 1 ... 4 [-].

    They came at least v/a (and L/v) earlier and have decayed since; their phase is left open.
    """
    rate = 2.0 * pi * mode.frequency_hz * mode.damping

    def of(move: Move) -> float:
        if isinstance(move, VelocityStep):
            return 1.0 + exp(-rate * move.velocity_step / largest)
        velocity = min(move.max_velocity, sqrt(largest * move.distance))
        return (1.0 + exp(-rate * velocity / largest)) * (
            1.0 + exp(-rate * move.distance / velocity)
        )

    return max(of(move) for move in machine.moves)


def _reach(move: Move, jerk_time: float) -> float:
    """Largest acceleration that a move still reaches with ramps of this length [m/s²]."""
    if isinstance(move, VelocityStep):
        return move.velocity_step / jerk_time
    return min(move.max_velocity / jerk_time, move.distance / (2.0 * jerk_time**2))


def _jerk_limited_time(
    machine: Machine,
    plant: Plant,
    controller: Controller,
    modes: tuple[_ModeNumbers, ...],
    servo: _ServoNumbers,
) -> float:
    """Jerk time at which the band holds whatever the phases: every ramp counts twice a step."""
    largest = _force_acceleration(machine, plant, controller, inf)
    worst = servo.compliance + servo.missing * servo.ramp_drag
    worst += sum(2.0 * mode.compliance * _echo(machine, mode, largest) for mode in modes)
    jerk = machine.requirements.tcp_deviation / worst
    times = [largest / jerk]
    for move in machine.moves:
        if isinstance(move, VelocityStep):
            times.append(sqrt(move.velocity_step / jerk))
        else:
            times.append(sqrt(move.max_velocity / jerk))
            times.append((move.distance / (2.0 * jerk)) ** (1.0 / 3.0))
    return min(times)


def _hand_calculation(
    machine: Machine,
    plant: Plant,
    controller: Controller,
    modes: tuple[_ModeNumbers, ...],
    servo: _ServoNumbers,
    best: RuleCandidate,
) -> tuple[RuleStep, ...]:
    m, time = controller.feedforward_mass, best.limits.jerk_time
    lines = [
        ("speed loop omega_v", "Kp / m", controller.velocity_gain / m, "1/s"),
        (
            "servo compliance c_S",
            "(max(0.4 T^2, 0.18 T_p^2) + 0.8 sum m c/omega^2) / omega_v + T_v/(2 Kv^2)",
            servo.compliance,
            "s^3",
        ),
        ("unknown share of the mass eps", "|m_ff - m| / m", servo.missing, "1"),
        (
            "payload compliance",
            "eps min(Tn/(omega_v Kv), 1.3 t_j/(omega_v (Kv + 1/Tn)))",
            servo.missing * min(servo.ramp_drag, servo.step_drag * time),
            "s^3",
        ),
    ]
    largest = _force_acceleration(machine, plant, controller, time)
    for mode in modes:
        ramp = ramp_vibration(mode.frequency_hz * time, damping=mode.damping, spread=mode.spread)
        lines.append(
            (f"compliance c of mode {mode.name}", "m |g| / omega^3", mode.compliance, "s^3")
        )
        lines.append(
            (
                f"vibration V of mode {mode.name}",
                "|1 - exp(p t_j)| within the spread, x echo of the earlier ramps",
                ramp * _echo(machine, mode, largest),
                "1",
            )
        )
    lines.append(("jerk time t_j", best.name, time, "s"))
    lines.append(("acceleration by force", "see the rule's formula", largest, "m/s^2"))
    lines.append(("acceleration a", f"by {best.bound_by}", best.limits.acceleration, "m/s^2"))
    lines.append(("jerk j", "a / t_j", best.limits.jerk, "m/s^3"))
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
