"""Limits looked at, rounded to the control's resolution: few digits, judged exactly."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import ceil, floor, log10

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.search.bench import (
    Bench,
    reached_accelerations,
    settle_gradually,
    use_of_bounds,
)
from mtcommission.limits.search.explore import USAGE_DOUBT, Pool
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


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundedLimits:
    """Limits to type in.

    Parameters
    ----------
    limits
        Rounded.
    meets_requirements
        Whether all requirements hold by the search's own judgement.
    """

    limits: MotionLimits
    meets_requirements: bool


def round_best(bench: Bench, pool: Pool, settings: SearchSettings) -> RoundedLimits:
    """Return the best limits after rounding to the control's resolution.

    Parameters
    ----------
    bench
        The bench.
    pool
        What was looked at.
    settings
        Digits.

    Returns
    -------
    RoundedLimits
        Where nothing meets the requirements, the limits with the least settling time within
        force and peaks; where nothing is within these, the ones that use least of them.
    """
    longest = bench.machine.requirements.max_settling_time
    possible = pool.usage <= 1.0 + USAGE_DOUBT
    good = possible & (pool.residual <= bench.band) & (pool.settling <= longest)
    for wanted, meets in ((good, True), (possible, False)):
        found = _first_within_bounds(bench, pool, wanted, settings, meets=meets)
        if found is not None:
            return RoundedLimits(limits=found, meets_requirements=meets)
    least = int(np.argmin(pool.usage))
    a, t = float(pool.acceleration[least]), float(pool.jerk_time[least])
    limits = MotionLimits(
        acceleration=_neighbours(a, settings.digits, 0)[0],
        jerk=_neighbours(a / t, settings.digits, 0)[0],
    )
    return RoundedLimits(limits=limits, meets_requirements=False)


def _first_within_bounds(
    bench: Bench, pool: Pool, wanted: NDArray[np.bool_], settings: SearchSettings, *, meets: bool
) -> MotionLimits | None:
    """The rounded neighbour that settles first; None if none keeps force and peaks."""
    order = np.flatnonzero(wanted)
    order = order[np.lexsort((pool.residual[order], pool.settling[order]))]
    while order.size:
        part, order = order[:LEADERS], order[LEADERS:]
        a, t = pool.acceleration[part], pool.jerk_time[part]
        used = use_of_bounds(bench, a, t).max(axis=1)
        limits = _round(bench, a, t, used, settings, meets=meets)
        if limits is not None:
            return limits
        order = order[_corrected(pool, order, part, used) <= 1.0 + NEAR_DOUBT]
    return None


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
    bench: Bench, a: Array, t_j: Array, used: Array, settings: SearchSettings, *, meets: bool
) -> MotionLimits | None:
    """The fastest neighbour with few digits that still holds; None if rounding spoils all."""
    pairs: dict[tuple[float, float], int] = {}
    for reached, one, ramp, share in zip(
        reached_accelerations(bench.machine, a, t_j), a, t_j, used, strict=True
    ):
        for digits, reach in ((settings.digits, 1), (settings.digits + 1, 0)):
            near = product(
                _neighbours(reached, digits, reach), _neighbours(one / ramp, digits, reach)
            )
            for pair in near:
                growth = max(pair[0] / reached, pair[1] * ramp / one)
                if share * growth <= 1.0 + ROUNDING_DOUBT:
                    pairs.setdefault(pair, digits)
    if not pairs:
        return None
    acceleration, jerk = np.array(list(pairs)).T
    settling = _judge(bench, acceleration, jerk, meets=meets)
    cost = settling * (1.0 + DIGIT_WORTH * np.array(list(pairs.values())))
    order = np.flatnonzero(np.isfinite(settling) | (not meets))
    order = order[np.argsort(cost[order], kind="stable")]
    for start in range(0, len(order), LEADERS):
        part = order[start : start + LEADERS]
        exact = use_of_bounds(bench, acceleration[part], acceleration[part] / jerk[part])
        for i in part[exact.max(axis=1) <= 1.0]:
            return MotionLimits(acceleration=float(acceleration[i]), jerk=float(jerk[i]))
    return None


def _judge(bench: Bench, acceleration: Array, jerk: Array, *, meets: bool) -> Array:
    """Settling time seen exactly; inf where the band or the time is missed and ``meets`` asks."""
    longest = bench.machine.requirements.max_settling_time
    settling = np.full_like(acceleration, np.inf)
    for alive, found in settle_gradually(bench, bench.tables, acceleration, acceleration / jerk):
        if meets:
            alive &= found.residual_deviation <= bench.band
            alive &= found.settling_time <= longest
        settling = np.where(alive, found.settling_time, np.inf)
    return settling


def _neighbours(value: float, digits: int, reach: int) -> list[float]:
    """The numbers with few significant digits around a value, ``reach`` more on either side."""
    exponent = floor(log10(value)) - digits + 1
    scaled = value / 10.0**exponent
    around = range(floor(scaled) - reach, ceil(scaled) + reach + 1)
    return [float(f"{number}e{exponent}") for number in around if number > 0]
