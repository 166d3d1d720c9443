"""What a group of axes must keep: each axis' own requirements, circles, reversals."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mtcommission.group.answers import line_deviation
from mtcommission.group.contours import Contours
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


def judge_group(group: Group, contours: Contours) -> tuple[GroupCheck, ...]:
    """Return every requirement of a group: contour first, then each axis' own."""
    checks = [_circles(group), _lines(group), *_reversals(group, contours)]
    for axis in group.axes:
        checks += _own(axis, group)
    return tuple(checks)


def _circles(group: Group) -> GroupCheck:
    """Every circle that path limits and feed permit; with a radius asked for, that at the feed."""
    task, item, plane = group.task, group.setpoint_filter, group.plane
    if task.radius is not None:
        omega, radii = np.array([task.feed / task.radius]), np.array([task.radius])
    else:
        omega = plane.responses[0].omega
        largest = task.feed / omega, group.acceleration / omega**2, group.jerk / omega**3
        radii = np.minimum.reduce(largest)
    entry = group.entry * radii * omega**2
    off = np.maximum(worst_deviation(plane.responses, omega, item)[0].largest * radii, entry)
    worst = int(off.argmax())
    where = Message(
        "group-where-circle",
        radius=float(radii[worst]),
        feed=float(radii[worst] * omega[worst]),
    )
    return _of_contour(group, "circle", float(off[worst]), where)


def _lines(group: Group) -> GroupCheck:
    """Lines in every direction, with the path limits up to the feed."""
    off = line_deviation(
        *group.answers, feed=group.task.feed, acceleration=group.acceleration, jerk=group.jerk
    )
    return _of_contour(group, "line", off, Message("group-where-line", feed=group.task.feed))


def _of_contour(group: Group, name: str, off: float, where: Message) -> GroupCheck:
    return GroupCheck(
        name=name,
        label=Message(f"group-check-{name}"),
        value=off + group.encoder_noise,
        limit=group.task.tolerance,
        reserve=group.reserve,
        unit="m",
        where=where,
    )


def _reversals(group: Group, contours: Contours) -> Iterator[GroupCheck]:
    """Peaks where an axis reverses at the feed, where friction is stated."""
    fastest = max(contours.circles, key=lambda circle: circle.feed)
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
