"""Every kind of control, by its key."""

from __future__ import annotations

from collections.abc import Mapping

from mtcommission.control_kinds import numeric, open_source, plc
from mtcommission.control_kinds.kind import (
    FEATURES,
    FIR,
    MOVING_AVERAGE,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
    PositionLoop,
    read,
)

DEFINED = "defined here, not a product"

ANYWHERE = (PositionLoop.CONTROL, PositionLoop.INTERPOLATED, PositionLoop.DRIVE)

GENERIC = ControlKind(
    key="generic",
    setpoint_filters=(FilterChoice(kind=MOVING_AVERAGE),),
    position_loops=ANYWHERE,
    force_filters=8,
    features=dict.fromkeys(FEATURES, read(DEFINED)),
)
"""The cascade that any of them can be set to; no single product has all of it."""

STATE_SPACE = ControlKind(
    key="state-space",
    setpoint_filters=(
        FilterChoice(kind=MOVING_AVERAGE),
        FilterChoice(kind=TWO_AVERAGES),
        FilterChoice(kind=FIR),
        *(FilterChoice(kind=shaper) for shaper in open_source.KLIPPER_SHAPERS),
    ),
    jerk_feedforward=True,
    position_loops=ANYWHERE,
    force_filters=8,
    state_feedback=True,
    features=dict.fromkeys(FEATURES, read(DEFINED)),
)
"""A free controller."""

KINDS: Mapping[str, ControlKind] = {
    kind.key: kind
    for kind in (
        numeric.SINUMERIK,
        numeric.HEIDENHAIN,
        numeric.FANUC,
        numeric.ISG,
        plc.TWINCAT,
        plc.PLCOPEN,
        GENERIC,
        STATE_SPACE,
        open_source.LINUXCNC,
        open_source.KLIPPER,
        open_source.GRBLHAL,
        open_source.FLUIDNC,
        open_source.MARLIN,
        open_source.ROS2,
    )
}
"""All of them, in the order in which they are listed."""

ADDRESSES: Mapping[str, str] = numeric.ADDRESSES | plc.ADDRESSES | open_source.ADDRESSES
"""Where each source was read, by its title."""
