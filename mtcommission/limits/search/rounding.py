"""Limits looked at, rounded to the control's resolution: few digits, judged exactly."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.digits import limits_about, round_limits
from mtcommission.limits.search.bench import (
    Bench,
    motion_time,
    reached_accelerations,
    settle_exactly,
    settle_gradually,
    use_of_bounds,
)
from mtcommission.limits.search.explore import USAGE_DOUBT, Pool
from mtcommission.limits.search.region import Region
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.setpoint.motion_limits import MotionLimits

Array = NDArray[np.float64]

LEADERS = 32
"""Candidates whose force is simulated together, and then their rounded neighbours, best first."""

ROUNDING_DOUBT = 0.005
"""Error allowed for in the use of force of a rounded neighbour before it is simulated, when it is
taken as the candidate's own in proportion to the limit that grows more (empirical)."""

NEAR_DOUBT = 0.01
"""The same for a candidate whose guess is corrected by what the nearest simulated one showed
(empirical)."""

DIGIT_WORTH = 0.002
"""Share of settling time that one digit less to type is worth (design choice)."""


EQUALLY_SOON = 1.005
"""Limits that settle within this factor of the soonest settle equally soon: then less jerk is
better (design choice: what half a per cent of time cannot buy, wear and noise pay for)."""

GENTLER = 16
"""Accelerations, and jerk times to each, looked at for gentler limits that settle equally soon."""

GENTLEST = 128
"""Of these and of what was looked at before, so many are judged exactly, the gentlest first."""


def rank_limits(
    bench: Bench, pool: Pool, region: Region, settings: SearchSettings, *, must_meet: bool = True
) -> Iterator[MotionLimits]:
    """Yield limits to type in, the best first: each holds by the search's own judgement.

    Parameters
    ----------
    bench
        The bench.
    pool
        What was looked at.
    region
        Where.
    settings
        Digits.
    must_meet
        Whether band and settling time must be met, and not force, peaks and contour alone.

    Yields
    ------
    MotionLimits
        Of those that settle equally soon the gentlest; then ever later ones.
    """
    longest = bench.machine.requirements.max_settling_time
    wanted = pool.usage <= 1.0 + USAGE_DOUBT
    if must_meet:
        wanted &= (pool.residual <= bench.band) & (pool.settling <= longest)
    order = np.flatnonzero(wanted)
    order = order[np.lexsort((pool.residual[order], pool.settling[order]))]
    is_first = must_meet
    while order.size:
        part, order = order[:LEADERS], order[LEADERS:]
        a, t = pool.acceleration[part], pool.jerk_time[part]
        used = use_of_bounds(bench, a, t).max(axis=1)
        for limits in _round(bench, region, a, t, used, settings, must_meet=must_meet):
            if is_first:
                is_first = False
                yield from _gentler(bench, pool, region, limits, settings)
            yield limits
        order = order[_corrected(pool, order, part, used) <= 1.0 + NEAR_DOUBT]


def least_used(bench: Bench, pool: Pool, settings: SearchSettings) -> MotionLimits:
    """Return the limits, rounded down, that use least of force and peaks by the first look."""
    least = int(np.argmin(pool.usage))
    a, t = float(pool.acceleration[least]), float(pool.jerk_time[least])
    return round_limits(bench.machine, a, t, digits=settings.digits)


def _gentler(
    bench: Bench, pool: Pool, region: Region, soonest: MotionLimits, settings: SearchSettings
) -> Iterator[MotionLimits]:
    """Limits with less jerk that settle equally soon, the gentlest first."""
    latest = EQUALLY_SOON * float(
        settle_exactly(
            bench, np.array([soonest.acceleration]), np.array([soonest.jerk_time])
        ).settling_time[0]
    )
    tau = bench.tables[0].reference_delay
    near = pool.settling <= latest
    # The same duration belongs to less jerk with more acceleration, up to where a is not reached.
    share = np.geomspace(2.0 - EQUALLY_SOON, 1.5, GENTLER)
    grid = np.outer(share, np.geomspace(1.0, 4.0, GENTLER))
    a = np.append(pool.acceleration[near], np.repeat(share, GENTLER) * soonest.acceleration)
    t = np.append(pool.jerk_time[near], grid.ravel() * soonest.jerk_time)
    a = np.minimum(a, region.largest_acceleration)
    jerkless = region.has_one_jerk_time
    if jerkless:
        t = np.full_like(a, region.shortest_jerk_time)
    reached = a if jerkless else reached_accelerations(bench.machine, a, t)
    pairs = {
        (typed.acceleration, typed.jerk)
        for one, ramp in zip(reached, t * reached / a, strict=True)
        if one < soonest.jerk * ramp
        for typed in limits_about(bench.machine, one, ramp, digits=settings.digits)
        if typed.jerk < soonest.jerk
    }
    if not pairs:
        return
    a, jerk = np.array(sorted(pairs, key=lambda pair: pair[1])).T
    in_time = np.flatnonzero(motion_time(bench.machine, a, a / jerk) + tau <= latest)[:GENTLEST]
    a, jerk = a[in_time], jerk[in_time]
    settling = _judge(bench, a, jerk, must_meet=True)
    good = np.flatnonzero(settling <= latest)
    for start in range(0, len(good), LEADERS):
        part = good[start : start + LEADERS]
        yield from _within_bounds(bench, a, jerk, part)


def _within_bounds(
    bench: Bench, a: Array, jerk: Array, part: NDArray[np.intp]
) -> Iterator[MotionLimits]:
    """Those of some limits that keep force, peaks and contour, in their order."""
    used = use_of_bounds(bench, a[part], a[part] / jerk[part]).max(axis=1)
    for i in part[used <= 1.0]:
        yield MotionLimits(acceleration=float(a[i]), jerk=float(jerk[i]))


def _corrected(pool: Pool, wanted: NDArray[np.intp], known: NDArray[np.intp], used: Array) -> Array:
    """The guessed use, times what the nearest simulated limits showed of its error."""
    places = np.column_stack([np.log(pool.acceleration), np.log(pool.jerk_time)])
    gap = np.sum(((places[wanted][:, None] - places[known]) / NEAR) ** 2, axis=2)
    nearest = np.argmin(gap, axis=1)
    is_near = gap[np.arange(len(wanted)), nearest] < 1.0
    ratio = (used / pool.usage[known])[nearest]
    return np.where(is_near, pool.usage[wanted] * ratio, pool.usage[wanted] - USAGE_DOUBT)


NEAR = np.array([0.1, 0.02])
"""Distance in log a and log t_j up to which the error of the guess is taken as the same
(empirical: below what vibrations swing over)."""


def _round(
    bench: Bench,
    region: Region,
    a: Array,
    t_j: Array,
    used: Array,
    settings: SearchSettings,
    *,
    must_meet: bool,
) -> Iterator[MotionLimits]:
    """The neighbours with few digits that still hold, the soonest first."""
    pairs: dict[tuple[float, float], int] = {}
    # Without a jerk limit the ramp follows from a, so that a counts even where it is not reached.
    jerkless = region.has_one_jerk_time
    peaks = a if jerkless else reached_accelerations(bench.machine, a, t_j)
    for reached, one, ramp, share in zip(peaks, a, t_j, used, strict=True):
        for digits, reach in ((settings.digits, 1), (settings.digits + 1, 0)):
            for typed in limits_about(
                bench.machine, reached, ramp * reached / one, digits=digits, reach=reach
            ):
                growth = max(typed.acceleration / reached, typed.jerk * ramp / one)
                if share * growth <= 1.0 + ROUNDING_DOUBT and typed.jerk <= region.largest_jerk:
                    pairs.setdefault((typed.acceleration, typed.jerk), digits)
    if not pairs:
        return
    acceleration, jerk = np.array(list(pairs)).T
    settling = _judge(bench, acceleration, jerk, must_meet=must_meet)
    cost = settling * (1.0 + DIGIT_WORTH * np.array(list(pairs.values())))
    order = np.flatnonzero(np.isfinite(settling) | (not must_meet))
    order = order[np.argsort(cost[order], kind="stable")]
    for start in range(0, len(order), LEADERS):
        part = order[start : start + LEADERS]
        yield from _within_bounds(bench, acceleration, jerk, part)


def _judge(bench: Bench, acceleration: Array, jerk: Array, *, must_meet: bool) -> Array:
    """Settling time seen exactly; inf where band or time must be met and are missed."""
    longest = bench.machine.requirements.max_settling_time
    settling = np.full_like(acceleration, np.inf)
    for alive, found in settle_gradually(bench, bench.tables, acceleration, acceleration / jerk):
        if must_meet:
            alive &= found.residual_deviation <= bench.band
            alive &= found.settling_time <= longest
        settling = np.where(alive, found.settling_time, np.inf)
    return settling
