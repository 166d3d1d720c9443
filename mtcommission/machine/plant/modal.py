"""A rigid mass with flexible modes, as read from a Bode plot."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from mtcommission.base.units.axis_units import AxisUnits
from mtcommission.base.units.quantities import Dimension
from mtcommission.machine.keys import Misfit, Table, keyed
from mtcommission.machine.mechanics import (
    FlexibleMode,
    Mechanics,
    ModeStates,
    find_mode_faults,
    renew_modes,
    scale_modes,
)
from mtcommission.machine.ranges import MASSES
from mtcommission.machine.readers import Array

MOST_MODES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Modal(Mechanics):
    """A rigid mass [kg] with flexible modes of distinct poles, as read from a Bode plot."""

    kind: ClassVar = "modal"
    position: ClassVar = "x"
    velocity: ClassVar = "v"

    moving_mass: float = keyed(MASSES, "Total rigid mass.", "800 kg")
    modes: tuple[FlexibleMode, ...] = keyed(
        Array(Table(FlexibleMode), 1, MOST_MODES), "One to eight modes."
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

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        """Return the plant with this mass [kg], frequencies and damping ratios."""
        return replace(self, moving_mass=mass, modes=renew_modes(self.modes, modes))

    def still_tool(self, modes: Collection[str]) -> Self | None:
        """Return the plant with a tool that does not move in these modes."""
        return replace(
            self,
            modes=tuple(
                replace(mode, tcp_gain=0.0) if mode.name in modes else mode for mode in self.modes
            ),
        )

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> list[Misfit]:
        """Return key below [plant] and message of what does not fit together."""
        return find_mode_faults(self.modes)
