"""What a residual is worth: the model's own error, scatter that the coherence hides, neighbours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mtcommission.identify.fit.lines import Lines, count_values, neighbours
from mtcommission.identify.fit.projection import Projected
from mtcommission.identify.measurement import Array

NEIGHBOURS = 21
"""Lines over which the scatter of the residuals is taken (empirical)."""
SMOOTHED_OVER = 0.12
"""Half of the stretch over which |H| is smoothed, in ln f: a sixth of an octave."""
NEWTON = 200
"""Steps; where the noise is told far too small each one only doubles the share's square."""
LARGEST_SHARE = 50.0
"""Squared residual at which one line stops to raise its neighbours' scatter."""


def smooth_errors(responses: Sequence[Lines]) -> list[Lines]:
    """Return responses whose weights no single line decides.

    A coherence estimated from few averages scatters itself, and a line whose magnitude came out too
    small by chance would weigh too much.
    """
    found = []
    for lines in responses:
        size = np.abs(lines.values)
        least = np.maximum(size, np.median(neighbours(size, 5), axis=1))
        found.append(lines.weigh(_smooth_share(lines) * least))
    return found


def _smooth_share(lines: Lines) -> Array:
    """The relative error of each line, as its neighbours allow."""
    squares = (lines.error / np.abs(lines.values)) ** 2
    mean = neighbours(squares, 5).mean(axis=1)
    return np.asarray(np.sqrt(np.maximum(0.5 * squares, mean)))


def judge_errors(responses: Sequence[Lines], fit: Projected) -> tuple[list[Lines], float]:
    """Return responses with errors that a fit's residuals bear out, and the model's own error.

    Where residuals are larger than coherence says, the model is to blame: a share of |H|, the same
    everywhere and smooth over frequency, is added so that the misfit becomes 1. Where a stretch of
    lines scatters more than the rest, its errors grow. Neither makes an error smaller.
    """
    rows = []
    for lines, residual in zip(responses, fit.residuals, strict=True):
        missed = residual * lines.error
        size = np.abs(lines.values + missed)
        rows.append((np.abs(missed) ** 2, _smooth_share(lines) * size, _course(lines, size)))
    q, e, c = map(np.concatenate, zip(*rows, strict=True))
    share = _excess_share(q, e, c, count_values(responses))
    found = []
    for lines, (squares, noise, course) in zip(responses, rows, strict=True):
        error = np.hypot(noise, share * course)
        own = np.minimum(squares / error**2, LARGEST_SHARE)
        local = neighbours(own, NEIGHBOURS).mean(axis=1) / 2
        found.append(lines.weigh(error * np.sqrt(np.maximum(1.0, local))))
    return found, share


def _excess_share(squares: Array, noise: Array, course: Array, count: int) -> float:
    """The share by which Σ squares/(noise² + share² course²) falls to the count; 0: it is below.

    Falling and convex in share², so that Newton's steps from 0 never pass the root.
    """
    power = 0.0
    for _ in range(NEWTON):
        variance = noise**2 + power * course**2
        excess = float(np.sum(squares / variance)) - count
        if excess <= 1e-12 * count:
            break
        power += excess / float(np.sum(squares * course**2 / variance**2))
    return float(np.sqrt(power))


def _course(lines: Lines, size: Array) -> Array:
    """|H| without its dips: at an antiresonance the model errs as much as beside it."""
    log_f = np.log(lines.frequency_hz)
    low = np.searchsorted(log_f, log_f - SMOOTHED_OVER)
    high = np.searchsorted(log_f, log_f + SMOOTHED_OVER, side="right")
    median = np.array([np.median(size[a:b]) for a, b in zip(low, high, strict=True)])
    return np.asarray(np.maximum(size, median))


def correlation_length(fit: Projected) -> float:
    """Return how many neighbouring lines err together, the worst response, >= 1.

    One and twice the sum of the autocorrelations before the first that is not significant.
    """
    lengths = [1.0]
    for residual in fit.residuals:
        n, power = residual.size, float(np.vdot(residual, residual).real)
        length = 1.0
        for lag in range(1, n // 4):
            rho = float(np.vdot(residual[:-lag], residual[lag:]).real) / max(power, 1e-300)
            if rho < 2.0 / np.sqrt(2.0 * n):
                break
            length += 2.0 * rho
        lengths.append(length)
    return max(lengths)
