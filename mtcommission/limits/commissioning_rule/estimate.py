"""What every smaller move leaves on an axis and what force it takes, without simulation.

With every size of move the times between the ramps take every value, so no ramp can be relied on
to cancel another: each adds its vibration, at worst twice that of one step of the jerk. What is
left is the jerk itself, and the setpoint filter, whose length stays the same. The deviation of the
tool, per jerk, in parts:

- each mode: m |g|/ω³, twice for each ramp, times what a moving average lets through,
- the servo: the lag and hold of the feed-forward force and the share of the modes that the
  encoder sees, divided by ω_v = Kp/m,
- the mass that the feed-forward does not know.

Derived, fitted and validated in ``docs/commissioning-rule.md``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, floor, inf, pi, sin, sqrt

import numpy as np

from mtcommission.loop.model.controller import Controller, filter_delay
from mtcommission.machine.machine import Machine, Move, VelocityStep, moving_mass
from mtcommission.machine.variations import corners, vary
from mtcommission.plant.plant import Plant, PlantMode
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import jerk_steps

LAG_SHARE = 0.4
"""Following-error transient of a jerk step behind a force lag, times ω_v/(j T²) (fitted, see the
docs)."""

HOLD_SHARE = 0.18
"""The same for the hold of the position cycle, times ω_v/(j T_p²) (fitted, see the docs)."""

DEFLECTION_SHARE = 0.8
"""The same for the encoder's share in the static deflection, times ω_v ω²/(j m c) (two thirds
to one of the peak of the loop's impulse response, as for the lag)."""

ALL_STEPS = 2.4
"""Following-error transient of the worst of all sizes over that of one jerk step (2.1 computed for
Kv = ω_v/4, Kv Tn = 1; sampled loops leave up to an eighth more, see the docs)."""

SMOOTHED = 6.0
"""The same behind a moving average, times ω_v T_F; what is less counts (computed likewise)."""

FORCE_RESERVE = 1.17
"""Factor on the inertial force for what the loop adds (fitted: exceeded by 1 % of machines)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeEstimate:
    """A mode as the formulas need it."""

    name: str
    low_hz: float
    """Lower end of what the closed loop rings with: encoder held still, and the spread [Hz]."""
    high_hz: float  # upper end [Hz]
    damping: float  # least damping ratio [-]
    jerk_sensitivity: float  # m |g|/ω³ at the lower end, deviation per jerk step [s³]

    @property
    def middle_hz(self) -> float:
        """Middle of what it may ring with [Hz]: an average of that period serves both ends."""
        return 0.5 * (self.low_hz + self.high_hz)


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoEstimate:
    """The following-error transient of the servo."""

    speed: float  # ω_v with the largest mass [1/s]
    impulse: float
    """Acceleration that the feed-forward misses, times time, per jerk of one step [s²]."""
    missing: float  # largest share of the force that the feed-forward does not know [-]
    drag: float  # deviation per jerk by it [s³]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisEstimate:
    """An axis with all numbers that the formulas need."""

    machine: Machine  # nominal
    plant: Plant
    controller: Controller  # the gains of its loop
    modes: tuple[ModeEstimate, ...]
    servo: ServoEstimate


def estimate_axis(machine: Machine, plant: Plant, controller: Controller) -> AxisEstimate:
    """Return the numbers behind the formulas for one axis.

    Machine and plant are nominal.
    """
    return AxisEstimate(
        machine=machine,
        plant=plant,
        controller=controller,
        modes=tuple(_mode_numbers(machine, controller, mode) for mode in plant.modes),
        servo=_servo_numbers(machine, plant, controller),
    )


def ramp_vibration(cycles: float, *, damping: float, spread: float) -> float:
    """Return the vibration after two equal and opposite pushes, in units of one push's.

    |1 - exp(p t)| with the eigenfrequency anywhere within its spread: an upper bound, exact
    without damping or without spread.

    It is 0 ... 2. ``cycles``: f t, time between the pushes in periods of the mode [-]; ``damping``:
    ζ [-]; ``spread``: relative uncertainty of f [-].

    Source: derived in ``docs/commissioning-rule.md``.

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
    masses = masses_in_corners(machine)
    omega_v = controller.velocity_gain / max(masses)
    left = 1.0 - controller.jerk_feedforward
    lag = controller.force_lag + sum(filter_delay(item) for item in controller.force_filters)
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


def masses_in_corners(machine: Machine) -> list[float]:
    """Return the moving mass in every corner [kg]."""
    return [moving_mass(vary(machine, corner)) for corner in corners(machine)]


def servo_sensitivity(axis: AxisEstimate, average: float) -> float:
    """Return the jerk sensitivity C_S of the servo, deviation per jerk after the worst size [s³].

    ``average``: length T_F of the moving average behind the setpoint, 0 for none [s].
    """
    servo = axis.servo
    passed = min(ALL_STEPS, SMOOTHED / (servo.speed * average)) if average else ALL_STEPS
    return servo.impulse * passed / servo.speed


def passed_by_average(mode: ModeEstimate, average: float) -> float:
    """Return the share of a mode's vibration behind a moving average, worst within its range.

    W = R(f T_F)/(ω T_F), at most 1 [-]; ``average``: length T_F, 0 for none [s].
    """
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


def duration(move: Move, limits: MotionLimits) -> float:
    """Return the end t_e of the setpoint of a move with these limits [s]."""
    steps = jerk_steps(
        move, acceleration=np.array([limits.acceleration]), jerk=np.array([limits.jerk])
    )
    return float(steps.duration[0])


def force_acceleration(axis: AxisEstimate, jerk: float) -> float:
    """Return the largest acceleration within the force [m/s²]: inertia, velocity ripple and modes.

    The velocity setpoint is held for T_p, so it is off by a T_p/2, and a visible mode adds its
    rate, that of a step of the acceleration or of two of the jerk; Kp answers both.

    ``jerk``: j [m/s³].
    """
    machine, controller = axis.machine, axis.controller
    m, Kp = controller.feedforward_mass, controller.velocity_gain
    inertia = FORCE_RESERVE * max(*masses_in_corners(machine), m)
    inertia += Kp * controller.position_cycle / 2.0
    force = machine.drive.motion_force - jerk_force(controller) * jerk
    largest = force / inertia
    modes = axis.plant.modes
    omega = (1.0 - machine.requirements.frequency_spread) * np.array(
        [mode.natural_frequency for mode in modes]
    )
    push = Kp * m * np.abs([mode.measured_gain for mode in modes]) / omega
    # The force rises with a in straight lines, bent where steps of the jerk push less.
    a = np.unique([0.0, *np.minimum(2.0 * jerk / omega, largest), largest])
    used = inertia * a + np.minimum(a[:, None], 2.0 * jerk / omega) @ push
    return float(np.interp(force, used, a))


def jerk_force(controller: Controller) -> float:
    """Return the force that is fed forward per jerk [N/(m/s³)]."""
    return controller.jerk_feedforward * controller.feedforward_mass * controller.force_lag
