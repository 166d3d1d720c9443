"""A rigid mass with flexible modes, as read from a Bode plot; and modes with the motor held.

Below a motor that follows its setpoint they are excited by its acceleration:

    q'' + 2 ζ ω q' + ω² q = -x_ref'',   tool = x_ref + Σ tcp_gain q

That is the modal plant with a mass of 1 and the acceleration of the motor for its force. The
frequencies are those with the motor held, which is what an accelerometer shows while it stands.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits, Dimension
from mtcommission.machine.keys import Misfit, Table, keyed
from mtcommission.machine.mechanics import (
    FlexibleMode,
    HeldMode,
    Mechanics,
    ModeStates,
    find_equal_poles,
)
from mtcommission.machine.readers import MASSES, Array

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
        modes = tuple(
            replace(
                mode,
                natural_frequency=mode.natural_frequency * frequency,
                damping_ratio=mode.damping_ratio * damping,
            )
            for mode in self.modes
        )
        return replace(self, moving_mass=self.moving_mass + payload, modes=modes)

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        """Return the plant with this mass [kg], frequencies and damping ratios."""
        renewed = tuple(
            replace(mode, natural_frequency=new.natural_frequency, damping_ratio=new.damping_ratio)
            for mode, new in zip(self.modes, modes, strict=True)
        )
        return replace(self, moving_mass=mass, modes=renewed)

    def still_tool(self, modes: Collection[str]) -> Self | None:
        """Return the plant with a tool that does not move in these modes."""
        still = (replace(mode, tcp_gain=0.0) if mode.name in modes else mode for mode in self.modes)
        return replace(self, modes=tuple(still))

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> list[Misfit]:
        """Return key below [plant] and message of names used twice and of equal poles."""
        names = [mode.name for mode in self.modes]
        faults = [
            (f"modes.{place}.name", Message("named-twice", name=name))
            for place, name in enumerate(names)
            if name in names[:place]
        ]
        return faults + [
            (f"modes.{place}.frequency", Message("equal-poles", modes=what))
            for place, what in find_equal_poles(self.modes)
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseExcited(Modal):
    """Modes on a motor that follows its setpoint; their poles are distinct."""

    moving_mass: float = 1.0  # and it stays so: no payload is stated here
    modes: tuple[HeldMode, ...] = keyed(
        Array(Table(HeldMode), 1, MOST_MODES), "One to eight modes, with the motor held."
    )

    def mode_states(self) -> tuple[ModeStates, ...]:
        """Return where each mode stands in the plant: q with its own sign."""
        return tuple(ModeStates(f"q_{one.name}", f"v_{one.name}", -1.0) for one in self.modes)

    def vary(
        self, *, payload: float, payload_radius: float, frequency: float, damping: float
    ) -> Self:
        """Return the modes in a corner; the motor follows whatever it carries."""
        return Modal.vary(
            self, payload=0.0, payload_radius=0.0, frequency=frequency, damping=damping
        )

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        """Return these frequencies and damping ratios; a motor that follows has no mass."""
        return Modal.renew(self, mass=self.moving_mass, modes=modes)

    def still_tool(self, modes: Collection[str]) -> None:
        """Return None: modes with the motor held are seen at the tool only."""

    def assumptions(self) -> tuple[Message, ...]:
        """Return what is assumed of the motor."""
        return (Message("motor-follows-assumed"),)
