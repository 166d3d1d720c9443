"""Machine -> Plant: the state space that optimiser and feedback loop share.

    x' = A x + B F_set,   y = C x

Every axis here is a rigid mass, a first-order force lag and decoupled flexible modes driven
by the same force. The manipulator of the paper is one of them, with scaled states, so one
description serves both kinds of profile. Where the motor follows its setpoint the force is its
acceleration: it has no lag, and what drives the plant is its jerk, or, for ``driven_at_once``, the
acceleration itself.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import FlexibleMode, find_equal_poles

Array = NDArray[np.float64]

PLANTS = 128
"""Plants whose form without a state for the force is kept."""

OUTPUTS = ("tcp", "encoder", "tcp_vibration")
"""Rows of C: tool, encoder, and the elastic part of the tool."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantMode(FlexibleMode):
    """A flexible mode and where its states sit in the plant.

    The plant's states are x[deflection] = scale q and x[rate] = scale q'.
    """

    scale: float  # factor from q to the plant's state
    deflection: int  # index of the state that is scale times q
    rate: int  # index of the state that is scale times q'


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plant:
    """Linear model of an axis."""

    states: tuple[str, ...]  # names; the last one is the force F, but of ``driven_at_once``
    A: Array  # shape (n, n)
    B: Array  # column of F_set, or of the jerk of a motor that follows, shape (n,)
    outputs: tuple[str, ...]
    """Names of the rows of C: ``tcp``, ``encoder``, ``tcp_vibration`` (the elastic part of tcp)."""
    C: Array  # shape (n_outputs, n) [m per unit of state]
    modes: tuple[PlantMode, ...]
    moving_mass: float  # rigid mass [kg]
    force_lag: float  # T [s]; 0 where the motor follows
    position: int  # index of the rigid position ...
    velocity: int  # ... and velocity
    signal_units: tuple[str, ...]  # SI units of ``signals``, for messages and sheets
    force_unit: str
    """SI unit of the set force: N, N m, or that of the acceleration of a motor that follows."""
    follows: bool = False  # the force is then the motor's acceleration, the input its jerk

    @property
    def order(self) -> int:
        """Number of states n."""
        return len(self.states)

    @property
    def force(self) -> int:
        """Index of the force state."""
        return self.order - 1

    @property
    def signals(self) -> tuple[str, ...]:
        """Names that a bound may refer to: states, then outputs."""
        return self.states + self.outputs

    @property
    def fastest_rate(self) -> float:
        """Largest of 1 / force lag and the natural frequencies [1/s]."""
        lag = tuple(-rate for rate in self.lag_rates)
        return max(*lag, *(mode.natural_frequency for mode in self.modes), 0.0)

    @property
    def lag_rates(self) -> tuple[float, ...]:
        """The pole -1/T of the force lag, if there is one [1/s]."""
        return (-1.0 / self.force_lag,) if self.force_lag else ()

    @property
    def lagged(self) -> slice:
        """Where the states hold the force that the lag lets through; empty without a lag."""
        return slice(self.order - 1 if self.force_lag else self.order, self.order)

    @property
    def jerk_unit(self) -> str:
        """Of what changes the acceleration of a motor that follows, m/s^3 or rad/s^3."""
        return self.force_unit.replace("s^2", "s^3")

    def unit(self, signal: str) -> str:
        """Return the SI unit of one of ``signals``."""
        return self.signal_units[self.signals.index(signal)]

    def row(self, signal: str) -> Array:
        """Return the row c with signal = c x, shape (n,).

        Raises KeyError if there is no such signal.
        """
        if signal in self.states:
            row = np.zeros(self.order)
            row[self.states.index(signal)] = 1.0
            return row
        if signal in self.outputs:
            return np.asarray(self.C[self.outputs.index(signal)])
        raise KeyError(signal)


def build_plant(machine: Machine) -> Plant:
    """Return the state space of an axis, nominal or in a corner.

    States of the manipulator: x_b, x_s, phi, v_b, v_s, v_phi, F; of a modal axis: x, v, q_<name>,
    v_<name>, ..., F. Where the motor follows, its jerk is the input.

    Raises ComputationError: EQUAL_POLES if two poles coincide; NOT_CONTROLLABLE if the force misses
    a state.

    Source: Christiansen, Maurer & Zirn, eq. (1).
    """
    mechanics = machine.mechanics
    dimensions = mechanics.states([mode.name for mode in mechanics.modes], machine.axis_units)
    states = tuple(dimensions)
    modes = tuple(
        PlantMode(
            **{one.name: getattr(mode, one.name) for one in fields(FlexibleMode)},
            scale=place.scale,
            deflection=states.index(place.deflection),
            rate=states.index(place.rate),
        )
        for mode, place in zip(mechanics.modes, mechanics.mode_states(), strict=True)
    )
    _check_modes(mechanics.modes, modes)
    n, force = len(states), len(states) - 1
    position, velocity = states.index(mechanics.position), states.index(mechanics.velocity)
    m, T = mechanics.moving_mass, machine.drive.force_lag
    A = np.zeros((n, n))
    A[position, velocity] = 1.0
    A[velocity, force] = 1.0 / m
    A[force, force] = -1.0 / T if T else 0.0
    vibration, encoder = np.zeros(n), np.zeros(n)
    for mode in modes:
        zeta, omega = mode.damping_ratio, mode.natural_frequency
        A[mode.deflection, mode.rate] = 1.0
        A[mode.rate, mode.deflection] = -(omega**2)
        A[mode.rate, mode.rate] = -2.0 * zeta * omega
        A[mode.rate, force] = mode.scale
        vibration[mode.deflection] = mode.tcp_gain / mode.scale
        encoder[mode.deflection] = mode.measured_gain / mode.scale
    encoder[position] = 1.0
    tcp = vibration.copy()
    tcp[position] = 1.0
    B = np.zeros(n)
    B[force] = 1.0 / T if T else 1.0
    C = np.vstack([tcp, encoder, vibration])
    for array in (A, B, C):
        array.setflags(write=False)
    length = machine.axis_units.length.si
    return Plant(
        states=states,
        A=A,
        B=B,
        outputs=OUTPUTS,
        C=C,
        modes=modes,
        moving_mass=m,
        force_lag=T,
        position=position,
        velocity=velocity,
        signal_units=(*(unit.si for unit in dimensions.values()), length, length, length),
        force_unit=dimensions[states[force]].si,
        follows=machine.drive.follows,
    )


@lru_cache(maxsize=PLANTS)
def driven_at_once(plant: Plant) -> Plant:
    """Return the plant that the set force drives, as optimal controls know it.

    Behind a force lag the plant stays the same; where the motor follows, it goes without the state
    F: the input is the set acceleration, and acts at once, on position and modes alike.
    """
    if not plant.follows:
        return plant
    rest = plant.force
    A, B, C = plant.A[:rest, :rest], plant.A[:rest, rest], plant.C[:, :rest]
    units = (*plant.signal_units[:rest], *plant.signal_units[plant.order :])
    states = plant.states[:rest]
    return replace(plant, states=states, A=A, B=B, C=C, signal_units=units, follows=False)


def _check_modes(modes: tuple[FlexibleMode, ...], placed: tuple[PlantMode, ...]) -> None:
    for mode in placed:
        if mode.scale == 0.0:
            raise ComputationError(
                Outcome.NOT_CONTROLLABLE, Message("mode-not-driven", mode=mode.name)
            )
    for _, detail in find_equal_poles(modes):
        raise ComputationError(Outcome.EQUAL_POLES, detail)


def kalman_rank(plant: Plant) -> int:
    """Return the rank of the controllability matrix (B, AB, ..., A^(n-1) B).

    The states are scaled by the fastest pole first; unscaled, the entries of the paper's
    plant span 18 decades and every numerical rank is meaningless.

    The rank is n if the plant is completely controllable.

    Source: Kalman's criterion; Christiansen, Maurer & Zirn, eq. (10).
    """
    A, column = plant.A / plant.fastest_rate, plant.B.copy()
    columns = []
    for _ in range(plant.order):
        columns.append(column)
        column = A @ column
    K = np.column_stack(columns)
    norms = np.linalg.norm(K, axis=1, keepdims=True)
    if not np.all(norms > 0.0):
        K, norms = K[norms[:, 0] > 0.0], norms[norms[:, 0] > 0.0]
    return int(np.linalg.matrix_rank(K / norms, tol=1e-13))


def dominant_mode(plant: Plant) -> PlantMode:
    """Return the mode with the largest static deflection of the tool per newton.

    The one that a setpoint excites most: max |tcp_gain| / ω².
    """
    return max(plant.modes, key=lambda mode: abs(mode.tcp_gain) / mode.natural_frequency**2)


def longest_period(plant: Plant) -> float:
    """Return the natural period of the slowest mode [s]; inf without modes."""
    return max((2 * pi / mode.natural_frequency for mode in plant.modes), default=inf)
