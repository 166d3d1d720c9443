"""What a setpoint leaves on an axis and what force it takes, by formulas without simulation.

The deviation of the tool after the end of a setpoint, per jerk, in parts:

- each mode: m |g|/ω³ times R = |1 - exp(p t_j)| of the last ramp times the echo of the others,
- the servo: the lag and hold of the feed-forward force and the share of the modes that the
  encoder sees, divided by ω_v = Kp/m,
- the mass that the feed-forward does not know.

Derived, fitted and validated in ``docs/commissioning-rule.md``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, floor, pi, sin, sqrt

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

RAMP_SHARE = 1.5
"""Following-error transient of a whole ramp over that of one of its two jerk steps: the second one
meets the swing that the first has left (fitted, see the docs)."""

PULL_SHARE = 1.0
"""Widening of a visible mode's spread over m c: its frequency falls by up to half of that where
the loop holds the encoder still, the rest stands for the damping that the loop takes away
(fitted, see the docs)."""

OVERSHOOT = 1.3
"""Peak deviation after a step of missing force over its value without overshoot (fitted)."""

FORCE_RESERVE = 1.17
"""Factor on the inertial force for what the loop adds (fitted: exceeded by 1 % of machines)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeEstimate:
    """A mode as the formulas need it.

    Parameters
    ----------
    name
        Identifier.
    frequency_hz
        Of the plant [Hz].
    spread
        Relative uncertainty of the frequency that the closed loop rings with [-].
    damping
        Least damping ratio [-].
    jerk_sensitivity
        m |g|/ω³, deviation per jerk step [s³].
    """

    name: str
    frequency_hz: float
    spread: float
    damping: float
    jerk_sensitivity: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoEstimate:
    """The following-error transient of the servo.

    Parameters
    ----------
    jerk_sensitivity
        Deviation per jerk, after a ramp that is long for the velocity loop [s³].
    impulse
        Deviation per jerk and jerk time after a short one, whose two steps nearly cancel [s²];
        the smaller of both counts.
    missing
        Largest share of the force that the feed-forward does not know [-].
    ramp_drag, step_drag
        Deviation per missing share and per jerk [s³], or per acceleration [s²]; the smaller
        of both counts.
    """

    jerk_sensitivity: float
    impulse: float
    missing: float
    ramp_drag: float
    step_drag: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisEstimate:
    """An axis with all numbers that the formulas need.

    Parameters
    ----------
    machine, plant, controller
        Nominal machine, its plant, and the gains of its loop.
    modes, servo
        See the classes.
    """

    machine: Machine
    plant: Plant
    controller: Controller
    modes: tuple[ModeEstimate, ...]
    servo: ServoEstimate

    @property
    def band(self) -> float:
        """Allowed deviation [m]."""
        return self.machine.requirements.tcp_deviation


def estimate_axis(machine: Machine, plant: Plant, controller: Controller) -> AxisEstimate:
    """Return the numbers behind the formulas for one axis.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    controller
        Its gains.

    Returns
    -------
    AxisEstimate
    """
    return AxisEstimate(
        machine=machine,
        plant=plant,
        controller=controller,
        modes=tuple(_mode_numbers(machine, controller, mode) for mode in plant.modes),
        servo=_servo_numbers(machine, plant, controller),
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


def _mode_numbers(machine: Machine, controller: Controller, mode: PlantMode) -> ModeEstimate:
    """The loop pulls a visible mode down and takes damping from it: its spread is widened."""
    omega, m = mode.natural_frequency, controller.feedforward_mass
    omega_v = controller.velocity_gain / m
    pull = PULL_SHARE * m * abs(mode.measured_gain) * min(1.0, omega_v / omega)
    spread = machine.requirements.frequency_spread
    gain = max(abs(mode.tcp_gain), abs(mode.tcp_gain - mode.measured_gain))
    return ModeEstimate(
        name=mode.name,
        frequency_hz=mode.frequency_hz,
        spread=min(spread + pull, 0.5),
        damping=mode.damping_ratio * (1.0 - machine.requirements.damping_spread),
        jerk_sensitivity=m * gain / (omega * (1.0 - spread)) ** 3,
    )


def _servo_numbers(machine: Machine, plant: Plant, controller: Controller) -> ServoEstimate:
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
    return ServoEstimate(
        jerk_sensitivity=RAMP_SHARE * (transient + DEFLECTION_SHARE * seen) / omega_v,
        impulse=transient + DEFLECTION_SHARE * seen,
        missing=max(abs(pushed - mass) / mass for mass in masses),
        ramp_drag=Tn / (omega_v * Kv),
        step_drag=OVERSHOOT / (omega_v * (Kv + 1.0 / Tn)),
    )


def masses_in_corners(machine: Machine) -> list[float]:
    """Return the moving mass in every corner [kg]."""
    return [moving_mass(vary(machine, corner)) for corner in corners(machine)]


def servo_parts(axis: AxisEstimate, jerk_time: float) -> list[float]:
    """Return the deviation per jerk by the servo and by the unknown mass.

    Parameters
    ----------
    axis
        The axis.
    jerk_time
        t_j [s].

    Returns
    -------
    list of float
        Two jerk sensitivities [s³].
    """
    servo = axis.servo
    drag = servo.missing * min(servo.ramp_drag, servo.step_drag * jerk_time)
    return [min(servo.jerk_sensitivity, servo.impulse * jerk_time), drag]


def vibrations(axis: AxisEstimate, jerk_time: float, *, largest: float) -> list[float]:
    """Return the vibration of each mode after a setpoint, per jerk.

    Parameters
    ----------
    axis
        The axis.
    jerk_time
        t_j [s].
    largest
        Acceleration that the setpoint does not exceed [m/s²].

    Returns
    -------
    list of float
        m |g|/ω³ R(f t_j) times the echo of the earlier ramps [s³].
    """
    return [
        mode.jerk_sensitivity
        * ramp_vibration(mode.frequency_hz * jerk_time, damping=mode.damping, spread=mode.spread)
        * echo(axis.machine, mode, largest)
        for mode in axis.modes
    ]


def duration(move: Move, limits: MotionLimits) -> float:
    """Return the end t_e of a setpoint [s].

    Parameters
    ----------
    move
        Velocity step or positioning.
    limits
        Acceleration and jerk.

    Returns
    -------
    float
    """
    steps = jerk_steps(
        move, acceleration=np.array([limits.acceleration]), jerk=np.array([limits.jerk])
    )
    return float(steps.duration[0])


def force_acceleration(axis: AxisEstimate, jerk_time: float) -> float:
    """Return the largest acceleration within the force: inertia, velocity ripple and modes.

    The velocity setpoint is held for T_p, so it is off by a T_p/2, and a visible mode adds its
    rate; the velocity controller answers both with Kp.

    Parameters
    ----------
    axis
        The axis.
    jerk_time
        t_j [s]; inf is allowed.

    Returns
    -------
    float
        a [m/s²].
    """
    machine, controller = axis.machine, axis.controller
    m, Kp = controller.feedforward_mass, controller.velocity_gain
    rates = 0.0
    for mode in axis.plant.modes:
        omega = mode.natural_frequency * (1.0 - machine.requirements.frequency_spread)
        rates += m * abs(mode.measured_gain) / omega * min(1.0, 2.0 / (omega * jerk_time))
    inertia = FORCE_RESERVE * max(*masses_in_corners(machine), m)
    inertia += controller.jerk_feedforward * m * controller.force_lag / jerk_time
    return machine.drive.motion_force / (inertia + Kp * (controller.position_cycle / 2.0 + rates))


def echo(machine: Machine, mode: ModeEstimate, largest: float) -> float:
    """Return what the earlier ramps of a motion add to the last one's vibration, 1 ... 4 [-].

    They came at least v/a (and L/v) earlier and have decayed since; their phase is left open.

    Parameters
    ----------
    machine
        Its moves count.
    mode
        The mode.
    largest
        Acceleration that none of the candidates exceeds [m/s²].

    Returns
    -------
    float
    """
    rate = 2.0 * pi * mode.frequency_hz * (1.0 - mode.spread) * mode.damping

    def of(move: Move) -> float:
        if isinstance(move, VelocityStep):
            return 1.0 + exp(-rate * move.velocity_step / largest)
        velocity = min(move.max_velocity, sqrt(largest * move.distance))
        return (1.0 + exp(-rate * velocity / largest)) * (
            1.0 + exp(-rate * move.distance / velocity)
        )

    return max(of(move) for move in machine.moves)
