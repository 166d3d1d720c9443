"""SINUMERIK 840D, 828D and ONE: names and units as the manuals give them, the rest is marked."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis, Control, Corner, CornerRule, Typed
from mtcommission.controls.kind import (
    MOVING_AVERAGE,
    NOTCH,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
    PositionLoop,
)
from mtcommission.controls.row import (
    Row,
    Setting,
    Values,
    at_corners,
    doubted,
    fixed,
    on_path,
)
from mtcommission.controls.syntax import MACHINE_DATA

DYNAMIC_MODES = {
    "DYNNORM": "",
    "DYNPOS": "",
    "DYNROUGH": "speed",
    "DYNSEMIFIN": "accuracy",
    "DYNFINISH": "surface",
}
"""Dynamic modes in the order of their index, and the machining mode of each; "" takes the
recommendation."""


def _rows(axis: Axis, loop: Values) -> Iterator[Row]:
    length = "rev" if axis.is_rotary else "m"
    for index, (dynamic, mode) in enumerate(DYNAMIC_MODES.items()):
        name, unit = f"N32300 $MA_MAX_AX_ACCEL[{index}]", f"{length}/s^2"
        said = Message("sinumerik-mode", dynamic=dynamic, about=axis.say_mode(mode))
        yield Row(Setting.ACCELERATION, name, index=mode, unit=unit, meaning=said)
    for index, (dynamic, mode) in enumerate(DYNAMIC_MODES.items()):
        name, unit = f"N32431 $MA_MAX_AX_JERK[{index}]", f"{length}/s^3"
        said = Message("sinumerik-mode-unit", dynamic=dynamic)
        yield doubted(Setting.JERK, name, index=mode, unit=unit, meaning=said)
    yield from _average(loop)
    yield Row(Setting.POSITION_GAIN, "N32200 $MA_POSCTRL_GAIN[0]", unit="1000/min")
    yield from _feedforward(axis, loop)
    yield doubted(
        Setting.POSITION_LOOP,
        "N32640 $MA_STIFFNESS_CONTROL_ENABLE[0]",
        codes={"drive": "1", "control": "0"},
        meaning="sinumerik-dsc",
    )
    yield from _drive(axis, loop)
    cycle, said = "N10050 x N10060", Message("sinumerik-position-cycle")
    yield Row(Setting.POSITION_CYCLE, cycle, unit="us", digits=9, meaning=said, is_elsewhere=True)


def _average(loop: Values) -> Iterator[Row]:
    """The jerk filter, on as moving average or off."""
    enable = "N32400 $MA_AX_JERK_ENABLE"
    if not loop.get((Setting.AVERAGE, "")):
        yield Row(Setting.AVERAGE, enable, codes={0.0: "0"}, meaning="sinumerik-filter-off")
        return
    yield fixed(enable, "1", "sinumerik-filter-on")
    has_two = (Setting.SECOND_AVERAGE, "") in loop
    kind = "sinumerik-two-averages" if has_two else "moving-average"
    yield fixed("N32402 $MA_AX_JERK_MODE", "4" if has_two else "2", kind)
    yield Row(Setting.AVERAGE, "N32410 $MA_AX_JERK_TIME", unit="s", digits=6)
    yield Row(Setting.SECOND_AVERAGE, "N32411 $MA_AX_JERK_TIME_ADD", unit="s", digits=6)


def _feedforward(axis: Axis, loop: Values) -> Iterator[Row]:
    which = loop[Setting.FEEDFORWARD, ""]
    codes = {"none": "0", "velocity": "3", "force": "4"}
    name = "N32620 $MA_FFW_MODE"
    yield Row(Setting.FEEDFORWARD, name, codes=codes, meaning="sinumerik-ffw-mode")
    yield Row(Setting.VELOCITY_FEEDFORWARD, "N32610 $MA_VELO_FFW_WEIGHT[0]")
    force, name, said = (
        Setting.FORCE_FEEDFORWARD,
        "N32650 $MA_AX_INERTIA",
        "row-feedforward-inertia",
    )
    yield from axis.rows_at_shaft(force, name, "kg m^2", said, is_verified=False)
    if which != "none":
        data = "32800 $MA_EQUIV_CURRCTRL" if which == "force" else "32810 $MA_EQUIV_SPEEDCTRL"
        name, said = f"N{data}_TIME[0]", "sinumerik-delay"
        yield doubted(Setting.REFERENCE_DELAY, name, unit="s", digits=6, meaning=said)


def _drive(axis: Axis, loop: Values) -> Iterator[Row]:
    """Parameters of the drive; five for each of its four filters of the torque setpoint."""
    gain = Setting.VELOCITY_GAIN
    yield from axis.rows_at_shaft(gain, "p1460", "N m s/rad", "gain-kp-at-shaft")
    yield doubted(Setting.INTEGRAL_TIME, "p1462", unit="ms", meaning="gain-tn-unit")
    counts = {float(count): str(2**count - 1) for count in range(5)}
    yield doubted(Setting.FILTERS, "p1656", codes=counts, meaning="sinumerik-filters")
    kinds = {"low_pass": "1", "notch": "2"}
    for number in range(1, 5):
        index, first = str(number), 1652 + 5 * number
        row = partial(doubted, index=index)
        yield row(Setting.FILTER_KIND, f"p{first}", codes=kinds, meaning="sinumerik-filter-kind")
        # The damping of a notch is that of the numerator, its width that of the denominator.
        is_notch = loop.get((Setting.FILTER_KIND, index)) == NOTCH
        parts = {"denominator": Setting.FILTER_WIDTH if is_notch else Setting.FILTER_DAMPING}
        if is_notch:
            parts["numerator"] = Setting.FILTER_DAMPING
        for place, (part, damping) in enumerate(parts.items()):
            own, said = first + 1 + 2 * place, f"sinumerik-{part}"
            frequency = f"{said}-frequency"
            yield row(Setting.FILTER_FREQUENCY, f"p{own}", unit="Hz", digits=5, meaning=frequency)
            yield row(damping, f"p{own + 1}", meaning=f"{said}-damping")


def _notes(axis: Axis, _typed: Typed) -> tuple[Message, ...]:
    return (
        Message("sinumerik-dynamic-modes" if axis.bands else "sinumerik-one-mode"),
        Message("sinumerik-path-jerk"),
        *((Message("sinumerik-turns"),) if axis.is_rotary else ()),
    )


CONTROL = Control(
    kind=ControlKind(
        key="sinumerik",
        unread=("position_loops",),
        modes=tuple(DYNAMIC_MODES),
        setpoint_filters=(
            FilterChoice(kind=MOVING_AVERAGE, least_cycles=1.0, advised_cycles=16.0),
            FilterChoice(kind=TWO_AVERAGES, least_cycles=1.0, advised_cycles=16.0),
        ),
        position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL, PositionLoop.INTERPOLATED),
        force_filters=4,
    ),
    rows=_rows,
    layout=MACHINE_DATA,
    notes_of=_notes,
    # 828D Basic Functions 09/2011, G2 7.5, and 802S p. 4-41 (0.0960 s, more exactly for fine
    # adaptation; that it acts in parts of a position cycle (?)); 01/2015, B1 4.3 p. 193.
    axis_in_group=(
        fixed("N32900 $MA_DYN_MATCH_ENABLE", "1", "group-row-match"),
        Row(Setting.WAIT, "N32910 $MA_DYN_MATCH_TIME[0]", unit="s", digits=6),
        at_corners("N33100 $MA_COMPRESS_POS_TOL", "mm", "group-row-arc"),
    ),
    # 828D Basic Functions 09/2011, B2 4.2.6 and 4.2.12.3; the index of MD20600 (?), and whether
    # SD42500 counts on circles, for which MD20602 names a share of the axes' limits, too (?).
    group=(
        fixed("N42502 $SC_IS_SD_MAX_PATH_ACCEL", "1", "group-row-acceleration-on"),
        on_path("acceleration", "N42500 $SC_SD_MAX_PATH_ACCEL", "m/s^2", is_verified=False),
        *(
            on_path("jerk", f"N20600 $MC_MAX_PATH_JERK[{index}]", "m/s^3", is_verified=False)
            for index, mode in enumerate(DYNAMIC_MODES.values())
            if not mode  # those that get the recommendation
        ),
    ),
    # SINUMERIK Basic Functions 01/2015, B1 4.3 p. 193; that it is an arc (?)
    corner=CornerRule(kind=Corner.ARC, is_verified=False),
)
