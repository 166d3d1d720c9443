"""How a record was excited: by blows, by what repeats, and in which lines on purpose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, median_filter

from mtcommission.identify.measurement import Array

QUIET = 0.05
"""Share of the largest force that counts as none."""

MOST_BUSY = 0.05
"""Share of the samples with force up to which a record is one of blows."""

LEAST_LIKENESS = 0.95
"""Correlation of a signal with itself one period later that makes it periodic."""

SAME = 0.02
"""A shorter period is taken if its correlation is lower by no more than this."""

SHORTEST = 32
"""Samples of a period."""

CLIFF = 30.0
"""Fall of the input's power from five lines to the next five that ends its band, for good. Beyond
it distortion remains, which repeats as well: 15 dB, and a multisine falls by more than 20."""

SPARSE = 50.0
"""Power of the lines around over that of one which was left out on purpose."""

FAINTEST = 1e-6
"""Power over the largest one below which a line is none."""

PARTS = 6.0
"""Of an octave, in which the largest power is looked for."""

MOSTLY = 0.7
"""Share of the lines that stand out from which a spectrum is dense."""

NEIGHBOURS = 5
"""Lines over which a level, or a variance, is averaged."""


def find_blows(force: Array, step: float) -> list[int]:
    """Return the samples at which blows begin; [] if the record is none of blows."""
    rest = force - np.median(force)
    busy = np.abs(rest) > QUIET * np.abs(rest).max()
    if not busy.any() or busy.mean() > MOST_BUSY:
        return []
    places = np.flatnonzero(busy)
    gap = max(int(0.05 / step), 8)
    return [int(p) for p in places[np.concatenate(([True], np.diff(places) > gap))]]


def find_period(values: Array) -> int:
    """Return the period of a signal in samples; 0 if it has none that is recorded twice.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> find_period(np.tile(rng.standard_normal(100), 5))
    100
    >>> find_period(rng.standard_normal(500))
    0
    """
    size = values.size
    if size < 2 * SHORTEST:
        return 0
    transformed = np.fft.rfft(values, 2 * size)
    product = np.fft.irfft(np.abs(transformed) ** 2)[: size // 2 + 1]
    energy = np.concatenate(([0.0], np.cumsum(values**2)))
    lags = np.arange(size // 2 + 1)
    heads, tails = energy[size - lags], energy[size] - energy[lags]
    with np.errstate(all="ignore"):
        likeness = np.nan_to_num(product / np.sqrt(heads * tails))
    likeness[:SHORTEST] = -1.0
    best = int(np.argmax(likeness))
    if likeness[best] < LEAST_LIKENESS:
        return 0
    for parts in range(best // SHORTEST, 1, -1):
        lag = round(best / parts)
        if abs(lag * parts - best) <= parts // 2 and likeness[lag] >= likeness[best] - SAME:
            near = slice(max(lag - 1, SHORTEST), lag + 2)
            return near.start + int(np.argmax(likeness[near]))
    return best


def excited_band(power: Array) -> NDArray[np.bool_]:
    """Return which lines of an input are excited on purpose, shape (n_lines,).

    A loop makes the input's power fall slowly, a resonance digs a hole that ends; only where the
    power falls off a cliff and never recovers does the excitation end. Where most lines stand far
    below their neighbours, only some are excited (odd ones, or so many per octave).

    Examples
    --------
    >>> power = np.full(60, 1e-4); power[10:40] = 1.0
    >>> np.flatnonzero(excited_band(power))[[0, -1]]
    array([10, 39])
    """
    band = np.zeros(power.size, dtype=np.bool_)
    stands_out = power * SPARSE > _envelope(power)
    loud = power > FAINTEST * power[1:].max()
    loud[0] = False
    dense = not loud.any() or stands_out[loud].mean() > MOSTLY
    lines = np.flatnonzero(loud if dense else loud & stands_out)
    band[lines[_between_cliffs(power[lines])]] = True
    return band


def _between_cliffs(power: Array) -> slice:
    """The lines from the last rise off a cliff to the first fall, around the loudest."""
    if power.size < 4 * NEIGHBOURS:
        return slice(0, power.size)
    level = median_filter(power, size=NEIGHBOURS, mode="nearest")
    loudest = int(np.argmax(level))
    below = _end_of_band(power[::-1], level[::-1], power.size - 1 - loudest)
    return slice(power.size - below, _end_of_band(power, level, loudest))


def _envelope(power: Array) -> Array:
    """The largest power within about a quarter of an octave, or a few lines, of each line."""
    lines = np.arange(1, power.size)
    widths = np.maximum(NEIGHBOURS, lines * np.log(2.0) / PARTS)
    parts = np.cumsum(1.0 / widths).astype(np.int64)
    starts = np.flatnonzero(np.diff(parts, prepend=-1))
    highest = maximum_filter1d(np.maximum.reduceat(power[1:], starts), 3, mode="nearest")
    places = np.cumsum(np.diff(parts, prepend=parts[0]) > 0)
    return np.concatenate(([power[0]], highest[places]))


def _end_of_band(power: Array, level: Array, start: int) -> int:
    """The first line beyond the band, upwards from a line inside it."""
    highest_after = np.maximum.accumulate(level[::-1])[::-1]
    for line in range(start + 1, level.size - NEIGHBOURS):
        before = float(np.median(power[max(line - NEIGHBOURS, 0) : line]))
        if before > CLIFF * highest_after[line + NEIGHBOURS // 2]:
            while power[line] * CLIFF > before:  # the median falls before the edge
                line += 1
            return line
    return level.size
