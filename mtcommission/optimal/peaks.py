"""Largest magnitudes of sampled signals, between the samples too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.plant.plant import Plant

Array = NDArray[np.float64]


def signal_rows(plant: Plant) -> Array:
    """Return the rows c with signal = c x for all ``Plant.signals``."""
    return np.vstack([np.eye(plant.order), plant.C])


def unit_cubics(
    step: Array, start: Array, end: Array, *, start_rate: Array, end_rate: Array
) -> Array:
    """Return the cubic in each cell that takes the values and derivatives at its ends."""
    rise, first, last = end - start, step * start_rate, step * end_rate
    return np.stack([first + last - 2.0 * rise, 3.0 * rise - 2.0 * first - last, first, start])


def hermite_peaks(
    step: Array, start: Array, end: Array, *, start_rate: Array, end_rate: Array
) -> Array:
    """Return the largest magnitude of each signal, interpolated cubically in each cell.

    Examples
    --------
    >>> t = np.linspace(0.0, 3.0, 31)[:, None]
    >>> y, dy = np.sin(t), np.cos(t)
    >>> peak = hermite_peaks(np.diff(t[:, 0]), y[:-1], y[1:], start_rate=dy[:-1], end_rate=dy[1:])
    >>> bool(abs(peak[0] - 1.0) < 1e-6)
    True
    """
    largest = np.maximum(np.abs(start).max(axis=0), np.abs(end).max(axis=0))
    reach = step[:, None] / 3.0
    inner = np.maximum(np.abs(start + reach * start_rate), np.abs(end - reach * end_rate))
    # A cubic stays within its control points: few cells can exceed what their ends reach.
    may_exceed = np.flatnonzero((inner > largest).any(axis=1))
    cube, square, first, start = unit_cubics(
        step[may_exceed, None],
        start[may_exceed],
        end[may_exceed],
        start_rate=start_rate[may_exceed],
        end_rate=end_rate[may_exceed],
    )
    root = np.sqrt(np.maximum(square**2 - 3.0 * first * cube, 0.0))
    # both roots of first + 2 square s + 3 cube s², in the form that does not cancel
    q = -(square + np.copysign(root, square))
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.clip(np.nan_to_num(np.stack([q / (3.0 * cube), first / q])), 0.0, 1.0)
    inside = start + places * (first + places * (square + places * cube))
    return np.asarray(np.maximum(largest, np.abs(inside).max(axis=(0, 1), initial=0.0)))
