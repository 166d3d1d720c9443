"""The acceleration and jerk that let the slowest move settle soonest, in every corner.

What is known beforehand (the commissioning rule, the makers' rules, the optima) is judged first:
nothing slower than the best of it need be looked at. The search itself is global, then local
(``search.explore``), by exact superposition, and what it finds is judged again by simulation:
only that verdict counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import islice
from math import inf, log

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.commissioning_rule.rule import apply_commissioning_rule
from mtcommission.limits.every.search import search_every_size
from mtcommission.limits.every.typed import Typed, bound_of, find_for_every_size
from mtcommission.limits.reserve import keep_reserve
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.limits.search.bench import (
    Bench,
    build_bench,
    motion_time,
    settle_exactly,
    use_of_bounds,
)
from mtcommission.limits.search.explore import Pool, explore, guess_usage, join
from mtcommission.limits.search.landscape import Landscape, chart_landscape
from mtcommission.limits.search.region import Region, lay_grid, narrow_region, widest_region
from mtcommission.limits.search.rounding import least_used, rank_limits, round_down
from mtcommission.limits.search.settings import SearchSettings
from mtcommission.loop.simulation_budget import require_affordable, require_affordable_limits
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Reserve
from mtcommission.machine.requirement import RESIDUAL_DEVIATION, SETTLING_TIME, Requirement
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message, join_by_and
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verdict.assess import assess
from mtcommission.verdict.evaluate import Candidate, MoveResult, evaluate_moves, simulate_moves
from mtcommission.verdict.every_size import judge_every_size

__all__ = ["Choice", "SearchSettings", "choose_limits"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Choice:
    """Recommended limits, judged, and what the search saw.

    Parameters
    ----------
    candidate
        The limits, rounded to what is typed in, and the verdict on exactly these.
    moves
        Their moves in every corner.
    reserve
        What was to be kept of band and force.
    reserve_used
        Whether the limits need more than that leaves, because nothing else meets the
        requirements.
    explain
        Names what forbids faster limits, when it is first asked for: few choices are.
    chart
        Charts the landscape to be printed, likewise.
    evaluations
        Limits judged in every corner, or until others were better already.
    """

    candidate: Candidate
    moves: tuple[MoveResult, ...]
    reserve: Reserve
    reserve_used: bool
    explain: Callable[[], Message]
    chart: Callable[[], Landscape]
    evaluations: int

    @property
    def limits(self) -> MotionLimits:
        """Acceleration and jerk to type in."""
        return self.candidate.limits

    @property
    def meets_requirements(self) -> bool:
        """Whether all requirements are met, reserve apart."""
        return self.candidate.assessment.is_met

    @property
    def warnings(self) -> tuple[Message, ...]:
        """What the verdict does not show."""
        kept = self.reserve
        used = Message("reserve-used", band=kept.band, force=kept.force)
        return (used,) if self.reserve_used else ()

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
    near: MotionLimits | None = None,
    largest_jerk: float = inf,
    settings: SearchSettings | None = None,
) -> Choice:
    """Return the limits with the least worst-case settling time that meet all requirements.

    Whatever is returned was simulated with the digits that are typed in and judged as the sheet
    judges it; what fails there gives way to the next best, and in the end to gentler limits.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.
    starts
        Limits to begin with besides those of the rules, e.g. from the optima.
    near
        Best limits of a loop much like this one: where every size counts, only their
        neighbourhood is looked at.
    largest_jerk
        [m/s³].
    settings
        None: the defaults.

    Returns
    -------
    Choice
        Keeps the reserve; where nothing does, all requirements without it. Of limits that settle
        equally soon the gentlest; else never slower than a rule or a start that meets all that
        (up to the rounding to what is typed in). Where nothing meets the requirements, the
        limits with the least settling time within force and peaks.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG where the moves take more cycles than are followed.
    """
    require_affordable(machine)
    settings = settings or SearchSettings()
    strict = keep_reserve(machine)
    if not machine.requirements.every_size and machine.control.seeks_setpoint_filter:
        return _choose_filter(machine, plant, tuned, starts, largest_jerk, settings)
    if machine.requirements.every_size:
        choice = _choose_for_every_size(machine, strict, plant, tuned, near, largest_jerk, settings)
        if choice is not None:
            return choice
    found = _search(strict, plant, tuned, starts, largest_jerk, settings)
    judged = _first_met(machine, strict, plant, tuned, found.proposals())
    if judged is None and strict is not machine:
        found = _search(machine, plant, tuned, starts, largest_jerk, settings)
        judged = _first_met(machine, machine, plant, tuned, found.proposals())
    met = judged is not None
    candidate, moves = judged or _soonest_possible(machine, plant, tuned, found)
    return Choice(
        candidate=candidate,
        moves=moves,
        reserve=machine.requirements.reserve,
        reserve_used=met and found.machine is not strict,
        explain=cache(partial(_explain, found, candidate.limits, met)),
        chart=cache(
            partial(_chart, machine, plant, tuned, found.widest, candidate.limits, settings)
        ),
        evaluations=len(found.pool.settling),
    )


def choose_for_listed(
    machine: Machine, plant: Plant, tuned: TunedLoop, *, settings: SearchSettings
) -> Candidate:
    """Return what would serve the listed sizes alone best, whatever smaller moves do.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    settings
        Of the search.

    Returns
    -------
    Candidate
        Judged on the listed sizes.
    """
    machine = replace(machine, requirements=replace(machine.requirements, every_size=False))
    return choose_limits(machine, plant, tuned, settings=settings).candidate


def _choose_filter(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    starts: Sequence[MotionLimits],
    largest_jerk: float,
    settings: SearchSettings,
) -> Choice:
    """The best choice over no setpoint filter and those that serve every size best.

    What serves every size with a filter serves the listed sizes, too: the search begins there.
    """
    strict = keep_reserve(machine)
    likely: dict[SetpointFilter | None, list[MotionLimits]] = {None: list(starts)}
    for item in search_every_size(strict, plant, tuned, largest_jerk=largest_jerk):
        own = MotionLimits(acceleration=item.acceleration, jerk=item.acceleration / item.jerk_time)
        likely.setdefault(item.setpoint_filter, [*starts]).append(own)
    choices = []
    for given, known in islice(likely.items(), 1 + LIKELY_FILTERS):
        control = replace(machine.control, setpoint_filter=given, seeks_setpoint_filter=False)
        choices.append(
            choose_limits(
                replace(machine, control=control),
                plant,
                tuned,
                starts=known,
                largest_jerk=largest_jerk,
                settings=settings,
            )
        )
    met = [choice for choice in choices if choice.meets_requirements] or choices
    return min(met, key=lambda choice: choice.candidate.settling_time)


LIKELY_FILTERS = 2
"""Setpoint filters that are tried for the listed sizes, the best for every size first."""


def _choose_for_every_size(
    machine: Machine,
    strict: Machine,
    plant: Plant,
    tuned: TunedLoop,
    near: MotionLimits | None,
    largest_jerk: float,
    settings: SearchSettings,
) -> Choice | None:
    """The limits and the filter that serve every smaller move, too.

    Where they only take longer than is wanted, they are still what may be typed in. None where no
    limits keep the rest.
    """
    late: Choice | None = None
    for allowed in dict.fromkeys((strict, machine)):
        typed = find_for_every_size(allowed, plant, tuned, largest_jerk=largest_jerk, near=near)
        if typed is None:
            continue
        moves = simulate_moves(machine, tuned, typed.limits)
        candidate = evaluate_moves(machine, plant, tuned, moves, sizes=typed.sizes)
        choice = Choice(
            candidate=candidate,
            moves=moves,
            reserve=machine.requirements.reserve,
            reserve_used=allowed is not strict,
            explain=cache(partial(_explain_sizes, allowed, plant, tuned, typed, largest_jerk)),
            chart=cache(partial(_chart_widest, machine, plant, tuned, typed.limits, settings)),
            evaluations=typed.evaluations,
        )
        if candidate.assessment.is_met:
            return choice
        missed = [item for item in candidate.assessment.checks if not item.is_met]
        if all(item.requirement == SETTLING_TIME for item in missed):
            late = late or choice
    return late


def _explain_sizes(
    machine: Machine, plant: Plant, tuned: TunedLoop, typed: Typed, largest_jerk: float
) -> Message:
    """Name what breaks at some size when either limit is raised a little."""
    limits, broken = typed.limits, dict[Requirement, None]()
    for a, j in RAISED:
        if j * limits.jerk > largest_jerk:
            return Message("bound-by-jerk-in-proportion", jerk=largest_jerk)
        raised = replace(limits, acceleration=a * limits.acceleration, jerk=j * limits.jerk)
        for check in judge_every_size(machine, plant, tuned, raised):
            if check.value > bound_of(machine, check.requirement):
                broken[check.requirement] = None
    motor = machine.drive.motion_force
    if not broken and machine.drive.follows and RAISED[0][0] * limits.acceleration > motor:
        return Message("bound-by-motor", acceleration=motor)
    if not broken:
        return Message("bound-by-settling-later")
    return Message(
        "bound-by-requirements", requirements=join_by_and([item.message for item in broken])
    )


RAISED = ((1.03, 1.03), (1.03, 1.0), (1.0, 1.03))
"""Factors of acceleration and jerk with which it is seen what forbids more."""


_Judged = tuple[Candidate, tuple[MoveResult, ...]]

MOST_JUDGED = 24
"""Proposals of each kind that are simulated, until one meets what is required."""


def _first_met(
    machine: Machine,
    strict: Machine,
    plant: Plant,
    tuned: TunedLoop,
    proposals: Iterable[MotionLimits],
) -> _Judged | None:
    """The first proposal whose simulated moves meet the stricter requirements."""
    for limits in proposals:
        moves = simulate_moves(machine, tuned, limits)
        rows = [result.responses for result in moves]
        if assess(strict, plant, tuned.corners, rows).is_met:
            return evaluate_moves(machine, plant, tuned, moves), moves
    return None


def _soonest_possible(machine: Machine, plant: Plant, tuned: TunedLoop, found: _Found) -> _Judged:
    """Where nothing meets all: the least settling time within force, peaks and contour."""
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Found:
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
            round_down(self.bench, *pair, self.settings) for pair in zip(a, a / j, strict=True)
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


def _search(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    starts: Sequence[MotionLimits],
    largest_jerk: float,
    settings: SearchSettings,
) -> _Found:
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
    return _Found(
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Stage:
    """The bench for a region, and the best known limits that meet all requirements, if any."""

    bench: Bench
    region: Region
    best: tuple[MotionLimits, ...]


def _chart_widest(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    chosen: MotionLimits,
    settings: SearchSettings,
) -> Landscape:
    """The map behind the filter that was chosen with the limits, about them."""
    own = chosen.setpoint_filter
    machine = replace(machine, control=replace(machine.control, setpoint_filter=own))
    widest = widest_region(machine, plant, settings, [chosen])
    return _chart(machine, plant, tuned, widest, chosen, settings)


def _chart(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    widest: Region,
    chosen: MotionLimits,
    settings: SearchSettings,
) -> Landscape:
    longest = max(widest.longest_jerk_time, CHOSEN_INSIDE * chosen.jerk_time)
    if widest.has_one_jerk_time:
        # The picture shows what a jerk limit would do, too.
        longest = max(longest_period(plant), MAPPED * widest.shortest_jerk_time)
    widest = replace(widest, longest_jerk_time=longest)
    bench = build_bench(machine, plant, tuned, longest=_longest(machine, widest))
    guess = guess_usage(bench, widest, widest=widest, points=settings.coarse_grid)
    return chart_landscape(bench, guess, widest, points=settings.landscape)


CHOSEN_INSIDE = 1.3
"""Longest jerk time of the map over that of the chosen limits, at least."""

MAPPED = 10.0
"""Longest jerk time of the map over the position cycle, where the control has no jerk limit."""

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
    bench = build_bench(machine, plant, tuned, longest=_longest(machine, widest))
    return _Stage(bench=bench, region=widest, best=())


def _longest(machine: Machine, region: Region) -> float:
    a, t = np.array([region.least_acceleration]), np.array([region.longest_jerk_time])
    return float(motion_time(machine, a, t)[0])


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


def _explain(found: _Found, limits: MotionLimits, feasible: bool) -> Message:
    """Name what breaks when either limit is raised a little."""
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
