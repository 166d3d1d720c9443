"""Numerical controls: SINUMERIK, HEIDENHAIN, FANUC, ISG kernel.

Names and units as the makers' manuals give them; what was not read there is marked.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import ceil

from mtcommission.export.choose import Chosen
from mtcommission.export.control import Control
from mtcommission.export.held import read_limits
from mtcommission.export.layout import MACHINE_DATA, NAMED_LIST, TABLE
from mtcommission.export.row import Row, Setting, Values, fixed
from mtcommission.export.subject import Subject
from mtcommission.export.wording import DEGREE, MICRO, MILLI, TURN, name_mode, show_value
from mtcommission.machine.control import FilterKind
from mtcommission.messages.message import Message

HUNDREDTH = 0.01
"""Unit of the position gain in FANUC's and ISG's parameters [1/s]."""

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

doubted = partial(Row, is_verified=False)
"""A row whose name or unit was not read in a maker's text."""


def _place(loop: Values) -> float | str:
    return loop[Setting.POSITION_LOOP, ""]


def _cycles(subject: Subject, unit: float) -> int:
    """The position cycle in whole units of time [unit in s], at least one."""
    return max(1, ceil(subject.controller.position_cycle / unit - 1e-9))


def _of_mode(subject: Subject, mode: str) -> Message:
    for entry in subject.record.limits.modes:
        if entry.name == mode:
            band = show_value(entry.band, subject.length, in_degrees=True)
            return Message("limit-of-mode", mode=name_mode(mode), band=band)
    return Message("limit-recommended")


def _sinumerik(subject: Subject, loop: Values) -> list[Row]:
    length, size = ("rev", TURN) if subject.is_rotary else ("m", 1.0)
    rows = [
        Row(
            Setting.ACCELERATION,
            f"N32300 $MA_MAX_AX_ACCEL[{index}]",
            index=mode,
            unit=f"{length}/s^2",
            scale=size,
            meaning=Message("sinumerik-mode", dynamic=dynamic, about=_of_mode(subject, mode)),
        )
        for index, (dynamic, mode) in enumerate(DYNAMIC_MODES)
    ]
    rows += [
        doubted(
            Setting.JERK,
            f"N32431 $MA_MAX_AX_JERK[{index}]",
            index=mode,
            unit=f"{length}/s^3",
            scale=size,
            meaning=Message("sinumerik-mode-unit", dynamic=dynamic),
        )
        for index, (dynamic, mode) in enumerate(DYNAMIC_MODES)
    ]
    return [
        *rows,
        *_sinumerik_average(loop),
        Row(
            Setting.POSITION_GAIN,
            "N32200 $MA_POSCTRL_GAIN[0]",
            unit="1000/min",
            scale=GAIN_PER_MINUTE,
        ),
        *_sinumerik_feedforward(subject, loop),
        doubted(
            Setting.POSITION_LOOP,
            "N32640 $MA_STIFFNESS_CONTROL_ENABLE[0]",
            codes={"drive": "1", "control": "0"},
            meaning=Message("sinumerik-dsc"),
        ),
        *_sinamics(subject, loop),
        Row(
            Setting.POSITION_CYCLE,
            "position cycle",
            unit="us",
            scale=MICRO,
            digits=9,
            meaning=Message("sinumerik-position-cycle"),
            is_elsewhere=True,
        ),
    ]


def _sinumerik_average(loop: Values) -> Iterator[Row]:
    """The jerk filter, on as moving average or off."""
    if not loop.get((Setting.AVERAGE, "")):
        yield Row(
            Setting.AVERAGE,
            "N32400 $MA_AX_JERK_ENABLE",
            codes={0.0: "0"},
            meaning=Message("sinumerik-filter-off"),
        )
        return
    yield fixed("N32400 $MA_AX_JERK_ENABLE", "1", Message("sinumerik-filter-on"))
    has_two = (Setting.SECOND_AVERAGE, "") in loop
    kind = "sinumerik-two-averages" if has_two else "sinumerik-moving-average"
    yield fixed("N32402 $MA_AX_JERK_MODE", "4" if has_two else "2", Message(kind))
    yield Row(Setting.AVERAGE, "N32410 $MA_AX_JERK_TIME", unit="s", digits=6)
    yield Row(Setting.SECOND_AVERAGE, "N32411 $MA_AX_JERK_TIME_ADD", unit="s", digits=6)


def _sinumerik_feedforward(subject: Subject, loop: Values) -> Iterator[Row]:
    which = loop[Setting.FEEDFORWARD, ""]
    yield Row(
        Setting.FEEDFORWARD,
        "N32620 $MA_FFW_MODE",
        codes={"none": "0", "velocity": "3", "force": "4"},
        meaning=Message("sinumerik-ffw-mode"),
    )
    yield Row(Setting.VELOCITY_FEEDFORWARD, "N32610 $MA_VELO_FFW_WEIGHT[0]")
    if subject.shaft:
        yield doubted(
            Setting.FORCE_FEEDFORWARD,
            "N32650 $MA_AX_INERTIA",
            unit="kg m^2",
            scale=subject.shaft**-2,
            meaning=Message("row-feedforward-inertia"),
        )
    if which != "none":
        data = "32800 $MA_EQUIV_CURRCTRL" if which == "force" else "32810 $MA_EQUIV_SPEEDCTRL"
        yield doubted(
            Setting.REFERENCE_DELAY,
            f"N{data}_TIME[0]",
            unit="s",
            digits=6,
            meaning=Message("sinumerik-delay"),
        )


def _sinamics(subject: Subject, loop: Values) -> Iterator[Row]:
    """Parameters of the drive; five for each of its four filters of the torque setpoint."""
    if subject.shaft:
        yield Row(
            Setting.VELOCITY_GAIN,
            "p1460",
            unit="N m s/rad",
            scale=subject.shaft**-2,
            meaning=Message("gain-kp-at-shaft"),
        )
    yield doubted(
        Setting.INTEGRAL_TIME, "p1462", unit="ms", scale=MILLI, meaning=Message("gain-tn-unit")
    )
    yield doubted(
        Setting.FILTERS,
        "p1656",
        codes={float(count): str(2**count - 1) for count in range(5)},
        meaning=Message("sinumerik-filters"),
    )
    for number in range(1, 5):
        index, first = str(number), 1652 + 5 * number
        is_notch = loop.get((Setting.FILTER_KIND, index)) == FilterKind.NOTCH.value
        yield doubted(
            Setting.FILTER_KIND,
            f"p{first}",
            index=index,
            codes={"low_pass": "1", "notch": "2"},
            meaning=Message("sinumerik-filter-kind"),
        )
        for place in (first + 1, first + 3) if is_notch else (first + 1,):
            yield doubted(Setting.FILTER_FREQUENCY, f"p{place}", index=index, unit="Hz", digits=5)
        own, other = (first + 4, first + 2) if is_notch else (first + 2, first + 4)
        yield doubted(Setting.FILTER_DAMPING, f"p{own}", index=index)
        yield doubted(Setting.FILTER_WIDTH, f"p{other}", index=index)


def _sinumerik_notes(subject: Subject, _chosen: Chosen) -> tuple[Message, ...]:
    return (
        Message("sinumerik-dynamic-modes"),
        Message("sinumerik-path-jerk"),
        *((Message("sinumerik-turns"),) if subject.is_rotary else ()),
    )


def _heidenhain(subject: Subject, _loop: Values) -> list[Row]:
    length, size = ("deg", DEGREE) if subject.is_rotary else ("m", 1.0)
    # The manual states m/s^2 for linear axes; degrees for rotary ones are inferred, and so are
    # columns for the machining modes.
    rows = []
    for mode in ("", "surface", "accuracy", "speed"):
        row = partial(Row, index=mode, is_verified=not (subject.is_rotary or mode), scale=size)
        for_mode = f", {mode}" if mode else ""
        rows += [
            row(
                Setting.ACCELERATION,
                f"maxAcceleration{for_mode}",
                unit=f"{length}/s^2",
                meaning=_of_mode(subject, mode),
            ),
            row(
                Setting.JERK,
                f"axPathJerk{for_mode}",
                unit=f"{length}/s^3",
                meaning=Message("limit-axis-jerk"),
            ),
            row(
                Setting.JERK,
                f"axPathJerkHi{for_mode}",
                unit=f"{length}/s^3",
                meaning=Message("limit-axis-jerk-at-rapid"),
            ),
        ]
    return [
        *rows,
        Row(Setting.POSITION_GAIN, "kvFactor", unit="1/s"),
        Row(Setting.VELOCITY_FEEDFORWARD, "feedForwardFactor"),
    ]


def _heidenhain_notes(_subject: Subject, _chosen: Chosen) -> tuple[Message, ...]:
    return (
        Message("heidenhain-path"),
        Message("heidenhain-filters"),
        Message("heidenhain-speed-gains"),
        Message("heidenhain-itnc"),
    )


def _fanuc(subject: Subject, _loop: Values) -> list[Row]:
    length, size = subject.small_unit
    return [
        Row(Setting.RISE_TIME, "1620", unit="ms", scale=MILLI, step=1),
        Row(Setting.JERK_TIME, "1774", unit="ms", scale=MILLI, step=_cycles(subject, MILLI)),
        doubted(
            Setting.POSITION_GAIN,
            "1825",
            unit="0.01/s",
            scale=HUNDREDTH,
            step=1,
            meaning=Message("gain-kv-name-and-unit"),
        ),
        doubted(Setting.VELOCITY_FEEDFORWARD, "2068", unit="0.01 %", scale=1e-4, step=1),
        Row(Setting.RAPID, "1420", unit=f"{length}/min", scale=size / 60.0, is_elsewhere=True),
    ]


def _fanuc_notes(subject: Subject, chosen: Chosen) -> tuple[Message, ...]:
    length, size = subject.small_unit
    a = read_limits(chosen.values).acceleration / size
    return (
        Message("fanuc-no-jerk", length=length),
        Message("fanuc-rapid", length=length, acceleration=a),
        Message("fanuc-gain"),
        Message("fanuc-nano"),
        Message("fanuc-look-ahead"),
    )


RAMPS = (
    ("tr_beschl_zu", Message("isg-acceleration-rises")),
    ("tr_beschl_ab", Message("isg-acceleration-falls")),
    ("tr_brems_zu", Message("isg-deceleration-rises")),
    ("tr_brems_ab", Message("isg-deceleration-falls")),
    ("tr_grenz", Message("isg-ramp-at-rapid")),
)
"""P-AXIS-00196, 195, 198, 197 and 200 of the kernel."""


def _isg(subject: Subject, loop: Values) -> Iterator[Row]:
    length, size = subject.small_unit
    for name, meaning in (
        ("a_beschl", Message("limit-acceleration")),
        ("a_brems", Message("limit-deceleration")),
        ("a_grenz", Message("isg-acceleration-at-rapid")),
    ):
        yield Row(
            Setting.ACCELERATION,
            f"getriebe[0].slope_profil.{name}",
            unit=f"{length}/s^2",
            scale=size,
            step=1,
            meaning=meaning,
        )
    for name, meaning in RAMPS:
        yield Row(
            Setting.JERK_TIME,
            f"getriebe[0].slope_profil.{name}",
            unit="us",
            scale=MICRO,
            step=_cycles(subject, MICRO),
            meaning=meaning,
        )
    yield Row(
        Setting.POSITION_LOOP,
        "antr.operation_mode",
        codes={"drive": "DSC_POSITION_CONTROL", "control": "CNC_POSITION_CONTROL"},
        meaning=Message("isg-operation-mode"),
    )
    if _place(loop) != "drive":
        yield Row(Setting.POSITION_GAIN, "getriebe[0].kv", unit="0.01/s", scale=HUNDREDTH, step=1)
    yield doubted(
        Setting.FEEDFORWARD,
        "vorsteuer.vorsteuerung",
        codes={"none": "0", "velocity": "0x101", "force": "0x303"},
        meaning=Message("isg-feedforward"),
    )
    if subject.shaft:
        yield Row(
            Setting.FORCE_FEEDFORWARD,
            "getriebe[0].load",
            unit="kg m^2",
            scale=subject.shaft**-2,
            meaning=Message("row-feedforward-inertia"),
        )
    if loop.get((Setting.AVERAGE, "")):
        yield fixed("filter_fir.type", "1", Message("isg-moving-average"))
        yield Row(Setting.AVERAGE, "filter_fir.order_time", unit="us", scale=MICRO, digits=9)


def _isg_notes(_subject: Subject, _chosen: Chosen) -> tuple[Message, ...]:
    return (Message("isg-gear-sets"), Message("isg-own-limits"), Message("isg-slope"))


NUMERIC_CONTROLS = (
    Control(key="sinumerik", rows=_sinumerik, layout=MACHINE_DATA, notes=_sinumerik_notes),
    Control(key="heidenhain", rows=_heidenhain, layout=TABLE, notes=_heidenhain_notes),
    Control(key="fanuc", rows=_fanuc, layout=TABLE, notes=_fanuc_notes),
    Control(key="isg", rows=lambda *of: tuple(_isg(*of)), layout=NAMED_LIST, notes=_isg_notes),
)
