"""Function blocks of PLCopen, e.g. in CODESYS."""

from __future__ import annotations

from mtcommission.controls.control import Axis, Control, acceleration_row, identifier, jerk_row
from mtcommission.controls.kind import (
    EARLIER,
    OF_DRIVE,
    ControlKind,
    PositionLoop,
    believed,
    read,
)
from mtcommission.controls.row import Row, Values
from mtcommission.controls.syntax import CONSTANTS

POSITION_CONTROL = "CODESYS SoftMotion, SM_Drive_PosControl"

VELOCITY_MODE = "CODESYS SM3_CNC, SMC_INT_VELMODE"

TORQUE_BLOCKS = "CODESYS SoftMotion, torque of groups and single axes"

ADDRESSES = {
    POSITION_CONTROL: "content.helpme-codesys.com, _sm_edt_drive_poscontrol_position_control_loop",
    VELOCITY_MODE: "content.helpme-codesys.com, libs/SM3_CNC",
    TORQUE_BLOCKS: "content.helpme-codesys.com, _sm_robotics_external_axis_torque_control",
}
"""Where each source was read, November 2026."""

PLCOPEN = ControlKind(
    key="plcopen",
    acceleration_feedforward=False,
    reference_delay=False,
    position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL),
    force_filters=4,
    features={
        **OF_DRIVE,
        "acceleration": read(EARLIER, "Acceleration, Deceleration [u/s^2], LREAL"),
        "jerk": read(
            f"{EARLIER}; {VELOCITY_MODE}",
            "Jerk [u/s^3], LREAL",
            "Acts only with the ramp type quadratic; 0 = default of the axis.",
        ),
        "modes": believed(note="None."),
        "setpoint_filters": believed(note="None; own code could."),
        "velocity_feedforward": read(
            POSITION_CONTROL,
            "share 0..1",
            "As set velocity; with CSP a velocity offset (60B1) if mapped (?).",
        ),
        "acceleration_feedforward": read(
            TORQUE_BLOCKS,
            "SMC_SetTorque, SMC_GroupSetDynamics",
            "By program or by the model of a group only; no row for one axis, so not counted on.",
        ),
        "jerk_feedforward": believed(note="None."),
        "reference_delay": read(
            POSITION_CONTROL,
            "D [cycles], whole",
            "Only where the PLC closes the loop; not counted on, since the drive usually does.",
        ),
        "position_loops": read(
            POSITION_CONTROL, note="Usually the drive (CSP); else SM_Drive_PosControl."
        ),
        "position_cycle": believed(note="Bus task of 1 to 4 ms."),
        "position_gain": read(
            POSITION_CONTROL, "Kp [1/s]", "Only with SM_Drive_PosControl; else the drive's."
        ),
        "state_feedback": believed(note="None; own blocks could: that is state-space."),
    },
)


def constants(axis: Axis, _loop: Values) -> list[Row]:
    """Return the limits as constants of a program."""
    name = identifier(axis)
    return [
        acceleration_row(axis, f"c{name}_Acceleration", "limit-acceleration"),
        acceleration_row(axis, f"c{name}_Deceleration", "limit-deceleration"),
        jerk_row(axis, f"c{name}_Jerk", "limit-jerk"),
    ]


CONTROL = Control(
    kind=PLCOPEN,
    rows=constants,
    layout=CONSTANTS,
    names_axes=True,
    notes=("plcopen-unit", "plcopen-jerk-of-zero", "plcopen-quadratic"),
)
