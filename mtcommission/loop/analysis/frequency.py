"""A loop over frequency, affine in its gains: open loop, closed velocity loop, compliance.

The loop is cut at F_set. What the controller asks for is a sum over Kp, Kp/Tn, Kp Kv, Kp Kv/Tn and
the state gains; what each of them is multiplied with depends on plant, cycles, filters, sensors and
observer alone and is scanned once for all gains. Everything at the velocity cycle is exact in
z = exp(i ω T_v); a position loop that closes in the control is taken in its base band, that is, the
images of its slower sampling are left out (they lie above 1/(2 T_p) and are attenuated by the hold
and the plant). python-control gives the same to 1e-9 from ``diagram.build_open_loop`` (tested).

The grid is refined where something is read off it: at crossings and at the highest peaks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import exp, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.model.assembly import discretise, discretise_disturbance
from mtcommission.loop.model.controller import Controller, filter_polynomials
from mtcommission.machine.control import ForceFilter
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

SQRT_HALF = sqrt(0.5)
"""-3 dB."""

GRID_POINTS = 800
"""Frequencies before refinement; modes get a cluster of their own (empirical: no crossing of a
shipped machine is missed, and margins do not change when doubled)."""

CLUSTER, HALF_WIDTHS, NARROWEST = 80, 4.0, 1e-3
"""Frequencies about each mode, over so many of its half-widths, at least that wide. An even number
leaves out the very resonance, where an undamped mode is infinite (empirical)."""

REFINEMENTS = 2
REFINED_POINTS = 15
"""Each refinement divides every interval of interest by so much: two leave a spacing of 0.004 %,
and what is interpolated on it is right to 1e-6 (tested against root finding). Odd, so that the
middle, perhaps an undamped resonance, is left out."""

STEADY, RIGID = 1e-9, 2
"""Distance from the unit circle of a pole that decays, and poles of a rigid body."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyResponse:
    """Responses over n frequencies."""

    frequency_hz: Array
    open_loop: ComplexArray  # L, loop cut at F_set
    closed_velocity_loop: ComplexArray
    """Velocity setpoint to encoder velocity, position loop open."""
    compliance: ComplexArray
    """Tool per disturbance force on the line of the drive force, all loops closed [m/N]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GainGrid:
    """A plant at n frequencies under all controllers that differ in their gains alone."""

    plant: Plant
    velocity_cycle: float  # T_v [s]
    omega: Array  # (n,) [rad/s]
    z: ComplexArray  # exp(i ω T_v)
    asked: ComplexArray
    """Force asked for, sign reversed, by gain, per set force and per force of disturbance,
    (2, n_gains, n)."""
    velocity: ComplexArray  # velocity of the encoder per velocity setpoint, by Kp and Kp/Tn, (2, n)
    tool: ComplexArray  # per set force and per force of disturbance, (2, n)

    @property
    def is_damped(self) -> bool:
        """Whether only the rigid body's poles of the plant stand on the unit circle."""
        poles = np.linalg.eigvals(discretise(self.plant, self.velocity_cycle)[0])
        return int(np.sum(np.abs(poles) > 1.0 - STEADY)) <= RIGID

    def open_loop(self, controller: Controller) -> ComplexArray:
        """Return L, shape (n,)."""
        return np.asarray(_gains(controller) @ self.asked[0])

    def respond(self, controller: Controller) -> FrequencyResponse:
        """Return open and closed loop at the frequencies of the grid."""
        gains = _gains(controller)
        L, reaction = gains @ self.asked
        inner = L - gains[2:4] @ self.asked[0, 2:4]
        return FrequencyResponse(
            frequency_hz=self.omega / (2 * pi),
            open_loop=L,
            closed_velocity_loop=gains[:2] @ self.velocity / (1.0 + inner),
            compliance=self.tool[1] - self.tool[0] * reaction / (1.0 + L),
        )

    def with_filters(self, filters: tuple[ForceFilter, ...]) -> GainGrid:
        """Return the same behind more filters of the set force."""
        factor = _filtered(filters, self.z, self.velocity_cycle)
        return replace(self, asked=self.asked * factor, velocity=self.velocity * factor)


def _gains(controller: Controller) -> Array:
    """Factors of what the controller asks for, shape (4 + n_observed,)."""
    Kp, Kv, Tn = controller.velocity_gain, controller.position_gain, controller.integral_time
    gains = controller.state_gains[list(controller.observer.states)]
    return np.concatenate([[Kp, Kp / Tn, Kp * Kv, Kp * Kv / Tn], gains])


def scan(
    plants: Sequence[Plant], controller: Controller, omegas: Sequence[Array]
) -> tuple[GainGrid, ...]:
    """Return plants of the same states at frequencies of their own [rad/s], all below Nyquist.

    Of the controller its cycles, filters, sensors and observer count.
    """
    T_v, N, observer = controller.velocity_cycle, controller.cycles, controller.observer
    counts = [len(omega) for omega in omegas]
    own = np.repeat(np.arange(len(plants)), counts)
    z = np.exp(1j * np.concatenate(omegas) * T_v)
    A, B = map(np.array, zip(*(discretise(plant, T_v) for plant in plants), strict=True))
    # A disturbance on the line of the drive force enters like the force state itself.
    pushes = [discretise_disturbance(plant, T_v) for plant in plants]
    names = ("encoder", "tcp", *controller.sensors)
    rows = np.array([[plant.row(name) for name in names] for plant in plants])
    seen = rows[own] @ _resolvent(A[own], np.stack([B, pushes], axis=2)[own], z)
    encoder, tool = seen[:, 0].T, seen[:, 1].T
    rate = encoder * (1.0 - 1.0 / z) / T_v
    # The position controller's demand reaches the integral branch through the reference model.
    integral, modelled = T_v / (z - 1.0), _reference_model(controller, z)
    position = encoder
    if controller.position_loop is not PositionLoop.DRIVE:
        late = z**-N
        position = encoder * late * (1.0 - late) / (1.0 - 1.0 / z) / N
    asked = np.array([rate, integral * rate, position, integral * modelled * position])
    if observer.states:
        drives = np.column_stack([observer.B, observer.L])
        estimates = _resolvent(observer.A - observer.L @ observer.C, drives, z)
        # The observer does not know a disturbance.
        known = np.broadcast_to([[1.0, 0.0]], (z.size, 1, 2))
        told = estimates @ np.concatenate([known, seen[:, 2:]], axis=1)
        asked = np.concatenate([asked, told.transpose(1, 2, 0)])
    path = _filtered(controller.force_filters, z, T_v) / z
    asked = path * asked.swapaxes(0, 1)
    velocity = path * np.array([rate[0], integral * modelled * rate[0]])
    ends = np.cumsum(counts)
    return tuple(
        GainGrid(
            plant=plant,
            velocity_cycle=T_v,
            omega=omega,
            z=z[part],
            asked=np.ascontiguousarray(asked[:, :, part]),
            velocity=velocity[:, part],
            tool=tool[:, part],
        )
        for plant, omega, part in zip(plants, omegas, map(slice, ends - counts, ends), strict=True)
    )


def lay_grids(plants: Sequence[Plant], controller: Controller) -> tuple[GainGrid, ...]:
    """Return plants of the same states from 0.1 Hz to the Nyquist frequency of the velocity cycle.

    With a cluster of frequencies about each mode.
    """
    nyquist = pi / controller.velocity_cycle
    omegas = []
    for plant in plants:
        parts = [np.geomspace(2 * pi * 0.1, 0.999 * nyquist, GRID_POINTS)]
        for mode in plant.modes:
            width = HALF_WIDTHS * max(mode.damping_ratio, NARROWEST)
            parts.append(mode.natural_frequency * (1.0 + np.linspace(-width, width, CLUSTER)))
        omega = np.unique(np.concatenate(parts))
        omegas.append(omega[(omega > 0.0) & (omega < nyquist)])
    return scan(plants, controller, omegas)


def complete(grids: Sequence[GainGrid], controller: Controller) -> tuple[FrequencyResponse, ...]:
    """Return open and closed loops, finest where margins, the bandwidth and the peaks are read."""
    found = [grid.respond(controller) for grid in grids]
    for _ in range(REFINEMENTS):
        omegas = [
            _between(2 * pi * item.frequency_hz, _intervals_of_interest(item)) for item in found
        ]
        finer = scan([grid.plant for grid in grids], controller, omegas)
        found = [
            _merge(item, grid.respond(controller)) for item, grid in zip(found, finer, strict=True)
        ]
    return tuple(found)


def _resolvent(A: Array, drives: Array, z: ComplexArray) -> ComplexArray:
    """(zI - A)^-1 drives at each frequency, shape (n_frequencies, n, n_drives)."""
    matrices = z[:, None, None] * np.eye(A.shape[-1]) - A
    return np.asarray(
        np.linalg.solve(matrices, np.broadcast_to(drives, (z.size, *drives.shape[-2:])))
    )


def _filtered(
    filters: tuple[ForceFilter, ...], z: ComplexArray, velocity_cycle: float
) -> ComplexArray:
    """Filters of the set force by the bilinear transform, which is how they are sampled."""
    s, path = 2.0 / velocity_cycle * (z - 1.0) / (z + 1.0), np.ones_like(z)
    for item in filters:
        numerator, denominator = filter_polynomials(item)
        path = path * np.polyval(numerator, s) / np.polyval(denominator, s)
    return path


def _reference_model(controller: Controller, z: ComplexArray) -> ComplexArray:
    """First-order lag at the velocity cycle through which the integral sees its setpoint."""
    if not controller.reference_model_time:
        return np.ones_like(z)
    share = 1.0 - exp(-controller.velocity_cycle / controller.reference_model_time)
    return np.asarray(share / (z - 1.0 + share))


def _intervals_of_interest(found: FrequencyResponse) -> NDArray[np.intp]:
    """Indices i such that something is read between the frequencies i and i + 1."""
    L = found.open_loop
    here, there = L[:-1], L[1:]
    marked = (here.imag * there.imag < 0.0) & (np.minimum(here.real, there.real) < 0.0)
    for level in (np.log(np.abs(L)), np.abs(found.closed_velocity_loop) - SQRT_HALF):
        marked |= level[:-1] * level[1:] < 0.0
    for size in (1.0 / np.abs(1.0 + L), np.abs(found.compliance)):
        peak = int(np.argmax(size))
        marked[max(peak - 1, 0) : peak + 1] = True
    return np.flatnonzero(marked)


def _between(omega: Array, intervals: NDArray[np.intp]) -> Array:
    """New frequencies inside the intervals, evenly spaced."""
    share = np.arange(1, REFINED_POINTS) / REFINED_POINTS
    low, high = omega[intervals, None], omega[intervals + 1, None]
    return np.asarray((low + share * (high - low)).ravel())


def _merge(one: FrequencyResponse, other: FrequencyResponse) -> FrequencyResponse:
    names = [item.name for item in fields(FrequencyResponse)]
    both = {name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in names}
    order = np.argsort(both["frequency_hz"], kind="stable")
    return FrequencyResponse(**{name: values[order] for name, values in both.items()})
