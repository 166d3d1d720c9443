"""Two installed programs side by side, command by command: ratios of processor time.

    python -m benchmarks.beside OTHER_PYTHON [--repeats 5]

``OTHER_PYTHON`` is the interpreter of an environment with another version, e.g. that of the commit
before a change. Each program gets the machine that it ships itself, since keys of profiles change.
Rounds alternate, so that a busy machine slows both.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

MACHINE = "milling-manipulator"

COMMANDS = {
    "--help": ["--help"],
    "check": ["check", "machine.toml"],
    "optimal": ["optimal", "machine.toml", "--kind", "time"],
    "simulate": ["simulate", "machine.toml", "--acceleration", "2", "--jerk", "100"],
    "limits": ["limits", "machine.toml"],
    "run, no PDF": ["run", "machine.toml", "--no-pdf", "-o", "out"],
    "run": ["run", "machine.toml", "-o", "out"],
    "sweep, 30 forces": ["sweep", "machine.toml", "--f-max", "1kN:4kN:30", "-o"],
}
"""What follows the program's name; a sweep gets a new folder each time."""


def time_command(python: str, command: list[str], folder: Path) -> float:
    """Return the processor time of one call, children included [s]."""
    others = python != sys.executable
    kept = {k: v for k, v in os.environ.items() if not (others and k == "PYTHONPATH")}
    process = subprocess.Popen(
        [python, "-m", "mtcommission", *command],
        cwd=folder,
        env={**kept, "OMP_NUM_THREADS": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    # 1 says that a requirement of the profile is not met: the job is done all the same.
    if process.returncode not in (0, 1):
        raise RuntimeError(f"{python} {' '.join(command)} ended with code {process.returncode}")
    return used.ru_utime + used.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.beside", description=__doc__)
    parser.add_argument("other", metavar="OTHER_PYTHON")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    print(f"{'command':18s} {'this':>8s} {'other':>8s} {'ratio':>6s}   processor time, median [s]")
    with tempfile.TemporaryDirectory() as scratch:
        folders = {}
        for number, python in enumerate((sys.executable, options.other)):
            folders[python] = Path(scratch) / str(number)
            folders[python].mkdir()
            copy = ["profiles", "copy", MACHINE, "machine.toml"]
            time_command(python, copy, folders[python])
        for name, command in COMMANDS.items():
            times: dict[str, list[float]] = {python: [] for python in folders}
            for number in range(options.repeats + 1):
                for python, folder in folders.items():
                    place = [f"sweep-{number}"] if command[-1] == "-o" else []
                    times[python].append(time_command(python, [*command, *place], folder))
            # The first round is cold.
            ours, theirs = (median(times[python][1:]) for python in folders)
            print(f"{name:18s} {ours:8.2f} {theirs:8.2f} {ours / theirs:6.2f}", flush=True)


if __name__ == "__main__":
    main()
