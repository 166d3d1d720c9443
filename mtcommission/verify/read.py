"""Recorded files -> traces: the readers of ``identify``, other columns, one clock for each."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from mtcommission.errors import Fault, InputError
from mtcommission.files import read_bytes
from mtcommission.identify.formats.contents import TimeContents
from mtcommission.identify.formats.plain import SAMPLE_TIME
from mtcommission.identify.formats.recognise import read_contents
from mtcommission.identify.formats.text import LARGEST_FILE
from mtcommission.identify.gather import STANDARD_INPUT
from mtcommission.identify.meaning.clock import LEAST_SAMPLES, LONGEST_STEP, SHORTEST_STEP
from mtcommission.messages.message import Message
from mtcommission.units.quantities import TIME, parse_quantity
from mtcommission.verify.columns import Axis, Meaning, read_meanings
from mtcommission.verify.trace import Array, Channel, Role, Trace

ROUNDING = 0.02
"""Distance from an even clock, as share of the step, that printed times may have."""

GAP = 4.0
"""Steps without a sample from which on something is missing."""

SIGMAS = 3.0
"""Standard errors that the largest error of an interpolation is taken for."""

SAME_TRAVEL = 0.5
"""Relative difference between what setpoint and encoder travel that no following error explains:
a wrong unit."""

SETPOINT_FROM_ERROR = "verify-setpoint-from-error"

_MEASURED = (Role.ENCODER, Role.FOLLOWING_ERROR, Role.TOOL, Role.ACCELERATION)


def read_trace(name: str, said: Mapping[str, str], axis: Axis) -> Trace:
    """Return what a file holds.

    Raises
    ------
    InputError
        It is no record over time, has no setpoint, nothing measured, or contradicts itself.
    """
    if name == STANDARD_INPUT:
        data = sys.stdin.buffer.read(LARGEST_FILE + 1)
    else:
        folder = Message("identify-file-is-folder")
        data = read_bytes(Path(name), folder=folder, most=LARGEST_FILE + 1)
    contents = read_contents(data, said, where=name)
    items = [item for item in contents.items if isinstance(item, TimeContents) and item.columns]
    if not items:
        raise _fault(name, Message("verify-no-time-record"))
    columns = [column for item in items for column in item.columns]
    meanings = read_meanings(columns, said, axis, where=name)
    remarks = [*contents.remarks, *(m.remark for m in meanings if m and m.remark)]
    channels, gaps = [], []
    for item in items:
        own, meanings = meanings[: len(item.columns)], meanings[len(item.columns) :]
        if not any(own):
            continue
        clock = _Clock.of(item, said, where=name)
        remarks += clock.remarks
        gaps += clock.gaps
        channels += [
            clock.sample(meaning, column.name, column.values)
            for column, meaning in zip(item.columns, own, strict=True)
            if meaning
        ]
    unused = tuple(c.name for c in columns if c.name not in {one.name for one in channels})
    if unused:
        remarks.append(Message("identify-ignored", names=unused))
    channels, more = _with_setpoint(channels, tuple(c.name for c in columns), where=name)
    if not any(one.role in _MEASURED for one in channels):
        raise _fault(
            name, Message("verify-missing-measured", found=tuple(one.name for one in columns))
        )
    channels, turned = _check_travel(channels, where=name)
    return Trace(
        file=name,
        sha256=sha256(data).hexdigest(),
        channels=tuple(channels),
        gaps=tuple(gaps),
        is_delayed=any(one.kind == SETPOINT_FROM_ERROR for one in more),
        remarks=tuple(dict.fromkeys([*remarks, *more, *turned])),
    )


class _Clock:
    """Times of a record, and the even ones at which its columns are wanted."""

    def __init__(self, times: Array, step: float, remarks: list[Message]) -> None:
        self.times, self.step, self.remarks = times, step, remarks
        steps = np.diff(times)
        at = np.flatnonzero(steps > GAP * step)
        self.gaps = [(float(times[i]), float(times[i + 1])) for i in at]
        self.remarks += [Message("verify-gap", begin=a, end=b) for a, b in self.gaps]
        count = int(np.floor((times[-1] - times[0]) / step + 1e-6)) + 1
        self.even = times[0] + step * np.arange(count, dtype=np.float64)
        same = count == times.size and float(np.abs(times - self.even).max()) <= ROUNDING * step
        self.is_even = same
        if not same and not self.gaps:
            spread = float(steps.max() - steps.min()) / step
            self.remarks.append(Message("identify-resampled", spread=spread, step=step))

    @classmethod
    def of(cls, item: TimeContents, said: Mapping[str, str], *, where: str) -> _Clock:
        """Return the clock of a record, or raise what is wrong with it."""
        size = item.columns[0].values.size
        if size < LEAST_SAMPLES:
            few = Message("identify-too-few-samples", got=size, least=LEAST_SAMPLES)
            raise _fault(where, few)
        if item.clock is None:
            step = item.sample_time or parse_quantity(said.get(SAMPLE_TIME, "0 s"), TIME)
            if step <= 0.0:
                raise _fault(where, Message("identify-no-sample-time"))
            times = step * np.arange(size, dtype=np.float64)
        else:
            times = _rising(item.clock, item.lines, where=where)
            steps = np.diff(times)
            step = float(np.mean(steps[steps <= GAP * np.median(steps)]))
        if not SHORTEST_STEP <= step <= LONGEST_STEP:
            raise _fault(where, Message("identify-step-out-of-range", step=step))
        return cls(times, step, [])

    def sample(self, meaning: Meaning, name: str, values: Array) -> Channel:
        """Return a column at the even times."""
        even, error = values, 0.0
        if not self.is_even:
            even = CubicSpline(self.times, values)(self.even)
            # Every other sample from its neighbours errs more than the sample between them.
            half = CubicSpline(self.times[::2], values[::2])(self.times[1:-1:2])
            error = float(np.abs(values[1:-1:2] - half).max()) / SIGMAS
        return Channel(
            role=meaning.role,
            name=name,
            start=float(self.even[0]),
            step=self.step,
            values=meaning.scale * np.asarray(even, dtype=np.float64),
            error=abs(meaning.scale) * error,
        )


def _rising(clock: Array, lines: object, *, where: str) -> Array:
    """Times that rise; those printed with too few digits are spread evenly between."""
    steps = np.diff(clock)
    if (steps > 0.0).all():
        return clock
    at = int(np.argmax(steps < 0.0))
    even = np.linspace(clock[0], clock[-1], clock.size)
    grain = float(steps.max())
    if steps[at] < 0.0 or grain == 0.0 or float(np.abs(clock - even).max()) > 1.5 * grain:
        at = int(np.argmax(steps <= 0.0))
        message = Message("identify-time-does-not-rise", before=clock[at], after=clock[at + 1])
        numbers = np.asarray(lines)
        line = int(numbers[at + 1]) if numbers.size else 0
        raise InputError([Fault(where=where, line=line, message=message)])
    return np.asarray(even, dtype=np.float64)


def _with_setpoint(
    channels: list[Channel], names: tuple[str, ...], *, where: str
) -> tuple[list[Channel], list[Message]]:
    """The channels with a setpoint's position, integrated from its velocity if need be."""
    by_role = {one.role: one for one in channels}
    if Role.SETPOINT in by_role:
        return channels, []
    rate = by_role.get(Role.SETPOINT_VELOCITY)
    if rate is not None:
        sums = np.concatenate([[0.0], np.cumsum(rate.values[1:] + rate.values[:-1])])
        own = replace(rate, role=Role.SETPOINT, values=0.5 * rate.step * sums)
        return [own, *channels], [Message("verify-setpoint-from-velocity", name=rate.name)]
    place, error = by_role.get(Role.ENCODER), by_role.get(Role.FOLLOWING_ERROR)
    if place is not None and error is not None and place.values.size == error.values.size:
        own = replace(place, role=Role.SETPOINT, values=place.values + error.values)
        remark = Message(SETPOINT_FROM_ERROR, name=place.name, error=error.name)
        return [own, *channels], [remark]
    message = Message("verify-missing-setpoint", found=names)
    raise InputError([Fault(where=where, message=message)])


def _check_travel(channels: list[Channel], *, where: str) -> tuple[list[Channel], list[Message]]:
    """Positions that travel as far as the setpoint; a reversed sensor is turned, and said."""
    setpoint = next(one for one in channels if one.role is Role.SETPOINT)
    travel = float(np.ptp(setpoint.values))
    if travel == 0.0:
        raise _fault(where, Message("verify-no-motion", name=setpoint.name))
    found, remarks = [], []
    for one in channels:
        if one.role not in (Role.ENCODER, Role.TOOL):
            found.append(one)
            continue
        at = np.interp(one.t, setpoint.t, setpoint.values)
        slope = float(np.polyfit(at - at.mean(), one.values, 1)[0]) if np.ptp(at) > 0.0 else 1.0
        if abs(abs(slope) - 1.0) > SAME_TRAVEL:
            kind = "verify-other-travel"
            message = Message(kind, name=one.name, reference=setpoint.name, ratio=slope)
            raise _fault(where, message)
        if slope < 0.0:
            remarks.append(Message("verify-reversed", name=one.name))
            one = replace(one, values=-one.values)
        found.append(one)
    return found, remarks


def _fault(where: str, message: Message) -> InputError:
    return InputError([Fault(where=where, message=message)])
