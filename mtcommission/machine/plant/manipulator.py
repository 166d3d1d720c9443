"""The manipulator of Christiansen, Maurer & Zirn, eq. (1): a slider with a tower on a soft base."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import ANGLE, ANGULAR_VELOCITY, AxisUnits, Dimension
from mtcommission.machine import readers as of
from mtcommission.machine.keys import Misfit, keyed
from mtcommission.machine.mechanics import FlexibleMode, Mechanics, ModeStates, find_equal_poles

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manipulator(Mechanics):
    """The two-mode manipulator of Christiansen, Maurer & Zirn, eq. (1); fields in SI.

    ``lever_arm`` reaches to the line of the drive force; the paper gives no sign of ``tcp_height``.
    """

    kind: ClassVar = "manipulator"
    position: ClassVar = "x_s"
    velocity: ClassVar = "v_s"

    base_mass: float = keyed(of.MASSES, "Mass of the base, m_b.", "450 kg")
    slider_mass: float = keyed(of.MASSES, "Mass of the slider, m_s.", "750 kg")
    rotary_inertia: float = keyed(
        of.INERTIAS, "Inertia of the tower about the fictive joint, J.", "40 kg m^2"
    )
    lever_arm: float = keyed(of.ARMS, "From the joint to the drive force, r.", "0.25 m")
    tcp_height: float = keyed(
        of.ARMS,
        "Tool centre point above the joint, h; negative if the tower tilts backwards.",
        "0.21 m",
    )
    base_stiffness: float = keyed(of.STIFFNESSES, "Stiffness k_b.", "44.41 N/um")  # [N/m]
    base_damping: float = keyed(of.DAMPINGS, "Damping d_b.", "8500 N s/m")
    rotary_stiffness: float = keyed(of.ROTARY_STIFFNESSES, "Stiffness k.", "8.2e6 N m/rad")
    rotary_damping: float = keyed(of.ROTARY_DAMPINGS, "Damping d.", "1800 N m s/rad")

    @property
    def moving_mass(self) -> float:
        """Rigid mass that the drive accelerates [kg]."""
        return self.slider_mass

    @property
    def modes(self) -> tuple[FlexibleMode, FlexibleMode]:
        """Base and tower, both in the form q'' + 2 ζ ω q' + ω² q = F.

        x_b = -q/m_b and φ = r q/J, so the base moves tool and encoder alike (+1/m_b) and the
        tower moves the tool alone (h r/J).

        Source: Christiansen, Maurer & Zirn, eq. (1), divided by m_b and J.
        """
        m_b, k_b, d_b = self.base_mass, self.base_stiffness, self.base_damping
        J, k, d = self.rotary_inertia, self.rotary_stiffness, self.rotary_damping
        base = FlexibleMode(
            name="base",
            natural_frequency=sqrt(k_b / m_b),
            damping_ratio=d_b / (2 * sqrt(k_b * m_b)),
            tcp_gain=1 / m_b,
            measured_gain=1 / m_b,
        )
        tower = FlexibleMode(
            name="rotation",
            natural_frequency=sqrt(k / J),
            damping_ratio=d / (2 * sqrt(k * J)),
            tcp_gain=self.tcp_height * self.lever_arm / J,
            measured_gain=0.0,
        )
        return base, tower

    def mode_states(self) -> tuple[ModeStates, ModeStates]:
        """Return where each mode stands in the plant."""
        return (
            ModeStates("x_b", "v_b", -1.0 / self.base_mass),
            ModeStates("phi", "v_phi", self.lever_arm / self.rotary_inertia),
        )

    @classmethod
    def states(cls, modes: Sequence[str], axis: AxisUnits) -> dict[str, Dimension]:
        """Return the plant's states in order and what they measure."""
        return {
            "x_b": axis.length,
            "x_s": axis.length,
            "phi": ANGLE,
            "v_b": axis.velocity,
            "v_s": axis.velocity,
            "v_phi": ANGULAR_VELOCITY,
            "F": axis.force,
        }

    def vary(
        self, *, payload: float, payload_radius: float, frequency: float, damping: float
    ) -> Self:
        """Return the manipulator in a corner: stiffness k s², damping d s, at factors s and d."""
        s, d = frequency, frequency * damping
        return replace(
            self,
            slider_mass=self.slider_mass + payload,
            rotary_inertia=self.rotary_inertia + payload * payload_radius**2,
            base_stiffness=self.base_stiffness * s**2,
            base_damping=self.base_damping * d,
            rotary_stiffness=self.rotary_stiffness * s**2,
            rotary_damping=self.rotary_damping * d,
        )

    def inertia_ratio(self, mode: str, payload: Array, payload_radius: float) -> Array:
        """Return the tower's inertia without payload over that with it; 1 for the base."""
        J, turned = self.rotary_inertia, payload * payload_radius**2 * (mode == "rotation")
        return np.asarray(J / (J + turned))

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        """Return the stiffnesses and damping constants that give these modes, with this mass."""
        m_b, J = self.base_mass, self.rotary_inertia
        base, tower = modes
        return replace(
            self,
            slider_mass=mass,
            base_stiffness=m_b * base.natural_frequency**2,
            base_damping=2.0 * m_b * base.damping_ratio * base.natural_frequency,
            rotary_stiffness=J * tower.natural_frequency**2,
            rotary_damping=2.0 * J * tower.damping_ratio * tower.natural_frequency,
        )

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> list[Misfit]:
        """Return key below [plant] and message of what does not fit together."""
        faults = []
        if self.lever_arm == 0.0:
            faults.append(("lever_arm", Message("lever-arm-zero")))
        for key, damping, stiffness, mass, unit in (
            ("base_damping", self.base_damping, self.base_stiffness, self.base_mass, "N s/m"),
            ("rotary_damping", self.rotary_damping, self.rotary_stiffness, self.rotary_inertia,
             "N m s/rad")
        ):  # fmt: skip
            critical = 2.0 * sqrt(stiffness * mass)
            if damping >= critical:
                ratio = damping / critical
                message = Message(
                    "damping-beyond-critical", got=damping, ratio=ratio, most=critical, unit=unit
                )
                faults.append((key, message))
        equal = () if faults else find_equal_poles(self.modes)
        return faults + [
            ("rotary_stiffness", Message("equal-poles", modes=modes)) for _, modes in equal
        ]

    def assumptions(self) -> tuple[Message, ...]:
        """Return where the tool is taken to stand; the paper does not say."""
        return (Message("tcp-height-assumed", side="above" if self.tcp_height >= 0 else "below"),)
