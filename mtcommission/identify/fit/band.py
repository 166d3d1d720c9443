"""Which lines tell of the machine: by coherence, then by misfit, then by what a low mode claims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.identify.fit.lines import (
    ERROR_FLOOR,
    Lines,
    count_values,
    ends_of,
    neighbours,
    see,
    share_frequencies,
)
from mtcommission.identify.fit.noise import smooth_errors
from mtcommission.identify.fit.order import BROADEST, Ordered, choose_modes
from mtcommission.identify.measurement import Array, FrequencyResponse, Sensor
from mtcommission.machine.identified import MOST_MISFIT

Band = tuple[float, float]

LEAST_LINES = 12
"""Fewer lines of a response in the band tell nothing."""
MOST_CUTS = 3
"""How often the ends of a band are cut."""
FEW_AVERAGES = 4.0
"""Of fewer a coherence tells little: it comes out near 1 by chance."""
MOST_ERROR = 0.1
"""Share of |H| that the model of a drive's response may miss, for the band to be left as it is."""
LEAST_COHERENCE = 0.5
"""Median over nine lines below which the ends of a response are left out (empirical)."""
EXCESS = 2.5
"""Misfit of a third of an octave at an end, in that of all lines, beyond which it is left out."""
LEAST_LINES_OF_STRETCH = 3
"""Of a stretch whose misfit is judged."""
LOW_END = 3.0
"""A mode below so many times the lowest line must show a rigid body below it."""
FRICTION_RATIO = 0.12
"""Damping beyond which a mode at the low end is taken for friction: sticking bodies spring."""
BELOW = 0.5
"""Friction lies below the lowest sharp mode times this."""
TOLERANCE = 1.05
"""Relative distance within which a pole sits on the end of the band."""
ABOVE = 1.8
"""Where a band begins whose lower end friction governs, in that false mode's frequency."""
LEAST_OCTAVES = 2.0
"""No cut leaves less than that."""
LEAST_OCTAVES_HALVED = 4.0
"""Of a band that is halved: a rigid body, a mode and what lies above it."""


def coherent_band(responses: Sequence[FrequencyResponse]) -> Band:
    """Return the band in which at least one response is coherent [Hz]."""
    ends: list[Band] = []
    for response in responses:
        good = f = response.frequency_hz
        if response.coherence is not None:
            median = np.median(neighbours(response.coherence, 9), axis=1)
            good = f[median >= LEAST_COHERENCE]
        if good.size:
            ends.append((float(good[0]), float(good[-1])))
    ends = ends or [(float(r.frequency_hz[0]), float(r.frequency_hz[-1])) for r in responses]
    return min(low for low, _ in ends), max(high for _, high in ends)


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """A fit in a band: the responses with enough lines there, these lines as coherence weighs."""

    band: Band
    used: list[FrequencyResponse]
    base: list[Lines]
    found: Ordered

    @property
    def by_drive(self) -> bool:
        """Whether the drive shakes, as far as one can tell: an encoder was recorded."""
        return any(one.sensor is Sensor.ENCODER for one in self.used)

    @property
    def spare(self) -> int:
        """Numbers that were measured beyond those that were fitted."""
        return max(count_values(self.base) - self.found.fit.parameters, 1)

    @property
    def is_described(self) -> bool:
        """Whether the model is near what was measured; a hammer's response may be farther."""
        is_near = self.found.model_error <= MOST_ERROR or not self.by_drive
        return self.misfit <= MOST_MISFIT and is_near

    @property
    def missed(self) -> list[Array]:
        """|model - measured|² of each response, line by line."""
        pairs = zip(self.found.fit.residuals, self.found.lines, strict=True)
        return [np.abs(residual * own.error) ** 2 for residual, own in pairs]

    @property
    def misfit(self) -> float:
        """Weighted rms of the residuals by their noise, by the free lines.

        The noise is what coherence and averages tell; where a file lacks them, or they are few, it
        is what neighbouring residuals differ by, which no smooth error of the model can make small.
        """
        squares = 0.0
        residuals, weighed = self.found.fit.residuals, self.found.lines
        smooth = smooth_errors(self.base)
        for response, missed, residual, own, lines in zip(
            self.used, self.missed, residuals, weighed, smooth, strict=True
        ):
            noise = lines.error
            if response.coherence is None or (response.averages or 0.0) < FEW_AVERAGES:
                scatter = 0.5 * float(np.sqrt(np.mean(np.abs(np.diff(residual)) ** 2)))
                noise = np.maximum(scatter * own.error, ERROR_FLOOR * np.abs(lines.values))
            squares += float(np.sum(missed / noise**2))
        return float(np.sqrt(squares / self.spare))

    @property
    def friction(self) -> list[int]:
        """Which poles stand for sticking friction, no mode.

        They lie below all sharp modes, and are strongly damped or show no free mass below them.
        """
        if not self.by_drive:
            return []
        poles, (low, _) = self.found.fit.poles, ends_of(self.found.lines)
        f, zeta = poles.frequency_hz, poles.zeta
        sharp = f[self.found.is_mode & (zeta < FRICTION_RATIO) & (f > LOW_END * low)]
        ceiling = min(LOW_END * low, BELOW * float(sharp.min(initial=np.inf)))
        return [
            k
            for k in np.flatnonzero(f < ceiling).tolist()
            if zeta[k] > FRICTION_RATIO or f[k] < TOLERANCE * low or not self._is_rigid_below(k)
        ]

    def _is_rigid_below(self, pole: int) -> bool:
        """Whether position lags force by half a turn below a pole, as that of a free mass does."""
        fit, signs = self.found.fit, list[float]()
        for lines, gains, delay in zip(
            self.found.lines, fit.gains, fit.poles.delays.tolist(), strict=True
        ):
            below = lines.frequency_hz < 0.8 * fit.poles.frequency_hz[pole]
            # Whether the sensor counts backwards shows above the pole, where friction has let go.
            turned = np.sign(gains[0] + gains[1 + pole]) * lines.position(delay)[below]
            signs += (turned.real / np.abs(turned)).tolist()
        return len(signs) >= 3 and float(np.median(signs)) < -0.5

    @property
    def background(self) -> list[float]:
        """Frequencies of broad terms within the band [Hz]."""
        poles = self.found.fit.poles
        broad = ~self.found.is_mode & (poles.zeta >= BROADEST)
        return [float(one) for one in poles.frequency_hz[broad]]

    @property
    def narrower(self) -> Band:
        """The band without ends that do not obey the model; the same where all do."""
        low, high = ends_of(self.base)
        f = self.found.fit.poles.frequency_hz
        friction = max((ABOVE * float(f[k]) for k in self.friction), default=0.0)
        if friction > low * TOLERANCE and np.log2(high / friction) >= LEAST_OCTAVES:
            return friction, high
        cut_low, cut_high = self._cut_by_misfit(low, high)
        return (low, high) if np.log2(cut_high / cut_low) < LEAST_OCTAVES else (cut_low, cut_high)

    def _cut_by_misfit(self, low: float, high: float) -> Band:
        edges = _edges(self.base, low, high * (1 + 1e-9))
        f = np.concatenate([lines.frequency_hz for lines in self.base])
        noise = np.concatenate([lines.error**2 for lines in self.base])
        sizes = np.concatenate([np.abs(lines.values) ** 2 for lines in self.base])
        squares = 0.5 * np.concatenate(self.missed)
        place = np.clip(np.searchsorted(edges, f, side="right") - 1, 0, edges.size - 2)
        counts = np.bincount(place, minlength=edges.size - 1)

        def mean(values: Array) -> Array:
            sums = np.bincount(place, values, edges.size - 1)
            return np.asarray(sums / np.maximum(counts, 1))

        # What the model misses in most stretches: the worst ends must not excuse themselves.
        share = float(np.median(mean(np.maximum(squares - noise, 0.0) / sizes)[counts > 0]))
        share = min(share, self.found.model_error**2)
        rms = np.sqrt(mean(squares / (noise + share * sizes)))
        bad = rms > EXCESS * max(float(np.median(rms[counts > 0])), 1.0)
        first = _skipped(bad, counts)
        last = bad.size - _skipped(bad[::-1], counts[::-1])
        return (
            float(edges[first]) if bad[:first].any() else low,
            float(edges[last]) if bad[last:].any() else high,
        )


def _skipped(bad: NDArray[np.bool_], counts: NDArray[np.intp]) -> int:
    """How many stretches at the beginning, at most a third, are bad or empty."""
    good = np.flatnonzero(~bad & (counts > 0))
    return min(int(good[0]) if good.size else bad.size, bad.size // 3)


def _edges(base: Sequence[Lines], low: float, high: float) -> Array:
    """Ends of stretches of a third of an octave, or of enough lines where these are rarer."""
    f = np.sort(np.concatenate([lines.frequency_hz for lines in base]))
    edges = [low]
    for edge in np.geomspace(low, high, max(4, round(3 * np.log2(high / low))) + 1)[1:].tolist():
        if np.searchsorted(f, edge) - np.searchsorted(f, edges[-1]) >= LEAST_LINES_OF_STRETCH:
            edges.append(edge)
    return np.array([*edges[:-1], high]) if len(edges) > 1 else np.array([low, high])


def inside(response: FrequencyResponse, band: Band) -> NDArray[np.bool_]:
    """Return which lines of a response lie in a band and hold something."""
    f, slack = response.frequency_hz, 1e-9 * band[1]
    is_number = np.isfinite(response.values) & (np.abs(response.values) > 0.0)
    return np.asarray((f >= band[0] - slack) & (f <= band[1] + slack) & is_number)


def fit_in(
    responses: Sequence[FrequencyResponse], band: Band, count: int | None, *, narrow: bool
) -> Trial:
    """Return the fit in a band, or where its ends do not obey the model in a narrower one.

    Raise InputError if no response has enough lines there.
    """
    trial: Trial | None = None
    for _ in range(1 + (MOST_CUTS if narrow else 0)):
        used = [one for one in responses if inside(one, band).sum() >= LEAST_LINES]
        if trial and [one.source for one in used] != [one.source for one in trial.used]:
            break
        if not used:
            (low, high), lines = band, int(inside(responses[0], band).sum())
            few = {"lines": lines, "least": LEAST_LINES, "low": low, "high": high}
            message = Message("identify-too-few-in-band", **few)
            raise InputError([Fault(where=responses[0].source.name, message=message)])
        base = share_frequencies([see(one, inside(one, band)) for one in used])
        trial = Trial(band=band, used=used, base=base, found=choose_modes(base, count=count))
        if not narrow or (band := trial.narrower) == ends_of(base):
            break
    assert trial is not None
    return trial


def fit_describable(responses: Sequence[FrequencyResponse], band: Band, count: int | None) -> Trial:
    """Return the fit in the widest band, by octaves from above, that the model describes.

    A drive measures to half its sampling rate, where current loop and shafts have more modes than
    a model holds; the many lines there would outvote the few in which the axis swings. Where no
    band is described it is the fit in the whole one.
    """
    trial = whole = fit_in(responses, band, count, narrow=True)
    while not (trial.is_described and (trial is whole or trial.found.is_mode.any())):
        band = band[0], 0.5 * trial.band[1]  # what a poor fit cut at the low end may be good
        if np.log2(band[1] / band[0]) < LEAST_OCTAVES_HALVED:
            return whole
        trial = fit_in(responses, band, count, narrow=True)
    return trial
