"""What was recorded during a move, in SI."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from math import ceil

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.message import Message

Array = NDArray[np.float64]


class Role(StrEnum):
    """What a column of a trace holds; the value is our name of it."""

    SETPOINT = "x_ref"
    SETPOINT_VELOCITY = "v_ref"
    ENCODER = "encoder"
    VELOCITY = "velocity"
    FOLLOWING_ERROR = "following_error"
    TOOL = "tcp"
    ACCELERATION = "acceleration"
    FORCE = "force"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Channel:
    """One column, evenly sampled."""

    # role, name: What it holds, and what the file calls it.
    role: Role
    name: str
    # start, step: Time of the first sample and step of the clock [s].
    start: float
    step: float
    values: Array  # Shape (n,) [SI]
    error: float = 0.0  # What interpolation to an even clock may have added [SI]

    @property
    def t(self) -> Array:
        """Times of the samples, shape (n,) [s]."""
        return self.start + self.step * np.arange(self.values.size, dtype=np.float64)

    def between(self, begin: float, end: float) -> tuple[Array, Array]:
        """Return times and values from a time up to another one."""
        first = int(np.clip(np.ceil((begin - self.start) / self.step - 1e-6), 0, self.values.size))
        last = int(
            np.clip(np.floor((end - self.start) / self.step + 1e-6) + 1, 0, self.values.size)
        )
        return self.t[first:last], self.values[first:last]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """A recorded file."""

    # file, sha256: Name as it was given, and hash of the bytes, 64 hexadecimal digits.
    file: str
    sha256: str
    # Of each role at most one; a setpoint, and something that was measured.
    channels: tuple[Channel, ...]
    gaps: tuple[tuple[float, float], ...] = ()  # Begin and end of stretches without samples [s]
    # Whether the setpoint is the one that is compared with the position, recorded behind τ.
    is_delayed: bool = False
    remarks: tuple[Message, ...] = ()  # What was done to it, what was assumed and what is doubtful

    def find(self, role: Role) -> Channel | None:
        """Return the channel of a role; None if it was not recorded."""
        return next((one for one in self.channels if one.role is role), None)

    def before(self, instant: float) -> Trace:
        """Return the trace up to an instant."""
        channels = tuple(
            replace(one, values=one.values[: max(ceil((instant - one.start) / one.step), 1)])
            for one in self.channels
        )
        return replace(self, channels=channels)

    @property
    def setpoint(self) -> Channel:
        """The setpoint's position."""
        return next(one for one in self.channels if one.role is Role.SETPOINT)


FINEST = 1e-11
"""Share of the range below which a step of the values is rounding."""

WHOLE = 0.05
"""Distance from a whole multiple of the step, as share of it, that rounding may have."""


def resolution(values: Array) -> float:
    """Return the step in which values were written down; 0 where there is none.

    Euclid's algorithm on the differences of neighbouring levels.

    Examples
    --------
    >>> round(resolution(np.array([0.0, 0.002, 0.003, 0.003, 0.007])), 9)
    0.001
    """
    levels = np.unique(values)
    steps = np.diff(levels)
    least = FINEST * float(np.ptp(values))
    steps = np.sort(steps[steps > least])[:2000]
    if not steps.size:
        return 0.0
    grain = float(steps[0])
    while grain > least:
        rest = np.abs(steps - grain * np.rint(steps / grain))
        off = rest[rest > max(WHOLE * grain, least)]
        if not off.size:
            return grain
        # Of the smallest step: the error of what is left grows with the multiples taken off.
        grain = float(off[0])
    return 0.0
