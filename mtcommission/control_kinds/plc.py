"""Motion control in a PLC: what it has, and where that was read."""

from __future__ import annotations

from mtcommission.control_kinds.kind import ControlKind, PositionLoop, believed, read
from mtcommission.control_kinds.numeric import EARLIER

NC_LOOP = "Beckhoff TF50x0 NC PTP, position control loop"
ADS = "Beckhoff ADS-NC, controller parameters 0x6000"
NCI = "Beckhoff TF5100 NCI, dynamics of axes and path"
AX5000 = "Beckhoff AX5000 IDN description"
AX5000_FFW = "Beckhoff AX5000, acceleration pre-control"
AX8000 = "Beckhoff AX8xxx object description"
AX8000_FILTERS = "Beckhoff AX8000, torque setpoint filter"

POSITION_CONTROL = "CODESYS SoftMotion, SM_Drive_PosControl"
VELOCITY_MODE = "CODESYS SM3_CNC, SMC_INT_VELMODE"
TORQUE_BLOCKS = "CODESYS SoftMotion, torque of groups and single axes"

ADDRESSES = {
    NC_LOOP: "infosys.beckhoff.com, tf50x0_tc3_nc_ptp/3443964683.html",
    ADS: "infosys.beckhoff.com, tc3_ads_intro/713112843.html",
    NCI: "infosys.beckhoff.com, tf5100_tc3_nc_i/8405470603.html, 9237585035, 3290345867",
    AX5000: "infosys.beckhoff.com, ax5000_idn_description (S-0-0100 to P-0-0556)",
    AX5000_FFW: "infosys.beckhoff.com, ax5000_function_doku_hw2/2868377355.html",
    AX8000: "infosys.beckhoff.com, ax8xxx_object (3062, 30C3, 3140 to 3142, 60C0)",
    AX8000_FILTERS: "infosys.beckhoff.com, ax8000_fb/10525186571.html",
    POSITION_CONTROL: "content.helpme-codesys.com, _sm_edt_drive_poscontrol_position_control_loop",
    VELOCITY_MODE: "content.helpme-codesys.com, libs/SM3_CNC",
    TORQUE_BLOCKS: "content.helpme-codesys.com, _sm_robotics_external_axis_torque_control",
}
"""Where each source was read, November 2026, as stored public copies."""

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
            f"{ADS}; {NC_LOOP}; {AX5000}",
            "NC Kp [1/s] 0..1000; AX5000 S-0-0104 [1000/min] 0.01",
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

PLCOPEN = ControlKind(
    key="plcopen",
    acceleration_feedforward=False,
    reference_delay=False,
    position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL),
    force_filters=4,
    features={
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
        "velocity_cycle": believed(note="The drive's."),
        "position_gain": read(
            POSITION_CONTROL, "Kp [1/s]", "Only with SM_Drive_PosControl; else the drive's."
        ),
        "velocity_gain": believed(note="In the drive."),
        "force_filters": believed(note="Those of the drive; four is what drives usually have."),
        "state_feedback": believed(note="None; own blocks could: that is state-space."),
    },
)
