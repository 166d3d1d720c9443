"""The best limits for the listed sizes of move: what the search saw, and what it proposes.

What is known beforehand (the commissioning rule, the makers' rules, the optima) is judged first:
nothing slower than the best of it need be looked at. The search itself is global, then local
(``search.explore``), by exact superposition; its proposals are judged by simulation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from math import log
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.commissioning_rule.rule import apply_commissioning_rule
from mtcommission.limits.digits import round_limits
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.limits.search.bench import (
    Bench,
    build_bench,
    motion_time,
    settle_exactly,
    use_of_bounds,
)
from mtcommission.limits.search.explore import Pool, explore, guess_usage, join
from mtcommission.limits.search.region import (
    Region,
    lay_grid,
    longest_motion,
    narrow_region,
    widest_region,
)
from mtcommission.limits.search.rounding import least_used, rank_limits
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.simulation_budget import require_affordable_limits
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import RESIDUAL_DEVIATION, SETTLING_TIME
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verdict.assess import assess
from mtcommission.verdict.evaluate import Candidate, MoveResult, evaluate_moves, simulate_moves

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Search:
    """What a search saw: its machine, whose requirements count, bench, regions and pool."""

    machine: Machine
    plant: Plant
    tuned: TunedLoop
    bench: Bench
    region: Region
    widest: Region
    pool: Pool
    known: tuple[MotionLimits, ...]
    settings: SearchSettings

    def proposals(self) -> Iterator[MotionLimits]:
        """Limits that should meet all requirements: the best first, then ever gentler ones."""
        ranked = rank_limits(self.bench, self.pool, self.region, self.settings)
        yield from islice(ranked, MOST_JUDGED)
        yield from islice(self._gentler(), MOST_JUDGED)

    def _gentler(self) -> Iterator[MotionLimits]:
        """Known limits, and the best within force and peaks, gentler step by step."""
        ranked = rank_limits(self.bench, self.pool, self.region, self.settings, must_meet=False)
        least = least_used(self.bench, self.pool, self.settings)
        seeds = [*islice(ranked, SEEDS), least, *self.known]
        shares = np.concatenate([GENTLER_PAIRS**n for n in GENTLER_STEPS])
        a = np.outer([item.acceleration for item in seeds], shares[:, 0]).ravel()
        j = np.outer([item.jerk for item in seeds], shares[:, 1]).ravel()
        rounded = {
            round_limits(self.machine, *pair, digits=self.settings.digits)
            for pair in zip(a, a / j, strict=True)
        }
        a = np.array([item.acceleration for item in rounded])
        t = np.array([item.jerk_time for item in rounded])
        longest = float(motion_time(self.machine, a, t).max())
        bench = build_bench(self.machine, self.plant, self.tuned, longest=longest)
        for i in _good_places(bench, a, t):
            yield MotionLimits(acceleration=float(a[i]), jerk=float(a[i] / t[i]))


SEEDS = 4
"""Of the best limits within force and peaks, so many are made gentler."""

GENTLER_PAIRS = np.array([(0.99, 0.99), (0.99, 1.0), (1.0, 0.99)])
"""Shares of acceleration and jerk in one step."""

GENTLER_STEPS = (0, 1, 2, 3, 5, 8, 13, 21, 34, 55)
"""How many steps gentler limits are tried, where nothing that was looked at meets all."""


def search_listed(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    starts: Sequence[MotionLimits],
    *,
    largest_jerk: float,
    settings: SearchSettings,
) -> Search:
    """Return what a search over all limits saw that counts for the listed sizes of move.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, whose requirements count as they stand, its plant and its loop.
    starts
        Limits to begin with besides those of the rules.
    largest_jerk
        [m/s³].
    settings
        Of the search.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG where the moves take more cycles than are followed.
    """
    by_rule = apply_commissioning_rule(machine, plant, tuned).limits
    require_affordable_limits(machine, by_rule)
    trusted = [by_rule, *starts]
    widest = widest_region(machine, plant, settings, trusted, largest_jerk=largest_jerk)
    known = [*trusted, *(rule.limits for rule in apply_rules_of_thumb(machine, plant))]
    stage = _set_stage(machine, plant, tuned, widest, known)
    bench, region = stage.bench, stage.region
    grid = lay_grid(region, machine, widest=widest, points=settings.grid)
    guess = guess_usage(bench, region, widest=widest, points=settings.coarse_grid)
    bench = replace(bench, decisive=guess.decisive)
    begin = [region.nearest(item) for item in (*known, *stage.best)]
    pool = explore(bench, guess, grid, region, starts=begin, settings=settings)
    if not np.any((pool.residual <= bench.band) & (pool.usage <= 1.0)):
        # Nothing comes to rest within the band: then the least settling time alone counts.
        more = explore(bench, guess, grid, region, starts=begin, settings=settings, urgency=0.0)
        pool = join([pool, more])
    return Search(
        machine=machine,
        plant=plant,
        tuned=tuned,
        bench=bench,
        region=region,
        widest=widest,
        pool=pool,
        known=(*stage.best, widest.nearest(by_rule)),
        settings=settings,
    )


Judged: TypeAlias = tuple[Candidate, tuple[MoveResult, ...]]

MOST_JUDGED = 24
"""Proposals of each kind that are simulated, until one meets what is required."""


def first_met(
    machine: Machine,
    strict: Machine,
    plant: Plant,
    tuned: TunedLoop,
    proposals: Iterable[MotionLimits],
) -> Judged | None:
    """Return the first proposal whose simulated moves meet the stricter requirements."""
    for limits in proposals:
        moves = simulate_moves(machine, tuned, limits)
        rows = [result.responses for result in moves]
        if assess(strict, plant, tuned.corners, rows).is_met:
            return evaluate_moves(machine, plant, tuned, moves), moves
    return None


def soonest_possible(machine: Machine, plant: Plant, tuned: TunedLoop, found: Search) -> Judged:
    """Return, where nothing meets all, the least settling time within force, peaks and contour."""
    missable = (RESIDUAL_DEVIATION, SETTLING_TIME)
    ranked = rank_limits(found.bench, found.pool, found.region, found.settings, must_meet=False)
    last = least_used(found.bench, found.pool, found.settings)
    for limits in (*islice(ranked, MOST_JUDGED), last):
        moves = simulate_moves(machine, tuned, limits)
        candidate = evaluate_moves(machine, plant, tuned, moves)
        missed = [item for item in candidate.assessment.checks if not item.is_met]
        if all(check.requirement in missable for check in missed):
            break
    return candidate, moves


SLOWER = ((1.0, 0.8, 0.6), (0.4, 0.25, 0.1))
"""Shares of the known limits that are tried, in two rounds, until some meet the requirements."""

MUCH_SLOWER = 3.0
"""Known limits that take so much longer than the fastest are tried only after these."""

TIERS = 3
"""How often longer ones are tried: what takes more than 27 times as long is not worth it."""

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
        places = [widest.nearest(item, share=share) for item in known for share in shares]
        a = np.array([item.acceleration for item in places])
        t = np.array([item.jerk_time for item in places])
        times = motion_time(machine, a, t)
        tiers = np.floor(np.log(times / times.min()) / log(MUCH_SLOWER))
        for tier in range(TIERS):
            own = tiers == tier
            if not own.any():
                continue
            bench = build_bench(machine, plant, tuned, longest=float(times[own].max()))
            good = next(_good_places(bench, a[own], t[own]), None)
            if good is not None:
                best = MotionLimits(
                    acceleration=float(a[own][good]), jerk=float((a[own] / t[own])[good])
                )
                longest = TOLERANCE * float(times[own][good])
                return _Stage(
                    bench=bench,
                    region=narrow_region(widest, machine, longest_motion=longest),
                    best=(best,),
                )
    bench = build_bench(machine, plant, tuned, longest=longest_motion(machine, widest))
    return _Stage(bench=bench, region=widest, best=())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Stage:
    """The bench for a region, and the best known limits that meet all requirements, if any."""

    bench: Bench
    region: Region
    best: tuple[MotionLimits, ...]


def _good_places(bench: Bench, a: Array, t: Array) -> Iterator[int]:
    """Yield which limits meet all requirements, the soonest first."""
    found = settle_exactly(bench, a, t)
    good = found.residual_deviation <= bench.band
    good &= found.settling_time <= bench.machine.requirements.max_settling_time
    order = np.flatnonzero(good)
    order = order[np.argsort(found.settling_time[order], kind="stable")]
    for start in range(0, len(order), FEW):
        part = order[start : start + FEW]
        yield from part[use_of_bounds(bench, a[part], t[part]).max(axis=1) <= 1.0]


FEW = 8
"""Known limits whose force is simulated together, best first."""


def explain(found: Search, limits: MotionLimits, feasible: bool) -> Message:
    """Return what breaks when either limit is raised a little."""
    if not feasible:
        return Message("bound-by-nothing-met")
    steps, region = (1.01, 1.03, 1.1), found.region
    pairs = [(f, f) for f in steps]
    if found.machine.control.kind.has_jerk_limit:
        pairs += [(f, 1.0) for f in steps] + [(1.0, f) for f in steps]
    allowed = [(f, g) for f, g in pairs if g * limits.jerk <= region.largest_jerk]
    if len(allowed) < len(pairs):
        return Message("bound-by-jerk-in-proportion", jerk=region.largest_jerk)
    factors = np.array(pairs)
    a = limits.acceleration * factors[:, 0]
    t = a / (limits.jerk * factors[:, 1])
    # Gentler limits than the search looked at may have been taken in the end.
    longest = float(motion_time(found.machine, a, t).max())
    bench = build_bench(found.machine, found.plant, found.tuned, longest=longest)
    residual = settle_exactly(bench, a, t).residual_deviation
    used = use_of_bounds(bench, a, t)
    columns = zip(
        (RESIDUAL_DEVIATION, *bench.requirements), (residual / bench.band, *used.T), strict=True
    )
    broken = [requirement.message for requirement, share in columns if np.any(share > 1.0)]
    if not broken:
        return Message("bound-by-settling-later")
    return Message("bound-by-requirements", requirements=join_by_and(broken))
