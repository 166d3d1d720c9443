"""TwinCAT NC."""

from __future__ import annotations

from functools import partial

from mtcommission.controls.control import Axis, Control, Corner, CornerRule
from mtcommission.controls.kind import ControlKind, PositionLoop, believed, read
from mtcommission.controls.makers.plcopen import constants
from mtcommission.controls.row import Row, Setting, Values
from mtcommission.controls.syntax import CONSTANTS, INLINE

NC_LOOP = "Beckhoff TF50x0 NC PTP, position control loop"

ADS = "Beckhoff ADS-NC, controller parameters 0x6000"

NCI = "Beckhoff TF5100 NCI, dynamics of axes and path"

AX5000 = "Beckhoff AX5000 IDN description"

AX5000_FFW = "Beckhoff AX5000, acceleration pre-control"

AX8000 = "Beckhoff AX8xxx object description"

AX8000_FILTERS = "Beckhoff AX8000, torque setpoint filter"

ADDRESSES = {
    NC_LOOP: "infosys.beckhoff.com, tf50x0_tc3_nc_ptp/3443964683.html",
    ADS: "infosys.beckhoff.com, tc3_ads_intro/713112843.html",
    NCI: "infosys.beckhoff.com, tf5100_tc3_nc_i/8405470603.html, 9237585035, 3290345867",
    AX5000: "infosys.beckhoff.com, ax5000_idn_description (S-0-0100 to P-0-0556)",
    AX5000_FFW: "infosys.beckhoff.com, ax5000_function_doku_hw2/2868377355.html",
    AX8000: "infosys.beckhoff.com, ax8xxx_object (3062, 30C3, 3140 to 3142, 60C0)",
    AX8000_FILTERS: "infosys.beckhoff.com, ax8000_fb/10525186571.html",
}
"""Where each source was read, November 2026."""

TWINCAT = ControlKind(
    key="twincat",
    reference_delay=False,
    position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
    force_filters=4,
    features={
        "acceleration": read(NCI, "Acceleration, Deceleration [mm/s^2], LREAL"),
        "jerk": read(NCI, "Jerk [mm/s^3], LREAL", "0 = default; path values at least 1."),
        "modes": read(NCI, note="None; by program."),
        "setpoint_filters": believed(
            "AX8000 3062:02, 30C3:01 0..0.01 s",
            "None in the NC; the drive's acts on the velocity feed-forward alone.",
            beside=AX8000,
        ),
        "velocity_feedforward": read(
            f"{ADS}; {AX5000}; {AX8000}", "NC 0..1; AX5000 S-0-0296 [0.01 %]; AX8000 3062:01 0..1.2"
        ),
        "acceleration_feedforward": read(
            f"{AX5000}; {AX5000_FFW}; {AX8000}",
            "AX5000 S-0-0348 [%/(rad/s^2)]; AX8000 3062:03 0..2 on 3140:07 + 32C0:0B [kg m^2]",
            "In the drive; AX5000 wants cubic interpolation and a position cycle of 250 us or "
            "more.",
        ),
        "jerk_feedforward": believed(note="None."),
        "reference_delay": believed(note="None in the NC; AX5000 lag-less mode has its own."),
        "position_loops": read(
            f"{NC_LOOP}; {AX5000}; {AX8000}",
            "AX5000 P-0-0556, AX8000 60C0 = -2: cubic",
            "In the NC with velocity setpoints, in the drive with position setpoints (CSP).",
        ),
        "position_cycle": believed(
            "P-0-0004", "NC task 2 ms; 125 us to 20 ms allowed.", beside=AX5000
        ),
        "velocity_cycle": believed(note="AX5000 125 us; AX8000 62.5 us (read).", beside=AX8000),
        "position_gain": read(
            f"{ADS}; {NC_LOOP}; {AX5000}", "NC Kp [1/s] 0..1000; AX5000 S-0-0104 [1000/min] 0.01"
        ),
        "velocity_gain": read(
            f"{AX5000}; {AX8000}",
            "AX5000 S-0-0100 [N m s/rad], S-0-0101 [0.1 ms]; AX8000 3140:01 [N m s/rad], "
            "3140:02 [s]",
            "At the motor shaft.",
        ),
        "force_filters": read(
            f"{AX5000}; {AX8000_FILTERS}",
            "AX5000 P-0-0513, 0515, 0516, 0517 [Hz], whole",
            "Low-pass, phase correction or notch, 10 to 4000 Hz; count of the AX8000 (?).",
        ),
        "state_feedback": believed(note="None; AX8000 has a velocity observer without gains."),
    },
)


def _twincat(axis: Axis, loop: Values) -> list[Row]:
    length = axis.small_unit
    path = [
        Row(
            setting,
            f"#set paramPathDynamics[{number}]",
            unit=f"{length}/s^2, {length}/s^3",
            meaning="limit-path-nci",
            section=INLINE,
        )
        for number, setting in enumerate(
            (Setting.ACCELERATION, Setting.ACCELERATION, Setting.JERK), start=1
        )
    ]
    return [*constants(axis, loop), *path, *_twincat_loop(axis, loop)]


def _twincat_loop(axis: Axis, loop: Values) -> list[Row]:
    """The position controller of the NC or of an AX5000, and the drive's velocity controller."""
    row = partial(Row, is_elsewhere=True)
    rows = [row(Setting.INTEGRAL_TIME, "S-0-0101", unit="0.1 ms", step=1, meaning="twincat-tn")]
    if axis.shaft:
        rows.append(
            row(
                Setting.VELOCITY_GAIN,
                "S-0-0100",
                unit="Nm/(rad/s)",
                at_shaft=axis.shaft**-2,
                step=1e-3,
                meaning="twincat-kp",
            )
        )
    if loop[Setting.POSITION_LOOP, ""] == "drive":
        return [
            *rows,
            row(
                Setting.POSITION_GAIN,
                "S-0-0104",
                unit="1000/min",
                step=1e-2,
                meaning="twincat-kv-in-drive",
            ),
            row(Setting.VELOCITY_FEEDFORWARD, "S-0-0296", unit="%", step=1e-2),
        ]
    return [
        *rows,
        row(
            Setting.POSITION_GAIN,
            "NC position controller Kv",
            unit="1/s",
            meaning="twincat-kv-in-nc",
        ),
        row(Setting.VELOCITY_FEEDFORWARD, "NC velocity pre-control weight"),
    ]


GROUP = (
    *(
        Row(
            Setting.TOGETHER,
            f"#set paramPathDynamics[{number}]",
            index=limit,
            unit="mm/s^2, mm/s^3",
            meaning="limit-path-nci",
            section=INLINE,
        )
        for number, limit in enumerate(("acceleration", "acceleration", "jerk"), start=1)
    ),
    Row(
        Setting.TOGETHER,
        "#set paramVertexSmoothing(2; 2; radius)#: radius",
        index="corner",
        unit="mm",
        meaning="group-row-parabola",
        is_elsewhere=True,
    ),
)
"""Source: TF5100 NCI, parabolic smoothing (infosys.beckhoff.com, tcnci/2742970379.html)."""

CONTROL = Control(
    kind=TWINCAT,
    rows=_twincat,
    layout=CONSTANTS,
    names_axes=True,
    group=GROUP,
    axes_hold=(),
    corner=CornerRule(
        kind=Corner.ARC,
        source="TwinCAT TF5100 NCI, parabolic smoothing; an arc is taken for the parabola",
        is_verified=False,
    ),
    notes=("twincat-jerk-unit", "twincat-no-jerk-filter"),
)
