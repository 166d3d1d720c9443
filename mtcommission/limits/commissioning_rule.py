"""The commissioning rule: average, jerk and acceleration for every move, with a pocket calculator.

In one sentence: average one period of the softest mode, let the band set the jerk, and the force
the acceleration. With every size of move the times between the ramps take every value, so no ramp
can be relied on to cancel another. Derived, fitted, validated in ``docs/commissioning-rule.md``:

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

from collections.abc import Sequence
from dataclasses import dataclass
from math import cbrt, exp, floor, hypot, inf, isfinite, pi, sin, sqrt

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import MOVING_AVERAGE, Jerk
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, corners, moving_mass, vary
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant, PlantMode
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import jerk_steps

LAG_SHARE, HOLD_SHARE = 0.4, 0.18
"""Following-error transient of a jerk step behind a force lag, times ω_v/(j T²), and of the hold of
the position cycle, times ω_v/(j T_p²) (fitted, see the docs)."""

DEFLECTION_SHARE = 0.8
"""The same for the encoder's share in the static deflection, times ω_v ω²/(j m c) (two thirds
to one of the peak of the loop's impulse response, as for the lag)."""

ALL_STEPS, SMOOTHED = 2.4, 6.0
"""Following-error transient of the worst of all sizes over that of one jerk step (2.1 computed for
Kv = ω_v/4, Kv Tn = 1; sampled loops leave up to an eighth more, see the docs), and behind a moving
average, times ω_v T_F; what is less counts (computed likewise)."""

FORCE_RESERVE, RESERVE = 1.17, 1.25
"""Factors on the inertial force for what the loop adds (fitted: exceeded by 1 % of machines), and
on the estimated residual (fitted, see the docs)."""

REACHED = 0.999
"""Share of the acceleration at which the phase of constant acceleration vanishes: on that
border itself the generator's arithmetic is degenerate."""

JERK_SHARE = 0.5
"""Of the force that the jerk may take where it is fed forward (design choice)."""

MOST_SEEN = 1.0
"""Largest m c of a mode that was tried: beyond it the held encoder is much too careful."""

DESCRIPTION, ADVICE = Message("rule-description"), Message("rule-advice")
VALIDITY = Message("rule-validity")
"""The rule in words, what to try, and where it holds."""

TOGETHER = "√(C_S² + C_P² + Σ (2 n C_i W_i)²)"
"""Sensitivity of servo, payload and modes together [s³]."""

PASSED = "R(f T_F)/(ω T_F)"
"""What a moving average passes of a mode."""

FORMULAS: tuple[tuple[str, Message | None], ...] = (
    (f"1.25 j {TOGETHER} ≤ band", None),
    ("C_i = m |g_i|/ω_i³", None),
    (f"W = {PASSED}", Message("rule-within-the-spread")),
    ("R(x) = |1 − exp(2 π x (i − ζ))|", None),
    ("a (1.17 m + Kp T_p/2) + Kp Σ (m c_i/ω_i) min(a, 2 j/ω_i) ≤ F", None),
    ("a ≤ √(v j)", None),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleFormula:
    """One of the rule's formulas."""

    text: str  # in the field's signs, e.g. "a ≤ √(v j)"; "_" begins an index
    aside: Message | None = None  # where it holds; None: everywhere


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStep:
    """One line of the hand calculation."""

    name: Message  # what is computed
    formula: Message | str
    value: float | None  # None: no bound
    unit: str  # SI unit of ``value``


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """A setpoint filter, or none, with the jerk and the acceleration that go with it."""

    name: Message  # which filter
    limits: MotionLimits  # acceleration, jerk, and the filter where it is the rule's to choose
    average: float  # length T_F of the moving average [s]; 0: none
    allowed_jerk: float  # what the band allows, however short the ramp is [m/s³]
    by_force: float  # what the force allows at that jerk [m/s²]
    bound_by: Message  # what bounds the acceleration: the force, or what a move just reaches
    duration: float  # of the slowest move, filter included, t_e [s]
    residual_deviation: float  # predicted by the rule, worst size and corner [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleResult:
    """The rule applied to a machine."""

    best: Tried  # what has the shortest motion
    tried: tuple[Tried, ...]
    predicted_settling_time: float  # t_e + τ of the slowest move [s]
    formulas: tuple[RuleFormula, ...]
    steps: tuple[RuleStep, ...]  # the hand calculation, in order
    warnings: tuple[Message, ...]  # why it may not hold here; empty where it is valid

    @property
    def limits(self) -> MotionLimits:
        """Acceleration, jerk and filter that the rule gives."""
        return self.best.limits


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeEstimate:
    """A mode as the formulas need it."""

    name: str
    low_hz: float  # of what the closed loop rings with: encoder held still, and the spread [Hz]
    high_hz: float  # [Hz]
    damping: float  # least damping ratio [-]
    jerk_sensitivity: float  # m |g|/ω³ at the lower end, deviation per jerk step [s³]

    @property
    def middle_hz(self) -> float:
        """Middle of what it may ring with [Hz]: an average of that period serves both ends."""
        return 0.5 * (self.low_hz + self.high_hz)


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoEstimate:
    """The following-error transient of the servo."""

    speed: float  # ω_v = Kp/m with the largest mass [1/s]
    impulse: float  # acceleration that the feed-forward misses, times time, per jerk step [s²]
    missing: float  # largest share of the force that the feed-forward does not know [-]
    drag: float  # deviation per jerk by it [s³]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisEstimate:
    """An axis with all numbers that the formulas need, nominal."""

    machine: Machine
    plant: Plant
    controller: Controller  # the gains of its loop
    modes: tuple[ModeEstimate, ...]
    servo: ServoEstimate


def apply_commissioning_rule(machine: Machine, tuned: TunedLoop) -> RuleResult:
    """Return limits and filter by the rule, from the gains of a loop, with the hand calculation.

    >>> from mtcommission.loop.tuning.tuning import tune_loop
    >>> from mtcommission.machine.profile.shipped import read_shipped
    >>> machine = read_shipped("modal-two-modes").machine
    >>> found = apply_commissioning_rule(machine, tune_loop(machine))
    >>> found.best.residual_deviation <= machine.requirements.tcp_deviation
    True
    """
    axis = estimate_axis(machine, tuned.plant, tuned.controller)
    tried = tuple(_try_filter(axis, item) for item in _filters(axis))
    best = min(tried, key=lambda item: item.duration)
    return RuleResult(
        best=best,
        tried=tried,
        predicted_settling_time=best.duration + tuned.controller.reference_delay,
        formulas=formulas_for(machine.moves),
        steps=_calculate_by_hand(axis, best),
        warnings=_warn_outside_validity(axis),
    )


def estimate_axis(machine: Machine, plant: Plant, controller: Controller) -> AxisEstimate:
    """Return the numbers behind the formulas for one nominal axis."""
    return AxisEstimate(
        machine=machine,
        plant=plant,
        controller=controller,
        modes=tuple(_mode_numbers(machine, controller, mode) for mode in plant.modes),
        servo=_servo_numbers(machine, plant, controller),
    )


def _mode_numbers(machine: Machine, controller: Controller, mode: PlantMode) -> ModeEstimate:
    """A loop that holds the encoder still lowers what it sees by sqrt(1 + m c)."""
    needs, omega, m = machine.requirements, mode.natural_frequency, controller.feedforward_mass
    held = min(1.0, controller.velocity_gain / m / omega)
    seen = 1.0 + m * abs(mode.measured_gain) * held
    low_hz = mode.frequency_hz * (1.0 - needs.frequency_spread) / sqrt(seen)
    gain = max(abs(mode.tcp_gain), abs(mode.tcp_gain - mode.measured_gain))
    return ModeEstimate(
        name=mode.name,
        low_hz=low_hz,
        high_hz=mode.frequency_hz * (1.0 + needs.frequency_spread),
        damping=mode.damping_ratio * (1.0 - needs.damping_spread),
        jerk_sensitivity=m * gain / (2.0 * pi * low_hz) ** 3,
    )


def _servo_numbers(machine: Machine, plant: Plant, controller: Controller) -> ServoEstimate:
    if controller.follows:
        return ServoEstimate(speed=inf, impulse=0.0, missing=0.0, drag=0.0)
    m, Kv, Tn = controller.feedforward_mass, controller.position_gain, controller.integral_time
    masses = _masses_in_corners(machine)
    omega_v = controller.velocity_gain / max(masses)
    left = 1.0 - controller.jerk_feedforward
    lag = controller.force_lag + sum(item.delay for item in controller.force_filters)
    seen = sum(m * abs(mode.measured_gain) / mode.natural_frequency**2 for mode in plant.modes)
    transient = max(
        LAG_SHARE * left * (2.0 - left) * lag**2, HOLD_SHARE * controller.position_cycle**2
    )
    pushed = controller.acceleration_feedforward * m
    missing = max(abs(pushed - mass) / mass for mass in masses)
    return ServoEstimate(
        speed=omega_v,
        impulse=transient + DEFLECTION_SHARE * seen,
        missing=missing,
        drag=missing * Tn / (omega_v * Kv),
    )


def _masses_in_corners(machine: Machine) -> list[float]:
    return [moving_mass(vary(machine, corner)) for corner in corners(machine)]


def ramp_vibration(cycles: float, *, damping: float, spread: float) -> float:
    """Return the vibration after two equal and opposite pushes, in units of one push's, 0 ... 2.

    |1 - exp(p t)| with the eigenfrequency anywhere within its spread: an upper bound, exact
    without damping or without spread. ``cycles``: f t, time between the pushes in periods [-].

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


def servo_sensitivity(axis: AxisEstimate, average: float) -> float:
    """Return C_S of the servo, deviation per jerk after the worst size, behind an average [s³]."""
    servo = axis.servo
    passed = min(ALL_STEPS, SMOOTHED / (servo.speed * average)) if average else ALL_STEPS
    return servo.impulse * passed / servo.speed


def passed_by_average(mode: ModeEstimate, average: float) -> float:
    """Return the share of a mode's vibration behind an average, worst within its range [-]."""
    if not average:
        return 1.0
    middle = mode.middle_hz
    left = ramp_vibration(
        middle * average, damping=mode.damping, spread=(mode.high_hz - middle) / middle
    )
    return min(1.0, left / (2.0 * pi * mode.low_hz * average))


def count_ramps(moves: Sequence[Move]) -> int:
    """Return how many ramps of acceleration the longest of some moves consists of."""
    return 2 if all(isinstance(move, VelocityStep) for move in moves) else 4


def force_acceleration(axis: AxisEstimate, jerk: float) -> float:
    """Return the largest acceleration within the force [m/s²]: inertia, velocity ripple and modes.

    The velocity setpoint is held for T_p, so it is off by a T_p/2, and a visible mode adds its
    rate, that of a step of the acceleration or of two of the jerk; Kp answers both.
    """
    machine, controller = axis.machine, axis.controller
    m, Kp = controller.feedforward_mass, controller.velocity_gain
    inertia = FORCE_RESERVE * max(*_masses_in_corners(machine), m)
    inertia += Kp * controller.position_cycle / 2.0
    force = machine.drive.motion_force - _jerk_force(controller) * jerk
    largest = force / inertia
    omega = np.array([mode.natural_frequency for mode in axis.plant.modes])
    omega *= 1.0 - machine.requirements.frequency_spread
    push = Kp * m * np.abs([mode.measured_gain for mode in axis.plant.modes]) / omega
    # The force rises with a in straight lines, bent where steps of the jerk push less.
    a = np.unique([0.0, *np.minimum(2.0 * jerk / omega, largest), largest])
    used = inertia * a + np.minimum(a[:, None], 2.0 * jerk / omega) @ push
    return float(np.interp(force, used, a))


def _jerk_force(controller: Controller) -> float:
    """Force that is fed forward per jerk [N/(m/s³)]."""
    return controller.jerk_feedforward * controller.feedforward_mass * controller.force_lag


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
    if fed := _jerk_force(axis.controller):
        jerk = min(jerk, JERK_SHARE * axis.machine.drive.motion_force / fed)
    bounds = {
        "rule-force": force_acceleration(axis, jerk),
        # Those of several moves that do not reach the largest have the same jerk.
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
    a, j = np.array([limits.acceleration]), np.array([limits.jerk])
    longest = max(float(jerk_steps(one, acceleration=a, jerk=j).duration[0]) for one in moves)
    return Tried(
        name=Message("rule-average", time=average) if average else Message("rule-no-average"),
        limits=limits,
        average=average,
        allowed_jerk=jerk,
        by_force=bounds["rule-force"],
        bound_by=Message(bound_by),
        duration=longest + (item.duration if item else 0.0),
        residual_deviation=limits.jerk * hypot(*parts),
    )


def _reach(move: Move, jerk: float) -> float:
    """Largest acceleration that a move reaches with ramps of this jerk [m/s²]."""
    if isinstance(move, VelocityStep):
        return REACHED * sqrt(move.velocity_step * jerk)
    return REACHED * min(sqrt(move.max_velocity * jerk), cbrt(move.distance * jerk**2 / 2.0))


def formulas_for(moves: Sequence[Move]) -> tuple[RuleFormula, ...]:
    """Return the rule's formulas for some moves, with the distance where one is positioning."""
    found = list(FORMULAS)
    if not all(isinstance(move, VelocityStep) for move in moves):
        found.append(("2 a³ ≤ L j²", Message("rule-for-positioning")))
    return tuple(RuleFormula(text=text, aside=aside) for text, aside in found)


def _calculate_by_hand(axis: AxisEstimate, found: Tried) -> tuple[RuleStep, ...]:
    """The calculation of what the rule found for an axis, in order."""
    average, limits = found.average, found.limits
    swing = "min(2.4, 6/(ω_v T_F))" if average else "2.4"
    servo = f"(max(0.4 T², 0.18 T_p²) + 0.8 Σ m c_i/ω_i²) {swing}/ω_v"
    lines: list[tuple[Message, Message | str, float, str]] = [
        (Message("rule-ramps"), Message("rule-by-moves"), count_ramps(axis.machine.moves), "1"),
        (Message("rule-average-length"), found.name, average, "s"),
        (Message("rule-speed-loop"), "Kp/m", axis.servo.speed, "1/s"),
        (Message("rule-servo-sensitivity"), servo, servo_sensitivity(axis, average), "s^3"),
        (Message("rule-unknown-mass"), "|m_ff − m|/m", axis.servo.missing, "1"),
        (Message("rule-payload-sensitivity"), "ε Tn/(ω_v Kv)", axis.servo.drag, "s^3"),
    ]
    lowest = "f (1 − s)/√(1 + m |c| min(1, ω_v/ω))"
    share = PASSED if average else Message("rule-no-average")
    for mode in axis.modes:
        name, passed = mode.name, passed_by_average(mode, average)
        sensitivity = Message("rule-mode-sensitivity", mode=name)
        lines += [
            (Message("rule-mode-lowest", mode=name), lowest, mode.low_hz, "Hz"),
            (sensitivity, "m |g|/ω³", mode.jerk_sensitivity, "s^3"),
            (Message("rule-mode-passed", mode=name), share, passed, "1"),
        ]
    by_band = f"band/(1.25 {TOGETHER})"
    if axis.controller.jerk_feedforward:
        by_band = f"min({by_band}, F/(2 m T))"
    force, bound = Message("rule-see-formula"), Message("rule-bound-by", what=found.bound_by)
    lines += [
        (Message("rule-allowed-jerk"), by_band, found.allowed_jerk, "m/s^3"),
        (Message("rule-force-acceleration"), force, found.by_force, "m/s^2"),
        (Message("rule-acceleration"), bound, limits.acceleration, "m/s^2"),
        (Message("rule-jerk-time"), "max(a/j, T_p)", limits.jerk_time, "s"),
        (Message("rule-jerk"), "a/t_j", limits.jerk, "m/s^3"),
        (Message("rule-residual"), f"j {TOGETHER}", found.residual_deviation, "m"),
    ]
    return tuple(
        RuleStep(name=name, formula=formula, value=value if isfinite(value) else None, unit=unit)
        for name, formula, value, unit in lines
    )


def _warn_outside_validity(axis: AxisEstimate) -> tuple[Message, ...]:
    machine, controller = axis.machine, axis.controller
    needs, control = machine.requirements, machine.control
    item, delay = control.setpoint_filter, control.reference_delay
    outside = {
        "rule-needs-velocity-feedforward": controller.velocity_feedforward != 1.0,
        "rule-needs-automatic-delay": delay is not None,
        "rule-knows-averages-only": item is not None and item.kind != MOVING_AVERAGE,
        "rule-needs-jerk-limit": control.kind.jerk is Jerk.NONE,
        "rule-knows-no-peaks": bool(needs.peaks)
        or min(machine.drive.continuous_force, needs.contour_deviation) < inf,
    }
    found = [Message(kind) for kind, is_so in outside.items() if is_so]
    for mode in axis.plant.modes:
        share = controller.feedforward_mass * abs(mode.measured_gain)
        if share > MOST_SEEN:
            found.append(Message("rule-careful-with-seen-mode", mode=mode.name, share=share))
    return tuple(found)
