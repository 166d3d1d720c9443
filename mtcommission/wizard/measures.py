"""What is measured on an axis, the ways into its mechanics, and the two commonest questions."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.units import (
    ANGLE,
    ANGULAR_VELOCITY,
    DAMPING,
    FORCE,
    INERTIA,
    LENGTH,
    MASS,
    PER_INERTIA,
    PER_MASS,
    RATIO,
    ROTARY_DAMPING,
    ROTARY_STIFFNESS,
    STIFFNESS,
    TORQUE,
    VELOCITY,
    Dimension,
)
from mtcommission.wizard.question import Answers, Question

TOWER_BY_STIFFNESS = "tower: masses and stiffness"
TOWER_BY_FREQUENCY = "tower: masses and measured eigenfrequencies"
PAIR_BY_STIFFNESS = "motor and load: masses and stiffness"
PAIR_BY_FREQUENCY = "motor and load: masses and measured eigenfrequency"
MODAL = "modes from a bode plot"
WAYS = (
    TOWER_BY_STIFFNESS,
    TOWER_BY_FREQUENCY,
    PAIR_BY_STIFFNESS,
    PAIR_BY_FREQUENCY,
    MODAL,
)
"""Ways into the mechanics; the wizard converts all to one of the profile's two kinds."""

YES, NO = "yes", "no"


@dataclass(frozen=True, slots=True, kw_only=True)
class Measures:
    """What masses, forces and lengths are on this axis."""

    mass: Dimension
    force: Dimension
    length: Dimension
    velocity: Dimension
    stiffness: Dimension
    damping: Dimension
    gain: Dimension


LINEAR = Measures(
    mass=MASS,
    force=FORCE,
    length=LENGTH,
    velocity=VELOCITY,
    stiffness=STIFFNESS,
    damping=DAMPING,
    gain=PER_MASS,
)
ROTARY = Measures(
    mass=INERTIA,
    force=TORQUE,
    length=ANGLE,
    velocity=ANGULAR_VELOCITY,
    stiffness=ROTARY_STIFFNESS,
    damping=ROTARY_DAMPING,
    gain=PER_INERTIA,
)


def measures(answers: Answers) -> Measures:
    """Return what is measured on the axis that the answers describe."""
    return ROTARY if answers.get("machine.motion") == "rotary" else LINEAR


def ask(
    key: str,
    text: str,
    where: str,
    dimension: Dimension,
    example: str,
    low: float,
    high: float,
    *,
    is_optional: bool = False,
) -> Question:
    """Return a question for a quantity that has no default; low and high in SI."""
    return Question(
        key=key,
        text=text,
        where=where,
        dimension=dimension,
        example=example,
        low=low,
        high=high,
        is_optional=is_optional,
    )


def damping_ratio(key: str, what: str) -> Question:
    """Return the question for the damping ratio of a mode."""
    return Question(
        key=key,
        text=f"Damping ratio of {what}",
        where="Half the relative 3 dB width of the peak; machine structures show 0.01 to 0.1.",
        dimension=RATIO,
        default="0.03",
        low=0.002,
        high=0.3,
    )
