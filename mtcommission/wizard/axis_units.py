"""What is measured on an axis, the ways into its mechanics, and the two commonest questions."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from mtcommission.units.axis_units import LINEAR, ROTARY, AxisUnits
from mtcommission.units.quantities import LENGTH, RATIO, Dimension
from mtcommission.wizard.question import Answers, Question, si_value

TOWER_BY_STIFFNESS = "tower: masses and stiffness"
TOWER_BY_FREQUENCY = "tower: masses and measured eigenfrequencies"
PAIR_BY_STIFFNESS = "motor and load: masses and stiffness"
PAIR_BY_FREQUENCY = "motor and load: masses and measured eigenfrequency"
MODAL = "modes from a Bode plot"
TOWERS = (TOWER_BY_FREQUENCY, TOWER_BY_STIFFNESS)
PAIRS = (PAIR_BY_FREQUENCY, PAIR_BY_STIFFNESS)
WAYS = (*PAIRS, MODAL, *TOWERS)
"""Ways into the mechanics, what engineers have most often first; the wizard converts all to one of
the profile's two kinds."""

YES, NO, UNKNOWN = "yes", "no", "not known"

MEASURED = "wizard.measured"
"""Key of the first question: files with measured responses, with ; or , between them."""


Span = tuple[float, float]
"""Least and largest common value [SI]; empirical, machine tool axes from a router to a gantry."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Common:
    """What is common on an axis; outside it the wizard asks back.

    The fields say what is measured; stiffness and velocity gain are those of the drive train.
    """

    mass: Span
    force: Span
    distance: Span
    deviation: Span
    velocity: Span
    acceleration: Span
    jerk: Span
    stiffness: Span
    velocity_gain: Span


LINEAR_COMMON = Common(
    mass=(0.01, 1e5),
    force=(1.0, 1e5),
    distance=(1e-5, 50.0),
    deviation=(1e-8, 1e-3),
    velocity=(1e-4, 10.0),
    acceleration=(0.01, 100.0),
    jerk=(0.1, 1e5),
    stiffness=(1e3, 1e10),
    velocity_gain=(1.0, 1e8),
)
ROTARY_COMMON = Common(
    mass=(1e-6, 1e5),
    force=(0.01, 1e5),
    distance=(1e-4, 1e3),
    deviation=(1e-7, 1e-2),
    velocity=(1e-3, 1e3),
    acceleration=(0.01, 1e4),
    jerk=(0.1, 1e7),
    stiffness=(1.0, 1e10),
    velocity_gain=(1e-4, 1e7),
)


def is_rotary(answers: Answers) -> bool:
    """Return whether the answers describe a rotary axis."""
    return answers.get("machine.motion") == "rotary"


SERVO, SOURCE = "servo", "position_source"
"""Kinds of drive."""


def follows(answers: Answers) -> bool:
    """Return whether the motor simply follows its setpoint: a stepper, or a stiff servo."""
    return answers.get("drive.kind") == SOURCE


def axis_units(answers: Answers) -> AxisUnits:
    """Return what is measured on the axis that the answers describe."""
    return ROTARY if is_rotary(answers) else LINEAR


def common(answers: Answers) -> Common:
    """Return what is common on the axis that the answers describe."""
    return ROTARY_COMMON if is_rotary(answers) else LINEAR_COMMON


def ask(
    key: str,
    dimension: Dimension,
    example: str,
    low: float,
    high: float,
    *,
    is_optional: bool = False,
    motor_turn: float = 0.0,
) -> Question:
    """Return a question for a quantity that has no default.

    Parameters
    ----------
    key, dimension, example
        As in ``Question``.
    low, high
        Least and largest common value [SI]; outside it the wizard asks back.
    is_optional
        Whether it may be left empty.
    motor_turn
        As in ``Question``.
    """
    return Question(
        key=key,
        dimension=dimension,
        example=example,
        low=low,
        high=high,
        is_optional=is_optional,
        motor_turn=motor_turn,
        measured=SHAFT if motor_turn else "",
    )


SHAFT = "shaft"
"""Ending of the texts where a value at the motor's shaft is taken, too."""


def motor_turn(answers: Answers) -> float:
    """Return how far the motor turns per travel of a linear axis [rad/m]; 0: not known."""
    lead = si_value(answers, "drive.lead", LENGTH)
    if is_rotary(answers) or follows(answers) or not lead or lead < 0.0:
        return 0.0
    return 2.0 * pi * (si_value(answers, "drive.gear", RATIO) or 1.0) / lead


def damping_ratio(key: str) -> Question:
    """Return the question for the damping ratio of a mode."""
    return Question(key=key, dimension=RATIO, default="0.03", low=0.002, high=0.3)
