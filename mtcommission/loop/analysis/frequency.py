"""A loop over frequency: open loop, closed velocity loop, compliance of the tool.

The loop is cut at F_set. Everything at the velocity cycle is exact in z = exp(i ω T_v); a
position loop that closes in the control is taken in its base band, that is, the images of its
slower sampling are left out (they lie above 1/(2 T_p) and are attenuated by the hold and the
plant). python-control gives the same to 1e-9 from ``diagram.build_open_loop`` (tested) in 40 ms
instead of the 0.1 ms that one more gain takes here: tuning asks for some hundred.

The grid is refined where something is read off it: at crossings and at the highest peaks.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.loop.analysis.block_responses import (
    BlockResponses,
    Blocks,
    PlantResponse,
    scan_blocks,
    scan_blocks_on_grid,
)
from mtcommission.loop.model.controller import Controller, filter_polynomials
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

SQRT_HALF = sqrt(0.5)
"""-3 dB."""

REFINEMENTS = 2
REFINED_POINTS = 15
"""Each refinement divides every interval of interest by so much: two leave a spacing of 0.004 %,
and what is interpolated on it is right to 1e-6 (tested against root finding). Odd, so that the
middle, perhaps an undamped resonance, is left out."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyResponse:
    """Responses over frequency.

    Parameters
    ----------
    frequency_hz
        Shape (n,) [Hz].
    open_loop
        L, loop cut at F_set, shape (n,).
    closed_velocity_loop
        Velocity setpoint to encoder velocity, position loop open, shape (n,).
    compliance
        Tool displacement per disturbance force on the line of the drive force, all loops
        closed, shape (n,) [m/N].
    """

    frequency_hz: Array
    open_loop: ComplexArray
    closed_velocity_loop: ComplexArray
    compliance: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Laws:
    """What the controller makes of what it sees, over frequency, each of shape (n,).

    Parameters
    ----------
    path
        Dead time of the velocity cycle and set-force filters, force asked for to force.
    velocity
        Error of the velocity to force asked for.
    observed
        Known force and each sensor, by observer and state gains, to force asked for, shape
        (n, 1 + n_sensors).
    handed_down, position
        What the position cycle hands down, and the position of the encoder, to force.
    """

    path: ComplexArray
    velocity: ComplexArray
    observed: ComplexArray
    handed_down: ComplexArray
    position: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OpenLoop:
    """The loop cut at F_set.

    Parameters
    ----------
    laws
        Of its controller.
    inner, whole
        Without and with the position loop, shape (n,).
    """

    laws: Laws
    inner: ComplexArray
    whole: ComplexArray

    @property
    def sensitivity_peak(self) -> float:
        """Largest |1/(1 + L)| at these frequencies [-]."""
        return float(np.max(1.0 / np.abs(1.0 + self.whole)))


def open_loop(controller: Controller, scanned: BlockResponses) -> OpenLoop:
    """Return the loop cut at F_set.

    Parameters
    ----------
    controller
        Its gains.
    scanned
        Of a plant with the same velocity cycle, sensors and observer.
    """
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
    """Return open and closed loop.

    Parameters
    ----------
    scanned, cut
        Of plant and observer, and from ``open_loop`` with these.
    """
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
    """Return open and closed loop at the frequencies of what is known of them.

    Parameters
    ----------
    controller
        Its gains.
    scanned
        Of a plant with the same velocity cycle, sensors and observer.
    """
    return close(scanned, open_loop(controller, scanned))


def refine(controller: Controller, blocks: Blocks, found: FrequencyResponse) -> FrequencyResponse:
    """Return a response with frequencies added where margins, bandwidth and peaks are read.

    Parameters
    ----------
    controller
        Its gains.
    blocks
        Plant and observer.
    found
        From ``scan`` of ``scan_blocks_on_grid``; all of it is kept.
    """
    for _ in range(REFINEMENTS):
        omega = _between(2 * pi * found.frequency_hz, _intervals_of_interest(found))
        found = _merge(found, scan(controller, scan_blocks(blocks, omega)))
    return found


def frequency_response(plant: Plant, controller: Controller) -> FrequencyResponse:
    """Return open and closed loop over frequency.

    Parameters
    ----------
    plant, controller
        The loop.

    Returns
    -------
    FrequencyResponse
        From 0.1 Hz to the Nyquist frequency of the velocity cycle, finest where margins, the
        bandwidth and the peaks are read.
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
