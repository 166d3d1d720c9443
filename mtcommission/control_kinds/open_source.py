"""Controls whose source is open: what they have, and where that was read."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf

from mtcommission.control_kinds.kind import (
    FEATURES,
    SHAPERS,
    ControlKind,
    Feature,
    FilterChoice,
    Jerk,
    PositionLoop,
    believed,
    read,
)
from mtcommission.control_kinds.numeric import EARLIER

LINUXCNC_SOURCE = "LinuxCNC at 5c41560e: ini-config, pid.9, biquad.comp, tp.c"
KLIPPER_SOURCE = "Klipper at 84104bbb: Config_Reference, input_shaper, kin_shaper.c"
GRBLHAL_SOURCE = "grblHAL core at f80fc34d: settings, planner, stepper"
FLUIDNC_SOURCE = "FluidNC at e952f33f: Axis.cpp, StepperPrivate.h"
MARLIN_SOURCE = "Marlin: M493, M494, M593, ft_types.h"
CONTROLLERS_SOURCE = "ros2_controllers at 02aa3725: joint_trajectory_controller"

ADDRESSES = {
    LINUXCNC_SOURCE: "github.com/LinuxCNC/linuxcnc",
    KLIPPER_SOURCE: "github.com/Klipper3d/klipper",
    GRBLHAL_SOURCE: "github.com/grblHAL/core",
    FLUIDNC_SOURCE: "github.com/bdring/FluidNC",
    MARLIN_SOURCE: "github.com/MarlinFirmware/Marlin (00317b4d, 02249df2, 03b25180)",
    CONTROLLERS_SOURCE: "github.com/ros-controls/ros2_controllers",
}
"""Where each source was read, November 2026."""

LINUXCNC = ControlKind(
    key="linuxcnc",
    acceleration_feedforward=False,
    reference_delay=False,
    position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
    position_cycle=1e-3,
    force_filters=4,
    features={
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
        "velocity_cycle": believed(note="The drive's."),
        "position_gain": read(LINUXCNC_SOURCE, "P [1/s], float", "With a velocity drive P = Kv."),
        "velocity_gain": read(LINUXCNC_SOURCE, note="In the velocity drive."),
        "force_filters": believed(note="Those of the drive; four is what drives usually have."),
        "state_feedback": read(
            LINUXCNC_SOURCE, note="None; an own component could: that is state-space."
        ),
    },
)


def _sends_steps(
    key: str,
    source: str,
    *,
    features: Mapping[str, Feature],
    jerk: Jerk = Jerk.NONE,
    setpoint_filters: tuple[FilterChoice, ...] = (),
    largest_acceleration: float = inf,
) -> ControlKind:
    """A control that sends steps: it has nothing of a loop, but for what was read."""
    common = dict.fromkeys(FEATURES, read(source, note="None: steps go out open loop."))
    pulses = "The pulses themselves carry the velocity; no parameter."
    common["velocity_feedforward"] = read(source, note=pulses)
    stand_in = (
        "None: the motor follows its steps: drive.kind = position_source. With a servo profile a "
        "stiff loop in the drive stands in for it."
    )
    common["position_loops"] = read(source, note=stand_in)
    common["modes"] = common["setpoint_filters"] = read(source, note="None.")
    return ControlKind(
        key=key,
        follows_steps=True,
        jerk=jerk,
        setpoint_filters=setpoint_filters,
        acceleration_feedforward=False,
        reference_delay=False,
        position_loops=(PositionLoop.DRIVE,),
        position_cycle=1e-3,
        largest_acceleration=largest_acceleration,
        features=common | dict(features),
    )


PRINTER = 20.0
"""The most that any of Klipper's sample configurations has as max_accel, most have 3 (config/ at
84104bbb) [m/s²]: what extruder, frame and driver of a printer take is not in the model. Marlin has
no such list; its printers are taken to be alike (assumed)."""

KLIPPER_SHAPERS = SHAPERS[:6]
MOST_DAMPING = {"ei": 0.4, "2hump_ei": 0.3, "3hump_ei": 0.2}
"""Largest damping ratios that Klipper takes, where it is not 0.99."""

KLIPPER = _sends_steps(
    "klipper",
    KLIPPER_SOURCE,
    largest_acceleration=PRINTER,
    setpoint_filters=tuple(
        FilterChoice(
            kind=shaper,
            most_damping=MOST_DAMPING.get(shaper, 0.99),
        )
        for shaper in KLIPPER_SHAPERS
    ),
    features={
        "acceleration": read(
            KLIPPER_SOURCE,
            "[printer] max_accel (z: max_z_accel) [mm/s^2]",
            "minimum_cruise_ratio lowers the velocity of short moves.",
        ),
        "jerk": read(KLIPPER_SOURCE, note="None; square_corner_velocity is a step of velocity."),
        "modes": read(KLIPPER_SOURCE, note="None; by macro."),
        "setpoint_filters": read(
            KLIPPER_SOURCE,
            "[input_shaper] shaper_type_x, shaper_freq_x [Hz], damping_ratio_x",
            "One shaper per axis. Damping at most 0.99, ei 0.4, 2hump_ei 0.3, 3hump_ei 0.2. The EI "
            "family as of 2025-09-16 (5da026a3), 3hump_ei as of 2026-03-31 (0d1445a7); earlier "
            "ones were the classical EI. mzv(n, t) and ei(v_tol) of 2026 are not offered.",
        ),
        "reference_delay": read(
            KLIPPER_SOURCE, note="None; pulses are centred, so a shaper's delay is not one."
        ),
    },
)

GRBLHAL = _sends_steps(
    "grblhal",
    GRBLHAL_SOURCE,
    jerk=Jerk.LIMIT,
    features={
        "acceleration": read(GRBLHAL_SOURCE, "$120 + axis [mm/s^2, deg/s^2] 0.001"),
        "jerk": read(
            GRBLHAL_SOURCE,
            "$800 + axis [mm/s^3, deg/s^3] 0.001",
            "Only in builds with ENABLE_JERK_ACCELERATION. The acceleration changes once per "
            "segment of 10 ms (default): jerk times near that cannot be promised.",
        ),
        "position_cycle": read(
            GRBLHAL_SOURCE,
            "ACCELERATION_TICKS_PER_SECOND",
            "Velocity is a staircase of 10 ms segments, which is not simulated.",
        ),
    },
)

FLUIDNC = _sends_steps(
    "fluidnc",
    FLUIDNC_SOURCE,
    features={
        "acceleration": read(FLUIDNC_SOURCE, "acceleration_mm_per_sec2 0.001..100 000, float"),
        "jerk": read(FLUIDNC_SOURCE, note="None; the word stands in one comment of the source."),
        "position_cycle": read(
            FLUIDNC_SOURCE,
            note="Velocity is a staircase of 10 ms segments, which is not simulated.",
        ),
    },
)

MARLIN_SHAPERS: Mapping[str, str] = {
    "marlin_zv": "1",
    "marlin_mzv": "8",
    "marlin_zvd": "2",
    "marlin_zvdd": "3",
    "marlin_zvddd": "4",
    "marlin_ei": "5",
    "marlin_2hump_ei": "6",
    "marlin_3hump_ei": "7",
}
"""Values of M493 C."""

MARLIN = _sends_steps(
    "marlin",
    MARLIN_SOURCE,
    largest_acceleration=PRINTER,
    setpoint_filters=tuple(
        FilterChoice(
            kind=shaper,
            least_frequency_hz=20.0,
            most_frequency_hz=500.0,
            least_damping=0.01,
            most_damping=0.25,
        )
        for shaper, code in MARLIN_SHAPERS.items()
    ),
    features={
        "acceleration": read(EARLIER, "M201 [mm/s^2]", "M204 for print and travel (?)."),
        "jerk": read(
            MARLIN_SOURCE,
            note="None; profiles of order 5 or 6 as build options, up to 1.875 times the "
            "acceleration. What Marlin calls jerk is a step of velocity.",
        ),
        "setpoint_filters": read(
            MARLIN_SOURCE,
            "M593 X/Y F [Hz] D; M493 C, A [Hz], I 0.01..0.25; M494 [s]",
            "ZV, or with FT motion ZV to ZVDDD, EI, 2HEI, 3HEI, MZV per axis, 10 or 20 to 500 Hz; "
            "its EI family is the classical one (shaping.cpp at 195278e4). FT motion rounds the "
            "first copy's delay to whole samples of 1 ms and repeats it, which is simulated; M593 "
            "delays steps by timer ticks and is not offered.",
        ),
        "position_cycle": read(
            MARLIN_SOURCE,
            "FTM_FS",
            "FT motion computes at 1000 Hz unless the build says otherwise; the steps in between "
            "are evenly spaced.",
        ),
    },
)

ROS2 = ControlKind(
    key="ros2",
    acceleration_feedforward=False,
    reference_delay=False,
    position_loops=(PositionLoop.CONTROL, PositionLoop.DRIVE),
    position_cycle=10e-3,
    force_filters=4,
    features={
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
        "velocity_cycle": believed(note="The drive's."),
        "position_gain": read(CONTROLLERS_SOURCE, "gains.<joint>.p [1/s], double"),
        "velocity_gain": believed(note="In the drive."),
        "force_filters": believed(note="Those of the drive; four is what drives usually have."),
        "state_feedback": read(CONTROLLERS_SOURCE, note="None; an own controller: state-space."),
    },
)
