"""The worst use of one bound over all sizes of a move, for any acceleration and jerk time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from math import inf, sqrt

import numpy as np

from mtcommission.limits.every.families import Judged
from mtcommission.loop.batch.echoes import less_delayed
from mtcommission.machine.machine import Move, Positioning, VelocityStep
from mtcommission.setpoint.setpoint import jerk_steps

FOR_EVER = 1e3
"""Longest time that is counted in samples [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sizes:
    """One set of bounded echoes, with what was computed of them.

    Parameters
    ----------
    judged
        The echoes.
    dt
        Spacing of the samples [s].
    every
        Samples between ramps that are looked at: the use of a bound is smooth between them, and
        what is chosen is judged again.
    rising
        The worst of ramps up to each on a grid, as far as it was asked for, by family.
    known
        Families seen so far, by name and lags.
    """

    judged: Judged
    dt: float
    every: int
    rising: dict[str, list[float]] = field(default_factory=dict)
    known: dict[tuple[str, int, int], float] = field(default_factory=dict)

    def worst(
        self, move: Move, acceleration: float, jerk_time: float, *, enough: float = inf
    ) -> float:
        """Return the largest share of the bounds that any smaller move uses.

        Parameters
        ----------
        move
            The listed one, the largest of its kind.
        acceleration, jerk_time
            Limits [m/s², s].
        enough
            Beyond this share no more is looked at [-].

        Returns
        -------
        float
            At least the worst share where it is below ``enough`` [-].
        """
        jerk, found = acceleration / jerk_time, 0.0
        families = self._steps if isinstance(move, VelocityStep) else self._positionings
        for family in families(move, acceleration, jerk):
            for used in family:
                found = max(found, jerk * used)
                if found > enough:
                    return found
        return found

    def _steps(self, move: Move, acceleration: float, jerk: float) -> Iterator[Iterator[float]]:
        assert isinstance(move, VelocityStep)
        k, longest = self._lag(acceleration / jerk), self._lag(move.velocity_step / acceleration)
        if longest >= k:
            yield self._once(("held step", k, longest), partial(self._held_step, k, longest))
        pointed = min(k, self._lag(sqrt(move.velocity_step / jerk)))
        yield self._up_to("pointed step", self._pointed_step, pointed)

    def _positionings(
        self, move: Move, acceleration: float, jerk: float
    ) -> Iterator[Iterator[float]]:
        assert isinstance(move, Positioning)
        times = jerk_steps(move, acceleration=np.array([acceleration]), jerk=np.array([jerk])).times
        ramp, rise = float(times[0, 1]), float(times[0, 3])
        k, peak = self._lag(acceleration / jerk), jerk * ramp * (rise - ramp)
        reaches = ramp >= acceleration / jerk * (1.0 - 1e-9)
        pointed, change = self._lag(ramp), self._lag(rise - ramp)
        if peak >= move.max_velocity * (1.0 - 1e-9):
            longest = self._lag(move.distance / peak)
            cruise = partial(self._cruise, pointed, change, longest)
            yield self._once((f"cruise {change}", pointed, longest), cruise)
        yield self._up_to("pointed move", self._pointed_move, pointed)
        if reaches:
            flat = partial(self._flat_move, k)
            yield self._up_to(f"flat move {k}", flat, max(change, k), start=k)

    def _lag(self, time: float) -> int:
        return max(round(min(time, FOR_EVER) / self.dt), 1)

    def _up_to(
        self, name: str, worst: Callable[[int], float], most: int, *, start: int = 1
    ) -> Iterator[float]:
        """The worst over ramps up to one, on a grid that all calls share.

        Rising, so what was seen once need not be looked at again.
        """
        yield from self._once((name, most, 0), partial(worst, most))
        rising = self.rising.setdefault(name, [worst(start)])
        count = (most - start - 1) // self.every + 1
        yield rising[min(count, len(rising) - 1)]
        while len(rising) <= count:
            rising.append(max(rising[-1], worst(start + len(rising) * self.every)))
            yield rising[-1]

    def _once(self, key: tuple[str, int, int], compute: Callable[[], float]) -> Iterator[float]:
        if key not in self.known:
            self.known[key] = compute()
        yield self.known[key]

    def _pointed_step(self, t: int) -> float:
        return self.judged.worst(self.judged.ramp(0), {0: 1.0, t: -2.0, 2 * t: 1.0}, length=2 * t)

    def _pointed_move(self, t: int) -> float:
        lags = {0: 1.0, t: -2.0, 3 * t: 2.0, 4 * t: -1.0}
        return self.judged.worst(self.judged.ramp(0), lags, length=4 * t)

    def _flat_move(self, k: int, t: int) -> float:
        lags = {0: 1.0, t: -1.0, 2 * t + k: 1.0}
        lags[t + k] = lags.get(t + k, 0.0) - 1.0
        return self.judged.worst(self.judged.ramp(k), lags, length=2 * (t + k))

    def _held_step(self, k: int, most: int) -> float:
        return self.judged.worst_difference(self.judged.ramp(k), length=k, least=k, most=most)

    def _cruise(self, k: int, change: int, most: int) -> float:
        y = less_delayed(self.judged.ramp(k), change)
        length = k + change
        return self.judged.worst_difference(y, length=length, least=length, most=most)
