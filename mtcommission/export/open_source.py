"""Open controls and firmware: LinuxCNC, grblHAL, FluidNC, Klipper, Marlin, ROS 2."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from mtcommission.errors import Fault, InputError
from mtcommission.export.control import (
    Control,
    Entry,
    hash_comment,
    ini_layout,
    line_layout,
    semicolon_comment,
    unverified,
    yaml_layout,
)
from mtcommission.export.modes import Values
from mtcommission.export.plc import identifier, si_coding
from mtcommission.export.rounding import Coding, JerkForm, Typed
from mtcommission.export.shaping import TypedShaper
from mtcommission.export.subject import Subject
from mtcommission.export.wording import MILLI
from mtcommission.messages.message import Message

LETTERS = "XYZABCUVW"
"""Axis letters in the order in which these controls number them."""

FREQUENCY_DIGITS, DAMPING_DIGITS = 2, 3
"""Decimals of a shaper's frequency [Hz] and damping ratio; Klipper and Marlin print as many."""

LEAST_DAMPING = 0.01
"""Smallest damping ratio that Marlin accepts."""


def _letter(subject: Subject, allowed: str, control: str) -> str:
    """The axis letter, or an error that says which letters the control has."""
    letter = subject.axis[:1].upper()
    if letter not in tuple(allowed):
        message = (
            f"{control} names its axes {', '.join(allowed)}; this record is of axis "
            f'"{subject.axis}": begin machine.axis with one of these letters, or use '
            "--control generic"
        )
        raise InputError([Fault(where="--control", message=Message("verbatim", text=message))])
    return letter


def _require_linear(subject: Subject, control: str) -> None:
    if subject.is_rotary:
        message = f"{control} limits linear axes only, this one is rotary; use --control generic"
        raise InputError([Fault(where="--control", message=Message("verbatim", text=message))])


def _jerk_coding(subject: Subject) -> Coding:
    size = subject.small_unit[1]
    return Coding(acceleration_unit=size, jerk_unit=size)


def _plain_coding(subject: Subject) -> Coding:
    return Coding(acceleration_unit=subject.small_unit[1], jerk_form=JerkForm.NONE)


def _shaped_coding(subject: Subject, *, control: str) -> Coding:
    _require_linear(subject, control)
    mode = subject.mode
    shapers = tuple(
        TypedShaper(
            order=order,
            frequency_hz=round(mode.frequency_hz, FREQUENCY_DIGITS),
            damping_ratio=max(LEAST_DAMPING, round(mode.damping_ratio, DAMPING_DIGITS)),
        )
        for order in (1, 2)
    )
    return Coding(acceleration_unit=MILLI, jerk_form=JerkForm.NONE, shapers=shapers)


def _linuxcnc_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    letter = _letter(subject, LETTERS, "LinuxCNC")
    unit = subject.small_unit[0]
    joint = f"JOINT_{LETTERS.index(letter)}"
    limits = tuple(
        Entry(name=name, value=value, unit=power, meaning=meaning, section=section)
        for section in (joint, f"AXIS_{letter}")
        for name, value, power, meaning in (
            ("MAX_ACCELERATION", typed.acceleration, f"{unit}/s^2", "acceleration"),
            ("MAX_JERK", typed.jerk, f"{unit}/s^3", "jerk; 0 would switch the limit off"),
        )
    )
    planner = Entry(
        name="PLANNER_TYPE", value="1", unit="", meaning="jerk-limited planner", section="TRAJ"
    )
    if subject.is_rotary:
        return (planner, *limits)
    path = Entry(
        name="MAX_LINEAR_JERK",
        value=typed.jerk,
        unit="mm/s^3",
        meaning="path jerk: the least of all linear axes",
        section="TRAJ",
    )
    return (planner, path, *limits)


def _linuxcnc_notes(_subject: Subject, _values: Values) -> tuple[str, ...]:
    return (
        "For LinuxCNC 2.10 and newer; machine units are taken to be mm and degrees.",
        "Joint numbers assume trivial kinematics: X Y Z A B C U V W are joints 0 to 8.",
        "MAX_LINEAR_JERK below 1 silently falls back to trapezoids. Home with PLANNER_TYPE = 0.",
    )


def _grblhal_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    index = LETTERS.index(_letter(subject, LETTERS[:6], "grblHAL"))
    unit = subject.small_unit[0]
    return (
        Entry(
            name=f"${120 + index}",
            value=typed.acceleration,
            unit=f"{unit}/s^2",
            meaning="acceleration",
        ),
        Entry(name=f"${800 + index}", value=typed.jerk, unit=f"{unit}/s^3", meaning="jerk"),
    )


def _grblhal_notes(_subject: Subject, _values: Values) -> tuple[str, ...]:
    return (
        "The jerk settings exist only in builds with ENABLE_JERK_ACCELERATION.",
        "$11 (junction deviation) sets how fast corners are taken and is not part of this.",
    )


def _settings_layout(entries: Sequence[Entry]) -> list[str]:
    return line_layout("{name}={value}", semicolon_comment, entries)


def _fluidnc_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    letter = _letter(subject, LETTERS[:6], "FluidNC").lower()
    entry = Entry(
        name="acceleration_mm_per_sec2",
        value=typed.acceleration,
        unit=f"{subject.small_unit[0]}/s^2",
        meaning="acceleration",
        section=f"axes/{letter}",
    )
    return (entry,)


def _fluidnc_notes(subject: Subject, values: Values) -> tuple[str, ...]:
    degrees = "The name says mm, but a rotary axis counts in degrees: the value is in deg/s^2."
    return (
        "FluidNC has released no jerk limit.",
        _make_up(subject, values.recommended),
        *((degrees,) if subject.is_rotary else ()),
    )


def _make_up(subject: Subject, typed: Typed) -> str:
    """What the acceleration had to give for the missing jerk limit."""
    share = typed.limits.acceleration / subject.limits.acceleration
    helper = "with the shaper" if typed.shaper else "without one"
    if not typed.verdict.assessment.is_met:
        return (
            "NO ACCELERATION MEETS THE REQUIREMENTS HERE: the value is the one of those tried, "
            f"{100.0 * share:.3g} % of the recommendation, that leaves least vibration {helper}."
        )
    return (
        f"To meet the requirements {helper}, the acceleration is {100.0 * share:.3g} % of the "
        "recommendation."
    )


def _klipper_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    letter = _letter(subject, "XYZ", "Klipper").lower()
    entries = [
        Entry(
            name="max_accel",
            value=typed.acceleration,
            unit="mm/s^2",
            meaning="of the tool head, so of its slowest axis",
            section="printer",
        )
    ]
    if typed.shaper:
        rows = (
            (f"shaper_type_{letter}", typed.shaper.name, "", "input shaper"),
            (
                f"shaper_freq_{letter}",
                f"{typed.shaper.frequency_hz:.{FREQUENCY_DIGITS}f}",
                "Hz",
                f"mode {subject.mode.name}",
            ),
            (
                f"damping_ratio_{letter}",
                f"{typed.shaper.damping_ratio:.{DAMPING_DIGITS}f}",
                "-",
                f"of mode {subject.mode.name}",
            ),
        )
        shaped = tuple(
            Entry(name=name, value=value, unit=unit, meaning=meaning, section="input_shaper")
            for name, value, unit, meaning in rows
        )
        entries += map(unverified, shaped) if letter == "z" else shaped
    return tuple(entries)


def _klipper_notes(subject: Subject, values: Values) -> tuple[str, ...]:
    return (
        "Klipper has no jerk limit; its square_corner_velocity is a velocity step, no jerk.",
        _make_up(subject, values.recommended),
        f"The shaper quiets mode {subject.mode.name}; it makes each move longer by its own length.",
    )


def _marlin_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    letter = _letter(subject, "XYZ", "Marlin")
    entries = [
        Entry(
            name=f"M201 {letter}", value=typed.acceleration, unit="mm/s^2", meaning="acceleration"
        )
    ]
    if typed.shaper:
        number = typed.shaper.order
        frequency = f"{typed.shaper.frequency_hz:.{FREQUENCY_DIGITS}f}"
        damping = f"{typed.shaper.damping_ratio:.{DAMPING_DIGITS}f}"
        entries.append(Entry(name="M493 S", value="1", unit="", meaning="fixed-time motion on"))
        entries.append(
            unverified(
                Entry(
                    name=f"M493 {letter} C",
                    value=f"{number} A{frequency} I{damping}",
                    unit="-, Hz, -",
                    meaning=f"{typed.shaper.name.upper()} shaper on mode {subject.mode.name}; "
                    "letters changed between versions",
                )
            )
        )
    return tuple(entries)


def _marlin_notes(subject: Subject, values: Values) -> tuple[str, ...]:
    return (
        'What Marlin calls "jerk" (M205) is a velocity step in mm/s, not a jerk.',
        _make_up(subject, values.recommended),
        "M493 needs a build with FT_MOTION; M500 keeps the values.",
    )


def _gcode_layout(entries: Sequence[Entry]) -> list[str]:
    return line_layout("{name}{value}", semicolon_comment, entries)


def _ros_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    length = subject.length
    section = f"joint_limits/{identifier(subject)}"
    rows = (
        ("has_acceleration_limits", "true", "", ""),
        ("max_acceleration", typed.acceleration, f"{length}/s^2", "acceleration"),
        ("has_jerk_limits", "true", "", ""),
        ("max_jerk", typed.jerk, f"{length}/s^3", "jerk"),
    )
    return tuple(
        Entry(name=name, value=value, unit=unit, meaning=meaning, section=section)
        for name, value, unit, meaning in rows
    )


OPEN_CONTROLS = (
    Control(
        key="linuxcnc",
        coding=_jerk_coding,
        describe=_linuxcnc_entries,
        layout=partial(ini_layout, " = "),
        comment=hash_comment,
        notes=_linuxcnc_notes,
    ),
    Control(
        key="klipper",
        coding=partial(_shaped_coding, control="Klipper"),
        describe=_klipper_entries,
        layout=partial(ini_layout, ": "),
        comment=hash_comment,
        notes=_klipper_notes,
    ),
    Control(
        key="grblhal",
        coding=_jerk_coding,
        describe=_grblhal_entries,
        layout=_settings_layout,
        comment=semicolon_comment,
        notes=_grblhal_notes,
    ),
    Control(
        key="fluidnc",
        coding=_plain_coding,
        describe=_fluidnc_entries,
        layout=yaml_layout,
        comment=hash_comment,
        notes=_fluidnc_notes,
    ),
    Control(
        key="marlin",
        coding=partial(_shaped_coding, control="Marlin"),
        describe=_marlin_entries,
        layout=_gcode_layout,
        comment=semicolon_comment,
        notes=_marlin_notes,
    ),
    Control(
        key="ros2",
        coding=si_coding,
        describe=_ros_entries,
        layout=yaml_layout,
        comment=hash_comment,
        in_degrees=False,
    ),
)
