"""The ISG kernel, also as TwinCAT CNC."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.controls.control import Axis, Control, Corner, CornerRule
from mtcommission.controls.kind import (
    MOVING_AVERAGE,
    ControlKind,
    FilterChoice,
    Jerk,
    PositionLoop,
)
from mtcommission.controls.row import Row, Setting, Values, at_corners, doubted, fixed
from mtcommission.controls.syntax import NAMED_LIST

ACCELERATIONS = {
    "a_beschl": "acceleration",
    "a_brems": "limit-deceleration",
    "a_grenz": "isg-acceleration-at-rapid",
}
RAMPS = {
    "tr_beschl_zu": "isg-acceleration-rises",
    "tr_beschl_ab": "isg-acceleration-falls",
    "tr_brems_zu": "isg-deceleration-rises",
    "tr_brems_ab": "isg-deceleration-falls",
    "tr_grenz": "isg-ramp-at-rapid",
}
"""P-AXIS-00196, 195, 198, 197 and 200 of the kernel."""


def _rows(axis: Axis, loop: Values) -> Iterator[Row]:
    slope = "getriebe[0].slope_profil"
    for name, meaning in ACCELERATIONS.items():
        yield axis.acceleration_row(f"{slope}.{name}", meaning, step=1)
    step = axis.cycles(1e-6)
    for name, meaning in RAMPS.items():
        yield Row(Setting.JERK_TIME, f"{slope}.{name}", unit="us", step=step, meaning=meaning)
    yield Row(
        Setting.POSITION_LOOP,
        "antr.operation_mode",
        codes={"drive": "DSC_POSITION_CONTROL", "control": "CNC_POSITION_CONTROL"},
        meaning="isg-operation-mode",
    )
    if loop[Setting.POSITION_LOOP, ""] != "drive":
        yield Row(Setting.POSITION_GAIN, "getriebe[0].kv", unit="0.01/s", step=1)
    yield doubted(
        Setting.FEEDFORWARD,
        "vorsteuer.vorsteuerung",
        codes={"none": "0", "velocity": "0x101", "force": "0x303"},
        meaning="isg-feedforward",
    )
    force, said = Setting.FORCE_FEEDFORWARD, "row-feedforward-inertia"
    yield from axis.rows_at_shaft(force, "getriebe[0].load", "kg m^2", said)
    if loop.get((Setting.AVERAGE, "")):
        yield fixed("filter_fir.type", "1", "isg-moving-average")
        yield Row(Setting.AVERAGE, "filter_fir.order_time", unit="us", digits=9)


DEVIATION = "#CONTOUR MODE [DEV, PATH_DEV v]: v"

CONTROL = Control(
    kind=ControlKind(
        key="isg",
        unread=("velocity_cycle", "force_filters"),
        jerk=Jerk.TIME,
        setpoint_filters=(
            FilterChoice(kind=MOVING_AVERAGE, least_cycles=1.0, most_cycles=200.0, step=1e-6),
        ),
        jerk_feedforward=True,
        position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL),
        position_cycle=1e-3,
        force_filters=4,
    ),
    rows=_rows,
    layout=NAMED_LIST,
    notes=("isg-gear-sets", "isg-own-limits", "isg-slope"),
    # Names second-hand
    group=(at_corners(DEVIATION, "mm", "group-row-arc", is_verified=False, is_elsewhere=True),),
    corner=CornerRule(kind=Corner.ARC, is_verified=False),
)
