"""The cascade with every gain resolved: P position, PI velocity, feed-forward, state feedback."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.machine.control import FilterKind, ForceFilter
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observer:
    """Predicting observer at the velocity cycle, x̂⁺ = A x̂ + B F_set + L (y - C x̂).

    Parameters
    ----------
    states
        Indices of the observed plant states.
    A, B, C, L
        Shapes (n, n), (n,), (n_sensors, n), (n, n_sensors).
    """

    states: tuple[int, ...]
    A: Array
    B: Array
    C: Array
    L: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Controller:
    """All that the loop needs beside the plant.

    Parameters
    ----------
    position_loop
        Where the position loop closes, and how the setpoint gets from cycle to cycle.
    position_gain, velocity_gain, integral_time
        Kv [1/s], Kp [N s/m], Tn [s].
    reference_model_time
        Time constant of the first-order reference model through which the integral branch sees
        the position controller's output [s]; 0 = none.
    velocity_feedforward, acceleration_feedforward, jerk_feedforward
        Weights [-]; the jerk part is feedforward_mass x force_lag x j_ref.
    feedforward_mass, force_lag
        [kg], [s].
    reference_delay
        τ [s]; at least ``handing_down_delay`` where the position loop closes in the drive.
    velocity_cycle
        T_v [s].
    cycles
        Velocity cycles in one position cycle.
    force_filters
        In the set-force path, in order.
    sensors
        Outputs of the plant that are measured: ``encoder``, perhaps ``tcp``.
    state_gains
        K, set force per deviation of each plant state, shape (n_plant,) [N per unit].
    observer
        Where K gets its states from; without states if K is zero.
    follows
        Whether there is no loop at all: the motor follows its setpoint, interpolated.
    """

    position_loop: PositionLoop
    position_gain: float
    velocity_gain: float
    integral_time: float
    reference_model_time: float
    velocity_feedforward: float
    acceleration_feedforward: float
    jerk_feedforward: float
    feedforward_mass: float
    force_lag: float
    reference_delay: float
    velocity_cycle: float
    cycles: int
    force_filters: tuple[ForceFilter, ...]
    sensors: tuple[str, ...]
    state_gains: Array
    observer: Observer
    follows: bool = False

    @property
    def position_cycle(self) -> float:
        """T_p [s]."""
        return self.cycles * self.velocity_cycle

    @property
    def handing_down_delay(self) -> float:
        """See the function of this name [s]."""
        return handing_down_delay(
            self.position_loop,
            position_cycle=self.position_cycle,
            velocity_cycle=self.velocity_cycle,
        )

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


def handing_down_delay(
    position_loop: PositionLoop, *, position_cycle: float, velocity_cycle: float
) -> float:
    """Return how old what the position cycle computes is, on average, when it is used [s].

    Parameters
    ----------
    position_loop
        How it is handed down.
    position_cycle, velocity_cycle
        T_p, T_v [s].

    Returns
    -------
    float
        One position cycle of dead time, and then: held, T_p + (T_p - T_v)/2 as the velocity cycle
        samples it; interpolated, 2 T_p, since between two setpoints both must be known.
    """
    if position_loop is PositionLoop.CONTROL:
        return 0.5 * (3.0 * position_cycle - velocity_cycle)
    return 2.0 * position_cycle


def no_observer(*, n_sensors: int) -> Observer:
    """Return the observer of a loop without state feedback: no states, whatever is measured."""
    return Observer(
        states=(),
        A=np.zeros((0, 0)),
        B=np.zeros(0),
        C=np.zeros((n_sensors, 0)),
        L=np.zeros((0, n_sensors)),
    )


def feedforward_delay(
    *,
    handing_down: float,
    velocity_cycle: float,
    force_lag: float,
    jerk_feedforward: float,
    force_filters: tuple[ForceFilter, ...],
) -> float:
    """Return the time after which the fed-forward force moves the axis: τ for "auto".

    Parameters
    ----------
    handing_down
        From ``handing_down_delay`` [s].
    velocity_cycle, force_lag
        [s].
    jerk_feedforward
        Weight [-]; 1 cancels the lag.
    force_filters
        In the set-force path.

    Returns
    -------
    float
        Handing down + 1.5 T_v (dead time and hold of the force) + (1 - jerk_feedforward) T + the
        low-frequency delay of the filters [s].

    Source: first-order (low-frequency) delay of each block.

    Examples
    --------
    >>> round(1e3 * feedforward_delay(handing_down=2.9375e-3, velocity_cycle=125e-6,
    ...     force_lag=2.5e-3, jerk_feedforward=0.0, force_filters=()), 4)
    5.625
    """
    filters = sum(filter_delay(item) for item in force_filters)
    return handing_down + 1.5 * velocity_cycle + (1.0 - jerk_feedforward) * force_lag + filters


def filter_delay(item: ForceFilter) -> float:
    """Return the low-frequency delay of a set-force filter [s]."""
    zeta, omega = item.damping, item.natural_frequency
    if item.kind is FilterKind.LOW_PASS:
        return 2.0 * zeta / omega
    return 2.0 * (item.width - zeta) / omega


def filter_polynomials(item: ForceFilter) -> tuple[Array, Array]:
    """Return numerator and denominator of a set-force filter in s, highest power first.

    Parameters
    ----------
    item
        Notch (s² + 2 ζ ω s + ω²) / (s² + 2 d ω s + ω²), d its width, or low-pass
        ω² / (s² + 2 ζ ω s + ω²).

    Returns
    -------
    (numerator, denominator)
        Shapes (3,).
    """
    zeta, omega = item.damping, item.natural_frequency
    if item.kind is FilterKind.LOW_PASS:
        return np.array([0.0, 0.0, omega**2]), np.array([1.0, 2 * zeta * omega, omega**2])
    return (
        np.array([1.0, 2 * zeta * omega, omega**2]),
        np.array([1.0, 2 * item.width * omega, omega**2]),
    )


def reference_state(plant: Plant, controller: Controller) -> Array:
    """Return the plant state that belongs to a setpoint: rigid motion, modes at rest on it.

    A mode follows slowly as q = F/ω² with F = m a_ref, so its deflection follows a_ref and
    its rate j_ref; the state feedback acts on the deviation from this state.

    Parameters
    ----------
    plant, controller
        The nominal plant and the controller, whose mass is used.

    Returns
    -------
    ndarray, shape (n_plant, 4)
        State = result @ (x_ref, v_ref, a_ref, j_ref).
    """
    m = controller.feedforward_mass
    result = np.zeros((plant.order, 4))
    result[plant.position, 0] = 1.0
    result[plant.velocity, 1] = 1.0
    result[plant.force, 2] = m
    for mode in plant.modes:
        result[mode.deflection, 2] = mode.scale * m / mode.natural_frequency**2
        result[mode.rate, 3] = mode.scale * m / mode.natural_frequency**2
    return result
