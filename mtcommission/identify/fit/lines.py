"""What the fit sees of a frequency response: lines in a band, with their standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.measurement import FrequencyResponse

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

ERROR_FLOOR = 3e-3
"""Least relative standard error of a line: no sensor and no amplifier is better (empirical)."""
UNKNOWN_ERROR = 3e-2
"""Relative standard error where the file has no coherence; only its course over the lines counts,
its size comes from the misfit."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lines:
    """A response as the fit weighs it."""

    frequency_hz: Array  # Shape (n,) [Hz]
    values: ComplexArray  # Shape (n,), complex [SI of output per input]
    error: Array  # Standard error of real and of imaginary part, shape (n,) [as values]
    derivative: int  # Power of s by which the output differs from a position

    @property
    def s(self) -> ComplexArray:
        """Laplace variable of each line [rad/s]."""
        found: ComplexArray = 2j * np.pi * self.frequency_hz.astype(np.complex128)
        return found

    @property
    def size(self) -> int:
        """Number of lines."""
        return int(self.frequency_hz.size)

    def keep_first(self, count: int) -> Lines:
        """Return the lowest lines."""
        return Lines(
            frequency_hz=self.frequency_hz[:count],
            values=self.values[:count],
            error=self.error[:count],
            derivative=self.derivative,
        )

    def weigh(self, error: Array) -> Lines:
        """Return the lines with other standard errors."""
        return replace(self, error=error)


def relative_error(response: FrequencyResponse) -> Array:
    """Return the standard error of real and imaginary part by |H|, shape (n_lines,).

    From coherence and averages; with coherence alone its course is kept; never below the floor.
    """
    n = response.frequency_hz.size
    if response.coherence is None:
        return np.full(n, UNKNOWN_ERROR)
    gamma2 = np.clip(response.coherence, 1e-4, 1.0)
    averages = response.averages or 1.0
    return np.hypot(np.sqrt((1.0 - gamma2) / (2.0 * averages * gamma2)), ERROR_FLOOR)


def share_frequencies(responses: Sequence[Lines]) -> list[Lines]:
    """Return the responses, those with equal frequencies with one array of them.

    So that what depends on frequencies alone is computed once.
    """
    kept: list[Array] = []
    found = []
    for lines in responses:
        f = lines.frequency_hz
        same = next((one for one in kept if np.array_equal(one, f)), f)
        if same is f:
            kept.append(f)
        found.append(replace(lines, frequency_hz=same))
    return found


def neighbours(values: Array, count: int) -> Array:
    """Return each value among an odd number of neighbours, mirrored at the ends, (n, count)."""
    padded = np.pad(values, count // 2, mode="symmetric")
    found: Array = np.lib.stride_tricks.sliding_window_view(padded, count)
    return found


MOST_LINES = 6000
"""More are joined where they lie closer than any mode is wide."""
CLOSE = 1e-3
"""Relative width of the groups in which they are joined: a third of a mode of ζ = 0.3 %."""


def see(response: FrequencyResponse, chosen: NDArray[np.bool_]) -> Lines:
    """Return some lines of a response, weighed by its coherence."""
    lines = Lines(
        frequency_hz=response.frequency_hz[chosen],
        values=response.values[chosen],
        error=(relative_error(response) * np.abs(response.values))[chosen],
        derivative=response.output.derivative,
    )
    return lines if lines.size <= MOST_LINES else _join(lines)


def _join(lines: Lines) -> Lines:
    """Weighed means of neighbours within groups of a thousandth of their frequency."""
    group = np.floor(np.log(lines.frequency_hz) / CLOSE)
    _, place = np.unique(group, return_inverse=True)
    weight = 1.0 / np.maximum(lines.error, 1e-300) ** 2
    total = np.bincount(place, weight)

    def mean(values: Array) -> Array:
        joined: Array = np.bincount(place, weight * values) / total
        return joined

    return Lines(
        frequency_hz=mean(lines.frequency_hz),
        values=mean(lines.values.real) + 1j * mean(lines.values.imag),
        error=1.0 / np.sqrt(total),
        derivative=lines.derivative,
    )
