"""The neutral cascade, and a free controller: no products."""

from __future__ import annotations

from functools import partial

from mtcommission.controls.control import Axis, Control, Corner, CornerRule, say_neutrally
from mtcommission.controls.kind import (
    FEATURES,
    FIR,
    MOVING_AVERAGE,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
    PositionLoop,
    read,
)
from mtcommission.controls.makers.klipper import KLIPPER_SHAPERS
from mtcommission.controls.row import Row, Setting, Values
from mtcommission.controls.syntax import TABLE

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
        *(FilterChoice(kind=shaper) for shaper in KLIPPER_SHAPERS),
    ),
    jerk_feedforward=True,
    position_loops=ANYWHERE,
    force_filters=8,
    state_feedback=True,
    features=dict.fromkeys(FEATURES, read(DEFINED)),
)
"""A free controller."""


def _generic(axis: Axis, loop: Values) -> tuple[Row, ...]:
    limits = ((Setting.ACCELERATION, ""), (Setting.JERK, ""))
    return say_neutrally((*limits, *loop), axis.units)


def _state_space(axis: Axis, loop: Values) -> tuple[Row, ...]:
    units = axis.state_units
    fed_back = (index for setting, index in loop if setting is Setting.STATE_GAIN)
    return (
        *_generic(axis, loop),
        *(
            Row(
                Setting.STATE_GAIN,
                f"state feedback {state}",
                index=state,
                unit=f"{units['F']}/({units[state]})",
                digits=6,
            )
            for state in fed_back
        ),
    )


IN_GROUP = (
    Row(Setting.WAIT, "wait", unit="ms", digits=9),
    Row(
        Setting.TOGETHER,
        "velocity step at corners",
        index="corner",
        unit="m/s",
        meaning="group-row-step",
    ),
)

GROUP = (
    Row(Setting.TOGETHER, "path acceleration", index="acceleration", unit="m/s^2"),
    Row(Setting.TOGETHER, "path jerk", index="jerk", unit="m/s^3"),
)

neutral = partial(
    Control,
    layout=TABLE,
    in_degrees=False,
    axis_in_group=IN_GROUP,
    group=GROUP,
    axes_hold=(),
    corner=CornerRule(kind=Corner.STEP, source=DEFINED),
)

CONTROL = neutral(kind=GENERIC, rows=_generic)

FREE = neutral(kind=STATE_SPACE, rows=_state_space)
