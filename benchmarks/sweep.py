"""Sweeps over F_max of the paper's machine: time, certificates and memory over the number of cases.

Run as ``python -m benchmarks.sweep [--largest N] [--workers N] [--limits N] [--plot FILE.svg]``.
Each size runs in a process of its own, so that the peak of its memory is its own. Processor time
is that of the process and its workers: on a busy machine it says more than the clock.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt

from mtcommission.sweep.cases import Plan, Quantity, read_axis
from mtcommission.sweep.engine import Engine, run_sweep
from mtcommission.sweep.table import read_table

PAPER = Path(__file__).parent.parent / "profiles" / "milling-manipulator.toml"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    count: int
    wall: float
    processor: float
    megabytes: float
    passed: int
    largest_gap: float


def measure(count: int, workers: int, quantity: Quantity) -> Row:
    axis = read_axis(f"drive.max_force=log:300:20e3:{count}", where="benchmark")
    if quantity is Quantity.LIMITS:
        axis = read_axis(f"drive.max_force=1000:4000:{count}", where="benchmark")
    plan = Plan(
        profile_text=PAPER.read_text(encoding="utf-8"),
        where=PAPER.name,
        axes=(axis,),
        quantity=quantity,
    )
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        store = run_sweep(plan, folder=Path(folder), engine=Engine(workers=workers))
        wall = time.perf_counter() - start
        here = resource.getrusage(resource.RUSAGE_SELF)
        below = resource.getrusage(resource.RUSAGE_CHILDREN)
        frame = read_table(plan, store).frame
    is_optimal = quantity is Quantity.OPTIMAL
    return Row(
        count=count,
        wall=wall,
        processor=here.ru_utime + here.ru_stime + below.ru_utime + below.ru_stime,
        megabytes=(here.ru_maxrss + below.ru_maxrss) / 1024,
        passed=int(frame["certified" if is_optimal else "requirements_met"].sum() or 0),
        largest_gap=float(frame["relative_gap"].max()) if is_optimal else 0.0,  # type: ignore[arg-type]
    )


def report(row: Row) -> None:
    each = 1e3 * row.processor / row.count
    print(
        f"{row.count:8d} {row.wall:9.2f} {row.processor:9.2f} {each:10.3f}"
        f" {row.megabytes:9.0f} {row.passed:8d} {row.largest_gap:9.1e}",
        flush=True,
    )


def plot(rows: list[Row], file: str) -> None:
    figure, (times, memory) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
    counts = [row.count for row in rows]
    times.loglog(counts, [row.processor for row in rows], "o-")
    times.set(xlabel="cases", ylabel="processor time [s]")
    memory.semilogx(counts, [row.megabytes for row in rows], "o-")
    memory.set(xlabel="cases", ylabel="peak memory [MB]", ylim=(0, None))
    figure.savefig(file)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=int, default=100_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--limits", type=int, default=0, help="choices of limits to time as well")
    parser.add_argument("--plot", default="")
    options = parser.parse_args()
    context = multiprocessing.get_context("spawn")
    print("   cases  wall [s]   cpu [s]  cpu/case [ms]  MB   passed  worst gap")
    sizes = [size for size in (100, 1000, 10_000, 100_000) if size <= options.largest]
    jobs = [(size, options.workers, Quantity.OPTIMAL) for size in sizes]
    if options.limits:
        jobs.append((options.limits, options.workers, Quantity.LIMITS))
    rows = []
    for job in jobs:
        # Not a Pool: its workers may have no children of their own.
        with ProcessPoolExecutor(1, mp_context=context) as executor:
            rows.append(executor.submit(measure, *job).result())
        report(rows[-1])
    if options.plot:
        plot(rows[: len(sizes)], options.plot)


if __name__ == "__main__":
    main()
