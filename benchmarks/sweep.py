"""Sweeps over F_max of the paper's machine: time, certificates and memory over the number of cases.

Run as ``python -m benchmarks.sweep [--largest N] [--workers N] [--limits N] [--output docs]``,
which renews the head of benchmarks-sweep.md, down to its picture, and benchmarks-sweep.svg.
Each size runs in a process of its own, so that the peak of its memory is its own; whole commands
are measured besides, with start-up, files and page. Processor time is that of the process and its
workers: on a busy machine it says more than the clock.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import date
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


HEAD = (
    "| quantity | cases | wall [s] | CPU [s] | CPU per case [ms] | peak memory [MB] | "
    "certified or met | worst gap |\n|---|---|---|---|---|---|---|---|"
)


def describe(row: Row) -> str:
    return (
        f"| {row.quantity} | {row.count} | {row.wall:.1f} | {row.processor:.1f} | "
        f"{1e3 * row.processor / row.count:.3g} | {row.megabytes:.0f} | {row.passed} | "
        f"{row.largest_gap:.0e} |"
    )


PICTURE = "![Time and memory](benchmarks-sweep.svg)"


def write(rows: list[Row], workers: int, folder: Path) -> None:
    lines = [
        "# Sweeps: time and memory over the number of cases",
        "",
        "`python -m benchmarks.sweep --limits N --output docs`, the paper's machine over F_max: "
        "300 N to 20 kN for `optimal`, 1 to 4 kN for `limits`.",
        f"{workers} workers, Python {platform.python_version()}, {date.today().isoformat()}; CPU "
        f"time includes start-up of every process. Load of the machine meanwhile: "
        f"{os.getloadavg()[1]:.1f} on {os.cpu_count()} cores, so compare CPU time, not the clock.",
        "",
        HEAD,
        *map(describe, rows),
        "",
        "Every `optimal` row is certified and t_f falls strictly with F_max, else the benchmark "
        "stops. Memory is the sum of the parent's and the largest worker's peak; of whole commands "
        "the largest process's of all before.",
        "",
    ]
    path = folder / "benchmarks-sweep.md"
    # What stands behind the picture is written by hand.
    kept = path.read_text(encoding="utf-8").partition(PICTURE)[2] if path.exists() else "\n"
    path.write_text("\n".join(lines) + "\n" + PICTURE + kept, encoding="utf-8")
    optimal = [row for row in rows if row.quantity == Quantity.OPTIMAL.value]
    plot(optimal, str(folder / "benchmarks-sweep.svg"))


def report(row: Row) -> None:
    each = 1e3 * row.processor / row.count
    print(
        f"{row.quantity:24s} {row.count:8d} {row.wall:9.2f} {row.processor:9.2f} {each:10.3f}"
        f" {row.megabytes:9.0f} {row.passed:8d} {row.largest_gap:9.1e}",
        flush=True,
    )


def plot(rows: list[Row], file: str) -> None:
    import matplotlib.pyplot as plt  # would count as start-up of every measured process

    figure, (times, memory) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
    counts = [row.count for row in rows]
    times.loglog(counts, [row.processor for row in rows], "o-")
    times.set(xlabel="cases", ylabel="processor time [s]")
    memory.semilogx(counts, [row.megabytes for row in rows], "o-")
    memory.set(xlabel="cases", ylabel="peak memory [MB]", ylim=(0, None))
    figure.savefig(file, metadata={"Date": None})


WHOLE = 10_000
"""Cases of the whole command that is measured."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=int, default=100_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--limits", type=int, default=0, help="choices of limits to time as well")
    parser.add_argument("--output", type=Path, default=None, help="folder for table and plot")
    options = parser.parse_args()
    context = multiprocessing.get_context("spawn")
    print(f"{'quantity':24s}    cases  wall [s]   cpu [s]   each [ms]        MB   passed   gap")
    sizes = [size for size in (100, 1000, 10_000, 100_000) if size <= options.largest]
    jobs = [(size, options.workers, Quantity.OPTIMAL) for size in sizes]
    if options.limits:
        jobs.append((options.limits, options.workers, Quantity.LIMITS))
    rows = []
    commands = [(1, 1, Quantity.OPTIMAL), (1, 1, Quantity.LIMITS)]
    if options.largest >= WHOLE:
        commands.append((WHOLE, options.workers, Quantity.OPTIMAL))
    for command in commands:
        rows.append(measure_command(*command))
        report(rows[-1])
    for job in jobs:
        # Not a Pool: its workers may have no children of their own.
        with ProcessPoolExecutor(1, mp_context=context) as executor:
            rows.append(executor.submit(measure, *job).result())
        report(rows[-1])
    if options.output:
        write(rows, options.workers, options.output)


if __name__ == "__main__":
    main()
