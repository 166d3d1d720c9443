"""Whole jobs as a user meets them: processor time, memory, and where the time goes."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from math import nan
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from time import process_time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mtcommission.base.messages.message import Message

PROFILE = Path(__file__).parent.parent / "profiles" / "milling-manipulator.toml"

SWEEPS = (30, 100, 300, 1000)
"""Cases of the sweeps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One job.

    Parameters
    ----------
    name, group
        Of the table, and which table.
    seconds
        Processor time, median [s].
    low, high
        Least and most of the repetitions [s].
    megabytes
        Peak memory [MB]; nan where it is not measured.
    """

    name: str
    group: str
    seconds: float
    low: float
    high: float
    megabytes: float = nan


def all_jobs(*, quick: bool) -> Iterator[Job]:
    """Measure all jobs; the quick ones leave out the sweeps and repeat less."""
    repeats = 2 if quick else 5
    yield from floors(repeats)
    yield cold_run(repeats)
    context = get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        yield from pool.submit(stages, repeats).result()
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        yield from pool.submit(parts, repeats).result()
    if not quick:
        yield from sweeps()


def floors(repeats: int) -> Iterator[Job]:
    """What no program in Python can be faster than, and what the imports add."""
    programs = {
        "interpreter alone": "pass",
        "imports of numpy and scipy's matrix exponential": "import numpy, scipy.linalg",
        "imports of the whole computation": "import mtcommission.commission.commission",
        "imports of the computation and of the sheet": (
            "import mtcommission.commission.commission; "
            "import mtcommission.sheet.html, mtcommission.sheet.pdf"
        ),
    }
    for name, text in programs.items():
        yield _command(name, "floor", ["-c", text], repeats)


def cold_run(repeats: int) -> Job:
    """The whole job from the command line, in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["-m", "mtcommission", "run", str(PROFILE), "-o", folder]
        return _command("mtcommission run (optimum to PDF)", "run", command, repeats)


def _command(name: str, group: str, arguments: list[str], repeats: int) -> Job:
    times, memory = [], 0
    for _ in range(repeats):
        process = subprocess.Popen(
            [sys.executable, *arguments],
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        # 1 says that a requirement of the profile is not met: the job is done all the same.
        if process.returncode not in (0, 1):
            raise RuntimeError(f"{name} ended with code {process.returncode}")
        times.append(used.ru_utime + used.ru_stime)
        memory = max(memory, used.ru_maxrss)
    # A small program is charged for the memory of the one that started it.
    megabytes = memory / 1024.0 if group == "run" else nan
    return _job(name, group, times, megabytes=megabytes)


def _job(name: str, group: str, times: list[float], *, megabytes: float = nan) -> Job:
    return Job(
        name=name,
        group=group,
        seconds=median(times),
        low=min(times),
        high=max(times),
        megabytes=megabytes,
    )


def stages(repeats: int) -> list[Job]:
    """Where the time of the whole job goes, imports not counted, by the names of its stages."""
    from mtcommission.base.messages.catalogue import Catalogue
    from mtcommission.commission.commission import commission
    from mtcommission.export.write import type_in
    from mtcommission.machine.profile.read import parse_profile, read_source
    from mtcommission.record.record import record_run
    from mtcommission.sheet.content import print_html, print_pdf

    english, times = Catalogue(), dict[str, list[float]]()
    for _ in range(repeats + 1):
        source = read_source(PROFILE)
        marks: list[tuple[str, float]] = [("profile", process_time())]

        def mark(stage: Message | str, into: list[tuple[str, float]] = marks) -> None:
            into.append((english.say(stage), process_time()))

        machine = parse_profile(source.text, where=str(PROFILE))
        found = commission(machine, profile=source, progress=mark)
        mark("record")
        record = record_run(found, created="2026-01-01T00:00:00+00:00")
        mark("sheet, HTML")
        typed = type_in(record)
        print_html(record, typed)
        mark("sheet, PDF")
        print_pdf(record, typed)
        mark("end")
        spent: dict[str, float] = {}
        for (name, start), (_, end) in pairwise(marks):
            spent[name] = spent.get(name, 0.0) + end - start
        for name, seconds in spent.items():
            times.setdefault(name, []).append(seconds)
    # The first round is cold: it loads what is imported late.
    return [_job(name, "stage", values[1:]) for name, values in times.items()]


def parts(repeats: int) -> list[Job]:
    """Single parts, warm."""
    from mtcommission.limits.choose import choose_limits
    from mtcommission.loop.tuning.tuning import tune_loop
    from mtcommission.machine.profile.read import read_profile

    machine = read_profile(PROFILE)
    tuned = tune_loop(machine)
    calls: dict[str, Callable[[], object]] = {
        "tune the cascade": lambda: tune_loop(machine),
        "search for limits": lambda: choose_limits(machine, tuned),
    }
    return [_job(name, "part", _times(call, repeats)) for name, call in calls.items()]


def _times(call: Callable[[], object], repeats: int) -> list[float]:
    call()
    times = []
    for _ in range(repeats):
        start = process_time()
        call()
        times.append(process_time() - start)
    return times


def sweeps() -> Iterator[Job]:
    """Time and memory of sweeps over F_max against the number of cases."""
    from benchmarks.sweep import measure
    from mtcommission.sweep.plan import Quantity

    for count in SWEEPS:
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            row = pool.submit(measure, count, 2, Quantity.OPTIMAL).result()
        if row.passed != count:
            raise RuntimeError(f"sweep: {count - row.passed} of {count} cases without certificate")
        name = f"{count} certified optima"
        yield _job(name, "sweep", [row.processor], megabytes=row.megabytes)
