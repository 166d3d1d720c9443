"""What the wizard asks, in the order in which one finds the data at a machine.

Keys, ranges, words and examples come from the schema of profiles; here stands only the order, what
is taken where nobody says otherwise, and what is asked in place of the profile's own keys.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from math import pi

from mtcommission.base.errors import Refused
from mtcommission.base.units.quantities import LENGTH, RATIO
from mtcommission.controls.kinds import GENERIC
from mtcommission.controls.kinds import KINDS as CONTROLS
from mtcommission.machine.machine import MOST_MOVES
from mtcommission.machine.mechanics import KINDS, SOURCE
from mtcommission.machine.plant.modal import MOST_MODES
from mtcommission.machine.profile.describe import KeyQuestion, questions
from mtcommission.machine.ranges import FREQUENCIES, LOADS, MASSES, RATIOS, STIFFNESSES
from mtcommission.wizard.answers import (
    FILES,
    MEASURED,
    MODAL,
    PAIR_BY_FREQUENCY,
    PAIRS,
    SERVO,
    TOWER_BY_FREQUENCY,
    TOWER_BY_STIFFNESS,
    Answers,
    axis_units,
    count_of,
    follows,
    is_rotary,
    move_count,
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
    "pair.modes.0.frequency": (FREQUENCIES, "110 Hz", "110 Hz"),
    "pair.modes.0.damping_ratio": (RATIOS, DAMPING, DAMPING),
    "measured.base_frequency": (FREQUENCIES, "50 Hz", "50 Hz"),
    "measured.base_damping_ratio": (RATIOS, DAMPING, DAMPING),
    "measured.rotary_frequency": (FREQUENCIES, "72 Hz", "72 Hz"),
    "measured.rotary_damping_ratio": (RATIOS, DAMPING, DAMPING),
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

AT_SHAFT = ("drive.max_force", "drive.continuous_force", "plant.moving_mass", "pair.motor_mass")
"""What may be given at the motor's shaft, too, where its travel per turn is known."""

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
    turns, open_loop = is_rotary(answers), follows(answers)
    missing = {
        "drive.gear": not turns and not answers.get("drive.lead"),
        "control.position_loop": len(control.position_loops) < 2,
        "control.state_feedback": not control.state_feedback,
        "today.jerk": not control.has_jerk_limit,
    }
    keys = [
        key
        for key in SETTLED
        if not missing.get(key) and not (open_loop and key.startswith(OF_SERVO))
    ]
    if answers.get("drive.continuous_force") and not open_loop:
        keys += [f"moves.{i}.dwell" for i in range(move_count(answers))]
    own = [key for key in _defaulted(answers) if key not in SETTLED and not key.endswith("name")]
    return tuple(find_question(key, answers) for key in (*own, *keys))


def find_question(key: str, answers: Answers) -> Question:
    """Return the question for any key of a profile; raise KeyError if there is no such key."""
    asked = (one for one in list_questions(answers) if one.key == key)
    return next(asked, None) or _ask(key, answers, default=_default(key, answers))


def list_defaults(answers: Answers) -> dict[str, str]:
    """Return what is written though nobody stated it."""
    found = {key: _default(key, answers) for key in _defaulted(answers) if not answers.get(key)}
    return {key: text for key, text in found.items() if text}


def _defaulted(answers: Answers) -> list[str]:
    """The keys that a profile must have, and that have a default here."""
    way, keys = answers.get("wizard.way", ""), list[str]()
    if way in (MODAL, FILES) or follows(answers):
        names = ("name", "damping_ratio", "tcp_gain")
        modes = range(count_of("plant.modes", "frequency", answers))
        keys += [f"plant.modes.{i}.{name}" for i in modes for name in names]
    elif way in PAIRS:
        further = range(count_of("pair.modes", "frequency", answers))
        keys += ["pair.damping_ratio", *(f"pair.modes.{i}.damping_ratio" for i in further)]
    elif way == TOWER_BY_FREQUENCY:
        keys += [f"measured.{part}_damping_ratio" for part in ("base", "rotary")]
    return [*keys, "machine.source", *([] if follows(answers) else ["drive.force_lag"])]


def _default(key: str, answers: Answers) -> str:
    """What is written for a key that nobody states; "" where it is left out."""
    if key.endswith("damping_ratio"):
        return DAMPING
    mode = re.fullmatch(r"plant\.modes\.(\d+)\.(name|tcp_gain)", key)
    if mode and mode[2] == "name":
        return f"mode{int(mode[1]) + 1}"
    if mode and not follows(answers):
        # The worst case of a tool on the far side of the mode, as identify takes it.
        unit = axis_units(answers)
        mass = si_value(answers, "plant.moving_mass", unit.mass)
        return f"{-1.0 / mass:.5g} {unit.gain.si}" if mass and mass > 0.0 else ""
    return {"drive.force_lag": LAG, "machine.source": BY_HAND}.get(key, "")


@cache
def _schema(kind: str, *, open_loop: bool, rotary: bool) -> dict[str, KeyQuestion]:
    return {one.key: one for one in questions(kind, follows=open_loop, rotary=rotary)}


def _known(answers: Answers) -> dict[str, KeyQuestion]:
    """What the schema says of each key of a profile with these answers."""
    way = answers.get("wizard.way", "")
    kind = "manipulator" if way in (TOWER_BY_STIFFNESS, TOWER_BY_FREQUENCY) else way
    is_held = follows(answers) or kind not in KINDS
    return _schema(
        "modal" if is_held else kind, open_loop=follows(answers), rotary=is_rotary(answers)
    )


def _ask(key: str, answers: Answers, *, default: str = "") -> Question:
    """The question for a key of the profile, from its schema, or for one of the wizard's own."""
    turns, generic = is_rotary(answers), re.sub(r"\.\d+(?=\.)", ".0", key)
    turn = motor_turn(answers) if key in AT_SHAFT else 0.0
    if generic in OWN:
        allowed, linear, rotary = OWN[generic]
        return Question(
            key=key,
            allowed=allowed.on(axis_units(answers)),
            default=default,
            example=rotary if turns else linear,
            motor_turn=turn,
            variant="shaft" if turn else "",
            is_optional=generic.endswith(("modes.0.frequency", "payload.1")),
        )
    one = _known(answers)[generic]
    return Question(
        key=key,
        allowed=one.allowed,
        choices=one.words,
        default=default,
        example=_example(generic, one) if turns else one.example,
        is_optional=not one.is_required and not default,
        meant=one.default,
        motor_turn=turn,
        variant="shaft" if turn else "",
    )


def _example(key: str, one: KeyQuestion) -> str:
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
        yield _ask("drive.max_acceleration", answers)
        yield _ask("drive.max_velocity", answers)
        return
    if not is_rotary(answers):
        yield _ask("drive.lead", answers)  # first of all that needs it
    yield _ask("drive.max_force", answers)
    yield _ask("drive.continuous_force", answers)


def ways_of(answers: Answers) -> tuple[str, ...]:
    """Return the ways into the mechanics, what engineers have most often first."""
    towers = () if is_rotary(answers) else (TOWER_BY_FREQUENCY, TOWER_BY_STIFFNESS)
    others = tuple(kind for kind in KINDS if kind not in ("modal", "manipulator"))
    return (*PAIRS, MODAL, *towers, *others, FILES)


def _mechanics(answers: Answers) -> Iterator[Question]:
    """The choice how the mechanics are known, then what belongs to it."""
    way = answers.get("wizard.way", "")
    if follows(answers):
        if way == FILES:
            yield Question(key=MEASURED)
        yield from _repeated("plant.modes", MOST_MODES, answers)
        return
    ways = ways_of(answers)
    yield Question(key="wizard.way", choices=ways, default=ways[0])
    if way == FILES:
        yield Question(key=MEASURED)
    elif way in PAIRS:
        spring = "frequency" if way == PAIR_BY_FREQUENCY else "stiffness"
        for name in ("motor_mass", "load_mass", spring):
            yield _ask(f"pair.{name}", answers)
        yield from _repeated("pair.modes", MOST_MODES - 1, answers, least=0)
    elif way == MODAL:
        yield _ask("plant.moving_mass", answers)
        yield from _repeated("plant.modes", MOST_MODES, answers)
    elif way:
        for key, one in _known(answers).items():
            is_spring = way == TOWER_BY_FREQUENCY and key.endswith(("stiffness", "damping"))
            if key.startswith("plant.") and one.is_required and not is_spring:
                yield _ask(key, answers)
        for part in ("base", "rotary") if way == TOWER_BY_FREQUENCY else ():
            yield _ask(f"measured.{part}_frequency", answers)


def _repeated(table: str, most: int, answers: Answers, *, least: int = 1) -> Iterator[Question]:
    """The frequency of each mode until one is left empty; all else of a mode has a default."""
    for i in range(most):
        question = _ask(f"{table}.{i}.frequency", answers)
        variant = "held" if follows(answers) else ""
        yield replace(question, is_optional=i >= least, variant=variant)
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
