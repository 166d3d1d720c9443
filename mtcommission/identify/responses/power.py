"""Power by frequency of a vibration that nobody measured the force of.

Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mtcommission.identify.measurement import Array
from mtcommission.identify.responses.ratio import HIGHEST_SHARE
from mtcommission.identify.responses.welch import HALF_POWER_BINS, averages_of, segments_of

WINDOW = 1.0
"""Length of the window [s], if the record has four of them: lines 1 Hz apart."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Power:
    """A power spectrum and what it is worth.

    Parameters
    ----------
    frequency_hz, density
        Shape (n_lines,).
    averages
        Independent ones.
    resolution_hz
        Half-power width of the window [Hz].
    """

    frequency_hz: Array
    density: Array
    averages: float
    resolution_hz: float


def estimate_power(values: Array, step: float) -> Power:
    """Return the power spectrum of a signal.

    Parameters
    ----------
    values
        Shape (n,).
    step
        Of the clock [s].
    """
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
