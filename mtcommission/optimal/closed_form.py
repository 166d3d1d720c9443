"""The motion of a plant after a step, an impulse or from a state, in closed form.

The modes do not couple, so all states are sums of exponentials: a grid of times costs one
vectorised expression, and no matrix exponential.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.plant.plant import Plant, PlantMode, driven_at_once

Array = NDArray[np.float64]


def step_response(plant: Plant, tau: Array) -> Array:
    """Return the states a time τ after a unit step of the input from rest; 0 for τ <= 0.

    The input is the set force, or the jerk of a motor that follows.

    Source: partial fractions of the transfer functions.
    """
    if plant.follows:
        return _ramp_response(plant, np.maximum(np.asarray(tau, dtype=np.float64), 0.0))
    T, after = plant.force_lag, np.maximum(np.asarray(tau, dtype=np.float64), 0.0)
    rise, fall = _rise(plant, after), _fall(plant, after)
    out = np.zeros((*after.shape, plant.order))
    out[..., plant.lagged] = rise[..., np.newaxis]
    out[..., plant.velocity] = (after - T * rise) / plant.moving_mass
    out[..., plant.position] = (after**2 / 2 - T * after + T**2 * rise) / plant.moving_mass
    for mode in plant.modes:
        p = mode.pole
        left = _left(plant, mode, fall)
        turn = 2.0 / ((p - p.conjugate()) * (T * p + 1.0) * p) * np.exp(p * after)
        started = np.asarray(after > 0.0)
        deflection = mode.natural_frequency**-2.0 - T**2 * left + turn.real
        out[..., mode.deflection] = mode.scale * deflection * started
        out[..., mode.rate] = mode.scale * (T * left + (p * turn).real) * started
    return out


def _ramp_response(plant: Plant, tau: Array) -> Array:
    """Return the states a time τ after the jerk of a motor that follows has become 1."""
    moved = step_response(driven_at_once(plant), tau)
    out = np.empty((*tau.shape, plant.order))
    out[..., plant.force] = tau
    out[..., plant.velocity] = tau**2 / 2.0
    out[..., plant.position] = tau**3 / 6.0
    for mode in plant.modes:
        p = mode.pole
        turn = 2.0 / ((p - p.conjugate()) * p**2) * np.expm1(p * tau)
        out[..., mode.deflection] = mode.scale * (tau / mode.natural_frequency**2 + turn.real)
        out[..., mode.rate] = moved[..., mode.deflection]
    return out


def _rise(plant: Plant, tau: Array) -> Array:
    """Return the share 1 - e^{-τ/T} of a set force that acts after τ; 1 without a lag."""
    return -np.expm1(-tau / plant.force_lag) if plant.force_lag else np.ones_like(tau)


def _fall(plant: Plant, tau: Array) -> Array:
    """Return the rest e^{-τ/T}; 0 without a lag."""
    return np.exp(-tau / plant.force_lag) if plant.force_lag else np.zeros_like(tau)


def _left(plant: Plant, mode: PlantMode, fall: Array) -> Array:
    """Return e^{-τ/T} / (1 - 2 ζ ω T + (ω T)²), the lag's share in a mode's answer."""
    bend = mode.natural_frequency * plant.force_lag
    return fall / (1.0 - 2.0 * mode.damping_ratio * bend + bend**2)


def impulse_response(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ) B in closed form.

    Source: derivative of the step response.
    """
    T, tau = plant.force_lag, np.asarray(tau, dtype=np.float64)
    if plant.follows:
        moved = step_response(driven_at_once(plant), tau)
        return np.concatenate([moved, np.ones((*tau.shape, 1))], axis=-1)
    rise, fall = _rise(plant, tau), _fall(plant, tau)
    out = np.empty((*tau.shape, plant.order))
    out[..., plant.lagged] = fall[..., np.newaxis] / (T or 1.0)
    out[..., plant.velocity] = rise / plant.moving_mass
    out[..., plant.position] = (tau - T * rise) / plant.moving_mass
    for mode in plant.modes:
        p = mode.pole
        left = _left(plant, mode, fall)
        turn = 2.0 / ((p - p.conjugate()) * (T * p + 1.0)) * np.exp(p * tau)
        out[..., mode.deflection] = mode.scale * (T * left + turn.real)
        out[..., mode.rate] = mode.scale * ((p * turn).real - left)
    return out


def advance(plant: Plant, states: Array, tau: Array) -> Array:
    """Return expm(A τ) x of many states and times, (..., n) and (...), in closed form.

    Source: free oscillation of each mode; what a force leaves, if it has a lag, from B.
    """
    tau = np.asarray(tau, dtype=np.float64)
    out = np.empty(np.broadcast_shapes(states.shape, (*tau.shape, 1)))
    out[...] = states
    out[..., plant.position] += tau * states[..., plant.velocity]
    for mode in plant.modes:
        omega, zeta, p = mode.natural_frequency, mode.damping_ratio, mode.pole
        d, v = states[..., mode.deflection], states[..., mode.rate]
        decay, wave = np.exp(p.real * tau), p.imag * tau
        c, s = decay * np.cos(wave), decay * np.sin(wave) / p.imag
        out[..., mode.deflection] = (c + zeta * omega * s) * d + s * v
        out[..., mode.rate] = -(omega**2) * s * d + (c - zeta * omega * s) * v
    # A force is what an impulse of the input leaves, behind a lag T times that.
    if plant.force_lag or plant.follows:
        force = states[..., plant.force, np.newaxis] * (plant.force_lag or 1.0)
        out[..., plant.force] = 0.0
        out += force * impulse_response(plant, tau)
    return out


def transition(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ) in closed form."""
    columns = advance(plant, np.eye(plant.order), np.asarray(tau)[..., np.newaxis])
    return np.asarray(np.swapaxes(columns, -1, -2))
