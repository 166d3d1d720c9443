"""Numerical controls: HEIDENHAIN, FANUC, ISG kernel.

Names and units as the makers' manuals give them; what was not read there is marked.
"""

from __future__ import annotations

from functools import partial
from math import ceil

from mtcommission.export.control import (
    Block,
    Control,
    Entry,
    bracket_comment,
    hash_comment,
    line_layout,
    table_layout,
    unverified,
)
from mtcommission.export.gains import GainUnits
from mtcommission.export.modes import Values, explain_left_out
from mtcommission.export.rounding import (
    AccelerationForm,
    Coding,
    JerkForm,
    Typed,
    round_down,
    type_number,
)
from mtcommission.export.sinumerik import SINUMERIK
from mtcommission.export.subject import Subject
from mtcommission.export.wording import DEGREE, MICRO, MILLI, name_mode, show_value
from mtcommission.messages.message import Message

HUNDREDTH = 0.01
"""Unit of the position gain in FANUC's and ISG's parameters [1/s]."""


def _whole_cycle(subject: Subject, unit: float) -> int:
    """Return the position cycle in whole units of time [unit in s], at least one."""
    return max(1, ceil(subject.machine.control.position_cycle / unit - 1e-9))


def _position_gain(subject: Subject, unit: float, *, is_whole: bool = False) -> str:
    """Return Kv as typed, in its unit [1/s]."""
    return type_number(round_down(subject.gains.position / unit, is_whole=is_whole))


def _heidenhain_coding(subject: Subject) -> Coding:
    unit = DEGREE if subject.is_rotary else 1.0
    return Coding(acceleration_unit=unit, jerk_unit=unit)


def _heidenhain_limits(subject: Subject, typed: Typed) -> tuple[Entry, ...]:
    unit = "deg" if subject.is_rotary else "m"
    entries = (
        Entry(
            name="maxAcceleration",
            value=typed.acceleration,
            unit=f"{unit}/s^2",
            meaning=Message("limit-acceleration"),
        ),
        Entry(
            name="axPathJerk",
            value=typed.jerk,
            unit=f"{unit}/s^3",
            meaning=Message("limit-axis-jerk"),
        ),
        Entry(
            name="axPathJerkHi",
            value=typed.jerk,
            unit=f"{unit}/s^3",
            meaning=Message("limit-axis-jerk-at-rapid"),
        ),
    )
    # The manual states m/s^2 for linear axes; degrees for rotary ones are inferred.
    return tuple(map(unverified, entries)) if subject.is_rotary else entries


def _heidenhain_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    gain = Entry(
        name="kvFactor", value=_position_gain(subject, 1.0), unit="1/s", meaning=Message("gain-kv")
    )
    return (*_heidenhain_limits(subject, values.recommended), gain)


def _heidenhain_modes(subject: Subject, values: Values) -> tuple[Block, ...]:
    """The same parameters for each machining mode; HEIDENHAIN's own names for the three."""
    blocks = []
    for mode in values.modes:
        band = show_value(mode.band, subject.length, in_degrees=True)
        note = Message("heidenhain-judged", band=band)
        if mode.typed is None:
            note = Message("heidenhain-left-out", why=explain_left_out(subject, mode))
        entries = _heidenhain_limits(subject, mode.typed) if mode.typed else ()
        blocks.append(
            Block(
                title=Message("heidenhain-mode", mode=name_mode(mode.name)),
                entries=entries,
                notes=(note,),
            )
        )
    return tuple(blocks)


def _heidenhain_notes(_subject: Subject, _values: Values) -> tuple[Message, ...]:
    return (
        Message("heidenhain-path"),
        Message("heidenhain-filters"),
        Message("heidenhain-itnc"),
    )


def _fanuc_coding(subject: Subject) -> Coding:
    return Coding(
        acceleration_form=AccelerationForm.RISE_TIME,
        acceleration_unit=MILLI,
        jerk_form=JerkForm.TIME,
        jerk_unit=MILLI,
        time_step=_whole_cycle(subject, MILLI),
        rapid=_fanuc_rapid(subject)[1],
    )


def _fanuc_rapid(subject: Subject) -> tuple[str, float]:
    """Rapid traverse as typed, per minute, and what it is [m/s]."""
    unit = subject.small_unit[1] / 60.0
    number = round_down(subject.fastest / unit)
    return type_number(number), float(number) * unit


def _fanuc_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    unit = f"{subject.small_unit[0]}/min"
    typed = values.recommended
    return (
        Entry(
            name="1620",
            value=typed.acceleration,
            unit="ms",
            meaning=Message("fanuc-rise-time", rapid=_fanuc_rapid(subject)[0], unit=unit),
        ),
        Entry(name="1774", value=typed.jerk, unit="ms", meaning=Message("fanuc-bell-time")),
        unverified(
            Entry(
                name="1825",
                value=_position_gain(subject, HUNDREDTH, is_whole=True),
                unit="0.01/s",
                meaning=Message("gain-kv-name-and-unit"),
            )
        ),
    )


def _fanuc_notes(subject: Subject, values: Values) -> tuple[Message, ...]:
    length, size = subject.small_unit
    rapid = _fanuc_rapid(subject)[0]
    rise = values.recommended.acceleration
    a = values.recommended.limits.acceleration / size
    return (
        Message("fanuc-no-jerk", length=length),
        Message("fanuc-rapid", rapid=rapid, length=length, rise=rise, acceleration=a),
        Message("fanuc-nano"),
        Message("fanuc-look-ahead"),
    )


def _isg_coding(subject: Subject) -> Coding:
    return Coding(
        acceleration_unit=subject.small_unit[1],
        is_whole=True,
        jerk_form=JerkForm.TIME,
        jerk_unit=MICRO,
        time_step=_whole_cycle(subject, MICRO),
    )


RAMPS = (
    ("tr_beschl_zu", Message("isg-acceleration-rises")),
    ("tr_beschl_ab", Message("isg-acceleration-falls")),
    ("tr_brems_zu", Message("isg-deceleration-rises")),
    ("tr_brems_ab", Message("isg-deceleration-falls")),
    ("tr_grenz", Message("isg-ramp-at-rapid")),
)
"""P-AXIS-00196, 195, 198, 197 and 200 of the kernel."""


def _isg_entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    unit = f"{subject.small_unit[0]}/s^2"
    place, typed = "getriebe[0].slope_profil", values.recommended
    accelerations = (
        ("a_beschl", Message("limit-acceleration")),
        ("a_brems", Message("limit-deceleration")),
        ("a_grenz", Message("isg-acceleration-at-rapid")),
    )
    gain = Entry(
        name="getriebe[0].kv",
        value=_position_gain(subject, HUNDREDTH, is_whole=True),
        unit="0.01/s",
        meaning=Message("gain-kv"),
    )
    return (
        *(
            Entry(name=f"{place}.{name}", value=typed.acceleration, unit=unit, meaning=meaning)
            for name, meaning in accelerations
        ),
        *(
            Entry(name=f"{place}.{name}", value=typed.jerk, unit="us", meaning=meaning)
            for name, meaning in RAMPS
        ),
        gain,
    )


def _isg_notes(_subject: Subject, _values: Values) -> tuple[Message, ...]:
    return (
        Message("isg-gear-sets"),
        Message("isg-own-limits"),
    )


NUMERIC_CONTROLS = (
    SINUMERIK,
    Control(
        key="heidenhain",
        coding=_heidenhain_coding,
        describe=_heidenhain_entries,
        layout=table_layout,
        comment=hash_comment,
        gains=GainUnits(position=1.0),
        has_modes=True,
        alternatives=_heidenhain_modes,
        notes=_heidenhain_notes,
    ),
    Control(
        key="fanuc",
        coding=_fanuc_coding,
        describe=_fanuc_entries,
        layout=table_layout,
        comment=hash_comment,
        gains=GainUnits(position=HUNDREDTH, is_whole=True),
        notes=_fanuc_notes,
    ),
    Control(
        key="isg",
        coding=_isg_coding,
        describe=_isg_entries,
        layout=partial(line_layout, "{name}  {value}", bracket_comment),
        comment=hash_comment,
        gains=GainUnits(position=HUNDREDTH, is_whole=True),
        notes=_isg_notes,
    ),
)
