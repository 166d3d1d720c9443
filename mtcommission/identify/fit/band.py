"""Which lines tell of the machine: by coherence, then by misfit, then by what a low mode claims."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.fit.lines import Lines, neighbours
from mtcommission.identify.fit.order import BROADEST, Ordered
from mtcommission.identify.measurement import FrequencyResponse

Band = tuple[float, float]

LEAST_COHERENCE = 0.5
"""Median over nine lines below which the ends of a response are left out (empirical)."""
EXCESS = 2.5
"""Misfit of a third of an octave at an end, in that of all lines, beyond which it is left out."""
LEAST_LINES = 3
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


def coherent_band(responses: Sequence[FrequencyResponse]) -> Band:
    """Return the band in which at least one response is coherent [Hz]."""
    lows, highs = [], []
    for response in responses:
        f = response.frequency_hz
        if response.coherence is None:
            lows.append(float(f[0]))
            highs.append(float(f[-1]))
            continue
        good = np.flatnonzero(
            np.median(neighbours(response.coherence, 9), axis=1) >= LEAST_COHERENCE
        )
        if good.size:
            lows.append(float(f[good[0]]))
            highs.append(float(f[good[-1]]))
    if not lows:
        ends = [(float(r.frequency_hz[0]), float(r.frequency_hz[-1])) for r in responses]
        return min(low for low, _ in ends), max(high for _, high in ends)
    return min(lows), max(highs)


def narrower_band(found: Ordered, base: Sequence[Lines], *, by_drive: bool) -> Band | None:
    """Return a narrower band where the ends of a fit do not obey its model; None: all do."""
    low = min(float(lines.frequency_hz[0]) for lines in base)
    high = max(float(lines.frequency_hz[-1]) for lines in base)
    friction = _friction_end(found, low) if by_drive else None
    if friction and np.log2(high / friction) >= LEAST_OCTAVES:
        return friction, high
    cut_low, cut_high = _misfit_ends(found, base, low, high)
    if (cut_low, cut_high) == (low, high) or np.log2(cut_high / cut_low) < LEAST_OCTAVES:
        return None
    return cut_low, cut_high


def _friction_end(found: Ordered, low: float) -> float | None:
    """Where the band should begin if a pole at its low end is friction, no mode."""
    f = found.fit.poles.omega / (2 * np.pi)
    ends = [ABOVE * float(f[k]) for k in friction_poles(found, low)]
    return max(ends) if ends and max(ends) > low * TOLERANCE else None


def friction_poles(found: Ordered, low: float) -> list[int]:
    """Return which poles stand for sticking friction, no mode.

    They lie below all sharp modes, and are strongly damped or show no free mass below them.
    """
    f, zeta = found.fit.poles.omega / (2 * np.pi), found.fit.poles.zeta
    sharp = f[np.array(found.is_mode, dtype=bool) & (zeta < FRICTION_RATIO) & (f > LOW_END * low)]
    ceiling = min(LOW_END * low, BELOW * float(sharp.min()) if sharp.size else np.inf)
    return [
        k
        for k in range(f.size)
        if f[k] < ceiling
        and (zeta[k] > FRICTION_RATIO or f[k] < TOLERANCE * low or not _rigid_below(found, k))
    ]


def _rigid_below(found: Ordered, pole: int) -> bool:
    """Whether position lags force by half a turn below a pole, as that of a free mass does."""
    frequency_hz = float(found.fit.poles.omega[pole]) / (2 * np.pi)
    signs = []
    for lines, gains, delay in zip(
        found.lines, found.fit.gains, found.fit.poles.delays.tolist(), strict=True
    ):
        below = lines.frequency_hz < 0.8 * frequency_hz
        position = lines.values * np.exp(lines.s * delay) / lines.s**lines.derivative
        # Whether the sensor counts backwards shows above the pole, where friction has let go.
        turned = np.sign(gains[0] + gains[1 + pole]) * position[below]
        signs += (turned.real / np.abs(turned)).tolist()
    return len(signs) >= 3 and float(np.median(signs)) < -0.5


def _misfit_ends(found: Ordered, base: Sequence[Lines], low: float, high: float) -> Band:
    edges = _edges(base, low, high * (1 + 1e-9))
    f = np.concatenate([lines.frequency_hz for lines in base])
    noise = np.concatenate([lines.error**2 for lines in base])
    sizes = np.concatenate([np.abs(lines.values) ** 2 for lines in base])
    missed = zip(found.fit.residuals, found.lines, strict=True)
    squares = np.concatenate([0.5 * np.abs(residual * own.error) ** 2 for residual, own in missed])
    place = np.clip(np.searchsorted(edges, f, side="right") - 1, 0, edges.size - 2)
    counts = np.bincount(place, minlength=edges.size - 1)

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        sums = np.bincount(place, values, edges.size - 1).astype(np.float64)
        means: NDArray[np.float64] = sums / np.maximum(counts, 1)
        return means

    # What the model misses in most stretches: the worst ends must not excuse themselves.
    share = float(np.median(mean(np.maximum(squares - noise, 0.0) / sizes)[counts > 0]))
    rms = np.sqrt(mean(squares / (noise + min(share, found.model_error**2) * sizes)))
    typical = float(np.median(rms[counts > 0]))
    bad = rms > EXCESS * max(typical, 1.0)
    first, last = 0, bad.size
    while first < bad.size // 3 and (bad[first] or counts[first] == 0):
        first += 1
    while last > bad.size - bad.size // 3 and (bad[last - 1] or counts[last - 1] == 0):
        last -= 1
    has_low, has_high = bool(bad[:first].any()), bool(bad[last:].any())
    return (float(edges[first]) if has_low else low), (float(edges[last]) if has_high else high)


def _edges(base: Sequence[Lines], low: float, high: float) -> NDArray[np.float64]:
    """Ends of stretches of a third of an octave, or of enough lines where these are rarer."""
    f = np.sort(np.concatenate([lines.frequency_hz for lines in base]))
    edges = [low]
    for edge in np.geomspace(low, high, max(4, round(3 * np.log2(high / low))) + 1)[1:].tolist():
        if np.searchsorted(f, edge) - np.searchsorted(f, edges[-1]) >= LEAST_LINES:
            edges.append(edge)
    return np.array([*edges[:-1], high]) if len(edges) > 1 else np.array([low, high])


def broad_poles(found: Ordered) -> list[float]:
    """Return the frequencies of background within the band [Hz]."""
    return [
        float(omega) / (2 * np.pi)
        for omega, zeta, is_mode in zip(
            found.fit.poles.omega, found.fit.poles.zeta, found.is_mode, strict=True
        )
        if not is_mode and zeta >= BROADEST
    ]
