"""The shortest motion whose every smaller move keeps all bounds, with each setpoint filter.

Where every move keeps the band after its setpoint has ended, each has settled as soon as that is
so: the settling time is the length of the setpoint and τ, known in closed form. What remains is the
largest acceleration that a filter and a jerk time allow. All bounds use a share a/t_j G, where G is
the worst over the sizes and does not fall as the acceleration falls (more of the smaller moves
reach it, for longer). So, begun from above, a by the share that it uses is no less than any allowed
acceleration: a few such steps end at the largest one. (Positioning to max_velocity bends that a
little, where the time to reach it happens to cancel a mode; what is found is allowed all the same.)
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import Jerk
from mtcommission.limits.every.families import Judged
from mtcommission.limits.every.filters import filters_to_try, neighbours
from mtcommission.limits.every.heard import Heard, hear, leading_rows, rows_left_vibrating
from mtcommission.limits.every.sizes import Sizes
from mtcommission.loop.batch.echoes import behind_filter, linear
from mtcommission.loop.simulation_budget import longest_affordable
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, Move, moving_mass
from mtcommission.machine.requirement import slow_to_feed
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import jerk_steps
from mtcommission.setpoint.smaller_moves import plan_sizes, size_of

Array = NDArray[np.float64]

JERK_TIMES = 14
"""Jerk times tried with each filter at first, logarithmic."""

LONGEST_JERK_TIME = 0.3
"""[s]; more only makes moves longer."""

LONGEST = 1.0
"""Of the motions that are looked at [s]; what is held for longer is as good as for ever."""

LEAST_SHARE = 1e-4
"""Least acceleration looked at, as a share of what the force allows [-]."""

EQUALLY_SOON = 1.005
"""Limits that settle within this factor of the soonest settle equally soon: then less jerk is
better (design choice: what half a per cent of time cannot buy, wear and noise pay for)."""

STEPS = 12
"""Towards the largest acceleration allowed, at most; each divides by the share that is used."""

NEARBY, NEAR_TIMES = 0.15, (0.3, 0.5, 0.75, 1.0, 1.4, 2.0)
"""How far a filter, and by what factors the jerk time, may lie from what is known of a loop much
like this one [-]."""

CLIMBED, CLIMB_STEPS = 3, 40
"""Best places from which larger accelerations are tried that the steps from above may have passed,
and how many of them, logarithmic: islands where the time to reach a velocity cancels a mode."""

REFINED = 3
"""Best places of the first look that are refined."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """Limits whose every smaller move keeps the bounds, as far as the echoes tell.

    Parameters
    ----------
    duration
        t_e of the slowest listed move, filter included [s].
    acceleration, jerk_time
        [m/s², s].
    setpoint_filter
        None: none.
    """

    duration: float
    acceleration: float
    jerk_time: float
    setpoint_filter: SetpointFilter | None


def search_every_size(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    *,
    largest_jerk: float = inf,
    near: MotionLimits | None = None,
) -> tuple[Found, ...]:
    """Return limits and filter with the shortest motion that keep all bounds at every size.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, whose requirements count as they stand, its plant and its loop.
    largest_jerk
        [m/s³].
    near
        What is known of a loop much like this one: then only its neighbourhood is looked at.

    Returns
    -------
    tuple of Found
        The best first: of those equally soon the one with the least jerk; then ever later ones.
        Empty where nothing keeps the bounds.
    """
    explorer = Explorer.about(machine, plant, tuned, largest_jerk=largest_jerk)
    dt, control = explorer.heard.dt, machine.control
    jerk_times = _jerk_times(machine, dt)
    if near is None:
        items = filters_to_try(control, tuned.loops[0])
    else:
        own = near.setpoint_filter
        items = [own, *neighbours(control, own, NEARBY)]
        if len(jerk_times) > 1:
            lags = np.unique(np.round(near.jerk_time / dt * np.array(NEAR_TIMES)))
            jerk_times = [float(lag) * dt for lag in lags if lag >= 1.0]
    places = [(item, t) for item in items for t in jerk_times]
    places.sort(key=lambda place: explorer.shortest(*place))
    for place in places:
        explorer.at(*place)
    if machine.control.kind.jerk is Jerk.NONE:
        for item in items:
            explorer.leap(item, jerk_times[0])
    by_filter: dict[SetpointFilter | None, Found] = {}
    for found in explorer.ranked()[1:]:
        by_filter.setdefault(found.setpoint_filter, found)
    for begin in list(by_filter.values())[:REFINED]:
        _refine(explorer, begin, machine, is_island=False)
    for begin in explorer.ranked()[:CLIMBED]:
        island = explorer.climb(begin)
        if island is not begin:
            _refine(explorer, island, machine, is_island=True)
    return explorer.ranked()


def _jerk_times(machine: Machine, dt: float) -> list[float]:
    """Jerk times to look at, whole samples long; the only one where there is no jerk limit."""
    if machine.control.kind.jerk is Jerk.NONE:
        return [without_jerk_limit(machine, 1.0).jerk_time]
    lags = np.geomspace(1.0, max(LONGEST_JERK_TIME / dt, 2.0), JERK_TIMES)
    return [float(lag) * dt for lag in np.unique(np.round(lags))]


def _refine(explorer: Explorer, begin: Found, machine: Machine, *, is_island: bool) -> None:
    """Look about a place, ever nearer, in the direction of either time."""
    dt, here = explorer.heard.dt, begin
    has_one = machine.control.kind.jerk is Jerk.NONE
    for reach in (0.16, 0.08, 0.04, 0.02, 0.01):
        while True:
            t = here.jerk_time
            step = max(round(reach * t / dt), 1) * dt
            around = [] if has_one else [t - step, t + step]
            places = [(here.setpoint_filter, time) for time in around if time >= dt]
            times = [t] if has_one else [t - step, t, t + step]
            places += [
                (item, time)
                for item in neighbours(machine.control, here.setpoint_filter, reach)
                for time in times
                if time >= dt
            ]
            each = (
                explorer.beside(*place, here) if is_island else explorer.at(*place)
                for place in places
            )
            found = [item for item in each if item is not None]
            best = min(found, key=lambda item: item.duration, default=here)
            if best.duration >= here.duration:
                break
            here = best


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explorer:
    """What was looked at so far: the largest acceleration at each filter and jerk time."""

    machine: Machine
    heard: Heard
    largest: float
    largest_jerk: float
    cases: dict[SetpointFilter | None, list[tuple[Sizes, tuple[Move, ...]]]] = field(
        default_factory=dict
    )
    known: dict[tuple[SetpointFilter | None, float], Found | None] = field(default_factory=dict)

    @classmethod
    def about(
        cls, machine: Machine, plant: Plant, tuned: TunedLoop, *, largest_jerk: float = inf
    ) -> Explorer:
        """Return one that has looked at nothing yet; parameters as ``search_every_size``."""
        return cls(
            machine=machine,
            heard=hear(machine, plant, tuned),
            largest=machine.drive.motion_force / moving_mass(machine),
            largest_jerk=largest_jerk,
        )

    def ranked(self) -> tuple[Found, ...]:
        """All that was found, the best first."""
        found = sorted(
            (item for item in self.known.values() if item is not None),
            key=lambda item: item.duration,
        )
        if not found:
            return ()
        latest = EQUALLY_SOON * (found[0].duration + self.heard.delay)
        near = [item for item in found if item.duration + self.heard.delay <= latest]
        best = min(near, key=lambda item: item.acceleration / item.jerk_time)
        return (best, *(item for item in found if item is not best))

    def shortest(self, item: SetpointFilter | None, jerk_time: float) -> float:
        """Length of the slowest listed move with all the acceleration that the force allows."""
        return float(self.durations(item, np.array([self.largest]), jerk_time)[0])

    def at(self, item: SetpointFilter | None, jerk_time: float) -> Found | None:
        """The largest acceleration there; None if that cannot be among the best."""
        key = (item, jerk_time)
        if key not in self.known:
            self.known[key] = self._find(item, jerk_time)
        return self.known[key]

    def climb(self, begin: Found) -> Found:
        """Look for a larger acceleration with the same filter and jerk time that is allowed."""
        largest = min(self.largest, self.largest_jerk * begin.jerk_time)
        least = CLIMBING * begin.acceleration
        if least >= largest:
            return begin
        steps = np.geomspace(largest, least, CLIMB_STEPS)
        return self._first_allowed(begin.setpoint_filter, begin.jerk_time, steps) or begin

    def leap(self, item: SetpointFilter | None, jerk_time: float) -> None:
        """Look for an acceleration that is sooner than all so far, from the largest downwards.

        The shorter the time to ``max_velocity``, the fewer steps of a mode it can add up.
        """
        least = self._least(item, jerk_time, self._soonest())
        if least < self.largest:
            self._first_allowed(item, jerk_time, np.geomspace(self.largest, least, LEAPS))

    def beside(self, item: SetpointFilter | None, jerk_time: float, island: Found) -> Found | None:
        """The largest acceleration there, or one near that of an island if it is larger."""
        found = self.at(item, jerk_time)
        steps = island.acceleration * np.array(NEAR_ISLAND)
        largest = min(self.largest, self.largest_jerk * jerk_time)
        steps = steps[(steps <= largest) & (steps > (found.acceleration if found else 0.0))]
        return self._first_allowed(item, jerk_time, steps) or found

    def _first_allowed(
        self, item: SetpointFilter | None, jerk_time: float, steps: Array
    ) -> Found | None:
        for a in steps.tolist():
            if self.share(item, a, jerk_time, enough=1.0) <= 1.0:
                found = self._found(item, a, jerk_time)
                self.known[item, jerk_time] = found
                return found
        return None

    def _found(self, item: SetpointFilter | None, a: float, jerk_time: float) -> Found:
        duration = float(self.durations(item, np.array([a]), jerk_time)[0])
        return Found(duration=duration, acceleration=a, jerk_time=jerk_time, setpoint_filter=item)

    def _soonest(self) -> float:
        """t_e of the best so far; before any is found, what can be judged at all [s]."""
        found = (f.duration for f in self.known.values() if f is not None)
        return min(found, default=longest_affordable(self.machine))

    def _find(self, item: SetpointFilter | None, jerk_time: float) -> Found | None:
        a = min(self.largest, self.largest_jerk * jerk_time)
        least = self._least(item, jerk_time, WORTHWHILE * self._soonest())
        if least > a or self.share(item, least, jerk_time, enough=HOPELESS) > HOPELESS:
            return None
        for _ in range(STEPS):
            share = self.share(item, a, jerk_time, enough=a / least)
            if share <= 1.0 + ROUNDING:
                return self._found(item, a, jerk_time)
            a /= share
            if a < least:
                return None
        return None

    def _least(self, item: SetpointFilter | None, jerk_time: float, longest: float) -> float:
        """The least acceleration with which the slowest listed move is no longer than that."""
        a = self.largest * np.geomspace(LEAST_SHARE, 1.0, LADDER)
        short = self.durations(item, a, jerk_time) <= longest
        return float(a[max(int(np.argmax(short)) - 1, 0)]) if short.any() else inf

    def durations(self, item: SetpointFilter | None, a: Array, jerk_time: float) -> Array:
        """Return t_e of the slowest listed move, shape (n_accelerations,) [s]."""
        each = [
            jerk_steps(move, acceleration=a, jerk=a / jerk_time).duration
            for move in self.machine.moves
        ]
        return np.asarray(np.max(each, axis=0) + (item.duration if item else 0.0))

    def share(
        self, item: SetpointFilter | None, a: float, jerk_time: float, *, enough: float
    ) -> float:
        """Return the largest share of any bound at any size, or one beyond ``enough`` [-]."""
        cases = self.cases.pop(item, None) or _cases(self.machine, self.heard, item)
        if self.cases:  # the filter that was looked at before may never be looked at again
            for sizes, _ in self.cases[next(reversed(self.cases))]:
                sizes.judged.forget_ramps()
        self.cases[item] = cases
        found = 0.0
        for sizes, moves in cases:
            for move in moves:
                found = max(found, sizes.worst(move, a, jerk_time, enough=enough))
                if found > enough:
                    return found
        return max(found, _rms_share(self.machine, item, a, jerk_time))


LEAPS = 24
"""Accelerations from the largest down, logarithmic, that the steps from above may have passed;
only where no jerk limit multiplies them."""

CLIMBING = 1.02
"""Least factor by which a larger acceleration is worth looking for [-]."""

NEAR_ISLAND = (1.03, 1.015, 1.0, 0.985, 0.97)
"""Accelerations tried beside an island, by its own [-]."""

LADDER = 128
"""Accelerations among which that is sought which is just worth while."""

HOPELESS = 1.05
"""Where an acceleration that is just worth while uses so much, no larger one is allowed, but where
the time to reach ``max_velocity`` cancels a mode."""

WORTHWHILE = 1.02
"""What takes longer than the best so far by this factor is not followed further."""

ROUNDING = 1e-6
"""Of a share that is just used up."""


def _cases(
    machine: Machine, heard: Heard, item: SetpointFilter | None
) -> list[tuple[Sizes, tuple[Move, ...]]]:
    """What is judged behind a filter, with the moves that it is judged for."""
    dt, moves, needs = heard.dt, machine.moves, machine.requirements
    wait = heard.wait + round((item.duration if item else 0.0) / dt)

    def sizes(answers: Array, wait: int) -> Sizes:
        judged = Judged(answers=answers, wait=wait, longest=round(LONGEST / dt))
        return Sizes(judged=judged, dt=dt, every=heard.between)

    residual = behind_filter(heard.residual, item, dt=dt)
    shaped = item is not None and not item.averages
    residual = rows_left_vibrating(residual, dt, wait) if shaped else leading_rows(residual, dt)
    moving = behind_filter(heard.moving, item, dt=dt, between=linear)  # forces jump
    cases = [(sizes(residual, wait), moves), (sizes(moving, -1), moves)]
    if len(heard.path):
        slow = tuple(slow_to_feed(move, needs.contour_feed) for move in moves)
        cases.append((sizes(behind_filter(heard.path, item, dt=dt), -1), slow))
    return cases


RMS_SIZES = (0.05, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Sizes of a move at which the RMS force is looked at, as shares of the listed one."""


def _rms_share(
    machine: Machine, item: SetpointFilter | None, acceleration: float, jerk_time: float
) -> float:
    """Share of the RMS force that the rigid axis uses at its worst size, heaviest payload [-]."""
    drive = machine.drive
    if not isfinite(drive.continuous_force):
        return 0.0
    mass, worst = moving_mass(machine) + max(machine.requirements.payload), 0.0
    limits = MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
    for move in machine.moves:
        steps = plan_sizes(move, size_of(move) * np.array(RMS_SIZES), limits)
        gaps = np.diff(steps.times, axis=1)
        a = np.cumsum(np.cumsum(steps.steps, axis=1)[:, :-1] * gaps, axis=1)
        a = np.column_stack([np.zeros(len(a)), a])
        square = (gaps * (a[:, :-1] ** 2 + a[:, :-1] * a[:, 1:] + a[:, 1:] ** 2)).sum(axis=1) / 3.0
        window = steps.duration + move.dwell + (item.duration if item else 0.0)
        worst = max(worst, float((square / window).max()))
    return float(np.hypot(mass * np.sqrt(worst), drive.static_load) / drive.continuous_force)
