"""ROS 2."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.controls.control import Axis, Control
from mtcommission.controls.kind import ControlKind, PositionLoop
from mtcommission.controls.row import Row, Setting, Values, fixed
from mtcommission.controls.syntax import YAML


def _rows(axis: Axis, loop: Values) -> Iterator[Row]:
    name, units = axis.identifier, axis.units
    limits = f"joint_limits/{name}"
    yield fixed("has_acceleration_limits", "true", section=limits)
    a = units.acceleration.si
    yield Row(Setting.ACCELERATION, "max_acceleration", unit=a, section=limits)
    yield fixed("has_jerk_limits", "true", section=limits)
    yield Row(Setting.JERK, "max_jerk", unit=units.jerk.si, section=limits)
    if loop[Setting.POSITION_LOOP, ""] != "drive":
        gains = f"joint_trajectory_controller/ros__parameters/gains/{name}"
        yield Row(Setting.POSITION_GAIN, "p", unit="1/s", meaning="ros-gain", section=gains)
        yield Row(Setting.VELOCITY_FEEDFORWARD, "ff_velocity_scale", section=gains)


CONTROL = Control(
    kind=ControlKind(
        key="ros2",
        unread=(
            *("velocity_cycle", "force_filters", "modes", "setpoint_filters"),
            *("acceleration_feedforward", "jerk_feedforward"),
        ),
        acceleration_feedforward=False,
        reference_delay=False,
        position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
        position_cycle=10e-3,
        force_filters=4,
    ),
    rows=_rows,
    layout=YAML,
    names_axes=True,
)
