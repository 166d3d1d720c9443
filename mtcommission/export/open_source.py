"""Open controls and firmware: LinuxCNC, grblHAL, FluidNC, Klipper, Marlin, ROS 2."""

from __future__ import annotations

from functools import partial
from math import sqrt

from mtcommission.control_kinds.open_source import KLIPPER_SHAPERS, MARLIN_SHAPERS
from mtcommission.errors import Fault, InputError
from mtcommission.export.choose import Chosen
from mtcommission.export.control import Control
from mtcommission.export.held import read_limits, write_filter
from mtcommission.export.layout import CONFIG, G_CODE, INI, MACHINE_DATA, YAML
from mtcommission.export.plc import identifier
from mtcommission.export.row import Row, Setting, Values, fixed
from mtcommission.export.subject import Subject
from mtcommission.export.wording import MILLI
from mtcommission.limits.corner_velocity import find_corner_velocity
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message

LETTERS = "XYZABCUVW"
"""Axis letters in the order in which these controls number them."""

NANO = 1e-9

LEAST_DAMPING, MOST_DAMPING = 0.01, 0.25
"""What Marlin accepts as the damping ratio of a shaper."""

FREQUENCY_STEP, DAMPING_STEP = 0.01, 0.001
"""Decimals of a shaper's frequency [Hz] and damping ratio; Klipper and Marlin print as many."""


USUAL_CORNER = 5e-3
"""square_corner_velocity that Klipper takes unless told otherwise [m/s] (Config_Reference)."""

JUNCTION_DEVIATIONS = (1e-5, 3e-4)
"""What Marlin takes as M205 J [m]; it refuses any other and keeps the old one
(M200-M205.cpp at 5ec63799)."""

WHOLE = 0.999
"""Share of the recommended acceleration that is all of it, but for rounding."""


def _letter(subject: Subject, allowed: str, control: str) -> str:
    """The axis letter, or an error that says which letters the control has."""
    letter = subject.axis[:1].upper()
    if letter not in tuple(allowed):
        message = Message(
            "export-other-letter", control=control, letters=tuple(allowed), axis_name=subject.axis
        )
        raise InputError([Fault(where="--control", message=message)])
    return letter


def _require_linear(subject: Subject, control: str) -> None:
    if subject.is_rotary:
        message = Message("export-linear-only", control=control)
        raise InputError([Fault(where="--control", message=message)])


def _acceleration(
    subject: Subject, name: str, meaning: Message | None = None, *, section: str = ""
) -> Row:
    length, size = subject.small_unit
    return Row(
        Setting.ACCELERATION,
        name,
        unit=f"{length}/s^2",
        scale=size,
        meaning=meaning,
        section=section,
    )


def _jerk(subject: Subject, name: str, meaning: Message, *, section: str = "") -> Row:
    length, size = subject.small_unit
    return Row(
        Setting.JERK, name, unit=f"{length}/s^3", scale=size, meaning=meaning, section=section
    )


def _shapers(subject: Subject, kinds: tuple[str, ...]) -> tuple[SetpointFilter, ...]:
    """The run's own shaper, or zero-vibration shapers on the mode that a setpoint excites most."""
    if subject.setpoint_filter:
        return (subject.setpoint_filter,)
    mode = subject.mode
    damping = min(max(LEAST_DAMPING, mode.damping_ratio), MOST_DAMPING)
    return tuple(
        SetpointFilter(kind=kind, frequency_hz=mode.frequency_hz, damping_ratio=damping)
        for kind in kinds
    )


def _write_shapers(subject: Subject, kinds: tuple[str, ...]) -> tuple[Values, ...]:
    return tuple(map(write_filter, _shapers(subject, kinds)))


KLIPPER_USUAL, MARLIN_USUAL = ("zv", "zvd"), ("marlin_zv", "marlin_zvd")
"""Shapers that are tried where the run's filter is none of the control's."""


def _linuxcnc(subject: Subject, loop: Values) -> list[Row]:
    letter = _letter(subject, LETTERS, "LinuxCNC")
    joint = f"JOINT_{LETTERS.index(letter)}"
    rows = [fixed("PLANNER_TYPE", "1", Message("linuxcnc-planner"), section="TRAJ")]
    if not subject.is_rotary:
        ceiling = Message("linuxcnc-path-acceleration")
        path = Message("linuxcnc-path-jerk")
        rows += [
            _acceleration(subject, "MAX_LINEAR_ACCELERATION", ceiling, section="TRAJ"),
            _jerk(subject, "MAX_LINEAR_JERK", path, section="TRAJ"),
        ]
    rows.append(
        Row(Setting.POSITION_CYCLE, "SERVO_PERIOD", unit="ns", scale=NANO, step=1, section="EMCMOT")
    )
    for section in (joint, f"AXIS_{letter}"):
        rows.append(_acceleration(subject, "MAX_ACCELERATION", section=section))
        rows.append(_jerk(subject, "MAX_JERK", Message("linuxcnc-jerk"), section=section))
    if loop[Setting.POSITION_LOOP, ""] == "control":
        rows.append(
            Row(
                Setting.POSITION_GAIN,
                "P",
                unit="1/s",
                meaning=Message("linuxcnc-gain"),
                section=joint,
            )
        )
        rows.append(Row(Setting.VELOCITY_FEEDFORWARD, "FF1", section=joint))
    return rows


def _linuxcnc_notes(_subject: Subject, _chosen: Chosen) -> tuple[Message, ...]:
    return (Message("linuxcnc-units"), Message("linuxcnc-joints"), Message("linuxcnc-least-jerk"))


def _grblhal(subject: Subject, _loop: Values) -> list[Row]:
    index = LETTERS.index(_letter(subject, LETTERS[:6], "grblHAL"))
    return [
        _acceleration(subject, f"${120 + index}"),
        _jerk(subject, f"${800 + index}", Message("limit-jerk")),
    ]


def _grblhal_notes(_subject: Subject, _chosen: Chosen) -> tuple[Message, ...]:
    return (Message("grblhal-builds"), Message("grblhal-corners"), Message("export-segments"))


def _fluidnc(subject: Subject, _loop: Values) -> list[Row]:
    letter = _letter(subject, LETTERS[:6], "FluidNC").lower()
    return [_acceleration(subject, "acceleration_mm_per_sec2", section=f"axes/{letter}")]


def _fluidnc_notes(subject: Subject, chosen: Chosen) -> tuple[Message, ...]:
    return (
        Message("fluidnc-no-jerk"),
        *_make_up(subject, chosen),
        Message("export-segments"),
        *((Message("fluidnc-degrees"),) if subject.is_rotary else ()),
    )


def _of_mode(subject: Subject) -> Message:
    """Where frequency and damping of the shaper come from."""
    if subject.setpoint_filter:
        return Message("shaper-of-run")
    return Message("klipper-of-mode", mode=subject.mode.name)


def _written(subject: Subject) -> float:
    """What the control is to get at most of the recommended acceleration [m/s²]."""
    return min(subject.limits.acceleration, subject.kind.largest_acceleration)


def _make_up(subject: Subject, chosen: Chosen) -> tuple[Message, ...]:
    """What the acceleration had to give for the missing jerk limit; nothing if it gave none."""
    a = read_limits(chosen.values).acceleration
    share = a / subject.limits.acceleration
    shaper = "yes" if (Setting.SHAPER, "") in chosen.values else "no"
    if not chosen.verdict.assessment.is_met:
        return (Message("export-least-vibration", share=share, shaper=shaper),)
    if a > WHOLE * _written(subject):
        return ()
    return (Message("export-share-of-acceleration", share=share, shaper=shaper),)


def _most_at_corner(subject: Subject, kinds: tuple[str, ...]) -> float:
    """The step of velocity that keeps the band behind whichever shaper is written [m/s]."""
    return min(find_corner_velocity(subject.machine, one) for one in _shapers(subject, kinds))


def _of_corner(
    subject: Subject, kind: str, kinds: tuple[str, ...], **values: float
) -> tuple[Message, ...]:
    """What the model says of the corner, and what it does not."""
    if not subject.machine.drive.follows:
        return ()
    most = _most_at_corner(subject, kinds)
    return (Message(kind, usual=1e3 * USUAL_CORNER, most=1e3 * most, **values),)


def _klipper(subject: Subject, _loop: Values) -> list[Row]:
    _require_linear(subject, "Klipper")
    letter = _letter(subject, "XYZ", "Klipper").lower()
    row = partial(Row, section="input_shaper", is_verified=letter != "z")
    of_mode = _of_mode(subject)
    return [
        Row(
            Setting.ACCELERATION,
            "max_accel",
            unit="mm/s^2",
            scale=MILLI,
            meaning=Message("klipper-tool-head"),
            section="printer",
        ),
        *_klipper_corner(subject),
        row(
            Setting.SHAPER,
            f"shaper_type_{letter}",
            codes=dict(zip(KLIPPER_SHAPERS, KLIPPER_SHAPERS, strict=True)),
        ),
        row(
            Setting.SHAPER_FREQUENCY,
            f"shaper_freq_{letter}",
            unit="Hz",
            step=FREQUENCY_STEP,
            meaning=of_mode,
        ),
        row(Setting.SHAPER_DAMPING, f"damping_ratio_{letter}", step=DAMPING_STEP, meaning=of_mode),
    ]


def _klipper_corner(subject: Subject) -> list[Row]:
    """Klipper's default, or less where that leaves the band."""
    if not subject.machine.drive.follows:
        return []
    corner = f"{1e3 * min(_most_at_corner(subject, KLIPPER_USUAL), USUAL_CORNER):.3g}"
    said = Message("klipper-corner")
    return [fixed("square_corner_velocity", corner, said, unit="mm/s", section="printer")]


def _klipper_notes(subject: Subject, chosen: Chosen) -> tuple[Message, ...]:
    return (
        Message("klipper-no-jerk"),
        *_make_up(subject, chosen),
        *_of_corner(subject, "klipper-corner-bound", KLIPPER_USUAL),
        Message("klipper-cruise"),
        Message("klipper-shaper"),
        *(
            (Message("klipper-three-humps"),)
            if chosen.values.get((Setting.SHAPER, "")) == "3hump_ei"
            else ()
        ),
    )


def _marlin(subject: Subject, _loop: Values) -> list[Row]:
    _require_linear(subject, "Marlin")
    letter = _letter(subject, "XYZ", "Marlin")
    of_mode = _of_mode(subject)
    return [
        _acceleration(subject, f"M201 {letter}"),
        *_marlin_corner(subject, letter),
        fixed("M493 S", "1", Message("marlin-fixed-time")),
        Row(
            Setting.SHAPER,
            f"M493 {letter} C",
            codes={kind: MARLIN_SHAPERS[kind] for kind in MARLIN_SHAPERS},
            meaning=Message("marlin-shaper"),
        ),
        Row(
            Setting.SHAPER_FREQUENCY,
            f"M493 {letter} A",
            unit="Hz",
            step=FREQUENCY_STEP,
            meaning=of_mode,
        ),
        Row(Setting.SHAPER_DAMPING, f"M493 {letter} I", step=DAMPING_STEP, meaning=of_mode),
    ]


def _marlin_corner(subject: Subject, letter: str) -> list[Row]:
    """By junction deviation; by the step of velocity where J would be below what M205 takes."""
    if not subject.machine.drive.follows:
        return []
    if deviation := _junction_deviation(subject):
        said = Message("marlin-corner")
        return [fixed("M205 J", f"{1e3 * deviation:.3g}", said, unit="mm")]
    corner, said = min(_most_at_corner(subject, MARLIN_USUAL), USUAL_CORNER), Message("marlin-step")
    return [fixed(f"M205 {letter}", f"{1e3 * corner:.3g}", said, unit="mm/s")]


def _junction_deviation(subject: Subject) -> float:
    """J = v² (sqrt(2) - 1)/a of a right angle that keeps the band [m]; 0: below what M205 takes."""

    def deviation(velocity: float) -> float:
        return velocity**2 * (sqrt(2.0) - 1.0) / _written(subject)

    least, most = JUNCTION_DEVIATIONS
    if deviation(_most_at_corner(subject, MARLIN_USUAL)) < least:
        return 0.0
    return min(max(least, deviation(USUAL_CORNER)), most)


def _marlin_notes(subject: Subject, chosen: Chosen) -> tuple[Message, ...]:
    least, _ = JUNCTION_DEVIATIONS
    by_least = sqrt(least * _written(subject) / (sqrt(2.0) - 1.0))
    fits = subject.machine.drive.follows and _junction_deviation(subject)
    bound = "marlin-corner-bound" if fits else "marlin-step-bound"
    return (
        Message("marlin-jerk"),
        *_make_up(subject, chosen),
        *_of_corner(subject, bound, MARLIN_USUAL, least=1e3 * by_least),
        Message("marlin-build"),
        Message("marlin-grid"),
    )


def _ros(subject: Subject, loop: Values) -> list[Row]:
    name, units = identifier(subject), subject.machine.axis_units
    limits, gains = (
        f"joint_limits/{name}",
        f"joint_trajectory_controller/ros__parameters/gains/{name}",
    )
    rows = [
        fixed("has_acceleration_limits", "true", section=limits),
        Row(Setting.ACCELERATION, "max_acceleration", unit=units.acceleration.si, section=limits),
        fixed("has_jerk_limits", "true", section=limits),
        Row(Setting.JERK, "max_jerk", unit=units.jerk.si, section=limits),
    ]
    if loop[Setting.POSITION_LOOP, ""] == "drive":
        return rows
    return [
        *rows,
        Row(Setting.POSITION_GAIN, "p", unit="1/s", meaning=Message("ros-gain"), section=gains),
        Row(Setting.VELOCITY_FEEDFORWARD, "ff_velocity_scale", section=gains),
    ]


OPEN_CONTROLS = (
    Control(key="linuxcnc", rows=_linuxcnc, layout=INI, notes=_linuxcnc_notes),
    Control(
        key="klipper",
        rows=_klipper,
        layout=CONFIG,
        shapers=partial(_write_shapers, kinds=KLIPPER_USUAL),
        notes=_klipper_notes,
    ),
    Control(key="grblhal", rows=_grblhal, layout=MACHINE_DATA, notes=_grblhal_notes),
    Control(key="fluidnc", rows=_fluidnc, layout=YAML, notes=_fluidnc_notes),
    Control(
        key="marlin",
        rows=_marlin,
        layout=G_CODE,
        shapers=partial(_write_shapers, kinds=MARLIN_USUAL),
        notes=_marlin_notes,
    ),
    Control(key="ros2", rows=_ros, layout=YAML, in_degrees=False),
)
