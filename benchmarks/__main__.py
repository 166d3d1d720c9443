"""Run the benchmarks and print them as one page: one command, everything side by side.

    python -m benchmarks [--quick] [race | jobs | quality | report ...]

Without names everything runs. ``--quick`` takes coarse grids, the three main problems and a few
machines. The rows are kept in the folder of ``--output``, so that ``report`` can print them again;
with ``--tools`` or ``--problems`` only those rows of an earlier race are renewed, and the page says
when.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from benchmarks.child import Measurement
from benchmarks.race import entries, race

PACKAGES = (
    "mtcommission",
    "numpy",
    "scipy",
    "casadi",
    "rockit-meco",
    "pyomo",
    "gekko",
    "dymos",
    "openmdao",
    "pyoptsparse",
)

SECTIONS = ("race", "jobs", "quality", "report")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("sections", nargs="*", metavar="SECTION", help="race jobs quality report")
    parser.add_argument("--quick", action="store_true", help="a small selection")
    parser.add_argument("--seconds", type=float, default=60.0, help="limit for one solve, CPU")
    parser.add_argument("--tools", nargs="*", default=[], help="only these (part of the name)")
    parser.add_argument("--problems", nargs="*", default=[], help="only these, by name")
    parser.add_argument("--count", type=int, default=100, help="machines for the quality of limits")
    parser.add_argument("--workers", type=int, default=1, help="processes at a time")
    parser.add_argument("--output", type=Path, default=Path("build"), help="folder of the rows")
    options = parser.parse_args()
    wanted = options.sections or list(SECTIONS)
    unknown = sorted(set(wanted) - set(SECTIONS))
    if unknown:
        parser.error(f"no section {', '.join(unknown)}; there are {', '.join(SECTIONS)}")
    os.environ["OMP_NUM_THREADS"] = "1"
    results = read_results(options.output)
    for section in SECTIONS[:-1]:
        if section in wanted:
            limits = {"seconds": options.seconds, "workers": options.workers}
            begun = {**stamp(), **limits}
            if section == "race" and section in results and (options.tools or options.problems):
                renewed = results[section].setdefault("renewed", [])
                renewed.append({**begun, "tools": options.tools, "problems": options.problems})
            else:
                results[section] = {**begun, "rows": []}

            def keep(row: dict[str, Any], section: str = section) -> None:
                results[section]["rows"] = with_row(results[section]["rows"], row)
                save(results, options.output)

            run_section(section, options, keep)
    if "report" in wanted:
        print_report(results)


def with_row(rows: list[dict[str, Any]], new: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the rows with one more, in place of an earlier one of the same tool and problem."""
    keys = ("tool", "problem", "cells")
    if "tool" not in new:
        return [*rows, new]
    return [*(row for row in rows if any(row[key] != new[key] for key in keys)), new]


def run_section(
    section: str, options: argparse.Namespace, keep: Callable[[dict[str, Any]], None]
) -> None:
    """Run one section and keep each row as soon as it is there."""
    if section == "race":
        chosen = [
            entry
            for entry in entries(quick=options.quick)
            if (not options.tools or any(part in entry.tool.name for part in options.tools))
            and (not options.problems or entry.problem in options.problems)
        ]

        def tell_and_keep(row: Measurement) -> None:
            tell(row)
            keep(asdict(row))

        race(chosen, seconds=options.seconds, workers=options.workers, tell=tell_and_keep)
    elif section == "jobs":
        from benchmarks.jobs import all_jobs

        for job in all_jobs(quick=options.quick):
            print(f"{job.group:8s} {job.name:50s} {job.seconds:9.3f} s", flush=True)
            keep(asdict(job))
    else:
        from benchmarks.limits_quality import score_population

        count = 6 if options.quick else options.count
        for score in score_population(count, workers=options.workers):
            keep(asdict(score))


def tell(row: Measurement) -> None:
    """Print a row as soon as it is there."""
    what = row.failure or (
        f"{1e3 * row.solve:10.2f} ms ({1 + len(row.warm)} solves), t_f {1e3 * row.t_f:.6f} ms, "
        f"terminal error {row.terminal_error:.1e}, violation {row.violation:.1e}"
    )
    grid = f"N = {row.cells}" if row.cells else ""
    print(f"{row.problem:16s} {row.tool:26s} {grid:10s} {what}", flush=True)


def stamp() -> dict[str, Any]:
    """Return when, where and with what a section begins."""
    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            versions[package] = "not installed"
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "commit": _commit(),
        "machine": f"{_processor()}, {os.cpu_count()} cores, {platform.system()}",
        "load": [round(load, 1) for load in os.getloadavg()],
        "versions": {"Python": platform.python_version(), **versions},
    }


def _commit() -> str:
    command = ["git", "rev-parse", "--short", "HEAD"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    return found.stdout.strip() or "no repository"


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def read_results(folder: Path) -> dict[str, Any]:
    """Return the results of earlier sections."""
    file = folder / "benchmarks.json"
    if not file.exists():
        return {}
    found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return found


def save(results: dict[str, Any], folder: Path) -> None:
    """Write the results; nan, which JSON does not know, as null."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(_plain(results), indent=1, allow_nan=False)
    (folder / "benchmarks.json").write_text(text + "\n", encoding="utf-8")


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.13g}") if value == value and abs(value) != float("inf") else None
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value


def print_report(results: dict[str, Any]) -> None:
    from benchmarks.report import compose_report

    sys.stdout.write("\n" + compose_report(json.loads(json.dumps(_plain(results)))))


if __name__ == "__main__":
    main()
