"""The shortest motion that keeps all bounds, over setpoint filters, jerk times and accelerations.

Where every move keeps the band after its setpoint has ended, each has settled as soon as that is
so: the settling time is t_e + τ, with t_e in closed form. What remains is the largest acceleration
that a filter and a jerk time allow. Sizes that do not reach ``max_velocity`` are judged for all
accelerations at once; what is dearer is looked at where the motion could still be the shortest.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import Jerk
from mtcommission.limits.bench import Bench
from mtcommission.limits.filters import filters_to_try, neighbours
from mtcommission.machine.machine import largest_acceleration
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit

Array = NDArray[np.float64]

JERK_TIMES = 13
"""Jerk times tried with each filter at first, logarithmic."""

SHORTEST, LONGEST = 1e-3, 3.0
"""Of them [s]; a longer one only makes moves longer."""

LEAST_SHARE, LADDER = 1e-5, 160
"""Least acceleration looked at, as a share of the largest, and rungs up to that."""

EQUALLY_SOON = 1.0015
"""Limits that settle within this factor of the soonest settle equally soon: then less jerk is
better (design choice: what a sixth of a per cent of time cannot buy, wear and noise pay for)."""

STEPS = 8
"""Towards the largest acceleration allowed, at most."""

FALLING = (1.0, 0.9975, 0.995, 0.99, 0.985, 0.98, 0.97, 0.96, 0.94, 0.92, 0.9)
"""Shares of an acceleration that are looked at together."""

WORTHWHILE = 1.05
"""What takes longer than the best so far by this factor is not followed further."""

NOTICEABLE = 0.9997
"""What is not shorter than the best so far by this factor is not worth the next step."""

CLOSE = 0.002
"""Share of a bound that may be left over [-]."""

FIRST = 3
"""Places with each filter that are settled at a first look."""

REFINED, REACHES = 4, (0.35, 0.16, 0.08, 0.04, 0.02, 0.01)
"""Best places, of different filters, that are refined, and how far about them [-]."""

NEARBY, NEAR_TIMES = 0.15, (0.3, 0.5, 0.75, 1.0, 1.4, 2.0)
"""How far a filter, and by what factors the jerk time, may lie from what is known of a loop much
like this one [-]."""

Place = tuple[SetpointFilter | None, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """Limits whose every size keeps the bounds, as far as the bench tells."""

    duration: float  # t_e of the slowest listed move, filter included [s]
    acceleration: float  # [m/s²]
    jerk_time: float  # [s]
    setpoint_filter: SetpointFilter | None


def explore(
    bench: Bench,
    *,
    largest_jerk: float = inf,
    near: MotionLimits | None = None,
    refined: int = REFINED,
) -> tuple[Found, ...]:
    """Return limits and filter with the shortest motion that keep all bounds, the best first.

    Of those equally soon the one with the least jerk; then ever later ones. ``near``: what is known
    of a loop much like this one; then only its neighbourhood is looked at. ``refined``: how many
    places are; 0 for a first look. Empty where nothing keeps the bounds.
    """
    explorer = Explorer.about(bench, largest_jerk=largest_jerk)
    control, machine = bench.machine.control, bench.machine
    is_free = control.kind.jerk is not Jerk.NONE
    jerk_times = [without_jerk_limit(machine, 1.0).jerk_time]
    if near is None:
        items = filters_to_try(control, bench.poles.loops[0])
        if is_free:
            jerk_times = np.geomspace(SHORTEST, LONGEST, JERK_TIMES).tolist()
    else:
        own = near.setpoint_filter
        items = list(dict.fromkeys([own, *neighbours(control, own, NEARBY)]))
        if is_free:
            jerk_times = [near.jerk_time * factor for factor in NEAR_TIMES]
    begins = [found for item in items if (found := explorer.first_look(item, jerk_times))]
    for begin in sorted(begins, key=lambda item: item.duration)[:refined]:
        if begin.duration <= WORTHWHILE * explorer.soonest():
            explorer.refine(begin, is_free=is_free)
    return explorer.ranked()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explorer:
    """What was looked at so far: the largest acceleration at each filter and jerk time."""

    bench: Bench
    ladder: Array  # accelerations [m/s²]
    largest_jerk: float
    known: dict[Place, Found | None] = field(default_factory=dict)

    @classmethod
    def about(cls, bench: Bench, *, largest_jerk: float = inf) -> Explorer:
        """Return one that has looked at nothing yet."""
        ladder = largest_acceleration(bench.machine) * np.geomspace(LEAST_SHARE, 1.0, LADDER)
        return cls(bench=bench, ladder=ladder, largest_jerk=largest_jerk)

    def ranked(self) -> tuple[Found, ...]:
        """All that was found, the best first."""
        found = sorted(
            (item for item in self.known.values() if item is not None),
            key=lambda item: item.duration,
        )
        if not found:
            return ()
        latest = EQUALLY_SOON * (found[0].duration + self.bench.delay)
        near = [item for item in found if item.duration + self.bench.delay <= latest]
        best = min(near, key=lambda item: item.acceleration / item.jerk_time)
        return (best, *(item for item in found if item is not best))

    def first_look(self, item: SetpointFilter | None, jerk_times: list[float]) -> Found | None:
        """Look at the jerk times that may be soon enough, and find the best with a filter."""
        latest = WORTHWHILE * self.soonest()
        places = [(item, t) for t in jerk_times if self._shortest(item, t) <= latest]
        return self.look_at(places, latest=latest, most=FIRST)

    def look_at(self, places: list[Place], *, latest: float, most: int) -> Found | None:
        """Find the largest accelerations at some places, those first that promise most.

        The best of them, where one is no later than ``latest``; at most so many are settled.
        """
        new = [place for place in dict.fromkeys(places) if place not in self.known]
        hopes = [(hope, place) for place in new if (hope := self._hope(*place, latest))]
        best: Found | None = None
        for (duration, a), place in sorted(hopes, key=lambda pair: pair[0][0])[:most]:
            if duration > latest:
                break
            found = self.known[place] = self._settle(*place, a, latest)
            if found is not None and (best is None or found.duration < best.duration):
                best, latest = found, min(latest, found.duration)
        return best

    def refine(self, begin: Found, *, is_free: bool) -> None:
        """Look about a place, ever nearer, in the direction of either time."""
        here, control = begin, self.bench.machine.control
        for reach in REACHES:
            while True:
                t = here.jerk_time
                around = [t * (1.0 - reach), t * (1.0 + reach)] if is_free else []
                around = [time for time in around if time >= SHORTEST]
                items = neighbours(control, here.setpoint_filter, reach)
                places = [(here.setpoint_filter, time) for time in around]
                places += [(item, time) for item in items for time in (t, *around)]
                latest = NOTICEABLE * here.duration
                found = self.look_at(places, latest=latest, most=len(places))
                if found is None:
                    break
                here = found

    def soonest(self) -> float:
        """Duration of the best so far [s]; inf where nothing was found."""
        return min((f.duration for f in self.known.values() if f is not None), default=inf)

    def _shortest(self, item: SetpointFilter | None, t_j: float) -> float:
        """Duration with all the acceleration that is looked at and the largest jerk allows."""
        a = min(float(self.ladder[-1]), self.largest_jerk * t_j)
        return float(self.bench.durations(item, np.array([a]), t_j)[0])

    def _hope(
        self, item: SetpointFilter | None, t_j: float, latest: float
    ) -> tuple[float, float] | None:
        """The least duration that quick looks leave possible, and its acceleration."""
        a = self.ladder[self.ladder <= self.largest_jerk * t_j]
        a = a[self.bench.durations(item, a, t_j) <= latest]
        if not len(a):
            return None
        used = self.bench.use(item, t_j).of_after(a)
        # The share rises between two rungs; where only the lower one is allowed, between them.
        allowed = used <= 1.0
        if not allowed.any():
            return None
        last = int(np.flatnonzero(allowed)[-1])
        found = a[last : last + 1]
        if last < len(a) - 1:
            low, high = np.log(max(used[last], 1e-12)), np.log(used[last + 1])
            found = found * (a[last + 1] / a[last]) ** (-low / (high - low))
        return float(self.bench.durations(item, found, t_j)[0]), float(found[0])

    def _settle(
        self, item: SetpointFilter | None, t_j: float, a: float, latest: float
    ) -> Found | None:
        """The largest acceleration up to some that keeps everything, where that is soon enough."""
        use, bench = self.bench.use(item, t_j), self.bench
        best: Found | None = None
        low, high = (0.0, 0.0), (inf, inf)  # accelerations kept and not, and what they use
        for _ in range(STEPS):
            # The time to max_velocity may cancel a mode: what is allowed has gaps.
            steps = a * np.array(FALLING)
            steps = steps[(bench.durations(item, steps, t_j) <= latest) & (steps > low[0])]
            if not len(steps):
                break
            for part in (steps[:1], steps[1:]) if len(steps) > 1 else (steps,):
                share = np.maximum(use.of_cruise(part), use.of_after(part))
                kept = part[share <= 1.0 + CLOSE]
                if len(kept):
                    break
            if not len(kept):
                if best:
                    break
                a = FALLING[-1] * a / max(float(share.min(initial=2.0)), 1.0)
                continue
            a = float(kept[0])
            rest = max(use.of_rest(a), CLOSE)
            if rest <= 1.0 + CLOSE:
                duration, low = float(bench.durations(item, np.array([a]), t_j)[0]), (a, rest)
                best = Found(duration=duration, acceleration=a, jerk_time=t_j, setpoint_filter=item)
                if rest >= 1.0 - CLOSE or high[0] == inf:
                    break
            else:
                high = a, rest
            if best is None:
                a /= rest
                continue
            # Peaks need not be in proportion to the acceleration: between the two.
            if high[0] < (1.0 + CLOSE) * low[0]:
                break
            place = -np.log(low[1]) / np.log(high[1] / low[1])
            a = low[0] * (high[0] / low[0]) ** float(np.clip(place, 0.1, 0.9))
        return best
