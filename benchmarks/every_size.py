"""Limits for every size of move: simulated at random sizes, and against a fine grid.

    python -m benchmarks.every_size [--machines N] [--first 0] [--points N] [PROFILE...]

Two questions on shipped profiles and random machines. Does every smaller move keep what is
required? Random sizes between a thousandth and the whole of each move go through Ruckig and the
simulation of every corner, which share nothing with the search but the loop. Is anything sooner?
With ``--points``, a grid of so many accelerations and jerk times, and a fifth as many lengths of a
moving average: what is more than 2 % sooner and seems allowed is judged exactly.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path

import numpy as np

from benchmarks.population import demanding_machine, random_machine
from mtcommission.errors import ComputationError
from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.every.search import Explorer
from mtcommission.limits.every.typed import bound_of
from mtcommission.limits.reserve import keep_reserve
from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.profile.read import read_profile
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.smaller_moves import SMALLEST, resize, size_of
from mtcommission.verdict.assess import assess
from mtcommission.verdict.evaluate import simulate_moves
from mtcommission.verdict.every_size import judge_every_size

PROFILES = Path(__file__).parent.parent / "profiles"
SOONER = 0.98


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    name: str
    is_met: bool
    settling_time: float
    setpoint_filter: str
    excess: float
    where: str
    sooner: float
    processor: float

    def __str__(self) -> str:
        beaten = f"{self.sooner:.3f}" if isfinite(self.sooner) else "-"
        return (
            f"{self.name:24} {'met' if self.is_met else 'not met':8} "
            f"{1e3 * self.settling_time:8.1f} ms {self.setpoint_filter:22} "
            f"worst use {self.excess:6.4f} {self.where:28} sooner {beaten:6} "
            f"{self.processor:5.2f} s"
        )


def measure(machine: Machine, *, sizes: int, points: int, seed: int) -> Row:
    plant, tuned = build_plant(machine), tune_loop(machine)
    begun = time.process_time()
    choice = choose_limits(machine, plant, tuned)
    spent = time.process_time() - begun
    excess, where = simulated(machine, plant, tuned, choice, sizes, seed)
    own = choice.limits.setpoint_filter
    return Row(
        name=machine.name[:24],
        is_met=choice.meets_requirements,
        settling_time=choice.candidate.settling_time,
        setpoint_filter=f"{own.kind} {1e3 * own.duration:.1f} ms" if own else "none",
        excess=excess,
        where=where,
        sooner=soonest_of_grid(machine, plant, tuned, choice, points),
        processor=spent,
    )


def simulated(
    machine: Machine, plant: Plant, tuned: TunedLoop, choice: Choice, count: int, seed: int
) -> tuple[float, str]:
    """Largest use of any requirement at random sizes, settling time apart, and where."""
    generator, worst = np.random.default_rng(seed), (0.0, "")
    if not choice.meets_requirements:
        return worst
    for share in SMALLEST ** generator.uniform(0.0, 1.0, count):
        moves = tuple(resize(move, share * size_of(move)) for move in machine.moves)
        needs = replace(machine.requirements, every_size=False)
        small = replace(machine, moves=moves, requirements=needs)
        rows = [result.responses for result in simulate_moves(small, tuned, choice.limits)]
        for check in assess(small, plant, tuned.corners, rows).checks:
            if check.name != "settling time":
                worst = max(worst, (check.value / check.limit, f"{check.name} at {share:.4f}"))
    return worst


def soonest_of_grid(
    machine: Machine, plant: Plant, tuned: TunedLoop, choice: Choice, points: int
) -> float:
    """Settling time of the soonest allowed limits of the grid by ours, if below 1; else nan."""
    if not points or not choice.meets_requirements:
        return np.nan
    strict = machine if choice.reserve_used else keep_reserve(machine)
    explorer = Explorer.about(strict, plant, tuned)
    a = strict.drive.motion_force / moving_mass(machine) * np.geomspace(0.02, 1.0, points)
    T_p, best = machine.control.position_cycle, np.nan
    averages = np.unique(np.round(np.geomspace(1.0, 0.15 / T_p, points // 5)))
    tau = tuned.controller.reference_delay
    latest = SOONER * choice.candidate.settling_time - tau
    for item in (None, *(moving_average(n * T_p) for n in averages)):
        for jerk_time in np.geomspace(0.5e-3, 0.3, points):
            duration = explorer.durations(item, a, jerk_time)
            for i in np.flatnonzero(duration <= latest):
                if explorer.share(item, float(a[i]), jerk_time, enough=1.0) > 1.0:
                    continue
                limits = MotionLimits(
                    acceleration=float(a[i]), jerk=float(a[i] / jerk_time), setpoint_filter=item
                )
                checks = judge_every_size(strict, plant, tuned, limits)
                if all(c.value <= bound_of(strict, c.requirement) for c in checks):
                    latest = float(duration[i])
                    best = (latest + tau) / choice.candidate.settling_time
    return float(best)


def machines(names: list[str], count: int, first: int) -> Iterator[tuple[int, Machine]]:
    for name in names:
        yield 0, read_profile(PROFILES / f"{name}.toml")
    for seed in range(first, first + count):
        machine = random_machine(seed) if seed % 2 else demanding_machine(seed)
        yield (
            seed,
            replace(
                machine,
                requirements=replace(machine.requirements, every_size=True),
                control=replace(machine.control, seeks_setpoint_filter=True),
            ),
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("profiles", nargs="*")
    parser.add_argument("--machines", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--sizes", type=int, default=40)
    parser.add_argument("--points", type=int, default=0)
    options = parser.parse_args()
    rows = []
    for seed, machine in machines(options.profiles, options.machines, options.first):
        try:
            row = measure(machine, sizes=options.sizes, points=options.points, seed=seed)
        except ComputationError as error:
            print(f"{machine.name[:24]:24} {error.outcome.name}")
            continue
        rows.append(row)
        print(row, flush=True)
    met = [row for row in rows if row.is_met]
    beyond, beaten = (row.excess > 1.005 for row in met), (row.sooner < SOONER for row in met)
    print(
        f"{len(rows)} machines, {len(met)} met; beyond 1.005: {sum(beyond)}; beaten: {sum(beaten)}"
    )


if __name__ == "__main__":
    main()
