"""The modes in a dwell: frequencies and damping ratios that explain what was recorded.

    y(t) = c + Σ e^(Re(p) t) (A cos Im(p) t + B sin Im(p) t)

over the poles p of the closed loop. Which ones matter, the prediction tells; where those that modes
have become begin, a scan: a damped vibration hides beside a servo tail from every fit that starts
blind. All oscillating ones are free then, since another mode moves the servo's poles, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, pi, sqrt

import numpy as np
from scipy.optimize import least_squares

from mtcommission.identify.measurement import FreeMode
from mtcommission.identify.responses.free_vibration import correlation_length
from mtcommission.verify.beside import FEWEST, Beside
from mtcommission.verify.prediction import Rebuilt
from mtcommission.verify.trace import Array

MOST_SAMPLES = 2000
SCANNED = np.linspace(0.7, 1.3, 61)
"""Factors on a mode's frequency at which a fit may begin."""

NOTABLE = 0.01
"""Share of the largest amplitude from which on a pole takes part."""

SIGNIFICANT = 4.0
"""Amplitude over its standard error."""

SURE = 0.05
"""Standard error of a frequency, relative, above which the mode counts as not seen."""

LARGEST_DAMPING = 0.6
BELOW_NYQUIST = 0.75
"""Share of half the sampling frequency up to which a mode is looked for, scan included."""

RINGS = 0.2
"""Damping ratio in the closed loop up to which a mode rings; one beyond it is part of the tail."""


def find_modes(rebuilt: Rebuilt, beside: Beside, *, rest: float) -> tuple[FreeMode | None, ...]:
    """Return the vibration in the dwell that belongs to each mode of the plant; None: not seen."""
    none: tuple[FreeMode | None, ...] = tuple(None for _ in rebuilt.plant.modes)
    after = beside.after(rest)
    if after.sum() < 8 * FEWEST:
        return none
    stride = max(int(after.sum()) // MOST_SAMPLES, 1)
    t = beside.t[after][::stride] - rest
    size = float(np.abs(beside.deviation[after]).max())
    if size == 0.0:
        return none
    measured = beside.deviation[after][::stride] / size
    expected = beside.predicted_deviation[0][after][::stride] / size
    fixed, modes = _poles_that_matter(rebuilt, t, expected, beside.noise / size)
    if not modes:
        return none
    start = dict.fromkeys(modes, 0j)
    for number in modes:
        start[number] = _scan(t, measured, fixed, start, number, rebuilt.poles[0, number])
    found = _fit(t, measured, fixed, start)
    # What the same fit makes of the prediction, whose poles are known, is its error on such a
    # dwell: poles that were left out, a tail that ends too early.
    known = _fit(t, expected, fixed, {number: rebuilt.poles[0, number] for number in modes})
    seen = [found.get(number) for number in range(len(none))]
    return tuple(
        _with_bias(one, known.get(number), complex(rebuilt.poles[0, number]), size) if one else None
        for number, one in enumerate(seen)
    )


def _with_bias(
    one: FreeMode, known: FreeMode | None, pole: complex, size: float
) -> FreeMode | None:
    """A mode with the error of the fit itself; None where that does not even find its own."""
    if known is None:
        return None
    hertz, zeta = abs(pole) / (2 * pi), -pole.real / abs(pole)
    return replace(
        one,
        frequency_sigma_hz=hypot(one.frequency_sigma_hz, known.frequency_hz - hertz),
        damping_sigma=hypot(one.damping_sigma, known.damping_ratio - zeta),
        amplitude=size * one.amplitude,
    )


def _poles_that_matter(
    rebuilt: Rebuilt, t: Array, expected: Array, noise: float
) -> tuple[list[complex], list[int]]:
    """Poles that stay, and numbers of the modes that are fitted, the largest amplitude first."""
    fastest = BELOW_NYQUIST * pi / float(t[1] - t[0])
    numbers = [
        k
        for k, pole in enumerate(rebuilt.poles[0])
        if -pole.real < RINGS * abs(pole) and pole.imag < fastest
    ]
    own = [complex(rebuilt.poles[0, k]) for k in numbers]
    damped = [complex(pole) for k, pole in enumerate(rebuilt.poles[0]) if k not in numbers]
    others = [
        pole
        for pole in (*damped, *rebuilt.servo_poles)
        if pole.imag < fastest
        and pole.real * t[-1] < -1.0
        and pole.real > -1.0 / (2.0 * float(t[1] - t[0]))
    ]
    poles = [*own, *others]
    weights = np.linalg.lstsq(_basis(t, poles), expected, rcond=None)[0][1:].reshape(-1, 2)
    size = np.hypot(*weights.T)
    notable = size > NOTABLE * float(size.max())
    fixed = [pole for pole, counts in zip(others, notable[len(own) :], strict=True) if counts]
    seen = [
        numbers[place]
        for place in np.argsort(-size[: len(own)])
        if notable[place] and 4.0 * size[place] > noise
    ]
    return fixed, seen


def _basis(t: Array, poles: Sequence[complex]) -> Array:
    columns = [np.ones_like(t)]
    for pole in poles:
        decay = np.exp(pole.real * t)
        columns += [decay * np.cos(pole.imag * t), decay * np.sin(pole.imag * t)]
    return np.column_stack(columns)


def _rest(t: Array, y: Array, poles: Sequence[complex]) -> Array:
    basis = _basis(t, poles)
    return np.asarray(y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0])


def _scan(
    t: Array,
    y: Array,
    fixed: Sequence[complex],
    known: dict[int, complex],
    number: int,
    pole: complex,
) -> complex:
    """Where one mode explains the most, beside those that have been placed."""
    others = [*fixed, *(p for place, p in known.items() if place != number and p != 0j)]
    tried = [factor * pole for factor in SCANNED]
    power = [float(np.sum(_rest(t, y, [*others, one]) ** 2)) for one in tried]
    return complex(tried[int(np.argmin(power))])


def _fit(
    t: Array, y: Array, fixed: Sequence[complex], start: dict[int, complex]
) -> dict[int, FreeMode]:
    numbers = list(start)
    begin = np.array([*start.values(), *(pole for pole in fixed if pole.imag > 0.0)])
    fixed = [pole for pole in fixed if pole.imag == 0.0]
    x0 = np.column_stack([np.abs(begin), -begin.real / np.abs(begin)])
    scale = np.column_stack([np.abs(begin), np.full(len(begin), 0.05)])

    def poles_of(x: Array) -> list[complex]:
        rows = x.reshape(-1, 2) * scale
        return [complex(-z * w, w * sqrt(max(1.0 - z * z, 1e-6))) for w, z in rows]

    low = np.tile([0.8, 0.0], len(begin))
    high = np.tile([1.25, LARGEST_DAMPING / 0.05], len(begin))

    def residuals(x: Array) -> Array:
        return _rest(t, y, [*poles_of(x), *fixed])

    solved = least_squares(
        residuals,
        np.clip((x0 / scale).ravel(), low + 1e-6, high - 1e-6),
        bounds=(low, high),
    )
    poles = [*poles_of(solved.x), *fixed]
    basis, rest = _basis(t, poles), np.asarray(solved.fun)
    weights = np.linalg.lstsq(basis, y, rcond=None)[0]
    free = basis.shape[1] + 2 * len(begin)
    variance = correlation_length(rest) * float(rest @ rest) / max(rest.size - free, 1)
    jacobian = np.column_stack([np.asarray(solved.jac), basis])
    norms = np.linalg.norm(jacobian, axis=0)
    norms[norms == 0.0] = 1.0
    inverse = np.linalg.pinv((jacobian / norms).T @ (jacobian / norms))
    sigma = np.sqrt(variance * np.maximum(np.diag(inverse), 0.0)) / norms
    found = {}
    for place, number in enumerate(numbers):
        omega, zeta = (solved.x.reshape(-1, 2) * scale)[place]
        errors = sigma[2 * place : 2 * place + 2] * scale[place]
        columns = slice(1 + 2 * place, 3 + 2 * place)
        amplitude = float(np.hypot(*weights[columns]))
        error = float(np.hypot(*sigma[2 * len(begin) :][columns]))
        if amplitude < SIGNIFICANT * error or errors[0] > SURE * omega:
            continue
        found[number] = FreeMode(
            frequency_hz=float(omega) / (2 * pi),
            frequency_sigma_hz=float(errors[0]) / (2 * pi),
            damping_ratio=float(zeta),
            damping_sigma=float(errors[1]),
            amplitude=amplitude,
        )
    return found
