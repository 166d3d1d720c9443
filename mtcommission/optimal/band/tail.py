"""The free motion of the tool after a control has ended.

With the moments z_k = ∫ e^{p_k τ} F_set dτ over the remaining time τ, the tool's distance from its
last place a time s after the end is

    e(s) = Re Σ C_k e^{p_k s} z_k - y,        k: the modes and a force lag, y the offset

that is, where the reference lies beside the place at which the tool comes to rest (or beside its
steady motion, for a velocity step).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.band.settings import BandSettings
from mtcommission.optimal.free.mesh import build_mesh
from mtcommission.optimal.free.moments import MomentProblem, all_moment_rows
from mtcommission.optimal.peaks import hermite_peaks
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

UNSEEN = 1e-6
"""Remainder of the cubics, over the band, from which samples are taken closer."""
NEAR = 0.99
"""Share of the band from which a sample may stand next to a peak that leaves it."""
POLISHES = 3
"""Newton steps from a sampled peak to the peak itself."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tail:
    """The free motion of one machine."""

    # Poles p of the modes, then -1/T if there is a force lag; shape (n_rates,) [1/s].
    rates: Complex
    gains: Complex  # C, shape (n_rates,) [m/(N s)]

    @property
    def swinging(self) -> Complex:
        """Poles of the modes, shape (n_modes,) [1/s]."""
        return self.rates[self.rates.imag > 0.0]

    def responses(self, s: Array) -> Complex:
        """Return C_k e^{p_k s}, shape (*s.shape, n_rates)."""
        return np.asarray(self.gains * np.exp(np.multiply.outer(s, self.rates)))

    def moments(self, edges: Array) -> Complex:
        """Return ∫ e^{pτ} dτ over each cell, shape (n_rates, n_cells)."""
        grown = np.expm1(np.multiply.outer(self.rates, edges)) / self.rates[:, np.newaxis]
        return np.asarray(np.diff(grown, axis=1))


def build_tail(plant: Plant) -> Tail:
    """Return the free motion of a plant's tool.

    Source: the tool's row in the eigenvectors of A; docs/optimal-control.md, section 6.

    Examples
    --------
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> build_tail(build_plant(read_shipped("milling-manipulator").machine)).rates.size
    3
    """
    row = np.linalg.solve(all_moment_rows(plant).T, plant.row("tcp"))
    modal = 2 * len(plant.modes)
    lags = plant.lag_rates
    rates = np.array([*(mode.pole for mode in plant.modes), *lags], dtype=complex)
    of_lag = row[modal : modal + len(lags)]
    return Tail(rates=rates, gains=np.append(row[0:modal:2] - 1j * row[1:modal:2], of_lag))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TailPeaks:
    """Where a free motion is farthest from the reference."""

    peak: float  # No |e(s)| is larger, for all s >= 0; at least the level [m]
    places: Array  # s of its local peaks beyond a given level, shape (k,) [s]


def find_tail_peaks(
    tail: Tail, moments: Complex, *, offset: float, level: float, settings: BandSettings
) -> TailPeaks:
    """Return the peak of a free motion, for all time, and its local peaks beyond a level.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if the motion needs more than ``settings.most_samples`` to decay.
    """
    weights = tail.gains * moments
    magnitudes = np.abs(weights)
    horizon = _decayed(tail.rates.real, magnitudes, level - abs(offset))
    if horizon * float(np.abs(tail.swinging).max(initial=0.0)) > (
        settings.radians * settings.most_samples
    ):
        raise ComputationError(Outcome.NO_CONVERGENCE, Message("free-motion-rings-on"))
    problem = MomentProblem(rates=tail.rates, degree=0, target=0.0)
    mesh = build_mesh(problem, horizon, radians=settings.radians)
    real = np.empty(2 * weights.size)
    real[0::2], real[1::2] = weights.real, -weights.imag
    real = real[: problem.size]
    values = real @ mesh.values[:-1] - offset
    slopes = (problem.differentiation @ real) @ mesh.values[:-1]
    remainder = float((magnitudes @ mesh.remainder).max())
    if remainder > UNSEEN * level:
        # Amplitudes far above the band cancel in the sum, but not in its remainder.
        finer = settings.radians * max((0.5 * UNSEEN * level / remainder) ** 0.25, 0.05)
        settings = replace(settings, radians=finer)
        return find_tail_peaks(tail, moments, offset=offset, level=level, settings=settings)
    peak = hermite_peaks(
        mesh.lengths,
        values[:-1, np.newaxis],
        values[1:, np.newaxis],
        start_rate=slopes[:-1, np.newaxis],
        end_rate=slopes[1:, np.newaxis],
    )
    far = np.abs(values)
    inner = (far[1:-1] >= far[:-2]) & (far[1:-1] > far[2:])
    is_peak = np.concatenate(([far[0] > far[1]], inner, [False]))
    chosen = np.flatnonzero(is_peak & (far > NEAR * level))
    return TailPeaks(
        peak=max(float(peak[0]) + remainder, level),
        places=_polished(tail, weights, mesh.nodes, chosen),
    )


def _decayed(decay: Array, magnitudes: Array, level: float) -> float:
    """Return a time after which the amplitudes together stay below a level [s]."""

    def left(s: float) -> float:
        return float(magnitudes @ np.exp(decay * s))

    high = 1.0 / float(np.abs(decay).max())
    while left(high) > level and high < 1e9:
        high *= 1.25
    return high


def _polished(tail: Tail, weights: Complex, nodes: Array, chosen: NDArray[np.intp]) -> Array:
    """Return the peaks next to samples, by Newton's method on the slope within their cells."""
    s = nodes[chosen]
    low, high = nodes[np.maximum(chosen - 1, 0)], nodes[np.minimum(chosen + 1, nodes.size - 1)]
    for _ in range(POLISHES):
        waves = weights * np.exp(np.multiply.outer(s, tail.rates)) * tail.rates
        slope, bend = waves.sum(axis=-1).real, (waves * tail.rates).sum(axis=-1).real
        step = np.divide(slope, bend, out=np.zeros_like(s), where=bend != 0.0)
        s = np.clip(s - step, low, high)
    return s
