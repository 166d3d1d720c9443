"""What the wizard asks, in the order in which one finds the data at a machine.

Keys, ranges, words and examples come from the schema of profiles; here stands only the order, what
is taken where nobody says otherwise, and what is asked in place of the profile's own keys.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import pi

from mtcommission.base.errors import Refused
from mtcommission.base.units.quantities import LENGTH, RATIO
from mtcommission.controls.kinds import GENERIC
from mtcommission.controls.kinds import KINDS as CONTROLS
from mtcommission.machine.machine import MOST_MOVES
from mtcommission.machine.mechanics import KINDS, SOURCE
from mtcommission.machine.plant.modal import MOST_MODES
from mtcommission.machine.profile.describe import KeyQuestion
from mtcommission.machine.readers import FREQUENCIES, LOADS, MASSES, RATIOS, STIFFNESSES
from mtcommission.wizard.answers import (
    KIND_OF_WAY,
    MODAL,
    PAIR_BY_FREQUENCY,
    PAIRS,
    SERVO,
    TOWER,
    Answers,
    axis_units,
    count_of,
    follows,
    is_rotary,
    known_keys,
    move_count,
    schema_key,
    si_value,
)
from mtcommission.wizard.question import Question

FOR_STEPS = "klipper"
"""Kind of control that is proposed for an open-loop axis: its shapers are made for that."""

DAMPING, LAG, BY_HAND = "0.03", "2 ms", "entered by hand"
"""What is taken where nobody says otherwise: damping of machine structures, lag of a servo drive,
source of the data."""

OWN = {
    "pair.motor_mass": (MASSES, "320 kg", "2 kg m^2"),
    "pair.load_mass": (MASSES, "1150 kg", "6 kg m^2"),
    "pair.stiffness": (STIFFNESSES, "16 N/um", "1 MN m/rad"),
    "pair.frequency": (FREQUENCIES, "40 Hz", "40 Hz"),
    "pair.damping_ratio": (RATIOS, DAMPING, DAMPING),
    "requirements.payload.1": (LOADS, "100 kg", "1 kg m^2"),
}
"""What no key of a profile holds: its range, and an example on a linear and on a rotary axis."""

ROTARY_EXAMPLES = {
    "drive.max_force": "800 N m",
    "drive.continuous_force": "400 N m",
    "drive.max_acceleration": "100 rad/s^2",
    "drive.max_velocity": "10 rad/s",
    "plant.moving_mass": "8 kg m^2",
    "moves.0.distance": "90 deg",
    "moves.0.max_velocity": "60 rev/min",
    "moves.0.velocity_step": "60 rev/min",
    "requirements.tcp_deviation": "5 arcsec",
}
"""Where the schema's example is one of a linear axis."""

SETTLED = (
    *("machine.source", "drive.force_lag", "drive.gear", "drive.static_load"),
    *("drive.encoder_resolution", "requirements.max_settling_time"),
    *("requirements.contour_deviation", "requirements.frequency_spread"),
    *("requirements.damping_spread", "requirements.payload.1", "control.position_loop"),
    *("control.position_cycle", "control.velocity_cycle", "control.position_gain"),
    *("control.velocity_gain", "control.integral_time", "control.state_feedback"),
    *("today.acceleration", "today.jerk"),
)
"""What has a sound default, or can be left out: shown at the end, with the chance to change it."""

OF_SERVO = ("drive.", "requirements.payload", "control.")
"""Beginnings of those that an open-loop axis does not have."""


def list_questions(answers: Answers) -> tuple[Question, ...]:
    """Return every question that is asked, in order.

    Examples
    --------
    >>> [question.key for question in list_questions({})][:3]
    ['machine.name', 'machine.axis', 'machine.motion']
    """
    control = FOR_STEPS if follows(answers) else GENERIC.key
    return (
        _ask("machine.name", answers, default="Machine"),
        _ask("machine.axis", answers, default="X"),
        _ask("machine.motion", answers, default="linear"),
        Question(key="drive.kind", choices=(SERVO, SOURCE), default=SERVO),
        *_drive(answers),
        *_mechanics(answers),
        *_moves(answers),
        _ask("requirements.tcp_deviation", answers),
        _ask("control.kind", answers, default=control),
    )


def list_settled(answers: Answers) -> tuple[Question, ...]:
    """Return what is not asked, with what is taken instead."""
    control = CONTROLS.get(answers.get("control.kind", ""), GENERIC)
    open_loop = follows(answers)
    missing = {
        "drive.gear": not is_rotary(answers) and not answers.get("drive.lead"),
        "control.position_loop": len(control.position_loops) < 2,
        "control.state_feedback": not control.state_feedback,
        "today.jerk": not control.has_jerk_limit,
    }
    keys = [key for key in _defaults(answers) if key not in SETTLED and not key.endswith("name")]
    keys += [
        key
        for key in SETTLED
        if not missing.get(key) and not (open_loop and key.startswith(OF_SERVO))
    ]
    if answers.get("drive.continuous_force") and not open_loop:
        keys += [f"moves.{i}.dwell" for i in range(move_count(answers))]
    return tuple(find_question(key, answers) for key in keys)


def find_question(key: str, answers: Answers) -> Question:
    """Return the question for any key of a profile; raise KeyError if there is no such key."""
    asked = (one for one in list_questions(answers) if one.key == key)
    return next(asked, None) or _ask(key, answers, default=_defaults(answers).get(key, ""))


def list_defaults(answers: Answers) -> dict[str, str]:
    """Return what is written though nobody stated it."""
    return {key: text for key, text in _defaults(answers).items() if text and not answers.get(key)}


def _defaults(answers: Answers) -> dict[str, str]:
    """What is taken for the keys that a profile must have; "" where that cannot be told yet."""
    way, found = answers.get("wizard.way", ""), dict[str, str]()
    if way == MODAL or follows(answers):
        # The worst case of a tool on the far side of the mode, as identify takes it.
        unit = axis_units(answers)
        mass = si_value(answers, "plant.moving_mass", unit.mass)
        is_known = mass and mass > 0.0 and not follows(answers)
        gain = f"{-1.0 / mass:.5g} {unit.gain.si}" if mass and is_known else ""
        for i in range(count_of("plant.modes", answers)):
            values = {"name": f"mode{i + 1}", "damping_ratio": DAMPING, "tcp_gain": gain}
            found |= {f"plant.modes.{i}.{key}": text for key, text in values.items()}
    elif way in PAIRS:
        found["pair.damping_ratio"] = DAMPING
    found["machine.source"] = BY_HAND
    return found if follows(answers) else {**found, "drive.force_lag": LAG}


def _ask(key: str, answers: Answers, *, default: str = "") -> Question:
    """The question for a key of the profile, from its schema, or for one of the wizard's own."""
    turns, generic, turn = is_rotary(answers), schema_key(key), motor_turn(answers)
    if generic in OWN:
        allowed, linear, rotary = OWN[generic]
        one = KeyQuestion(
            key=generic,
            allowed=allowed.on(axis_units(answers)),
            example=rotary if turns else linear,
            default=None,
            is_required=not generic.endswith("payload.1"),
            words=(),
        )
    else:
        one = known_keys(answers)[generic]
    return Question(
        key=key,
        allowed=one.allowed,
        choices=one.words,
        default=default,
        example=_rotary_example(generic, one) if turns else one.example,
        is_optional=not one.is_required and not default,
        meant=one.default,
        motor_turn=turn,
    )


def _rotary_example(key: str, one: KeyQuestion) -> str:
    """An example on a rotary axis; the schema's is one of a linear axis."""
    example = ROTARY_EXAMPLES.get(key, one.example)
    if one.allowed is not None:
        try:
            one.allowed.number_of(example)
        except Refused:
            return ""
    return example


def _drive(answers: Answers) -> Iterator[Question]:
    if follows(answers):
        keys = ["max_acceleration", "max_velocity"]
    else:  # first of all the lead, which all the rest needs
        keys = [*([] if is_rotary(answers) else ["lead"]), "max_force", "continuous_force"]
    for key in keys:
        yield _ask(f"drive.{key}", answers)


def _mechanics(answers: Answers) -> Iterator[Question]:
    """The choice how the mechanics are known, then what belongs to it."""
    way = answers.get("wizard.way", "")
    if not follows(answers):
        # What engineers have most often first.
        tower = () if is_rotary(answers) else (TOWER,)
        others = (kind for kind in KINDS if kind not in KIND_OF_WAY.values())
        ways = (*PAIRS, MODAL, *tower, *others)
        yield Question(key="wizard.way", choices=ways, default=ways[0])
    if follows(answers):
        yield from _frequencies(answers)
    elif way in PAIRS:
        spring = "frequency" if way == PAIR_BY_FREQUENCY else "stiffness"
        for name in ("motor_mass", "load_mass", spring):
            yield _ask(f"pair.{name}", answers)
    elif way == MODAL:
        yield _ask("plant.moving_mass", answers)
        yield from _frequencies(answers)
    elif way:
        for key, one in known_keys(answers).items():
            if key.startswith("plant.") and one.is_required:
                yield _ask(key, answers)


def _frequencies(answers: Answers) -> Iterator[Question]:
    """The frequency of each mode until one is left empty; all else of a mode has a default."""
    for i in range(MOST_MODES):
        question = _ask(f"plant.modes.{i}.frequency", answers)
        variant = "held" if follows(answers) else ""
        yield replace(question, is_optional=i > 0, variant=variant)
        if not answers.get(question.key):
            return


def _moves(answers: Answers) -> Iterator[Question]:
    """The size of each move, a distance or a velocity, until one is left empty."""
    for i in range(MOST_MOVES):
        place = f"moves.{i}"
        step = _ask(f"{place}.velocity_step", answers)
        if answers.get(step.key):
            yield step
            continue
        size = _ask(f"{place}.distance", answers)
        yield replace(size, is_optional=i > 0, instead=step)
        if not answers.get(size.key):
            return
        yield _ask(f"{place}.max_velocity", answers)


def motor_turn(answers: Answers) -> float:
    """Return how far the motor turns per travel of a linear axis [rad/m]; 0: not known."""
    lead = si_value(answers, "drive.lead", LENGTH)
    if is_rotary(answers) or follows(answers) or not lead or lead < 0.0:
        return 0.0
    return 2.0 * pi * (si_value(answers, "drive.gear", RATIO) or 1.0) / lead
