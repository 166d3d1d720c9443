"""Modes with the motor held, excited by its acceleration: an axis whose motor simply follows.

    q'' + 2 ζ ω q' + ω² q = -x_ref'',   tool = x_ref + Σ tcp_gain q

That is the modal plant with a mass of 1 and the acceleration of the motor for its force. The
frequencies are those with the motor held, which is what an accelerometer shows while it stands.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Self

from mtcommission.base.messages.message import Message
from mtcommission.machine.keys import Table, keyed
from mtcommission.machine.mechanics import (
    FlexibleMode,
    HeldMode,
    ModeStates,
    renew_modes,
    scale_modes,
)
from mtcommission.machine.plant.modal import MOST_MODES, Modal
from mtcommission.machine.readers import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseExcited(Modal):
    """Modes on a motor that follows its setpoint; their poles are distinct.

    Examples
    --------
    >>> from math import pi
    >>> head = HeldMode(name="belt", natural_frequency=2 * pi * 45, damping_ratio=0.05)
    >>> [(mode.tcp_gain, round(mode.frequency_hz)) for mode in BaseExcited(modes=(head,)).modes]
    [(-1.0, 45)]
    """

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
        modes = scale_modes(self.modes, frequency=frequency, damping=damping)
        return replace(self, modes=modes)

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        """Return these frequencies and damping ratios; a motor that follows has no mass."""
        return replace(self, modes=renew_modes(self.modes, modes))

    def still_tool(self, modes: Collection[str]) -> None:
        """Return None: modes with the motor held are seen at the tool only."""

    def assumptions(self) -> tuple[Message, ...]:
        """Return what is assumed of the motor."""
        return (Message("motor-follows-assumed"),)
