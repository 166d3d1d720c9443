"""Open controls and firmware: LinuxCNC, grblHAL, FluidNC, Klipper, Marlin, ROS 2."""

from __future__ import annotations

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
        message = Message(
            "export-other-letter", control=control, letters=tuple(allowed), axis_name=subject.axis
        )
        raise InputError([Fault(where="--control", message=message)])
    return letter


def _require_linear(subject: Subject, control: str) -> None:
    if subject.is_rotary:
        message = Message("export-linear-only", control=control)
        raise InputError([Fault(where="--control", message=message)])


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
            ("MAX_ACCELERATION", typed.acceleration, f"{unit}/s^2", Message("limit-acceleration")),
            ("MAX_JERK", typed.jerk, f"{unit}/s^3", Message("linuxcnc-jerk")),
        )
    )
    planner = Entry(
        name="PLANNER_TYPE", value="1", unit="", meaning=Message("linuxcnc-planner"), section="TRAJ"
    )
    if subject.is_rotary:
        return (planner, *limits)
    path = Entry(
        name="MAX_LINEAR_JERK",
        value=typed.jerk,
        unit="mm/s^3",
        meaning=Message("linuxcnc-path-jerk"),
        section="TRAJ",
    )
    return (planner, path, *limits)


def _linuxcnc_notes(_subject: Subject, _values: Values) -> tuple[Message, ...]:
    return (
        Message("linuxcnc-units"),
        Message("linuxcnc-joints"),
        Message("linuxcnc-least-jerk"),
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
            meaning=Message("limit-acceleration"),
        ),
        Entry(
            name=f"${800 + index}",
            value=typed.jerk,
            unit=f"{unit}/s^3",
            meaning=Message("limit-jerk"),
        ),
    )


def _grblhal_notes(_subject: Subject, _values: Values) -> tuple[Message, ...]:
    return (
        Message("grblhal-builds"),
        Message("grblhal-corners"),
    )


def _fluidnc_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    letter = _letter(subject, LETTERS[:6], "FluidNC").lower()
    entry = Entry(
        name="acceleration_mm_per_sec2",
        value=typed.acceleration,
        unit=f"{subject.small_unit[0]}/s^2",
        meaning=Message("limit-acceleration"),
        section=f"axes/{letter}",
    )
    return (entry,)


def _fluidnc_notes(subject: Subject, values: Values) -> tuple[Message, ...]:
    return (
        Message("fluidnc-no-jerk"),
        _make_up(subject, values.recommended),
        *((Message("fluidnc-degrees"),) if subject.is_rotary else ()),
    )


def _make_up(subject: Subject, typed: Typed) -> Message:
    """What the acceleration had to give for the missing jerk limit."""
    share = typed.limits.acceleration / subject.limits.acceleration
    shaper = "yes" if typed.shaper else "no"
    if not typed.verdict.assessment.is_met:
        return Message("export-least-vibration", share=share, shaper=shaper)
    return Message("export-share-of-acceleration", share=share, shaper=shaper)


def _klipper_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    letter = _letter(subject, "XYZ", "Klipper").lower()
    entries = [
        Entry(
            name="max_accel",
            value=typed.acceleration,
            unit="mm/s^2",
            meaning=Message("klipper-tool-head"),
            section="printer",
        )
    ]
    if typed.shaper:
        rows = (
            (f"shaper_type_{letter}", typed.shaper.name, "", Message("klipper-input-shaper")),
            (
                f"shaper_freq_{letter}",
                f"{typed.shaper.frequency_hz:.{FREQUENCY_DIGITS}f}",
                "Hz",
                Message("klipper-mode", mode=subject.mode.name),
            ),
            (
                f"damping_ratio_{letter}",
                f"{typed.shaper.damping_ratio:.{DAMPING_DIGITS}f}",
                "-",
                Message("klipper-of-mode", mode=subject.mode.name),
            ),
        )
        shaped = tuple(
            Entry(name=name, value=value, unit=unit, meaning=meaning, section="input_shaper")
            for name, value, unit, meaning in rows
        )
        entries += map(unverified, shaped) if letter == "z" else shaped
    return tuple(entries)


def _klipper_notes(subject: Subject, values: Values) -> tuple[Message, ...]:
    return (
        Message("klipper-no-jerk"),
        _make_up(subject, values.recommended),
        Message("klipper-shaper", mode=subject.mode.name),
    )


def _marlin_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    letter = _letter(subject, "XYZ", "Marlin")
    entries = [
        Entry(
            name=f"M201 {letter}",
            value=typed.acceleration,
            unit="mm/s^2",
            meaning=Message("limit-acceleration"),
        )
    ]
    if typed.shaper:
        number = typed.shaper.order
        frequency = f"{typed.shaper.frequency_hz:.{FREQUENCY_DIGITS}f}"
        damping = f"{typed.shaper.damping_ratio:.{DAMPING_DIGITS}f}"
        entries.append(
            Entry(name="M493 S", value="1", unit="", meaning=Message("marlin-fixed-time"))
        )
        entries.append(
            unverified(
                Entry(
                    name=f"M493 {letter} C",
                    value=f"{number} A{frequency} I{damping}",
                    unit="-, Hz, -",
                    meaning=Message(
                        "marlin-shaper", shaper=typed.shaper.name.upper(), mode=subject.mode.name
                    ),
                )
            )
        )
    return tuple(entries)


def _marlin_notes(subject: Subject, values: Values) -> tuple[Message, ...]:
    return (
        Message("marlin-jerk"),
        _make_up(subject, values.recommended),
        Message("marlin-build"),
    )


def _ros_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed = values.recommended
    length = subject.length
    section = f"joint_limits/{identifier(subject)}"
    rows = (
        ("has_acceleration_limits", "true", "", None),
        ("max_acceleration", typed.acceleration, f"{length}/s^2", Message("limit-acceleration")),
        ("has_jerk_limits", "true", "", None),
        ("max_jerk", typed.jerk, f"{length}/s^3", Message("limit-jerk")),
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
        layout=partial(line_layout, "{name}={value}", semicolon_comment),
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
        layout=partial(line_layout, "{name}{value}", semicolon_comment),
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
