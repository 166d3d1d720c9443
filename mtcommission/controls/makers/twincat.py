"""TwinCAT NC."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from mtcommission.controls.control import Axis, Control, Corner, CornerRule
from mtcommission.controls.kind import ControlKind, PositionLoop
from mtcommission.controls.makers.plcopen import constants
from mtcommission.controls.row import Row, Setting, Values, at_corners, on_path
from mtcommission.controls.syntax import CONSTANTS, INLINE

PATH = {1: "acceleration", 2: "acceleration", 3: "jerk"}
"""Places of the limits of the path in the line of the part program."""

RADIUS = "#set paramVertexSmoothing(2; 2; radius)#: radius"


def _rows(axis: Axis, loop: Values) -> Iterator[Row]:
    yield from constants(axis, loop)
    length = axis.small_unit
    unit = f"{length}/s^2, {length}/s^3"
    for number, limit in PATH.items():
        setting, name = Setting[limit.upper()], f"#set paramPathDynamics[{number}]"
        yield Row(setting, name, unit=unit, meaning="limit-path-nci", section=INLINE)
    yield from _loop(axis, loop)


def _loop(axis: Axis, loop: Values) -> Iterator[Row]:
    """The position controller of the NC or of an AX5000, and the drive's velocity controller."""
    row, gain = partial(Row, is_elsewhere=True), Setting.VELOCITY_GAIN
    yield row(Setting.INTEGRAL_TIME, "S-0-0101", unit="0.1 ms", step=1, meaning="twincat-tn")
    unit, said = "Nm/(rad/s)", "twincat-kp"
    yield from axis.rows_at_shaft(gain, "S-0-0100", unit, said, step=1e-3, is_elsewhere=True)
    if loop[Setting.POSITION_LOOP, ""] == "drive":
        said, unit = "twincat-kv-in-drive", "1000/min"
        yield row(Setting.POSITION_GAIN, "S-0-0104", unit=unit, step=1e-2, meaning=said)
        yield row(Setting.VELOCITY_FEEDFORWARD, "S-0-0296", unit="%", step=1e-2)
    else:
        name, said = "NC position controller Kv", "twincat-kv-in-nc"
        yield row(Setting.POSITION_GAIN, name, unit="1/s", meaning=said)
        yield row(Setting.VELOCITY_FEEDFORWARD, "NC velocity pre-control weight")


CONTROL = Control(
    kind=ControlKind(
        key="twincat",
        unread=(
            *("setpoint_filters", "jerk_feedforward", "reference_delay"),
            *("position_cycle", "velocity_cycle", "state_feedback"),
        ),
        reference_delay=False,
        position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
        force_filters=4,
    ),
    rows=_rows,
    layout=CONSTANTS,
    names_axes=True,
    # TF5100 NCI, parabolic smoothing (infosys.beckhoff.com, tcnci/2742970379.html); an arc is taken
    # for the parabola
    group=(
        *(
            on_path(
                limit,
                f"#set paramPathDynamics[{number}]",
                "mm/s^2, mm/s^3",
                "limit-path-nci",
                section=INLINE,
            )
            for number, limit in PATH.items()
        ),
        at_corners(RADIUS, "mm", "group-row-parabola", is_elsewhere=True),
    ),
    axes_hold=(),
    corner=CornerRule(kind=Corner.ARC, is_verified=False),
    notes=("twincat-jerk-unit", "twincat-no-jerk-filter"),
)
