"""Time of one certified time-optimal control; other tools beside it: ``benchmarks.race``.

Run as ``python -m benchmarks.time_optimal [--count N] [--modes N ...] [--passes N]
[--followers N]`` with OMP_NUM_THREADS=1. The cases are the survey of the
documentation: 60 for each number of modes. With several passes each case counts with its best,
which is what it takes on a quiet core; every pass builds its plants anew, so that nothing about
them is known. The certified control does not need the exact peaks of the signals; what reading them
adds is printed, too.
``--followers`` adds that many of the random axes of ``benchmarks.printers``, whose motor follows.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.printers import random_axis
from mtcommission.base.errors import ComputationError
from mtcommission.limits.optima import find_time_optimum
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.profile.read import parse_profile
from mtcommission.optimal.control import TimeOptimum
from mtcommission.optimal.free import solve_time_optimal
from tests.machines import paper_machine, random_modal_machine


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """Times of certified solves [s, CPU], the worst gap and terminal error against each peak.

    ``with_peaks`` are the times until the peaks are read, too.
    """

    case: str
    times: tuple[float, ...]
    with_peaks: tuple[float, ...]
    gap: float
    error: float
    outcomes: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    plant: Plant
    move: Move
    force_limit: float
    solve: Callable[..., TimeOptimum] = solve_time_optimal


def paper_problems(repeat: int) -> list[Problem]:
    """Different forces each time, so that nothing can be remembered."""
    plant, move = build_plant(paper_machine()), VelocityStep(velocity_step=0.1)
    return [
        Problem(plant=plant, move=move, force_limit=float(factor) * 2e3)
        for factor in np.linspace(0.8, 1.25, repeat)
    ]


def random_problems(n_modes: int, count: int) -> list[Problem]:
    """Random machines, both kinds of move, five decades of force."""
    problems = []
    for seed in range(count):
        machine = random_modal_machine(seed, n_modes=n_modes)
        distance = (1e-3, 0.02, 0.5)[seed % 3]
        move = machine.moves[0] if seed % 2 else Positioning(distance=distance)
        force = machine.drive.max_force * 10.0 ** (seed % 5 - 2)
        problems.append(Problem(plant=build_plant(machine), move=move, force_limit=force))
    return problems


def follower_problems(kind: str, count: int) -> list[Problem]:
    """Axes whose motor follows, by the program's own door."""
    problems = []
    for seed in range(count):
        axis = random_axis(seed)
        plant = build_plant(parse_profile(axis.profile, where=f"axis {seed}"))
        moves: dict[str, Move] = {
            "follower, v_max": Positioning(distance=axis.distance, max_velocity=axis.velocity),
            "follower, free": Positioning(distance=axis.distance),
            "follower, step": VelocityStep(velocity_step=axis.velocity),
        }
        solve = partial(find_time_optimum, bounds=())
        limit = axis.largest
        problems.append(Problem(plant=plant, move=moves[kind], force_limit=limit, solve=solve))
    return problems


def measure(case: str, build: Callable[[], list[Problem]], *, passes: int) -> Row:
    """CPU time, not the clock's: other processes must not count."""
    rows = [measure_once(case, build()) for _ in range(passes)]
    last = rows[-1]
    return Row(
        case=case,
        times=best(row.times for row in rows),
        with_peaks=best(row.with_peaks for row in rows),
        gap=last.gap,
        error=last.error,
        outcomes=last.outcomes,
    )


def best(passes: Iterable[tuple[float, ...]]) -> tuple[float, ...]:
    """Each case counts with its best pass."""
    return tuple(min(times) for times in zip(*passes, strict=True))


def measure_once(case: str, problems: list[Problem]) -> Row:
    times, with_peaks, gaps, errors, outcomes = [], [], [0.0], [0.0], []
    for one in problems:
        start = time.process_time()
        try:
            optimum = one.solve(one.plant, one.move, force_limit=one.force_limit)
        except ComputationError as error:
            outcomes.append(str(error))
            continue
        times.append(time.process_time() - start)
        peaks = optimum.peaks[: one.plant.order]
        with_peaks.append(time.process_time() - start)
        gaps.append(optimum.certificate.relative_gap)
        errors.append(float(np.max(np.abs(optimum.terminal_error) / peaks)))
        if not optimum.certificate.switching_law_holds:
            outcomes.append("switching law not confirmed")
        if optimum.method != "exact":
            outcomes.append(optimum.method)
    return Row(
        case=case,
        times=tuple(times),
        with_peaks=tuple(with_peaks),
        gap=max(gaps),
        error=max(errors),
        outcomes=tuple(outcomes),
    )


def print_row(row: Row) -> None:
    times = 1e3 * np.array(row.times)
    print(
        f"{row.case:18s} {times.size:5d} {np.median(times):8.2f} {np.quantile(times, 0.9):8.2f} "
        f"{times.max():8.2f} {1e3 * np.median(row.with_peaks):11.2f} {row.gap:10.1e} "
        f"{row.error:10.1e}"
    )
    for outcome in row.outcomes:
        print(f"    {outcome}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--modes", type=int, nargs="*", default=list(range(1, 9)))
    parser.add_argument("--passes", type=int, default=1)
    parser.add_argument("--followers", type=int, default=0)
    arguments = parser.parse_args()
    print("CPU time [ms]; gap against t_f; terminal error against each state's peak")
    print(f"{'case':18s} {'cases':>5s} {'median':>8s} {'90 %':>8s} {'most':>8s}", end="")
    print(f" {'with peaks':>11s} {'gap':>10s} {'error':>10s}")
    measure_once("", paper_problems(3))
    passes = arguments.passes
    print_row(measure("2 modes (paper)", partial(paper_problems, arguments.count), passes=passes))
    for n_modes in arguments.modes:
        build = partial(random_problems, n_modes, arguments.count)
        print_row(measure(f"{n_modes} modes", build, passes=passes))
    for kind in ("follower, free", "follower, step", "follower, v_max"):
        build = partial(follower_problems, kind, arguments.followers)
        if arguments.followers:
            print_row(measure(kind, build, passes=passes))


if __name__ == "__main__":
    main()
