"""Response of a record of hammer blows: each from its blow to the next, averaged.

A blow is short and what follows dies away, so no window is needed: the transforms begin before the
blow and end before the next one. What has not died away until then is said.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mtcommission.identify.measurement import Array
from mtcommission.identify.responses.ratio import HIGHEST_SHARE, Lines, Signals

QUIET = 0.05
"""Share of the largest force that counts as none."""

MOST_BUSY = 0.05
"""Share of the samples with force up to which a record is one of blows."""

BEFORE = 0.005
"""Time before a blow at which its part of the record begins [s]."""

USEFUL = 1e-2
"""Power of the blow over that at low frequency, down to which lines are kept: 20 dB."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImpactEstimate:
    """A response by blows."""

    lines: Lines  # The response, in the band that the blows excite
    blows: int  # Averaged
    duration: float  # Of the part of each [s]
    left_over: float  # Largest share of a response that was left at the end of its part


def find_blows(force: Array, step: float) -> list[int]:
    """Return the samples at which blows begin; [] if the record is none of blows."""
    rest = force - np.median(force)
    busy = np.abs(rest) > QUIET * np.abs(rest).max()
    if not busy.any() or busy.mean() > MOST_BUSY:
        return []
    places = np.flatnonzero(busy)
    gap = max(int(0.05 / step), 8)
    return [int(p) for p in places[np.concatenate(([True], np.diff(places) > gap))]]


def estimate_by_blows(signals: Signals, blows: list[int]) -> ImpactEstimate:
    """Return a response from a record of blows."""
    lead = int(BEFORE / signals.step)
    starts = [max(blow - lead, 0) for blow in blows]
    gaps = np.diff([*starts, signals.input.size])
    whole = gaps[:-1].min() if len(starts) > 1 else gaps[0]
    if gaps[-1] < 0.7 * whole:  # the last one was cut
        starts = starts[:-1]
        length = int(whole)
    else:
        length = int(min(whole, gaps[-1]))
    u = np.stack([signals.input[start : start + length] for start in starts])
    y = np.stack([signals.output[start : start + length] for start in starts])
    u = u - np.median(u, axis=1, keepdims=True)
    y = y - np.median(y[:, -max(length // 10, 1) :], axis=1, keepdims=True)
    tail = np.abs(y[:, -max(length // 20, 1) :]).max(axis=1) / np.abs(y).max(axis=1)
    frequency: Array = np.fft.rfftfreq(length, signals.step).astype(np.float64)
    U, Y = np.fft.rfft(u, axis=1), np.fft.rfft(y, axis=1)
    S_uu, S_yy = (np.abs(U) ** 2).mean(axis=0), (np.abs(Y) ** 2).mean(axis=0)
    S_uy = (U.conj() * Y).mean(axis=0)
    kept = (frequency > 0.0) & (frequency <= HIGHEST_SHARE / signals.step)
    kept &= (S_uu > USEFUL * S_uu[1:].max()) & (S_yy > 0.0)
    frequency = frequency[kept]
    lines = Lines(
        frequency_hz=frequency,
        values=signals.undo(frequency, S_uy[kept] / S_uu[kept]),
        coherence=np.abs(S_uy[kept]) ** 2 / (S_uu[kept] * S_yy[kept]),
        averages=float(len(starts)),
        resolution_hz=0.0,
    )
    return ImpactEstimate(
        lines=lines,
        blows=len(starts),
        duration=length * signals.step,
        left_over=float(tail.max()),
    )
