"""What follows from the answers so far: modes, accelerations, deflections, contradictions."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

from mtcommission.messages.message import Message
from mtcommission.plant.modal import MOST_MODES
from mtcommission.units.quantities import (
    DAMPING,
    FREQUENCY,
    INERTIA,
    LENGTH,
    MASS,
    RATIO,
    ROTARY_DAMPING,
    ROTARY_STIFFNESS,
    STIFFNESS,
    Dimension,
)
from mtcommission.wizard.axis_units import (
    MODAL,
    PAIR_BY_FREQUENCY,
    TOWER_BY_FREQUENCY,
    TOWER_BY_STIFFNESS,
    axis_units,
    follows,
)
from mtcommission.wizard.convert import pair_of
from mtcommission.wizard.question import Answers, si_value

CONTRADICTION = 0.1
"""Relative difference of two frequencies for one mode above which one of them is wrong: more
than masses and stiffnesses of data sheets are off together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Insight:
    """One line about the machine.

    Parameters
    ----------
    text
        With numbers and units.
    is_warning
        Whether something contradicts itself.
    """

    text: Message
    is_warning: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class _Mode:
    """What is known of a mode; the gain is None while it is not."""

    name: str | Message
    omega: float
    damping_ratio: float | None
    tcp_gain: float | None


def find_insights(answers: Answers) -> tuple[Insight, ...]:
    """Return what is known of the machine, in words.

    Parameters
    ----------
    answers
        As far as given.

    Examples
    --------
    >>> find_insights({"wizard.way": TOWER_BY_STIFFNESS, "plant.base_mass": "450 kg",
    ...     "plant.base_stiffness": "50 N/m"})[0].text.kind
    'insight-mode'
    """
    force = _motion_force(answers)
    found = []
    for mode in _modes(answers):
        kind = "insight-mode-damped" if mode.damping_ratio else "insight-mode"
        text = Message(
            kind,
            mode=mode.name,
            frequency=mode.omega / (2 * pi),
            damping_ratio=mode.damping_ratio,
        )
        found.append(Insight(text=text))
        if mode.tcp_gain is not None and force is not None and force > 0.0:
            by = "held" if follows(answers) else "free"
            found.append(_deflection(mode, force, by))
    mass = _moving_mass(answers)
    unit = axis_units(answers)
    if force is not None and force <= 0.0:
        text = Message("insight-no-force", force=force, unit=unit.force.si)
        found.append(Insight(text=text, is_warning=True))
    elif mass and force is not None:
        text = Message(
            "insight-acceleration",
            acceleration=force / mass,
            rate=unit.acceleration.si,
            force=force,
            unit=unit.force.si,
            mass=mass,
            mass_unit=unit.mass.si,
        )
        found.append(Insight(text=text))
    return (*found, *_contradictions(answers))


def _motion_force(answers: Answers) -> float | None:
    unit = axis_units(answers).force
    if follows(answers):
        return si_value(answers, "drive.max_acceleration", axis_units(answers).acceleration)
    force = si_value(answers, "drive.max_force", unit)
    if force is None:
        return None
    return force - abs(si_value(answers, "drive.static_load", unit) or 0.0)


def _moving_mass(answers: Answers) -> float | None:
    way, unit = answers.get("wizard.way"), axis_units(answers).mass
    if way in (TOWER_BY_STIFFNESS, TOWER_BY_FREQUENCY):
        return si_value(answers, "plant.slider_mass", unit)
    if way == MODAL:
        return si_value(answers, "plant.moving_mass", unit)
    motor = si_value(answers, "pair.motor_mass", unit)
    load = si_value(answers, "pair.load_mass", unit)
    return None if motor is None or load is None else motor + load


def _deflection(mode: _Mode, force: float, by: str) -> Insight:
    deflection = abs(mode.tcp_gain or 0.0) * force / mode.omega**2
    return Insight(text=Message("insight-deflection", mode=mode.name, deflection=deflection, by=by))


def _modes(answers: Answers) -> list[_Mode]:
    way = answers.get("wizard.way")
    if way in (TOWER_BY_STIFFNESS, TOWER_BY_FREQUENCY):
        return _tower_modes(answers, measured=way == TOWER_BY_FREQUENCY)
    if way == MODAL or follows(answers):
        return _bode_modes(answers)
    pair = pair_of(answers)
    if pair is None:
        return []
    return [
        _Mode(
            name=Message("mode-of-pair"),
            omega=2.0 * pi * pair.frequency_hz,
            damping_ratio=pair.damping_ratio,
            tcp_gain=pair.tcp_gain,
        )
    ]


def _tower_modes(answers: Answers, *, measured: bool) -> list[_Mode]:
    found = []
    arm = si_value(answers, "plant.lever_arm", LENGTH)
    height = si_value(answers, "plant.tcp_height", LENGTH)
    for name, part, mass_key, unit, spring, damper in (
        ("base", "base", "plant.base_mass", MASS, STIFFNESS, DAMPING),
        ("rotation", "rotary", "plant.rotary_inertia", INERTIA, ROTARY_STIFFNESS, ROTARY_DAMPING),
    ):
        m = si_value(answers, mass_key, unit)
        omega, zeta = _measured(answers, part) if measured else _sprung(
            answers, part, m, spring, damper)  # fmt: skip
        if not m or omega is None:
            continue
        gain = 1.0 / m if name == "base" else None
        if name == "rotation" and arm is not None and height is not None:
            gain = arm * height / m
        found.append(_Mode(name=name, omega=omega, damping_ratio=zeta, tcp_gain=gain))
    return found


def _measured(answers: Answers, part: str) -> tuple[float | None, float | None]:
    f = si_value(answers, f"measured.{part}_frequency", FREQUENCY)
    zeta = si_value(answers, f"measured.{part}_damping_ratio", RATIO)
    return (2.0 * pi * f if f else None), zeta


def _sprung(
    answers: Answers, part: str, m: float | None, spring: Dimension, damper: Dimension
) -> tuple[float | None, float | None]:
    k = si_value(answers, f"plant.{part}_stiffness", spring)
    d = si_value(answers, f"plant.{part}_damping", damper)
    if not m or not k or m < 0.0 or k < 0.0:
        return None, None
    return sqrt(k / m), None if d is None else d / (2.0 * sqrt(k * m))


def _bode_modes(answers: Answers) -> list[_Mode]:
    found = []
    gain = RATIO if follows(answers) else axis_units(answers).gain
    for i in range(MOST_MODES):
        place = f"plant.modes.{i}"
        f = si_value(answers, f"{place}.frequency", FREQUENCY)
        if f:
            found.append(
                _Mode(
                    name=answers.get(f"{place}.name", str(i + 1)),
                    omega=2.0 * pi * f,
                    damping_ratio=si_value(answers, f"{place}.damping_ratio", RATIO),
                    tcp_gain=si_value(answers, f"{place}.tcp_gain", gain),
                )
            )
    return found


def _contradictions(answers: Answers) -> list[Insight]:
    """Measured frequencies against those of mass and stiffness."""
    unit, way = axis_units(answers), answers.get("wizard.way")
    cases = []
    if way == TOWER_BY_FREQUENCY:
        cases = [
            (Message("part-base"), "measured.base_frequency", "plant.base_mass", MASS,
             "measured.base_stiffness", STIFFNESS),
            (Message("part-tower"), "measured.rotary_frequency", "plant.rotary_inertia", INERTIA,
             "measured.rotary_stiffness", ROTARY_STIFFNESS),
        ]  # fmt: skip
    elif way == PAIR_BY_FREQUENCY:
        cases = [
            (Message("part-load"), "pair.frequency", "pair.load_mass", unit.mass,
             "pair.stiffness", unit.stiffness),
        ]  # fmt: skip
    found = []
    for name, f_key, m_key, mass, k_key, spring in cases:
        f = si_value(answers, f_key, FREQUENCY)
        m, k = si_value(answers, m_key, mass), si_value(answers, k_key, spring)
        if not f or not m or not k or m < 0.0 or k < 0.0:
            continue
        expected = sqrt(k / m) / (2.0 * pi)
        if abs(expected - f) > CONTRADICTION * f:
            text = Message("insight-contradiction", part=name, expected=expected, measured=f)
            found.append(Insight(text=text, is_warning=True))
    return found
