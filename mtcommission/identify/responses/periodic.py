"""Response of a record whose excitation repeats: by whole periods, without leakage.

Averages over periods before dividing: noise of the input then biases nothing, and neither does a
closed loop, since noise does not repeat. The spread between periods is the variance.

Source: R. Pintelon, J. Schoukens, System Identification, 2nd ed., 2.5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, median_filter

from mtcommission.identify.measurement import Array, ComplexArray
from mtcommission.identify.responses.ratio import HIGHEST_SHARE, Lines, Signals

LEAST_LIKENESS = 0.95
"""Correlation of a signal with itself one period later that makes it periodic."""

SAME = 0.02
"""A shorter period is taken if its correlation is lower by no more than this."""

SHORTEST = 32
"""Samples of a period."""

EXCITED = 20.0
"""Power of a line of the input over the variance of its mean from which it counts as excited."""

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

FEW_PERIODS = 8
NEIGHBOURS = 5
"""Lines over which the variance is averaged where fewer periods were recorded."""

UNSETTLED = 4.0
"""How much more the first period may differ from the others than they do among themselves."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PeriodicEstimate:
    """A response by periods."""

    lines: Lines  # The response in the excited lines
    period: float  # [s]
    periods: int  # Used
    left_out: int  # Periods at the start in which the transient had not died away


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


def estimate_by_periods(signals: Signals, period: int) -> PeriodicEstimate:
    """Return a response from a record that repeats."""
    count = signals.input.size // period
    first = signals.input.size - count * period
    U = np.fft.rfft(signals.input[first:].reshape(count, period), axis=1)
    Y = np.fft.rfft(signals.output[first:].reshape(count, period), axis=1)
    left_out = 0
    if count > 2 and _is_unsettled(U, Y):
        U, Y, left_out = U[1:], Y[1:], 1
    used = len(U)
    frequency = np.fft.rfftfreq(period, signals.step)
    U_mean, Y_mean = U.mean(axis=0), Y.mean(axis=0)
    power = np.abs(U_mean) ** 2
    spread = _smooth(U.var(axis=0, ddof=1), used)
    excited = (power > EXCITED * spread / used) & excited_band(power)
    excited &= (frequency > 0.0) & (frequency <= HIGHEST_SHARE / signals.step)
    excited &= np.abs(Y_mean) > 0.0
    U, Y, frequency = U[:, excited], Y[:, excited], frequency[excited]
    H = Y_mean[excited] / U_mean[excited]
    S_vv = (np.abs(Y - H * U) ** 2).sum(axis=0) / (used - 1)
    noise = _smooth(S_vv / np.abs(Y_mean[excited]) ** 2, used)
    lines = Lines(
        frequency_hz=frequency,
        values=signals.undo(frequency, H),
        coherence=1.0 / (1.0 + noise),
        averages=float(used),
        resolution_hz=0.0,
    )
    return PeriodicEstimate(
        lines=lines, period=period * signals.step, periods=used, left_out=left_out
    )


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


def _is_unsettled(U: ComplexArray, Y: ComplexArray) -> bool:
    def off(Z: ComplexArray) -> Array:
        steady = Z[1:].mean(axis=0)
        distance: Array = np.linalg.norm(Z[:, 1:] - steady[1:], axis=1)
        return distance

    return any(distance[0] > UNSETTLED * np.median(distance[1:]) for distance in (off(U), off(Y)))


def _smooth(values: Array, periods: int) -> Array:
    """The mean over neighbouring lines, where few periods leave each line's own uncertain."""
    if periods >= FEW_PERIODS or values.size < NEIGHBOURS:
        return values
    padded = np.pad(values, NEIGHBOURS // 2, mode="edge")
    smooth: Array = np.convolve(padded, np.ones(NEIGHBOURS) / NEIGHBOURS, mode="valid")
    return smooth
