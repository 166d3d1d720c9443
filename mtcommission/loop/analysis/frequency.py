"""A loop over frequency: open loop, closed velocity loop, compliance of the tool.

The loop is cut at F_set. Everything at the velocity cycle is exact in z = exp(i ω T_v); a
position loop that closes in the control is taken in its base band, that is, the images of its
slower sampling are left out (they lie above 1/(2 T_p) and are attenuated by the hold and the
plant). python-control gives the same to 1e-9 from ``diagram.build_open_loop`` (tested) in 40 ms
instead of the 0.1 ms that one more gain takes here: what plant and observer do is the same for all
controllers with the same cycles, sensors and observer, and computed once.

The grid is refined where something is read off it: at crossings and at the highest peaks.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.model.controller import Controller, filter_polynomials
from mtcommission.loop.model.discrete import discretise, discretise_disturbance
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

SQRT_HALF = sqrt(0.5)
"""-3 dB."""

GRID_POINTS = 800
"""Frequencies before refinement; modes get a cluster of their own (empirical: no crossing of a
shipped machine is missed, and margins do not change when doubled)."""

REFINEMENTS = 2
REFINED_POINTS = 15
"""Each refinement divides every interval of interest by so much: two leave a spacing of 0.004 %,
and what is interpolated on it is right to 1e-6 (tested against root finding). Odd, so that the
middle, perhaps an undamped resonance, is left out."""

STEADY, RIGID = 1e-9, 2
"""Distance from the unit circle of a pole that decays, and poles of a rigid body."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Blocks:
    """Plant and observer, one velocity cycle later."""

    velocity_cycle: float  # T_v [s]
    A: Array  # plant, (n, n)
    entries: Array  # per set force, and per force of disturbance, (n, 2)
    observer: Array  # (n_observed, n_observed)
    drives: Array  # of the observer, per known force and per sensor, (n_observed, 1 + n_sensors)
    rows: Array  # over the plant: encoder, tool, then the sensors, (2 + n_sensors, n)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlantResponse:
    """What is seen of the plant, per newton, over n frequencies."""

    rate: ComplexArray  # velocity of the encoder, from differences of its position, (n,)
    encoder: ComplexArray  # its position, (n,)
    tool: ComplexArray  # (n,)
    sensors: ComplexArray  # (n, n_sensors)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BlockResponses:
    """What plant and observer do at some frequencies."""

    blocks: Blocks
    omega: Array  # (n,) [rad/s]
    z: ComplexArray  # exp(i ω T_v)
    moved: PlantResponse  # per set force
    disturbed: PlantResponse  # per force of disturbance
    estimates: ComplexArray
    """Observer states per known force and per sensor, (n, 1 + n_sensors, n_observed)."""

    @property
    def is_damped(self) -> bool:
        """Whether only the rigid body's poles of the plant stand on the unit circle."""
        return int(np.sum(np.abs(np.linalg.eigvals(self.blocks.A)) > 1.0 - STEADY)) <= RIGID


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
class Laws:
    """What the controller makes of what it sees, each of shape (n,)."""

    path: ComplexArray  # dead time and set-force filters, force asked for to force
    velocity: ComplexArray  # error of the velocity to force asked for
    observed: ComplexArray  # known force and each sensor to force asked for, (n, 1 + n_sensors)
    handed_down: ComplexArray  # what the position cycle hands down, to force
    position: ComplexArray  # position of the encoder, to force


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OpenLoop:
    """The loop cut at F_set, with the laws of its controller."""

    laws: Laws
    inner: ComplexArray  # without the position loop, (n,)
    whole: ComplexArray


def build_blocks(plant: Plant, controller: Controller) -> Blocks:
    """Return a plant, and the observer of a controller of which only cycle and sensors count."""
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
    """Return what ``scan`` needs of a loop, the same for all gains, before refinement.

    From 0.1 Hz to the Nyquist frequency of the velocity cycle.
    """
    return scan_blocks(build_blocks(plant, controller), _grid(plant, controller))


def scan_blocks(blocks: Blocks, omega: Array) -> BlockResponses:
    """Return what plant and observer do at frequencies [rad/s] below the Nyquist frequency."""
    z = np.exp(1j * omega * blocks.velocity_cycle)
    states = _resolvent(blocks.A, blocks.entries, z)
    estimates = _resolvent(blocks.observer, blocks.drives, z).swapaxes(1, 2)
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


def _resolvent(A: Array, drives: Array, z: ComplexArray) -> ComplexArray:
    """(zI - A)^-1 drives at each frequency, shape (n_frequencies, n, n_drives)."""
    matrices = z[:, None, None] * np.eye(A.shape[0]) - A
    return np.asarray(np.linalg.solve(matrices, np.broadcast_to(drives, (z.size, *drives.shape))))


def open_loop(controller: Controller, scanned: BlockResponses) -> OpenLoop:
    """Return the loop cut at F_set, of a plant scanned with the same cycle, sensors, observer."""
    laws = _laws(controller, scanned)
    inner = _velocity_feedback(laws, scanned.moved, known=1.0)
    return OpenLoop(laws=laws, inner=inner, whole=inner + laws.position * scanned.moved.encoder)


def _laws(controller: Controller, scanned: BlockResponses) -> Laws:
    T_v, N, z = controller.velocity_cycle, controller.cycles, scanned.z
    Kp, integral = controller.velocity_gain, T_v / controller.integral_time / (z - 1.0)
    path = 1.0 / z
    s = 2.0 / T_v * (z - 1.0) / (z + 1.0)  # bilinear
    for item in controller.force_filters:
        numerator, denominator = filter_polynomials(item)
        path = path * np.polyval(numerator, s) / np.polyval(denominator, s)
    # The position controller's demand reaches the integral branch through the reference model.
    handed_down = path * (Kp * (1.0 + integral * _reference_model(controller, z)))
    correction = np.full_like(z, controller.position_gain)
    if controller.position_loop is not PositionLoop.DRIVE:
        late = z**-N
        correction *= late * (1.0 - late) / (1.0 - 1.0 / z) / N
    gains = controller.state_gains[list(controller.observer.states)]
    return Laws(
        path=path,
        velocity=Kp * (1.0 + integral),
        observed=np.tensordot(scanned.estimates, gains, axes=(2, 0)),
        handed_down=handed_down,
        position=handed_down * correction,
    )


def _velocity_feedback(laws: Laws, seen: PlantResponse, *, known: float) -> ComplexArray:
    """Force asked for by velocity loop and state feedback, sign reversed."""
    estimated = known * laws.observed[:, 0] + np.sum(laws.observed[:, 1:] * seen.sensors, axis=1)
    return np.asarray(laws.path * (laws.velocity * seen.rate + estimated))


def close(scanned: BlockResponses, cut: OpenLoop) -> FrequencyResponse:
    """Return open and closed loop, ``cut`` being that of ``open_loop`` with ``scanned``."""
    moved, disturbed, laws = scanned.moved, scanned.disturbed, cut.laws
    # The observer does not know a disturbance.
    reaction = _velocity_feedback(laws, disturbed, known=0.0) + laws.position * disturbed.encoder
    return FrequencyResponse(
        frequency_hz=scanned.omega / (2 * pi),
        open_loop=cut.whole,
        closed_velocity_loop=laws.handed_down * moved.rate / (1.0 + cut.inner),
        compliance=disturbed.tool - moved.tool * reaction / (1.0 + cut.whole),
    )


def scan(controller: Controller, scanned: BlockResponses) -> FrequencyResponse:
    """Return open and closed loop at the frequencies that were scanned."""
    return close(scanned, open_loop(controller, scanned))


def refine(controller: Controller, blocks: Blocks, found: FrequencyResponse) -> FrequencyResponse:
    """Return a response on the grid with frequencies where margins, bandwidth, peaks are read."""
    for _ in range(REFINEMENTS):
        omega = _between(2 * pi * found.frequency_hz, _intervals_of_interest(found))
        found = _merge(found, scan(controller, scan_blocks(blocks, omega)))
    return found


def frequency_response(plant: Plant, controller: Controller) -> FrequencyResponse:
    """Return open and closed loop from 0.1 Hz to the Nyquist frequency of the velocity cycle.

    Finest where margins, the bandwidth and the peaks are read.
    """
    return complete_response(controller, scan_blocks_on_grid(plant, controller))


def complete_response(controller: Controller, scanned: BlockResponses) -> FrequencyResponse:
    """Return the same where plant and observer have been scanned on the grid already."""
    return refine(controller, scanned.blocks, scan(controller, scanned))


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
    frequency_hz = np.concatenate([one.frequency_hz, other.frequency_hz])
    order = np.argsort(frequency_hz, kind="stable")

    def merged(a: ComplexArray, b: ComplexArray) -> ComplexArray:
        return np.asarray(np.concatenate([a, b])[order])

    return FrequencyResponse(
        frequency_hz=frequency_hz[order],
        open_loop=merged(one.open_loop, other.open_loop),
        closed_velocity_loop=merged(one.closed_velocity_loop, other.closed_velocity_loop),
        compliance=merged(one.compliance, other.compliance),
    )
