"""Whether numbers can be what they are said to be: clipped, swapped, off by a power of ten."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import Fault
from mtcommission.identify.formats.contents import Lines
from mtcommission.identify.measurement import Array, ComplexArray
from mtcommission.messages.message import Message

LEAST_LINES = 12
LOWEST_HZ, HIGHEST_HZ = 5.0, 50_000.0
"""The last line of a response lies between, or its unit is wrong."""
SLACK = 1e-3
"""How far a coherence may leave 0 to 1 by rounding."""

PLATEAU = 4
"""Equal samples at the end of the range that no smooth signal shows."""

FEWEST_PLATEAUS = 3
LARGEST_SHARE = 0.35
"""A signal that stands at its ends more often switches between two values on purpose."""

STEEPEST = -0.7
"""Slope of the position in decades per decade of frequency that an axis with its mass stays below:
a free mass falls by two, modes bend that by less than one on the whole."""

LEAST_DECADES = 0.8
"""Band below which a resonance alone may make a response rise."""

STEEPEST_HELD = 1.0
"""The same of a structure that is held, seen at the tool: it stays level, then falls."""


def find_clipping(values: Array, name: str, *, where: str) -> Fault | None:
    """Return the fault of a signal that was cut off at the end of its range.

    A clipped signal runs into its largest value at full slope and stands there; a smooth one
    arrives slowly, and one of two values (PRBS, square) is there half of the time.
    """
    steps = np.abs(np.diff(values))
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    if usual == 0.0:
        return None
    for end in (values.max(), values.min()):
        at_end = values == end
        starts, lengths = _runs(at_end)
        long = lengths >= PLATEAU
        share = float(lengths[long].sum()) / values.size
        if long.sum() < FEWEST_PLATEAUS or share > LARGEST_SHARE:
            continue
        entered = starts[long]
        entered = entered[entered > 0]
        quantum = float(steps[steps > 0.0].min())
        arrival = float(np.median(steps[entered - 1])) if entered.size else 0.0
        if arrival > 0.2 * usual and arrival > 2.5 * quantum:
            message = Message(
                "identify-clipped", name=name, end=float(end), count=int(long.sum()), share=share
            )
            return Fault(where=where, message=message)
    return None


def _runs(flags: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return edges[::2], edges[1::2] - edges[::2]


def find_bad_frequency(frequency_hz: Array, lines: Lines, *, where: str) -> Fault | None:
    """Return the fault of frequencies that do not rise, are too few, or out of all range."""
    if frequency_hz.size < LEAST_LINES:
        message = Message(
            "identify-fewer-lines-than-needed", got=frequency_hz.size, least=LEAST_LINES
        )
        return Fault(where=where, message=message)
    steps = np.diff(frequency_hz)
    if (steps <= 0.0).any():
        row = int(np.argmax(steps <= 0.0)) + 1
        message = Message(
            "identify-frequency-does-not-rise",
            before=frequency_hz[row - 1],
            after=frequency_hz[row],
        )
        return Fault(where=where, line=int(lines[row]) if lines.size else 0, message=message)
    first, last = float(frequency_hz[0]), float(frequency_hz[-1])
    if not LOWEST_HZ <= last <= HIGHEST_HZ or first < 0.0:
        kind, most = "identify-frequency-out-of-range", HIGHEST_HZ
        message = Message(kind, first=first, last=last, least=LOWEST_HZ, most=most)
        return Fault(where=where, message=message)
    return None


def find_bad_coherence(coherence: Array, lines: Lines, *, where: str) -> Fault | None:
    """Return the fault of a coherence that leaves 0 to 1."""
    out = (coherence < -SLACK) | (coherence > 1.0 + SLACK)
    if not out.any():
        return None
    row = int(np.argmax(out))
    message = Message("identify-coherence-out-of-range", got=float(coherence[row]))
    return Fault(where=where, line=int(lines[row]) if lines.size else 0, message=message)


def find_rising(
    frequency_hz: Array, values: ComplexArray, derivative: int, *, is_held: bool, where: str
) -> Fault | None:
    """Return the fault of a response per force that rises like no mechanics do.

    The position per force falls with frequency or stays; one that rises is the reciprocal
    (columns swapped), or a derivative more than was said.
    """
    good = (frequency_hz > 0.0) & (np.abs(values) > 0.0)
    if good.sum() < LEAST_LINES:
        return Fault(where=where, message=Message("identify-all-zero"))
    decades = np.log10(frequency_hz[good])
    if decades[-1] - decades[0] < LEAST_DECADES:
        return None
    # Evenly over the decades: on a linear grid the high lines would outvote the low ones.
    grid = np.linspace(decades[0], decades[-1], 200)
    size = np.interp(grid, decades, np.log10(np.abs(values[good]))) - derivative * grid
    slope = float(np.polyfit(grid, size, 1)[0])
    if slope <= (STEEPEST_HELD if is_held else STEEPEST):
        return None
    return Fault(where=where, message=Message("identify-rising", slope=slope))


def find_unit_slip(
    position: Array, velocity: Array, step: float, *, name: str, where: str
) -> Fault | None:
    """Return the fault of a velocity that is not the position's rate, or so for acceleration."""
    rate = np.diff(position) / step
    mean = 0.5 * (velocity[1:] + velocity[:-1])
    width = min(9, rate.size)
    smooth = np.ones(width) / width
    rate, mean = np.convolve(rate, smooth, "valid"), np.convolve(mean, smooth, "valid")
    size = float(np.linalg.norm(rate) * np.linalg.norm(mean))
    if size == 0.0 or abs(float(rate @ mean)) < 0.9 * size:
        return None
    ratio = float(np.linalg.norm(mean) / np.linalg.norm(rate))
    if 0.7 < ratio < 1.4:
        return None
    return Fault(where=where, message=Message("identify-unit-slip", name=name, ratio=ratio))
