"""From axes that were judged alone to what they are told together; read ``join`` first.

own loop and limits -> one position gain where lag counts -> one filter -> one delay
        -> path limits
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import MOVING_AVERAGE
from mtcommission.group.answers import AxisAnswers, line_deviation
from mtcommission.group.circle import (
    Deviation,
    ToolResponse,
    deviate,
    find_response,
    peak_bound,
)
from mtcommission.group.rules import CornerRule, rule_of
from mtcommission.group.task import Task
from mtcommission.limits.choose import Choice
from mtcommission.limits.explore import Found
from mtcommission.limits.typed import round_limits
from mtcommission.loop.disturbance import encoder_noise
from mtcommission.loop.poles import LoopPoles, find_poles
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter, moving_average
from mtcommission.messages.message import Message
from mtcommission.recommend import Progress, Recommendation, recommend
from mtcommission.study.variations import Row, choose, look

Array = NDArray[np.float64]

NEARLY = 0.8
"""Share of the largest path acceleration from which a filter is as good for circles as the best
(design choice) [-]."""

SHORT = 0.8
"""Of the path acceleration without a filter, what an average must leave to be tried; the longest of
these and one half as long are (design choice) [-]."""

LADDER = np.geomspace(1.0, 1e-3, 700)
"""Shares of the axes' acceleration at which circles are looked at, the largest first."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisAlone:
    """An axis before the group: its loop, its limits, and how it answers circles."""

    found: Recommendation
    poles: LoopPoles
    response: ToolResponse

    @property
    def machine(self) -> Machine:
        """The axis."""
        return self.found.machine

    @property
    def tuned(self) -> TunedLoop:
        """Its loop, in every corner."""
        return self.found.tuned


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plane:
    """The two axes that draw circles and corners, as the tool follows them."""

    responses: tuple[ToolResponse, ToolResponse]  # their waits included
    alone: tuple[AxisAlone, AxisAlone]

    def behind(self, item: SetpointFilter | None) -> tuple[AxisAnswers, AxisAnswers]:
        """Return the axes behind a filter."""
        first, second = (
            AxisAnswers(
                poles=one.poles, setpoint_filter=item, wait=round(response.wait / one.poles.dt)
            )
            for one, response in zip(self.alone, self.responses, strict=True)
        )
        return first, second


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterTrial:
    """A setpoint filter for all axes, and what it costs and gives, at a first look."""

    setpoint_filter: SetpointFilter | None
    settling_time: float  # of the slowest axis, without the wait of the others [s]; inf: none found
    axes_acceleration: float  # the smallest of the axes' limits [m/s²]
    acceleration: float  # along the path, with which every circle keeps the tolerance [m/s²]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GroupAxis:
    """What one axis is told in the group."""

    name: str
    alone: AxisAlone
    choice: Choice  # with the group's filter
    wait: int  # position cycles by which its setpoint is held back
    peak_bound: float  # no reversal throws the tool off further [m]

    @property
    def delay(self) -> float:
        """From setpoint to tool, the filter apart [s]."""
        return self.alone.response.delay + self.wait * self.alone.poles.dt


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Group:
    """Axes that move together: what they are told."""

    task: Task
    axes: tuple[GroupAxis, ...]
    setpoint_filter: SetpointFilter | None
    trials: tuple[FilterTrial, ...]  # that were compared, the one in use first
    acceleration: float  # along the path [m/s²]
    jerk: float  # [m/s³]
    reserve: float  # share of the tolerance that circles and corners may use [-]
    encoder_noise: float  # what the encoders of the plane add [m]
    entry: float  # deviation after a step of acceleration of 1 m/s², as circles begin with [s²]
    rule: CornerRule

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
    def plane(self) -> Plane:
        """How these follow circles, their waits included."""
        alone = [axis.alone for axis in self.axes]
        return _plane(self.task, alone, [axis.wait for axis in self.axes])

    @property
    def answers(self) -> tuple[AxisAnswers, AxisAnswers]:
        """The same behind the group's filter."""
        return self.plane.behind(self.setpoint_filter)


def join(task: Task, *, progress: Progress = lambda _: None) -> Group:
    """Return what axes are told together.

    Raises
    ------
    ComputationError
        A stage ended with a named outcome; the message tells the remedy.
    """
    alone = _match_gains([_stand_alone(machine, progress) for machine in task.machines], progress)
    progress(Message("stage-group"))
    waits, noise = _find_waits(alone), _encoder_noise(task, alone)
    reserve = min(machine.requirements.reserve.band for machine in task.machines)
    allowed = max(reserve * task.tolerance - noise, 0.0)
    plane = _plane(task, alone, waits)
    trials = _compare_filters(task, alone, plane, allowed)
    item = trials[0].setpoint_filter
    axes = tuple(
        GroupAxis(
            name=one.machine.axis,
            alone=one,
            choice=_with_filter(one, item),
            wait=wait,
            peak_bound=peak_bound(one.tuned.loops, one.machine.drive),
        )
        for one, wait in zip(alone, waits, strict=True)
    )
    largest = min(axis.choice.limits.acceleration for axis in axes)
    jerk = min(axis.choice.limits.jerk for axis in axes)
    # Where no circle keeps the tolerance the axes' own limits stand, and the verdict says so.
    acceleration = path_acceleration(task, plane, item, allowed, largest, jerk) or largest
    acceleration, jerk = _kept_on_lines(task, plane, item, allowed, acceleration, jerk)
    typed = round_limits(task.machines[0], acceleration, acceleration / jerk)
    return Group(
        task=task,
        axes=axes,
        setpoint_filter=item,
        trials=trials,
        acceleration=typed.acceleration,
        jerk=min(typed.jerk, jerk),
        reserve=reserve,
        encoder_noise=noise,
        entry=_entry(plane, item),
        rule=rule_of(task.machines[0].control.kind.key),
    )


def _stand_alone(machine: Machine, progress: Progress) -> AxisAlone:
    found = recommend(machine, progress=progress)
    poles = find_poles(found.tuned.loops)
    return AxisAlone(found=found, poles=poles, response=find_response(poles))


def _match_gains(alone: Sequence[AxisAlone], progress: Progress) -> list[AxisAlone]:
    """The axes with the position gain of the slowest, where they lag behind by 1/Kv at all."""
    controllers = [one.tuned.controller for one in alone]
    if all(one.follows or one.velocity_feedforward == 1.0 for one in controllers):
        return list(alone)
    common = min(one.position_gain for one in controllers)
    matched = []
    for one, controller in zip(alone, controllers, strict=True):
        if controller.position_gain > common:
            control = replace(one.machine.control, position_gain=common)
            one = _stand_alone(replace(one.machine, control=control), progress)
        matched.append(one)
    return matched


def _find_waits(alone: Sequence[AxisAlone]) -> list[int]:
    """Position cycles by which each axis waits for the slowest."""
    delays, cycle = [one.response.delay for one in alone], alone[0].poles.dt
    return [round((max(delays) - delay) / cycle) for delay in delays]


def _encoder_noise(task: Task, alone: Sequence[AxisAlone]) -> float:
    """What the steps of both encoders of the plane do to the contour at most [m]."""
    noise = 0.0
    for i in task.plane:
        resolution, loops = alone[i].machine.drive.encoder_resolution, alone[i].tuned.loops
        noise += max(encoder_noise(loop, resolution=resolution).tool for loop in loops)
    return noise


def _compare_filters(
    task: Task,
    alone: Sequence[AxisAlone],
    plane: Plane,
    allowed: float,
) -> tuple[FilterTrial, ...]:
    """Filters for all axes, at a first look, best first: for circles, then for moves."""
    trials = []
    for item in _filters_to_try(task, alone, plane, allowed):
        found = [_look(one, item) for one in alone]
        if not all(found):
            trials.append(
                FilterTrial(
                    setpoint_filter=item, settling_time=inf, axes_acceleration=0.0, acceleration=0.0
                )
            )
            continue
        best = [each[0] for each in found]
        largest = min(one.acceleration for one in best)
        jerk = min(one.acceleration / one.jerk_time for one in best)
        delays = [one.poles.delay for one in alone]
        trials.append(
            FilterTrial(
                setpoint_filter=item,
                settling_time=max(t.duration + d for t, d in zip(best, delays, strict=True)),
                axes_acceleration=largest,
                acceleration=path_acceleration(task, plane, item, allowed, largest, jerk),
            )
        )
    most = max(trial.acceleration for trial in trials)

    def rank(trial: FilterTrial) -> tuple[bool, float]:
        return trial.acceleration < NEARLY * most, trial.settling_time

    return tuple(sorted(trials, key=rank))


def _plane(task: Task, alone: Sequence[AxisAlone], waits: Sequence[int]) -> Plane:
    first, second = (alone[i] for i in task.plane)
    late = [waits[i] * alone[i].poles.dt for i in task.plane]
    return Plane(
        responses=(
            replace(first.response, wait=late[0]),
            replace(second.response, wait=late[1]),
        ),
        alone=(first, second),
    )


def _filters_to_try(
    task: Task,
    alone: Sequence[AxisAlone],
    plane: Plane,
    allowed: float,
) -> list[SetpointFilter | None]:
    """The filter that a profile gives; else the axes' own ones, none, and shorter averages."""
    controls = [one.machine.control for one in alone]
    given = [one.setpoint_filter for one in controls if not one.seeks_setpoint_filter]
    if given:
        return given[:1]
    own = [one.found.choice.limits.setpoint_filter for one in alone]
    found: list[SetpointFilter | None] = [*own, None]
    limits = [one.found.choice.limits for one in alone]
    largest, jerk = min(one.acceleration for one in limits), min(one.jerk for one in limits)
    choice = controls[0].kind.find_filter(MOVING_AVERAGE)
    if choice is not None:
        unit = choice.unit(controls[0].position_cycle)
        least, most = choice.times(controls[0].position_cycle)
        lengths = np.arange(max(ceil(least / unit - 1e-9), 1), int(most / unit + 1e-9) + 1)
        kept = SHORT * path_acceleration(task, plane, None, allowed, largest, jerk)
        short = [
            item
            for item in (moving_average(float(k * unit)) for k in lengths)
            if path_acceleration(task, plane, item, allowed, largest, jerk) >= kept
        ]
        found += short[-1:] + short[(len(short) - 1) // 2 :][:1]
    return list(dict.fromkeys(found))


def _behind(one: AxisAlone, item: SetpointFilter | None) -> Row:
    control = replace(one.machine.control, setpoint_filter=item, seeks_setpoint_filter=False)
    return Row(machine=replace(one.machine, control=control), tuned=one.tuned, refined=1)


def _look(one: AxisAlone, item: SetpointFilter | None) -> tuple[Found, ...]:
    """What the search sees of an axis behind a filter."""
    return look(_behind(one, item))


def _with_filter(one: AxisAlone, item: SetpointFilter | None) -> Choice:
    """The limits of an axis behind a filter."""
    own = one.found.choice
    return own if own.limits.setpoint_filter == item else choose(_behind(one, item))


def worst_deviation(
    responses: tuple[ToolResponse, ToolResponse], omega: Array, item: SetpointFilter | None
) -> tuple[Deviation, Array]:
    """Return the worst deviation of every pair of corners, and which pair it is, shape of omega."""
    first, second = (one.at(omega, item) for one in responses)
    every = deviate(first[:, None], second[None])
    flat = every.largest.reshape(-1, *omega.shape)
    worst = flat.argmax(axis=0)
    at = worst[None]
    return Deviation(
        radius=np.take_along_axis(every.radius.reshape(flat.shape), at, axis=0)[0],
        form=np.take_along_axis(every.form.reshape(flat.shape), at, axis=0)[0],
    ), worst


def _entry(plane: Plane, item: SetpointFilter | None) -> float:
    return max(axis.entry() for axis in plane.behind(item))


def path_acceleration(
    task: Task,
    plane: Plane,
    item: SetpointFilter | None,
    allowed: float,
    largest: float,
    jerk: float,
) -> float:
    """Return the acceleration with which every circle up to the feed keeps the tolerance [m/s²].

    The largest circle of an angular velocity ω that the limits permit has the radius
    min(v/ω, a/ω², j/ω³); its entry steps the acceleration by at most a. At most ``largest``; 0
    where no circle keeps it. A radius that is asked for counts alone, at the feed.
    """
    entry = _entry(plane, item)
    if task.radius is not None:
        omega = np.array([task.feed / task.radius])
        off = worst_deviation(plane.responses, omega, item)[0].largest[0] * task.radius
        off = max(off, entry * task.feed**2 / task.radius)
        return largest if off <= allowed else 0.0
    omega = plane.responses[0].omega
    off = worst_deviation(plane.responses, omega, item)[0].largest
    others = off * np.minimum(task.feed / omega, jerk / omega**3)
    a = largest * LADDER
    worst = np.minimum(others, off / omega**2 * a[:, None]).max(axis=1)
    kept = np.flatnonzero(np.maximum(worst, entry * a) <= allowed)
    return float(a[kept[0]]) if len(kept) else 0.0


ROUNDS = 6
"""Times that path limits are lowered for lines, at most."""


def _kept_on_lines(
    task: Task,
    plane: Plane,
    item: SetpointFilter | None,
    allowed: float,
    acceleration: float,
    jerk: float,
) -> tuple[float, float]:
    """Path limits with which lines keep the tolerance, too: both lowered by the same factor.

    What unequal delays do at the feed no limit changes: where that is too much they stay.
    """
    first, second = plane.behind(item)
    apart = float(np.abs(first.lag[:, None] - second.lag).max())
    coasting = 0.5 * task.feed * apart
    for _ in range(ROUNDS if coasting < allowed else 0):
        off = line_deviation(first, second, feed=task.feed, acceleration=acceleration, jerk=jerk)
        if off <= allowed:
            break
        share = 0.98 * (allowed - coasting) / (off - coasting)
        acceleration, jerk = share * acceleration, share * jerk
    return acceleration, jerk
