"""The free motion of a plant after a control has ended, and its peaks for all time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.free.moments import all_moment_rows

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

RADIANS, BLOCK = 0.2, 64
"""Between samples, of the fastest rate, and how many of them one power of it serves."""
MOST_SAMPLES = 400_000
"""Of a free motion, until it has decayed below the band."""
NEAR = 0.97
"""Share of the band from which a sample may stand next to a peak that leaves it."""
POLISHES = 4
"""Newton steps from a sampled peak to the peak itself."""


def free_row(plant: Plant, row: Array) -> Array:
    """Return the row of a signal's distance from its rest, or its steady motion, shape (n,).

    Source: the row in the left eigenvectors of A without momentum and place of rest.
    """
    basis = all_moment_rows(plant)
    return np.asarray(np.linalg.solve(basis.T, row)[:-2] @ basis[:-2])


def free_rates(plant: Plant) -> Complex:
    """Return the poles of the modes, then that of a force lag, shape (n_rates,) [1/s]."""
    return np.array([*(mode.pole for mode in plant.modes), *plant.lag_rates], dtype=complex)


def free_gains(plant: Plant, rows: Array) -> Complex:
    """Return C of signals r x(t_f + s) = Re Σ_k C_k z_k e^{p_k s}, shape (n_rows, n_rates).

    z_k = ∫ e^{p_k τ} F_set dτ are the moments of the force; docs/optimal-control.md, section 6.
    """
    parts, modal = np.linalg.solve(all_moment_rows(plant).T, rows.T).T, 2 * len(plant.modes)
    of_lag = parts[:, modal : modal + len(plant.lag_rates)]
    return np.hstack([parts[:, 0:modal:2] - 1j * parts[:, 1:modal:2], of_lag])


def free_moments(plant: Plant, state: Array) -> Complex:
    """Return the moments z of the force that has led to a state, shape (n_rates,)."""
    parts, modal = all_moment_rows(plant) @ state, 2 * len(plant.modes)
    of_lag = parts[modal : modal + len(plant.lag_rates)]
    return np.concatenate([parts[0:modal:2] + 1j * parts[1:modal:2], of_lag])


def free_peaks(
    rates: Complex, weights: Complex, *, offset: float
) -> tuple[NDArray[np.intp], Array, Array]:
    """Return the peaks of |Re Σ w_k e^{p_k s} - offset| near 1 and above, for all s >= 0.

    Rates and weights of shape (m, k); indices of the motions, s and heights.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if a motion needs too many samples to decay.
    """
    if not weights.size:
        return np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros(0)
    step = RADIANS / float(np.abs(rates).max())
    longest, level = MOST_SAMPLES * step, 1.0 - abs(offset)
    horizon = _decayed(rates.real, np.abs(weights), level, longest=longest)
    if horizon > longest:
        raise ComputationError(Outcome.NO_CONVERGENCE, Message("free-motion-rings-on"))
    blocks = int(np.ceil(horizon / step / BLOCK)) + 1
    far = weights[..., np.newaxis] * np.exp(
        rates[..., np.newaxis] * (BLOCK * step * np.arange(blocks))
    )
    near = np.exp(rates[..., np.newaxis] * (step * np.arange(BLOCK)))
    values = (np.swapaxes(far, -1, -2) @ near).real.reshape(len(weights), -1) - offset
    size = np.pad(np.abs(values), ((0, 0), (1, 0)))
    is_peak = (size[:, 1:-1] >= size[:, :-2]) & (size[:, 1:-1] > size[:, 2:])
    motion, at = np.nonzero(is_peak & (size[:, 1:-1] > NEAR))
    p, w, first = rates[motion], weights[motion], step * at
    low, high, s = np.maximum(first - step, 0.0), first + step, first
    for _ in range(POLISHES):
        waves = w * np.exp(s[:, np.newaxis] * p) * p
        slope, bend = waves.sum(axis=-1).real, (waves * p).sum(axis=-1).real
        s = np.clip(s - np.divide(slope, bend, out=np.zeros_like(s), where=bend != 0.0), low, high)
    height = np.abs((w * np.exp(s[:, np.newaxis] * p)).sum(axis=-1).real - offset)
    sample = size[motion, at + 1]
    # The free motion may begin at its largest.
    return motion, np.where(height >= sample, s, first), np.maximum(height, sample)


def _decayed(decay: Array, magnitudes: Array, level: float, *, longest: float) -> float:
    """Return a time after which all amplitudes of each motion stay below a level [s]."""
    s = 1.0 / float(np.abs(decay).max())
    while float((magnitudes * np.exp(decay * s)).sum(axis=1).max()) > level and s < longest:
        s *= 1.25
    return s
