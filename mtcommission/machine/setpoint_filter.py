"""Filters that a control puts behind its setpoint generator: averages, shapers, taps.

Each is a short kernel, so the filtered setpoint ends with it: a moving average adds its length,
impulses the delay of the last one. They act on every size of move alike, which limits of
acceleration and jerk do not. What rings on without end (second order, band-stop) is none of them:
behind it a setpoint has no end, so neither a settling time nor a proof over every size.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, pi, sqrt
from typing import NamedTuple

from mtcommission.control_kinds.kind import MOVING_AVERAGE

EI_TOLERANCE = 0.05
"""Vibration that the EI shapers tolerate about their frequency [-] (the usual 5 %)."""


class Impulses(NamedTuple):
    """A sum of delayed copies.

    Parameters
    ----------
    delays
        The first is 0 [s].
    shares
        Their sum is 1 [-].
    """

    delays: tuple[float, ...] = (0.0,)
    shares: tuple[float, ...] = (1.0,)


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointFilter:
    """One filter behind the setpoint generator.

    Parameters
    ----------
    kind
        ``"moving_average"``, ``"two_moving_averages"``, ``"fir"`` or a shaper of ``DESIGNS``.
    time, second_time
        Lengths of the averages [s]; 0 where there is none.
    frequency_hz, damping_ratio
        What a shaper is designed for [Hz, -].
    taps, spacing
        Weights of a finite impulse response, whose sum is 1 [-], and the time between them [s].
    """

    kind: str
    time: float = 0.0
    second_time: float = 0.0
    frequency_hz: float = 0.0
    damping_ratio: float = 0.0
    taps: tuple[float, ...] = ()
    spacing: float = 0.0

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

    @property
    def mean_delay(self) -> float:
        """By how much it delays a slow setpoint [s]: the centre of its kernel."""
        pairs = zip(self.impulses.delays, self.impulses.shares, strict=True)
        return 0.5 * sum(self.averages) + sum(delay * share for delay, share in pairs)


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


def shape(kind: str, *, frequency_hz: float, damping_ratio: float) -> Impulses:
    """Return the impulses of a shaper.

    Parameters
    ----------
    kind
        One of ``DESIGNS``.
    frequency_hz, damping_ratio
        Natural frequency [Hz] and damping ratio [-] of the mode that shall stay at rest.

    Returns
    -------
    Impulses

    Source: Singer & Seering 1990 (ZV, ZVD); Singhose, Seering & Singer 1994 (EI) and 1997 (two and
    three humps); MZV and the correction for damping as Klipper documents them.

    Examples
    --------
    >>> shape("zvd", frequency_hz=50.0, damping_ratio=0.0)
    Impulses(delays=(0.0, 0.01, 0.02), shares=(0.25, 0.5, 0.25))
    """
    root = sqrt(1.0 - damping_ratio**2)
    period = 1.0 / (frequency_hz * root)
    spacing, shares = DESIGNS[kind]
    decay = exp(-2.0 * pi * damping_ratio / root * spacing)  # from one impulse to the next
    weights = [share * decay**i for i, share in enumerate(shares)]
    total = sum(weights)
    return Impulses(
        delays=tuple(i * spacing * period for i in range(len(weights))),
        shares=tuple(weight / total for weight in weights),
    )


def _two_humps() -> tuple[float, ...]:
    V = EI_TOLERANCE
    X = (V**2 * (sqrt(1.0 - V**2) + 1.0)) ** (1.0 / 3.0)
    outer = (3.0 * X**2 + 2.0 * X + 3.0 * V**2) / (16.0 * X)
    return outer, 0.5 - outer, 0.5 - outer, outer


def _three_humps() -> tuple[float, ...]:
    V = EI_TOLERANCE
    outer = (1.0 + 3.0 * V + 2.0 * sqrt(2.0 * V * (1.0 + V))) / 16.0
    inner = 0.25 * (1.0 - V)
    return outer, inner, 1.0 - 2.0 * (outer + inner), inner, outer


_EDGE = 1.0 - 1.0 / sqrt(2.0)
_V = EI_TOLERANCE

DESIGNS: Mapping[str, tuple[float, tuple[float, ...]]] = {
    "zv": (0.5, (0.5, 0.5)),
    "mzv": (0.375, (_EDGE, 1.0 - 2.0 * _EDGE, _EDGE)),
    "zvd": (0.5, (0.25, 0.5, 0.25)),
    "ei": (0.5, (0.25 * (1.0 + _V), 0.5 * (1.0 - _V), 0.25 * (1.0 + _V))),
    "2hump_ei": (0.5, _two_humps()),
    "3hump_ei": (0.5, _three_humps()),
}
"""Spacing of the impulses in periods, and their shares without damping."""
