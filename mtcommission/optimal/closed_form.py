"""The motion of a plant after a step, an impulse or from a state, in closed form.

The modes do not couple, so all states are sums of exponentials: a grid of times costs one
vectorised expression, and no matrix exponential.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


def step_response(plant: Plant, tau: Array) -> Array:
    """Return the states a time τ after a unit step of the set force from rest; 0 for τ <= 0.

    Parameters
    ----------
    plant
        Plant with n states.
    tau
        Times since the step, any shape [s].

    Returns
    -------
    ndarray, shape (*tau.shape, n)

    Source: partial fractions of the transfer functions.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> [round(float(f), 6) for f in step_response(plant, np.array([-1.0, 2.5e-3]))[:, plant.force]]
    [0.0, 0.632121]
    """
    T, lag = plant.force_lag, -1.0 / plant.force_lag
    after = np.maximum(np.asarray(tau, dtype=np.float64), 0.0)
    rise = -np.expm1(lag * after)
    out = np.zeros((*after.shape, plant.order))
    out[..., plant.force] = rise
    out[..., plant.velocity] = (after - T * rise) / plant.moving_mass
    out[..., plant.position] = (after**2 / 2 - T * after + T**2 * rise) / plant.moving_mass
    for mode in plant.modes:
        omega, p = mode.natural_frequency, mode.pole
        at_lag = -1.0 / (lag**2 + 2.0 * mode.damping_ratio * omega * lag + omega**2)
        at_pole = 1.0 / ((p - p.conjugate()) * (T * p + 1.0) * p)
        fall, turn = at_lag * (1.0 - rise), 2.0 * at_pole * np.exp(p * after)
        started = np.asarray(after > 0.0)
        out[..., mode.deflection] = mode.scale * (omega**-2.0 + fall + turn.real) * started
        out[..., mode.rate] = mode.scale * (lag * fall + (p * turn).real) * started
    return out


def impulse_response(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ) B in closed form.

    Parameters
    ----------
    plant
        Plant with n states.
    tau
        Times >= 0, any shape [s].

    Returns
    -------
    ndarray, shape (*tau.shape, n)

    Source: derivative of the step response.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> tau = np.array(1e-3)
    >>> bool(np.allclose(impulse_response(plant, tau), transition(plant, tau) @ plant.B))
    True
    """
    T, lag = plant.force_lag, -1.0 / plant.force_lag
    fall = np.exp(lag * np.asarray(tau, dtype=np.float64))
    rise = -np.expm1(lag * tau)
    out = np.empty((*fall.shape, plant.order))
    out[..., plant.force] = fall / T
    out[..., plant.velocity] = rise / plant.moving_mass
    out[..., plant.position] = (tau - T * rise) / plant.moving_mass
    for mode in plant.modes:
        omega, p = mode.natural_frequency, mode.pole
        at_lag = 1.0 / (lag**2 + 2.0 * mode.damping_ratio * omega * lag + omega**2)
        turn = 2.0 / ((p - p.conjugate()) * (p - lag)) * np.exp(p * tau)
        scale = mode.scale / T
        out[..., mode.deflection] = scale * (at_lag * fall + turn.real)
        out[..., mode.rate] = scale * (lag * at_lag * fall + (p * turn).real)
    return out


def transition(plant: Plant, tau: Array) -> Array:
    """Return expm(A τ) in closed form.

    Parameters
    ----------
    plant
        Plant with n states.
    tau
        Times >= 0, any shape [s].

    Returns
    -------
    ndarray, shape (*tau.shape, n, n)

    Source: free oscillation of each mode; the column of the force by partial fractions.

    Examples
    --------
    >>> from scipy.linalg import expm
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> bool(np.allclose(transition(plant, np.array(1e-3)), expm(plant.A * 1e-3), atol=1e-12))
    True
    """
    tau = np.asarray(tau, dtype=np.float64)
    T, lag, force = plant.force_lag, -1.0 / plant.force_lag, plant.force
    fall, rise = np.exp(lag * tau), -np.expm1(lag * tau)
    out = np.zeros((*tau.shape, plant.order, plant.order))
    out[..., plant.position, plant.position] = out[..., plant.velocity, plant.velocity] = 1.0
    out[..., plant.position, plant.velocity] = tau
    out[..., force, force] = fall
    out[..., plant.velocity, force] = T * rise / plant.moving_mass
    out[..., plant.position, force] = (T * tau - T**2 * rise) / plant.moving_mass
    for mode in plant.modes:
        omega, zeta, p = mode.natural_frequency, mode.damping_ratio, mode.pole
        d, v = mode.deflection, mode.rate
        decay, wave = np.exp(p.real * tau), p.imag * tau
        c, s = decay * np.cos(wave), decay * np.sin(wave) / p.imag
        out[..., d, d], out[..., d, v] = c + zeta * omega * s, s
        out[..., v, d], out[..., v, v] = -(omega**2) * s, c - zeta * omega * s
        at_lag = 1.0 / (lag**2 + 2.0 * zeta * omega * lag + omega**2)
        turn = 2.0 / ((p - p.conjugate()) * (p - lag)) * np.exp(p * tau)
        out[..., d, force] = mode.scale * (at_lag * fall + turn.real)
        out[..., v, force] = mode.scale * (lag * at_lag * fall + (p * turn).real)
    return out
