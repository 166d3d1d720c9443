"""The search for limits against brute force, and what it costs.

    python -m benchmarks.choose [--points 300] [--machines 20] [--output docs/benchmarks-search.md]
    python -m benchmarks.choose --verdicts 2000 [--first 0]

Brute force as the issue states it: a from 5 % to 100 % of F_max/m, a/j from 0.5 ms to three periods
of the slowest mode, both logarithmic, the response seen at every velocity cycle, the same gains.
To be found are limits that settle more than 2 % sooner, so what has already lasted longer than
98 % of our settling time (the setpoint alone, or in one corner) is not followed further; that
leaves nothing out.

``--verdicts`` looks for false ones on machines that are asked for everything at once: a "met" that
a fresh simulation does not confirm, and a "not met" where limits 1 % gentler, or any of a coarse
grid, meet everything.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from math import inf, isfinite
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from mtcommission.loop.batch.extremes import find_extremes
from mtcommission.loop.batch.response import simulate_limits_batched
from mtcommission.loop.batch.settling import settle
from mtcommission.loop.batch.tables import build_tables
from numpy.typing import NDArray

from benchmarks.population import demanding_machine, random_machine
from mtcommission.errors import ComputationError
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.optima import condense_optima, find_optima
from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.machine import Machine, Move, moving_mass
from mtcommission.machine.variations import as_variations
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.profile.read import read_profile
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import (
    JerkSteps,
    filter_steps,
    jerk_steps,
    plan_setpoint,
)
from mtcommission.verdict.evaluate import evaluate

PROFILES = Path(__file__).parent.parent / "profiles"
SOONER = 0.98
SLICE = 3000


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    name: str
    corners: int
    moves: int
    is_met: bool
    settling_time: float
    best_other: float
    looked_at: int
    processor: float

    @property
    def is_beaten(self) -> bool:
        return self.best_other < SOONER * self.settling_time


def measure(machine: Machine, points: int) -> Row:
    plant, tuned = build_plant(machine), tune_loop(machine)
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    starts = [limits for _, limits in condense_optima(machine, plant, optima)]
    begun = time.process_time()
    choice = choose_limits(machine, plant, tuned, starts=starts)
    spent = time.process_time() - begun
    ours = evaluate(machine, plant, tuned, choice.limits)
    met = ours.assessment.is_met
    latest = ours.settling_time if isfinite(ours.settling_time) else inf
    limits = candidates(machine, tuned, points, SOONER * latest)
    best = brute_force(machine, plant, tuned, limits, latest=SOONER * latest, met=met)
    return Row(
        name=machine.name,
        corners=len(tuned.corners),
        moves=len(machine.moves),
        is_met=met,
        settling_time=ours.settling_time,
        best_other=best,
        looked_at=len(limits),
        processor=spent,
    )


def candidates(
    machine: Machine, tuned: TunedLoop, points: int, latest: float
) -> NDArray[np.float64]:
    """(a, a/j) whose setpoints end soon enough, shape (n, 2)."""
    a_max = machine.drive.motion_force / moving_mass(machine)
    plant = build_plant(machine)
    period = max(1.0 / mode.frequency_hz for mode in plant.modes)
    a = np.geomspace(0.05 * a_max, a_max, points)
    t = np.geomspace(0.5e-3, 3.0 * period, points)
    pairs = np.array([axis.ravel() for axis in np.meshgrid(a, t, indexing="ij")]).T
    ends = np.max([steps_of(machine, move, pairs).duration for move in machine.moves], axis=0)
    soon: NDArray[np.float64] = pairs[ends + tuned.controller.reference_delay <= latest]
    return soon


def steps_of(machine: Machine, move: Move, pairs: np.ndarray) -> JerkSteps:
    steps = jerk_steps(move, acceleration=pairs[:, 0], jerk=pairs[:, 0] / pairs[:, 1])
    return filter_steps(steps, machine.control.setpoint_filter)


def brute_force(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    pairs: np.ndarray,
    *,
    latest: float,
    met: bool,
) -> float:
    """Least settling time below ``latest``; inf if there is none.

    With ``met`` all requirements must hold, else those on force and peaks.
    """
    if not len(pairs):
        return inf
    settling = np.zeros(len(pairs))
    for move in machine.moves:
        steps = steps_of(machine, move, pairs)
        longest = float(steps.duration.max())
        for loop in tuned.loops:
            tables = build_tables(loop, longest=longest, order=steps.order)
            alive = np.flatnonzero(settling <= latest)
            for part in slices(alive):
                band = machine.requirements.tcp_deviation
                found = settle(tables, steps_of(machine, move, pairs[part]), band=band)
                missed = met & (found.residual_deviation > band)
                late = np.where(missed, inf, found.settling_time)
                settling[part] = np.maximum(settling[part], late)
    good = np.flatnonzero(settling <= latest)
    order = good[np.argsort(settling[good], kind="stable")]
    for part in slices(order, 100):
        fits = keeps_bounds(machine, plant, tuned, pairs[part])
        if fits.any():
            return float(settling[part[fits][0]])
    return inf


def slices(places: np.ndarray, size: int = SLICE) -> Iterator[np.ndarray]:
    for start in range(0, len(places), size):
        yield places[start : start + size]


def keeps_bounds(machine: Machine, plant: Plant, tuned: TunedLoop, pairs: np.ndarray) -> np.ndarray:
    n, needs, drive = plant.order, machine.requirements, machine.drive
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])
    signals = np.array([np.eye(n + 3)[2], *(outputs @ plant.row(p.name) for p in needs.peaks)])
    bounds = np.array([drive.motion_force, *(peak.bound for peak in needs.peaks)])
    fits = np.ones(len(pairs), dtype=bool)
    for move in machine.moves:
        for loop in tuned.loops:
            found = find_extremes(
                loop,
                steps_of(machine, move, pairs),
                signals=signals,
                dwell=move.dwell,
                tail=0.1,
                static_load=drive.static_load,
            )
            fits &= np.all(found.peaks <= bounds, axis=1)
            fits &= found.rms_force <= drive.continuous_force
    return fits


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
        choice = choose_limits(machine, plant, tuned)
    except ComputationError:
        return None
    spent = time.process_time() - begun

    def meets(limits: MotionLimits) -> bool:
        return evaluate(machine, plant, tuned, limits).assessment.is_met

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
    places = as_variations(tuned.corners)
    for share in GRID_SHARES:
        for jerk_time in GRID_TIMES:
            a = float(largest * share)
            limits = MotionLimits(acceleration=a, jerk=a / float(jerk_time))
            longest = max(plan_setpoint(move, limits).duration for move in machine.moves)
            if longest > min(machine.requirements.max_settling_time, LONGEST):
                continue
            found = simulate_limits_batched(machine, plant, tuned, limits, variations=places)
            if found.meets(machine).all():
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


HEAD = (
    "| machine | corners x moves | met | settles [ms] | grid's best [ms] | sooner by | "
    "grid looked at | search, CPU [s] |\n|---|---|---|---|---|---|---|---|"
)


def describe(row: Row, points: int) -> str:
    other = f"{1e3 * row.best_other:.2f}" if isfinite(row.best_other) else "none"
    gain = f"{100 * (1 - row.best_other / row.settling_time):.1f} %" if row.is_beaten else "-"
    return (
        f"| {row.name} | {row.corners} x {row.moves} | {'yes' if row.is_met else 'no'} | "
        f"{1e3 * row.settling_time:.2f} | {other} | {gain} | "
        f"{100 * row.looked_at / points**2:.0f} % | {row.processor:.2f} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=300)
    parser.add_argument("--machines", type=int, default=20, help="random ones, besides profiles/")
    parser.add_argument("--output", type=Path, default=None, help="Markdown file for the table")
    parser.add_argument("--verdicts", type=int, default=0, help="demanding machines, instead")
    parser.add_argument("--first", type=int, default=0, help="seed of the first of them")
    options = parser.parse_args()
    if options.verdicts:
        survey_verdicts(options.first, options.verdicts)
        return
    machines = [read_profile(path) for path in sorted(PROFILES.glob("*.toml"))]
    machines += [random_machine(seed) for seed in range(options.machines)]
    lines, rows = [HEAD], []
    print(HEAD)
    for machine in machines:
        rows.append(measure(machine, options.points))
        lines.append(describe(rows[-1], options.points))
        print(lines[-1], flush=True)
    beaten = sum(row.is_beaten for row in rows)
    lines += [
        "",
        f"Of {len(rows)} machines brute force ({options.points} x {options.points}) settles more "
        f"than 2 % sooner on {beaten}. CPU time of the search: median "
        f"{np.median([row.processor for row in rows]):.2f} s, largest "
        f"{max(row.processor for row in rows):.2f} s.",
    ]
    print("\n".join(lines[-2:]))
    if options.output:
        title = "# Search for limits against brute force\n\n`python -m benchmarks.choose`\n\n"
        options.output.write_text(title + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
