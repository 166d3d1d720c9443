"""Sweeps over F_max of the paper's machine: time, certificates and memory over the number of cases.

    python -m benchmarks.sweep [--largest N] [--workers N] [--limits N]

Each size runs in a process of its own, so that the peak of its memory is its own; whole commands
are measured besides, with start-up, files and page. Processor time is that of the process and its
workers: on a busy machine it says more than the clock.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from mtcommission.sweep.engine import run_sweep
from mtcommission.sweep.lanes import Engine
from mtcommission.sweep.plan import Plan, Quantity, read_axis
from mtcommission.sweep.table import read_table

PAPER = Path(__file__).parent.parent / "profiles" / "milling-manipulator.toml"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    quantity: str
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
    if is_optimal:
        check(frame)
    return Row(
        quantity=quantity.value,
        count=count,
        wall=wall,
        processor=here.ru_utime + here.ru_stime + below.ru_utime + below.ru_stime,
        megabytes=(here.ru_maxrss + below.ru_maxrss) / 1024,
        passed=int(frame["certified" if is_optimal else "requirements_met"].sum() or 0),
        largest_gap=float(frame["relative_gap"].max()),  # type: ignore[arg-type]
    )


def measure_command(count: int, workers: int, quantity: Quantity) -> Row:
    """The whole command, as a user types it."""
    forces = f"log:300:20e3:{count}" if count > 1 else "2000"
    options = ["--f-max", forces, "--quantity", quantity.value, "--workers", str(workers)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        line = [sys.executable, "-m", "mtcommission", "sweep", str(PAPER), *options, "-o", folder]
        subprocess.run(line, check=True, stdout=subprocess.DEVNULL)
        wall = time.perf_counter() - start
        frame = pl.read_parquet(Path(folder) / "rows.parquet")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    is_optimal = quantity is Quantity.OPTIMAL
    return Row(
        quantity=f"{quantity.value}, whole command",
        count=count,
        wall=wall,
        processor=spent,
        megabytes=after.ru_maxrss / 1024,
        passed=int(frame["certified" if is_optimal else "requirements_met"].sum() or 0),
        largest_gap=float(frame["relative_gap"].max()),  # type: ignore[arg-type]
    )


def check(frame: pl.DataFrame) -> None:
    """Every row certified, t_f strictly falling with F_max: else the benchmark is void."""
    if not frame["certified"].all():
        raise SystemExit("a row is not certified")
    if frame["t_f"].diff().drop_nulls().max() >= 0.0:  # type: ignore[operator]
        raise SystemExit("t_f does not fall strictly with F_max")


def report(row: Row) -> None:
    each = 1e3 * row.processor / row.count
    print(
        f"{row.quantity:24s} {row.count:8d} {row.wall:9.2f} {row.processor:9.2f} {each:10.3f}"
        f" {row.megabytes:9.0f} {row.passed:8d} {row.largest_gap:9.1e}",
        flush=True,
    )


WHOLE = 10_000
"""Cases of the whole command that is measured."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=int, default=100_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--limits", type=int, default=0, help="choices of limits to time as well")
    options = parser.parse_args()
    context = multiprocessing.get_context("spawn")
    print(f"{'quantity':24s}    cases  wall [s]   cpu [s]   each [ms]        MB   passed   gap")
    sizes = [size for size in (100, 1000, 10_000, 100_000) if size <= options.largest]
    jobs = [(size, options.workers, Quantity.OPTIMAL) for size in sizes]
    if options.limits:
        jobs.append((options.limits, options.workers, Quantity.LIMITS))
    commands = [(1, 1, Quantity.OPTIMAL), (1, 1, Quantity.LIMITS)]
    if options.largest >= WHOLE:
        commands.append((WHOLE, options.workers, Quantity.OPTIMAL))
    for command in commands:
        report(measure_command(*command))
    for job in jobs:
        # Not a Pool: its workers may have no children of their own.
        with ProcessPoolExecutor(1, mp_context=context) as executor:
            report(executor.submit(measure, *job).result())


if __name__ == "__main__":
    main()
