"""What rings after a move or a step: decaying oscillations, by matrix pencil and least squares.

    y(t) = c + Σ e^(-ζ ω t) (A cos ω_d t + B sin ω_d t) + tail,   ω_d = ω √(1 - ζ²)

c and the amplitudes enter linearly. Starts come from a matrix pencil, the order from the Bayesian
information criterion, intervals from the Jacobian and the correlation of the residuals.

Source: Y. Hua, T. K. Sarkar, IEEE Trans. ASSP 38 (1990) 814-824; G. Schwarz, Ann. Stat. 6 (1978).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import decimate

from mtcommission.identify.measurement import Array, FreeMode, correlation_length

MOST_SAMPLES = 1500
MOST_MODES = 6
LEAST_GAIN = 10.0
"""Fall of the information criterion for which a further mode is kept."""

BAND_SHARE = 0.99
"""Share of the energy of a signal's rate below the frequency up to which it is looked at."""

LARGEST_DAMPING = 0.3
SMALLEST_AMPLITUDE = 0.02
"""Share of the largest amplitude below which a mode is left out."""

FEWEST_CYCLES = 2.0
LEAST_DECAY = 3.0
"""Factor by which what rings must fall from the first quarter of the record to the last."""

CALM = 0.3
"""Share of the vibration that may be there before it, if it is a free one."""

SIGNIFICANT = 4.0
"""Amplitude over its standard error."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ringing:
    """What was found in a decay."""

    modes: tuple[FreeMode, ...]  # The largest amplitude first; () where nothing rings
    duration: float  # Looked at [s]
    explained: float  # Share of the variance that the modes explain


def find_start(reference: Array | None, values: Array) -> int:
    """Return the sample at which a signal is left to itself."""
    if reference is not None:
        steps = np.abs(np.diff(reference))
        if steps.max() > 0.0:
            moving = np.flatnonzero(steps > 1e-3 * steps.max())
            return int(moving[-1]) + 1
    shakes = np.abs(np.diff(values, n=2))
    width = _width(values)
    power = np.convolve(shakes**2, np.ones(width), "same")
    return min(int(np.argmax(power)) + width, values.size - 1)


def _width(values: Array) -> int:
    """Samples over which shaking is averaged."""
    return max(values.size // 100, 8)


def begins(values: Array, start: int) -> bool:
    """Return whether a signal was calm just before it is left to itself.

    What is driven through a resonance, by a sweep, swells before it fades.
    """
    shakes = np.diff(values, n=2)
    width = _width(values)
    before = shakes[max(start - 4 * width, 0) : max(start - 2 * width, 0)]
    if before.size < width:  # it rings from the first sample on
        return True
    return float(before.std()) < CALM * float(shakes[start - width : start + width].std())


def is_decay(values: Array) -> bool:
    """Return whether a signal dies away, rather than being driven on."""
    part = values.size // 4
    if part < 16:
        return False
    rest = values - values[-part:].mean()
    first, last = rest[:part], rest[-part:]
    return float(first.std()) > LEAST_DECAY * float(last.std()) > 0.0


def fit_ringing(values: Array, step: float) -> Ringing:
    """Return the modes in a free vibration."""
    y, step = _thinned(values - values[-max(values.size // 10, 1) :].mean(), step)
    t = step * np.arange(y.size, dtype=np.float64)
    best: _Fit | None = None
    for order in range(1, MOST_MODES + 1):
        start = _pencil(y, step, order)
        if len(start) < order:
            break
        fit = _refine(y, t, start)
        if fit is None or (best is not None and fit.criterion > best.criterion - LEAST_GAIN):
            break
        best = fit
    if best is None:
        return Ringing(modes=(), duration=float(t[-1]), explained=0.0)
    modes = [
        FreeMode(
            frequency_hz=omega / (2 * np.pi),
            frequency_sigma_hz=sigma_omega / (2 * np.pi),
            damping_ratio=zeta,
            damping_sigma=sigma_zeta,
            amplitude=amplitude,
        )
        for omega, zeta, sigma_omega, sigma_zeta, amplitude, share in best.modes
        if 0.0 < zeta < LARGEST_DAMPING
        and share > SIGNIFICANT
        and amplitude > SMALLEST_AMPLITUDE * max(row[4] for row in best.modes)
        and omega * t[-1] > 2 * np.pi * FEWEST_CYCLES
    ]
    modes.sort(key=lambda mode: -mode.amplitude)
    return Ringing(modes=tuple(modes), duration=float(t[-1]), explained=best.explained)


@dataclass(frozen=True, slots=True)
class _Fit:
    """Modes as (ω, ζ, σ_ω, σ_ζ, amplitude, amplitude over its standard error)."""

    modes: list[tuple[float, float, float, float, float, float]]
    criterion: float
    explained: float


def _thinned(values: Array, step: float) -> tuple[Array, float]:
    """The signal with no more samples than its band needs."""
    power = np.abs(np.fft.rfft(np.diff(values) * np.hanning(values.size - 1))) ** 2
    share = np.cumsum(power) / max(float(power.sum()), np.finfo(float).tiny)
    top = float(np.searchsorted(share, BAND_SHARE) + 1) / ((values.size - 1) * step)
    factor = max(int(1.0 / (step * 6.0 * top)), 1)
    while factor > 1:
        once = min(factor, 10)
        values = np.asarray(decimate(values, once, ftype="fir"), dtype=np.float64)
        step, factor = step * once, factor // once
    return values[:MOST_SAMPLES], step


def _pencil(y: Array, step: float, order: int) -> list[tuple[float, float]]:
    """Starting (ω, ζ) of the strongest oscillations."""
    stride = max(y.size // 600, 1)  # the pencil's cost grows with the cube
    y = np.ascontiguousarray(y[::stride])
    step *= stride
    t = step * np.arange(y.size, dtype=np.float64)
    wide = y.size // 3
    hankel = np.lib.stride_tricks.sliding_window_view(y, wide + 1)
    _, _, rows = np.linalg.svd(hankel, full_matrices=False)
    kept = rows[: 2 * order + 2].T  # two more: an offset and a slow tail
    shift = np.linalg.lstsq(kept[:-1], kept[1:], rcond=None)[0]
    poles = np.linalg.eigvals(shift)
    found = []
    for pole in np.log(poles[np.abs(poles) > 1e-6]) / step:
        omega = float(abs(pole))
        if pole.imag > 0.0 and omega > 0.0 and pole.imag < 0.98 * np.pi / step:
            found.append((omega, float(np.clip(-pole.real / omega, 1e-4, 0.5))))
    sizes = [float(np.linalg.norm(_amplitudes(y, t, [one])[1:])) for one in found]
    ranked = [one for _, one in sorted(zip(sizes, found, strict=True), reverse=True)]
    return ranked[:order]


def _basis(t: Array, modes: list[tuple[float, float]]) -> Array:
    columns = [np.ones_like(t)]
    for omega, zeta in modes:
        decay, angle = np.exp(-zeta * omega * t), omega * np.sqrt(max(1.0 - zeta**2, 1e-6)) * t
        columns += [decay * np.cos(angle), decay * np.sin(angle)]
    return np.column_stack(columns)


def _amplitudes(y: Array, t: Array, modes: list[tuple[float, float]]) -> Array:
    return np.asarray(np.linalg.lstsq(_basis(t, modes), y, rcond=None)[0], dtype=np.float64)


def _refine(y: Array, t: Array, start: list[tuple[float, float]]) -> _Fit | None:
    count = len(start)
    scale = np.array([[omega, 0.05] for omega, _ in start]).ravel()

    def modes_of(x: Array) -> list[tuple[float, float]]:
        return [(float(w), float(z)) for w, z in (x * scale).reshape(-1, 2)]

    def residuals(x: Array) -> Array:
        basis = _basis(t, modes_of(x))
        rest: Array = y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0]
        return rest

    x0 = np.array(start).ravel() / scale
    low = np.tile([0.3, 0.0], count)
    high = np.tile([3.0, 0.6 / 0.05], count)
    try:
        solved = least_squares(residuals, np.clip(x0, low + 1e-6, high - 1e-6), bounds=(low, high))
    except (ValueError, np.linalg.LinAlgError):
        return None
    rest = solved.fun
    power = float(rest @ rest)
    free = 4 * count + 1
    total = float(((y - y.mean()) ** 2).sum())
    if total == 0.0 or y.size <= 2 * free:
        return None
    spread = correlation_length(rest)
    independent = y.size / spread
    noise = max(power, 1e-24 * total)
    criterion = independent * np.log(noise / y.size) + free * np.log(independent)
    variance = noise / (y.size - free) * spread
    jacobian = np.column_stack([np.asarray(solved.jac), _basis(t, modes_of(solved.x))])
    covariance = variance * np.linalg.pinv(jacobian.T @ jacobian)
    sigma = np.sqrt(np.diag(covariance)[: 2 * count]) * scale
    weights = _amplitudes(y, t, modes_of(solved.x))[1:].reshape(-1, 2)
    errors = np.sqrt(np.diag(covariance)[2 * count + 1 :]).reshape(-1, 2)
    rows = []
    for (omega, zeta), s, weight, error in zip(
        modes_of(solved.x), sigma.reshape(-1, 2), weights, errors, strict=True
    ):
        amplitude = float(np.hypot(*weight))
        certainty = amplitude / max(float(np.hypot(*error)), 1e-300)
        rows.append((omega, zeta, float(s[0]), float(s[1]), amplitude, certainty))
    return _Fit(rows, float(criterion), 1.0 - power / total)
