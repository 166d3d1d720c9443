"""Power by frequency of a vibration that nobody measured the force of, by Welch's method."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.signal import welch

from mtcommission.identify.measurement import AllDirections, Array, TimeRecord
from mtcommission.identify.responses.averaged import (
    HALF_POWER_BINS,
    HIGHEST_SHARE,
    averages_of,
)

KLIPPER_WINDOW, KLIPPER_KAISER = 0.5, 6.0
"""Least length of Klipper's window [s], rounded up to a power of two of samples, and its shape:
klippy/extras/shaper_calibrate.py at 84104bbb."""

WINDOW = 1.0
"""Length of the window [s], if the record has four of them: lines 1 Hz apart."""


class Power(NamedTuple):
    """A power spectrum and what it is worth."""

    # frequency_hz, density: Shape (n_lines,).
    frequency_hz: Array
    density: Array
    averages: float  # Independent ones
    resolution_hz: float  # Half-power width of the window [Hz]


def estimate_power(values: Array, step: float) -> Power:
    """Return the power spectrum of a signal."""
    length = max(min(int(WINDOW / step), values.size // 4), 32)
    frequency, density = welch(values, 1.0 / step, nperseg=length, noverlap=length - length // 2)
    kept = (frequency <= HIGHEST_SHARE / step) & (np.arange(frequency.size) >= 2)
    segments = 1 + (values.size - length) // (length // 2)
    resolution = HALF_POWER_BINS / (length * step)
    return Power(frequency[kept], density[kept], averages_of(segments), resolution)


def power_as_klipper(record: TimeRecord) -> AllDirections | None:
    """Return the power of all channels together, as Klipper does; None of too short a record."""
    length = 1 << int(KLIPPER_WINDOW / record.sample_time - 1).bit_length()
    if record.size <= length:
        return None
    window: Any = np.kaiser(length, KLIPPER_KAISER)
    rate = 1.0 / record.sample_time
    signals = np.array([channel.values for channel in record.channels])
    frequency, density = welch(signals, rate, window, nperseg=length, noverlap=length // 2)
    return AllDirections(frequency_hz=frequency, density=density.sum(axis=0), is_divided=False)
