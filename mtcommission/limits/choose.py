"""The acceleration and jerk that let the slowest move settle soonest, in every corner.

What is known beforehand (the commissioning rule, the makers' rules, the optima) is judged first:
nothing slower than the best of it need be looked at. The search itself is global, then local
(``search.explore``), by exact superposition, and what it finds is judged again by simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.commissioning_rule.rule import apply_commissioning_rule
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.limits.search.bench import (
    Bench,
    build_bench,
    motion_time,
    settle_exactly,
    use_of_bounds,
)
from mtcommission.limits.search.explore import explore, guess_usage, join
from mtcommission.limits.search.landscape import Landscape, chart_landscape
from mtcommission.limits.search.region import Region, lay_grid, narrow_region, widest_region
from mtcommission.limits.search.rounding import round_best
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.simulation_budget import require_affordable, require_affordable_limits
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import RESIDUAL_DEVIATION
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits

__all__ = ["Choice", "SearchSettings", "choose_limits"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Choice:
    """Recommended limits and what the search saw.

    Parameters
    ----------
    limits
        Rounded to the control's resolution.
    meets_requirements
        Whether all requirements hold by the search's own judgement.
    explain
        Names what forbids faster limits, when it is first asked for: few choices are.
    chart
        Charts the landscape to be printed, likewise.
    evaluations
        Limits judged in every corner, or until others were better already.
    """

    limits: MotionLimits
    meets_requirements: bool
    explain: Callable[[], Message]
    chart: Callable[[], Landscape]
    evaluations: int

    @property
    def bound_by(self) -> Message:
        """What forbids faster limits."""
        return self.explain()

    @property
    def landscape(self) -> Landscape:
        """Settling time, residual deviation and use of force over all limits."""
        return self.chart()


def choose_limits(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    *,
    starts: Sequence[MotionLimits] = (),
    settings: SearchSettings | None = None,
) -> Choice:
    """Return the limits with the least worst-case settling time that meet all requirements.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.
    starts
        Limits to begin with besides those of the rules, e.g. from the optima.
    settings
        None: the defaults.

    Returns
    -------
    Choice
        Never slower than a rule or a start that meets all requirements (up to the rounding of
        the resolution). Where nothing meets them, the limits with the least settling time
        within force and peaks.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG where the moves take more cycles than are followed.
    """
    require_affordable(machine)
    settings = settings or SearchSettings()
    by_rule = apply_commissioning_rule(machine, plant, tuned).limits
    require_affordable_limits(machine, by_rule)
    trusted = [by_rule, *starts]
    widest = widest_region(machine, plant, settings, trusted)
    known = [*trusted, *(rule.limits for rule in apply_rules_of_thumb(machine, plant))]
    stage = _set_stage(machine, plant, tuned, widest, known)
    bench, region = stage.bench, stage.region
    grid = lay_grid(region, machine, widest=widest, points=settings.grid)
    guess = guess_usage(bench, region, widest=widest, points=settings.coarse_grid)
    begin = [_inside(item, region) for item in (*known, *stage.best)]
    pool = explore(bench, guess, grid, region, starts=begin, settings=settings)
    if not np.any((pool.residual <= bench.band) & (pool.usage <= 1.0)):
        # Nothing comes to rest within the band: then the least settling time alone counts.
        more = explore(bench, guess, grid, region, starts=begin, settings=settings, urgency=0.0)
        pool = join([pool, more])
    found = round_best(bench, pool, settings)
    return Choice(
        limits=found.limits,
        meets_requirements=found.meets_requirements,
        explain=cache(partial(_explain, bench, found.limits, found.meets_requirements)),
        chart=cache(partial(_chart, machine, plant, tuned, widest, settings)),
        evaluations=len(pool.settling),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Stage:
    """The bench for a region, and the best known limits that meet all requirements, if any."""

    bench: Bench
    region: Region
    best: tuple[MotionLimits, ...]


def _chart(
    machine: Machine, plant: Plant, tuned: TunedLoop, widest: Region, settings: SearchSettings
) -> Landscape:
    bench = build_bench(machine, plant, tuned, longest=_longest(machine, widest))
    guess = guess_usage(bench, widest, widest=widest, points=settings.coarse_grid)
    return chart_landscape(bench, guess, widest, points=settings.landscape)


SLOWER = ((1.0, 0.8, 0.6), (0.4, 0.25, 0.1))
"""Shares of the known limits that are tried, in two rounds, until some meet the requirements."""

MUCH_SLOWER = 3.0
"""Known limits that take so much longer than the fastest are not worth a try."""

TOLERANCE = 1.01
"""Room for rounding in the longest motion that is looked at."""


def _set_stage(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    widest: Region,
    known: Sequence[MotionLimits],
) -> _Stage:
    for shares in SLOWER:
        places = [_inside(item, widest, share=share) for item in known for share in shares]
        a = np.array([item.acceleration for item in places])
        t = np.array([item.jerk_time for item in places])
        times = motion_time(machine, a, t)
        quick = times <= MUCH_SLOWER * times.min()
        a, t = a[quick], t[quick]
        bench = build_bench(machine, plant, tuned, longest=float(times[quick].max()))
        place, soonest = _soonest(bench, a, t)
        if isfinite(soonest):
            longest = TOLERANCE * (soonest - bench.tables[0].reference_delay)
            return _Stage(
                bench=bench,
                region=narrow_region(widest, machine, longest_motion=longest),
                best=(MotionLimits(acceleration=float(a[place]), jerk=float(a[place] / t[place])),),
            )
    bench = build_bench(machine, plant, tuned, longest=_longest(machine, widest))
    return _Stage(bench=bench, region=widest, best=())


def _inside(limits: MotionLimits, region: Region, *, share: float = 1.0) -> MotionLimits:
    """The nearest limits within a region, with a share of the acceleration."""
    low, high = region.least_acceleration, region.largest_acceleration
    a = min(max(share * min(limits.acceleration, high), low), high)
    t = min(max(limits.jerk_time, region.shortest_jerk_time), region.longest_jerk_time)
    return MotionLimits(acceleration=a, jerk=a / t)


def _longest(machine: Machine, region: Region) -> float:
    a, t = np.array([region.least_acceleration]), np.array([region.longest_jerk_time])
    return float(motion_time(machine, a, t)[0])


def _soonest(bench: Bench, a: Array, t: Array) -> tuple[int, float]:
    """Which limits meet all requirements and settle first, and when; inf if none do."""
    found = settle_exactly(bench, a, t)
    good = found.residual_deviation <= bench.band
    good &= found.settling_time <= bench.machine.requirements.max_settling_time
    order = np.flatnonzero(good)
    order = order[np.argsort(found.settling_time[order], kind="stable")]
    for start in range(0, len(order), FEW):
        part = order[start : start + FEW]
        fits = part[use_of_bounds(bench, a[part], t[part]).max(axis=1) <= 1.0]
        if fits.size:
            return int(fits[0]), float(found.settling_time[fits[0]])
    return 0, inf


FEW = 8
"""Known limits whose force is simulated together, best first."""


def _explain(bench: Bench, limits: MotionLimits, feasible: bool) -> Message:
    """Name what breaks when either limit is raised a little."""
    if not feasible:
        return Message("bound-by-nothing-met")
    steps = (1.01, 1.03, 1.1)
    pairs = [(f, 1.0) for f in steps] + [(1.0, f) for f in steps] + [(f, f) for f in steps]
    factors = np.array(pairs)
    a = limits.acceleration * factors[:, 0]
    t = a / (limits.jerk * factors[:, 1])
    residual = settle_exactly(bench, a, t).residual_deviation
    used = use_of_bounds(bench, a, t)
    columns = zip(
        (RESIDUAL_DEVIATION, *bench.requirements), (residual / bench.band, *used.T), strict=True
    )
    broken = [requirement.message for requirement, share in columns if np.any(share > 1.0)]
    if not broken:
        return Message("bound-by-settling-later")
    return Message("bound-by-requirements", requirements=join_by_and(broken))
