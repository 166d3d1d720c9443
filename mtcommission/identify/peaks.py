"""A spectrum without phase and force -> frequencies and damping of its modes.

The tool of a machine whose motor follows its setpoint is shaken by the motor's acceleration; that
of a sweep is smooth over frequency. What an accelerometer on the tool sees has the density::

    P(f) = C f^α |1 - Σ γ_k s²/(s² + 2 ζ_k ω_k s + ω_k²)|²

smeared by the window. Neighbouring lines scatter in proportion to P, so that ln P is fitted.

Far above its modes a tool stands still, so the shares γ_k of all of them add up to 1. Where lines
beside the peaks rise above what says nothing, they decide; those of a slow bed do not, and any
share would do: then the sum is what is known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.optimize import least_squares

from mtcommission.identify.fit import FittedSpectrum
from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.measured.measurement import Array, Spectrum
from mtcommission.measured.regression import information_criterion, regress

LOBE_TO_DEVIATION = 0.18
"""Standard deviation of a bell as narrow as the main lobe of a Hann window's power, in that
lobe's width."""
BAND_HZ = (5.0, 200.0)
"""Where the modes of axes without encoder lie; beyond it such a spectrum tells of the sensor."""
LEAST_HEIGHT = 2.0
"""Least density at a mode, by what it is without."""
LEAST_FALL = 10.0
"""Least fall of the Bayesian information criterion for another peak."""
INDIFFERENT = 0.03
"""Share of the largest density below which a spectrum says nothing: where the sweep has ended,
and noise."""
RATIO_ENDS = (5e-3, 0.3)
"""Damping ratios that are tried."""
SWEPT = 0.15
"""Standard error of a frequency by what the sweep goes on within one window, in the distance of
two lines (empirical: simulated sweeps of 1 and 2 Hz/s)."""
SHARE_BIAS = 0.025
"""Standard error of a share by what the window smears while the sweep goes on (empirical: in
simulated sweeps shares come out lower by up to 0.046)."""
SUM_OF_SHARES = 0.8
"""Weight of the shares' sum being 1, against one line: the scatter of a line, about 0.25, by how
far the sum may be off, about 0.3 (empirical: 0.9 to 1.1 where measured printers decide)."""
MOST = 5
"""Peaks of a spectrum."""
FEWEST_LINES = 30
UNKNOWN_CORRELATION = 2.0
"""Neighbouring lines of a windowed spectrum that scatter together."""


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    """Evenly spaced lines fine enough for the window, and the measured ones among them."""

    f: Array
    y: Array
    step: float
    deviation: float


def fit_spectrum(spectrum: Spectrum) -> FittedSpectrum:
    """Return the modes that a spectrum shows, each with its intervals."""
    f, density = spectrum.frequency_hz, spectrum.density
    is_used = (f >= BAND_HZ[0]) & (f <= BAND_HZ[1]) & (density > 0.0)
    found = FittedSpectrum(spectrum=spectrum, is_used=is_used, modes=(), density=np.zeros(0))
    if np.count_nonzero(is_used) < FEWEST_LINES:
        return replace(found, is_used=np.zeros_like(is_used))
    f, largest = f[is_used], float(density[is_used].max())
    y = np.log(density[is_used] / largest + INDIFFERENT)
    step = float(np.median(np.diff(f)))
    lobe = spectrum.resolution_hz or 4.0 * step
    grid = _Grid(f=f, y=y, step=step, deviation=LOBE_TO_DEVIATION * lobe)
    best = _least_squares(grid, np.zeros((0, 3)), float(np.median(y)), 2.0)
    while len(best.modes) < MOST:
        tried = [
            _least_squares(grid, np.vstack([best.modes, new]), best.size, best.slope)
            for start in _largest_misfits(grid, best)
            for new in ([np.log(start), np.log(0.04), 0.5], [np.log(start), np.log(0.1), 1.0])
        ]
        better = [
            one
            for one in tried
            if _criterion(grid, one) < _criterion(grid, best) - LEAST_FALL
            and min(_heights(grid, one)) > LEAST_HEIGHT
            and np.all(np.exp(one.modes[:, 1]) < 0.98 * RATIO_ENDS[1])
            and np.all(np.diff(np.sort(np.exp(one.modes[:, 0]))) > lobe)
        ]
        if not better:
            break
        best = min(better, key=lambda one: one.cost)
    model = (np.exp(best.model) - INDIFFERENT) * largest
    return replace(found, modes=_peaks(grid, best), density=model)


@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    modes: Array  # ln f, ln ζ and γ of each mode, shape (n_modes, 3)
    size: float  # ln C at the middle of the band
    slope: float  # α
    model: Array
    cost: float
    jacobian: Array


def _density(grid: _Grid, modes: Array, size: float, slope: float) -> Array:
    transfer = np.ones(grid.f.size, dtype=np.complex128)
    for centre, ratio, share in modes.tolist():
        r = grid.f / np.exp(centre)
        transfer += share * r**2 / (1.0 - r**2 + 2j * np.exp(ratio) * r)
    smeared = gaussian_filter1d(np.abs(transfer) ** 2, grid.deviation / grid.step, mode="nearest")
    middle = float(np.sqrt(grid.f[0] * grid.f[-1]))
    return np.asarray(smeared * np.exp(size) * (grid.f / middle) ** slope)


def _unpack(theta: Array) -> tuple[Array, float, float]:
    return theta[:-2].reshape(-1, 3), float(theta[-2]), float(theta[-1])


def _least_squares(grid: _Grid, modes: Array, size: float, slope: float) -> _Fit:
    count = len(modes)
    low_mode = [np.log(grid.f[0]), np.log(RATIO_ENDS[0]), -3.0]
    high_mode = [np.log(grid.f[-1]), np.log(RATIO_ENDS[1]), 3.0]
    low = np.array([*low_mode * count, -25.0, -1.0])
    high = np.array([*high_mode * count, 5.0, 4.0])
    start = np.concatenate([modes.ravel(), [size, slope]])

    def model(theta: Array) -> Array:
        return np.log(_density(grid, *_unpack(theta)) + INDIFFERENT)

    def residual(theta: Array) -> Array:
        off = SUM_OF_SHARES * (float(theta[2:-2:3].sum()) - 1.0) if count else 0.0
        return np.append(model(theta) - grid.y, off)

    found = least_squares(
        residual,
        np.clip(start, low + 1e-9, high - 1e-9),
        bounds=(low, high),
        x_scale="jac",
        max_nfev=40,
    )
    fitted = model(found.x)
    cost = float(np.sum((fitted - grid.y) ** 2))
    return _Fit(*_unpack(found.x), fitted, cost, np.asarray(found.jac))


def _largest_misfits(grid: _Grid, fit: _Fit) -> list[float]:
    """Frequencies of the largest smoothed excess over the model, three at most [Hz]."""
    excess = gaussian_filter1d(grid.y - fit.model, max(1.0, grid.deviation / grid.step))
    is_top = (excess == maximum_filter1d(excess, 5)) & (excess > 0.0)
    tops = np.flatnonzero(is_top)
    return [float(grid.f[i]) for i in tops[np.argsort(excess[tops])[::-1]][:3]]


def _criterion(grid: _Grid, fit: _Fit) -> float:
    parameters = 3 * len(fit.modes) + 2
    return information_criterion(fit.cost, grid.f.size, parameters, UNKNOWN_CORRELATION)


def _heights(grid: _Grid, fit: _Fit) -> list[float]:
    """Density at each mode, by what it is without that mode."""
    heights = []
    for k, mode in enumerate(fit.modes):
        at = int(np.argmin(np.abs(grid.f - np.exp(mode[0]))))
        less = _density(grid, np.delete(fit.modes, k, axis=0), fit.size, fit.slope)
        heights.append(float(np.exp(fit.model[at]) / (less[at] + INDIFFERENT)))
    return heights


def _peaks(grid: _Grid, fit: _Fit) -> tuple[MeasuredMode, ...]:
    rest = np.append(fit.model - grid.y, 0.0)
    sigmas = regress(fit.jacobian, rest, correlated=UNKNOWN_CORRELATION).sigma
    peaks = []
    for k in np.argsort(fit.modes[:, 0]).tolist():
        f, zeta = np.exp(fit.modes[k, :2]).tolist()
        by_f, by_zeta, by_share = sigmas[3 * k : 3 * k + 3].tolist()
        share, swept = float(fit.modes[k, 2]), SWEPT * grid.step
        peaks.append(
            MeasuredMode(
                frequency_hz=Estimate(value=f, sigma=hypot(by_f * f, swept)),
                damping_ratio=Estimate(value=zeta, sigma=by_zeta * zeta),
                tcp_gain=Estimate(value=share, sigma=hypot(by_share, SHARE_BIAS)),
            )
        )
    return tuple(peaks)
