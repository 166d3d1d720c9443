"""SINUMERIK 840D, 828D and ONE: machine data by dynamic mode, gains, and the jerk filter."""

from __future__ import annotations

from functools import partial
from math import ceil

from mtcommission.export.control import (
    Block,
    Control,
    Entry,
    line_layout,
    semicolon_comment,
    unverified,
)
from mtcommission.export.gains import GainUnits
from mtcommission.export.modes import Values, explain_left_out
from mtcommission.export.rounding import (
    Coding,
    round_down,
    round_up_digits,
    type_number,
)
from mtcommission.export.subject import Subject, judge_plan
from mtcommission.export.wording import MILLI, TURN, name_mode, show_value
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import without_jerk_limit
from mtcommission.setpoint.setpoint import plan_setpoint

GAIN_PER_MINUTE = 1000.0 / 60.0
"""(m/min)/mm = 1000/min in 1/s."""

DYNAMIC_MODES = (
    ("DYNNORM", ""),
    ("DYNPOS", ""),
    ("DYNROUGH", "speed"),
    ("DYNSEMIFIN", "accuracy"),
    ("DYNFINISH", "surface"),
)
"""Dynamic modes in the order of their index, and the machining mode of each; "" takes the
recommendation."""

LONGEST_MOVING_AVERAGE = 16
"""Position cycles; the range of jerk filter mode 2."""


def _coding(subject: Subject) -> Coding:
    unit = TURN if subject.is_rotary else 1.0
    return Coding(acceleration_unit=unit, jerk_unit=unit)


def _entries(subject: Subject, values: Values) -> tuple[Entry, ...]:
    length = "rev" if subject.is_rotary else "m"
    by_mode = {"": (values.recommended, Message("limit-recommended"))} | {
        mode.name: (
            mode.typed,
            Message(
                "limit-of-mode", mode=name_mode(mode.name), band=_show_band(subject, mode.band)
            ),
        )
        for mode in values.modes
        if mode.typed is not None
    }
    rows = [
        (index, dynamic, *by_mode[name])
        for index, (dynamic, name) in enumerate(DYNAMIC_MODES)
        if name in by_mode
    ]
    accelerations = tuple(
        Entry(
            name=f"N32300 $MA_MAX_AX_ACCEL[{index}]",
            value=typed.acceleration,
            unit=f"{length}/s^2",
            meaning=Message("sinumerik-mode", dynamic=dynamic, about=about),
        )
        for index, dynamic, typed, about in rows
    )
    jerks = tuple(
        unverified(
            Entry(
                name=f"N32431 $MA_MAX_AX_JERK[{index}]",
                value=typed.jerk,
                unit=f"{length}/s^3",
                meaning=Message("sinumerik-mode-unit", dynamic=dynamic),
            )
        )
        for index, dynamic, typed, _ in rows
    )
    return (*accelerations, *jerks, *_gains(subject))


def _show_band(subject: Subject, band: float) -> str | Message:
    return show_value(band, subject.length, in_degrees=True)


def _gains(subject: Subject) -> tuple[Entry, ...]:
    gains = subject.gains
    return (
        Entry(
            name="N32200 $MA_POSCTRL_GAIN[0]",
            value=type_number(round_down(gains.position / GAIN_PER_MINUTE)),
            unit="1000/min",
            meaning=Message("gain-kv"),
        ),
        unverified(
            Entry(
                name="N32610 $MA_VELO_FFW_WEIGHT[0]",
                value=f"{subject.machine.control.velocity_feedforward:.4g}",
                unit="",
                meaning=Message("gain-feed-forward-name"),
            )
        ),
        unverified(
            Entry(
                name="p1460",
                value=type_number(round_down(gains.velocity)),
                unit=subject.machine.axis_units.damping.si,
                meaning=Message("gain-kp-at-axis"),
            )
        ),
        unverified(
            Entry(
                name="p1462",
                value=type_number(round_up_digits(gains.integral_time / MILLI)),
                unit="ms",
                meaning=Message("gain-tn-unit"),
            )
        ),
    )


def _jerk_filter(subject: Subject, values: Values) -> tuple[Block, ...]:
    """The same ramp from the control's moving average instead of the jerk limit."""
    title = Message("sinumerik-jerk-filter")
    typed, cycle = values.recommended, subject.machine.control.position_cycle
    if subject.machine.control.moving_average_time > 0.0:
        return ()
    count = ceil(typed.limits.jerk_time / cycle - 1e-9)
    if count > LONGEST_MOVING_AVERAGE:
        note = Message(
            "sinumerik-ramp-too-long",
            ramp=typed.limits.jerk_time,
            longest=LONGEST_MOVING_AVERAGE * cycle,
            cycles=LONGEST_MOVING_AVERAGE,
        )
        return (Block(title=title, entries=(), notes=(note,)),)
    time = count * cycle
    limits = without_jerk_limit(subject.machine, typed.limits.acceleration)
    verdict = judge_plan(subject, partial(plan_setpoint, limits=limits, moving_average=time))
    notes = (
        Message("sinumerik-filter-instead"),
        Message(
            "sinumerik-filter-simulated",
            met="yes" if verdict.assessment.is_met else "no",
            settling=show_value(verdict.settling_time, "s", in_degrees=True),
        ),
    )
    return (Block(title=title, entries=_filter_entries(time, count), notes=notes),)


def _filter_entries(time: float, count: int) -> tuple[Entry, ...]:
    return (
        Entry(
            name="N32400 $MA_AX_JERK_ENABLE",
            value="1",
            unit="",
            meaning=Message("sinumerik-filter-on"),
        ),
        Entry(
            name="N32402 $MA_AX_JERK_MODE",
            value="2",
            unit="",
            meaning=Message("sinumerik-moving-average"),
        ),
        Entry(
            name="N32410 $MA_AX_JERK_TIME",
            value=f"{time:.6g}",
            unit="s",
            meaning=Message("sinumerik-cycles", count=count),
        ),
    )


def _notes(subject: Subject, values: Values) -> tuple[Message, ...]:
    dynamic = {mode: name for name, mode in DYNAMIC_MODES}
    left_out = tuple(
        Message(
            "sinumerik-left-out",
            dynamic=dynamic[mode.name],
            why=explain_left_out(subject, mode),
        )
        for mode in values.left_out
    )
    return (
        *left_out,
        Message("sinumerik-dynamic-modes"),
        Message("sinumerik-path-jerk"),
        Message("sinumerik-filter-already-on"),
        *((Message("sinumerik-turns"),) if subject.is_rotary else ()),
    )


SINUMERIK = Control(
    key="sinumerik",
    coding=_coding,
    describe=_entries,
    layout=partial(line_layout, "{name}={value}", semicolon_comment),
    comment=semicolon_comment,
    gains=GainUnits(position=GAIN_PER_MINUTE, velocity=1.0, integral_time=MILLI),
    has_modes=True,
    alternatives=_jerk_filter,
    notes=_notes,
)
