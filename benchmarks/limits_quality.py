"""Limits from every source on the same random machines: who meets the requirements, who is soon.

    python -m benchmarks quality --count 100

Each machine is tuned once; every source then gets the same loop, corners and judgement. The
brute force is a plain grid over the same region, judged from its soonest point on: it knows
nothing of the search, and where it is sooner, the search has missed something.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from math import nan
from multiprocessing import get_context
from statistics import median
from time import process_time

import numpy as np

from benchmarks.population import random_machine
from mtcommission.base.errors import ComputationError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.kinds import STATE_SPACE
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.commissioning_rule import apply_commissioning_rule
from mtcommission.limits.judge import Candidate, evaluate
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.robustness import respond_varied
from mtcommission.study.rules import compare_shapers

GRID = 10
"""Points of the brute force in each direction."""
LEAST_SHARE = 0.02
"""Its least acceleration as a share of F_max/m."""
JERK_TIMES = (0.5e-3, 0.2)
"""Its jerk times [s]."""
TRIES = 25
"""Points of the grid that are judged, soonest first, until one meets everything."""

SEARCH = "our limits (search)"
RULE = "our rule (by hand)"
BRUTE = f"brute force, {GRID} x {GRID} grid"


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """One source of limits on one machine.

    Parameters
    ----------
    seed
        Of the machine.
    source
        Whose limits.
    is_met
        Whether all requirements hold in every corner.
    settling_time
        Worst over moves and corners [s].
    seconds
        Processor time to find the limits [s].
    """

    seed: int
    source: str
    is_met: bool
    settling_time: float
    seconds: float


def score_machine(seed: int) -> list[Score]:
    """Return all sources on one machine; none if its loop cannot be tuned."""
    machine = random_machine(seed)
    plant = build_plant(machine)
    try:
        tuned = tune_loop(machine)
    except ComputationError:
        return []
    scores = []

    def note(source: str, candidate: Candidate, seconds: float) -> None:
        scores.append(
            Score(
                seed=seed,
                source=source,
                is_met=candidate.assessment.is_met,
                settling_time=candidate.settling_time,
                seconds=seconds,
            )
        )

    start = process_time()
    searched = choose_limits(machine, tuned).limits
    taken = process_time() - start
    note(SEARCH, evaluate(machine, tuned, searched), taken)
    start = process_time()
    by_hand = apply_commissioning_rule(machine, tuned).limits
    taken = process_time() - start
    note(RULE, evaluate(machine, tuned, by_hand), taken)
    for rule in apply_rules_of_thumb(machine, plant):
        name = Catalogue().say(rule.name).split(" (")[0]
        note(name, evaluate(machine, tuned, rule.limits), 0.0)
    start = process_time()
    free = replace(machine, control=replace(machine.control, kind=STATE_SPACE))  # has all shapers
    shaped = compare_shapers(free, tuned)
    taken = (process_time() - start) / len(shaped)
    for candidate in shaped:
        note(Catalogue().say(candidate.name or "").split(" (")[0], candidate, taken)
    start = process_time()
    best = search_by_grid(machine, plant, tuned)
    note(BRUTE, best, process_time() - start)
    return scores


def search_by_grid(machine: Machine, plant: Plant, tuned: TunedLoop) -> Candidate:
    """Return the soonest point of a plain grid that meets all requirements, else the last tried."""
    largest = machine.drive.motion_force / moving_mass(machine)
    points = []
    for a in largest * np.geomspace(1.0, LEAST_SHARE, GRID):
        for jerk_time in np.geomspace(*JERK_TIMES, GRID):
            limits = MotionLimits(acceleration=float(a), jerk=float(a / jerk_time))
            found = respond_varied(machine, tuned, limits, tuned.corners)
            is_missed = bool(found.is_missed.any())
            points.append((is_missed, float(found.settling_time.max()), limits))
    points.sort(key=lambda point: point[:2])
    for _, _, limits in points[:TRIES]:
        candidate = evaluate(machine, tuned, limits)
        if candidate.assessment.is_met:
            break
    return candidate


def score_population(count: int, *, workers: int) -> Iterator[Score]:
    """Yield the scores of the machines with seeds 0 ... count - 1, machine by machine."""
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for scores in pool.map(score_machine, range(count)):
            yield from scores


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """One source over the population.

    Parameters
    ----------
    source
        Whose limits.
    machines
        On how many machines it gave limits.
    share_met
        Share of machines on which all requirements are met [-], of those on which anything meets
        them.
    ratio, ratio_high
        Settling time over that of our search where both meet: median and 95 % quantile [-].
    sooner
        Share of machines on which it meets and settles sooner than our search by over 0.5 % [-].
    seconds
        Median processor time to find the limits [s].
    """

    source: str
    machines: int
    share_met: float
    ratio: float
    ratio_high: float
    sooner: float
    seconds: float


def rank(scores: Sequence[Score]) -> list[Standing]:
    """Return all sources, those that meet the requirements most often first."""
    possible = {score.seed for score in scores if score.is_met}
    ours = {score.seed: score for score in scores if score.source == SEARCH}
    standings = []
    for source in dict.fromkeys(score.source for score in scores):
        rows = [score for score in scores if score.source == source and score.seed in possible]
        ratios = list(_ratios(rows, ours))
        standings.append(
            Standing(
                source=source,
                machines=len(rows),
                share_met=sum(row.is_met for row in rows) / max(len(rows), 1),
                ratio=median(ratios) if ratios else nan,
                ratio_high=float(np.quantile(ratios, 0.95)) if ratios else nan,
                sooner=sum(ratio < 0.995 for ratio in ratios) / max(len(rows), 1),
                seconds=median(row.seconds for row in rows) if rows else nan,
            )
        )
    return sorted(standings, key=lambda item: (-item.share_met, item.ratio))


def _ratios(rows: Sequence[Score], ours: dict[int, Score]) -> Iterator[float]:
    for row in rows:
        own = ours[row.seed]
        if row.is_met and own.is_met:
            yield row.settling_time / own.settling_time
