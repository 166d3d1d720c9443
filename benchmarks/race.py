"""Every installed tool on every problem, each in a process of its own with a limit of time."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

from benchmarks.child import LATE, Measurement, read
from benchmarks.problems import MAIN, NAMES
from benchmarks.tools import TOOLS, Tool, is_installed

PATIENCE = 8.0
"""Wall time over processor time after which a process is given up (a busy machine)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """What is to be measured."""

    tool: Tool
    problem: str
    cells: int


LADDER_SHARE = 0.5
"""Part of the allowed time on the ladders, where there are many problems."""


def entries(*, quick: bool) -> Iterator[Entry]:
    """All entries; the quick ones are the main problems on the coarsest grids."""
    for problem in MAIN if quick else NAMES:
        for tool in TOOLS:
            grids = tool.cells[:1] if quick else tool.cells
            for cells in grids if problem in MAIN else (tool.ladder_cells,):
                yield Entry(tool=tool, problem=problem, cells=cells)


def race(
    wanted: list[Entry], *, seconds: float, workers: int, tell: Callable[[Measurement], None]
) -> list[Measurement]:
    """Measure all entries.

    Parameters
    ----------
    wanted
        Entries.
    seconds
        Processor time allowed for one [s]; LADDER_SHARE of it on the ladders.
    workers
        How many run at a time; 1 disturbs the times least.
    tell
        Called with each row as it is there.
    """

    def run_chain(chain: list[Entry]) -> list[Measurement]:
        rows: list[Measurement] = []
        for entry in chain:
            allowed = seconds if entry.problem in MAIN else LADDER_SHARE * seconds
            late = [row for row in rows if is_late(row)]
            if late:
                row = Measurement(tool=entry.tool.name, problem=entry.problem, cells=entry.cells)
                row = replace(row, failure=f"not tried: N = {late[0].cells} was too slow")
            else:
                row = run(entry, seconds=allowed)
            rows.append(row)
            tell(row)
        return rows

    chains = [
        list(chain) for _, chain in groupby(wanted, lambda entry: (entry.problem, entry.tool.name))
    ]
    with ThreadPoolExecutor(workers) as pool:
        return [row for rows in pool.map(run_chain, chains) for row in rows]


def is_late(row: Measurement) -> bool:
    """Whether a tool was stopped at the limit of time."""
    return row.failure.startswith(LATE)


def run(entry: Entry, *, seconds: float) -> Measurement:
    """Measure one entry in a process of its own."""
    row = Measurement(tool=entry.tool.name, problem=entry.problem, cells=entry.cells)
    if not is_installed(entry.tool):
        return replace(row, failure=f"not installed: {entry.tool.install}")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "row.json"
        command = [sys.executable, "-m", "benchmarks.child", entry.tool.name, entry.problem]
        command += [str(entry.cells), str(seconds), str(file)]
        ended = _wait(command, folder=folder, seconds=seconds)
        if file.exists():
            return read(file)
    return replace(row, failure=ended)


def _wait(command: list[str], *, folder: str, seconds: float) -> str:
    """Run a command in a folder of its own and say how it ended.

    It leads a group of processes, so that solvers that it started can be ended with it.
    """
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(Path.cwd())}
    limit = int(seconds) + 1
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5)),
    )
    try:
        _, errors = process.communicate(timeout=PATIENCE * seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return f"{LATE} {PATIENCE * seconds:.0f} s by the clock"
    if process.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return f"{LATE} {seconds:.0f} s of processor time"
    last = [line for line in errors.splitlines() if line.strip()]
    return last[-1][:200] if last else f"ended with code {process.returncode}"
