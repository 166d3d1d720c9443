"""What a group of axes must keep: each axis' own requirements, circles, reversals."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mtcommission.group.group import Group, GroupAxis, worst_deviation
from mtcommission.messages.message import Message
from mtcommission.requirements.settling_time import SETTLING_TIME


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupCheck:
    """One requirement of a group against the worst that was found."""

    name: str  # in records
    label: Message
    value: float  # [unit]
    limit: float
    reserve: float  # share of the limit that the choice may use [-]
    unit: str
    where: Message

    @property
    def is_met(self) -> bool:
        """Whether it is kept."""
        return self.value <= self.limit * (1.0 + 1e-9)


def judge_group(group: Group) -> tuple[GroupCheck, ...]:
    """Return every requirement of a group: contour first, then each axis' own."""
    checks = [_circles(group), *_reversals(group)]
    for axis in group.axes:
        checks += _own(axis, group)
    return tuple(checks)


def _circles(group: Group) -> GroupCheck:
    """Every circle that path limits and feed permit; with a radius asked for, that at the feed."""
    task, item = group.task, group.setpoint_filter
    if task.radius is not None:
        omega, radii = np.array([task.feed / task.radius]), np.array([task.radius])
    else:
        omega = group.responses[0].omega
        largest = task.feed / omega, group.acceleration / omega**2, group.jerk / omega**3
        radii = np.minimum.reduce(largest)
    off = worst_deviation(group.responses, omega, item)[0].largest * radii
    worst = int(off.argmax())
    where = Message("group-where-circle", radius=radii[worst], feed=radii[worst] * omega[worst])
    noise = group.encoder_noise
    return GroupCheck(
        name="circle",
        label=Message("group-check-circle"),
        value=float(off[worst]) + noise,
        limit=task.tolerance,
        reserve=group.reserve,
        unit="m",
        where=where,
    )


def _reversals(group: Group) -> Iterator[GroupCheck]:
    """Peaks where an axis reverses at the feed, where friction is stated."""
    fastest = max(group.circles, key=lambda circle: circle.feed)
    for axis, peak in fastest.quadrant_peak.items():
        yield GroupCheck(
            name=f"quadrant peak {axis}",
            label=Message("group-check-peak", name=axis),
            value=peak,
            limit=group.task.tolerance,
            reserve=1.0,
            unit="m",
            where=Message("group-where-circle", radius=fastest.radius, feed=fastest.feed),
        )


def _own(axis: GroupAxis, group: Group) -> Iterator[GroupCheck]:
    """The axis' own requirements, with the group's filter, and its wait where time counts."""
    wait = axis.wait * axis.alone.poles.dt
    for check in axis.choice.candidate.assessment.checks:
        late = wait if check.requirement is SETTLING_TIME else 0.0
        yield GroupCheck(
            name=f"{check.name} {axis.name}",
            label=Message("group-check-of", name=axis.name, requirement=check.requirement.message),
            value=check.value + late,
            limit=check.limit,
            reserve=check.reserve,
            unit=check.unit,
            where=check.where,
        )
