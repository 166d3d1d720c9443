"""Verdicts on machines that are asked for everything at once: are any of them false?

    python -m benchmarks.choose [--machines 2000] [--first 0]

A "met" that a fresh simulation does not confirm, and a "not met" where limits 1 % gentler, or any
of a coarse grid, meet everything. Whether anything is sooner asks ``benchmarks.every_size``.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np

from benchmarks.population import demanding_machine
from mtcommission.base.errors import ComputationError
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.judge import evaluate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import (
    plan_setpoint,
)
from mtcommission.study.robustness import respond_varied


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictRow:
    """What the search said of one machine, and who knows better."""

    seed: int
    is_met: bool
    reserve_used: bool
    false_met: bool
    gentler: MotionLimits | None
    on_grid: MotionLimits | None
    processor: float


GENTLER = ((0.99, 0.99), (0.99, 1.0), (1.0, 0.99))
GRID_SHARES, GRID_TIMES = np.geomspace(0.01, 1.0, 12), np.geomspace(1e-3, 0.3, 12)
LONGEST = 2.0
"""Longest motion of the coarse grid [s]: beyond it each simulation takes seconds."""


def examine_verdict(seed: int, *, grid: bool = True) -> VerdictRow | None:
    """Return whether the verdict on a demanding machine is true; None if it has no loop."""
    machine = demanding_machine(seed)
    plant = build_plant(machine)
    try:
        tuned = tune_loop(machine)
        begun = time.process_time()
        choice = choose_limits(machine, tuned)
    except ComputationError:
        return None
    spent = time.process_time() - begun

    def meets(limits: MotionLimits) -> bool:
        return evaluate(machine, tuned, limits).assessment.is_met

    gentler = on_grid = None
    a, j = choice.limits.acceleration, choice.limits.jerk
    if not choice.meets_requirements:
        near = (MotionLimits(acceleration=f * a, jerk=g * j) for f, g in GENTLER)
        gentler = next(filter(meets, near), None)
        if grid:
            on_grid = next(filter(meets, promising(machine, plant, tuned)), None)
    return VerdictRow(
        seed=seed,
        is_met=choice.meets_requirements,
        reserve_used=choice.reserve_used,
        false_met=choice.meets_requirements and not meets(choice.limits),
        gentler=gentler,
        on_grid=on_grid,
        processor=spent,
    )


def promising(machine: Machine, plant: Plant, tuned: TunedLoop) -> Iterator[MotionLimits]:
    """Limits of a coarse grid that seem to meet everything, known to no search."""
    largest = machine.drive.motion_force / moving_mass(machine)
    for share in GRID_SHARES:
        for jerk_time in GRID_TIMES:
            a = float(largest * share)
            limits = MotionLimits(acceleration=a, jerk=a / float(jerk_time))
            longest = max(plan_setpoint(move, limits).duration for move in machine.moves)
            if longest > min(machine.requirements.max_settling_time, LONGEST):
                continue
            found = respond_varied(machine, tuned, limits, tuned.corners)
            if not found.is_missed.any():
                yield limits


def survey_verdicts(first: int, count: int) -> None:
    rows = []
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        for row in pool.map(examine_verdict, range(first, first + count)):
            if row is None:
                continue
            rows.append(row)
            if row.false_met or row.gentler or row.on_grid:
                print(row, flush=True)
    print(
        f"{len(rows)} machines: {sum(row.is_met for row in rows)} met, "
        f"{sum(row.reserve_used for row in rows)} of them with the reserve; "
        f"false met {sum(row.false_met for row in rows)}, not met though 1 % gentler limits meet "
        f"all {sum(row.gentler is not None for row in rows)}, though some of a grid do "
        f"{sum(row.on_grid is not None for row in rows)}; search, CPU: median "
        f"{np.median([row.processor for row in rows]):.2f} s, "
        f"largest {max(row.processor for row in rows):.2f} s"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--machines", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, help="seed of the first of them")
    options = parser.parse_args()
    survey_verdicts(options.first, options.machines)


if __name__ == "__main__":
    main()
