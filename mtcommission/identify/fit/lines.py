"""What the fit sees of a frequency response: lines in a band, with their standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.measurement import Array, ComplexArray, FrequencyResponse

ERROR_FLOOR = 3e-3
"""Least relative standard error of a line: no sensor and no amplifier is better (empirical)."""
UNKNOWN_ERROR = 3e-2
"""Relative standard error where the file has no coherence; only its course over the lines counts,
its size comes from the misfit."""
MOST_LINES = 6000
"""More are joined where they lie closer than any mode is wide."""
CLOSE = 1e-3
"""Relative width of the groups in which they are joined: a third of a mode of ζ = 0.3 %."""


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
        return np.asarray(2j * np.pi * self.frequency_hz)

    @property
    def size(self) -> int:
        """Number of lines."""
        return int(self.frequency_hz.size)

    def position(self, delay: float = 0.0, lag: float = 0.0) -> ComplexArray:
        """Return the position per input, without a delay and a lag [s]."""
        s = self.s
        return np.asarray(self.values * np.exp(s * delay) * (1.0 + s * lag) / s**self.derivative)

    def weigh(self, error: Array) -> Lines:
        """Return the lines with other standard errors."""
        return replace(self, error=error)


def ends_of(responses: Sequence[Lines]) -> tuple[float, float]:
    """Return the lowest and the highest line of some responses [Hz]."""
    first, last = zip(
        *((one.frequency_hz[0], one.frequency_hz[-1]) for one in responses), strict=True
    )
    return float(min(first)), float(max(last))


def count_values(responses: Sequence[Lines]) -> int:
    """Return how many real numbers some responses hold."""
    return sum(2 * lines.size for lines in responses)


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
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, count))


def spacing_at(frequency_hz: Array, wanted_hz: float) -> float:
    """Return how far the lines about a frequency lie apart [Hz]."""
    at = int(np.clip(np.searchsorted(frequency_hz, wanted_hz), 1, frequency_hz.size - 1))
    return float(frequency_hz[at] - frequency_hz[at - 1])


def see(response: FrequencyResponse, chosen: NDArray[np.bool_]) -> Lines:
    """Return some lines of a response, weighed by its coherence.

    With coherence alone its course counts; no error is below the floor.
    """
    known = response.relative_error
    relative = np.hypot(known, ERROR_FLOOR) if known is not None else UNKNOWN_ERROR
    lines = Lines(
        frequency_hz=response.frequency_hz[chosen],
        values=response.values[chosen],
        error=(relative * np.abs(response.values))[chosen],
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
        return np.asarray(np.bincount(place, weight * values) / total)

    return replace(
        lines,
        frequency_hz=mean(lines.frequency_hz),
        values=mean(lines.values.real) + 1j * mean(lines.values.imag),
        error=1.0 / np.sqrt(total),
    )
