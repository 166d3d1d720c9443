"""The shortest motion that keeps all bounds, over setpoint filters, jerk times and accelerations.

Where every move keeps the band after its setpoint has ended, each has settled as soon as that is
so: the settling time is t_e + τ, with t_e in closed form. What remains is the largest acceleration
that a filter and a jerk time allow. Sizes that do not reach ``max_velocity`` are judged for all
accelerations at once; what is dearer is looked at where the motion could still be the shortest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from heapq import heapify, heappop, heappush
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.controls.kind import Jerk
from mtcommission.limits.bench import Bench, Use
from mtcommission.limits.filters import filters_to_try, jerk_times_to_try, neighbours
from mtcommission.machine.machine import largest_acceleration
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit

Array = NDArray[np.float64]

SHORTEST, LONGEST = 1e-3, 3.0
"""Of them [s]; a longer one only makes moves longer."""

LEAST_SHARE, LADDER = 1e-5, 160
"""Least acceleration looked at, as a share of the largest, and rungs up to that (empirical)."""

FINER, SMOOTH = np.linspace(0.0, 1.0, 9), 1.2
"""Shares of the way to the next rung at which it is looked closer, and by what factor more may be
used there without (empirical)."""

EQUALLY_SOON = 1.0015
"""Limits that settle within this factor of the soonest settle equally soon: then less jerk is
better (design choice: what a sixth of a per cent of time cannot buy, wear and noise pay for)."""

AS_SOON = 1.006
"""Quick looks within this factor of the soonest may be the soonest, judged exactly (empirical)."""

ROUGH = 2
"""Places that are settled where a loop is only looked at (empirical)."""

STEPS = 4
"""Towards the largest acceleration allowed, at most (empirical)."""

FALLING = (1.0, 0.9975, 0.995, 0.99, 0.985, 0.98, 0.97, 0.96, 0.94, 0.92, 0.9)
"""Shares of an acceleration that are looked at together (empirical)."""

WORTHWHILE = 1.1
"""What takes longer than the best so far by this factor is not followed further (empirical: so much
sooner the bottom of a valley lies than where it is met first)."""

NOTICEABLE = 0.9997
"""What is not shorter than the best so far by this factor is not worth a step (empirical)."""

LEAST_GROWTH = 0.2
"""Power of the acceleration with which what is used grows, at least [-] (empirical)."""

WHOLE = 1.0 - 1e-9
"""Share of a ramp that is the whole, but for rounding [-]."""

CLOSE, NEARLY = 0.002, 0.01
"""Share of a bound that may be left over, and by which limits are scaled without a look [-]
(empirical)."""

REFINED, REACHES = 4, (0.1, 0.06, 0.02, 0.01, 0.003)
"""Best places, no two in one valley, that are refined, and how far about them [-] (empirical)."""

FOR_SHAPERS = 0.005
"""Nearer than that only another frequency makes a difference [-] (empirical)."""

NEAR_REACHES = (0.25, 0.1, 0.03)
"""The same where one begins at what is known of a loop much like this one [-] (empirical)."""

NEARBY, NEAR_TIMES = 0.15, (0.3, 0.5, 0.75, 1.0, 1.4, 2.0)
"""How far a filter, and by what factors the jerk time, may lie from what is known of a loop much
like this one [-] (empirical)."""

Place = tuple[SetpointFilter | None, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """Limits whose every size keeps the bounds, as far as the bench tells."""

    duration: float  # t_e of the slowest listed move, filter included [s]
    acceleration: float  # [m/s²]
    jerk_time: float  # [s]
    setpoint_filter: SetpointFilter | None


def growth(
    before: tuple[Array | float, Array | float], now: tuple[Array | float, Array | float]
) -> Array:
    """Return the power of the acceleration with which what is used grows, between two of both."""
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = np.log(np.divide(before[1], now[1])) / np.log(np.divide(before[0], now[0]))
    return np.clip(grown, LEAST_GROWTH, 1.0)


def explore(
    bench: Bench,
    *,
    largest_jerk: float = inf,
    near: MotionLimits | None = None,
    beside: Sequence[SetpointFilter | None] = (),
    refined: int = REFINED,
    latest: float = inf,
) -> tuple[Found, ...]:
    """Return limits with the shortest motion that keep all bounds, behind each filter, best first.

    Of those equally soon the one with the least jerk. ``near``: what is known of a loop much like
    this one; then only its neighbourhood is looked at, and ``beside`` its filter others.
    ``refined``: how many places are; 0 for a first look. ``latest``: duration beyond which nothing
    is wanted [s]. Empty where nothing keeps the bounds.
    """
    machine, control = bench.machine, bench.machine.control
    ladder = largest_acceleration(machine) * np.geomspace(LEAST_SHARE, 1.0, LADDER)
    explorer = _Explorer(
        bench=bench, ladder=ladder, largest_jerk=largest_jerk, is_rough=not refined
    )
    is_free = control.kind.jerk is not Jerk.NONE
    jerk_times = [without_jerk_limit(machine, 1.0).jerk_time]
    if near is None:
        items = filters_to_try(control, bench.poles.loops[0])
        if is_free:
            jerk_times = jerk_times_to_try(bench.poles.loops[0], SHORTEST, LONGEST, len(items))
    else:
        # A first look goes no further: it looks at other filters at once.
        own = near.setpoint_filter
        about = [] if refined else neighbours(control, own, NEARBY)
        items = list(dict.fromkeys([own, *about, *beside]))
        if is_free:
            times = [max(near.jerk_time * factor, SHORTEST) for factor in NEAR_TIMES]
            jerk_times = list(dict.fromkeys(times))
    worthwhile = WORTHWHILE if refined else 1.0
    places = [(item, t) for item in items for t in jerk_times]
    begins = explorer.first_look(places, worthwhile * latest)
    # One after the other: what was refined before decides what is worth it.
    queue = [(explorer.promise(place), k) for k, place in enumerate(begins)]
    heapify(queue)
    begun = list[Found]()
    while queue and len(begun) < refined:
        promised, k = heappop(queue)
        soon = worthwhile * min(explorer.soonest(), latest)
        if promised > soon or promised == inf:
            break
        begin = explorer.known.get(begins[k])
        if begin is None:
            if explorer.look_at([begins[k]], latest=soon):
                heappush(queue, (explorer.promise(begins[k]), k))
        elif not any(_is_beside(begin, other) for other in begun):
            explorer.refine(begin, REACHES if near is None else NEAR_REACHES, is_free=is_free)
            begun.append(begin)
    return explorer.ranked()


def _is_beside(one: Found, other: Found) -> bool:
    """Whether two places lie in one valley: the first steps from either lead past the other."""
    a, b = one.setpoint_filter, other.setpoint_filter
    if a is None or b is None or a.frequency_hz or a.kind != b.kind:  # shapers' are narrow
        return False
    pairs = [(one.jerk_time, other.jerk_time), (a.time, b.time), (a.second_time, b.second_time)]
    return all(abs(x - y) <= 2.0 * REACHES[0] * max(x, y) for x, y in pairs)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Explorer:
    """What was looked at so far: the largest acceleration at each filter and jerk time."""

    bench: Bench
    ladder: Array  # accelerations [m/s²]
    largest_jerk: float
    is_rough: bool  # what is above a bound is taken in proportion
    known: dict[Place, Found | None] = field(default_factory=dict)
    hoped: dict[Place, Found] = field(default_factory=dict)  # by quick looks
    followed: set[Place] = field(default_factory=set)  # whose rise was followed
    rests: dict[SetpointFilter | None, dict[float, float]] = field(default_factory=dict)
    """Use of force and peaks per acceleration, behind each filter, by the jerk time [s²/m]."""

    def ranked(self) -> tuple[Found, ...]:
        """The best with each filter, the soonest first; of those equally soon the least jerk.

        What was settled, and what quick looks leave that is as soon but for their error.
        """
        found, soonest = [item for item in self.known.values() if item is not None], self.soonest()
        for place in self.hoped.keys() - self.known.keys():
            hope = self._capped(place)
            if soonest <= hope.duration <= AS_SOON * soonest:
                found.append(self._as_reached(place, hope.acceleration))
        best, behind = list[Found](), dict[SetpointFilter | None, list[Found]]()
        delay = self.bench.poles.delay
        for item in found:
            behind.setdefault(item.setpoint_filter, []).append(item)
        for of_filter in behind.values():
            soonest = min(item.duration for item in of_filter)
            late = EQUALLY_SOON * (soonest + delay) - delay
            near = [item for item in of_filter if item.duration <= late]
            best.append(min(near, key=lambda item: item.acceleration / item.jerk_time))
        return tuple(sorted(best, key=lambda item: item.duration))

    def first_look(self, places: list[Place], latest: float) -> list[Place]:
        """Find the best of some places; the most promising with each filter, the best first.

        Where there is but one, all of them: then nothing but the ramp tells them apart.
        """
        hopes = self._hopes(places, latest)
        self._settle_first(hopes[:ROUGH] if self.is_rough else hopes, latest)
        ranked = sorted(hopes, key=self.promise)
        first: dict[SetpointFilter | None, Place] = {}
        for place in ranked:
            first.setdefault(place[0], place)
        return list(first.values()) if len(first) > 1 else ranked

    def promise(self, place: Place) -> float:
        """Duration of what was settled there, inf where nothing was; of what is hoped else [s]."""
        if place not in self.known:
            return self._capped(place).duration
        found = self.known[place]
        return found.duration if found else inf

    def look_at(self, places: list[Place], *, latest: float) -> Found | None:
        """Find the best of some places; None where none is as soon as asked for."""
        known = [found for place in places if (found := self.known.get(place))]
        best = min(known, key=lambda item: item.duration, default=None)
        if best is not None and best.duration <= latest:
            return best
        return self._settle_first(self._hopes(places, latest), latest)

    def _hopes(self, places: list[Place], latest: float) -> list[Place]:
        """Places not settled yet where quick looks leave that possible, the soonest first."""
        new: dict[SetpointFilter | None, dict[float, None]] = {}
        for item, t in places:
            if (item, t) not in self.known and (item, t) not in self.hoped:
                new.setdefault(item, {})[t] = None
        for item, times in new.items():
            self._hope(item, np.array(list(times)), latest)
        open_ = {p: self.hoped[p].duration for p in places if p in self.hoped}
        soon = [p for p, time in open_.items() if time <= latest and p not in self.known]
        return sorted(soon, key=open_.__getitem__)

    def _settle_first(self, places: list[Place], latest: float) -> Found | None:
        """The best of some places: no other hope is as soon."""
        best: Found | None = None
        queue = [(self.hoped[place].duration, i) for i, place in enumerate(places)]
        heapify(queue)
        while queue and queue[0][0] <= latest:
            time, i = heappop(queue)
            place = places[i]
            hope = self._capped(place)
            if hope.duration <= time and place not in self.followed:
                self._follow_rises(place[0], latest)
                hope = self._capped(place)
            if hope.duration > time:
                heappush(queue, (hope.duration, i))
                continue
            found = self.known[place] = self._settle(*place, hope.acceleration, latest)
            if found is not None and found.duration <= latest:
                best, latest = found, found.duration
        return best

    def refine(self, begin: Found, reaches: Sequence[float], *, is_free: bool) -> None:
        """Look about a place, ever nearer, in the direction of either time."""
        here, control = begin, self.bench.machine.control
        for reach in reaches:
            item = here.setpoint_filter
            if reach < FOR_SHAPERS and not (item and item.frequency_hz):
                continue
            while True:
                t, shifts = here.jerk_time, [reach * here.jerk_time]
                if reach == reaches[0] and control.position_cycle > shifts[0]:
                    # Nearer by than a cycle a ramp may stay where the phases just favour it.
                    shifts.append(control.position_cycle)
                around = [t + sign * x for x in shifts for sign in (-1.0, 1.0)] if is_free else []
                around = [time for time in around if time >= SHORTEST]
                items = neighbours(control, here.setpoint_filter, reach)
                places = [(here.setpoint_filter, time) for time in around]
                places += [(item, time) for item in items for time in (t, *around)]
                latest = NOTICEABLE * here.duration
                found = self.look_at(places, latest=latest)
                if found is None:
                    break
                here = found

    def soonest(self) -> float:
        """Duration of the best so far [s]; inf where nothing was found."""
        return min((f.duration for f in self.known.values() if f is not None), default=inf)

    def _hope(self, item: SetpointFilter | None, times: Array, latest: float) -> None:
        """Note what quick looks leave possible at some jerk times, where that is soon enough."""
        use, a = self.bench.use(item), np.tile(self.ladder, (len(times), 1))
        for _ in (0, 1):  # what is allowed may end with a jump between two rungs
            t_j = np.broadcast_to(times[:, None], a.shape)
            possible, used = a <= self.largest_jerk * t_j, np.full(a.shape, inf)
            ends = np.full(a.shape, inf)
            ends[possible] = self.bench.durations(item, a[possible], t_j[possible])
            is_soon = ends <= latest
            is_soon[:, :-1] |= is_soon[:, 1:]  # between two rungs it may be
            possible &= is_soon
            if possible.any():
                used[possible] = use.of_after(a[possible], t_j[possible])
            is_any = (used <= 1.0).any(axis=1)
            if not is_any.any():
                return
            a, used, possible, times = a[is_any], used[is_any], possible[is_any], times[is_any]
            row = np.arange(len(a))
            last = a.shape[1] - 1 - np.argmax((used <= 1.0)[:, ::-1], axis=1)
            above = np.minimum(last + 1, a.shape[1] - 1)
            found, following = a[row, last], a[row, above]
            if np.all(used[row, above] <= SMOOTH * used[row, last]):
                break
            a = found[:, None] * (following / found)[:, None] ** FINER
        is_between = possible[row, above] & (above > last)
        low = np.log(np.maximum(used[row, last], 1e-12))
        high = np.log(np.where(is_between, used[row, above], inf))
        found = found * (following / found) ** (-low / (high - low))
        most = self._within_means(use, found, times)
        durations = self.bench.durations(item, most, times)
        # A ramp that no move needs whole makes the same motions as the next longer one.
        is_whole = self.bench.ramps_reached(most, times) >= WHOLE * times
        longest = times[~is_whole].min(initial=inf)
        is_soon = (durations <= latest) & (is_whole | (times <= longest))
        for k in np.flatnonzero(is_soon):
            t = float(times[k])
            self.hoped[item, t] = Found(
                duration=float(durations[k]),
                acceleration=float(most[k]),
                jerk_time=t,
                setpoint_filter=item,
            )

    def _as_reached(self, place: Place, a: float) -> Found:
        """The same motions by the acceleration that the listed moves reach, and its jerk time.

        More of it changes nothing, so that how much more would be up to the last digit of a sum.
        """
        (item, t_j), duration = place, self._duration(place, a)
        if self.bench.machine.control.kind.jerk is not Jerk.NONE:  # where the ramp follows from a
            reached = float(self.bench.ramps_reached(np.array([a]), t_j)[0])
            a, t_j = a * reached / t_j, reached
        return Found(duration=duration, acceleration=a, jerk_time=t_j, setpoint_filter=item)

    def _duration(self, place: Place, a: float) -> float:
        return float(self.bench.durations(place[0], np.array([a]), place[1])[0])

    def _within_means(self, use: Use, a: Array, t_j: Array) -> Array:
        """The largest accelerations up to some that keep what is a mean over the move."""
        share, grows = use.of_means(a, t_j), np.ones_like(a)
        for _ in range(STEPS):
            over = share > 1.0 + CLOSE
            if not over.any():
                break
            less = np.where(over, a * (1.0 - 0.5 * CLOSE) * share ** (-1.0 / grows), a)
            after = use.of_means(less, t_j)
            # A static load, or a longer move, leaves another power than the first.
            grows = np.where(over, growth((a, share), (less, after)), grows)
            a, share = less, after
        return a

    def _rest(self, use: Use, a: float, t_j: float, latest: float) -> float:
        """Share of force and peaks, as far as less of it may be kept, and soon enough."""

        def is_enough(used: float) -> bool:
            is_over = used > 1.0 + NEARLY and not self.is_rough
            return is_over or (used > 1.0 and self._duration((use.item, t_j), a / used) > latest)

        used = max(use.of_rest(a, t_j, is_enough=is_enough), CLOSE)
        own = self.rests.setdefault(use.item, {})
        own[t_j] = max(own.get(t_j, 0.0), used / a)
        return used

    def _follow_rises(self, item: SetpointFilter | None, latest: float) -> None:
        """Note what the rise of the acceleration asks for, wherever a filter may be soon enough.

        With less acceleration it lasts longer, and asks for no less in proportion: as often as that
        tells more.
        """
        use = self.bench.use(item)
        hopes = [self._capped(p) for p in self.hoped if p[0] == item and p not in self.followed]
        hopes = [hope for hope in hopes if hope.duration <= latest]
        a = np.array([hope.acceleration for hope in hopes])
        t_j, own = np.array([hope.jerk_time for hope in hopes]), self.rests.setdefault(item, {})
        used, more = np.zeros_like(a), np.arange(len(a))
        while len(more):
            used[more] = np.maximum(use.of_rise(a[more], t_j[more]), CLOSE) / a[more]
            less = np.minimum(a, 1.0 / used)
            is_less = less < (1.0 - NEARLY) * a
            more = np.flatnonzero(is_less & (self.bench.durations(item, less, t_j) <= latest))
            a = less
        for t, each in zip(t_j.tolist(), used.tolist(), strict=True):
            own[t] = max(own.get(t, 0.0), each)
            self.followed.add((item, t))

    def _capped(self, place: Place) -> Found:
        """What was hoped for, with the force that it asks for: longer ramps ask for less."""
        (item, t_j), hope = place, self.hoped[place]
        used = [each for t, each in self.rests.get(item, {}).items() if t >= t_j]
        a = min(hope.acceleration, 1.0 / max(used) if used else inf)
        if a == hope.acceleration:
            return hope
        return replace(hope, acceleration=a, duration=self._duration(place, a))

    def _settle(
        self, item: SetpointFilter | None, t_j: float, a: float, latest: float
    ) -> Found | None:
        """The largest acceleration up to some that keeps everything, where that is soon enough."""
        use, bench = self.bench.use(item), self.bench
        best: Found | None = None
        low, high = (0.0, 0.0), (inf, inf)  # accelerations kept and not, and what they use
        grows = 1.0  # power of the acceleration with which that grows
        for _ in range(STEPS):
            # The time to max_velocity may cancel a mode: what is allowed has gaps.
            steps = a * np.array(FALLING)
            steps = steps[steps > max(low[0], self.ladder[0])]
            steps = steps[bench.durations(item, steps, t_j) <= latest] if len(steps) else steps
            if not len(steps):
                break
            for part in (steps[:1], steps[1:]) if len(steps) > 1 else (steps,):
                share = np.maximum(use.of_cruise(part, t_j), use.of_after(part, t_j))
                kept = part[share <= 1.0 + CLOSE]
                if len(kept):
                    break
            if not len(kept):
                if best:
                    break
                a = FALLING[-1] * a / max(float(share.min(initial=2.0)), 1.0)
                continue
            a = float(kept[0])
            rest = self._rest(use, a, t_j, inf if best else latest)
            if best is None and self._duration((item, t_j), a / max(rest, 1.0)) > latest:
                break
            if self.is_rough or 1.0 < rest <= 1.0 + NEARLY:  # near enough to be in proportion
                a, rest = a / max(rest, 1.0), min(rest, 1.0)
            if rest <= 1.0 + CLOSE:
                best, low = self._as_reached((item, t_j), a), (a, rest)
                if rest >= 1.0 - NEARLY or high[0] == inf:
                    break
            else:
                before, high = high, (a, rest)
                if best is None:
                    # What does not reach its acceleration uses less than in proportion to it.
                    if before[0] < inf:
                        grows = float(growth(before, high))
                    a *= rest ** (-1.0 / grows)
                    continue
            # Peaks need not be in proportion to the acceleration: between the two.
            if high[0] < (1.0 + CLOSE) * low[0]:
                break
            place = -np.log(low[1]) / np.log(high[1] / low[1])
            a = low[0] * (high[0] / low[0]) ** float(np.clip(place, 0.1, 0.9))
        return best
