"""A first look at many limits, and a closer one at the best of them.

The landscape of settling time over (a, t_j) is full of narrow valleys, where a ramp or the
distance of two ramps happens to cancel a mode. So the whole region is looked at first, then the
best cells are halved again and again, all at once. What is found here is judged exactly later.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import isfinite, log

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator

from mtcommission.limits.search.bench import (
    Bench,
    find_decisive,
    motion_time,
    settle_gradually,
    use_by_corner,
    use_of_bounds,
)
from mtcommission.limits.search.region import ALIKE, Grid, Region
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.batch.settling import Settling
from mtcommission.loop.batch.tables import SEARCH_HORIZON
from mtcommission.setpoint.motion_limits import MotionLimits

Array = NDArray[np.float64]

RESIDUAL_URGENCY = 0.5
"""Power by which a residual above the band lengthens the settling time in the ranking of seeds
(empirical)."""

USAGE_DOUBT = 0.05
"""Error allowed for in the guessed use of force before it is simulated (measured: below 3 %)."""

SKETCH_DOUBT = 1.03
"""Factor by which a first look may be wrong in time and deviation (see ``SKETCH_SAMPLES``)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pool:
    """Limits looked at, each array of shape (n_limits,).

    Parameters
    ----------
    acceleration, jerk_time
        [m/s², s].
    settling, residual
        Worst over moves and corners at a first look [s, m]; inf where the look was broken off,
        because others were better already.
    usage
        Guessed share of the bounds on force and peaks, worst case [-].
    """

    acceleration: Array
    jerk_time: Array
    settling: Array
    residual: Array
    usage: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Guess:
    """The use of force and peaks, which is smooth in (a, t_j), between some simulated limits.

    Parameters
    ----------
    logarithm
        Of the use over the logarithms of a and t_j.
    decisive
        Corners that show the worst use everywhere.
    """

    logarithm: RegularGridInterpolator
    decisive: tuple[int, ...]

    def at(self, acceleration: Array, jerk_time: Array) -> Array:
        """Return the guessed use, worst case, shape (n_limits,) [-]."""
        places = np.column_stack([np.log(acceleration), np.log(jerk_time)])
        return np.asarray(np.exp(self.logarithm(places)))


LEAST_NODES = 5
"""Simulated limits in each direction however narrow the region is."""


PEAK_NODES = 3.0
"""So many times more jerk times are simulated where peaks of states are bounded (empirical)."""


def guess_usage(bench: Bench, region: Region, *, widest: Region, points: int) -> Guess:
    """Return the guess for a region.

    Parameters
    ----------
    bench
        The bench.
    region
        Where.
    widest
        Region that ``points`` is meant for.
    points
        In each direction over the widest region.
    """
    a = _nodes(
        region.least_acceleration,
        region.largest_acceleration,
        points / log(widest.largest_acceleration / widest.least_acceleration),
    )
    # Force hardly swings with the jerk time, but the peaks of vibrating states do.
    needs = bench.machine.requirements
    finer = PEAK_NODES if needs.peaks or isfinite(needs.contour_deviation) else 1.0
    if region.has_one_jerk_time:
        t = region.shortest_jerk_time * np.array([1.0, ALIKE])
    else:
        t = _nodes(
            region.shortest_jerk_time,
            region.longest_jerk_time,
            finer * points / log(widest.longest_jerk_time / widest.shortest_jerk_time),
        )
    a_grid, t_grid = np.meshgrid(a, t, indexing="ij")
    time = motion_time(bench.machine, a_grid.ravel(), t_grid.ravel()).reshape(a_grid.shape)
    # A cell is wanted where its fastest corner is fast enough, and then all its corners are.
    cell = time[1:, :-1] <= region.longest_motion
    wanted = np.zeros(a_grid.shape, dtype=bool)
    for i, j in product((0, 1), repeat=2):
        wanted[i : len(a) - 1 + i, j : len(t) - 1 + j] |= cell
    used = np.ones(a_grid.shape)
    by_corner = use_by_corner(bench, a_grid[wanted], t_grid[wanted])
    used[wanted] = by_corner.max(axis=(0, 2))
    axes = np.log(a), np.log(t)
    return Guess(
        logarithm=RegularGridInterpolator(
            axes, np.log(np.maximum(used, 1e-12)), bounds_error=False, fill_value=None
        ),
        decisive=find_decisive(by_corner),
    )


def _nodes(low: float, high: float, density: float) -> Array:
    return np.geomspace(low, high, max(LEAST_NODES, round(density * log(high / low)) + 1))


def screen(
    bench: Bench,
    acceleration: Array,
    jerk_time: Array,
    *,
    usage: Array,
    urgency: float,
    ceiling: Array | float = np.inf,
) -> Pool:
    """Return the first look at some limits.

    Parameters
    ----------
    bench
        The bench.
    acceleration, jerk_time
        Limits, shape (n_limits,) [m/s², s].
    usage
        Guessed share of the bounds, shape (n_limits,) [-].
    urgency
        As in ``score``.
    ceiling
        Score beyond which limits that miss the band need not be followed into further corners.
    """
    whole = np.ones(len(acceleration), dtype=bool)
    found = Settling(settling_time=acceleration, residual_deviation=acceleration)
    for alive, found in settle_gradually(bench, bench.sketches, acceleration, jerk_time):
        whole &= alive
        missed = (found.residual_deviation > bench.band) | (usage > 1.0 + USAGE_DOUBT)
        alive &= (_score(bench, found, usage, urgency) <= ceiling) | ~missed
    return Pool(
        acceleration=acceleration,
        jerk_time=jerk_time,
        settling=np.where(whole, found.settling_time, np.inf),
        residual=np.where(whole, found.residual_deviation, np.inf),
        usage=usage,
    )


def _score(bench: Bench, found: Settling, usage: Array, urgency: float) -> Array:
    missed = np.maximum(found.residual_deviation / bench.band, 1.0) ** urgency
    settling = np.where(np.isfinite(found.settling_time), found.settling_time, 2.0 * SEARCH_HORIZON)
    return np.asarray(settling * missed * np.maximum(usage, 1.0) ** 4)


def score(bench: Bench, pool: Pool, *, urgency: float) -> Array:
    """Return the settling time, lengthened by how far the requirements are missed.

    It only ranks where to look closer; shape (n_limits,) [s].
    """
    found = Settling(settling_time=pool.settling, residual_deviation=pool.residual)
    return np.where(np.isfinite(pool.residual), _score(bench, found, pool.usage, urgency), np.inf)


EVERY = 4
"""Share of a grid that is looked at fully, to know how good the best seeds are at least."""


def screen_grid(bench: Bench, guess: Guess, grid: Grid, *, seeds: int, urgency: float) -> Pool:
    """Return the look at a whole grid, broken off where limits are no seeds anyway.

    Parameters
    ----------
    bench, guess
        The bench, and the use of its bounds.
    grid
        Limits to look at.
    seeds
        How many of the best must be found for sure.
    urgency
        As in ``score``.
    """
    a, t = grid.acceleration, grid.jerk_time
    usage = guess.at(a, t)
    chosen = np.arange(len(a)) % EVERY == 0
    first = screen(bench, a[chosen], t[chosen], usage=usage[chosen], urgency=urgency)
    ranked = np.sort(score(bench, first, urgency=urgency))
    ceiling = float(ranked[min(seeds, len(ranked)) - 1])
    left = ~chosen
    rest = screen(bench, a[left], t[left], usage=usage[left], urgency=urgency, ceiling=ceiling)
    return join([first, rest])


def join(pools: Sequence[Pool]) -> Pool:
    """Return all limits of some pools."""
    return Pool(
        acceleration=np.concatenate([pool.acceleration for pool in pools]),
        jerk_time=np.concatenate([pool.jerk_time for pool in pools]),
        settling=np.concatenate([pool.settling for pool in pools]),
        residual=np.concatenate([pool.residual for pool in pools]),
        usage=np.concatenate([pool.usage for pool in pools]),
    )


def explore(
    bench: Bench,
    guess: Guess,
    grid: Grid,
    region: Region,
    *,
    starts: Sequence[MotionLimits],
    settings: SearchSettings,
    urgency: float = RESIDUAL_URGENCY,
) -> Pool:
    """Return all that was looked at: the grid, and the best cells ever closer.

    Parameters
    ----------
    bench, guess
        The bench, and the use of its bounds.
    grid, region
        What to look at first, and where to stay.
    starts
        Limits to look at closely whatever their score.
    settings
        How many cells, how often.
    urgency
        As in ``score``; 0 where only the settling time counts.
    """
    first = screen_grid(bench, guess, grid, seeds=settings.seeds, urgency=urgency)
    pools = [first]
    best = np.argsort(score(bench, first, urgency=urgency), kind="stable")[: settings.seeds]
    seeds = _Seeds(
        a=np.append(first.acceleration[best], [item.acceleration for item in starts]),
        t=np.append(first.jerk_time[best], [item.jerk_time for item in starts]),
        score=np.append(score(bench, first, urgency=urgency)[best], [np.inf] * len(starts)),
        error=np.ones(len(best) + len(starts)),
    )
    region = _tighten(bench, first, region)
    for level in range(settings.refinements):
        share = 0.5 ** (level + 1)  # whole cells away lie the neighbours in the grid
        cell = grid.ratio_acceleration**share, grid.ratio_jerk_time**share
        if level % EVERY_LEVEL == 0:
            seeds = _correct(bench, guess, seeds)
        pool, seeds = _screen_neighbours(bench, guess, seeds, region, cell=cell, urgency=urgency)
        pools.append(pool)
        seeds = _best_apart(
            seeds, cell=cell, count=settings.seeds if level < 2 else settings.seeds // 2
        )
        region = _tighten(bench, pool, region)
    return join(pools)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Seeds:
    """Limits to look at closer, with their score, and what to multiply the guessed use by there.

    Each of shape (n_seeds,).
    """

    a: Array
    t: Array
    score: Array
    error: Array


EVERY_LEVEL = 3
"""So many levels share the error of the guess that was found by simulating the seeds."""

FREE = 0.8
"""Guessed use below which its error does not matter."""


def _correct(bench: Bench, guess: Guess, seeds: _Seeds) -> _Seeds:
    """Simulate the use of force and peaks at the seeds: what is wrong there, is wrong nearby."""
    guessed, error = guess.at(seeds.a, seeds.t), np.ones_like(seeds.a)
    tight = guessed > FREE
    if tight.any():
        used = use_of_bounds(bench, seeds.a[tight], seeds.t[tight]).max(axis=1)
        error[tight] = used / guessed[tight]
    return replace(seeds, error=error)


OFFSETS = np.array(list(product((-1.0, 0.0, 1.0), repeat=2)))


def _screen_neighbours(
    bench: Bench,
    guess: Guess,
    seeds: _Seeds,
    region: Region,
    *,
    cell: tuple[float, float],
    urgency: float,
) -> tuple[Pool, _Seeds]:
    """Look at the neighbours of every seed; each moves to the best of them."""
    a = seeds.a[:, None] * cell[0] ** OFFSETS[:, 0]
    t = seeds.t[:, None] * cell[1] ** OFFSETS[:, 1]
    a = np.clip(a, region.least_acceleration, region.largest_acceleration)
    t = np.clip(t, region.shortest_jerk_time, region.longest_jerk_time)
    owner = np.repeat(np.arange(len(seeds.a)), len(OFFSETS))
    a, t = a.ravel(), t.ravel()
    kept = (motion_time(bench.machine, a, t) <= region.longest_motion) & region.holds(a, t)
    a, t, owner = a[kept], t[kept], owner[kept]
    pool = screen(
        bench,
        a,
        t,
        usage=guess.at(a, t) * seeds.error[owner],
        urgency=urgency,
        ceiling=seeds.score[owner] * (1.0 + 1e-9),
    )
    found = score(bench, pool, urgency=urgency)
    order = np.lexsort((found, owner))
    _, place = np.unique(owner[order], return_index=True)
    winners = order[place]
    return pool, _Seeds(
        a=a[winners], t=t[winners], score=found[winners], error=seeds.error[owner[winners]]
    )


def _best_apart(seeds: _Seeds, *, cell: tuple[float, float], count: int) -> _Seeds:
    """The best seeds; of those that have come into the same small cell only one."""
    order = np.argsort(seeds.score, kind="stable")
    places = np.column_stack(
        [
            np.round(np.log(seeds.a[order]) / (0.5 * log(cell[0]))),
            np.round(np.log(seeds.t[order]) / (0.5 * log(max(cell[1], ALIKE)))),
        ]
    )
    _, first = np.unique(places, axis=0, return_index=True)
    kept = order[np.sort(first)][:count]
    return _Seeds(
        a=seeds.a[kept], t=seeds.t[kept], score=seeds.score[kept], error=seeds.error[kept]
    )


def _tighten(bench: Bench, pool: Pool, region: Region) -> Region:
    """Leave out what takes longer than limits that seem to meet all requirements."""
    good = (SKETCH_DOUBT * pool.residual <= bench.band) & (pool.usage <= 1.0 - USAGE_DOUBT)
    if not good.any():
        return region
    latest = SKETCH_DOUBT * float(pool.settling[good].min()) - bench.tables[0].reference_delay
    return replace(region, longest_motion=min(region.longest_motion, latest))
