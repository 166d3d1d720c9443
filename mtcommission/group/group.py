"""From axes that were judged alone to what they are told together; read ``join`` first.

own loop and limits -> one position gain where lag counts -> one delay -> one filter -> path limits
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR
from math import ceil, hypot, inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.commission.recommend import Progress, Recommendation, recommend
from mtcommission.controls.control import Control
from mtcommission.controls.kind import MOVING_AVERAGE, Jerk
from mtcommission.controls.kinds import CONTROLS
from mtcommission.controls.row import (
    PATH_ACCELERATION,
    PATH_JERK,
    WAIT,
    Key,
    round_number,
)
from mtcommission.group.contours import (
    Pair,
    PathLimits,
    entries_at_first_look,
    find_entries,
    line_deviation,
    worst_circle,
)
from mtcommission.group.follow import Follower, follow
from mtcommission.group.task import Task
from mtcommission.limits.choose import Choice
from mtcommission.limits.judge import Candidate
from mtcommission.loop.disturbance import worst_noise
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.study.variations import Row, choose, judge, look

Array = NDArray[np.float64]

NEARLY = 0.8
"""Share of the largest path acceleration from which a filter is as good for circles as the best
(design choice) [-]."""

ALL = 0.999
"""Share of the axes' acceleration that is all of it, but for the steps of ``LADDER`` [-]."""

SHORT = 0.8
"""Of the path acceleration without a filter, what an average must leave to be tried; the longest of
these and one half as long are (design choice) [-]."""

LEAST_RADIUS = 1e-3
"""Of circles that must keep the tolerance [m]; smaller ones are passed as corners are (design
choice)."""

LADDER = np.geomspace(1.0, 1e-3, 700)
"""Shares of the axes' acceleration at which circles are looked at, the largest first."""

UNBOUND = 1.75
"""Times the largest limit of an axis, with which one along the path bounds no direction: more than
sqrt(3). Source: HEIDENHAIN MANUALplus 620 Technical Manual, p. 834."""

ROUNDS, LOWER = 12, 0.98
"""Times that path limits are lowered for lines, at most, and by how much more than in proportion
(empirical)."""

BY_CONTOUR = Message("group-bound-by-contour")
"""What binds an axis whose limits were lowered in place of those of the path."""

TENTH = 7
"""Decimals of a wait [s]: a tenth of a microsecond."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Trial:
    """A setpoint filter for all axes, and what it costs and gives, at a first look."""

    filter: SetpointFilter | None
    settling_time: float  # of the slowest axis, without the wait of the others; inf: never
    axes_acceleration: float  # the smallest of the axes' limits [m/s²]
    path_acceleration: float  # with which every circle keeps the tolerance [m/s²]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GroupAxis:
    """What one axis is told: alone at first, then in the group."""

    found: Recommendation  # alone
    choice: Choice  # its limits
    follower: Follower  # how it follows contours
    slowed: Candidate | None = None
    """Its moves with the limits of the path, where these are less than its own."""

    @property
    def machine(self) -> Machine:
        """The axis."""
        return self.found.machine

    @property
    def name(self) -> str:
        """As the profile gives it."""
        return self.machine.axis

    @property
    def in_effect(self) -> Candidate:
        """Its moves with all limits that hold, its own and those of the path."""
        return self.slowed or self.choice.candidate

    def behind(self, item: SetpointFilter | None) -> Row:
        """Return it with its own loop behind a filter, to look at or to choose limits for."""
        control = replace(self.machine.control, setpoint_filter=item, seeks_setpoint_filter=False)
        machine = replace(self.machine, control=control)
        return Row(machine=machine, tuned=self.found.tuned, refined=0)

    def told(self, item: SetpointFilter | None) -> GroupAxis:
        """Return it with a filter and the limits that go with that."""
        is_own = self.choice.limits.setpoint_filter == item
        return replace(
            self,
            choice=self.choice if is_own else choose(self.behind(item)),
            follower=replace(self.follower, setpoint_filter=item),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Group:
    """Axes that move together: what they are told."""

    task: Task
    control: Control
    axes: tuple[GroupAxis, ...]
    setpoint_filter: SetpointFilter | None  # of every axis
    filter_reason: Message  # why that one
    path: PathLimits
    reserve: float  # share of the tolerance that circles and corners may use [-]
    encoder_noise: float  # what the encoders of the plane add [m]
    entries: Array
    """What entering a circle does at most, as a share of its radius, by the angular velocities of
    the plane's axes [-]."""

    @property
    def allowed(self) -> float:
        """What is left of the tolerance for circles and corners [m]."""
        return max(self.reserve * self.task.tolerance - self.encoder_noise, 0.0)

    @property
    def drawn(self) -> tuple[GroupAxis, GroupAxis]:
        """The two axes of the plane."""
        first, second = self.task.plane
        return self.axes[first], self.axes[second]

    @property
    def pair(self) -> Pair:
        """How these follow contours."""
        first, second = self.drawn
        return first.follower, second.follower


def join(task: Task, *, progress: Progress = lambda _: None) -> Group:
    """Return what axes are told together.

    Raises
    ------
    ComputationError
        A stage ended with a named outcome; the message tells the remedy.
    """
    alone = _match_gains([_stand_alone(machine, progress) for machine in task.machines], progress)
    progress(Message("stage-group"))
    control = CONTROLS[task.machines[0].control.kind.key]
    if control.place_of(WAIT):
        alone = _wait_for_slowest(alone)
    drives = [alone[i] for i in task.plane]
    noise = sum(
        worst_noise(one.follower.tuned.loops, one.machine.drive.encoder_resolution).tool
        for one in drives
    )
    reserve = min(machine.requirements.reserve.band for machine in task.machines)
    allowed = max(reserve * task.tolerance - noise, 0.0)
    setpoint_filter, reason = _choose_filter(task, alone, allowed)
    axes = tuple(one.told(setpoint_filter) for one in alone)
    group = Group(
        task=task,
        control=control,
        axes=axes,
        setpoint_filter=setpoint_filter,
        filter_reason=reason,
        path=PathLimits(acceleration=inf, jerk=inf, accelerations=(inf, inf), jerks=(inf, inf)),
        reserve=reserve,
        encoder_noise=noise,
        entries=find_entries(_plane(task, axes)),
    )
    path = _lowered_for_lines(group, _lowered_for_circles(group, _path_of(group)))
    return _judge_again(replace(group, path=path))


def _stand_alone(machine: Machine, progress: Progress) -> GroupAxis:
    found = recommend(machine, progress=progress)
    return GroupAxis(found=found, choice=found.choice, follower=follow(machine, found.tuned))


def _match_gains(alone: list[GroupAxis], progress: Progress) -> list[GroupAxis]:
    """The axes with the position gain of the slowest, where they lag behind by 1/Kv at all."""
    controllers = [one.found.tuned.controller for one in alone]
    if all(one.follows or one.velocity_feedforward == 1.0 for one in controllers):
        return alone
    common = min(one.position_gain for one in controllers)
    matched = []
    for one, controller in zip(alone, controllers, strict=True):
        if controller.position_gain > common:
            control = replace(one.machine.control, position_gain=common)
            one = _stand_alone(replace(one.machine, control=control), progress)
        matched.append(one)
    return matched


def _wait_for_slowest(alone: Sequence[GroupAxis]) -> list[GroupAxis]:
    """The axes, each behind the time by which it would be sooner than the slowest."""
    latest = max(one.follower.delay for one in alone)
    return [
        replace(
            one,
            follower=replace(one.follower, wait=round(latest - one.follower.delay, TENTH)),
        )
        for one in alone
    ]


def _plane(task: Task, axes: Sequence[GroupAxis]) -> Pair:
    first, second = (axes[i].follower for i in task.plane)
    return first, second


def _behind(pair: Pair, item: SetpointFilter | None) -> Pair:
    first, second = (replace(axis, setpoint_filter=item) for axis in pair)
    return first, second


# The filter


def _choose_filter(
    task: Task, alone: Sequence[GroupAxis], allowed: float
) -> tuple[SetpointFilter | None, Message]:
    """The filter that is best for circles, then for moves, at a first look, and why that one."""
    trials, pair = [], _plane(task, alone)
    for item in _filters_to_try(task, alone, allowed):
        # No limits of an axis keep its bounds behind some filters.
        found = [look(one.behind(item)) for one in alone]
        ends = [
            each[0].duration + one.follower.poles.delay if each else inf
            for each, one in zip(found, alone, strict=True)
        ]
        largest = min(each[0].acceleration if each else 0.0 for each in found)
        trials.append(
            _Trial(
                filter=item,
                settling_time=max(ends),
                axes_acceleration=largest,
                path_acceleration=_first_look(task, _behind(pair, item), allowed, largest),
            )
        )
    most = max(trial.path_acceleration for trial in trials)

    def rank(trial: _Trial) -> tuple[bool, float]:
        return trial.path_acceleration < NEARLY * most, trial.settling_time

    best = min(trials, key=rank)
    leaves_all = best.path_acceleration >= ALL * best.axes_acceleration
    return best.filter, Message("group-filter-chosen" if leaves_all else "group-filter-binds")


def _filters_to_try(
    task: Task, alone: Sequence[GroupAxis], allowed: float
) -> list[SetpointFilter | None]:
    """The filter that a profile gives; else the axes' own ones, none, and shorter averages."""
    controls = [one.machine.control for one in alone]
    given = [one.setpoint_filter for one in controls if not one.seeks_setpoint_filter]
    if given:
        return given[:1]
    limits = [one.choice.limits for one in alone]
    found: list[SetpointFilter | None] = [*(one.setpoint_filter for one in limits), None]
    largest = min(one.acceleration for one in limits)
    cycle, pair = controls[0].position_cycle, _plane(task, alone)

    def kept(item: SetpointFilter | None) -> float:
        return _first_look(task, _behind(pair, item), allowed, largest)

    if choice := controls[0].kind.find_filter(MOVING_AVERAGE):
        unit, (least, most) = choice.unit(cycle), choice.times(cycle)
        lengths = np.arange(max(ceil(least / unit - 1e-9), 1), int(most / unit + 1e-9) + 1)
        enough = SHORT * kept(None)
        low, high = 0, len(lengths)
        while low < high:  # the longer, the less is kept
            middle = (low + high) // 2
            fits = kept(moving_average(float(lengths[middle] * unit))) >= enough
            low, high = (middle + 1, high) if fits else (low, middle)
        short = [moving_average(float(one * unit)) for one in lengths[:low]]
        found += short[-1:] + short[(len(short) - 1) // 2 :][:1]
    return list(dict.fromkeys(found))


# Path limits


def tell(control: Control, key: Key, needed: float, axes: Sequence[float]) -> float:
    """Return the limit that a control is told for the path, as typed; inf: it has no place for it.

    ``needed``: what lines and circles need at most, ``axes``: the same limit of each axis [SI].
    Where the control keeps the axes' own along the path, too, it is a ceiling.
    """
    if not control.place_of(key):
        return inf
    holds = key[1] in control.axes_hold
    limit = min(needed, UNBOUND * max(axes)) if holds else min(needed, *axes)
    return _typed(limit)


def _path_of(group: Group) -> PathLimits:
    """What the control keeps along the path where nothing asks for less than the axes."""
    limits = [axis.choice.limits for axis in group.axes]
    a, j = [one.acceleration for one in limits], [one.jerk for one in limits]
    first, second = group.task.plane
    jerkless = group.control.kind.jerk is Jerk.NONE
    return PathLimits(
        acceleration=tell(group.control, PATH_ACCELERATION, inf, a),
        jerk=inf if jerkless else tell(group.control, PATH_JERK, inf, j),
        accelerations=(a[first], a[second]),
        jerks=(j[first], j[second]),
    )


def _lowered_for_circles(group: Group, path: PathLimits) -> PathLimits:
    """Limits with which every circle keeps the tolerance.

    Where none does they stay, and the verdict says so.
    """
    largest, _ = path.on_circles
    kept = circle_acceleration(group.task, group.pair, group.entries, group.allowed, largest)
    if not 0.0 < kept < largest:
        return path
    if group.control.place_of(PATH_ACCELERATION):
        return replace(path, acceleration=_typed(kept))
    return _gentler(path, [min(kept / a, 1.0) for a in path.accelerations])


def _lowered_for_lines(group: Group, path: PathLimits) -> PathLimits:
    """Limits with which lines keep the tolerance, too: all of the path, or those of the axes.

    What unequal delays do at the feed no limit changes: where that is too much they stay.
    """
    feed, allowed, first_path = group.task.feed, group.allowed, path
    first, second = group.pair
    coasting = 0.5 * feed * float(np.abs(first.lag[:, None] - second.lag).max())
    for _ in range(ROUNDS if coasting < allowed else 0):
        off, _ = line_deviation(group.pair, feed=feed, limits=path)
        if off <= allowed:
            return path
        share = LOWER * (allowed - coasting) / (off - coasting)
        a = share * min(path.acceleration, hypot(*path.accelerations))
        j = share * min(path.jerk, hypot(*path.jerks))
        lowered = replace(
            path,
            acceleration=_typed(a) if isfinite(path.acceleration) else inf,
            jerk=_typed(j) if isfinite(path.jerk) else inf,
        )
        path = lowered if lowered != path else _gentler(path, [share, share])
    return first_path


def _gentler(path: PathLimits, shares: Sequence[float]) -> PathLimits:
    """The limits of the axes lowered, each with the time of its ramps."""
    limits = zip(path.accelerations, path.jerks, shares, strict=True)
    (a, j), (b, k) = ((_typed(share * a), _typed(share * j)) for a, j, share in limits)
    return replace(path, accelerations=(a, b), jerks=(j, k))


def _typed(limit: float) -> float:
    return float(round_number(limit, ROUND_FLOOR))


def _judge_again(group: Group) -> Group:
    """The group with each axis judged whose limits were lowered, or whose moves the path slows."""
    axes, path = [], group.path
    lowered = dict(
        zip(group.task.plane, zip(path.accelerations, path.jerks, strict=True), strict=True)
    )
    for i, axis in enumerate(group.axes):
        row, own = axis.behind(group.setpoint_filter), axis.choice.limits
        a, j = lowered.get(i, (own.acceleration, own.jerk))
        limits = replace(own, acceleration=a, jerk=j)
        if limits != own:
            candidate = judge(replace(row, limits=limits))
            choice = replace(axis.choice, candidate=candidate, why=BY_CONTOUR)
            axis = replace(axis, choice=choice)
        if (slower := path.within(limits)) != limits:
            axis = replace(axis, slowed=judge(replace(row, limits=slower)))
        axes.append(axis)
    return replace(group, axes=tuple(axes))


def _first_look(task: Task, pair: Pair, allowed: float, largest: float) -> float:
    return circle_acceleration(task, pair, entries_at_first_look(pair), allowed, largest)


def circle_deviation(pair: Pair, entries: Array, omega: Array) -> tuple[Array, Array]:
    """Return how far circles are off, once they last and when they are entered, of R = 1 [-]."""
    steady = worst_circle(pair, omega)[0].largest
    return steady, np.interp(np.log(omega), np.log(pair[0].omega), entries)


def largest_radii(omega: Array, *, feed: float, acceleration: float | Array) -> Array:
    """Return the radius of the largest circle of each angular velocity [m]; 0 where it is tiny.

    min(v/ω, a/ω²): not every control slows down on circles by the jerk v³/R².
    """
    radii = np.minimum(feed / omega, acceleration / omega**2)
    return np.asarray(np.where(radii >= LEAST_RADIUS, radii, 0.0))


def circle_acceleration(
    task: Task, pair: Pair, entries: Array, allowed: float, largest: float
) -> float:
    """Return the acceleration with which every circle up to the feed keeps the tolerance [m/s²].

    At most ``largest``; 0 where no circle keeps it. A radius that is asked for counts alone, at the
    feed.
    """
    if task.radius is not None:
        asked = np.array([task.feed / task.radius])
        is_kept = task.radius * np.max(circle_deviation(pair, entries, asked)) <= allowed
        return largest if is_kept else 0.0
    omega = pair[0].omega
    off = np.maximum(*circle_deviation(pair, entries, omega))
    radii = largest_radii(omega, feed=task.feed, acceleration=largest * LADDER[:, None])
    kept = np.flatnonzero((off * radii).max(axis=1) <= allowed)
    return float(largest * LADDER[kept[0]]) if len(kept) else 0.0
