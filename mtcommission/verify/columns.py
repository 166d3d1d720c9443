"""Columns of a trace -> what each one holds: by our names, by words and units, or as was said."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import pi

from mtcommission.errors import Fault, InputError
from mtcommission.identify.formats.contents import Column
from mtcommission.identify.formats.heads import words_of
from mtcommission.identify.formats.plain import find_columns
from mtcommission.identify.meaning.columns import place_in, says_setpoint, signals_in
from mtcommission.identify.meaning.units import SignalUnit, read_signal_unit
from mtcommission.identify.measurement import Sensor, Signal
from mtcommission.machine.drive import Drive
from mtcommission.messages.message import Message


class Role(StrEnum):
    """What a column of a trace holds; the value is our name of it."""

    SETPOINT = "x_ref"
    SETPOINT_VELOCITY = "v_ref"
    ENCODER = "encoder"
    VELOCITY = "velocity"
    FOLLOWING_ERROR = "following_error"
    TOOL = "tcp"
    ACCELERATION = "acceleration"
    FORCE = "force"


NAMES = {**{role.value: role for role in Role}, "torque": Role.FORCE, "current": Role.FORCE}
"""Names of ``--columns``; see docs/verification.md."""

_FORCES = (Signal.FORCE, Signal.TORQUE, Signal.CURRENT)
_SIGNALS = {
    Role.SETPOINT: (Signal.POSITION,),
    Role.SETPOINT_VELOCITY: (Signal.VELOCITY,),
    Role.ENCODER: (Signal.POSITION,),
    Role.VELOCITY: (Signal.VELOCITY,),
    Role.FOLLOWING_ERROR: (Signal.POSITION,),
    Role.TOOL: (Signal.POSITION,),
    Role.ACCELERATION: (Signal.ACCELERATION,),
    Role.FORCE: _FORCES,
}
_ERRORS = ({"following", "error"}, {"position", "error"}, {"pos", "error"}, {"lag", "error"},
           {"pos", "err"}, {"position", "diff"}, {"tracking", "error"}, {"ferror"}, {"f", "error"},
           {"schleppabstand"}, {"schleppfehler"}, {"lagedifferenz"}, {"regeldifferenz"},
           {"nachlauffehler"})  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """What columns must know of the axis."""

    rotary: bool  # Whether lengths are angles
    drive: Drive  # Lead and gear, for values at the motor's shaft
    # Force (torque) per ampere, or per unit of a column without one [N/A, N m/A]; None: not said.
    constant: float | None

    @property
    def motor_turn(self) -> float:
        """Angle of the motor per travel of the axis [rad/m, rad/rad]; 0: not known."""
        if self.rotary:
            return self.drive.gear
        return 2.0 * pi * self.drive.gear / self.drive.lead if self.drive.lead else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Meaning:
    """What a column holds."""

    role: Role
    scale: float  # SI value at the axis of one unit of the file
    remark: Message | None = None  # What was assumed


def read_meanings(
    columns: Sequence[Column], said: Mapping[str, str], axis: Axis, *, where: str
) -> list[Meaning | None]:
    """Return what each column holds; None for one that is not needed.

    Raises
    ------
    InputError
        A name that is none of ours, a unit that does not fit, or two columns for one role.
    """
    given = {
        place: (NAMES[name], unit or columns[place].unit)
        for place, (name, unit) in find_columns(
            [column.name for column in columns], said, NAMES
        ).items()
    }
    taken = {role for role, _ in given.values()}
    found: list[Meaning | None] = []
    for place, column in enumerate(columns):
        if place in given:
            found.append(_meaning(column, *given[place], axis, where=where))
            continue
        role = _role(column)
        if role is None or role in taken:
            found.append(None)
        else:
            found.append(_meaning(column, role, column.unit, axis, where=where))
    _require_one_each(columns, found, where=where)
    return found


def _role(column: Column) -> Role | None:
    """By name and unit; None where they leave it open."""
    own = column.name.casefold().replace(" ", "_")
    if own in NAMES:
        return NAMES[own]
    words = words_of(column.name)
    unit = read_signal_unit(column.unit) if column.unit else None
    by_name = signals_in(words)
    signal = unit.signal if unit else by_name[0] if len(by_name) == 1 else None
    if signal is None:
        return None
    if signal is Signal.POSITION:
        if any(error <= set(words) for error in _ERRORS):
            return Role.FOLLOWING_ERROR
        if says_setpoint(words):
            return Role.SETPOINT
        sensor = column.sensor or place_in(words)
        return Role.TOOL if sensor is Sensor.TCP else Role.ENCODER
    if says_setpoint(words):
        return Role.SETPOINT_VELOCITY if signal is Signal.VELOCITY else None
    if signal is Signal.VELOCITY:
        return Role.VELOCITY
    if signal is Signal.ACCELERATION:
        return Role.ACCELERATION
    return Role.FORCE


def _meaning(column: Column, role: Role, unit: str, axis: Axis, *, where: str) -> Meaning:
    if not unit:
        assumed = Message("verify-si-assumed", name=column.name)
        scale = axis.constant if role is Role.FORCE and axis.constant else 1.0
        return Meaning(role=role, scale=scale, remark=assumed)
    measured = read_signal_unit(unit)
    if measured is None or measured.signal not in _SIGNALS[role]:
        message = Message("verify-unit-contradicts", name=column.name, unit=unit, role=role.value)
        raise InputError([Fault(where=where, message=message)])
    scale, remark = _at_axis(column, measured, axis, where=where)
    return Meaning(role=role, scale=scale, remark=remark)


def _at_axis(
    column: Column, measured: SignalUnit, axis: Axis, *, where: str
) -> tuple[float, Message | None]:
    """SI value at the axis per unit, and what was taken for it."""
    if measured.signal is Signal.CURRENT:
        if axis.constant is None:
            message = Message("verify-constant-missing", name=column.name)
            raise InputError([Fault(where=where, message=message)])
        return measured.scale * axis.constant, None
    if measured.rotary == axis.rotary:
        return measured.scale, None
    turn = axis.motor_turn
    if axis.rotary or turn == 0.0:
        message = Message("verify-other-motion", name=column.name, unit=column.unit)
        raise InputError([Fault(where=where, message=message)])
    factor = turn if measured.signal in _FORCES else 1.0 / turn
    remark = Message("verify-at-motor", name=column.name, unit=column.unit)
    return measured.scale * factor, remark


def _require_one_each(
    columns: Sequence[Column], found: Sequence[Meaning | None], *, where: str
) -> None:
    for role in Role:
        same = [c.name for c, m in zip(columns, found, strict=True) if m and m.role is role]
        if len(same) > 1:
            message = Message("verify-two-columns", role=role.value, names=tuple(same))
            raise InputError([Fault(where=where, message=message)])
