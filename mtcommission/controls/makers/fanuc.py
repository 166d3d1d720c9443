"""FANUC 30i and its relatives."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis, Control, Corner, CornerRule, Typed
from mtcommission.controls.kind import (
    MOVING_AVERAGE,
    ControlKind,
    FilterChoice,
    Jerk,
    PositionLoop,
)
from mtcommission.controls.row import Row, Setting, Values, at_corners, doubted, si_of
from mtcommission.controls.syntax import TABLE


def _rows(axis: Axis, _loop: Values) -> Iterator[Row]:
    gain = "gain-kv-name-and-unit"
    yield Row(Setting.RISE_TIME, "1620", unit="ms", step=1)
    yield Row(Setting.JERK_TIME, "1774", unit="ms", step=axis.cycles(1e-3))
    yield doubted(Setting.POSITION_GAIN, "1825", unit="0.01/s", step=1, meaning=gain)
    yield doubted(Setting.VELOCITY_FEEDFORWARD, "2068", unit="0.01 %", step=1)
    yield Row(Setting.RAPID, "1420", unit=f"{axis.small_unit}/min", is_elsewhere=True)


def _notes(axis: Axis, typed: Typed) -> tuple[Message, ...]:
    length = axis.small_unit
    a = typed.acceleration / si_of(length)
    return (
        Message("fanuc-no-jerk", length=length),
        Message("fanuc-rapid", length=length, acceleration=a),
        Message("fanuc-gain"),
        Message("fanuc-nano"),
        Message("fanuc-look-ahead"),
    )


CONTROL = Control(
    kind=ControlKind(
        key="fanuc",
        unread=(
            *("modes", "setpoint_filters", "velocity_feedforward", "acceleration_feedforward"),
            *("jerk_feedforward", "reference_delay", "position_loops", "position_cycle"),
            *("velocity_cycle", "force_filters", "state_feedback"),
        ),
        jerk=Jerk.TIME,
        setpoint_filters=(FilterChoice(kind=MOVING_AVERAGE, step=1e-3),),
        reference_delay=False,
        position_loops=(PositionLoop.DRIVE,),
        position_cycle=1e-3,
        velocity_cycle=500e-6,
        force_filters=5,
    ),
    rows=_rows,
    layout=TABLE,
    notes_of=_notes,
    # FANUC Series 0i Connection Manual (Function) B-63833EN-1/02, 7, p. 354; A-63512EN, 2.4
    axis_in_group=(at_corners("1783", "mm/min", "group-row-step", step=1),),
    corner=CornerRule(kind=Corner.STEP),
)
