"""Machine -> Plant: the state space that optimiser and feedback loop share.

    x' = A x + B F_set,   y = C x

Every axis here is a rigid mass, a first-order force lag and decoupled flexible modes driven
by the same force. The manipulator of the paper is one of them, with scaled states, so one
description serves both kinds of profile.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import FlexibleMode, find_equal_poles
from mtcommission.messages.message import Message

Array = NDArray[np.float64]

FORGOTTEN_LAGS = 12.0
"""After so many of its time constants a lag has forgotten all but e^-12."""

OUTPUTS = ("tcp", "encoder", "tcp_vibration")
"""Rows of C: tool, encoder, and the elastic part of the tool."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantMode:
    """A flexible mode and where its states sit in the plant.

    The modal coordinate obeys q'' + 2 ζ ω q' + ω² q = F; the plant's states are
    x[deflection] = scale q and x[rate] = scale q'.

    Parameters
    ----------
    name
        Identifier.
    natural_frequency
        ω [rad/s].
    damping_ratio
        ζ [-].
    tcp_gain, measured_gain
        Shares of q in tool and encoder position [1/kg].
    scale
        Factor from q to the plant's state.
    deflection, rate
        Indices of the two states.
    """

    name: str
    natural_frequency: float
    damping_ratio: float
    tcp_gain: float
    measured_gain: float
    scale: float
    deflection: int
    rate: int

    @property
    def frequency_hz(self) -> float:
        """Natural frequency [Hz]."""
        return self.natural_frequency / (2 * pi)

    @property
    def pole(self) -> complex:
        """The pole with positive imaginary part, -ζω + iω√(1-ζ²) [1/s]."""
        zeta, omega = self.damping_ratio, self.natural_frequency
        return complex(-zeta * omega, omega * sqrt(1.0 - zeta**2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plant:
    """Linear model of an axis.

    Parameters
    ----------
    states
        Names of the states; the last one is the force F.
    A, B
        Shapes (n, n) and (n,); B is the column of F_set.
    outputs
        Names of the rows of C: ``tcp``, ``encoder``, ``tcp_vibration`` (the elastic part of tcp).
    C
        Shape (n_outputs, n) [m per unit of state].
    modes
        The flexible modes.
    moving_mass
        Rigid mass [kg].
    force_lag
        T [s].
    position, velocity
        Indices of the rigid position and velocity.
    signal_units
        SI units of ``signals``, for messages and sheets.
    follows
        Whether the motor follows its setpoint: the force is its acceleration, and the lag only
        stands for an acceleration that changes at once, in optimal controls.
    """

    states: tuple[str, ...]
    A: Array
    B: Array
    outputs: tuple[str, ...]
    C: Array
    modes: tuple[PlantMode, ...]
    moving_mass: float
    force_lag: float
    position: int
    velocity: int
    signal_units: tuple[str, ...]
    follows: bool = False

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
        return max(1.0 / self.force_lag, *(mode.natural_frequency for mode in self.modes))

    @property
    def force_unit(self) -> str:
        """N, or N·m on a rotary axis."""
        return self.unit(self.states[self.force])

    @property
    def proof_slack(self) -> float:
        """By how much a control without the stand-in lag may undercut what is proved with it [s].

        Let u0 reach the target at rest at t0 with |u0| <= a. Sent as u = (1 + η) u0(t) -
        η u0(t - δ), η = 1/(e^(δ/T) - 1), it passes the lag as u0 averaged over δ, by weights that
        are positive and end: so at t0 + δ all is at rest again, and every bound on a state holds.
        Only |u| <= (1 + 2 η) a is asked for, which at δ = 12 T is a share of 1e-5.
        """
        return FORGOTTEN_LAGS * self.force_lag if self.follows else 0.0

    def unit(self, signal: str) -> str:
        """Return the SI unit of a signal.

        Parameters
        ----------
        signal
            A name from ``signals``.

        Returns
        -------
        str
        """
        return self.signal_units[self.signals.index(signal)]

    def row(self, signal: str) -> Array:
        """Return the row c with signal = c x.

        Parameters
        ----------
        signal
            A name from ``signals``.

        Returns
        -------
        ndarray, shape (n,)

        Raises
        ------
        KeyError
            If there is no such signal.
        """
        if signal in self.states:
            row = np.zeros(self.order)
            row[self.states.index(signal)] = 1.0
            return row
        if signal in self.outputs:
            return np.asarray(self.C[self.outputs.index(signal)])
        raise KeyError(signal)


def build_plant(machine: Machine) -> Plant:
    """Return the state space of an axis.

    Parameters
    ----------
    machine
        A machine, nominal or in a corner.

    Returns
    -------
    Plant
        States of the manipulator: x_b, x_s, phi, v_b, v_s, v_phi, F; of a modal axis:
        x, v, q_<name>, v_<name>, ..., F.

    Raises
    ------
    ComputationError
        EQUAL_POLES if two poles coincide; NOT_CONTROLLABLE if the force misses a state.

    Source: Christiansen, Maurer & Zirn, eq. (1).

    Examples
    --------
    >>> from mtcommission.machine.machine import Drive, Modes, Requirements, VelocityStep
    >>> from mtcommission.machine.mechanics import FlexibleMode
    >>> from mtcommission.plant.modal import Modal
    >>> axis = Machine(name="a", axis="X", source="example",
    ...     mechanics=Modal(moving_mass=100.0, modes=(FlexibleMode(name="column",
    ...         natural_frequency=2 * pi * 40, damping_ratio=0.03, tcp_gain=0.01),)),
    ...     drive=Drive(force_lag=2e-3, max_force=1e3), moves=(VelocityStep(velocity_step=0.1),),
    ...     requirements=Requirements(tcp_deviation=1e-5,
    ...         modes=Modes(surface=4e-6, accuracy=1e-5, speed=4e-5)))
    >>> build_plant(axis).states
    ('x', 'v', 'q_column', 'v_column', 'F')
    """
    mechanics = machine.mechanics
    dimensions = mechanics.states([mode.name for mode in mechanics.modes], machine.axis_units)
    states = tuple(dimensions)
    modes = tuple(
        PlantMode(
            name=mode.name,
            natural_frequency=mode.natural_frequency,
            damping_ratio=mode.damping_ratio,
            tcp_gain=mode.tcp_gain,
            measured_gain=mode.measured_gain,
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
    A[force, force] = -1.0 / T
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
    B[force] = 1.0 / T
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
        follows=machine.drive.follows,
    )


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

    Parameters
    ----------
    plant
        Any plant.

    Returns
    -------
    int
        n if the plant is completely controllable.

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

    Parameters
    ----------
    plant
        Any plant.

    Returns
    -------
    PlantMode
        The one that a setpoint excites most: max |tcp_gain| / ω².
    """
    return max(plant.modes, key=lambda mode: abs(mode.tcp_gain) / mode.natural_frequency**2)


def longest_period(plant: Plant) -> float:
    """Return the natural period of the slowest mode [s]; inf without modes."""
    return max((2 * pi / mode.natural_frequency for mode in plant.modes), default=inf)
