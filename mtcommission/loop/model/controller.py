"""The cascade with every gain resolved: P position, PI velocity, feed-forward, state feedback."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import LOW_PASS, PositionLoop
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.plant.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observer:
    """Predicting observer at the velocity cycle, x̂⁺ = A x̂ + B F_set + L (y - C x̂)."""

    states: tuple[int, ...]  # indices of the n observed plant states
    A: Array  # (n, n)
    B: Array  # (n,)
    C: Array  # (n_sensors, n)
    L: Array  # (n, n_sensors)


NO_OBSERVER = Observer(
    states=(), A=np.zeros((0, 0)), B=np.zeros(0), C=np.zeros((0, 0)), L=np.zeros((0, 0))
)

INTERPOLATED = 2.0
"""How late a motion is that is interpolated between two setpoints, both of which must be known
[position cycles]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Controller:
    """All that the loop needs beside the plant."""

    position_loop: PositionLoop  # where it closes, and how the setpoint gets from cycle to cycle
    position_gain: float  # Kv [1/s]
    velocity_gain: float  # Kp [N s/m]
    integral_time: float  # Tn [s]
    reference_model_time: float = 0.0
    """Time constant of the first-order reference model through which the integral branch sees the
    position controller's output [s]; 0: none."""
    velocity_feedforward: float  # weights [-]
    acceleration_feedforward: float
    jerk_feedforward: float  # of feedforward_mass x force_lag x j_ref
    feedforward_mass: float  # [kg]
    force_lag: float  # [s]
    reference_delay: float  # τ [s]; at least ``handing_down_delay`` with the loop in the drive
    velocity_cycle: float  # T_v [s]
    cycles: int  # velocity cycles in one position cycle
    force_filters: tuple[ForceFilter, ...] = ()  # in the set-force path, in order
    sensors: tuple[str, ...] = ("encoder",)  # measured outputs of the plant, perhaps ``tcp``
    state_gains: Array  # K, set force per deviation of each plant state, (n_plant,) [N per unit]
    observer: Observer = NO_OBSERVER  # where K gets its states from
    follows: bool = False  # an open-loop axis: no loop, the motor follows the interpolated setpoint

    @property
    def position_cycle(self) -> float:
        """T_p [s]."""
        return self.cycles * self.velocity_cycle

    @property
    def handing_down_delay(self) -> float:
        """How old what the position cycle computes is, on average, when it is used [s].

        One position cycle of dead time, and then: held, T_p + (T_p - T_v)/2 as the velocity cycle
        samples it; interpolated, 2 T_p.
        """
        if self.position_loop is PositionLoop.CONTROL:
            return 0.5 * (3.0 * self.position_cycle - self.velocity_cycle)
        return INTERPOLATED * self.position_cycle

    @property
    def feedforward_delay(self) -> float:
        """The time after which the fed-forward force moves the axis: τ for "auto" [s].

        Handing down + 1.5 T_v (dead time and hold of the force) + (1 - jerk_feedforward) T + the
        low-frequency delay of the filters.
        """
        lag = (1.0 - self.jerk_feedforward) * self.force_lag
        filters = sum(item.delay for item in self.force_filters)
        return self.handing_down_delay + 1.5 * self.velocity_cycle + lag + filters

    @property
    def reference_age(self) -> float:
        """How long ago the setpoint was from which the wanted motion is taken [s].

        So that it is compared τ late, like the position; 0 where τ is shorter than the path.
        """
        return max(self.reference_delay - self.handing_down_delay, 0.0)

    @property
    def velocity_age(self) -> float:
        """How long ago the setpoint was from which a held velocity is taken [s].

        It is compared with a difference, which is half a velocity cycle late.
        """
        arrival = self.reference_delay + 0.5 * self.velocity_cycle
        return max(arrival - self.handing_down_delay, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class PathDelay:
    """What delays one path of the loop [s]."""

    path: Message
    setpoint_age: float  # how old the setpoint is that is taken
    dead_time: float  # whole cycles until it acts
    hold: float  # mean age of a held value
    lag: float  # first-order lags: drive, filters
    total: float


def list_delays(controller: Controller) -> list[PathDelay]:
    """Return which path carries which dead time."""
    T_p, T_v = controller.position_cycle, controller.velocity_cycle
    filters = sum(item.delay for item in controller.force_filters)
    left = (1.0 - controller.jerk_feedforward) * controller.force_lag
    held, half = 0.5 * (T_p - T_v), 0.5 * T_v
    # Interpolation between two setpoints waits for the second one.
    down = held if controller.position_loop is PositionLoop.CONTROL else T_p
    in_drive = controller.position_loop is PositionLoop.DRIVE
    position = (0.0, 0.0) if in_drive else (T_p, held)
    paths = {  # age of the setpoint, dead time, hold, lag
        "path-position-setpoint": (controller.reference_delay, 0.0, 0.0, 0.0),
        "path-position-controller": (0.0, *position, 0.0),
        "has-velocity-feedforward": (controller.velocity_age, T_p, down, 0.0),
        "path-wanted-state": (controller.reference_age, T_p, down, 0.0),
        "has-acceleration-feedforward": (0.0, T_p + T_v, down + half, left + filters),
        "path-velocity-controller": (half, T_v, half, controller.force_lag + filters),
    }
    if controller.follows:
        paths = {"path-position-setpoint": (0.0, T_p, T_p, 0.0)}
    elif not controller.state_gains.any():
        del paths["path-wanted-state"]
    return [
        PathDelay(
            path=Message(path),
            setpoint_age=age,
            dead_time=dead,
            hold=hold,
            lag=lag,
            total=age + dead + hold + lag,
        )
        for path, (age, dead, hold, lag) in paths.items()
    ]


def filter_polynomials(item: ForceFilter) -> tuple[Array, Array]:
    """Return numerator and denominator of a set-force filter in s, highest power first, (3,).

    Notch (s² + 2 ζ ω s + ω²) / (s² + 2 d ω s + ω²), d its width, or low-pass
    ω² / (s² + 2 ζ ω s + ω²).
    """
    zeta, omega = item.damping, item.natural_frequency
    damped = np.array([1.0, 2 * zeta * omega, omega**2])
    if item.kind == LOW_PASS:
        return np.array([0.0, 0.0, omega**2]), damped
    return damped, np.array([1.0, 2 * item.width * omega, omega**2])


def reference_state(plant: Plant, controller: Controller) -> Array:
    """Return the plant state that belongs to a setpoint: rigid motion, modes at rest on it.

    A mode follows slowly as q = F/ω² with F = m a_ref, so its deflection follows a_ref and
    its rate j_ref; the state feedback acts on the deviation from this state. Result @ (x_ref,
    v_ref, a_ref, j_ref), shape (n_plant, 4), of the nominal plant.
    """
    m = controller.feedforward_mass
    result = np.zeros((plant.order, 4))
    result[plant.position, 0] = result[plant.velocity, 1] = 1.0
    result[plant.force, 2] = m
    for mode in plant.modes:
        follows = mode.scale * m / mode.natural_frequency**2
        result[mode.deflection, 2] = result[mode.rate, 3] = follows
    return result
