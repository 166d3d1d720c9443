"""What a requirement is: everything that judge, search, studies and sheet ask of one.

They go through ``requirements_of`` a machine and know none by name: a new one is an object in a
file of its own, and a line in ``REGISTER``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.loop.disturbance import EncoderNoise
from mtcommission.loop.poles import LoopPoles
from mtcommission.loop.respond import Signal
from mtcommission.loop.simulate import LoopResponse
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.requirements import Reserve
from mtcommission.setpoint.setpoint import JerkSteps

Array = NDArray[np.float64]


class Yields(Enum):
    """How far a requirement gives way where no limits meet all of them."""

    FIRST = auto()
    """Limits are named that miss it as little as possible: how far the tool is off."""

    MINIMISED = auto()
    """The search makes it as small as the others allow: the time."""

    IF_ASKED = auto()
    """Limits that miss it are never sought, but what could be met instead is said."""

    NEVER = auto()
    """More is not to be had: what the drive can do."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Swing:
    """The largest magnitude of a signal of the linear loop.

    ``is_after``: from t_e + τ on only. Such a signal comes to rest with the setpoint; what is left
    of it is in proportion to the jerk, all times of the setpoint kept.
    """

    signal: Signal
    is_after: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mean:
    """A mean over move and dwell.

    ``estimate``: of the rigid axis, of each setpoint, shape (n_setpoints,) [own unit]. ``exact``:
    of one setpoint, from so many position cycles at most, shape (n_corners,) [own unit].
    """

    estimate: Callable[[Machine, Move, JerkSteps], Array]
    exact: Callable[[Machine, LoopPoles, Move, JerkSteps, int], Array]


@dataclass(frozen=True, slots=True)
class Settling:
    """When the tool stays in the band of the definitions: sought as soon as can be."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """What is bounded in every corner, by its key alone equal to another.

    A plant is the nominal one: units and rows are the same on all of them.
    """

    key: str  # name in records, e.g. "set force" or "peak v_phi"
    message: Message = field(compare=False)  # its text in every language
    unit: Callable[[Machine, Plant], str] = field(compare=False)  # SI unit of value and bound
    bound: Callable[[Machine], float] = field(compare=False)  # inf: not asked for
    with_bound: Callable[[Machine, float], Machine] = field(compare=False)  # the same else
    share: Callable[[Reserve], float] = field(compare=False)  # that recommendations may use [-]
    value: Callable[[LoopResponse, Plant], float] = field(compare=False)  # inf: not settled
    by_poles: Callable[[Plant], Swing | Mean | Settling] = field(compare=False)
    """What of the linear loop it bounds: so many setpoints are looked at at once."""
    yields: Yields = field(compare=False)
    judged: Callable[[Machine, Move], Move] = field(default=lambda _, move: move, compare=False)
    """The move at which it must hold, where that is a slower one."""
    with_noise: Callable[[Array, EncoderNoise], Array] = field(
        default=lambda value, _: value, compare=False
    )
    """Values, with what the steps of the encoder add to them."""
    at_most: Callable[[Machine, float], float] = field(default=lambda *_: inf, compare=False)
    """What limits with an acceleration [m/s²] are not expected to exceed: where that is below the
    bound the search does not look, and the judge decides; inf: only a response tells."""
    whole_move: tuple[str, str] = field(default=("", ""), compare=False)
    """Where it bounds the tool while it moves: keys that ask for it, and up to which velocity."""
    rests_on: tuple[str, str] = field(default=("", ""), compare=False)
    """Beginning and end of the keys of data that decide it where nobody stated them; "": none."""

    def noisy(self, values: Array, noises: Sequence[EncoderNoise]) -> Array:
        """Return values in every corner with the noise of each, shape (..., n_corners)."""
        columns = [self.with_noise(values[..., i], noise) for i, noise in enumerate(noises)]
        return np.stack(columns, axis=-1)
