"""LinuxCNC."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import LETTERS, Axis, Control, Corner, CornerRule
from mtcommission.controls.kind import ControlKind, PositionLoop
from mtcommission.controls.row import Row, Setting, Values, at_corners, fixed, on_path
from mtcommission.controls.syntax import INI


def _rows(axis: Axis, loop: Values) -> Iterator[Row]:
    letter = axis.letter(LETTERS, "LinuxCNC")
    joint = f"JOINT_{LETTERS.index(letter)}"
    yield fixed("PLANNER_TYPE", "1", "linuxcnc-planner", section="TRAJ")
    if not axis.is_rotary:
        ceiling, path = "linuxcnc-path-acceleration", "linuxcnc-path-jerk"
        yield axis.acceleration_row("MAX_LINEAR_ACCELERATION", ceiling, section="TRAJ")
        yield axis.jerk_row("MAX_LINEAR_JERK", path, section="TRAJ")
    yield Row(Setting.POSITION_CYCLE, "SERVO_PERIOD", unit="ns", step=1, section="EMCMOT")
    for section in (joint, f"AXIS_{letter}"):
        yield axis.acceleration_row("MAX_ACCELERATION", section=section)
        yield axis.jerk_row("MAX_JERK", "linuxcnc-jerk", section=section)
    if loop[Setting.POSITION_LOOP, ""] == "control":
        said = Message("linuxcnc-gain")
        yield Row(Setting.POSITION_GAIN, "P", unit="1/s", meaning=said, section=joint)
        yield Row(Setting.VELOCITY_FEEDFORWARD, "FF1", section=joint)


CONTROL = Control(
    kind=ControlKind(
        key="linuxcnc",
        unread=("velocity_cycle", "force_filters", "setpoint_filters"),
        acceleration_feedforward=False,
        reference_delay=False,
        position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
        position_cycle=1e-3,
        force_filters=4,
    ),
    rows=_rows,
    layout=INI,
    names_axes=True,
    group=(
        on_path("acceleration", "MAX_LINEAR_ACCELERATION", "mm/s^2", section="TRAJ"),
        on_path("jerk", "MAX_LINEAR_JERK", "mm/s^3", "linuxcnc-path-jerk", section="TRAJ"),
        at_corners("G64 P", "mm", "group-row-arc", is_elsewhere=True),
    ),
    axes_hold=("acceleration",),
    # LinuxCNC 5c41560e, blendmath.c: 0.866 of the acceleration for the arc
    corner=CornerRule(kind=Corner.ARC, share=sqrt(0.75)),
    notes=("linuxcnc-units", "linuxcnc-joints", "linuxcnc-least-jerk"),
)
