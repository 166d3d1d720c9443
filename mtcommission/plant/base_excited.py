"""Modes with the motor held, excited by its acceleration: an axis whose motor simply follows.

    q'' + 2 ζ ω q' + ω² q = -x_ref'',   tool = x_ref + Σ tcp_gain q

That is the modal plant with a mass of 1 and the acceleration of the motor for its force. The
frequencies are those with the motor held, which is what an accelerometer shows while it stands.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.keys import Misfit, Table, keyed
from mtcommission.machine.mechanics import (
    FlexibleMode,
    HeldMode,
    ModeStates,
    find_mode_faults,
    renew_modes,
    scale_modes,
)
from mtcommission.machine.readers import Array as ArrayOf
from mtcommission.messages.message import Message
from mtcommission.plant.modal import MOST_MODES, Modal
from mtcommission.units.axis_units import AxisUnits
from mtcommission.units.quantities import Dimension

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseExcited:
    """Modes on a motor that follows its setpoint; their poles are distinct.

    Examples
    --------
    >>> from math import pi
    >>> head = HeldMode(name="belt", natural_frequency=2 * pi * 45, damping_ratio=0.05)
    >>> driven = BaseExcited(held_modes=(head,)).modes
    >>> [(mode.tcp_gain, round(mode.frequency_hz)) for mode in driven]
    [(-1.0, 45)]
    """

    kind: ClassVar = "modal"
    position: ClassVar = "x"
    velocity: ClassVar = "v"
    moving_mass: ClassVar = 1.0

    held_modes: tuple[HeldMode, ...] = keyed(
        ArrayOf(Table(HeldMode), 1, MOST_MODES),
        "One to eight modes, with the motor held.",
        key="modes",
    )

    @property
    def modes(self) -> tuple[FlexibleMode, ...]:
        """The modes as driven by the acceleration of the motor."""
        return tuple(mode.driven for mode in self.held_modes)

    def mode_states(self) -> tuple[ModeStates, ...]:
        """Return where each mode stands in the plant: q with its own sign."""
        return tuple(ModeStates(f"q_{one.name}", f"v_{one.name}", -1.0) for one in self.held_modes)

    @classmethod
    def states(cls, modes: Sequence[str], axis: AxisUnits) -> dict[str, Dimension]:
        """Return the plant's states in order and what they measure; F is the acceleration."""
        return Modal.states(modes, axis)

    def mode_key(self, index: int) -> str:
        """Return the key of a mode in the profile."""
        return f"plant.modes[{index + 1}]"

    def vary(
        self, *, payload: float, payload_radius: float, frequency: float, damping: float
    ) -> Self:
        """Return the modes in a corner; the motor follows whatever it carries."""
        modes = scale_modes(self.held_modes, frequency=frequency, damping=damping)
        return replace(self, held_modes=modes)

    def inertia_ratio(self, mode: str, payload: Array, payload_radius: float) -> Array:
        """Return 1: no payload is stated here."""
        return np.ones_like(payload)

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        """Return these frequencies and damping ratios; a motor that follows has no mass."""
        return replace(self, held_modes=renew_modes(self.held_modes, modes))

    def still_tool(self, modes: Collection[str]) -> None:
        """Return None: modes with the motor held are seen at the tool only."""

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> list[Misfit]:
        """Return key below [plant] and message of what does not fit together."""
        return find_mode_faults(self.modes)

    def assumptions(self) -> tuple[Message, ...]:
        """Return what is assumed of the motor."""
        return (Message("motor-follows-assumed"),)
