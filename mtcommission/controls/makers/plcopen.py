"""Function blocks of PLCopen, e.g. in CODESYS."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.controls.control import Axis, Control
from mtcommission.controls.kind import ControlKind, PositionLoop
from mtcommission.controls.row import Row, Values
from mtcommission.controls.syntax import CONSTANTS


def constants(axis: Axis, _loop: Values) -> Iterator[Row]:
    """Yield the limits as constants of a program."""
    name = axis.identifier
    yield axis.acceleration_row(f"c{name}_Acceleration", "acceleration")
    yield axis.acceleration_row(f"c{name}_Deceleration", "limit-deceleration")
    yield axis.jerk_row(f"c{name}_Jerk", "jerk")


CONTROL = Control(
    kind=ControlKind(
        key="plcopen",
        unread=(
            *("velocity_cycle", "force_filters", "modes", "setpoint_filters"),
            *("jerk_feedforward", "position_cycle", "state_feedback"),
        ),
        acceleration_feedforward=False,
        reference_delay=False,
        position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL),
        force_filters=4,
    ),
    rows=constants,
    layout=CONSTANTS,
    names_axes=True,
    notes=("plcopen-unit", "plcopen-jerk-of-zero", "plcopen-quadratic"),
)
