"""What plant and observer do over frequency, whatever the gains around them.

Tuning tries some twenty controllers with the same cycles, sensors and observer: what these share
is computed once. Everything is exact at the velocity cycle, in z = exp(i ω T_v).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.controller import Controller
from mtcommission.loop.model.discrete import discretise, discretise_disturbance
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

GRID_POINTS = 800
"""Frequencies before refinement; modes get a cluster of their own (empirical: no crossing of a
shipped machine is missed, and margins do not change when doubled)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Blocks:
    """Plant and observer at the velocity cycle.

    Parameters
    ----------
    velocity_cycle
        T_v [s].
    A, entries
        Plant state one cycle later, shape (n, n), and per set force and per force of
        disturbance, shape (n, 2).
    observer, drives
        Observer state one cycle later, shape (n_observed, n_observed), and per known force and
        per sensor, shape (n_observed, 1 + n_sensors).
    rows
        Over the plant states: encoder, tool, then the sensors, shape (2 + n_sensors, n).
    """

    velocity_cycle: float
    A: Array
    entries: Array
    observer: Array
    drives: Array
    rows: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlantResponse:
    """What is seen of the plant, per newton.

    Parameters
    ----------
    rate, encoder, tool
        Velocity of the encoder, from differences of its position; its position, and that of the
        tool, shape (n,).
    sensors
        Shape (n, n_sensors).
    """

    rate: ComplexArray
    encoder: ComplexArray
    tool: ComplexArray
    sensors: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockResponses:
    """What plant and observer do at some frequencies.

    Parameters
    ----------
    blocks
        Plant and observer.
    omega, z
        Frequencies, shape (n,) [rad/s], and exp(i ω T_v).
    moved, disturbed
        What is seen per set force, and per force of disturbance.
    estimates
        Observer states per known force and per sensor, shape (n, 1 + n_sensors, n_observed).
    """

    blocks: Blocks
    omega: Array
    z: ComplexArray
    moved: PlantResponse
    disturbed: PlantResponse
    estimates: ComplexArray

    @property
    def is_damped(self) -> bool:
        """Whether only the rigid body's poles of the plant stand on the unit circle."""
        return int(np.sum(np.abs(np.linalg.eigvals(self.blocks.A)) > 1.0 - STEADY)) <= RIGID


STEADY, RIGID = 1e-9, 2
"""Distance from the unit circle of a pole that decays, and poles of a rigid body."""


def build_blocks(plant: Plant, controller: Controller) -> Blocks:
    """Return plant and observer at the velocity cycle.

    Parameters
    ----------
    plant, controller
        The loop; of the controller only velocity cycle, sensors and observer count.
    """
    T_v, observer = controller.velocity_cycle, controller.observer
    A, B = discretise(plant, T_v)
    names = ("encoder", "tcp", *controller.sensors)
    return Blocks(
        velocity_cycle=T_v,
        A=A,
        # A disturbance on the line of the drive force enters like the force state itself.
        entries=np.column_stack([B, discretise_disturbance(plant, T_v)]),
        observer=observer.A - observer.L @ observer.C,
        drives=np.column_stack([observer.B, observer.L]),
        rows=np.array([plant.row(name) for name in names]),
    )


def scan_blocks_on_grid(plant: Plant, controller: Controller) -> BlockResponses:
    """Return what ``scan`` needs of a loop, the same for all gains.

    Parameters
    ----------
    plant, controller
        The loop; of the controller only velocity cycle, sensors and observer count.

    Returns
    -------
    BlockResponses
        From 0.1 Hz to the Nyquist frequency of the velocity cycle, before refinement.
    """
    return scan_blocks(build_blocks(plant, controller), _grid(plant, controller))


def scan_blocks(blocks: Blocks, omega: Array) -> BlockResponses:
    """Return what plant and observer do at given frequencies.

    Parameters
    ----------
    blocks
        Plant and observer.
    omega
        Shape (n,), below the Nyquist frequency of the velocity cycle [rad/s].
    """
    z = np.exp(1j * omega * blocks.velocity_cycle)
    states = resolvent(blocks.A, blocks.entries, z)
    estimates = resolvent(blocks.observer, blocks.drives, z).swapaxes(1, 2)
    return BlockResponses(
        blocks=blocks,
        omega=omega,
        z=z,
        moved=_read_outputs(blocks, states[:, :, 0], z),
        disturbed=_read_outputs(blocks, states[:, :, 1], z),
        estimates=np.ascontiguousarray(estimates),
    )


def _read_outputs(blocks: Blocks, states: ComplexArray, z: ComplexArray) -> PlantResponse:
    encoder, tool = states @ blocks.rows[0], states @ blocks.rows[1]
    return PlantResponse(
        rate=encoder * (1.0 - 1.0 / z) / blocks.velocity_cycle,
        encoder=encoder,
        tool=tool,
        sensors=states @ blocks.rows[2:].T,
    )


def _grid(plant: Plant, controller: Controller) -> Array:
    """Frequencies [rad/s] up to Nyquist, with clusters of each mode's half-width.

    An even number of points leaves out the very resonance, where an undamped mode is infinite.
    """
    nyquist = pi / controller.velocity_cycle
    parts = [np.geomspace(2 * pi * 0.1, 0.999 * nyquist, GRID_POINTS)]
    for mode in plant.modes:
        width = max(mode.damping_ratio, 1e-3)
        parts.append(mode.natural_frequency * (1.0 + width * np.linspace(-4.0, 4.0, 80)))
    omega = np.unique(np.concatenate(parts))
    return omega[(omega > 0.0) & (omega < nyquist)]


def resolvent(A: Array, drives: Array, z: ComplexArray) -> ComplexArray:
    """Return (zI - A)^-1 drives at each frequency, shape (n_frequencies, n, n_drives)."""
    matrices = z[:, None, None] * np.eye(A.shape[0]) - A
    return np.asarray(np.linalg.solve(matrices, np.broadcast_to(drives, (z.size, *drives.shape))))
