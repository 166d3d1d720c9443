"""[plant] of a profile: its keys, and what must fit together for the modes to be computable."""

from __future__ import annotations

from math import pi, sqrt
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mtcommission.machine.mechanics import EQUAL_POLE_TOLERANCE
from mtcommission.messages.catalogue import Catalogue
from mtcommission.profile.ranges import (
    ARM_Q,
    DAMPING_Q,
    FREQUENCY_Q,
    INERTIA_Q,
    MASS_Q,
    MODE_GAIN_Q,
    RATIO_Q,
    ROTARY_DAMPING_Q,
    ROTARY_STIFFNESS_Q,
    STIFFNESS_Q,
)
from mtcommission.profile.table import Table, optional, raise_all, required
from mtcommission.profile.values import Faults, Name

MOST_MODES = 8


class ManipulatorTable(Table):
    """[plant] with kind = "manipulator"."""

    kind: Literal["manipulator"] = required("Form of the plant.", '"manipulator"')
    base_mass: Annotated[float, MASS_Q] = required("Mass of the base, m_b.", '"450 kg"')
    slider_mass: Annotated[float, MASS_Q] = required("Mass of the slider, m_s.", '"750 kg"')
    rotary_inertia: Annotated[float, INERTIA_Q] = required(
        "Inertia of the tower about the fictive joint, J.", '"40 kg m^2"'
    )
    lever_arm: Annotated[float, ARM_Q] = required(
        "From the joint to the drive force, r.", '"0.25 m"'
    )
    tcp_height: Annotated[float, ARM_Q] = required(
        "Tool centre point above the joint, h; negative if the tower tilts backwards.", '"0.21 m"'
    )
    base_stiffness: Annotated[float, STIFFNESS_Q] = required("Stiffness k_b.", '"44.41 N/um"')
    base_damping: Annotated[float, DAMPING_Q] = required("Damping d_b.", '"8500 N s/m"')
    rotary_stiffness: Annotated[float, ROTARY_STIFFNESS_Q] = required(
        "Stiffness k.", '"8.2e6 N m/rad"'
    )
    rotary_damping: Annotated[float, ROTARY_DAMPING_Q] = required("Damping d.", '"1800 N m s/rad"')

    @model_validator(mode="after")
    def _check(self) -> Self:
        k_b, m_b, d_b = self.base_stiffness, self.base_mass, self.base_damping
        k, J, d = self.rotary_stiffness, self.rotary_inertia, self.rotary_damping
        faults = []
        if self.lever_arm == 0.0:
            faults.append(
                (
                    "lever_arm",
                    "got 0, but the force must turn the tower; "
                    'give the arm, or describe the axis as kind = "modal"',
                )
            )
        for key, damping, critical, unit in (
            ("base_damping", d_b, 2.0 * sqrt(k_b * m_b), "N s/m"),
            ("rotary_damping", d, 2.0 * sqrt(k * J), "N m s/rad"),
        ):
            if damping >= critical:
                faults.append(
                    (
                        key,
                        f"got {damping:g} {unit}, a damping ratio of "
                        f"{damping / critical:.3g}; must be < {critical:.4g} {unit} (ratio 1)",
                    )
                )
        base = _pole(sqrt(k_b / m_b), d_b / (2.0 * sqrt(k_b * m_b)))
        if not faults and _is_same(base, _pole(sqrt(k / J), d / (2.0 * sqrt(k * J)))):
            faults.append(("rotary_stiffness", _equal_poles("base", "rotation", sqrt(k / J))))
        raise_all(faults)
        return self


class ModeTable(Table):
    """[[plant.modes]]."""

    name: Annotated[str, Name(is_identifier=True)] = required("Name of the mode.", '"column"')
    frequency: Annotated[float, FREQUENCY_Q] = required("Eigenfrequency, undamped.", '"40 Hz"')
    damping_ratio: Annotated[float, RATIO_Q] = required("Damping ratio, 0 to below 1.", "0.03")
    tcp_gain: Annotated[float, MODE_GAIN_Q] = required(
        "Share in the tool position.", '"0.002 1/kg"'
    )
    measured_gain: Annotated[float, MODE_GAIN_Q] = optional(
        "Share in the encoder position.", '"0.001 1/kg"', 0.0
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not 0.0 <= self.damping_ratio < 1.0:
            message = f"got {self.damping_ratio:g}, must be >= 0 and < 1"
            raise Faults([("damping_ratio", message)])
        return self


class ModalTable(Table):
    """[plant] with kind = "modal"."""

    kind: Literal["modal"] = required("Form of the plant.", '"modal"')
    moving_mass: Annotated[float, MASS_Q] = required("Total rigid mass.", '"800 kg"')
    modes: list[ModeTable] = Field(
        description="One to eight modes.", min_length=1, max_length=MOST_MODES
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        faults = []
        poles = [_pole(mode.frequency, mode.damping_ratio) for mode in self.modes]
        for i, mode in enumerate(self.modes):
            for j in range(i):
                other = self.modes[j]
                if mode.name == other.name:
                    faults.append(
                        (f"modes.{i}.name", f'got "{mode.name}" twice, names must differ')
                    )
                if _is_same(poles[i], poles[j]):
                    omega = 2.0 * pi * mode.frequency
                    faults.append(
                        (f"modes.{i}.frequency", _equal_poles(other.name, mode.name, omega))
                    )
        raise_all(faults)
        return self


def damping_ratios(plant: ManipulatorTable | ModalTable) -> list[float]:
    """Return the damping ratio of each mode [-]."""
    if isinstance(plant, ModalTable):
        return [mode.damping_ratio for mode in plant.modes]
    return [
        plant.base_damping / (2.0 * sqrt(plant.base_stiffness * plant.base_mass)),
        plant.rotary_damping / (2.0 * sqrt(plant.rotary_stiffness * plant.rotary_inertia)),
    ]


def _pole(omega: float, zeta: float) -> complex:
    """Return the pole of a mode; its unit does not matter for a relative comparison."""
    return complex(-zeta * omega, omega * sqrt(1.0 - zeta**2)) if zeta < 1.0 else complex(-omega)


def _is_same(pole: complex, other: complex) -> bool:
    return abs(pole - other) <= EQUAL_POLE_TOLERANCE * abs(pole)


def _equal_poles(one: str, other: str, omega: float) -> str:
    hertz, remedy = omega / (2.0 * pi), Catalogue().text("modes-have-equal-poles")
    return f"modes {one} and {other} at {hertz:.6g} Hz: {remedy}"
