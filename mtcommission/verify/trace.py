"""What was recorded during a move: files, by the readers of ``identify``, to traces in SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from hashlib import sha256
from math import ceil

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.measured.columns import Course, Meaning, read_columns
from mtcommission.measured.formats.recognise import read_contents, read_measured
from mtcommission.measured.measurement import (
    FORCES,
    Array,
    Channel,
    Column,
    Given,
    Sensor,
    Signal,
    TimeContents,
    refuse,
)
from mtcommission.measured.signals import read_clock

SAME_TRAVEL = 0.5
"""Relative difference between what setpoint and encoder travel that no following error explains:
a wrong unit."""

FINEST = 1e-11
"""Share of the range below which a step of the values is rounding."""

ABSURD = 1e30
"""Of no signal in its own unit: its squares, summed, might be no numbers any more."""


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


_MEASURED = (Role.ENCODER, Role.FOLLOWING_ERROR, Role.TOOL, Role.ACCELERATION)
_ROLES = {
    (Signal.POSITION, Course.SETPOINT): Role.SETPOINT,
    (Signal.VELOCITY, Course.SETPOINT): Role.SETPOINT_VELOCITY,
    (Signal.POSITION, Course.ERROR): Role.FOLLOWING_ERROR,
    (Signal.POSITION, Course.ACTUAL): Role.ENCODER,
    (Signal.VELOCITY, Course.ACTUAL): Role.VELOCITY,
    (Signal.ACCELERATION, Course.ACTUAL): Role.ACCELERATION,
    **{(signal, Course.ACTUAL): Role.FORCE for signal in FORCES},
}
"""Of a column that is no position of the tool; others are of no use to a trace."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """A recorded file: of each role at most one channel, a setpoint and something measured."""

    file: str  # name as it was given
    sha256: str  # of its bytes
    channels: Mapping[Role, Channel]
    gaps: tuple[tuple[float, float], ...] = ()  # begin and end of stretches without samples [s]
    is_delayed: bool = False  # whether the setpoint was recorded behind τ, as the loop compares it
    remarks: tuple[Message, ...] = ()  # what was done to it, assumed, and what is doubtful

    def before(self, instant: float) -> Trace:
        """Return the trace up to an instant."""
        channels = {
            role: replace(one, values=one.values[: max(ceil((instant - one.start) / one.step), 1)])
            for role, one in self.channels.items()
        }
        return replace(self, channels=channels)

    @property
    def setpoint(self) -> Channel:
        """The setpoint's position."""
        return self.channels[Role.SETPOINT]


def read_trace(name: str, given: Given) -> Trace:
    """Return what a file holds.

    Raise InputError where it is no record over time, has no setpoint, nothing measured, or
    contradicts itself: a name that is none of ours, a unit that does not fit, two of one role.
    """
    data = read_measured(name)
    contents = read_contents(data, given.columns, where=name)
    items = [item for item in contents.items if isinstance(item, TimeContents) and item.columns]
    if not items:
        raise refuse(name, "verify-no-time-record")
    columns = [column for item in items for column in item.columns]
    used, assumed = _roles(columns, given, where=name)
    remarks = [*contents.remarks, *assumed]
    channels: dict[Role, Channel] = {}
    gaps: list[tuple[float, float]] = []
    for item in items:
        own = [column for column in item.columns if id(column) in used]
        if not own:
            continue
        clock = read_clock(item, given.columns, where=name)
        remarks += [Message("verify-gap", begin=a, end=b) for a, b in clock.gaps]
        remarks += clock.remarks
        gaps += clock.gaps
        for column in own:
            role, scale, one = used[id(column)]
            if not np.all(np.abs(column.values) < ABSURD):
                raise refuse(name, "identify-series-not-finite", name=column.name)
            channels[role] = clock.channel(
                column, one.signal, scale=scale, sensor=one.sensor, rotary=given.rotary
            )
    names = tuple(column.name for column in columns)
    if unused := tuple(one for one in names if one not in [own.name for own in channels.values()]):
        remarks.append(Message("identify-ignored", names=unused))
    if Role.SETPOINT not in channels:
        setpoint, remark = _other_setpoint(channels, names, where=name)
        channels = {Role.SETPOINT: setpoint, **channels}
        remarks.append(remark)
    if not channels.keys() & set(_MEASURED):
        raise refuse(name, "verify-missing-measured", found=names)
    channels, turned = _check_travel(channels, where=name)
    return Trace(
        file=name,
        sha256=sha256(data).hexdigest(),
        channels=channels,
        gaps=tuple(gaps),
        is_delayed=any(one.kind == "verify-setpoint-from-error" for one in remarks),
        remarks=tuple(dict.fromkeys([*remarks, *turned])),
    )


def _roles(
    columns: Sequence[Column], given: Given, *, where: str
) -> tuple[dict[int, tuple[Role, float, Meaning]], list[Message]]:
    """Role, SI value per unit and meaning of the columns of use, and what was assumed of them."""
    found = []
    for column, one in zip(columns, read_columns(columns, given.columns, where=where), strict=True):
        if one and (role := _ROLES.get((one.signal, one.course))):
            at_tool = role is Role.ENCODER and one.sensor is Sensor.TCP
            found.append((column, Role.TOOL if at_tool else role, one))
    said = {role for _, role, one in found if one.is_said}
    found = [row for row in found if row[2].is_said or row[1] not in said]
    used, remarks = {}, []
    for column, role, one in found:
        scale, remark = _at_axis(column, role, one, given, where=where)
        used[id(column)] = role, scale, one
        remarks += [remark] if remark else []
    for role in Role:
        same = tuple(column.name for column, own, _ in found if own is role)
        if len(same) > 1:
            raise refuse(where, "verify-two-columns", role=role.value, names=same)
    return used, remarks


def _at_axis(
    column: Column, role: Role, one: Meaning, given: Given, *, where: str
) -> tuple[float, Message | None]:
    """SI value at the axis per unit, and what was taken for it."""
    name, unit = column.name, column.unit
    if one.is_assumed:
        scale = given.constant if role is Role.FORCE and given.constant else 1.0
        return scale, Message("verify-si-assumed", name=name)
    if one.signal is Signal.CURRENT:
        if given.constant is None:
            raise refuse(where, "verify-constant-missing", name=name)
        return one.scale * given.constant, None
    if one.rotary == given.rotary:
        return one.scale, None
    turn = given.motor_turn
    if given.rotary or turn == 0.0:
        raise refuse(where, "verify-other-motion", name=name, unit=unit)
    factor = turn if one.signal in FORCES else 1.0 / turn
    return one.scale * factor, Message("verify-at-motor", name=name, unit=unit)


def _other_setpoint(
    by_role: Mapping[Role, Channel], names: tuple[str, ...], *, where: str
) -> tuple[Channel, Message]:
    """A setpoint's position from its velocity, or from position and following error."""
    if rate := by_role.get(Role.SETPOINT_VELOCITY):
        sums = np.concatenate([[0.0], np.cumsum(rate.values[1:] + rate.values[:-1])])
        position = replace(rate, values=0.5 * rate.step * sums)
        return position, Message("verify-setpoint-from-velocity", name=rate.name)
    place, error = by_role.get(Role.ENCODER), by_role.get(Role.FOLLOWING_ERROR)
    if place and error and place.values.size == error.values.size:
        position = replace(place, values=place.values + error.values)
        return position, Message("verify-setpoint-from-error", name=place.name, error=error.name)
    raise refuse(where, "verify-missing-setpoint", found=names)


def _check_travel(
    channels: Mapping[Role, Channel], *, where: str
) -> tuple[dict[Role, Channel], list[Message]]:
    """Positions that travel as far as the setpoint; a reversed sensor is turned, and said."""
    setpoint = channels[Role.SETPOINT]
    if float(np.ptp(setpoint.values)) == 0.0:
        raise refuse(where, "verify-no-motion", name=setpoint.name)
    found, remarks = {}, []
    for role, one in channels.items():
        if role in (Role.ENCODER, Role.TOOL):
            at = np.interp(one.t, setpoint.t, setpoint.values)
            slope = float(np.polyfit(at - at.mean(), one.values, 1)[0]) if np.ptp(at) else 1.0
            if abs(abs(slope) - 1.0) > SAME_TRAVEL:
                kind, reference = "verify-other-travel", setpoint.name
                raise refuse(where, kind, name=one.name, reference=reference, ratio=slope)
            if slope < 0.0:
                remarks.append(Message("verify-reversed", name=one.name))
                one = replace(one, values=-one.values)
        found[role] = one
    return found, remarks


def resolution(values: Array) -> float:
    """Return the step in which values were written down; of unrounded ones next to nothing.

    Examples
    --------
    >>> round(resolution(np.array([0.0, 0.002, 0.003, 0.003, 0.007])), 9)
    0.001
    """
    steps = np.diff(np.unique(values))
    steps = steps[steps > FINEST * float(np.ptp(values))]
    return float(steps.min(initial=np.inf)) if steps.size else 0.0
