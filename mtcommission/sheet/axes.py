"""Axes of a printed plot: from values to places on paper, and where the ticks are."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, log10

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TICKS = 6
"""Steps on an axis, at most."""

DECADES = 30.0
"""Ratio of the ends of a logarithmic axis below which ticks stand inside the decades, too."""

INSIDE = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
"""Where they stand then, in each decade."""

FEWEST = 3
"""Ticks inside the decades that are too few to read a value by."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One axis of a plot.

    Parameters
    ----------
    low, high
        Values at its ends; low < high, both above 0 on a logarithmic axis.
    begin, end
        Places of the ends [pt].
    is_log
        Whether it is logarithmic.
    """

    low: float
    high: float
    begin: float
    end: float
    is_log: bool = False

    def at(self, values: Array | float) -> Array:
        """Return the places of values [pt].

        Examples
        --------
        >>> float(Axis(low=0.0, high=2.0, begin=10.0, end=20.0).at(1.0))
        15.0
        >>> float(Axis(low=1.0, high=100.0, begin=0.0, end=20.0, is_log=True).at(10.0))
        10.0
        """
        low, high, x = self.low, self.high, np.asarray(values, dtype=np.float64)
        if self.is_log:
            low, high, x = np.log(low), np.log(high), np.log(x)
        return np.asarray(self.begin + (x - low) / (high - low) * (self.end - self.begin))

    def ticks(self, *, most: int = TICKS) -> list[float]:
        """Return values for the ticks, about ``most`` at most.

        Examples
        --------
        >>> Axis(low=-0.3, high=10.4, begin=0.0, end=1.0).ticks()
        [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
        >>> Axis(low=0.1, high=100.0, begin=0.0, end=1.0, is_log=True).ticks()
        [0.1, 1.0, 10.0, 100.0]
        """
        if self.is_log:
            inside = INSIDE if self.high < DECADES * self.low else (1.0,)
            powers = range(floor(log10(self.low)), ceil(log10(self.high)) + 1)
            found = [part * 10.0**power for power in powers for part in inside]
            # Written with powers of ten, 0.1 may come out as 0.1000000001.
            found = [float(f"{value:.3g}") for value in found]
            found = [value for value in found if self.low <= value <= self.high]
            # Within less than half a decade even steps are more, and rounder, than these.
            if len(found) > (FEWEST if self.high < DECADES * self.low else 1):
                return found
        return _even_ticks(self.low, self.high, most)


def span(parts: list[Array], *, is_log: bool, room: float = 0.06) -> tuple[float, float]:
    """Return the ends of an axis on which all values are seen.

    Parameters
    ----------
    parts
        Values, each of shape (n,); those that are not finite do not count.
    is_log
        Whether the axis is logarithmic; then all values are above 0.
    room
        Space beyond the values, as a share of what they span.

    Examples
    --------
    >>> span([np.array([0.0, 10.0])], is_log=False, room=0.1)
    (-1.0, 11.0)
    >>> span([np.array([3.0])], is_log=False)
    (0.0, 6.0)
    """
    values = np.concatenate([np.ravel(part) for part in parts]) if parts else np.zeros(0)
    values = values[np.isfinite(values)]
    if not values.size:
        return (1.0, 10.0) if is_log else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    if is_log:
        factor = max((high / low) ** room, 1.05)
        return low / factor, high * factor
    margin = room * (high - low) or abs(high) or 1.0
    return low - margin, high + margin


def _even_ticks(low: float, high: float, most: int) -> list[float]:
    rough = (high - low) / most
    size = 10.0 ** floor(log10(rough))
    step = next(part * size for part in (1.0, 2.0, 5.0, 10.0) if part * size >= rough)
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [i * step for i in range(first, last + 1)]
