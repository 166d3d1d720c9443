"""What the wizard asks, in the order in which one finds the data at a machine.

``list_questions`` is a pure function of the answers so far: some answers open or close other
questions, and going back needs no memory but the answers.
"""

from __future__ import annotations

from mtcommission.control_kinds.kind import ControlKind
from mtcommission.control_kinds.kinds import GENERIC, KINDS
from mtcommission.machine.machine import MOST_MOVES
from mtcommission.units.quantities import GAIN, RATIO, TIME
from mtcommission.wizard.axis_units import (
    MEASURED,
    NO,
    SERVO,
    SOURCE,
    TOWERS,
    UNKNOWN,
    YES,
    ask,
    axis_units,
    common,
    follows,
    is_rotary,
    motor_turn,
)
from mtcommission.wizard.mechanics import ask_mechanics
from mtcommission.wizard.question import Answers, Question

POSITIONING, STEP = "positioning from rest to rest", "acceleration to a velocity"


def list_questions(answers: Answers) -> tuple[Question, ...]:
    """Return every question that applies, in order.

    Parameters
    ----------
    answers
        What is known so far.

    Examples
    --------
    >>> [question.key for question in list_questions({})][:3]
    ['wizard.measured', 'machine.name', 'machine.axis']
    """
    return (
        Question(key=MEASURED, is_optional=True),
        *_machine(),
        *_drive(answers),
        *ask_mechanics(answers),
        *_moves(answers),
        *_requirements(answers),
        *_control(answers),
        *_today(answers),
        *_optimal(answers),
    )


FOR_STEPS = "klipper"
"""Kind of control that is proposed where the motor follows: its shapers are made for that."""


def _machine() -> tuple[Question, ...]:
    return (
        Question(key="machine.name", default="Machine"),
        Question(key="machine.axis", default="X"),
        Question(key="machine.motion", choices=("linear", "rotary"), default="linear"),
        Question(key="machine.source", default="entered by hand"),
    )


def _drive(answers: Answers) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    kind = Question(key="drive.kind", choices=(SERVO, SOURCE), default=SERVO)
    turn = motor_turn(answers)
    if follows(answers):
        acceleration, velocity = ("100 rad/s^2", "10 rad/s") if turns else ("10 m/s^2", "0.5 m/s")
        return (
            kind,
            ask("drive.max_acceleration", unit.acceleration, acceleration, *usual.acceleration),
            ask("drive.max_velocity", unit.velocity, velocity, *usual.velocity, is_optional=True),
        )
    return (
        kind,
        *_drive_train(answers),
        ask(
            "drive.max_force",
            unit.force,
            "800 N m" if turns else "2 kN",
            *usual.force,
            motor_turn=turn,
        ),
        Question(key="drive.force_lag", dimension=TIME, default="2 ms", low=1e-4, high=2e-2),
        ask(
            "drive.continuous_force",
            unit.force,
            "400 N m" if turns else "1 kN",
            *usual.force,
            is_optional=True,
            motor_turn=turn,
        ),
        Question(key="drive.static_load", dimension=unit.force, default=f"0 {unit.force.si}"),
    )


def _moves(answers: Answers) -> tuple[Question, ...]:
    found: list[Question] = []
    for i in range(MOST_MOVES):
        found += _move(answers, i)
        if answers.get(f"moves.{i}.more") != YES:
            break
    return tuple(found)


def _move(answers: Answers, index: int) -> tuple[Question, ...]:
    place = f"moves.{index}"
    kind = Question(key=f"{place}.kind", choices=(POSITIONING, STEP), default=POSITIONING)
    is_step = answers.get(kind.key) == STEP
    dwell = Question(key=f"{place}.dwell", dimension=TIME, default="0 s", low=0.0, high=3600.0)
    more = Question(key=f"{place}.more", choices=(NO, YES), default=NO)
    size = _velocity_step(answers, place) if is_step else _positioning(answers, place)
    heats = bool(answers.get("drive.continuous_force")) and not follows(answers)
    return (kind, *size, *((dwell,) if heats else ()), more)


def _velocity_step(answers: Answers, place: str) -> tuple[Question]:
    return (
        ask(
            f"{place}.velocity_step",
            axis_units(answers).velocity,
            _example_velocity(answers),
            *common(answers).velocity,
        ),
    )


def _positioning(answers: Answers, place: str) -> tuple[Question, Question]:
    unit, usual = axis_units(answers), common(answers)
    return (
        ask(
            f"{place}.distance",
            unit.length,
            "90 deg" if is_rotary(answers) else "20 mm",
            *usual.distance,
        ),
        ask(
            f"{place}.max_velocity",
            unit.velocity,
            _example_velocity(answers),
            *usual.velocity,
            is_optional=True,
        ),
    )


def _example_velocity(answers: Answers) -> str:
    return "60 rev/min" if is_rotary(answers) else "30 m/min"


def _requirements(answers: Answers) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    payload = Question(
        key="requirements.payload.1",
        dimension=unit.mass,
        default=f"0 {unit.mass.si}",
        low=0.0,
        high=usual.mass[1],
    )
    return (
        ask(
            "requirements.tcp_deviation",
            unit.length,
            "5 arcsec" if turns else "5 um",
            *usual.deviation,
        ),
        ask("requirements.max_settling_time", TIME, "0.2 s", 1e-3, 60.0, is_optional=True),
        Question(
            key="requirements.frequency_spread", dimension=RATIO, default="5 %", low=0.0, high=0.3
        ),
        Question(
            key="requirements.damping_spread", dimension=RATIO, default="30 %", low=0.0, high=0.8
        ),
        *(() if follows(answers) else (payload,)),
        *_contour(answers),
    )


def _contour(answers: Answers) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    deviation = ask(
        "requirements.contour_deviation",
        unit.length,
        "20 arcsec" if turns else "20 um",
        *usual.deviation,
        is_optional=True,
    )
    if not answers.get(deviation.key):
        return (deviation,)
    example = "10 rev/min" if turns else "2 m/min"
    feed = ask(
        "requirements.contour_feed", unit.velocity, example, *usual.velocity, is_optional=True
    )
    return (deviation, feed)


def _control(answers: Answers) -> tuple[Question, ...]:
    kind = KINDS.get(answers.get("control.kind", ""), GENERIC)
    position, velocity = f"{1e3 * kind.position_cycle:g} ms", f"{1e6 * kind.velocity_cycle:g} us"
    feeds_states_back = (
        Question(key="control.state_feedback", choices=("auto", "off"), default="auto"),
        Question(key="control.tcp_sensor", choices=("none", "position"), default="none"),
    )
    if follows(answers):
        return (Question(key="control.kind", choices=tuple(KINDS), default=FOR_STEPS),)
    gains_of_states = any(key.startswith("control.state_feedback.") for key in answers)
    return (
        Question(key="control.kind", choices=tuple(KINDS), default=GENERIC.key),
        *_position_loop(kind),
        Question(
            key="control.position_cycle", dimension=TIME, default=position, low=5e-5, high=0.02
        ),
        Question(
            key="control.velocity_cycle", dimension=TIME, default=velocity, low=3e-5, high=5e-3
        ),
        _resolution(answers),
        *_gains(answers, "control"),
        *(feeds_states_back[gains_of_states:] if kind.state_feedback else ()),
    )


def _position_loop(kind: ControlKind) -> tuple[Question, ...]:
    """Where the position loop closes, where that can be chosen; unknown, it stays an assumption."""
    loops = [loop.value for loop in kind.position_loops]
    if len(loops) < 2:
        return ()
    return (Question(key="control.position_loop", choices=(UNKNOWN, *loops), default=UNKNOWN),)


def _drive_train(answers: Answers) -> tuple[Question, ...]:
    """What turns values at the motor into those at the axis: first of all that needs it."""
    unit, turns = axis_units(answers), is_rotary(answers)
    lead = ask("drive.lead", unit.length, "10 mm", 1e-4, 1.0, is_optional=True)
    gear = Question(key="drive.gear", dimension=RATIO, default="1", low=0.01, high=1e3)
    has_gear = turns or bool(answers.get(lead.key))
    return (*(() if turns else (lead,)), *((gear,) if has_gear else ()))


def _resolution(answers: Answers) -> Question:
    return ask(
        "drive.encoder_resolution",
        axis_units(answers).length,
        "0.1 arcsec" if is_rotary(answers) else "0.1 um",
        1e-11,
        1e-4,
        is_optional=True,
    )


def _gains(answers: Answers, table: str) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    return (
        ask(f"{table}.position_gain", GAIN, "4 (m/min)/mm", 6.0, 1e3, is_optional=True),
        ask(
            f"{table}.velocity_gain",
            unit.damping,
            "2000 N m s/rad" if turns else "200 kN s/m",
            *usual.velocity_gain,
            is_optional=True,
        ),
        ask(f"{table}.integral_time", TIME, "20 ms", 1e-3, 1.0, is_optional=True),
    )


def _today(answers: Answers) -> tuple[Question, ...]:
    """What the control holds now; the rest is only asked for where there is an acceleration."""
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    acceleration = ask(
        "today.acceleration",
        unit.acceleration,
        "20 rad/s^2" if turns else "2 m/s^2",
        *usual.acceleration,
        is_optional=True,
    )
    if not answers.get(acceleration.key):
        return (acceleration,)
    example = "400 rad/s^3" if turns else "40 m/s^3"
    jerk = ask("today.jerk", unit.jerk, example, *usual.jerk, is_optional=True)
    has_jerk = KINDS.get(answers.get("control.kind", ""), GENERIC).has_jerk_limit
    gains = () if follows(answers) else _gains(answers, "today")
    return (acceleration, *((jerk,) if has_jerk else ()), *gains)


def _optimal(answers: Answers) -> tuple[Question, ...]:
    wanted = Question(key="wizard.experts", choices=(NO, YES), default=NO)
    if answers.get("wizard.experts") != YES:
        return (wanted,)
    final = ask("damping_optimal.t_f", TIME, "52.2 ms", 1e-3, 60.0, is_optional=True)
    if answers.get("wizard.way") not in TOWERS:
        return (wanted, final)
    weights = tuple(
        Question(key=f"damping_optimal.weights.{state}", example="1e15", is_optional=True)
        for state in ("x_b", "phi", "v_b", "v_phi")
    )
    return (wanted, final, *weights)
