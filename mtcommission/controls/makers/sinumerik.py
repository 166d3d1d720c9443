"""SINUMERIK 840D, 828D and ONE: names and units as the manuals give them, the rest is marked."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis, Control, Corner, CornerRule, Typed, say_mode
from mtcommission.controls.kind import (
    EARLIER,
    MOVING_AVERAGE,
    NOTCH,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
    PositionLoop,
    believed,
    read,
)
from mtcommission.controls.row import Row, Setting, Values, doubted, fixed
from mtcommission.controls.syntax import MACHINE_DATA

AXES_2019 = "SINUMERIK Axes and Spindles 06/2019, B2 pp. 371, 377"

LIST_808 = "SINUMERIK 808D ADVANCED Parameter Manual 08/2013, p. 224"

JERK_2005 = "SINUMERIK 840D sl B2 08/2005, 2.17"

COMPENSATIONS = "SINUMERIK Extended Functions 03/2013, K3 pp. 279, 283, B3 p. 84"

SPEED_FFW = "SINUMERIK Extended Functions 01/2008, K3 p. 388"

S120_DSC = "SINAMICS S120 Drive Functions 11/2017, 4.16 p. 170"

S120_LISTS = "SINAMICS S List Manual 07/2007, diagram 3090"

TELEGRAM_105 = "SINAMICS S120 to Technology CPU 09/2011, 5.1.2"

SIMODRIVE = "SIMODRIVE 611 universal 04.05, p. 5-224"

S210_FILTERS = "SINAMICS S210 manual, F07420 p. 445"

S120_FILTERS = "SINAMICS S120 Drive Functions 07/2007, 3.7 p. 81"

PARAMETER_SETS = "SINUMERIK 828D Basic Functions 09/2011, G2 7.5"

ADDRESSES = {
    AXES_2019: "manual.onestart.ai/manuals/Siemens-SINUMERIK-840D-Function-Manual-5628446",
    LIST_808: "easymanua.ls/siemens/sinumerik-808d-advanced/manual?p=224",
    JERK_2005: "easymanua.ls/siemens/sinumerik-840de-sl/manual/32519?p=244",
    COMPENSATIONS: "easymanua.ls/siemens/sinumerik-series/manual/275710?p=279",
    SPEED_FFW: "manual.onestart.ai/manuals/Siemens-SINUMERIK-840D-sl-Function-Manual-5628453",
    S120_DSC: "manualshive.com/en/manual/siemens/sinamics-s120/376543?page=170",
    S120_LISTS: "easymanua.ls/siemens/sinamics-s-series/manual?p=1234",
    TELEGRAM_105: "manualshelf.com/manual/connect-tech/cpu/technical-data-english/page-129.html",
    SIMODRIVE: "manualshive.com/ru/manual/siemens/simodrive-611-universal/1265789?page=224",
    S210_FILTERS: "easymanua.ls/siemens/sinamics-s210/manual?p=445",
    S120_FILTERS: "azmanual.top/manuals/84895",
    PARAMETER_SETS: "manualshive.com, sinumerik-828d-turning_function-manual_376603-378",
}
"""Where each source was read, November 2026."""

SINUMERIK = ControlKind(
    key="sinumerik",
    modes=("DYNNORM", "DYNPOS", "DYNROUGH", "DYNSEMIFIN", "DYNFINISH"),
    setpoint_filters=(
        FilterChoice(kind=MOVING_AVERAGE, least_cycles=1.0, advised_cycles=16.0),
        FilterChoice(kind=TWO_AVERAGES, least_cycles=1.0, advised_cycles=16.0),
    ),
    position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL, PositionLoop.INTERPOLATED),
    force_filters=4,
    features={
        "acceleration": read(
            f"{EARLIER}; {AXES_2019}",
            "MD32300 MAX_AX_ACCEL[0..4] [m/s^2, rev/s^2]",
            "G0: times MD32434.",
        ),
        "jerk": read(
            f"{EARLIER}; {AXES_2019}",
            "MD32431 MAX_AX_JERK[0..4] [m/s^3, rev/s^3 (?)]",
            "Path MD20600 above it; G0: times MD32435; JOG: MD32420, MD32430.",
        ),
        "modes": read(EARLIER, "index 0..4 of the limits", "A sixth column in newer software (?)."),
        "setpoint_filters": read(
            f"{AXES_2019}; {LIST_808}; {JERK_2005}",
            "MD32400 = 1; MD32402 = 2 (one average) or 4 (two); MD32410, MD32411 [s]",
            "One per axis. An average acts only above one position cycle; the maker advises 1 to "
            "16, and warns of contour error with two equal ones. Second order, band-stop and FIR "
            "(MD32402 = 1, 3, 5) are not offered: the first two ring on without end, and the taps "
            "of the third were not read.",
        ),
        "velocity_feedforward": read(
            f"{COMPENSATIONS}; {SPEED_FFW}",
            "MD32620 FFW_MODE = 3, MD32610 VELO_FFW_WEIGHT[set] 0..1",
            "From the program by FFWON if MD32630 = 1 or 2.",
        ),
        "acceleration_feedforward": read(
            COMPENSATIONS,
            "MD32620 FFW_MODE = 4, MD32650 AX_INERTIA [kg m^2 (?)], MD32652 AX_MASS [kg (?)]",
            "Without spline telegrams it arrives in steps of a position cycle.",
        ),
        "jerk_feedforward": read(COMPENSATIONS, note="In none of the sources."),
        "reference_delay": read(
            f"{COMPENSATIONS}; {PARAMETER_SETS}; {S120_DSC}",
            "MD32810 EQUIV_SPEEDCTRL_TIME [s] with speed, MD32800 EQUIV_CURRCTRL_TIME [s] with "
            "torque feed-forward",
            "Belongs to feed-forward. With spline DSC the drive balances itself: p1195, p1427.",
        ),
        "position_loops": believed(
            "MD32640 STIFFNESS_CONTROL_ENABLE = 1 and telegram 105/106: DSC in the drive",
            "DSC needs a P controller and clock-synchronous operation. The smooth setpoint that is "
            "simulated needs a spline telegram (125, 126, 136 (?)).",
            beside=f"{S120_LISTS}; {TELEGRAM_105}; {S120_DSC}",
        ),
        "position_cycle": read(
            COMPENSATIONS,
            "MD10050 x MD10060 (?), shown in MD10061",
            "1 to 2 ms typical; 828D 1.5 or 3 ms (?). Ratio fixed at 1 on an 840D sl; MD10070 is "
            "that of the interpolator.",
        ),
        "velocity_cycle": read(EARLIER, note="125 us in the maker's example."),
        "position_gain": read(
            f"{EARLIER}; {SIMODRIVE}", "MD32200 POSCTRL_GAIN[set] [(m/min)/mm]", "Double."
        ),
        "velocity_gain": read(
            f"{EARLIER}; {S210_FILTERS}",
            "p1460 [N m s/rad, linear N s/m (?)], p1462 [ms], p1433 to p1435 (?)",
            "At the motor shaft.",
        ),
        "force_filters": read(
            f"{S210_FILTERS}; {S120_FILTERS}",
            "p1656, p1657 to p1676 (order (?))",
            "Four, ten with the extended module; below half the current controller's rate.",
        ),
        "state_feedback": read(S210_FILTERS, note="None; APC is an option of the drive (?)."),
    },
)

DYNAMIC_MODES = (
    ("DYNNORM", ""),
    ("DYNPOS", ""),
    ("DYNROUGH", "speed"),
    ("DYNSEMIFIN", "accuracy"),
    ("DYNFINISH", "surface"),
)
"""SINUMERIK's dynamic modes in the order of their index, and the machining mode of each; ""
takes the recommendation."""


def _sinumerik(axis: Axis, loop: Values) -> list[Row]:
    length = "rev" if axis.is_rotary else "m"
    rows = [
        Row(
            Setting.ACCELERATION,
            f"N32300 $MA_MAX_AX_ACCEL[{index}]",
            index=mode,
            unit=f"{length}/s^2",
            meaning=Message("sinumerik-mode", dynamic=dynamic, about=say_mode(axis, mode)),
        )
        for index, (dynamic, mode) in enumerate(DYNAMIC_MODES)
    ]
    rows += [
        doubted(
            Setting.JERK,
            f"N32431 $MA_MAX_AX_JERK[{index}]",
            index=mode,
            unit=f"{length}/s^3",
            meaning=Message("sinumerik-mode-unit", dynamic=dynamic),
        )
        for index, (dynamic, mode) in enumerate(DYNAMIC_MODES)
    ]
    return [
        *rows,
        *_sinumerik_average(loop),
        Row(Setting.POSITION_GAIN, "N32200 $MA_POSCTRL_GAIN[0]", unit="1000/min"),
        *_sinumerik_feedforward(axis, loop),
        doubted(
            Setting.POSITION_LOOP,
            "N32640 $MA_STIFFNESS_CONTROL_ENABLE[0]",
            codes={"drive": "1", "control": "0"},
            meaning="sinumerik-dsc",
        ),
        *_sinamics(axis, loop),
        Row(
            Setting.POSITION_CYCLE,
            "N10050 x N10060",
            unit="us",
            digits=9,
            meaning="sinumerik-position-cycle",
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
            meaning="sinumerik-filter-off",
        )
        return
    yield fixed("N32400 $MA_AX_JERK_ENABLE", "1", "sinumerik-filter-on")
    has_two = (Setting.SECOND_AVERAGE, "") in loop
    kind = "sinumerik-two-averages" if has_two else "moving-average"
    yield fixed("N32402 $MA_AX_JERK_MODE", "4" if has_two else "2", Message(kind))
    yield Row(Setting.AVERAGE, "N32410 $MA_AX_JERK_TIME", unit="s", digits=6)
    yield Row(Setting.SECOND_AVERAGE, "N32411 $MA_AX_JERK_TIME_ADD", unit="s", digits=6)


def _sinumerik_feedforward(axis: Axis, loop: Values) -> Iterator[Row]:
    which = loop[Setting.FEEDFORWARD, ""]
    yield Row(
        Setting.FEEDFORWARD,
        "N32620 $MA_FFW_MODE",
        codes={"none": "0", "velocity": "3", "force": "4"},
        meaning="sinumerik-ffw-mode",
    )
    yield Row(Setting.VELOCITY_FEEDFORWARD, "N32610 $MA_VELO_FFW_WEIGHT[0]")
    if axis.shaft:
        yield doubted(
            Setting.FORCE_FEEDFORWARD,
            "N32650 $MA_AX_INERTIA",
            unit="kg m^2",
            at_shaft=axis.shaft**-2,
            meaning="row-feedforward-inertia",
        )
    if which != "none":
        data = "32800 $MA_EQUIV_CURRCTRL" if which == "force" else "32810 $MA_EQUIV_SPEEDCTRL"
        yield doubted(
            Setting.REFERENCE_DELAY,
            f"N{data}_TIME[0]",
            unit="s",
            digits=6,
            meaning="sinumerik-delay",
        )


def _sinamics(axis: Axis, loop: Values) -> Iterator[Row]:
    """Parameters of the drive; five for each of its four filters of the torque setpoint."""
    if axis.shaft:
        yield Row(
            Setting.VELOCITY_GAIN,
            "p1460",
            unit="N m s/rad",
            at_shaft=axis.shaft**-2,
            meaning="gain-kp-at-shaft",
        )
    yield doubted(Setting.INTEGRAL_TIME, "p1462", unit="ms", meaning="gain-tn-unit")
    yield doubted(
        Setting.FILTERS,
        "p1656",
        codes={float(count): str(2**count - 1) for count in range(5)},
        meaning="sinumerik-filters",
    )
    for number in range(1, 5):
        index, first = str(number), 1652 + 5 * number
        is_notch = loop.get((Setting.FILTER_KIND, index)) == NOTCH
        yield doubted(
            Setting.FILTER_KIND,
            f"p{first}",
            index=index,
            codes={"low_pass": "1", "notch": "2"},
            meaning="sinumerik-filter-kind",
        )
        # The damping of a notch is that of the numerator, its width that of the denominator.
        own, other = Setting.FILTER_DAMPING, Setting.FILTER_WIDTH
        parts = ("denominator", "numerator") if is_notch else ("denominator",)
        for place, part in enumerate(parts):
            frequency = first + 1 + 2 * place
            yield doubted(
                Setting.FILTER_FREQUENCY,
                f"p{frequency}",
                index=index,
                unit="Hz",
                digits=5,
                meaning=Message(f"sinumerik-{part}-frequency"),
            )
            yield doubted(
                other if is_notch and part == "denominator" else own,
                f"p{frequency + 1}",
                index=index,
                meaning=Message(f"sinumerik-{part}-damping"),
            )


def _sinumerik_notes(axis: Axis, _typed: Typed) -> tuple[Message, ...]:
    return (
        Message("sinumerik-dynamic-modes" if axis.bands else "sinumerik-one-mode"),
        Message("sinumerik-path-jerk"),
        *((Message("sinumerik-turns"),) if axis.is_rotary else ()),
    )


IN_GROUP = (
    fixed("N32900 $MA_DYN_MATCH_ENABLE", "1", "group-row-match"),
    Row(Setting.WAIT, "N32910 $MA_DYN_MATCH_TIME[0]", unit="s", digits=6),
    Row(
        Setting.TOGETHER,
        "N33100 $MA_COMPRESS_POS_TOL",
        index="corner",
        unit="mm",
        meaning="group-row-arc",
    ),
)
"""Source: 828D Basic Functions 09/2011, G2 7.5, and 802S p. 4-41 (0.0960 s, more exactly for fine
adaptation; that it acts in parts of a position cycle (?)); 01/2015, B1 4.3 p. 193."""

GROUP = (
    fixed("N42502 $SC_IS_SD_MAX_PATH_ACCEL", "1", "group-row-acceleration-on"),
    doubted(Setting.TOGETHER, "N42500 $SC_SD_MAX_PATH_ACCEL", index="acceleration", unit="m/s^2"),
    doubted(Setting.TOGETHER, "N20600 $MC_MAX_PATH_JERK[0]", index="jerk", unit="m/s^3"),
)
"""Source: 828D Basic Functions 09/2011, B2 4.2.6 and 4.2.12.3; the index of MD20600 (?), and
whether SD42500 counts on circles, for which MD20602 names a share of the axes' limits, too (?)."""

CONTROL = Control(
    kind=SINUMERIK,
    rows=_sinumerik,
    layout=MACHINE_DATA,
    notes_of=_sinumerik_notes,
    axis_in_group=IN_GROUP,
    group=GROUP,
    corner=CornerRule(
        kind=Corner.ARC,
        source="SINUMERIK Basic Functions 01/2015, B1 4.3 p. 193; that it is an arc (?)",
        is_verified=False,
    ),
)
