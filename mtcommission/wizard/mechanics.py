"""The questions about the mechanics, one set for each way into them."""

from __future__ import annotations

from dataclasses import replace

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
)
from mtcommission.wizard.axis_units import (
    MODAL,
    NO,
    PAIR_BY_FREQUENCY,
    PAIR_BY_STIFFNESS,
    TOWER_BY_FREQUENCY,
    TOWER_BY_STIFFNESS,
    TOWERS,
    WAYS,
    YES,
    ask,
    axis_units,
    common,
    damping_ratio,
    follows,
    is_rotary,
    motor_turn,
)
from mtcommission.wizard.question import Answers, Question, si_value

ROTOR = "wizard.rotor"
"""Key of the inertia that the whole rigid mass must contain."""

HELD = "held"
"""How the modes of a motor that follows are measured."""


def ask_mechanics(answers: Answers) -> tuple[Question, ...]:
    """Return the questions for the way that was chosen; first the choice itself."""
    if follows(answers):
        return _held(answers)
    ways = tuple(way for way in WAYS if way not in TOWERS) if is_rotary(answers) else WAYS
    way = Question(key="wizard.way", choices=ways, default=ways[0])
    match answers.get("wizard.way", ""):
        case chosen if chosen == TOWER_BY_STIFFNESS:
            return (way, *_tower_masses(), *_tower_stiffness())
        case chosen if chosen == TOWER_BY_FREQUENCY:
            return (way, *_tower_masses(), *_tower_frequencies())
        case chosen if chosen == PAIR_BY_STIFFNESS:
            return (way, *_pair(answers, by_stiffness=True))
        case chosen if chosen == PAIR_BY_FREQUENCY:
            return (way, *_pair(answers, by_stiffness=False))
        case chosen if chosen == MODAL:
            return (way, *_modal(answers))
    return (way,)


def _tower_masses() -> tuple[Question, ...]:
    return (
        ask("plant.base_mass", MASS, "450 kg", 1.0, 1e5),
        ask("plant.slider_mass", MASS, "750 kg", 0.1, 1e5),
        ask("plant.rotary_inertia", INERTIA, "40 kg m^2", 1e-3, 1e5),
        ask("plant.lever_arm", LENGTH, "0.25 m", -2.0, 2.0),
        ask("plant.tcp_height", LENGTH, "0.21 m", -5.0, 5.0),
    )


def _tower_stiffness() -> tuple[Question, ...]:
    return (
        ask("plant.base_stiffness", STIFFNESS, "44.41 N/um", 1e4, 1e10),
        ask("plant.base_damping", DAMPING, "8500 N s/m", 0.0, 1e7),
        ask("plant.rotary_stiffness", ROTARY_STIFFNESS, "8.2e6 N m/rad", 1e2, 1e11),
        ask("plant.rotary_damping", ROTARY_DAMPING, "1800 N m s/rad", 0.0, 1e8),
    )


def _tower_frequencies() -> tuple[Question, ...]:
    return (
        ask("measured.base_frequency", FREQUENCY, "50 Hz", 1.0, 1e3),
        damping_ratio("measured.base_damping_ratio"),
        ask(
            "measured.base_stiffness",
            STIFFNESS,
            "44.41 N/um",
            1e4,
            1e10,
            is_optional=True,
        ),
        ask("measured.rotary_frequency", FREQUENCY, "72 Hz", 1.0, 1e3),
        damping_ratio("measured.rotary_damping_ratio"),
        ask(
            "measured.rotary_stiffness",
            ROTARY_STIFFNESS,
            "8.2e6 N m/rad",
            1e2,
            1e11,
            is_optional=True,
        ),
    )


def _pair(answers: Answers, *, by_stiffness: bool) -> tuple[Question, ...]:
    spring = (
        (_pair_stiffness(answers, is_optional=False),)
        if by_stiffness
        else _pair_by_frequency(answers)
    )
    own = (*_pair_masses(answers), *spring, damping_ratio("pair.damping_ratio"))
    return (*own, *_further_modes(answers))


def _further_modes(answers: Answers) -> tuple[Question, ...]:
    """Resonances that were measured besides that of motor and load: of each no more than a peak."""
    found = [Question(key="pair.further", choices=(NO, YES), default=NO)]
    for i in range(MOST_MODES - 1):
        if answers.get(found[-1].key) != YES:
            break
        place = f"pair.modes.{i}"
        found += [
            ask(f"{place}.frequency", FREQUENCY, "110 Hz", 1.0, 2e3),
            damping_ratio(f"{place}.damping_ratio"),
        ]
        if i + 2 < MOST_MODES:
            found.append(Question(key=f"{place}.more", choices=(NO, YES), default=NO))
    return tuple(found)


def _pair_masses(answers: Answers) -> tuple[Question, Question]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    motor, load = ("2 kg m^2", "6 kg m^2") if turns else ("320 kg", "1150 kg")
    return (
        ask("pair.motor_mass", unit.mass, motor, *usual.mass, motor_turn=motor_turn(answers)),
        ask("pair.load_mass", unit.mass, load, *usual.mass),
    )


def _pair_by_frequency(answers: Answers) -> tuple[Question, Question]:
    frequency = ask("pair.frequency", FREQUENCY, "40 Hz", 1.0, 2e3)
    return frequency, _pair_stiffness(answers, is_optional=True)


def _pair_stiffness(answers: Answers, *, is_optional: bool) -> Question:
    return ask(
        "pair.stiffness",
        axis_units(answers).stiffness,
        "1 MN m/rad" if is_rotary(answers) else "16 N/um",
        *common(answers).stiffness,
        is_optional=is_optional,
    )


def _modal(answers: Answers) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    turn = motor_turn(answers)
    found = [
        *([ask(ROTOR, INERTIA, "0.005 kg m^2", 1e-6, 10.0, is_optional=True)] if turn else []),
        ask(
            "plant.moving_mass",
            unit.mass,
            "8 kg m^2" if turns else "800 kg",
            *usual.mass,
            motor_turn=turn,
        ),
    ]
    for i in range(MOST_MODES):
        found += _mode(answers, i)
        if i + 1 == MOST_MODES:
            break
        more = f"plant.modes.{i}.more"
        found.append(Question(key=more, choices=(NO, YES), default=NO))
        if answers.get(more) != YES:
            break
    return tuple(found)


def _held(answers: Answers) -> tuple[Question, ...]:
    """Modes with the motor held: no mass, and the encoder, if any, sees none of them."""
    found: list[Question] = []
    for i in range(MOST_MODES):
        place = f"plant.modes.{i}"
        found += [
            Question(key=f"{place}.name", default=f"mode{i + 1}"),
            replace(ask(f"{place}.frequency", FREQUENCY, "48 Hz", 1.0, 2e3), measured=HELD),
            damping_ratio(f"{place}.damping_ratio"),
            Question(key=f"{place}.tcp_gain", dimension=RATIO, default="1", measured=HELD),
            Question(key=f"{place}.more", choices=(NO, YES), default=NO, measured=HELD),
        ]
        if answers.get(f"{place}.more") != YES:
            break
    return tuple(found)


def _mode(answers: Answers, index: int) -> tuple[Question, ...]:
    unit, place = axis_units(answers), f"plant.modes.{index}"
    gain, mass = unit.gain, si_value(answers, "plant.moving_mass", unit.mass)
    return (
        Question(key=f"{place}.name", default=f"mode{index + 1}"),
        ask(f"{place}.frequency", FREQUENCY, "40 Hz", 1.0, 2e3),
        damping_ratio(f"{place}.damping_ratio"),
        Question(
            key=f"{place}.tcp_gain",
            dimension=gain,
            # The worst case of a tool on the far side of the mode, as identify takes it.
            default=f"{-1.0 / mass:.5g} {gain.si}" if mass and mass > 0.0 else "",
            example="0.1 1/(kg m^2)" if is_rotary(answers) else "0.002 1/kg",
        ),
        Question(key=f"{place}.measured_gain", dimension=gain, default=f"0 {gain.si}"),
    )
