"""How many modes: one after the other, each against the evidence for it.

What a residual is worth: the model's own error, scatter that the coherence hides, neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.projection import (
    Lines,
    Poles,
    Projected,
    count_values,
    ends_of,
    find_variances,
    project,
    refine,
    spacing_at,
    weighed_rows,
)
from mtcommission.measured.measurement import Array
from mtcommission.measured.regression import correlation_length, information_criterion, neighbours

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
        found.append(replace(lines, error=_smooth_share(lines) * least))
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
        found.append(replace(lines, error=error * np.sqrt(np.maximum(1.0, local))))
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
    stretches = (np.sort(size[a:b]) for a, b in zip(low, high, strict=True))
    # numpy's own median takes five times as long, on arrays as short as these.
    median = [0.5 * (own[own.size // 2] + own[~(own.size // 2)]) for own in stretches]
    return np.asarray(np.maximum(size, median))


def _correlation(fit: Projected) -> float:
    """How many neighbouring lines err together, the worst response."""
    return max(map(correlation_length, fit.residuals))


LEAST_GAIN = 7.0
"""A mode stays if the Bayesian information criterion falls by more than this.

Source: Kass, Raftery, J. Am. Stat. Assoc. 90 (1995) 773: "strong" from 6 to 10. With the two below,
150 axes beside the survey's have as many right and as many false as with 10, 18 and 4.
"""
LEAST_EVIDENCE = 12.0
"""χ² that a mode must take away without the two lines that speak most for it (empirical): a hum
of the mains stands in one line, a mode in several."""
SEPARATION = 0.75
"""Least distance of two modes, in the sum of their half-power widths; true modes are found down
to one sum, and two estimates within one peak are one mode and the error of the model."""
LEAST_CERTAINTY = 3.5
"""Least gain of a mode, in its standard errors (empirical, likewise)."""
PLACED = 0.25
"""Error of a frequency, in the distance of two lines, up to which a mode narrower than that is one
whose damping alone is not known (empirical)."""
SHARPEST = 1e-3
"""Damping ratio below which a mode narrower than half the lines' distance is a single bad line."""
BROADEST = 0.2
"""Damping ratio beyond which a term is background, no mode."""
SUSPICIOUS = 5e-3
"""Error of the model beyond which a second start is worth its time."""
HOPELESS = 0.25
"""Error of the model beyond which, after two starts, no other one is tried: the band holds more
than modes (empirical: on 200 axes of the survey the better of two misses 2 % at most)."""
WHITE = 1.25
"""Correlation length below which residuals have no shape left."""
FIRST_LAG = 1e-4
"""Least lag at which a fit begins [s]."""
LONG_LAG = 2e-3
"""Lag at which another one begins: a lag so long that the phase's slope does not show it [s]."""
CERTAIN = 1e9
"""A gain in its standard errors beyond which more counts no more."""
MOST = 10
"""Terms of a fit, background and modes."""
PHASE_STEP = 0.04
"""Distance of the two lines whose phases are compared, in the highest frequency."""
LONGEST = 5e-3
"""Longest delay at which a fit begins [s]."""
RATIOS = (0.003, 0.012, 0.045, 0.15)
"""Damping ratios of the candidates; least squares finds those between."""
GRID_STEP, FINE = 1.6, 2000
"""Distance of the candidates' frequencies, in ζ f, and places at which that is looked at."""
MOST_LINES = 3000
"""Of a response with more, every second, third, ... line is searched."""


@dataclass(frozen=True, slots=True, eq=False)
class Ordered:
    """A fit whose number of modes was chosen."""

    lines: list[Lines]  # The responses in their final weights
    fit: Projected  # Of least squares
    is_mode: NDArray[np.bool_]  # For each pole, whether it is a mode; else background
    model_error: float  # Share of |H| that the model misses beyond what the coherence says [-]
    correlation: float  # Neighbouring lines that err together

    @property
    def is_good(self) -> bool:
        """Whether residuals are noise, small or white; with background both."""
        is_small, is_white = self.model_error < SUSPICIOUS, self.correlation < WHITE
        is_noise = (is_small or is_white) if self.is_mode.all() else (is_small and is_white)
        return bool(is_noise)


def choose_modes(responses: Sequence[Lines], *, count: int | None = None) -> Ordered:
    """Return the fit with the modes for which there is evidence."""
    return _Search(responses, count).choose()


class _Search:
    """Responses as coherence weighs them, and how many modes are asked for."""

    def __init__(self, responses: Sequence[Lines], count: int | None) -> None:
        self.responses, self.smooth = responses, smooth_errors(responses)
        self.count, self.most = count, MOST if count is None else count
        self.candidates = _Candidates(responses)

    def choose(self) -> Ordered:
        slopes = np.array([_slope_of_phase(lines) for lines in self.responses])
        none = np.zeros(len(self.responses))
        found = self._with_lags(self._from(slopes, none))
        # Background, or more misfit than noise: the search may have gone astray with the delay.
        tried = [found]
        for delays, lags in ((slopes, none), (none, none), (none, none + LONG_LAG)):
            astray = [one.model_error > HOPELESS for one in tried]
            if tried[-1].is_good or (len(astray) > 1 and all(astray)):
                break
            tried.append(self._from(delays, lags, holds_delay=not lags.any()))
        if len(tried) == 1:
            return found
        return min(tried, key=lambda one: self._worth(one.fit.poles, found.correlation))

    def _worth(self, poles: Poles, correlation: float) -> float:
        again = refine(self.smooth, poles, steps=5)
        return _criterion(self.smooth, again, correlation=correlation)

    def _from(self, delays: Array, lags: Array, *, holds_delay: bool = False) -> Ordered:
        """The fit that grows from some delays and lags."""
        start = Poles(0.0, delays, lags, np.zeros(0), np.zeros(0))
        return self._settle(self._grow(project(self.smooth, start), holds_delay=holds_delay))

    def _with_lags(self, found: Ordered) -> Ordered:
        """The modes with a lag in place of background, if there is evidence for it."""
        smooth, poles = self.smooth, found.fit.poles
        halves, sharp = 0.5 * np.maximum(poles.delays, 0.0), poles.zeta < BROADEST
        starts = (
            (halves, np.maximum(halves, FIRST_LAG)),
            (0.0 * halves, np.full(halves.size, LONG_LAG)),
        )
        modes = poles.omega[sharp], poles.zeta[sharp]
        tried = [refine(smooth, Poles(poles.drag, *start, *modes)) for start in starts]
        fit = min(tried, key=lambda one: one.cost)
        gain = self._worth(poles, found.correlation)
        gain -= _criterion(smooth, fit, correlation=found.correlation)
        return found if gain < LEAST_GAIN else self._settle(self._grow(fit))

    def _grow(self, best: Projected, *, holds_delay: bool = False) -> Projected:
        """Add the mode that takes most of the misfit away until none is worth it."""
        responses = self.smooth

        def improve(poles: Poles) -> Projected:
            return refine(responses, poles, steps=25, tolerance=1e-4, holds_delay=holds_delay)

        best = improve(best.poles)
        while best.poles.omega.size < self.most:
            new = improve(best.poles.add(*self.candidates.best(responses, best)))
            if _evidence(responses, new, best) < LEAST_EVIDENCE or _too_near(new.poles):
                break
            gain = _criterion(responses, best) - _criterion(responses, new)
            if self.count is None and gain <= LEAST_GAIN:
                break
            best = new
        return best

    def _settle(self, fit: Projected) -> Ordered:
        """Judge errors by what is left, and drop modes that nothing determines then."""
        fit = self._prune(self.smooth, fit)
        lines, share = judge_errors(self.responses, fit)
        fit = self._prune(lines, refine(lines, fit.poles))
        while self.count is None and (doubtful := _doubtful(lines, fit)) is not None:
            fit = refine(lines, fit.poles.drop(doubtful))
        return Ordered(lines, fit, _are_modes(lines, fit), share, _correlation(fit))

    def _prune(self, responses: Sequence[Lines], best: Projected) -> Projected:
        """Drop modes without which the fit is as good, the weakest first."""
        best = refine(responses, best.poles)
        while best.poles.omega.size > (self.count or 0):
            surest = np.abs(best.gains) / find_variances(responses, best).each_gain
            weakest = int(np.argmin(np.sum(np.minimum(surest[:, 1:-1], CERTAIN) ** 2, axis=0)))
            less = refine(responses, best.poles.drop(weakest), steps=15, tolerance=1e-4)
            if self.count is None and not _too_near(best.poles):
                correlation = _correlation(best)
                with_it = _criterion(responses, best, correlation=correlation)
                without = _criterion(responses, less, correlation=correlation)
                is_worth = without - with_it > LEAST_GAIN
                if is_worth and _evidence(responses, best, less) > LEAST_EVIDENCE:
                    break
            best = refine(responses, less.poles)
        return best


def _criterion(responses: Sequence[Lines], fit: Projected, *, correlation: float = 1.0) -> float:
    size = count_values(responses)
    cost = max(fit.cost, 1e-12 * size)
    return information_criterion(cost, size, fit.parameters, correlation)


def _evidence(responses: Sequence[Lines], fit: Projected, less: Projected) -> float:
    """χ² between two fits without the two lines that tell most."""
    after, before = (np.abs(np.concatenate(one.residuals)) ** 2 for one in (fit, less))
    gains = np.sort(before - after)
    variance = max(fit.cost / count_values(responses), 1e-12)
    return float(gains[:-2].sum() / variance)


def _spacing(responses: Sequence[Lines], f: Array) -> Array:
    """How far the lines about some frequencies lie apart where they are closest [Hz]."""
    return np.asarray(np.min([spacing_at(one.frequency_hz, f) for one in responses], axis=0))


def _doubtful(responses: Sequence[Lines], fit: Projected) -> int | None:
    """The least sure mode that nothing determines; None if all are determined.

    Its frequency is less sure than its half-power width or a part of the lines' distance, no
    response has a gain beyond its error, or it is a spike between two lines, sharper than any
    structure.
    """
    if not fit.poles.omega.size:
        return None
    variances = find_variances(responses, fit)
    spare = max(count_values(responses) - fit.parameters, 1)
    factor = np.sqrt(max(fit.cost / spare, 1.0) * _correlation(fit))
    surest = np.max(np.abs(fit.gains) / (factor * variances.each_gain), axis=0)[1:-1]
    f, zeta = fit.poles.frequency_hz, fit.poles.zeta
    spacing = _spacing(responses, f)
    is_spike = (zeta < SHARPEST) & (2 * zeta * f < 0.5 * spacing)
    known_to = np.maximum(2.0 * zeta * f, PLACED * spacing)
    is_unsure = factor * variances.of_modes[0] * f > known_to
    is_unsure |= (surest < LEAST_CERTAINTY) | is_spike
    # Background need not be sure: it only stands for what lies about the band.
    is_unsure &= _are_modes(responses, fit)
    return int(np.argmin(np.where(is_unsure, surest, np.inf))) if is_unsure.any() else None


def _too_near(poles: Poles) -> bool:
    order = np.argsort(poles.omega)
    omega, zeta = poles.omega[order], poles.zeta[order]
    width = 2.0 * zeta * omega
    apart = SEPARATION * (width[1:] + width[:-1])
    both_sharp = np.maximum(zeta[1:], zeta[:-1]) < BROADEST
    return bool(np.any((np.diff(omega) < apart) & both_sharp))


def _are_modes(responses: Sequence[Lines], fit: Projected) -> NDArray[np.bool_]:
    (low, high), f = ends_of(responses), fit.poles.frequency_hz
    return np.asarray((fit.poles.zeta < BROADEST) & (f > 1.05 * low) & (f < 0.98 * high))


# Where a fit begins


def _slope_of_phase(lines: Lines) -> float:
    """A delay from the median slope of the phase over the upper four fifths [s].

    A mode turns the phase within its width only, so that half of all pairs of lines see none; what
    is left is the delay.
    """
    f = lines.frequency_hz
    step = PHASE_STEP * f[-1]
    low = np.flatnonzero((f > 0.2 * f[-1]) & (f < f[-1] - step))
    if low.size < 3:
        return 0.0
    high = np.searchsorted(f, f[low] + step)
    turn = np.angle(lines.values[high] * np.conj(lines.values[low]))
    slope = turn / (2 * np.pi * (f[high] - f[low]))
    return float(np.clip(-np.median(slope), 0.0, LONGEST))


class _Candidates:
    """Poles on a grid, against which residuals are matched."""

    def __init__(self, responses: Sequence[Lines]) -> None:
        low, high = map(np.log, ends_of(responses))
        log_f = np.linspace(low, high, FINE)
        apart = _spacing(responses, np.exp(log_f))
        grids = []
        for zeta in RATIOS:
            # Closer than half the distance of two lines none is another.
            step = np.maximum(np.log1p(GRID_STEP * zeta), 0.5 * apart / np.exp(log_f))
            count = np.append(0.0, np.cumsum(np.diff(log_f) / step[1:]))
            at = np.linspace(0.0, count[-1], max(2, int(count[-1])))
            grids.append(2 * np.pi * np.exp(np.interp(at, count, log_f)))
        self.omega = np.concatenate(grids)
        self.zeta = np.repeat(RATIOS, [grid.size for grid in grids])
        self.shapes: dict[int, tuple[Array, Array]] = {}
        for one in responses:
            self.shapes.setdefault(id(one.frequency_hz), self._shapes(one))

    def _shapes(self, lines: Lines) -> tuple[Array, Array]:
        """Real above imaginary parts of 1/(s² + 2 ζ ω s + ω²), (2 n_lines, n_candidates); |.|²."""
        omega = 2 * np.pi * lines.frequency_hz[_searched(lines)][:, None]
        real, turned = self.omega**2 - omega**2, 2 * self.zeta * self.omega * omega
        power = 1.0 / (real**2 + turned**2)
        return np.concatenate([real * power, -turned * power]), power

    def best(self, responses: Sequence[Lines], known: Projected) -> tuple[float, float]:
        """ω and ζ of the mode that would lower the misfit most.

        The misfit that a mode of given pole takes away is (c · r)²/(c · c), with c its column less
        what b, the known modes and R can do: a matched filter on all poles of a grid, so that a
        mode between two lines is found by its flanks.
        """
        fall = np.zeros(self.omega.size)
        for place, (lines, residual) in enumerate(zip(responses, known.residuals, strict=True)):
            grid, chosen = id(lines.frequency_hz), _searched(lines)
            rows = weighed_rows(lines, known.poles, place)[:, chosen]
            # The last row is the weight alone: that of R.
            weight, half = rows[-1], rows.shape[1]
            stacked = np.concatenate([rows.real, rows.imag], axis=1).T
            q, _ = np.linalg.qr(stacked / np.linalg.norm(stacked, axis=0))
            turned = np.column_stack([q[:half] + 1j * q[half:], residual[chosen]])
            turned *= np.conj(weight)[:, None]
            shapes, power = self.shapes[grid]
            along = np.concatenate([turned.real, turned.imag]).T @ shapes
            before = np.abs(weight) ** 2 @ power
            after = before - np.sum(along[:-1] ** 2, axis=0)
            good = after > 1e-6 * before
            fall[good] += along[-1, good] ** 2 / after[good]
        most = int(np.argmax(fall))
        return float(self.omega[most]), float(self.zeta[most])


def _searched(lines: Lines) -> slice:
    return slice(None, None, 1 + lines.size // MOST_LINES)
