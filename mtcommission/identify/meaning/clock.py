"""Even clocks from those that files have."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from mtcommission.errors import Fault
from mtcommission.identify.formats.contents import Lines, TimeContents
from mtcommission.identify.measurement import Array
from mtcommission.messages.message import Message

LEAST_SAMPLES = 64
ROUNDING = 0.02
"""Spread of the steps that comes from times printed with few digits, as share of the step."""

JITTER = 0.5
"""Spread of the steps up to which values may be interpolated; beyond it samples are missing."""

SHORTEST_STEP, LONGEST_STEP = 2e-6, 0.05
"""Other steps are no sampling of an axis but a wrong unit [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EvenClock:
    """Times at which all signals are wanted."""

    step: float  # [s]
    # times, even: Clock of the file and the even one, both None where they are the same.
    times: Array | None = None
    even: Array | None = None
    remark: Message | None = None  # What was done, if anything

    def sample(self, values: Array) -> Array:
        """Return a signal at the even times, shape (n,)."""
        if self.times is None or self.even is None:
            return values
        sampled: Array = CubicSpline(self.times, values)(self.even)
        return sampled


def even_clock(contents: TimeContents, sample_time: float, *, where: str) -> EvenClock | Fault:
    """Return the even clock of a record, or what is wrong with its own."""
    size = contents.columns[0].values.size if contents.columns else 0
    if size < LEAST_SAMPLES:
        return Fault(
            where=where, message=Message("identify-too-few-samples", got=size, least=LEAST_SAMPLES)
        )
    if contents.clock is None:
        step = contents.sample_time or sample_time
        if step <= 0.0:
            return Fault(where=where, message=Message("identify-no-sample-time"))
        return _in_range(EvenClock(step=step), where=where)
    return _of_times(contents.clock, contents.lines, where=where)


def _in_range(clock: EvenClock, *, where: str) -> EvenClock | Fault:
    if SHORTEST_STEP <= clock.step <= LONGEST_STEP:
        return clock
    return Fault(where=where, message=Message("identify-step-out-of-range", step=clock.step))


def _of_times(clock: Array, lines: Lines, *, where: str) -> EvenClock | Fault:
    steps = np.diff(clock)
    at = int(np.argmax(steps <= 0.0))
    if steps[at] <= 0.0:
        message = Message("identify-time-does-not-rise", before=clock[at], after=clock[at + 1])
        return Fault(where=where, line=_line(lines, at + 1), message=message)
    step = float(clock[-1] - clock[0]) / steps.size
    found = _in_range(EvenClock(step=step), where=where)
    if isinstance(found, Fault):
        return found
    middle = float(np.median(steps))
    worst = int(np.argmax(np.abs(steps - middle)))
    spread = abs(float(steps[worst]) - middle) / middle
    even = clock[0] + step * np.arange(clock.size)
    off = float(np.abs(clock - even).max()) / step
    if spread <= ROUNDING or off <= ROUNDING:
        return found
    if spread > JITTER:
        message = Message(
            "identify-uneven", usual=middle, got=float(steps[worst]), at=float(clock[worst])
        )
        return Fault(where=where, line=_line(lines, worst + 1), message=message)
    remark = Message("identify-resampled", spread=spread, step=step)
    return EvenClock(step=step, times=clock, even=even, remark=remark)


def _line(lines: Lines, row: int) -> int:
    return int(lines[row]) if lines.size else 0
