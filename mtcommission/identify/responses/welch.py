"""Welch's estimate of a response, with and without a recorded excitation.

Without one H = S_uy / S_uu (H1). With one, r, H = S_ry / S_ru: in a closed loop the disturbances
come back through the controller and stand in u, but not in r, so only this one is unbiased.
Its variance is S_vv S_rr / (n |S_ru|²) with v = y - H u, which for r = u is that of H1.

Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73; R. Pintelon, J. Schoukens,
System Identification, 2nd ed., 2.6.4; overlap: F. J. Harris, Proc. IEEE 66 (1978), eq. (19).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks, peak_widths
from scipy.signal.windows import hann

from mtcommission.identify.measurement import Array, ComplexArray
from mtcommission.identify.responses.ratio import HIGHEST_SHARE, Lines, Signals

HALF_POWER_BINS = 1.44
"""Half-power width of Hann's window in bins. Source: Harris 1978, table I."""

OVERLAP_CORRELATION = 1.0 / 36.0
"""Square of Hann's correlation at half overlap, 1/6. Source: Harris 1978, eq. (17)."""

FEWEST_SEGMENTS = 7
FIRST_SEGMENTS = 24
MOST_LINES = 3000
SPACING_OF_WIDTH = 0.4
"""Largest line spacing per half-power width 2 ζ f: beyond it damping is read too large by the
window. Source: tried on records of 2, 4 and 8 s, see docs/identification.md."""

LEAST_PEAK_DB = 6.0
CLEAR = 0.6
"""Coherence from which a peak is believed when the window is chosen."""

CARRIES = 0.2
"""Coherence of excitation and input from which the excitation is used."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WelchEstimate:
    """A response and how its window was chosen."""

    lines: Lines  # The response
    window: float  # Length [s]
    segments: int  # Number, overlapping by a half
    narrowest_hz: float  # Half-power width of the sharpest peak [Hz]; 0 where none was seen
    is_resolved: bool  # Whether the line spacing is fine enough for it
    is_joint: bool  # Whether the recorded excitation was used


def estimate_by_welch(signals: Signals) -> WelchEstimate:
    """Return a response from a record that repeats nothing.

    The window is lengthened from a twelfth of the record until the sharpest peak is resolved, but
    not beyond the length that leaves seven overlapping segments.
    """
    size = signals.input.size
    longest = 2 * size // (FEWEST_SEGMENTS + 1)
    length = min(2 * size // (FIRST_SEGMENTS + 1), int(MOST_LINES / HIGHEST_SHARE))
    while True:
        lines, segments, is_joint = _estimate(signals, length)
        narrowest = _narrowest_width(signals, lines)
        spacing = 1.0 / (length * signals.step)
        is_resolved = narrowest == 0.0 or spacing <= SPACING_OF_WIDTH * narrowest
        if is_resolved or length >= longest:
            return WelchEstimate(
                lines=lines,
                window=length * signals.step,
                segments=segments,
                narrowest_hz=narrowest,
                is_resolved=is_resolved,
                is_joint=is_joint,
            )
        length = min(longest, int(1.5 * length))


def segments_of(values: Array, length: int) -> ComplexArray:
    """Return the transforms of Hann-windowed segments, shape (n_segments, n_lines)."""
    parts = np.lib.stride_tricks.sliding_window_view(values, length)[:: max(length // 2, 1)]
    parts = parts - parts.mean(axis=1, keepdims=True)
    transformed: ComplexArray = np.fft.rfft(parts * hann(length, sym=False), axis=1)
    return transformed


def averages_of(segments: int) -> float:
    """Return how many independent averages segments with half overlap are worth."""
    return segments / (1.0 + 2.0 * OVERLAP_CORRELATION * (segments - 1) / segments)


def _estimate(signals: Signals, length: int) -> tuple[Lines, int, bool]:
    frequency = np.fft.rfftfreq(length, signals.step)
    # Hann's window spreads what is near 0 Hz into the first two lines.
    kept = (frequency <= HIGHEST_SHARE / signals.step) & (np.arange(frequency.size) >= 2)
    U = segments_of(signals.input, length)[:, kept]
    Y = segments_of(signals.output, length)[:, kept]
    frequency = frequency[kept]
    R, is_joint = U, False
    if signals.reference is not None:
        recorded = segments_of(signals.reference, length)[:, kept]
        if _carries(recorded, U, Y):
            R, is_joint = recorded, True
    S_rr, S_ru = _mean(R, R).real, _mean(R, U)
    with np.errstate(all="ignore"):
        H = _mean(R, Y) / S_ru
        S_vv = _mean(Y - H * U, Y - H * U).real
        noise = S_vv * S_rr / (np.abs(S_ru) * np.abs(H)) ** 2
        gamma2 = 1.0 / (1.0 + noise)
    good = np.isfinite(H) & np.isfinite(gamma2) & (np.abs(H) > 0.0)
    frequency, H, gamma2 = frequency[good], H[good], gamma2[good]
    lines = Lines(
        frequency_hz=frequency,
        values=signals.undo(frequency, H),
        coherence=gamma2,
        averages=averages_of(len(U)),
        resolution_hz=HALF_POWER_BINS / (length * signals.step),
    )
    return lines, len(U), is_joint


def _mean(one: ComplexArray, other: ComplexArray) -> ComplexArray:
    mean: ComplexArray = (one.conj() * other).mean(axis=0)
    return mean


def _carries(R: ComplexArray, U: ComplexArray, Y: ComplexArray) -> bool:
    """Whether the excitation moves the input in the lines in which the input moves the output."""
    with np.errstate(all="ignore"):
        by_input = np.abs(_mean(U, Y)) ** 2 / (_mean(U, U) * _mean(Y, Y)).real
        by_reference = np.abs(_mean(R, U)) ** 2 / (_mean(R, R) * _mean(U, U)).real
    moved = by_reference[np.isfinite(by_reference) & (by_input > 0.3)]
    return bool(moved.size) and float(np.median(moved)) > CARRIES


def _narrowest_width(signals: Signals, lines: Lines) -> float:
    """Half-power width of the sharpest clear peak [Hz], freed of the window's own."""
    if lines.frequency_hz.size < 5:
        return 0.0
    spacing = float(np.median(np.diff(lines.frequency_hz)))
    # Times f the velocity's peaks stand on a level ground, and a position's nearly so.
    power = 1 if not signals.is_difference else 2
    size = 20.0 * np.log10(np.abs(lines.values) * lines.frequency_hz**power)
    peaks, _ = find_peaks(size, prominence=LEAST_PEAK_DB)
    peaks = peaks[lines.coherence[peaks] > CLEAR]
    if not peaks.size:
        return 0.0
    ease = 10.0 ** (size / 10.0)
    widths = peak_widths(ease, peaks, rel_height=0.5)[0] * spacing
    own = np.maximum(widths - lines.resolution_hz, 0.2 * widths)
    return float(own.min())
