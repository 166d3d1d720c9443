"""SINUMERIK 840D, 828D and ONE: machine data by dynamic mode, gains, and the jerk filter."""

from __future__ import annotations

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
from mtcommission.export.subject import Subject, judge_setpoints, plan_moves
from mtcommission.export.wording import MILLI, TURN, show_value
from mtcommission.setpoint.motion_limits import without_jerk_limit

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
    by_mode = {"": (values.recommended, "recommended")} | {
        mode.name: (mode.typed, f"{mode.name}, band {_show_band(subject, mode.band)}, met")
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
            meaning=f"{dynamic}: {about}",
        )
        for index, dynamic, typed, about in rows
    )
    jerks = tuple(
        unverified(
            Entry(
                name=f"N32431 $MA_MAX_AX_JERK[{index}]",
                value=typed.jerk,
                unit=f"{length}/s^3",
                meaning=f"{dynamic}; unit",
            )
        )
        for index, dynamic, typed, _ in rows
    )
    return (*accelerations, *jerks, *_gains(subject))


def _show_band(subject: Subject, band: float) -> str:
    return show_value(band, subject.length, in_degrees=True)


def _gains(subject: Subject) -> tuple[Entry, ...]:
    gains = subject.gains
    return (
        Entry(
            name="N32200 $MA_POSCTRL_GAIN[0]",
            value=type_number(round_down(gains.position / GAIN_PER_MINUTE)),
            unit="1000/min",
            meaning="Kv of this loop",
        ),
        unverified(
            Entry(
                name="N32610 $MA_VELO_FFW_WEIGHT[0]",
                value=f"{subject.machine.control.velocity_feedforward:.4g}",
                unit="",
                meaning="velocity feed-forward of this loop; name",
            )
        ),
        unverified(
            Entry(
                name="p1460",
                value=type_number(round_down(gains.velocity)),
                unit=subject.machine.axis_units.damping.si,
                meaning="Kp of this loop, at the axis; a rotary motor needs Nms/rad at its shaft",
            )
        ),
        unverified(
            Entry(
                name="p1462",
                value=type_number(round_up_digits(gains.integral_time / MILLI)),
                unit="ms",
                meaning="Tn of this loop, rounded up; unit",
            )
        ),
    )


def _jerk_filter(subject: Subject, values: Values) -> tuple[Block, ...]:
    """The same ramp from the control's moving average instead of the jerk limit."""
    title = "Alternative with the jerk filter MD32400"
    typed, cycle = values.recommended, subject.machine.control.position_cycle
    if subject.machine.control.moving_average_time > 0.0:
        return ()
    count = ceil(typed.limits.jerk_time / cycle - 1e-9)
    if count > LONGEST_MOVING_AVERAGE:
        note = (
            f"The ramp of {1e3 * typed.limits.jerk_time:.4g} ms is longer than the filter's usual "
            f"range of {1e3 * LONGEST_MOVING_AVERAGE * cycle:.4g} ms ({LONGEST_MOVING_AVERAGE} "
            "position cycles), so there is no alternative with the jerk filter here."
        )
        return (Block(title=title, entries=(), notes=(note,)),)
    time = count * cycle
    limits = without_jerk_limit(subject.machine, typed.limits.acceleration)
    verdict = judge_setpoints(subject, plan_moves(subject, limits, moving_average=time))
    met = "meets" if verdict.assessment.is_met else "DOES NOT MEET"
    notes = (
        "Set the filter INSTEAD of the jerk limit: raise MD32431 until it no longer acts, keep "
        "the acceleration. Both together would count the jerk time twice.",
        f"Simulated so, it {met} all requirements, settling after "
        f"{show_value(verdict.settling_time, 's', in_degrees=True)}. The filter also acts on moves "
        "that never reach the acceleration, where a jerk limit leaves vibration.",
    )
    return (Block(title=title, entries=_filter_entries(time, count), notes=notes),)


def _filter_entries(time: float, count: int) -> tuple[Entry, ...]:
    return (
        Entry(name="N32400 $MA_AX_JERK_ENABLE", value="1", unit="", meaning="jerk filter on"),
        Entry(name="N32402 $MA_AX_JERK_MODE", value="2", unit="", meaning="moving average"),
        Entry(
            name="N32410 $MA_AX_JERK_TIME",
            value=f"{time:.6g}",
            unit="s",
            meaning=f"{count} position cycles",
        ),
    )


def _notes(subject: Subject, values: Values) -> tuple[str, ...]:
    dynamic = {mode: name for name, mode in DYNAMIC_MODES}
    left_out = tuple(
        f"{dynamic[mode.name]} IS LEFT OUT: {explain_left_out(subject, mode)}. Do not use this "
        "mode with the old values."
        for mode in values.left_out
    )
    turns = "Accelerations count in revolutions, positions and bands in degrees."
    return (
        *left_out,
        "DYNNORM and DYNPOS get the recommendation, the others the limits of a machining mode, "
        "judged with its own band. G0 may use MD32434/MD32435 (factors), JOG uses MD32420/MD32430.",
        "The path jerk MD20600 must stay above the axis values, or it limits instead.",
        "If a jerk filter is already on (MD32400 = 1), its time adds to the ramp: switch it off, "
        "or use the alternative below.",
        *((turns,) if subject.is_rotary else ()),
    )


SINUMERIK = Control(
    key="sinumerik",
    coding=_coding,
    describe=_entries,
    layout=lambda entries: line_layout("{name}={value}", semicolon_comment, entries),
    comment=semicolon_comment,
    gains=GainUnits(position=GAIN_PER_MINUTE, velocity=1.0, integral_time=MILLI),
    has_modes=True,
    alternatives=_jerk_filter,
    notes=_notes,
)
