"""A rigid mass with flexible modes, as read from a Bode plot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.keys import keyed, keyed_array
from mtcommission.machine.mechanics import (
    FlexibleMode,
    Misfit,
    ModeStates,
    find_mode_faults,
    scale_modes,
)
from mtcommission.machine.ranges import MASSES
from mtcommission.messages.message import Message
from mtcommission.units.axis_units import AxisUnits
from mtcommission.units.quantities import Dimension

Array = NDArray[np.float64]

MOST_MODES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Modal:
    """A rigid mass [kg] with flexible modes of distinct poles, as read from a Bode plot."""

    kind: ClassVar = "modal"
    position: ClassVar = "x"
    velocity: ClassVar = "v"

    moving_mass: float = keyed(MASSES, "Total rigid mass.", "800 kg")
    modes: tuple[FlexibleMode, ...] = keyed_array(
        FlexibleMode, "One to eight modes.", most=MOST_MODES
    )

    def mode_states(self) -> tuple[ModeStates, ...]:
        """Return where each mode stands in the plant."""
        return tuple(ModeStates(f"q_{mode.name}", f"v_{mode.name}") for mode in self.modes)

    @classmethod
    def states(cls, modes: Sequence[str], axis: AxisUnits) -> dict[str, Dimension]:
        """Return the plant's states in order and what they measure, from the modes' names."""
        found = {"x": axis.length, "v": axis.velocity}
        for name in modes:
            found |= {f"q_{name}": axis.modal_deflection, f"v_{name}": axis.modal_rate}
        return {**found, "F": axis.force}

    def mode_key(self, index: int) -> str:
        """Return the key of a mode in the profile."""
        return f"plant.modes[{index + 1}]"

    def vary(
        self, *, payload: float, payload_radius: float, frequency: float, damping: float
    ) -> Self:
        """Return the plant in a corner; a payload turns nothing here."""
        modes = scale_modes(self.modes, frequency=frequency, damping=damping)
        return replace(self, moving_mass=self.moving_mass + payload, modes=modes)

    def inertia_ratio(self, mode: str, payload: Array, payload_radius: float) -> Array:
        """Return 1: a payload leaves the modes as they are."""
        return np.ones_like(payload)

    def find_faults(self) -> list[Misfit]:
        """Return key below [plant] and message of what does not fit together."""
        return find_mode_faults(self.modes)

    def assumptions(self) -> tuple[Message, ...]:
        """Return nothing: all that is used was stated."""
        return ()
