"""The questions about the mechanics, one set for each way into them."""

from __future__ import annotations

from mtcommission.plant.modal import MOST_MODES
from mtcommission.units.quantities import (
    DAMPING,
    FREQUENCY,
    INERTIA,
    LENGTH,
    MASS,
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
    WAYS,
    YES,
    ask,
    axis_units,
    common,
    damping_ratio,
    is_rotary,
)
from mtcommission.wizard.question import Answers, Question


def ask_mechanics(answers: Answers) -> tuple[Question, ...]:
    """Return the questions for the way that was chosen; first the choice itself."""
    ways = WAYS[2:] if is_rotary(answers) else WAYS
    way = Question(
        key="wizard.way",
        text="Known of the mechanics",
        where="Tower: slider with a tool column on a base that gives way (the paper's machine). "
        "Motor and load: two masses with a spring. Bode plot: mode by mode.",
        choices=ways,
        default=ways[0],
    )
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
    sheet = "Weights of the parts list or CAD."
    return (
        ask("plant.base_mass", "Mass of the base", sheet, MASS, "450 kg", 1.0, 1e5),
        ask("plant.slider_mass", "Mass of the slider", sheet, MASS, "750 kg", 0.1, 1e5),
        ask(
            "plant.rotary_inertia",
            "Inertia of the tower about its joint",
            "CAD; or from the measured tilting frequency and the rotary stiffness.",
            INERTIA,
            "40 kg m^2",
            1e-3,
            1e5,
        ),
        ask(
            "plant.lever_arm",
            "Height from the joint to the drive force",
            "Drawing: line of motor or ball screw against the guideways.",
            LENGTH,
            "0.25 m",
            -2.0,
            2.0,
        ),
        ask(
            "plant.tcp_height",
            "Height of the tool above the joint, signed",
            "Drawing; negative if the tower tilts backwards when it is pushed forwards.",
            LENGTH,
            "0.21 m",
            -5.0,
            5.0,
        ),
    )


def _tower_stiffness() -> tuple[Question, ...]:
    bode = "Data sheet of mounts and guideways, or from a measurement: k = m (2 pi f)^2."
    width = "d = 2 x damping ratio x sqrt(k m); ratios of 0.02 to 0.05 are common."
    return (
        ask(
            "plant.base_stiffness",
            "Stiffness of the base",
            bode,
            STIFFNESS,
            "44.41 N/um",
            1e4,
            1e10,
        ),
        ask("plant.base_damping", "Damping of the base", width, DAMPING, "8500 N s/m", 0.0, 1e7),
        ask(
            "plant.rotary_stiffness",
            "Rotary stiffness of the tower",
            bode.replace("m (", "J ("),
            ROTARY_STIFFNESS,
            "8.2e6 N m/rad",
            1e2,
            1e11,
        ),
        ask(
            "plant.rotary_damping",
            "Rotary damping of the tower",
            width.replace("k m", "k J"),
            ROTARY_DAMPING,
            "1800 N m s/rad",
            0.0,
            1e8,
        ),
    )


PEAK = "Frequency response from force to acceleration, or a tap with an accelerometer: the peak."
CHECK = "Only to check it against the frequency; leave empty if unknown."


def _tower_frequencies() -> tuple[Question, ...]:
    return (
        ask(
            "measured.base_frequency",
            "Eigenfrequency of the base",
            PEAK,
            FREQUENCY,
            "50 Hz",
            1.0,
            1e3,
        ),
        damping_ratio("measured.base_damping_ratio", "the base"),
        ask(
            "measured.base_stiffness",
            "Stiffness of the base (empty: unknown)",
            CHECK,
            STIFFNESS,
            "44.41 N/um",
            1e4,
            1e10,
            is_optional=True,
        ),
        ask(
            "measured.rotary_frequency",
            "Eigenfrequency of the tower",
            PEAK,
            FREQUENCY,
            "72 Hz",
            1.0,
            1e3,
        ),
        damping_ratio("measured.rotary_damping_ratio", "the tower"),
        ask(
            "measured.rotary_stiffness",
            "Rotary stiffness of the tower (empty: unknown)",
            CHECK,
            ROTARY_STIFFNESS,
            "8.2e6 N m/rad",
            1e2,
            1e11,
            is_optional=True,
        ),
    )


def _pair(answers: Answers, *, by_stiffness: bool) -> tuple[Question, ...]:
    tail = damping_ratio("pair.damping_ratio", "the load against the held motor")
    spring = _pair_by_stiffness(answers) if by_stiffness else _pair_by_frequency(answers)
    return (*_pair_masses(answers), *spring, tail)


def _pair_masses(answers: Answers) -> tuple[Question, Question]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    mass, motor, load = (
        ("Inertia", "2 kg m^2", "6 kg m^2") if turns else ("Mass", "320 kg", "1150 kg")
    )
    return (
        ask(
            "pair.motor_mass",
            f"{mass} on the motor's side, seen at the axis",
            "Rotor and gearbox: inertia x (gear ratio)^2."
            if turns
            else "Rotor, screw, gearbox: inertia x (2 pi / lead)^2; moving part of a linear motor.",
            unit.mass,
            motor,
            *usual.mass,
        ),
        ask(
            "pair.load_mass",
            f"{mass} on the tool's side of the spring",
            "Table or head with everything that it carries."
            if turns
            else "Table, gantry or head with everything that it carries.",
            unit.mass,
            load,
            *usual.mass,
        ),
    )


def _pair_by_stiffness(answers: Answers) -> tuple[Question]:
    where = (
        "Gear or worm, shaft in torsion, coupling in series, at the axis: data sheets."
        if is_rotary(answers)
        else "Screw, nut and bearings in series, belt, rack, coupling: data sheets."
    )
    return (_pair_stiffness(answers, "Stiffness between the two", where, is_optional=False),)


def _pair_by_frequency(answers: Answers) -> tuple[Question, Question]:
    frequency = ask(
        "pair.frequency",
        "Eigenfrequency of the load while the motor holds",
        "Brake or position loop on, tap the load; in a Bode plot of the motor the antiresonance.",
        FREQUENCY,
        "40 Hz",
        1.0,
        2e3,
    )
    text = "Stiffness between the two (empty: unknown)"
    return frequency, _pair_stiffness(answers, text, CHECK, is_optional=True)


def _pair_stiffness(answers: Answers, text: str, where: str, *, is_optional: bool) -> Question:
    return ask(
        "pair.stiffness",
        text,
        where,
        axis_units(answers).stiffness,
        "1 MN m/rad" if is_rotary(answers) else "16 N/um",
        *common(answers).stiffness,
        is_optional=is_optional,
    )


def _modal(answers: Answers) -> tuple[Question, ...]:
    unit, usual, turns = axis_units(answers), common(answers), is_rotary(answers)
    found = [
        ask(
            "plant.moving_mass",
            "Whole rigid inertia" if turns else "Whole rigid mass",
            "Torque over angular acceleration at low frequencies."
            if turns
            else "Force over acceleration at low frequencies.",
            unit.mass,
            "8 kg m^2" if turns else "800 kg",
            *usual.mass,
        ),
    ]
    for i in range(MOST_MODES):
        found += _mode(answers, i)
        if i + 1 == MOST_MODES:
            break
        more = f"plant.modes.{i}.more"
        found.append(
            Question(
                key=more,
                text="Another mode",
                where="Up to eight; those above the bandwidth of the loop hardly matter.",
                choices=(NO, YES),
                default=NO,
            )
        )
        if answers.get(more) != YES:
            break
    return tuple(found)


def _mode(answers: Answers, index: int) -> tuple[Question, ...]:
    gain, place = axis_units(answers).gain, f"plant.modes.{index}"
    return (
        Question(
            key=f"{place}.name",
            text=f"Name of mode {index + 1}",
            where="What moves: column, ram, table, ...; letters, digits and _.",
            default=f"mode{index + 1}",
        ),
        ask(f"{place}.frequency", "Its eigenfrequency", PEAK, FREQUENCY, "40 Hz", 1.0, 2e3),
        damping_ratio(f"{place}.damping_ratio", "this mode"),
        Question(
            key=f"{place}.tcp_gain",
            text="Its share in the tool position, signed",
            where="Residue of the frequency response force to tool; 1/modal mass for the "
            "mode shape 1 at force and tool.",
            dimension=gain,
            example="0.1 1/(kg m^2)" if is_rotary(answers) else "0.002 1/kg",
        ),
        Question(
            key=f"{place}.measured_gain",
            text="Its share in the encoder position, signed",
            where="The same from force to encoder; 0 if the encoder does not see the mode.",
            dimension=gain,
            default=f"0 {gain.si}",
        ),
    )
