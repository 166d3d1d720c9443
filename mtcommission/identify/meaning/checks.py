"""Whether numbers can be what they are said to be: clipped, swapped, off by a power of ten."""

from __future__ import annotations

import numpy as np

from mtcommission.base.errors import Fault
from mtcommission.base.messages.message import Message
from mtcommission.identify.formats.contents import Lines
from mtcommission.identify.measurement import Array, FrequencyResponse, Sensor

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


def find_clipping(values: Array, name: str) -> Message | None:
    """Return what is wrong with a signal that was cut off at the end of its range.

    A clipped signal runs into its largest value at full slope and stands there; a smooth one
    arrives slowly, and one of two values (PRBS, square) is there half of the time.
    """
    steps = np.abs(np.diff(values))
    moved = steps[steps > 0.0]
    if not moved.size:
        return None
    usual, quantum = float(np.median(moved)), float(moved.min())
    for end in (values.max(), values.min()):
        edges = np.flatnonzero(np.diff((values == end).astype(np.int8), prepend=0, append=0))
        starts, lengths = edges[::2], edges[1::2] - edges[::2]
        long = lengths >= PLATEAU
        share = float(lengths[long].sum()) / values.size
        if long.sum() < FEWEST_PLATEAUS or share > LARGEST_SHARE:
            continue
        entered = starts[long & (starts > 0)]
        arrival = float(np.median(steps[entered - 1])) if entered.size else 0.0
        if arrival > 0.2 * usual and arrival > 2.5 * quantum:
            count = int(long.sum())
            return Message("identify-clipped", name=name, end=float(end), count=count, share=share)
    return None


def find_bad_lines(
    frequency_hz: Array, lines: Lines, *, where: str, coherence: Array | None = None
) -> Fault | None:
    """Return the fault of frequencies that do not rise, are too few, or out of all range.

    Or that of a coherence that leaves 0 to 1.
    """

    def fault(message: Message, row: int = -1) -> Fault:
        line = int(lines[row]) if row >= 0 and lines.size else 0
        return Fault(where=where, line=line, message=message)

    f = frequency_hz
    if f.size < LEAST_LINES:
        kind = "identify-fewer-lines-than-needed"
        return fault(Message(kind, got=f.size, least=LEAST_LINES))
    steps = np.diff(f)
    if (steps <= 0.0).any():
        row = int(np.argmax(steps <= 0.0)) + 1
        kind = "identify-frequency-does-not-rise"
        return fault(Message(kind, before=f[row - 1], after=f[row]), row)
    first, last = float(f[0]), float(f[-1])
    if not LOWEST_HZ <= last <= HIGHEST_HZ or first < 0.0:
        allowed = {"least": LOWEST_HZ, "most": HIGHEST_HZ}
        return fault(Message("identify-frequency-out-of-range", first=first, last=last, **allowed))
    if coherence is not None:
        out = (coherence < -SLACK) | (coherence > 1.0 + SLACK)
        if out.any():
            row = int(np.argmax(out))
            return fault(Message("identify-coherence-out-of-range", got=float(coherence[row])), row)
    return None


def find_rising(response: FrequencyResponse) -> Message | None:
    """Return what is wrong with a response per force that rises like no mechanics do.

    The position per force falls with frequency or stays; one that rises is the reciprocal
    (columns swapped), or a derivative more than was said.
    """
    f, size = response.frequency_hz, np.abs(response.values)
    good = (f > 0.0) & (size > 0.0)
    if good.sum() < LEAST_LINES:
        return Message("identify-all-zero")
    decades = np.log10(f[good])
    if decades[-1] - decades[0] < LEAST_DECADES:
        return None
    # Evenly over the decades: on a linear grid the high lines would outvote the low ones.
    grid = np.linspace(decades[0], decades[-1], 200)
    course = np.interp(grid, decades, np.log10(size[good])) - response.output.derivative * grid
    slope = float(np.polyfit(grid, course, 1)[0])
    most = STEEPEST_HELD if response.sensor is Sensor.TCP else STEEPEST
    return Message("identify-rising", slope=slope) if slope > most else None


def find_unit_slip(position: Array, velocity: Array, step: float, *, name: str) -> Message | None:
    """Return what is wrong with a velocity that is not the position's rate; or acceleration so."""
    rate = np.diff(position) / step
    mean = 0.5 * (velocity[1:] + velocity[:-1])
    width = min(9, rate.size)
    rate, mean = (np.convolve(one, np.ones(width) / width, "valid") for one in (rate, mean))
    size = float(np.linalg.norm(rate) * np.linalg.norm(mean))
    if size == 0.0 or abs(float(rate @ mean)) < 0.9 * size:
        return None
    ratio = float(np.linalg.norm(mean) / np.linalg.norm(rate))
    return None if 0.7 < ratio < 1.4 else Message("identify-unit-slip", name=name, ratio=ratio)
