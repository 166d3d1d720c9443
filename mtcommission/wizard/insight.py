"""What follows from the answers so far: modes, deflections, accelerations, what counts twice."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import MASS
from mtcommission.machine.mechanics import PLANTS, Mechanics
from mtcommission.machine.readers import Reading
from mtcommission.wizard.answers import (
    MODAL,
    PAIRS,
    Answers,
    axis_units,
    follows,
    si_value,
    to_profile,
)
from mtcommission.wizard.script import motor_turn

ALIKE = 0.1
"""Relative difference of two measured frequencies below which they may be one resonance."""


def find_insights(answers: Answers, defaults: Answers) -> Iterator[Message]:
    """Yield what is known of the machine, in words, as soon as the mechanics can be read."""
    mechanics, axis = _read_mechanics(answers, defaults), axis_units(answers)
    if mechanics is None:
        return
    if follows(answers):
        force, mass = si_value(answers, "drive.max_acceleration", axis.acceleration), 0.0
    else:
        force, mass = _motion_force(answers), mechanics.moving_mass
    for mode in mechanics.modes:
        known = {"frequency": mode.frequency_hz, "damping_ratio": mode.damping_ratio}
        yield Message("insight-mode", mode=mode.name, **known)
        if force is not None and force > 0.0:
            deflection = abs(mode.tcp_gain) * force / mode.natural_frequency**2
            by = "held" if follows(answers) else "free"
            yield Message("insight-deflection", mode=mode.name, deflection=deflection, by=by)
    if force is not None and force <= 0.0:
        yield Message("insight-no-force", force=force, unit=axis.force.si)
    elif mass and force is not None:
        yield Message(
            "insight-acceleration",
            acceleration=force / mass,
            rate=axis.acceleration.si,
            force=force,
            unit=axis.force.si,
            mass=mass,
            mass_unit=axis.mass.si,
        )
    if turn := motor_turn(answers):
        motor = si_value(answers, "pair.motor_mass", MASS)
        if answers.get("wizard.way") in PAIRS and motor:
            yield Message("insight-shaft", mass=motor, inertia=1e4 * motor / turn**2)
        elif answers.get("wizard.way") == MODAL:
            yield Message("insight-rotor-unknown", mass=mass, each=1e-4 * turn**2)
    for one, other in combinations(mechanics.modes, 2):
        first, second = one.frequency_hz, other.frequency_hz
        if abs(first - second) < ALIKE * max(first, second):
            yield Message("insight-twice-measured", first=first, second=second)


def _motion_force(answers: Answers) -> float | None:
    unit = axis_units(answers).force
    force = si_value(answers, "drive.max_force", unit)
    return force and force - abs(si_value(answers, "drive.static_load", unit) or 0.0)


def _read_mechanics(answers: Answers, defaults: Answers) -> Mechanics | None:
    plant = to_profile(answers, defaults).get("plant")
    reading = Reading(axis=axis_units(answers), states={}, outputs={}, follows=follows(answers))
    found = PLANTS.read(plant, ("plant",), reading) if isinstance(plant, dict) else None
    return None if reading.faults else found
