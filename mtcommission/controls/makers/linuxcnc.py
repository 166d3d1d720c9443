"""LinuxCNC."""

from __future__ import annotations

from math import sqrt

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import (
    LETTERS,
    Axis,
    Control,
    Corner,
    CornerRule,
    acceleration_row,
    jerk_row,
    letter_of,
)
from mtcommission.controls.kind import OF_DRIVE, ControlKind, PositionLoop, believed, read
from mtcommission.controls.row import Row, Setting, Values, fixed
from mtcommission.controls.syntax import INI

LINUXCNC_SOURCE = "LinuxCNC at 5c41560e: ini-config, pid.9, biquad.comp, tp.c"

ADDRESSES = {LINUXCNC_SOURCE: "github.com/LinuxCNC/linuxcnc"}
"""Where each source was read, November 2026."""

LINUXCNC = ControlKind(
    key="linuxcnc",
    acceleration_feedforward=False,
    reference_delay=False,
    position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
    position_cycle=1e-3,
    force_filters=4,
    features={
        **OF_DRIVE,
        "acceleration": read(LINUXCNC_SOURCE, "MAX_ACCELERATION [u/s^2], float"),
        "jerk": read(
            LINUXCNC_SOURCE,
            "[JOINT_n], [AXIS_x] MAX_JERK; [TRAJ] MAX_LINEAR_JERK [u/s^3], float",
            "From version 2.10; needs PLANNER_TYPE = 1. Below 1 it falls back to trapezoids.",
        ),
        "modes": read(LINUXCNC_SOURCE, "G64 R", "By program: trapezoid or smooth."),
        "setpoint_filters": believed(note="None in the planner.", beside=LINUXCNC_SOURCE),
        "velocity_feedforward": read(LINUXCNC_SOURCE, "FF1, float", "With a velocity drive."),
        "acceleration_feedforward": read(
            LINUXCNC_SOURCE,
            "FF2",
            "A torque only where pid drives torque, at the servo period; usual are velocity "
            "drives, so not counted on (else: generic with both cycles at 1 ms).",
        ),
        "jerk_feedforward": read(LINUXCNC_SOURCE, "FF3", "As FF2."),
        "reference_delay": read(
            LINUXCNC_SOURCE, "error-previous-target", "One servo cycle at most."
        ),
        "position_loops": read(
            LINUXCNC_SOURCE,
            note="In the servo thread; in the drive with step/direction or bus position drives.",
        ),
        "position_cycle": read(LINUXCNC_SOURCE, "SERVO_PERIOD [ns]"),
        "position_gain": read(LINUXCNC_SOURCE, "P [1/s], float", "With a velocity drive P = Kv."),
        "velocity_gain": read(LINUXCNC_SOURCE, note="In the velocity drive."),
        "state_feedback": read(
            LINUXCNC_SOURCE, note="None; an own component could: that is state-space."
        ),
    },
)


def _linuxcnc(axis: Axis, loop: Values) -> list[Row]:
    letter = letter_of(axis, LETTERS, "LinuxCNC")
    joint = f"JOINT_{LETTERS.index(letter)}"
    rows = [fixed("PLANNER_TYPE", "1", "linuxcnc-planner", section="TRAJ")]
    if not axis.is_rotary:
        ceiling = Message("linuxcnc-path-acceleration")
        path = Message("linuxcnc-path-jerk")
        rows += [
            acceleration_row(axis, "MAX_LINEAR_ACCELERATION", ceiling, section="TRAJ"),
            jerk_row(axis, "MAX_LINEAR_JERK", path, section="TRAJ"),
        ]
    rows.append(Row(Setting.POSITION_CYCLE, "SERVO_PERIOD", unit="ns", step=1, section="EMCMOT"))
    for section in (joint, f"AXIS_{letter}"):
        rows.append(acceleration_row(axis, "MAX_ACCELERATION", section=section))
        rows.append(jerk_row(axis, "MAX_JERK", "linuxcnc-jerk", section=section))
    if loop[Setting.POSITION_LOOP, ""] == "control":
        rows.append(
            Row(Setting.POSITION_GAIN, "P", unit="1/s", meaning="linuxcnc-gain", section=joint)
        )
        rows.append(Row(Setting.VELOCITY_FEEDFORWARD, "FF1", section=joint))
    return rows


GROUP = (
    Row(
        Setting.TOGETHER,
        "MAX_LINEAR_ACCELERATION",
        index="acceleration",
        unit="mm/s^2",
        section="TRAJ",
    ),
    Row(
        Setting.TOGETHER,
        "MAX_LINEAR_JERK",
        index="jerk",
        unit="mm/s^3",
        meaning="linuxcnc-path-jerk",
        section="TRAJ",
    ),
    Row(
        Setting.TOGETHER,
        "G64 P",
        index="corner",
        unit="mm",
        meaning="group-row-arc",
        is_elsewhere=True,
    ),
)

CONTROL = Control(
    kind=LINUXCNC,
    rows=_linuxcnc,
    layout=INI,
    names_axes=True,
    group=GROUP,
    axes_hold=("acceleration",),
    corner=CornerRule(
        kind=Corner.ARC,
        source="LinuxCNC 5c41560e, blendmath.c: 0.866 of the acceleration for the arc",
        share=sqrt(0.75),
    ),
    notes=("linuxcnc-units", "linuxcnc-joints", "linuxcnc-least-jerk"),
)
