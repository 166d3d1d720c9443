"""PLC motion controls: TwinCAT NC and PLCopen function blocks; and the neutral list."""

from __future__ import annotations

from collections.abc import Sequence

from mtcommission.export.control import (
    Control,
    Entry,
    hash_comment,
    remark,
    structured_text_comment,
    table_layout,
)
from mtcommission.export.gains import GainUnits
from mtcommission.export.modes import Values
from mtcommission.export.rounding import (
    Coding,
    Typed,
    round_down,
    round_up,
    round_up_digits,
    type_number,
)
from mtcommission.export.subject import Subject
from mtcommission.export.wording import MICRO
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message

INLINE = "NC program"
"""Section of what stands in the part program instead of the PLC."""


def identifier(subject: Subject) -> str:
    """Return the axis name as part of an identifier."""
    kept = "".join(
        letter if letter.isascii() and letter.isalnum() else "_" for letter in subject.axis
    )
    return kept if kept[:1].isalpha() else f"Axis_{kept}"


def _small_coding(subject: Subject) -> Coding:
    size = subject.small_unit[1]
    return Coding(acceleration_unit=size, jerk_unit=size)


def _constants(subject: Subject, typed: Typed, *, length: str) -> tuple[Entry, ...]:
    axis = identifier(subject)
    rows = (
        ("Acceleration", typed.acceleration, f"{length}/s^2", Message("limit-acceleration")),
        ("Deceleration", typed.acceleration, f"{length}/s^2", Message("limit-deceleration")),
        ("Jerk", typed.jerk, f"{length}/s^3", Message("limit-jerk")),
    )
    return tuple(
        Entry(name=f"c{axis}_{name}", value=value, unit=unit, meaning=meaning)
        for name, value, unit, meaning in rows
    )


def _twincat_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    typed, length = values.recommended, subject.small_unit[0]
    path = Entry(
        name="#set paramPathDynamics",
        value=f"{typed.acceleration};{typed.acceleration};{typed.jerk}",
        unit=f"{length}/s^2, {length}/s^3",
        meaning=Message("limit-path-nci"),
        section=INLINE,
    )
    return (*_constants(subject, typed, length=length), path)


def _plcopen_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    return _constants(subject, values.recommended, length=subject.small_unit[0])


def _structured_text(entries: Sequence[Entry], words: Catalogue) -> list[str]:
    constants = [entry for entry in entries if entry.section != INLINE]
    heads = [f"    {entry.name} : LREAL := {_real(entry.value)};" for entry in constants]
    width = max(map(len, heads))
    lines = ["VAR_GLOBAL CONSTANT"]
    lines += [
        f"{head:<{width}}  {structured_text_comment(remark(entry, words))}"
        for head, entry in zip(heads, constants, strict=True)
    ]
    lines.append("END_VAR")
    for entry in entries:
        if entry.section == INLINE:
            lines += [
                "",
                structured_text_comment(
                    words.text("export-for-nc-program", remark=remark(entry, words))
                ),
                structured_text_comment(f"{entry.name}({entry.value})#"),
            ]
    return lines


def _real(text: str) -> str:
    """A literal of type LREAL has a decimal point."""
    return text if "." in text else f"{text}.0"


def _twincat_notes(_subject: Subject, _values: Values) -> tuple[Message, ...]:
    return (
        Message("twincat-jerk-unit"),
        Message("twincat-no-jerk-filter"),
    )


def _plcopen_notes(_subject: Subject, _values: Values) -> tuple[Message, ...]:
    return (
        Message("plcopen-unit"),
        Message("plcopen-jerk-of-zero"),
    )


def si_coding(_subject: Subject) -> Coding:
    """Return how a control stores limits in SI units."""
    return Coding(acceleration_unit=1.0)


def _generic_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    length, force = subject.length, subject.machine.axis_units.force.si
    typed, gains = values.recommended, subject.gains
    delay = subject.tuned.controller.reference_delay
    rows = (
        ("acceleration", typed.acceleration, f"{length}/s^2", Message("limit-itself")),
        ("jerk", typed.jerk, f"{length}/s^3", Message("limit-itself")),
        (
            "jerk time",
            type_number(round_up(typed.limits.jerk_time / MICRO)),
            "us",
            Message("limit-jerk-time"),
        ),
        ("Kv", type_number(round_down(gains.position)), "1/s", Message("gain-position")),
        (
            "Kp",
            type_number(round_down(gains.velocity)),
            f"{force} s/{length}",
            Message("gain-velocity"),
        ),
        (
            "Tn",
            type_number(round_up_digits(gains.integral_time / MICRO)),
            "us",
            Message("gain-integral-time"),
        ),
        (
            "reference delay",
            type_number(round_up(delay / MICRO)),
            "us",
            Message("delay-of-reference"),
        ),
    )
    return tuple(
        Entry(name=name, value=value, unit=unit, meaning=meaning)
        for name, value, unit, meaning in rows
    )


PLC_CONTROLS = (
    Control(
        key="twincat",
        coding=_small_coding,
        describe=_twincat_entries,
        layout=_structured_text,
        comment=structured_text_comment,
        notes=_twincat_notes,
    ),
    Control(
        key="plcopen",
        coding=_small_coding,
        describe=_plcopen_entries,
        layout=_structured_text,
        comment=structured_text_comment,
        notes=_plcopen_notes,
    ),
    Control(
        key="generic",
        coding=si_coding,
        describe=_generic_entries,
        layout=table_layout,
        comment=hash_comment,
        gains=GainUnits(position=1.0, velocity=1.0, integral_time=MICRO),
        in_degrees=False,
    ),
)
