"""The neutral cascade, and a free controller: defined here, no products."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from mtcommission.controls.control import Axis, Control, Corner, CornerRule, say_neutrally
from mtcommission.controls.kind import (
    FIR,
    KLIPPER_SHAPERS,
    MOVING_AVERAGE,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
    PositionLoop,
)
from mtcommission.controls.row import Row, Setting, Values, at_corners, on_path
from mtcommission.controls.syntax import TABLE

ANYWHERE = (PositionLoop.CONTROL, PositionLoop.INTERPOLATED, PositionLoop.DRIVE)

GENERIC = ControlKind(
    key="generic",
    setpoint_filters=(FilterChoice(kind=MOVING_AVERAGE),),
    position_loops=ANYWHERE,
    force_filters=8,
)
"""The cascade that any of them can be set to; no single product has all of it."""

STATE_SPACE = ControlKind(
    key="state-space",
    setpoint_filters=tuple(
        FilterChoice(kind=kind) for kind in (MOVING_AVERAGE, TWO_AVERAGES, FIR, *KLIPPER_SHAPERS)
    ),
    jerk_feedforward=True,
    position_loops=ANYWHERE,
    force_filters=8,
    state_feedback=True,
)
"""A free controller."""


def _generic(axis: Axis, loop: Values) -> tuple[Row, ...]:
    limits = ((Setting.ACCELERATION, ""), (Setting.JERK, ""))
    return say_neutrally((*limits, *loop), axis.units)


def _state_space(axis: Axis, loop: Values) -> Iterator[Row]:
    yield from _generic(axis, loop)
    units = axis.state_units
    for setting, state in loop:
        if setting is Setting.STATE_GAIN:
            name, unit = f"state feedback {state}", f"{units['F']}/({units[state]})"
            yield Row(setting, name, index=state, unit=unit, digits=6)


neutral = partial(
    Control,
    layout=TABLE,
    axis_in_group=(
        Row(Setting.WAIT, "wait", unit="ms", digits=9),
        at_corners("velocity step at corners", "m/s", "group-row-step"),
    ),
    group=(
        on_path("acceleration", "path acceleration", "m/s^2"),
        on_path("jerk", "path jerk", "m/s^3"),
    ),
    axes_hold=(),
    corner=CornerRule(kind=Corner.STEP),
)

CONTROL = neutral(kind=GENERIC, rows=_generic)

FREE = neutral(kind=STATE_SPACE, rows=_state_space)
