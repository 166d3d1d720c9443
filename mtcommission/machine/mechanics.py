"""What a machine knows of its mechanics, whichever kind of plant describes them.

The kinds themselves stand in ``plant``, one file each.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import ClassVar, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.keys import keyed
from mtcommission.machine.ranges import FREQUENCIES, MODE_GAINS, RATIOS
from mtcommission.messages.message import Message
from mtcommission.units.axis_units import AxisUnits
from mtcommission.units.quantities import Dimension

Array = NDArray[np.float64]

Misfit = tuple[str, Message]
"""Key of a profile, below the table that it belongs to, and what is wrong with its value."""

EQUAL_POLE_TOLERANCE = 1e-6
"""Relative distance of two poles below which they count as one (empirical: beyond it the
moment equations of the two modes are dependent to half of double precision)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlexibleMode:
    """One mode q'' + 2 ζ ω q' + ω² q = F."""

    name: str = keyed(None, "Name of the mode.", "column")  # used in state names
    natural_frequency: float = keyed(
        FREQUENCIES, "Eigenfrequency, undamped.", "40 Hz", key="frequency", factor=2.0 * pi
    )  # ω [rad/s]
    damping_ratio: float = keyed(RATIOS, "Damping ratio, 0 to below 1.", "0.03")  # ζ [-]
    tcp_gain: float = keyed(MODE_GAINS, "Share in the tool position.", "0.002 1/kg")  # of q, signed
    measured_gain: float = keyed(
        MODE_GAINS, "Share in the encoder position.", "0.001 1/kg", default=0.0
    )  # of q, signed [1/kg]

    @property
    def frequency_hz(self) -> float:
        """Natural frequency [Hz]."""
        return self.natural_frequency / (2 * pi)

    @property
    def pole(self) -> complex:
        """The pole with positive imaginary part, -ζω + iω√(1-ζ²) [1/s]."""
        zeta, omega = self.damping_ratio, self.natural_frequency
        return complex(-zeta * omega, omega * sqrt(1.0 - zeta**2))

    def find_faults(self) -> list[Misfit]:
        """Return key and message of what cannot be."""
        if 0.0 <= self.damping_ratio < 1.0:
            return []
        return [("damping_ratio", Message("damping-ratio-beyond-one", got=self.damping_ratio))]


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldMode:
    """One mode q'' + 2 ζ ω q' + ω² q = -x_ref''."""

    name: str = keyed(None, "Name of the mode.", "belt")  # used in state names
    natural_frequency: float = keyed(
        FREQUENCIES,
        "Eigenfrequency with the motor held, undamped.",
        "48 Hz",
        key="frequency",
        factor=2.0 * pi,
    )  # ω [rad/s]
    damping_ratio: float = keyed(RATIOS, "Damping ratio, 0 to below 1.", "0.05")  # ζ [-]
    tcp_gain: float = keyed(
        RATIOS, "Share in the tool position; 1 where one mode is all of it.", "1", default=1.0
    )  # of q, signed [-]

    def find_faults(self) -> list[Misfit]:
        """Return key and message of what cannot be."""
        return self.driven.find_faults()

    @property
    def driven(self) -> FlexibleMode:
        """The same mode driven by the acceleration, as every plant has its modes: -q for q."""
        return FlexibleMode(
            name=self.name,
            natural_frequency=self.natural_frequency,
            damping_ratio=self.damping_ratio,
            tcp_gain=-self.tcp_gain,
        )


@dataclass(frozen=True, slots=True)
class ModeStates:
    """Where the coordinate q of a mode stands in the plant."""

    deflection: str  # name of the state that is scale times q
    rate: str  # name of the state that is scale times q'
    scale: float = 1.0  # factor from q to the state


class Mechanics(Protocol):
    """A rigid mass with flexible modes; a kind of plant is a frozen dataclass that tells this.

    Its fields are described by ``keyed``, so that the profile can read it.
    """

    kind: ClassVar[str]
    """As ``plant.kind`` of a profile names it."""
    position: ClassVar[str]
    velocity: ClassVar[str]
    """Names of the states of the rigid motion."""

    @property
    def moving_mass(self) -> float:
        """Rigid mass that the drive accelerates [kg]."""

    @property
    def modes(self) -> tuple[FlexibleMode, ...]:
        """The flexible modes, in the order of the plant's states."""

    def mode_states(self) -> tuple[ModeStates, ...]:
        """Return where each mode stands in the plant."""

    @classmethod
    def states(cls, modes: Sequence[str], axis: AxisUnits) -> dict[str, Dimension]:
        """Return the plant's states in order and what they measure, from the modes' names."""

    def mode_key(self, index: int) -> str:
        """Return the key of a mode in the profile; "plant" where it follows from several."""

    def vary(
        self, *, payload: float, payload_radius: float, frequency: float, damping: float
    ) -> Self:
        """Return the mechanics with payload [kg, m], frequencies and damping ratios scaled [-]."""

    def inertia_ratio(self, mode: str, payload: Array, payload_radius: float) -> Array:
        """Return what a mode moves without payload over that with it [-], shape of payload."""

    def find_faults(self) -> list[Misfit]:
        """Return key below [plant] and message of what does not fit together."""

    def assumptions(self) -> tuple[Message, ...]:
        """Return what the kind assumes beyond the profile."""


def find_equal_poles(modes: Sequence[FlexibleMode]) -> Iterator[tuple[int, Message]]:
    """Yield the place of each mode that has the poles of an earlier one, and what is wrong."""
    for place, mode in enumerate(modes):
        for other in modes[:place]:
            if abs(mode.pole - other.pole) <= EQUAL_POLE_TOLERANCE * abs(mode.pole):
                yield (
                    place,
                    Message(
                        "modes-at-one-frequency",
                        one=other.name,
                        other=mode.name,
                        frequency=mode.frequency_hz,
                    ),
                )


_Mode = TypeVar("_Mode", FlexibleMode, HeldMode)


def scale_modes(modes: Sequence[_Mode], *, frequency: float, damping: float) -> tuple[_Mode, ...]:
    """Return modes with frequencies and damping ratios scaled by a factor each [-]."""
    return tuple(
        replace(
            mode,
            natural_frequency=mode.natural_frequency * frequency,
            damping_ratio=mode.damping_ratio * damping,
        )
        for mode in modes
    )


def find_mode_faults(modes: Sequence[FlexibleMode]) -> list[Misfit]:
    """Return key below [plant] and message of names used twice and of equal poles."""
    names = [mode.name for mode in modes]
    faults = [
        (f"modes.{place}.name", Message("mode-named-twice", name=name))
        for place, name in enumerate(names)
        if name in names[:place]
    ]
    return faults + [
        (f"modes.{place}.frequency", Message("equal-poles", modes=what))
        for place, what in find_equal_poles(modes)
    ]
