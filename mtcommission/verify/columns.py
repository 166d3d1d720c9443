"""Columns of a trace -> what each one holds: by our names, by words and units, or as was said."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import pi

from mtcommission.errors import Fault, InputError
from mtcommission.identify.formats.contents import Column
from mtcommission.identify.meaning import columns as identify
from mtcommission.identify.meaning.columns import Course, read_columns
from mtcommission.identify.measurement import FORCES, Sensor, Signal
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


_ACTUAL = {
    Signal.VELOCITY: Role.VELOCITY,
    Signal.ACCELERATION: Role.ACCELERATION,
    **dict.fromkeys(FORCES, Role.FORCE),
}


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
    found = read_columns(columns, said, where=where)
    roles = [_role(one) if one else None for one in found]
    taken = {role for role, one in zip(roles, found, strict=True) if one and one.is_said}
    meanings = [
        _meaning(column, role, one, axis, where=where)
        if one and role and (one.is_said or role not in taken)
        else None
        for column, role, one in zip(columns, roles, found, strict=True)
    ]
    _require_one_each(columns, meanings, where=where)
    return meanings


def _role(one: identify.Meaning) -> Role | None:
    """What a column is to a trace; None where it is of no use."""
    if one.signal is Signal.POSITION:
        by_course = {Course.SETPOINT: Role.SETPOINT, Course.ERROR: Role.FOLLOWING_ERROR}
        actual = Role.TOOL if one.sensor is Sensor.TCP else Role.ENCODER
        return actual if one.course is Course.ACTUAL else by_course.get(one.course)
    if one.course is Course.SETPOINT and one.signal is Signal.VELOCITY:
        return Role.SETPOINT_VELOCITY
    return _ACTUAL[one.signal] if one.course is Course.ACTUAL else None


def _meaning(
    column: Column, role: Role, one: identify.Meaning, axis: Axis, *, where: str
) -> Meaning:
    if one.is_assumed:
        assumed = Message("verify-si-assumed", name=column.name)
        scale = axis.constant if role is Role.FORCE and axis.constant else 1.0
        return Meaning(role=role, scale=scale, remark=assumed)
    scale, remark = _at_axis(column, one, axis, where=where)
    return Meaning(role=role, scale=scale, remark=remark)


def _at_axis(
    column: Column, measured: identify.Meaning, axis: Axis, *, where: str
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
    factor = turn if measured.signal in FORCES else 1.0 / turn
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
