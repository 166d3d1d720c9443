"""An axis of a group with its loop built again: from its record, or as a text makes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.answers import AxisAnswers
from mtcommission.group.circle import Deviation, ToolResponse, deviate, find_response
from mtcommission.group.record import AxisEntry, GroupRecord
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.read_back import close_as_held, read_held, read_limits

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeldAxis:
    """An axis as it follows circles."""

    name: str
    machine: Machine
    tuned: TunedLoop  # in every corner, the nominal machine first
    setpoint_filter: SetpointFilter | None
    poles: LoopPoles
    response: ToolResponse  # wait included, without the filter

    @property
    def answers(self) -> AxisAnswers:
        """How it answers what contours are made of."""
        wait = round(self.response.wait / self.poles.dt)
        return AxisAnswers(poles=self.poles, setpoint_filter=self.setpoint_filter, wait=wait)


def hold_axis(
    name: str, machine: Machine, tuned: TunedLoop, item: SetpointFilter | None, wait: float
) -> HeldAxis:
    """Return an axis behind a filter that waits for some time [s]."""
    poles = find_poles(tuned.loops)
    return HeldAxis(
        name=name,
        machine=machine,
        tuned=tuned,
        setpoint_filter=item,
        poles=poles,
        response=replace(find_response(poles), wait=wait),
    )


def read_axis(entry: AxisEntry) -> HeldAxis:
    """Return an axis of a record as it was when the record was made."""
    machine = read_held(entry)
    item = read_limits(entry.limits.recommended).setpoint_filter
    return hold_axis(entry.name, machine, close_as_held(machine), item, entry.wait)


def read_plane(record: GroupRecord) -> tuple[HeldAxis, HeldAxis]:
    """Return the two axes that draw circles."""
    first, second = (read_axis(record.axis(name)) for name in record.plane)
    return first, second


def find_deviations(axes: Sequence[HeldAxis], omega: Array) -> Deviation:
    """Return how circles come out, as shares of their radius, (n_pairs of corners, *omega.shape).

    The first pair is that of the nominal machines.
    """
    first, second = (axis.response.at(omega, axis.setpoint_filter) for axis in axes)
    every = deviate(first[:, None], second[None])
    shape = (-1, *omega.shape)
    return Deviation(radius=every.radius.reshape(shape), form=every.form.reshape(shape))


def find_ellipses(axes: Sequence[HeldAxis], omega: Array) -> Complex:
    """Return how oval circles come out, as shares of their radius, (n_pairs, *omega.shape).

    The radius is off by the real part times cos 2θ and the imaginary part times sin 2θ, θ the
    tool's angle, counterclockwise; clockwise the imaginary part has the other sign.
    """
    first, second = (axis.response.at(omega, axis.setpoint_filter) for axis in axes)
    mean = (first[:, None] + second[None]).reshape(-1, *omega.shape)
    apart = (first[:, None] - second[None]).reshape(-1, *omega.shape)
    return np.asarray(0.5 * np.conj(apart) * mean / np.abs(mean))
