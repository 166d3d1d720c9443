"""How many modes: one after the other, each against the evidence for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.fit.delay import align, slope_of_phase
from mtcommission.identify.fit.lines import Lines
from mtcommission.identify.fit.noise import correlation_length, judge_errors, smooth_errors
from mtcommission.identify.fit.projection import (
    Poles,
    Projected,
    Variances,
    count_parameters,
    find_variances,
    project,
    refine,
)
from mtcommission.identify.fit.search import Candidates

Array = NDArray[np.float64]

LEAST_GAIN = 10.0
"""A mode stays if the Bayesian information criterion falls by more than this.

Source: Kass, Raftery, J. Am. Stat. Assoc. 90 (1995) 773: "very strong".
"""
LEAST_EVIDENCE = 18.0
"""χ² that a mode must take away without the two lines that speak most for it (empirical): a hum
of the mains stands in one line, a mode in several."""
CLEAR_GAIN = 50.0
"""Fall of the criterion beyond which no other candidate is tried."""
SEPARATION = 0.75
"""Least distance of two modes, in the sum of their half-power widths; true modes are found down
to one sum, and two estimates within one peak are one mode and the error of the model."""
LEAST_CERTAINTY = 4.0
"""Least gain of a mode, in its standard errors."""
PLACED = 0.25
"""Error of a frequency, in the distance of two lines, up to which a mode narrower than that is one
whose damping alone is not known (empirical)."""
SHARPEST = 1e-3
"""Damping ratio below which a mode narrower than half the lines' distance is a single bad line."""
BROADEST = 0.2
"""Damping ratio beyond which a term is background, no mode."""
SUSPICIOUS = 5e-3
"""Error of the model beyond which a second start is worth its time."""
WHITE = 1.25
"""Correlation length below which residuals have no shape left."""
FIRST_LAG = 1e-4
"""Least lag at which a fit begins [s]."""
LONG_LAG = 2e-3
"""Lag at which another one begins: a lag so long that the phase's slope does not show it [s]."""
CERTAIN = 1e9
"""A gain in its standard errors beyond which more counts no more."""
TRIED = 3
"""Modes, the least sure first, without which a fit is tried."""
MOST = 10
"""Terms of a fit, background and modes."""


@dataclass(frozen=True, slots=True, eq=False)
class Ordered:
    """A fit whose number of modes was chosen."""

    lines: list[Lines]  # The responses in their final weights
    fit: Projected  # Of least squares
    is_mode: tuple[bool, ...]  # For each pole, whether it is a mode; else background
    model_error: float  # Share of |H| that the model misses beyond what the coherence says [-]
    correlation: float  # Neighbouring lines that err together


def choose_modes(responses: Sequence[Lines], *, count: int | None = None) -> Ordered:
    """Return the fit with the modes for which there is evidence."""
    slopes = np.array([slope_of_phase(lines) for lines in responses])
    candidates, none = Candidates(responses), np.zeros(len(responses))
    choose = partial(_choose, responses, candidates, count)
    found = choose(slopes, lags=none, holds_delay=False)
    found = _with_lags(responses, candidates, found, count)
    if _is_good(found):
        return found
    # Background, or more misfit than noise: the search may have gone astray with the delay.
    tried = [found]
    for delays, lags in ((slopes, none), (none, none), (none, none + LONG_LAG)):
        if _is_good(tried[-1]):
            break
        tried.append(choose(delays, lags=lags, holds_delay=not lags.any()))
    smooth = smooth_errors(responses)

    def worth(one: Ordered) -> float:
        again = refine(smooth, one.fit.poles, steps=5)
        return criterion(smooth, again, correlation=found.correlation)

    return min(tried, key=worth)


def _with_lags(
    responses: Sequence[Lines], candidates: Candidates, found: Ordered, count: int | None
) -> Ordered:
    """The modes with a lag in place of background, if there is evidence for it."""
    smooth, poles = smooth_errors(responses), found.fit.poles
    halves, sharp = 0.5 * np.maximum(poles.delays, 0.0), poles.zeta < BROADEST
    starts = (halves, np.maximum(halves, FIRST_LAG)), (0.0 * halves, np.full(halves.size, LONG_LAG))
    fit = min(
        (
            refine(smooth, Poles(poles.drag, *start, poles.omega[sharp], poles.zeta[sharp]))
            for start in starts
        ),
        key=lambda one: one.cost,
    )
    without = criterion(smooth, refine(smooth, poles, steps=5), correlation=found.correlation)
    if without - criterion(smooth, fit, correlation=found.correlation) < LEAST_GAIN:
        return found
    fit = _grow(smooth, candidates, fit, MOST if count is None else count, count)
    return _settle(responses, smooth, fit, count)


def _is_good(found: Ordered) -> bool:
    """Only modes, and residuals that are noise: small, or white."""
    is_noise = found.model_error < SUSPICIOUS or found.correlation < WHITE
    return all(found.is_mode) and is_noise


def _choose(
    responses: Sequence[Lines],
    candidates: Candidates,
    count: int | None,
    delays: Array,
    *,
    lags: Array,
    holds_delay: bool,
) -> Ordered:
    smooth = smooth_errors(responses)
    start = Poles(0.0, delays, lags, np.zeros(0), np.zeros(0))
    most = MOST if count is None else count
    even = _per_octave(smooth)
    rough = _grow(even, candidates, project(even, start), most, count, holds_delay=holds_delay)
    fit = _grow(smooth, candidates, rough, most, count)
    return _settle(responses, smooth, fit, count)


def _settle(
    responses: Sequence[Lines], smooth: Sequence[Lines], fit: Projected, count: int | None
) -> Ordered:
    """Judge errors by what is left, and drop modes that nothing determines then."""
    fit = _prune(smooth, fit, count)
    lines, share = judge_errors(responses, fit)
    fit = _prune(lines, refine(lines, fit.poles), count)
    while count is None and (doubtful := _doubtful(lines, fit)) is not None:
        fit = refine(lines, fit.poles.drop(doubtful))
    return Ordered(lines, fit, _modes(lines, fit), share, correlation_length(fit))


def criterion(responses: Sequence[Lines], fit: Projected, *, correlation: float = 1.0) -> float:
    """Return the Bayesian information criterion of a fit, noise of unknown size."""
    size, parameters = _size(responses), count_parameters(fit)
    cost = max(fit.cost, 1e-12 * size)
    return float(size / correlation * np.log(cost / size) + parameters * np.log(size / correlation))


def _size(responses: Sequence[Lines]) -> int:
    return sum(2 * lines.size for lines in responses)


def _evidence(responses: Sequence[Lines], fit: Projected, less: Projected) -> float:
    """χ² between two fits without the two lines that tell most."""
    gains = np.concatenate(
        [
            np.abs(a) ** 2 - np.abs(b) ** 2
            for a, b in zip(less.residuals, fit.residuals, strict=True)
        ]
    )
    variance = max(fit.cost / _size(responses), 1e-12)
    return float((gains.sum() - np.sort(gains)[-2:].sum()) / variance)


def _per_octave(responses: Sequence[Lines]) -> list[Lines]:
    """Each octave weighs the same, and none better than 3 %: for the rough shape."""
    found = []
    for lines in responses:
        step = np.gradient(np.log(lines.frequency_hz))
        error = np.hypot(lines.error, 0.03 * np.abs(lines.values))
        found.append(lines.weigh(error * np.sqrt(np.median(step) / step)))
    return found


def _grow(
    responses: Sequence[Lines],
    candidates: Candidates,
    best: Projected,
    most: int,
    count: int | None,
    *,
    holds_delay: bool = False,
) -> Projected:
    """Add the mode that takes most of the misfit away until none is worth it."""
    best = _improve(responses, best.poles, holds_delay=holds_delay)
    while best.poles.omega.size < most:
        least = np.inf if count is not None else criterion(responses, best) - LEAST_GAIN
        tried: list[Projected] = []
        for omega, zeta in candidates.best(responses, best, most=3):
            new = _improve(responses, best.poles.add(omega, zeta), holds_delay=holds_delay)
            if _evidence(responses, new, best) < LEAST_EVIDENCE or _too_near(new.poles):
                continue
            tried.append(new)
            if criterion(responses, new) < criterion(responses, best) - CLEAR_GAIN:
                break
        if not tried:
            break
        new = min(tried, key=lambda fit: fit.cost)
        if criterion(responses, new) >= least:
            break
        best = new
    return best


def _improve(responses: Sequence[Lines], poles: Poles, *, holds_delay: bool) -> Projected:
    start = poles if holds_delay else align(responses, poles)
    return refine(responses, start, steps=25, tolerance=1e-4, holds_delay=holds_delay)


def _prune(responses: Sequence[Lines], best: Projected, count: int | None) -> Projected:
    """Drop modes without which the fit is as good, the weakest first."""
    best = refine(responses, best.poles)
    while best.poles.omega.size > (count or 0):
        less = [
            refine(responses, best.poles.drop(mode), steps=15, tolerance=1e-4)
            for mode in _least_sure(responses, best)
        ]
        shown = [_evidence(responses, best, one) for one in less]
        weakest = int(np.argmin([one.cost for one in less]))
        if count is None and _too_near(best.poles):
            best = refine(responses, less[weakest].poles)
            continue
        correlation = correlation_length(best)
        with_it = criterion(responses, best, correlation=correlation)
        without = criterion(responses, less[weakest], correlation=correlation)
        if count is None and without - with_it > LEAST_GAIN:
            if min(shown) > LEAST_EVIDENCE:
                break
            weakest = int(np.argmin(shown))
        best = refine(responses, less[weakest].poles)
    return best


def _least_sure(responses: Sequence[Lines], fit: Projected) -> list[int]:
    """Modes of the least gains in their standard errors, and those too near to another."""
    n = fit.poles.omega.size
    surest = np.abs(fit.gains[:, 1:-1]) / _gain_errors(find_variances(responses, fit))
    order = np.argsort(np.sum(np.minimum(surest, CERTAIN) ** 2, axis=0))
    return [int(k) for k in order[: min(n, TRIED)]]


def _gain_errors(variances: Variances) -> Array:
    """Standard errors of all gains for residuals of variance 1, shape (n_responses, n_modes)."""
    found: Array = np.diagonal(variances.gains, axis1=1, axis2=2)[:, 1:-1]
    return np.sqrt(np.maximum(found, 1e-300))


def _doubtful(responses: Sequence[Lines], fit: Projected) -> int | None:
    """The least sure mode that nothing determines; None if all are determined.

    Its frequency is less sure than its half-power width or a part of the lines' distance, no
    response has a gain beyond its error, or it is a spike between two lines, sharper than any
    structure.
    """
    n = fit.poles.omega.size
    if not n:
        return None
    variances = find_variances(responses, fit)
    size = _size(responses)
    spare = max(size - count_parameters(fit), 1)
    factor = np.sqrt(max(fit.cost / spare, 1.0) * correlation_length(fit))
    by_omega = factor * np.array([variances.of_mode(k, n)[0] for k in range(n)])
    surest = np.max(np.abs(fit.gains[:, 1:-1]) / (factor * _gain_errors(variances)), axis=0)
    f = fit.poles.omega / (2 * np.pi)
    spacing = np.array([min(_spacing(lines, one) for lines in responses) for one in f])
    is_spike = (fit.poles.zeta < SHARPEST) & (2 * fit.poles.zeta * f < 0.5 * spacing)
    known_to = np.maximum(2.0 * fit.poles.zeta * f, PLACED * spacing)
    is_unsure = (by_omega * f > known_to) | (surest < LEAST_CERTAINTY) | is_spike
    # Background need not be sure: it only stands for what lies about the band.
    is_unsure &= np.array(_modes(responses, fit), dtype=bool)
    if not is_unsure.any():
        return None
    return int(np.argmin(np.where(is_unsure, surest, np.inf)))


def _spacing(lines: Lines, frequency_hz: float) -> float:
    f = lines.frequency_hz
    at = int(np.clip(np.searchsorted(f, frequency_hz), 1, f.size - 1))
    return float(f[at] - f[at - 1])


def _too_near(poles: Poles) -> bool:
    """Whether two poles lie in one peak."""
    order = np.argsort(poles.omega)
    omega = poles.omega[order]
    width = 2.0 * poles.zeta[order] * omega
    apart = SEPARATION * (width[1:] + width[:-1])
    both_sharp = np.maximum(poles.zeta[order][1:], poles.zeta[order][:-1]) < BROADEST
    return bool(np.any((np.diff(omega) < apart) & both_sharp))


def _modes(responses: Sequence[Lines], fit: Projected) -> tuple[bool, ...]:
    low = min(float(lines.frequency_hz[0]) for lines in responses)
    high = max(float(lines.frequency_hz[-1]) for lines in responses)
    f = fit.poles.omega / (2 * np.pi)
    chosen = (fit.poles.zeta < BROADEST) & (f > 1.05 * low) & (f < 0.98 * high)
    return tuple(bool(one) for one in chosen)
