"""PLC motion controls: TwinCAT NC and PLCopen function blocks; and the neutral list."""

from __future__ import annotations

from functools import partial

from mtcommission.export.choose import Chosen
from mtcommission.export.control import Control, say_neutrally
from mtcommission.export.layout import CONSTANTS, INLINE, TABLE
from mtcommission.export.row import Row, Setting, Values
from mtcommission.export.subject import Subject
from mtcommission.messages.message import Message

GAIN_PER_MINUTE = 1000.0 / 60.0
"""1000/min in 1/s."""


def identifier(subject: Subject) -> str:
    """Return the axis name as part of an identifier."""
    kept = "".join(
        letter if letter.isascii() and letter.isalnum() else "_" for letter in subject.axis
    )
    return kept if kept[:1].isalpha() else f"Axis_{kept}"


def _constants(subject: Subject, _loop: Values) -> list[Row]:
    (length, size), axis = subject.small_unit, identifier(subject)
    return [
        Row(setting, f"c{axis}_{name}", unit=f"{length}/s^{power}", scale=size, meaning=meaning)
        for setting, name, power, meaning in (
            (Setting.ACCELERATION, "Acceleration", 2, Message("limit-acceleration")),
            (Setting.ACCELERATION, "Deceleration", 2, Message("limit-deceleration")),
            (Setting.JERK, "Jerk", 3, Message("limit-jerk")),
        )
    ]


def _twincat(subject: Subject, loop: Values) -> list[Row]:
    length, size = subject.small_unit
    path = [
        Row(
            setting,
            f"#set paramPathDynamics[{number}]",
            unit=f"{length}/s^2, {length}/s^3",
            scale=size,
            meaning=Message("limit-path-nci"),
            section=INLINE,
        )
        for number, setting in enumerate(
            (Setting.ACCELERATION, Setting.ACCELERATION, Setting.JERK), start=1
        )
    ]
    return [*_constants(subject, loop), *path, *_twincat_loop(subject, loop)]


def _twincat_loop(subject: Subject, loop: Values) -> list[Row]:
    """The position controller of the NC or of an AX5000, and the drive's velocity controller."""
    row = partial(Row, is_elsewhere=True)
    rows = [
        row(
            Setting.INTEGRAL_TIME,
            "S-0-0101",
            unit="0.1 ms",
            scale=1e-4,
            step=1,
            meaning=Message("twincat-tn"),
        )
    ]
    if subject.shaft:
        rows.append(
            row(
                Setting.VELOCITY_GAIN,
                "S-0-0100",
                unit="Nm/(rad/s)",
                scale=subject.shaft**-2,
                step=1e-3,
                meaning=Message("twincat-kp"),
            )
        )
    if loop[Setting.POSITION_LOOP, ""] == "drive":
        return [
            *rows,
            row(
                Setting.POSITION_GAIN,
                "S-0-0104",
                unit="1000/min",
                scale=GAIN_PER_MINUTE,
                step=1e-2,
                meaning=Message("twincat-kv-in-drive"),
            ),
            row(Setting.VELOCITY_FEEDFORWARD, "S-0-0296", unit="%", scale=1e-2, step=1e-2),
        ]
    return [
        *rows,
        row(
            Setting.POSITION_GAIN,
            "NC position controller Kv",
            unit="1/s",
            meaning=Message("twincat-kv-in-nc"),
        ),
        row(Setting.VELOCITY_FEEDFORWARD, "NC velocity pre-control weight"),
    ]


def _twincat_notes(_subject: Subject, _chosen: Chosen) -> tuple[Message, ...]:
    return (Message("twincat-jerk-unit"), Message("twincat-no-jerk-filter"))


def _plcopen_notes(_subject: Subject, _chosen: Chosen) -> tuple[Message, ...]:
    return (Message("plcopen-unit"), Message("plcopen-jerk-of-zero"), Message("plcopen-quadratic"))


def _generic(subject: Subject, loop: Values) -> tuple[Row, ...]:
    limits = ((Setting.ACCELERATION, ""), (Setting.JERK, ""))
    return say_neutrally((*limits, *loop), subject.machine.axis_units)


def _state_space(subject: Subject, loop: Values) -> tuple[Row, ...]:
    units = subject.record.plant.units
    fed_back = (index for setting, index in loop if setting is Setting.STATE_GAIN)
    return (
        *_generic(subject, loop),
        *(
            Row(
                Setting.STATE_GAIN,
                f"state feedback {state}",
                index=state,
                unit=f"{units['F']}/({units[state]})",
                digits=6,
            )
            for state in fed_back
        ),
    )


PLC_CONTROLS = (
    Control(key="twincat", rows=_twincat, layout=CONSTANTS, notes=_twincat_notes),
    Control(key="plcopen", rows=_constants, layout=CONSTANTS, notes=_plcopen_notes),
    Control(key="generic", rows=_generic, layout=TABLE, in_degrees=False),
)

FREE = Control(key="state-space", rows=_state_space, layout=TABLE, in_degrees=False)
"""The free controller: no product, so no name of a control, but its rows stand on page 1."""
