"""What the wizard asks, in the order in which one finds the data at a machine.

``list_questions`` is a pure function of the answers so far: some answers open or close other
questions, and going back needs no memory but the answers.
"""

from __future__ import annotations

from mtcommission.profile.model import MOST_MOVES
from mtcommission.units.quantities import GAIN, RATIO, TIME
from mtcommission.wizard.axis_units import (
    NO,
    TOWER_BY_FREQUENCY,
    TOWER_BY_STIFFNESS,
    YES,
    ask,
    axis_units,
    common,
    is_rotary,
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

    Returns
    -------
    tuple of Question

    Examples
    --------
    >>> [question.key for question in list_questions({})][:3]
    ['machine.name', 'machine.axis', 'machine.motion']
    """
    return (
        *_machine(),
        *_drive(answers),
        *ask_mechanics(answers),
        *_moves(answers),
        *_requirements(answers),
        *_control(answers),
        *_optimal(answers),
    )


def _machine() -> tuple[Question, ...]:
    return (
        Question(
            key="machine.name",
            text="Name of the machine",
            where="The type plate; it heads the sheet.",
            default="Machine",
        ),
        Question(
            key="machine.axis",
            text="Name of the axis",
            where="The axis letter in NC programs, e.g. X, Y, Z, B, C.",
            default="X",
        ),
        Question(
            key="machine.motion",
            text="Linear or rotary axis",
            where="A rotary axis takes inertia for mass, torque for force and angles for lengths.",
            choices=("linear", "rotary"),
            default="linear",
        ),
        Question(
            key="machine.source",
            text="Where the numbers come from",
            where="E.g. data sheet and date, or measured on the machine; printed on the sheet.",
            default="entered by hand",
        ),
    )


def _drive(answers: Answers) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    force, example = ("torque", "800 N m") if turns else ("force", "2 kN")
    return (
        Question(
            key="drive.max_force",
            text=f"Largest {force} of the drive at the axis",
            where="Motor data sheet: peak torque x gear ratio."
            if turns
            else "Motor data sheet: peak force, or peak torque x 2 pi / lead x gear ratio.",
            dimension=unit.force,
            example=example,
            low=usual.force[0],
            high=usual.force[1],
        ),
        Question(
            key="drive.force_lag",
            text=f"Time constant of the {force} loop",
            where="Drive's current loop: rise time to 63 %; servo drives have 0.5 to 5 ms.",
            dimension=TIME,
            default="2 ms",
            low=1e-4,
            high=2e-2,
        ),
        Question(
            key="drive.continuous_force",
            text=f"Continuous {force} (empty: no thermal limit)",
            where="Motor data sheet: rated or stall value, the thermal (RMS) limit.",
            dimension=unit.force,
            example="400 N m" if turns else "1 kN",
            low=usual.force[0],
            high=usual.force[1],
            is_optional=True,
        ),
        Question(
            key="drive.static_load",
            text=f"Weight or process {force} that the drive holds",
            where="Swivel axis off its balance: mass x 9.81 m/s^2 x distance of the centre; else 0."
            if turns
            else "Vertical axis without full counterbalance: mass x 9.81 m/s^2; else 0.",
            dimension=unit.force,
            default=f"0 {unit.force.si}",
        ),
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
    kind = Question(
        key=f"{place}.kind",
        text=f"Kind of move {index + 1}",
        where="The limits serve all moves that you list: take the typical and the hardest.",
        choices=(POSITIONING, STEP),
        default=POSITIONING,
    )
    is_step = answers.get(kind.key) == STEP
    dwell = Question(
        key=f"{place}.dwell",
        text="Rest after it",
        where="Counts for the thermal load only.",
        dimension=TIME,
        default="0 s",
        low=0.0,
        high=3600.0,
    )
    more = Question(
        key=f"{place}.more",
        text="Another move",
        where="E.g. a short and a long one.",
        choices=(NO, YES),
        default=NO,
    )
    size = _velocity_step(answers, place) if is_step else _positioning(answers, place)
    return (kind, *size, dwell, more)


def _velocity_step(answers: Answers, place: str) -> tuple[Question]:
    return (
        ask(
            f"{place}.velocity_step",
            "Velocity at the end",
            "Feed or rapid traverse that is reached; the end position is free.",
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
            "Distance",
            "A typical step between two operations.",
            unit.length,
            "90 deg" if is_rotary(answers) else "20 mm",
            *usual.distance,
        ),
        ask(
            f"{place}.max_velocity",
            "Velocity limit (empty: none)",
            "Rapid traverse of the axis, from the control or its data sheet.",
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
    return (
        ask(
            "requirements.tcp_deviation",
            "Allowed deviation of the tool after a move",
            "Half the tolerance that you leave to vibration, not the whole tolerance of the part.",
            unit.length,
            "5 arcsec" if turns else "5 um",
            *usual.deviation,
        ),
        ask(
            "requirements.max_settling_time",
            "Longest time to settle (empty: none)",
            "Cycle time calculation: from the start of the move until the tool is quiet.",
            TIME,
            "0.2 s",
            1e-3,
            60.0,
            is_optional=True,
        ),
        Question(
            key="requirements.frequency_spread",
            text="Uncertainty of the eigenfrequencies",
            where="5 % for measured values, 10 to 20 % for calculated ones; costs some speed. "
            "With 0 % the limits fit exactly these frequencies.",
            dimension=RATIO,
            default="0 %",
            low=0.0,
            high=0.3,
        ),
        Question(
            key="requirements.damping_spread",
            text="Uncertainty of the damping ratios",
            where="Damping is rarely known to better than 30 %, but it matters little.",
            dimension=RATIO,
            default="0 %",
            low=0.0,
            high=0.8,
        ),
        Question(
            key="requirements.payload.1",
            text="Largest payload",
            where="Workpiece, pallet or tool; the limits then hold from empty to this.",
            dimension=unit.mass,
            default=f"0 {unit.mass.si}",
            low=0.0,
            high=usual.mass[1],
        ),
    )


def _control(answers: Answers) -> tuple[Question, ...]:
    return (
        Question(
            key="control.position_cycle",
            text="Cycle of the position controller",
            where="Control: interpolation or position cycle, 0.5 to 4 ms.",
            dimension=TIME,
            default="2 ms",
            low=5e-5,
            high=2e-2,
        ),
        Question(
            key="control.velocity_cycle",
            text="Cycle of the velocity controller",
            where="Drive: speed controller cycle; the position cycle is a whole multiple.",
            dimension=TIME,
            default="125 us",
            low=3e-5,
            high=5e-3,
        ),
        *_gains(answers),
        Question(
            key="control.tcp_sensor",
            text="Second encoder near the tool",
            where="A direct measuring system at the tool that the controller could use.",
            choices=("none", "position"),
            default="none",
        ),
    )


def _gains(answers: Answers) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    return (
        ask(
            "control.position_gain",
            "Position gain Kv (empty: tune it)",
            "Control: Kv factor, servo gain; (m/min)/mm or 1/s.",
            GAIN,
            "4 (m/min)/mm",
            6.0,
            1e3,
            is_optional=True,
        ),
        ask(
            "control.velocity_gain",
            "Velocity gain Kp at the axis (empty: tune it)",
            "Drive: speed controller gain, turned to the axis: x "
            + ("(gear ratio)^2." if turns else "(2 pi / lead)^2."),
            unit.damping,
            "2000 N m s/rad" if turns else "200 kN s/m",
            *usual.velocity_gain,
            is_optional=True,
        ),
        ask(
            "control.integral_time",
            "Integral time Tn (empty: tune it)",
            "Drive: reset time of the speed controller.",
            TIME,
            "20 ms",
            1e-3,
            1.0,
            is_optional=True,
        ),
    )


def _optimal(answers: Answers) -> tuple[Question, ...]:
    wanted = Question(
        key="wizard.experts",
        text="Details of the damping-optimal control",
        where="Final time and weights, as in the paper's section 6; the defaults serve well.",
        choices=(NO, YES),
        default=NO,
    )
    if answers.get("wizard.experts") != YES:
        return (wanted,)
    final = ask(
        "damping_optimal.t_f",
        "Its final time (empty: by rule)",
        "At least the time-optimal one.",
        TIME,
        "52.2 ms",
        1e-3,
        60.0,
        is_optional=True,
    )
    if answers.get("wizard.way") not in (TOWER_BY_STIFFNESS, TOWER_BY_FREQUENCY):
        return (wanted, final)
    weights = tuple(
        Question(
            key=f"damping_optimal.weights.{state}",
            text=f"Weight of {state} squared (empty: balanced)",
            where="Of the paper's eq. (17), in N^2 per squared SI unit of the state.",
            example="1e15",
            is_optional=True,
        )
        for state in ("x_b", "phi", "v_b", "v_phi")
    )
    return (wanted, final, *weights)
