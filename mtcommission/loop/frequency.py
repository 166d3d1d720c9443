"""A loop over frequency: open loop, closed velocity loop, compliance of the tool.

The loop is cut at F_set. Everything at the velocity cycle is exact in z = exp(i ω T_v); the
position path is taken in its base band, that is, the images of its slower sampling are left
out (they lie above 1/(2 T_p) and are attenuated by the hold and the plant).

The grid is refined where something is read off it: at crossings and at the highest peaks.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.controller import Controller
from mtcommission.loop.discrete import discretise, discretise_disturbance, discretise_filter
from mtcommission.plant import Plant

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

GRID_POINTS = 800
"""Frequencies before refinement; modes get a cluster of their own (empirical: no crossing of a
shipped machine is missed, and margins do not change when doubled)."""

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
class Answers:
    """What plant and observer do at some frequencies, whatever the gains around them.

    Parameters
    ----------
    omega
        Shape (n,) [rad/s].
    moved, disturbed
        Plant states per set force and per force of disturbance, shape (n, n_plant).
    estimates
        Observer states per known force and per sensor, shape (n, n_observed, 1 + n_sensors).
    """

    omega: Array
    moved: ComplexArray
    disturbed: ComplexArray
    estimates: ComplexArray


def answer_on_grid(plant: Plant, controller: Controller) -> Answers:
    """Return what ``scan`` needs of a loop, the same for all gains.

    Parameters
    ----------
    plant, controller
        The loop; of the controller only velocity cycle, sensors and observer count.

    Returns
    -------
    Answers
        From 0.1 Hz to the Nyquist frequency of the velocity cycle, before refinement.
    """
    return _answer(plant, controller, _grid(plant, controller))


def scan(plant: Plant, controller: Controller, answers: Answers) -> FrequencyResponse:
    """Return open and closed loop at the frequencies of what is known of them.

    Parameters
    ----------
    plant, controller
        The loop.
    answers
        Of the same plant, velocity cycle, sensors and observer.

    Returns
    -------
    FrequencyResponse
    """
    T_v, N = controller.velocity_cycle, controller.cycles
    z = np.exp(1j * answers.omega * T_v)
    pi_law = controller.velocity_gain * (1.0 + T_v / controller.integral_time / (z - 1.0))
    # The position controller's demand reaches the integral branch through the reference model.
    model = _reference_model(controller, z)
    position_law = controller.velocity_gain * (
        1.0 + T_v / controller.integral_time / (z - 1.0) * model
    )
    held = z**-N * (1.0 - z**-N) / (1.0 - 1.0 / z) / N
    path = 1.0 / z
    for item in controller.force_filters:
        stage = discretise_filter(item, controller)
        path = path * (_resolvent(stage.A, stage.B[:, None], z)[:, :, 0] @ stage.C + stage.D)
    observed = np.tensordot(
        answers.estimates, controller.state_gains[list(controller.observer.states)], axes=(1, 0)
    )
    sensors = np.array([plant.row(sensor) for sensor in controller.sensors])
    rate_row = plant.row("encoder") @ plant.A

    def feedback(states: ComplexArray, known: float) -> ComplexArray:
        """Force asked for by velocity loop and state feedback, sign reversed."""
        estimated = known * observed[:, 0] + np.sum(observed[:, 1:] * (states @ sensors.T), axis=1)
        return np.asarray(path * (pi_law * (states @ rate_row) + estimated))

    def position_feedback(states: ComplexArray) -> ComplexArray:
        gain = path * position_law * controller.position_gain * held
        return np.asarray(gain * (states @ plant.row("encoder")))

    moved, disturbed = answers.moved, answers.disturbed
    inner = feedback(moved, 1.0)
    open_loop = inner + position_feedback(moved)
    # The observer does not know a disturbance.
    reaction = feedback(disturbed, 0.0) + position_feedback(disturbed)
    tool = plant.row("tcp")
    return FrequencyResponse(
        frequency_hz=answers.omega / (2 * pi),
        open_loop=open_loop,
        closed_velocity_loop=path * position_law * (moved @ rate_row) / (1.0 + inner),
        compliance=disturbed @ tool - (moved @ tool) * reaction / (1.0 + open_loop),
    )


def refine(plant: Plant, controller: Controller, found: FrequencyResponse) -> FrequencyResponse:
    """Return a response with frequencies added where margins, bandwidth and peaks are read.

    Parameters
    ----------
    plant, controller
        The loop.
    found
        From ``scan`` of ``answer_on_grid``; all of it is kept.

    Returns
    -------
    FrequencyResponse
    """
    for _ in range(REFINEMENTS):
        omega = _between(2 * pi * found.frequency_hz, _intervals_of_interest(found))
        found = _merge(found, respond_at(plant, controller, omega=omega))
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
    return refine(plant, controller, scan(plant, controller, answer_on_grid(plant, controller)))


def respond_at(plant: Plant, controller: Controller, *, omega: Array) -> FrequencyResponse:
    """Return open and closed loop at given frequencies.

    Parameters
    ----------
    plant, controller
        The loop.
    omega
        Shape (n,), below the Nyquist frequency of the velocity cycle [rad/s].

    Returns
    -------
    FrequencyResponse
    """
    return scan(plant, controller, _answer(plant, controller, omega))


def _answer(plant: Plant, controller: Controller, omega: Array) -> Answers:
    z = np.exp(1j * omega * controller.velocity_cycle)
    A, B = discretise(plant, controller.velocity_cycle)
    # A disturbance on the line of the drive force enters like the force state itself.
    entries = np.column_stack([B, discretise_disturbance(plant, controller.velocity_cycle)])
    states = _resolvent(A, entries, z)
    observer = controller.observer
    drives = np.column_stack([observer.B, observer.L])
    return Answers(
        omega=omega,
        moved=states[:, :, 0],
        disturbed=states[:, :, 1],
        estimates=_resolvent(observer.A - observer.L @ observer.C, drives, z),
    )


def _reference_model(controller: Controller, z: ComplexArray) -> ComplexArray:
    """First-order lag at the velocity cycle through which the integral sees its setpoint."""
    if not controller.reference_model_time:
        return np.ones_like(z)
    share = 1.0 - exp(-controller.velocity_cycle / controller.reference_model_time)
    return np.asarray(share / (z - 1.0 + share))


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


def _resolvent(A: Array, drives: Array, z: ComplexArray) -> ComplexArray:
    """(zI - A)^-1 drives at each frequency, shape (n_frequencies, n, n_drives)."""
    matrices = z[:, None, None] * np.eye(A.shape[0]) - A
    return np.asarray(np.linalg.solve(matrices, np.broadcast_to(drives, (z.size, *drives.shape))))
