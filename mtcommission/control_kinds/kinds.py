"""Every kind of control, by its key."""

from __future__ import annotations

from collections.abc import Mapping

from mtcommission.control_kinds.kind import ControlKind, Jerk, PositionLoop

CONTROL, INTERPOLATED, DRIVE = (
    PositionLoop.CONTROL,
    PositionLoop.INTERPOLATED,
    PositionLoop.DRIVE,
)
ANYWHERE = (CONTROL, INTERPOLATED, DRIVE)

GENERIC = ControlKind(
    key="generic",
    setpoint_filters=("moving_average",),
    position_loops=ANYWHERE,
    force_filters=8,
)
"""The cascade that any of them can be set to."""

STATE_SPACE = ControlKind(
    key="state-space",
    setpoint_filters=("moving_average",),
    jerk_feedforward=True,
    position_loops=ANYWHERE,
    force_filters=8,
    state_feedback=True,
)
"""A free controller."""

KINDS: Mapping[str, ControlKind] = {
    kind.key: kind
    for kind in (
        ControlKind(
            key="sinumerik",
            modes=("DYNNORM", "DYNPOS", "DYNROUGH", "DYNSEMIFIN", "DYNFINISH"),
            setpoint_filters=("moving_average",),
            position_loops=(DRIVE, CONTROL, INTERPOLATED),
            force_filters=4,
        ),
        ControlKind(
            key="heidenhain",
            modes=("axPathJerk", "axPathJerkHi"),
            setpoint_filters=("moving_average",),
            position_loops=(INTERPOLATED, CONTROL),
            position_cycle=3e-3,
            force_filters=5,
        ),
        ControlKind(
            key="fanuc",
            jerk=Jerk.TIME,
            setpoint_filters=("moving_average",),
            reference_delay=False,
            position_loops=(DRIVE,),
            position_cycle=1e-3,
            force_filters=4,
        ),
        ControlKind(
            key="isg",
            jerk=Jerk.TIME,
            setpoint_filters=("moving_average",),
            jerk_feedforward=True,
            position_loops=(DRIVE, CONTROL),
        ),
        ControlKind(
            key="twincat", reference_delay=False, position_loops=(CONTROL, DRIVE), force_filters=4
        ),
        ControlKind(key="plcopen", position_loops=(DRIVE, CONTROL)),
        GENERIC,
        STATE_SPACE,
        ControlKind(
            key="linuxcnc",
            jerk_feedforward=True,
            reference_delay=False,
            position_cycle=1e-3,
            position_loops=(CONTROL, DRIVE),
            force_filters=4,
        ),
        ControlKind(
            key="klipper",
            jerk=Jerk.NONE,
            acceleration_feedforward=False,
            reference_delay=False,
            position_loops=(DRIVE,),
        ),
        ControlKind(
            key="grblhal",
            acceleration_feedforward=False,
            reference_delay=False,
            position_loops=(DRIVE,),
        ),
        ControlKind(
            key="fluidnc",
            jerk=Jerk.NONE,
            acceleration_feedforward=False,
            reference_delay=False,
            position_loops=(DRIVE,),
        ),
        ControlKind(
            key="marlin",
            jerk=Jerk.NONE,
            acceleration_feedforward=False,
            reference_delay=False,
            position_loops=(DRIVE,),
        ),
        ControlKind(
            key="ros2",
            acceleration_feedforward=False,
            reference_delay=False,
            position_cycle=1e-3,
            position_loops=(CONTROL, DRIVE),
        ),
    )
}
"""All of them, in the order in which they are listed."""
