"""Least squares whose errors know that what is left is no white noise; of damped vibrations, too.

    y(t) = c + Σ e^(-ζ ω t) (A cos ω_d t + B sin ω_d t),   ω_d = ω √(1 - ζ²)

c and the amplitudes enter linearly and are eliminated at each step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np

from mtcommission.machine.identified import Estimate
from mtcommission.measured.measurement import Array, ComplexArray

RATIO = 0.05
"""Damping ratio that weighs in a step like the whole frequency."""
MOST_DAMPING = 0.6


@dataclass(frozen=True, slots=True, eq=False)
class Equations:
    """Values, shape (n,), that are some columns, (n, m), times what is sought: of one move."""

    columns: Array
    values: Array

    @staticmethod
    def of(all_of: Sequence[Equations]) -> Equations:
        """Return the equations of several moves."""
        columns, values = zip(*((one.columns, one.values) for one in all_of), strict=True)
        return Equations(np.vstack(columns), np.concatenate(values))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Regression:
    """What explains a signal by some columns."""

    values: Array  # one for each column
    sigma: Array  # their standard errors
    variance: float  # of the rest, as often larger as samples are correlated
    rest: Array  # of the signal, shape (n,)


def regress(columns: Array, signal: Array, *, correlated: float = 0.0) -> Regression:
    """Return the least-squares solution.

    ``correlated``: how many samples count as one; 0: as what is left shows.
    """
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    A = columns / scale
    found = np.linalg.lstsq(A, signal, rcond=None)[0]
    rest = signal - A @ found
    length = correlated or correlation_length(rest)
    variance = length * float(rest @ rest) / max(rest.size - scale.size, 1)
    spread = np.maximum(np.diag(np.linalg.pinv(A.T @ A)), 0.0)
    sigma = np.sqrt(variance * spread) / scale
    return Regression(values=found / scale, sigma=sigma, variance=variance, rest=rest)


def neighbours(values: Array, count: int) -> Array:
    """Return each value among an odd number of neighbours, mirrored at the ends, (n, count)."""
    padded = np.pad(values, count // 2, mode="symmetric")
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, count))


def information_criterion(cost: float, size: int, parameters: int, correlated: float) -> float:
    """Return the Bayesian information criterion of a fit, noise of unknown size.

    ``cost``: sum of ``size`` squares, of which ``correlated`` are worth one independent one.
    Source: G. Schwarz, Ann. Stat. 6 (1978).
    """
    n = size / correlated
    return n * log(cost / size) + parameters * log(n)


def correlation_length(rest: Array | ComplexArray) -> float:
    """Return how many samples of what a fit leaves are worth one independent one, at least 1.

    One and twice the sum of the autocorrelations before the first that is not significant.
    """
    power = np.abs(np.fft.fft(rest, 2 * rest.size)) ** 2
    lags = np.fft.ifft(power).real[: rest.size // 4]
    if lags.size < 2 or lags[0] <= 0.0:
        return 1.0
    rho = lags / lags[0]
    values = rest.size * (2 if np.iscomplexobj(rest) else 1)
    end = int(np.argmax(rho < 2.0 / sqrt(values))) or rho.size
    return float(max(1.0 + 2.0 * rho[1:end].sum(), 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeMode:
    """One vibration that dies away."""

    frequency_hz: Estimate  # natural frequency [Hz]
    damping_ratio: Estimate
    amplitude: float  # at the first sample [as the signal]

    @property
    def pole(self) -> complex:
        """The one above the real axis [1/s]."""
        zeta = self.damping_ratio.value
        return 2 * pi * self.frequency_hz.value * complex(-zeta, sqrt(max(1.0 - zeta**2, 0.0)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Damped:
    """Vibrations that explain a signal, in the order in which they were begun with."""

    modes: tuple[FreeMode, ...]
    errors: tuple[float, ...]  # standard errors of their amplitudes
    rest: Array  # of the signal


def weigh(t: Array, y: Array, poles: Sequence[complex]) -> tuple[Array, Array]:
    """Return what an offset and the vibrations of some poles [1/s] weigh in a signal, and the rest.

    Weights of the cosine and the sine for each pole behind that of the offset.
    """
    basis = _basis(t, poles)
    weights = np.asarray(np.linalg.lstsq(basis, y, rcond=None)[0], dtype=np.float64)
    return weights, y - basis @ weights


def fit_damped(
    t: Array,
    y: Array,
    start: Sequence[complex],
    *,
    held: Sequence[complex] = (),
    ends: tuple[float, float],
) -> Damped:
    """Return the vibrations near some poles that leave least of a signal.

    ``held``: poles that stay; ``ends``: between which factors frequencies may change. Raises
    LinAlgError or ValueError where the signal tells nothing.
    """
    from scipy.optimize import least_squares  # slow to load

    begin = np.array(start)
    omega = np.abs(begin)
    scale = np.column_stack([omega, np.full(begin.size, RATIO)])
    x0 = np.column_stack([np.ones(begin.size), -begin.real / omega / RATIO]).ravel()
    low = np.tile([ends[0], 0.0], begin.size)
    high = np.tile([ends[1], MOST_DAMPING / RATIO], begin.size)

    def poles_of(x: Array) -> list[complex]:
        rows = x.reshape(-1, 2) * scale
        return [*(complex(-z * w, w * sqrt(max(1.0 - z * z, 1e-6))) for w, z in rows), *held]

    def left(x: Array) -> Array:
        return weigh(t, y, poles_of(x))[1]

    solved = least_squares(left, np.clip(x0, low + 1e-6, high - 1e-6), bounds=(low, high))
    poles = poles_of(solved.x)
    weights, rest = weigh(t, y, poles)
    sigma = regress(np.column_stack([np.asarray(solved.jac), _basis(t, poles)]), rest).sigma
    values, errors = (one.reshape(-1, 2) * scale for one in (solved.x, sigma[: 2 * begin.size]))
    sizes, doubts = (
        np.hypot(*one.reshape(-1, 2)[: begin.size].T)
        for one in (weights[1:], sigma[2 * begin.size + 1 :])
    )
    modes = tuple(
        FreeMode(
            frequency_hz=Estimate(value=w / (2 * pi), sigma=w_sigma / (2 * pi)),
            damping_ratio=Estimate(value=z, sigma=z_sigma),
            amplitude=size,
        )
        for (w, z), (w_sigma, z_sigma), size in zip(
            values.tolist(), errors.tolist(), sizes.tolist(), strict=True
        )
    )
    return Damped(modes=modes, errors=tuple(doubts.tolist()), rest=rest)


def _basis(t: Array, poles: Sequence[complex]) -> Array:
    columns = [np.ones_like(t)]
    for pole in poles:
        decay = np.exp(pole.real * t)
        columns += [decay * np.cos(pole.imag * t), decay * np.sin(pole.imag * t)]
    return np.column_stack(columns)
