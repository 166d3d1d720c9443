"""ROS 2."""

from __future__ import annotations

from mtcommission.controls.control import Axis, Control, identifier
from mtcommission.controls.kind import (
    EARLIER,
    OF_DRIVE,
    ControlKind,
    PositionLoop,
    believed,
    read,
)
from mtcommission.controls.row import Row, Setting, Values, fixed
from mtcommission.controls.syntax import YAML

CONTROLLERS_SOURCE = "ros2_controllers at 02aa3725: joint_trajectory_controller"

ADDRESSES = {CONTROLLERS_SOURCE: "github.com/ros-controls/ros2_controllers"}
"""Where each source was read, November 2026."""

ROS2 = ControlKind(
    key="ros2",
    acceleration_feedforward=False,
    reference_delay=False,
    position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
    position_cycle=10e-3,
    force_filters=4,
    features={
        **OF_DRIVE,
        "acceleration": read(EARLIER, "max_acceleration [rad/s^2, m/s^2], double"),
        "jerk": read(
            EARLIER,
            "has_jerk_limits, max_jerk [rad/s^3, m/s^3], double",
            "Kept only where the time parametrisation uses it (Ruckig smoothing (?)).",
        ),
        "modes": believed(note="None; scaling factors by request."),
        "setpoint_filters": believed(note="None; MoveIt Servo has plugins."),
        "velocity_feedforward": read(
            CONTROLLERS_SOURCE,
            "gains.<joint>.ff_velocity_scale, double",
            "Default 0; where the command is a velocity or an effort (?).",
        ),
        "acceleration_feedforward": believed(note="None."),
        "jerk_feedforward": believed(note="None."),
        "reference_delay": read(CONTROLLERS_SOURCE, note="None."),
        "position_loops": read(
            CONTROLLERS_SOURCE,
            note="PID at the update rate for velocity or effort commands; else in the drive.",
        ),
        "position_cycle": read(
            CONTROLLERS_SOURCE, "update_rate [Hz]", "100 Hz in the examples, up to 1 kHz (?)."
        ),
        "position_gain": read(CONTROLLERS_SOURCE, "gains.<joint>.p [1/s], double"),
        "state_feedback": read(CONTROLLERS_SOURCE, note="None; an own controller: state-space."),
    },
)


def _ros(axis: Axis, loop: Values) -> list[Row]:
    name, units = identifier(axis), axis.units
    limits, gains = (
        f"joint_limits/{name}",
        f"joint_trajectory_controller/ros__parameters/gains/{name}",
    )
    rows = [
        fixed("has_acceleration_limits", "true", section=limits),
        Row(Setting.ACCELERATION, "max_acceleration", unit=units.acceleration.si, section=limits),
        fixed("has_jerk_limits", "true", section=limits),
        Row(Setting.JERK, "max_jerk", unit=units.jerk.si, section=limits),
    ]
    if loop[Setting.POSITION_LOOP, ""] == "drive":
        return rows
    return [
        *rows,
        Row(Setting.POSITION_GAIN, "p", unit="1/s", meaning="ros-gain", section=gains),
        Row(Setting.VELOCITY_FEEDFORWARD, "ff_velocity_scale", section=gains),
    ]


CONTROL = Control(kind=ROS2, rows=_ros, layout=YAML, names_axes=True, in_degrees=False)
