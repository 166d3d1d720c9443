"""Power by frequency of a vibration that nobody measured the force of.

Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mtcommission.identify.measurement import AllDirections, Array, TimeRecord
from mtcommission.identify.responses.averaged import (
    HALF_POWER_BINS,
    HIGHEST_SHARE,
    averages_of,
    segments_of,
)

KLIPPER_WINDOW, KLIPPER_KAISER = 0.5, 6.0
"""Least length of Klipper's window [s], rounded up to a power of two of samples, and its shape:
klippy/extras/shaper_calibrate.py at 84104bbb."""

WINDOW = 1.0
"""Length of the window [s], if the record has four of them: lines 1 Hz apart."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Power:
    """A power spectrum and what it is worth."""

    # frequency_hz, density: Shape (n_lines,).
    frequency_hz: Array
    density: Array
    averages: float  # Independent ones
    resolution_hz: float  # Half-power width of the window [Hz]


def estimate_power(values: Array, step: float) -> Power:
    """Return the power spectrum of a signal."""
    length = max(min(int(WINDOW / step), values.size // 4), 32)
    transformed = segments_of(values - values.mean(), length)
    frequency = np.fft.rfftfreq(length, step).astype(np.float64)
    kept = (frequency <= HIGHEST_SHARE / step) & (np.arange(frequency.size) >= 2)
    return Power(
        frequency_hz=frequency[kept],
        density=(np.abs(transformed[:, kept]) ** 2).mean(axis=0),
        averages=averages_of(len(transformed)),
        resolution_hz=HALF_POWER_BINS / (length * step),
    )


def power_as_klipper(record: TimeRecord) -> AllDirections | None:
    """Return the power of all channels together, as Klipper does; None of too short a record."""
    length = 1 << int(KLIPPER_WINDOW / record.sample_time - 1).bit_length()
    if record.size <= length:
        return None
    window, total = np.kaiser(length, KLIPPER_KAISER), np.zeros(length // 2 + 1)
    for channel in record.channels:
        parts = np.lib.stride_tricks.sliding_window_view(channel.values, length)
        parts = parts[:: length - length // 2]
        lines = np.fft.rfft(window * (parts - parts.mean(axis=1, keepdims=True)), axis=1)
        total += (np.abs(lines) ** 2).mean(axis=0)
    total[1:-1] *= 2.0
    frequency = np.fft.rfftfreq(length, record.sample_time).astype(np.float64)
    return AllDirections(frequency_hz=frequency, density=total, is_divided=False)
