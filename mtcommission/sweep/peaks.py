"""Peaks of many bang-bang controls on one plant at once.

Between switches, under a set force u, the motion of each mode is known in closed form,

    w(t) = e^{pt} w_0 + u (e^{pt} - 1)/p + (F_0 - u) (e^{pt} - e^{-t/T})/(p + 1/T)

for w' = p w + F, and q = Im w / Im p, q' = Re w + Re p q; where u acts at once, without the last
term. Samples are laid so close that the cubic through values and rates gives the peak between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.free.curve import CurvePoint
from mtcommission.optimal.peaks import hermite_peaks
from mtcommission.plant.plant import Plant, PlantMode

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

FINE = 0.5
"""ω h of the samples [rad]: a relative error below (ω h)^4/384 = 2e-4."""

MOST_CELLS = 4000
"""Samples in one arc at most: a long arc's vibration has died out before its end."""

TOGETHER = 2**17
"""Samples computed together: keeps the memory flat."""


def curve_peaks(plant: Plant, points: Sequence[CurvePoint], force_limits: Array) -> Array:
    """Return the peaks of ``rows.peak_signals`` for each control.

    Parameters
    ----------
    plant
        Plant of all controls, from ``driven_at_once``.
    points
        Controls.
    force_limits
        Force of each, shape (n_points,) [N].

    Returns
    -------
    ndarray, shape (n_points, n_modes + 2)
        Rate of each mode, TCP vibration, motor force.
    """
    found = np.empty((len(points), len(plant.modes) + 2))
    fastest = max((mode.natural_frequency for mode in plant.modes), default=0.0)
    alike: dict[tuple[int, float], list[int]] = {}
    for place, point in enumerate(points):
        alike.setdefault((len(point.zeros), point.first_sign), []).append(place)
    for (count, last_sign), places in alike.items():
        begin = last_sign * (-1.0) ** count
        signs: Array = begin * (-1.0) ** np.arange(count + 1, dtype=np.float64)
        knots = np.array([[0.0, *points[i].switching_times, points[i].t_f] for i in places])
        longest = float(np.max(np.diff(knots)))
        cells = min(max(int(np.ceil(fastest * longest / FINE)), 4), MOST_CELLS)
        size = max(TOGETHER // cells, 1)
        for first in range(0, len(places), size):
            part = places[first : first + size]
            found[part] = force_limits[part, None] * _unit_peaks(
                plant, knots[first : first + size], signs, cells
            )
    return found


def _unit_peaks(plant: Plant, knots: Array, signs: Array, cells: int) -> Array:
    """Peaks under a force of 1 N with a sign in each arc between the knots.

    Knots of shape (n, n_arcs + 1) [s], peaks of shape (n, n_modes + 2).
    """
    T, poles = plant.force_lag, [_pole(mode) for mode in plant.modes]
    F = np.zeros((len(knots), 1))
    w = [np.zeros((len(knots), 1), dtype=np.complex128) for _ in poles]
    largest = np.zeros((len(knots), len(poles) + 2))
    for lengths, sign in zip(np.diff(knots).T, signs.tolist(), strict=True):
        age = lengths[:, None] * np.linspace(0.0, 1.0, cells + 1)
        fade = np.exp(-age / T) if T else np.zeros_like(age)
        excess = F - sign
        force = sign + excess * fade
        signals = []
        for i, p in enumerate(poles):
            turn = np.exp(p * age)
            lagging = T * excess * (turn - fade) / (T * p + 1.0)
            whole = turn * w[i] + sign * (turn - 1.0) / p + lagging
            signals.append(_mode_signals(plant.modes[i], p, whole, force))
            w[i] = whole[:, -1:]
        F = force[:, -1:]
        found = _arc_peaks(plant, signals, lengths / cells)
        # Between knots the motor force only tends to the set force.
        largest = np.maximum(largest, np.column_stack([found, np.abs(F)]))
    return largest


def _pole(mode: PlantMode) -> complex:
    omega, zeta = mode.natural_frequency, mode.damping_ratio
    return complex(-zeta * omega, omega * sqrt(1.0 - zeta**2))


def _mode_signals(mode: PlantMode, p: complex, w: Complex, force: Array) -> Array:
    """q, q' and q'' from w, shape (3, n, n_samples)."""
    q = w.imag / p.imag
    rate = w.real + p.real * q
    return np.stack([q, rate, force + 2.0 * p.real * rate - mode.natural_frequency**2 * q])


def _arc_peaks(plant: Plant, signals: list[Array], step: Array) -> Array:
    """Peaks of the modes' rates and of the TCP vibration in one arc, shape (n, n_modes + 1)."""
    tool = sum(mode.tcp_gain * item for mode, item in zip(plant.modes, signals, strict=True))
    scaled = [mode.scale * item[1:] for mode, item in zip(plant.modes, signals, strict=True)]
    value, rate = np.stack([*scaled, np.asarray(tool)[:2]], axis=-1)
    value, rate = value.swapaxes(0, 1), step[:, None] * rate.swapaxes(0, 1)
    flat = (len(value) - 1, -1)
    peaks = hermite_peaks(
        np.ones(flat[0]),
        value[:-1].reshape(flat),
        value[1:].reshape(flat),
        start_rate=rate[:-1].reshape(flat),
        end_rate=rate[1:].reshape(flat),
    )
    return peaks.reshape(value.shape[1:])
