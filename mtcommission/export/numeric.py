"""Numerical controls: SINUMERIK, HEIDENHAIN, FANUC, ISG kernel.

Names and units as the makers' manuals give them; what was not read there is marked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil, pi

from mtcommission.export.control import (
    Block,
    Control,
    Entry,
    bracket_comment,
    hash_comment,
    line_layout,
    semicolon_comment,
    table_layout,
    unverified,
)
from mtcommission.export.rounding import (
    AccelerationForm,
    Coding,
    JerkForm,
    Typed,
    round_down,
    type_limits,
    type_number,
)
from mtcommission.export.subject import Subject, for_mode, judge_setpoints, plan_moves
from mtcommission.limits import MotionLimits
from mtcommission.rules import NO_JERK_LIMIT

MILLI, MICRO = 1e-3, 1e-6
DEGREE, TURN = pi / 180.0, 2.0 * pi
GAIN_PER_MINUTE = 1000.0 / 60.0
"""(m/min)/mm = 1000/min in 1/s."""

DYNAMIC_MODES = (
    ("DYNNORM", ""),
    ("DYNPOS", ""),
    ("DYNROUGH", "speed"),
    ("DYNSEMIFIN", "accuracy"),
    ("DYNFINISH", "surface"),
)
"""SINUMERIK's dynamic modes in the order of their index, and the machining mode of each; ""
takes the recommendation."""

LONGEST_MOVING_AVERAGE = 16
"""Position cycles; the range of SINUMERIK's jerk filter mode 2."""


def whole_cycle(subject: Subject, unit: float) -> int:
    """Return the position cycle in whole units of time [unit in s], at least one."""
    return max(1, ceil(subject.machine.control.position_cycle / unit - 1e-9))


def position_gain(subject: Subject, unit: float) -> str:
    """Return Kv as typed, rounded down, in its unit [1/s]."""
    return type_number(round_down(subject.record["loop"]["Kv"] / unit))


def _typed_by_mode(subject: Subject, coding: Coding) -> dict[str, tuple[Typed, str]]:
    """The limits of each machining mode as typed, and how its own band judges them."""
    length = "urad" if subject.is_rotary else "um"
    found = {}
    for mode in subject.record["limits"]["modes"]:
        typed = type_limits(for_mode(subject, mode), coding)
        met = "met" if typed.verdict.assessment.is_met else "requirements NOT MET"
        found[mode["name"]] = (
            typed,
            f"{mode['name']}, band {1e6 * mode['band']:.4g} {length}, {met}",
        )
    return found


def _sinumerik_coding(subject: Subject) -> Coding:
    unit = TURN if subject.is_rotary else 1.0
    return Coding(acceleration_unit=unit, jerk_unit=unit)


def _sinumerik_entries(subject: Subject, typed: Typed) -> tuple[Entry, ...]:
    length = "rev" if subject.is_rotary else "m"
    gain = position_gain(subject, GAIN_PER_MINUTE)
    loop = subject.record["loop"]
    gain_unit = "N m s/rad" if subject.is_rotary else "N s/m"
    by_mode = _typed_by_mode(subject, _sinumerik_coding(subject))
    rows = [(mode, *by_mode.get(name, (typed, "recommended"))) for mode, name in DYNAMIC_MODES]
    accelerations = tuple(
        Entry(
            name=f"N32300 $MA_MAX_AX_ACCEL[{i}]",
            value=chosen.acceleration,
            unit=f"{length}/s^2",
            meaning=f"{mode}: {about}",
        )
        for i, (mode, chosen, about) in enumerate(rows)
    )
    jerks = tuple(
        unverified(
            Entry(
                name=f"N32431 $MA_MAX_AX_JERK[{i}]",
                value=chosen.jerk,
                unit=f"{length}/s^3",
                meaning=f"{mode}; unit",
            )
        )
        for i, (mode, chosen, _) in enumerate(rows)
    )
    gain_entry = Entry(
        name="N32200 $MA_POSCTRL_GAIN[0]", value=gain, unit="1000/min", meaning="Kv of this loop"
    )
    drive = (
        unverified(
            Entry(
                name="p1460",
                value=type_number(round_down(loop["Kp"])),
                unit=gain_unit,
                meaning="Kp of this loop, at the axis; a rotary motor needs Nms/rad at its shaft",
            )
        ),
        unverified(
            Entry(
                name="p1462",
                value=type_number(round_down(loop["Tn"] / MILLI)),
                unit="ms",
                meaning="Tn of this loop; unit",
            )
        ),
    )
    return (*accelerations, *jerks, gain_entry, *drive)


def _sinumerik_lines(entries: Sequence[Entry]) -> list[str]:
    return line_layout("{name}={value}", semicolon_comment, entries)


def _jerk_filter(subject: Subject, typed: Typed) -> tuple[Block, ...]:
    """The same ramp from the control's moving average instead of the jerk limit."""
    cycle = subject.machine.control.position_cycle
    if subject.machine.control.moving_average_time > 0.0:
        return ()
    count = ceil(typed.limits.jerk_time / cycle - 1e-9)
    if count > LONGEST_MOVING_AVERAGE:
        longest = LONGEST_MOVING_AVERAGE * cycle
        note = (
            f"The ramp of {1e3 * typed.limits.jerk_time:.4g} ms is longer than the filter's usual "
            f"range of {1e3 * longest:.4g} ms ({LONGEST_MOVING_AVERAGE} position cycles), so there "
            "is no alternative with the jerk filter here."
        )
        return (Block(title="Alternative with the jerk filter MD32400", entries=(), notes=(note,)),)
    time = count * cycle
    limits = MotionLimits(
        acceleration=typed.limits.acceleration, jerk=typed.limits.acceleration / NO_JERK_LIMIT
    )
    verdict = judge_setpoints(subject, plan_moves(subject, limits, moving_average=time))
    met = "meets" if verdict.assessment.is_met else "DOES NOT MEET"
    notes = (
        "Set the filter INSTEAD of the jerk limit: raise MD32431 until it no longer acts, keep "
        "the acceleration. Both together would count the jerk time twice.",
        f"Simulated so, it {met} all requirements, settling after "
        f"{1e3 * verdict.settling_time:.4g} ms. The filter also acts on moves that never reach "
        "the acceleration, where a jerk limit leaves vibration.",
    )
    entries = (
        Entry(name="N32400 $MA_AX_JERK_ENABLE", value="1", unit="", meaning="jerk filter on"),
        Entry(name="N32402 $MA_AX_JERK_MODE", value="2", unit="", meaning="moving average"),
        Entry(
            name="N32410 $MA_AX_JERK_TIME",
            value=f"{time:.6g}",
            unit="s",
            meaning=f"{count} position cycles",
        ),
    )
    return (Block(title="Alternative with the jerk filter MD32400", entries=entries, notes=notes),)


def _sinumerik_notes(subject: Subject) -> tuple[str, ...]:
    return (
        "DYNNORM and DYNPOS get the recommendation, the others the limits of a machining mode, "
        "judged with its own band. G0 may use MD32434/MD32435 (factors), JOG uses MD32420/MD32430.",
        "The path jerk MD20600 must stay above the axis values, or it limits instead.",
        "If a jerk filter is already on (MD32400 = 1), its time adds to the ramp: switch it off, "
        "or use the alternative below.",
    )


def _heidenhain_coding(subject: Subject) -> Coding:
    unit = DEGREE if subject.is_rotary else 1.0
    return Coding(acceleration_unit=unit, jerk_unit=unit)


def _heidenhain_entries(subject: Subject, typed: Typed) -> tuple[Entry, ...]:
    unit = "deg" if subject.is_rotary else "m"
    entries = (
        Entry(
            name="maxAcceleration",
            value=typed.acceleration,
            unit=f"{unit}/s^2",
            meaning="acceleration",
        ),
        Entry(name="axPathJerk", value=typed.jerk, unit=f"{unit}/s^3", meaning="axis jerk"),
        Entry(
            name="axPathJerkHi",
            value=typed.jerk,
            unit=f"{unit}/s^3",
            meaning="axis jerk at rapid; the maker's rule of 5 x axPathJerk was not judged",
        ),
        Entry(
            name="kvFactor",
            value=position_gain(subject, 1.0),
            unit="1/s",
            meaning="Kv of this loop",
        ),
    )
    # The manual states m/s^2 for linear axes; degrees for rotary ones are inferred.
    return tuple(map(unverified, entries[:3])) + entries[3:] if subject.is_rotary else entries


def _heidenhain_modes(subject: Subject, _typed: Typed) -> tuple[Block, ...]:
    """The same parameters for each machining mode; HEIDENHAIN's own names for the three."""
    found = _typed_by_mode(subject, _heidenhain_coding(subject))
    return tuple(
        Block(
            title=f"Machining mode {name}",
            entries=_heidenhain_entries(subject, typed)[:3],
            notes=(f"Judged with a band of its own: {about}.",),
        )
        for name, (typed, about) in found.items()
    )


def _heidenhain_notes(subject: Subject) -> tuple[str, ...]:
    return (
        "maxPathJerk and maxPathJerkHi (default 40 m/s^3) and maxPathYank limit the path: keep "
        "them above the axis values, at least 1.75 x the largest axis value by the maker's rule.",
        "The position filters of the control add jerk time of their own: what they add must not "
        "be counted twice.",
        "On an iTNC 530 the Kv factor is in (m/min)/mm.",
    )


def _fanuc_coding(subject: Subject) -> Coding:
    return Coding(
        acceleration_form=AccelerationForm.RISE_TIME,
        acceleration_unit=MILLI,
        jerk_form=JerkForm.TIME,
        jerk_unit=MILLI,
        time_step=whole_cycle(subject, MILLI),
        rapid=_fanuc_rapid(subject)[1],
    )


def _fanuc_rapid(subject: Subject) -> tuple[str, float]:
    """Rapid traverse as typed, per minute, and what it is [m/s]."""
    unit = (DEGREE if subject.is_rotary else MILLI) / 60.0
    number = round_down(subject.fastest / unit)
    return type_number(number), float(number) * unit


def _fanuc_entries(subject: Subject, typed: Typed) -> tuple[Entry, ...]:
    unit = "deg/min" if subject.is_rotary else "mm/min"
    rapid = f"{_fanuc_rapid(subject)[0]} {unit}"
    gain = position_gain(subject, 0.01)
    return (
        Entry(
            name="1620",
            value=typed.acceleration,
            unit="ms",
            meaning=f"time from standstill to rapid traverse, if 1420 = {rapid}",
        ),
        Entry(name="1774", value=typed.jerk, unit="ms", meaning="bell time, acceleration / jerk"),
        unverified(
            Entry(name="1825", value=gain, unit="0.01/s", meaning="Kv of this loop; name and unit")
        ),
    )


def _fanuc_notes(subject: Subject) -> tuple[str, ...]:
    unit = "deg/s^2" if subject.is_rotary else "m/s^2"
    a = subject.limits.acceleration / (DEGREE if subject.is_rotary else 1.0)
    return (
        "There is no jerk in mm/s^3 here: the bell time sets it.",
        "1620 belongs to the fastest move of the profile: leave 1420 as it is, and with another "
        f"rapid traverse v enter 1620 = v / a, rounded up (a = {a:.4g} {unit}).",
        "1788/1789 (acceleration change) and, not verified (?), 1660, 1671 and 1772 limit "
        "look-ahead modes and must not be faster than these values.",
    )


def _isg_coding(subject: Subject) -> Coding:
    return Coding(
        acceleration_unit=DEGREE if subject.is_rotary else MILLI,
        jerk_form=JerkForm.TIME,
        jerk_unit=MICRO,
        time_step=whole_cycle(subject, MICRO),
    )


def _isg_entries(subject: Subject, typed: Typed) -> tuple[Entry, ...]:
    unit = "deg/s^2" if subject.is_rotary else "mm/s^2"
    place = "getriebe[0].slope_profil"
    a = Entry(name=f"{place}.a_beschl", value=typed.acceleration, unit=unit, meaning="acceleration")
    ramp = unverified(
        Entry(name="", value=typed.jerk, unit="us", meaning="ramp time, acceleration / jerk; name")
    )
    others = (
        unverified(replace(a, name=f"{place}.a_brems", meaning="deceleration; name")),
        unverified(replace(a, name=f"{place}.a_grenz", meaning="acceleration at G0; name")),
    )
    names = ("tr_beschl_zu", "tr_beschl_ab", "tr_brems_zu", "tr_brems_ab", "tr_grenz")
    gain = Entry(
        name="getriebe[0].kv",
        value=position_gain(subject, 0.01),
        unit="0.01/s",
        meaning="Kv of this loop",
    )
    ramps = tuple(replace(ramp, name=f"{place}.{name}") for name in names)
    return (a, *others, *ramps, gain)


def _isg_lines(entries: Sequence[Entry]) -> list[str]:
    return line_layout("{name}  {value}", bracket_comment, entries)


def _isg_notes(subject: Subject) -> tuple[str, ...]:
    return (
        "getriebe[0] is the first gear set; repeat the lines for others.",
        "The kernel's own jerk limit is dynamik.a_max / dynamik.tr_min: it must lie above these "
        "values, or it limits instead.",
    )


NUMERIC_CONTROLS = (
    Control(
        key="sinumerik",
        title="SINUMERIK 840D / 828D / ONE",
        coding=_sinumerik_coding,
        describe=_sinumerik_entries,
        layout=_sinumerik_lines,
        comment=semicolon_comment,
        position_gain=GAIN_PER_MINUTE,
        alternatives=_jerk_filter,
        notes=_sinumerik_notes,
    ),
    Control(
        key="heidenhain",
        title="HEIDENHAIN, NCK-based",
        coding=_heidenhain_coding,
        describe=_heidenhain_entries,
        layout=table_layout,
        comment=hash_comment,
        position_gain=1.0,
        alternatives=_heidenhain_modes,
        notes=_heidenhain_notes,
    ),
    Control(
        key="fanuc",
        title="FANUC 16i / 18i / 30i",
        coding=_fanuc_coding,
        describe=_fanuc_entries,
        layout=table_layout,
        comment=hash_comment,
        position_gain=0.01,
        notes=_fanuc_notes,
    ),
    Control(
        key="isg",
        title="ISG kernel / TwinCAT CNC",
        coding=_isg_coding,
        describe=_isg_entries,
        layout=_isg_lines,
        comment=bracket_comment,
        position_gain=0.01,
        notes=_isg_notes,
    ),
)
