"""One tool on one problem, in a process of its own: time, memory and what its control is worth.

    python -m benchmarks.child TOOL PROBLEM CELLS SECONDS FILE

The measurement is written after the first answer and again after every further one, so that a
process that is stopped at its limit still leaves what it had.
"""

from __future__ import annotations

import importlib
import json
import resource
import statistics
import sys
import warnings
from dataclasses import asdict, dataclass, replace
from math import nan
from pathlib import Path
from typing import Any

from benchmarks.tools import find_tool

REPEATS = 15
"""Warm solves at most."""
LATE = "no answer within"
"""How the message of a tool begins that was stopped at its limit of time."""
WARM_SHARE = 0.2
"""Part of the allowed time in which further warm solves are begun; the first may take all of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """A row of the table; times are processor times, of child processes too.

    Parameters
    ----------
    tool, problem, cells
        What was measured.
    failure
        The tool's own message; empty where it answered.
    imports
        Time to import it [s].
    first
        From the matrices to the first answer [s].
    warm
        Of each further solve [s].
    t_f, cost, lower_bound
        What it claims [s, N² s, s].
    terminal_error, residual, violation
        What its control is worth, see ``benchmarks.answer``.
    megabytes
        Peak memory of the process and its largest child, interpreter included.
    """

    tool: str
    problem: str
    cells: int
    failure: str = ""
    imports: float = nan
    first: float = nan
    warm: tuple[float, ...] = ()
    t_f: float = nan
    cost: float = nan
    lower_bound: float = nan
    terminal_error: float = nan
    residual: float = nan
    violation: float = nan
    megabytes: float = nan

    @property
    def solve(self) -> float:
        """Median warm solve, or the first answer where there was no time for another [s]."""
        return statistics.median(self.warm) if self.warm else self.first


def processor_time() -> float:
    """User and system time of this process and of those it waited for [s]."""
    own = resource.getrusage(resource.RUSAGE_SELF)
    below = resource.getrusage(resource.RUSAGE_CHILDREN)
    return own.ru_utime + own.ru_stime + below.ru_utime + below.ru_stime


def peak_megabytes() -> float:
    """Peak memory of this process and its largest child [MB]."""
    below = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    status = Path("/proc/self/status")
    if status.exists():  # getrusage counts what the parent had before it started this program
        line = next(s for s in status.read_text().splitlines() if s.startswith("VmHWM"))
        own = int(line.split()[1])
    unit = 1024.0**2 if sys.platform == "darwin" else 1024.0
    return (own + below) / unit


def measure(tool: str, problem: str, *, cells: int, seconds: float, file: Path) -> Measurement:
    """Measure and write; the last measurement is returned as well.

    Parameters
    ----------
    tool, problem
        Names.
    cells
        Intervals.
    seconds
        Processor time allowed [s]; a fifth of it goes to warm solves.
    file
        Where the JSON goes.
    """
    from benchmarks.answer import judge
    from benchmarks.problems import find_problem

    given = find_problem(problem)
    begin = processor_time()
    prepare = importlib.import_module(f"benchmarks.peers.{find_tool(tool).module}").prepare
    row = Measurement(tool=tool, problem=problem, cells=cells, imports=processor_time() - begin)
    try:
        start = processor_time()
        solve = prepare(given, cells)
        answer = solve()
    except Exception as error:  # every failure of a peer is a result, shown with its message
        message = _message(error)
        if processor_time() - begin > 0.95 * seconds:  # its solver program was stopped, not it
            message = f"{LATE} {seconds:.0f} s of processor time"
        row = replace(row, failure=message, megabytes=peak_megabytes())
        write(row, file)
        return row
    row = replace(row, first=processor_time() - start, megabytes=peak_megabytes())
    worth = judge(given, answer)
    row = replace(
        row,
        t_f=answer.t_f,
        cost=answer.cost,
        lower_bound=answer.lower_bound,
        terminal_error=worth.terminal_error,
        residual=worth.residual,
        violation=worth.violation,
    )
    write(row, file)
    # The first warm solve is worth all the time that is left: some tools need long to set up, not
    # to solve. If it is stopped, the first answer stands in the file.
    end = begin + seconds
    until = min(processor_time() + WARM_SHARE * seconds, end)
    while len(row.warm) < REPEATS and (
        processor_time() + 1.2 * row.solve < until if row.warm else processor_time() < end
    ):
        start = processor_time()
        solve()
        row = replace(row, warm=(*row.warm, processor_time() - start))
        write(row, file)
    return row


def write(row: Measurement, file: Path) -> None:
    """Write a measurement as JSON."""
    file.write_text(json.dumps(asdict(row)), encoding="utf-8")


def read(file: Path) -> Measurement:
    """Read a measurement back."""
    return read_row(json.loads(file.read_text(encoding="utf-8")))


def read_row(values: dict[str, Any]) -> Measurement:
    """Return a measurement from its JSON object."""
    return Measurement(warm=tuple(values.pop("warm")), **values)


def _message(error: Exception) -> str:
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text[:160]}"


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    _, given_tool, given_problem, given_cells, given_seconds, given_file = sys.argv
    measure(
        given_tool,
        given_problem,
        cells=int(given_cells),
        seconds=float(given_seconds),
        file=Path(given_file),
    )
