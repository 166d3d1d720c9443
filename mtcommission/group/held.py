"""An axis of a group with its loop built again: from its record, or as a text makes it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.circle import ToolResponse, find_response
from mtcommission.group.record import GroupRecord
from mtcommission.loop.poles import find_poles
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.read_back import close_as_held, read_held, read_limits

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeldAxis:
    """An axis as it follows circles."""

    machine: Machine
    tuned: TunedLoop  # in every corner, the nominal machine first
    setpoint_filter: SetpointFilter | None
    response: ToolResponse  # wait included, without the filter


def hold_axis(
    machine: Machine, tuned: TunedLoop, item: SetpointFilter | None, wait: float
) -> HeldAxis:
    """Return an axis behind a filter that waits for some time [s]."""
    response = replace(find_response(find_poles(tuned.loops)), wait=wait)
    return HeldAxis(machine=machine, tuned=tuned, setpoint_filter=item, response=response)


def read_plane(record: GroupRecord) -> tuple[HeldAxis, HeldAxis]:
    """Return the two axes that draw circles, as they were when the record was made."""
    axes = []
    for name in record.plane:
        entry = record.axis(name)
        machine = read_held(entry)
        item = read_limits(entry.limits.recommended).setpoint_filter
        axes.append(hold_axis(machine, close_as_held(machine), item, entry.wait))
    return axes[0], axes[1]


def find_circle(
    first: HeldAxis, second: HeldAxis, *, radius: float, feed: float
) -> tuple[Array, Complex]:
    """Return how a circle comes out in every pair of corners, the nominal first, (n_pairs,) [m].

    The deviation of its mean radius, and E: the radius is off by Re E cos 2θ + Im E sin 2θ, too, θ
    the tool's angle, counterclockwise; clockwise Im E has the other sign.
    """
    omega = np.array([feed / radius])
    G_x = first.response.at(omega, first.setpoint_filter)[:, None, 0]
    G_y = second.response.at(omega, second.setpoint_filter)[None, :, 0]
    mean = 0.5 * np.abs(G_x + G_y)
    E = 0.25 * np.conj(G_x - G_y) * (G_x + G_y) / mean
    return radius * (mean - 1.0).ravel(), radius * E.ravel()
