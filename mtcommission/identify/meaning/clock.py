"""Even clocks from those that files have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mtcommission.base.errors import Fault, InputError, Refused
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import TIME, parse_quantity
from mtcommission.identify.formats.contents import Lines, TimeContents, refuse
from mtcommission.identify.formats.heads import CLOCK, SAMPLE_TIME
from mtcommission.identify.measurement import Array

LEAST_SAMPLES = 64
ROUNDING = 0.02
"""Distance from an even clock, as share of the step, that times printed with few digits have."""

GAP = 4.0
"""Steps without a sample from which on something is missing."""

JITTER = 0.5
"""Spread of the steps up to which what nothing is missing from may be interpolated."""

SHORTEST_STEP, LONGEST_STEP = 2e-6, 0.05
"""Other steps are no sampling of an axis but a wrong unit [s]."""

LATEST = 1e12
"""Beyond it a time is a broken number [s]; a clock may count from the year 1601."""

SIGMAS = 3.0
"""Standard errors that the largest error of an interpolation is taken for."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Clock:
    """Times at which samples were taken, and the even ones at which they are wanted."""

    times: Array  # shape (n,) [s]
    step: float  # [s]
    lines: Lines  # of each sample in the file, shape (n,) or empty

    @property
    def even(self) -> Array:
        """Even times, shape (m,) [s]."""
        count = int((self.times[-1] - self.times[0]) / self.step + 1e-6) + 1
        return np.asarray(self.times[0] + self.step * np.arange(count))

    @property
    def is_even(self) -> bool:
        """Whether samples stand at even times but for rounding."""
        even = self.even
        off = np.abs(self.times - even).max() if even.size == self.times.size else np.inf
        return bool(off <= ROUNDING * self.step)

    @property
    def gaps(self) -> list[tuple[float, float]]:
        """Begin and end of stretches without samples [s]."""
        at = np.flatnonzero(np.diff(self.times) > GAP * self.step)
        return [(float(self.times[i]), float(self.times[i + 1])) for i in at]

    @property
    def remarks(self) -> list[Message]:
        """What is done to the signals, if anything."""
        if self.is_even or self.gaps:
            return []
        spread = float(np.abs(np.diff(self.times) / self.step - 1.0).max())
        return [Message("identify-resampled", spread=spread, step=self.step)]

    def sample(self, values: Array) -> tuple[Array, float]:
        """Return a signal at the even times, and the standard error of its interpolation."""
        if self.is_even:
            return values, 0.0
        from scipy.interpolate import CubicSpline  # slow to load, and most clocks are even

        # Every other sample from its neighbours errs more than the sample between them.
        half = CubicSpline(self.times[::2], values[::2])(self.times[1:-1:2])
        error = float(np.abs(values[1:-1:2] - half).max()) / SIGMAS
        return np.asarray(CubicSpline(self.times, values)(self.even)), error

    def require_even(self, *, where: str) -> None:
        """Raise InputError where samples are missing."""
        steps = np.diff(self.times)
        usual = float(np.median(steps))
        worst = int(np.argmax(np.abs(steps - usual)))
        got, at = float(steps[worst]), float(self.times[worst])
        if not self.is_even and abs(got - usual) > JITTER * usual:
            line = _line(self.lines, worst + 1)
            raise refuse(where, "identify-uneven", line=line, usual=usual, got=got, at=at)


def read_clock(contents: TimeContents, said: Mapping[str, str], *, where: str) -> Clock:
    """Return the clock of a record; ``said``: ``--columns``, which may state the sample time."""
    size = contents.columns[0].values.size if contents.columns else 0
    if size < LEAST_SAMPLES:
        raise refuse(where, "identify-too-few-samples", got=size, least=LEAST_SAMPLES)
    if contents.clock is None:
        step = contents.sample_time or _said_step(said)
        if step <= 0.0:
            raise refuse(where, "identify-no-sample-time")
        times: Array = step * np.arange(size, dtype=np.float64)
    else:
        times = _rising(contents.clock, contents.lines, where=where)
        steps = np.diff(times)
        step = float(np.mean(steps[steps <= GAP * np.median(steps)]))
    if not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise refuse(where, "identify-step-out-of-range", step=step)
    return Clock(times=times, step=step, lines=contents.lines)


def _said_step(said: Mapping[str, str]) -> float:
    try:
        return parse_quantity(said[SAMPLE_TIME], TIME) if SAMPLE_TIME in said else 0.0
    except Refused as error:
        fault = Fault(where=f"--columns {SAMPLE_TIME}", message=error.message)
        raise InputError([fault]) from error


def _rising(clock: Array, lines: Lines, *, where: str) -> Array:
    """Times that rise; those printed with too few digits are spread evenly between."""
    if not (np.abs(clock) < LATEST).all():
        raise refuse(where, "identify-series-not-finite", name=CLOCK)
    steps = np.diff(clock)
    if (steps > 0.0).all():
        return clock
    even: Array = np.linspace(clock[0], clock[-1], clock.size)
    grain = float(steps.max())
    if steps.min() < 0.0 or grain == 0.0 or float(np.abs(clock - even).max()) > 1.5 * grain:
        at = int(np.argmax(steps <= 0.0))
        kind, before, after = "identify-time-does-not-rise", clock[at], clock[at + 1]
        raise refuse(where, kind, line=_line(lines, at + 1), before=before, after=after)
    return even


def _line(lines: Lines, row: int) -> int:
    return int(lines[row]) if lines.size else 0
