"""Filters that a control puts behind its setpoint generator: averages, shapers, taps.

Each is a short kernel, so the filtered setpoint ends with it: a moving average adds its length,
impulses the delay of the last one. They act on every size of move alike, which limits of
acceleration and jerk do not. What rings on without end (second order, band-stop) is none of them:
behind it a setpoint has no end, so neither a settling time nor a proof over every size.
"""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.control_kinds.kind import MOVING_AVERAGE
from mtcommission.machine.shapers import Impulses, shape


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointFilter:
    """One filter behind the setpoint generator."""

    kind: str  # ``"moving_average"``, ``"two_moving_averages"``, ``"fir"`` or one of ``SHAPERS``
    time: float = 0.0  # length of the average [s]; 0: there is none
    second_time: float = 0.0  # length of the second average [s]; 0: there is none
    frequency_hz: float = 0.0  # what a shaper is designed for [Hz]
    damping_ratio: float = 0.0  # likewise [-]
    taps: tuple[float, ...] = ()  # weights of a finite impulse response, whose sum is 1 [-] ...
    spacing: float = 0.0  # ... and the time between them [s]

    @property
    def averages(self) -> tuple[float, ...]:
        """Lengths of the moving averages that follow each other [s]."""
        return tuple(time for time in (self.time, self.second_time) if time > 0.0)

    @property
    def impulses(self) -> Impulses:
        """The copies that shaper or taps send; a single one for averages."""
        if self.taps:
            delays = tuple(i * self.spacing for i in range(len(self.taps)))
            return Impulses(delays=delays, shares=self.taps)
        if not self.frequency_hz:
            return Impulses()
        return shape(self.kind, frequency_hz=self.frequency_hz, damping_ratio=self.damping_ratio)

    @property
    def duration(self) -> float:
        """By how much it lengthens every setpoint [s]."""
        return sum(self.averages) + self.impulses.delays[-1]


def moving_average(time: float) -> SetpointFilter | None:
    """Return a moving average, or None for no time at all.

    Examples
    --------
    >>> moving_average(0.02).duration
    0.02
    >>> moving_average(0.0) is None
    True
    """
    return SetpointFilter(kind=MOVING_AVERAGE, time=time) if time > 0.0 else None
