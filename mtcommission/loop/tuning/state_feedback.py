"""Active damping of the tool: LQR around the closed cascade, states by a Kalman observer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.model.controller import Controller, Observer
from mtcommission.loop.model.discrete import discretise
from mtcommission.loop.tuning.riccati import observer_gains, regulator_gains
from mtcommission.loop.tuning.tuned import TuningSettings
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, PlantMode

Array = NDArray[np.float64]


def is_seen(mode: PlantMode, sensors: tuple[str, ...]) -> bool:
    """Return whether a mode shows in any of the sensors (names of measured outputs)."""
    return mode.measured_gain != 0.0 or ("tcp" in sensors and mode.tcp_gain != 0.0)


def moving_modes(plant: Plant, sensors: tuple[str, ...]) -> tuple[PlantMode, ...]:
    """Return the visible modes that move the tool, the one that moves it most first.

    Ordered by |tcp_gain| / ω of the nominal plant; ``sensors``: names of measured outputs.
    """
    visible = [mode for mode in plant.modes if is_seen(mode, sensors) and mode.tcp_gain]
    return tuple(sorted(visible, key=_tool_share, reverse=True))


def _tool_share(mode: PlantMode) -> float:
    """How far the tool moves by the mode, over the rate q' that this takes."""
    return abs(mode.tcp_gain) / mode.natural_frequency


def add_state_feedback(
    machine: Machine,
    plant: Plant,
    cascade: Controller,
    *,
    weight: float,
    observer: Observer,
) -> Controller:
    """Return the cascade with the state feedback that damps what moves the tool.

    Machine and plant are nominal, ``cascade`` is without state feedback. ``weight``: of the squared
    vibration of the tool against the squared force, in units of what F_max does to the mode that
    moves the tool most [-]; ``observer``: from ``design_observer``.
    """
    gains = _gains(machine, plant, cascade, weight, observer.states)
    return replace(cascade, state_gains=gains, observer=observer)


def given_state_feedback(
    machine: Machine, plant: Plant, cascade: Controller, *, settings: TuningSettings
) -> Controller:
    """Return the cascade with the state gains that the profile gives.

    Machine and plant are nominal, ``cascade`` is without state feedback; ``settings``: assumed
    noises of the observer.

    Raises
    ------
    ComputationError
        NOT_OBSERVABLE if a gain needs a state that the sensors do not see;
        FEEDBACK_DESIGN_FAILED if the observer cannot be computed.
    """
    gains = np.zeros(plant.order)
    for item in machine.control.state_gains:
        gains[plant.states.index(item.state)] = item.value
    observer = design_observer(machine, plant, cascade, settings=settings)
    hidden = [plant.states[i] for i in np.flatnonzero(gains) if i not in observer.states]
    if hidden:
        raise ComputationError(
            Outcome.NOT_OBSERVABLE, Message("loop-hidden-states", states=tuple(hidden))
        )
    return replace(cascade, state_gains=gains, observer=observer)


def design_observer(
    machine: Machine, plant: Plant, cascade: Controller, *, settings: TuningSettings
) -> Observer:
    """Return the stationary Kalman observer at the velocity cycle for all that the sensors see.

    Machine and plant are nominal; of ``cascade`` its sensors and its velocity cycle count, of
    ``settings`` the assumed noises.
    """
    modes = [mode for mode in plant.modes if is_seen(mode, cascade.sensors)]
    states = [plant.position, plant.velocity]
    states += [index for mode in modes for index in (mode.deflection, mode.rate)]
    states.append(plant.force)
    T_v, F_max = cascade.velocity_cycle, machine.drive.max_force
    A, B = discretise(plant, T_v)
    noises = np.zeros((plant.order, 1 + len(modes)))
    noises[:, 0] = settings.force_noise * F_max * B
    for column, mode in enumerate(modes, start=1):
        noises[mode.rate, column] = settings.mode_noise * F_max * mode.scale * T_v
    A, B, G = A[np.ix_(states, states)], B[states], noises[states]
    C = np.array([plant.row(sensor) for sensor in cascade.sensors])[:, states]
    # Noises of variance 1 and states in units of what they move by in a cycle under F_max, so
    # that the Riccati equation sees no extreme numbers.
    scale = np.abs(B) * F_max
    scaled = (A * scale / scale[:, None], G / scale[:, None], C * scale / settings.position_noise)
    with _riccati_errors("loop-observer-failed"):
        L = observer_gains(*scaled) * scale[:, None] / settings.position_noise
    return Observer(states=tuple(states), A=A, B=B, C=C, L=L)


def _gains(
    machine: Machine,
    plant: Plant,
    controller: Controller,
    weight: float,
    observed: tuple[int, ...],
) -> Array:
    """LQR gains on the observed plant states, shape (n_plant,).

    The design model is the plant under its continuous cascade, with the integrator as last
    state, without the modes that no sensor sees (no gain can use them) and with a trace of
    damping on every mode: so its Riccati equation has a stabilising solution even where a
    mode is stated as undamped. The gain on the integrator is left out: the cost does not
    weigh it.
    """
    n, Kp = plant.order, controller.velocity_gain
    encoder = plant.row("encoder")
    A = np.zeros((n + 1, n + 1))
    A[:n, :n] = plant.A
    A[n, :n] = -(encoder @ plant.A + controller.position_gain * encoder) / controller.integral_time
    law = Kp * np.concatenate([encoder @ plant.A + controller.position_gain * encoder, [-1.0]])
    B = np.append(plant.B, 0.0)
    # States in units of what F_max does at the first mode's frequency: all numbers near 1.
    damped = moving_modes(plant, controller.sensors)
    force, omega = machine.drive.max_force, damped[0].natural_frequency
    scale = np.full(n + 1, force / (plant.moving_mass * omega**2))
    scale[[plant.velocity, n]] *= omega
    scale[plant.force] = force
    for item in plant.modes:
        scale[item.deflection] = abs(item.scale) * force / omega**2
        scale[item.rate] = abs(item.scale) * force / omega
        zeta = max(item.damping_ratio, LEAST_DAMPING)
        A[item.rate, item.rate] = -2.0 * zeta * item.natural_frequency
    A = (A - np.outer(B, law)) * scale / scale[:, None] / omega
    Q = np.zeros((n + 1, n + 1))
    for item in damped:
        Q[item.rate, item.rate] = weight * (_tool_share(item) / _tool_share(damped[0])) ** 2
    kept = [*observed, n]
    inside = np.ix_(kept, kept)
    B = (B * force / scale / omega)[kept]
    with _riccati_errors("loop-gains-failed"):
        K = regulator_gains(A[inside], B, Q[inside])
    gains = np.zeros(n)
    gains[kept[:-1]] = (K * force / scale[kept])[:-1]
    return gains


@contextmanager
def _riccati_errors(kind: str) -> Iterator[None]:
    """Name what scipy raises where a Riccati equation defeats them."""
    try:
        yield
    except (ValueError, np.linalg.LinAlgError) as error:
        detail = Message(kind, error=str(error))
        raise ComputationError(Outcome.FEEDBACK_DESIGN_FAILED, detail) from error


LEAST_DAMPING = 1e-4
"""Damping ratio that the design of the state feedback takes for granted (empirical: far below
any real joint, and enough for the Riccati solver)."""
