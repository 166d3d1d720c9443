"""Values that several parts of a record hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from mtcommission.messages.message import Message

Words: TypeAlias = Message | str
"""What the catalogue says, or the user's own words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """A sampled motion for the plots; ``signals`` by name (F_set, then every state and output)."""

    t: list[float]
    signals: dict[str, list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointFilterEntry:
    """A filter of the control in the setpoint.

    Lengths of averages [s], and a shaper's mode [Hz, -]. The filtered setpoint is the sum of
    copies, ``delays`` later [s] and times ``shares`` [-], behind the averages; ``duration`` is by
    how much it lengthens every setpoint [s].
    """

    kind: str
    time: float
    second_time: float
    frequency_hz: float
    damping_ratio: float
    delays: list[float]
    shares: list[float]
    duration: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceFilterEntry:
    """A filter in the set-force path: (s² + 2 ζ ω s + ω²) / (s² + 2 d ω s + ω²), or the low-pass.

    ``natural_frequency`` is ω [rad/s], not a frequency in Hz, ``damping`` ζ and ``width`` d [-].
    """

    kind: str
    natural_frequency: float
    damping: float
    width: float
