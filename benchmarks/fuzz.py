"""Commands on thousands of broken profiles: an exit code and a message, never a traceback.

    python -m benchmarks.fuzz --count 10000 --command check
    python -m benchmarks.fuzz --count 200 --command limits --values --second
    python -m benchmarks.fuzz --count 500 --command limits --machines --seconds 90

Each case is a shipped profile, broken by its seed alone; for ``export``, ``sheet`` and ``verify`` a
record, mostly changed and sealed again; for ``sweep`` a table of cases. Costly commands run in a
process of their own with a limit of CPU time. A case is bad if it ends otherwise than with exit
code 0 to 3, prints a traceback, a warning of Python, an internal error, or a character that steers
a terminal, prints nan or inf as a number, holds more than a gigabyte, or takes longer than
``--longest`` times the whole run of the profile that was broken.
``--values`` only moves numbers, and skips what ``check`` refuses, so that every case is computed.
``--machines`` makes machines of its own instead, from 1 g to 100 t and 0.1 Hz to 5 kHz, none of
which may take more than a minute of the machine at its fastest: a fixed piece of work before and
after each case tells how much slower a shared one is just then.
``--second`` lets the second program of the tests judge what ``limits`` recommends.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import re
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from shutil import rmtree
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.mutations import (
    dice_of,
    extreme_machine,
    mutated,
    mutated_table,
    mutated_text,
    mutated_values,
    shipped_texts,
)
from mtcommission import cli
from mtcommission.base.errors import ComputationError
from mtcommission.export.catalogue import CONTROL_KEYS
from mtcommission.machine.profile.shipped import read_shipped, shipped_names

RECORDS = ("export", "sheet", "verify")
"""Commands that read a record."""

COMMANDS = ("check", "wizard", "optimal", "simulate", "limits", "run", "sweep", *RECORDS)
QUICK = ("check", "wizard", "export")
"""Commands that compute little; the others run in a process of their own."""

WARM = tuple(
    f"mtcommission.{name}"
    for name in (
        "commission",
        "sheet",
        "cli.machine_view",
        "cli.optimum_view",
        "cli.limits_view",
        "limits.judge",
        "wizard",
        "commission.options",
        "export.write",
    )
)
GOOD = "milling-manipulator"
"""Whose record is broken for the commands that read one."""

ALWAYS_ALLOWED = 1.0
"""CPU time that is not compared [s]: every shipped profile's run takes several times as long."""

LONGEST = 60.0
"""CPU time of any machine [s]."""

LARGEST = 1024.0
"""Memory that a command may hold [MB]."""

GOOD_TABLE = """requirements.tcp_deviation,f_max
5 um,2000
2e-5,2.5 kN
"""
"""Cases of a sweep."""

NUMBER = re.compile(r"(?<![\w.])(nan|inf)(?![\w.])")


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """How a case ended: exit code (-1 killed), CPU time [s], memory [MB], and all that was said."""

    code: int
    processor: float
    said: str
    memory: float = 0.0


def pace() -> float:
    """CPU time of a fixed piece of work much like a simulation [s]."""
    dice = np.random.default_rng(0)
    A, X = dice.normal(size=(14, 14)), dice.normal(size=(14, 40))
    begun = time.process_time()
    for _ in range(12000):
        np.abs(A @ X).max()
    return time.process_time() - begun


def call(*arguments: str) -> tuple[int, str]:
    """One command in this process: exit code and all that was said."""
    out = io.StringIO()
    code: object = 0
    with (
        patch.object(sys, "argv", ["mtcommission", *arguments]),
        redirect_stdout(out),
        redirect_stderr(out),
    ):
        try:
            cli.main()
        except SystemExit as stopped:
            code = stopped.code
    return (code if isinstance(code, int) else 3), out.getvalue()


def in_place(work: Callable[[], tuple[int, str]]) -> Ending:
    """What needs no guard: forking would take longer than the work."""
    begun = time.process_time()
    code, said = work()
    return Ending(code=code, processor=time.process_time() - begun, said=said)


def in_child(work: Callable[[], tuple[int, str]], *, seconds: int) -> Ending:
    """The same in a process of its own, ended when it has used up its CPU time."""
    import resource  # not on Windows, where the quick commands still run

    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        signal.signal(signal.SIGXCPU, signal.SIG_DFL)
        code, said = work()
        with os.fdopen(write, "wb") as pipe:
            pipe.write(f"{code}\n{said}".encode(errors="replace"))
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        code_text, _, said = pipe.read().decode(errors="replace").partition("\n")
    _, status, used = os.wait4(child, 0)
    killed = os.waitstatus_to_exitcode(status) != 0
    return Ending(
        code=-1 if killed else int(code_text),
        processor=used.ru_utime + used.ru_stime,
        said=f"ended by the system, status {status}" if killed else said,
        memory=used.ru_maxrss / 1024.0,
    )


def arguments_of(command: str, profile: Path, dice: np.random.Generator) -> list[str]:
    """The command line for a profile; options by chance where they matter."""
    folder = str(profile.parent / "out")
    match command:
        case "wizard":
            return [command, "--yes", "-o", str(profile)]
        case "optimal":
            return [command, str(profile), "--kind", str(dice.choice(["time", "damping"]))]
        case "simulate":
            a = 10.0 ** dice.uniform(-2.0, 2.0)
            j = a * 10.0 ** dice.uniform(0.5, 4.0)
            return [command, str(profile), "--acceleration", f"{a:.4g}", "--jerk", f"{j:.4g}"]
        case "run":
            return [command, str(profile), "-o", folder, "--no-pdf"]
        case "export":
            return [command, str(profile), "--control", str(dice.choice(CONTROL_KEYS))]
        case "sheet":
            print_also = [] if dice.random() < 0.2 else ["--no-pdf"]
            return [command, str(profile), "-o", folder, *print_also]
        case "verify":
            return [command, str(profile), str(profile.parent / "trace.csv")]
        case "sweep":
            table, out = str(profile.parent / "case.csv"), str(profile.parent / "swept")
            return [command, str(profile), "--cases", table, "-o", out, "--workers", "1"]
    return [command, str(profile)]


def fault_of(command: str, ending: Ending, *, longest: float) -> str:
    """What is bad about an ending; "" if nothing is."""
    if ending.code not in (0, 1, 2, 3):
        return f"exit code {ending.code}"
    for words in ("Traceback", "internal error", "RuntimeWarning", "\x1b"):
        if words in ending.said:
            return words if words.isprintable() else repr(words)
    if ending.memory > LARGEST:
        return f"{ending.memory:.0f} MB"
    if ending.code and not ending.said.strip():
        return "silent"
    printed = ending.said.split("Source of the data", 1)[-1]
    if command in ("check", "limits", "simulate", "optimal") and ending.code in (0, 1):
        found = NUMBER.search(printed)
        if found:
            return f"prints {found[0]}"
    if ending.processor > longest:
        return f"{ending.processor:.1f} s of CPU, more than {longest:.1f} s"
    return ""


def second_opinion(profile: Path) -> str:
    """What a program that shares nothing with the package finds broken in the recommendation."""
    from mtcommission.machine.profile.read import read_profile
    from tests.test_second_program import broken_requirements

    try:
        broken = broken_requirements(read_profile(profile))
    except ComputationError:
        return ""
    return "; ".join(broken or [])


def main() -> None:
    options = _options()
    with TemporaryDirectory() as name:
        raise SystemExit(fuzz(options, Path(name)))


def fuzz(options: argparse.Namespace, folder: Path) -> int:
    """Run the cases, print what is bad and a summary; 1 if something is bad."""
    command = options.command
    for name in WARM:  # else every child would import them anew
        import_module(name)
    runs = GoodRuns(folder=folder)
    reads_record = command in RECORDS
    names = [GOOD] if reads_record else list(shipped_names())
    if reads_record and options.record:
        texts = [path.read_text("utf-8") for path in options.record]
        names = [GOOD] * len(texts)
    else:
        texts = [runs.record_of(GOOD)] if reads_record else shipped_texts()
    case = folder / ("case.json" if reads_record else "case.toml")
    codes: Counter[int] = Counter()
    times: list[float] = []
    ends: Counter[str] = Counter()
    bad = skipped = 0
    fastest = pace() if options.machines else 1.0
    seed = options.first - 1
    while len(times) < options.count:
        seed += 1
        dice, base = dice_of(options.series, seed), seed % len(texts)
        case.write_text(_broken(texts[base], dice, options, seed), "utf-8", newline="")
        if command == "sweep":
            table = mutated_table(GOOD_TABLE, dice)
            (folder / "case.csv").write_text(table, "utf-8", newline="")
            rmtree(folder / "swept", ignore_errors=True)
        if command == "verify":
            _write_trace(folder / "trace.csv", json.loads(texts[base]))
        if (options.values or options.machines) and call("check", str(case))[0]:
            skipped += 1
            continue
        arguments = arguments_of(command, case, dice)
        work = partial(call, *arguments)
        before = pace() if options.machines else fastest
        ending = in_place(work) if command in QUICK else in_child(work, seconds=options.seconds)
        if options.machines:
            after = pace()
            fastest = min(fastest, before, after)
            own = ending.processor * 2.0 * fastest / (before + after)
            ending = replace(ending, processor=own)
            ends[_outcome(ending)] += 1
        codes[ending.code] += 1
        times.append(ending.processor)
        is_long = ending.processor > ALWAYS_ALLOWED
        longest = ALWAYS_ALLOWED
        if options.machines:
            longest = LONGEST
        elif is_long:
            longest = options.longest * runs.time_of(names[base])
        fault = fault_of(command, ending, longest=longest)
        if not fault and options.second and ending.code == 0:
            fault = second_opinion(case)
        if fault:
            bad += 1
            (options.keep / f"{command}-{seed}{case.suffix}").write_bytes(case.read_bytes())
            last = ending.said.strip().splitlines()[-1:] or [""]
            print(f"BAD seed {seed}: {arguments[2:]}: {fault}: {last[0][:200]}", flush=True)
    exits = ", ".join(f"exit {code}: {number}" for code, number in sorted(codes.items()))
    seeds = f"seeds {options.first} to {seed} of series {options.series}, {skipped} left out"
    print(f"{command}: {len(times)} cases, {seeds}; {exits}")
    shares = ", ".join(f"{t:.3g} s" for t in np.quantile(times, [0.5, 0.9, 0.99, 1.0]))
    print(f"CPU median, 90 %, 99 %, largest: {shares}; {bad} bad")
    for outcome, number in ends.most_common():
        print(f"  {number:4d}  {outcome}")
    return 1 if bad else 0


def _outcome(ending: Ending) -> str:
    """The name of an outcome: how its message begins; else the exit code."""
    last = (ending.said.strip().splitlines() or [""])[-1]
    return last.split(":", 1)[0][:60] if ending.code == 3 else f"exit {ending.code}"


def _broken(text: str, dice: np.random.Generator, options: argparse.Namespace, seed: int) -> str:
    if options.command == "sweep":
        return text
    if options.machines:
        return extreme_machine(dice)
    if options.command in RECORDS:
        return mutated_text(text, dice)
    return (mutated_values if options.values else mutated)(text, dice)


def _write_trace(path: Path, record: dict[str, Any]) -> None:
    """The first move as a perfect machine would have recorded it."""
    series = record["moves"][0]["series"]
    t, x = np.array(series["t"]), np.array(series["signals"]["x_ref_delayed"])
    even = np.arange(-0.2, t[-1], 1e-3)
    moved = np.interp(even, t, x)
    rows = [f"{at:.6g},{y:.9g},{y:.9g}" for at, y in zip(even, moved, strict=True)]
    path.write_text("t [s],x_ref [m],encoder [m]\n" + "\n".join(rows) + "\n", "utf-8")


@dataclass(frozen=True, slots=True, kw_only=True)
class GoodRuns:
    """The whole runs of the shipped profiles, each when it is first asked for."""

    folder: Path
    times: dict[str, float] = field(default_factory=dict)

    def time_of(self, name: str) -> float:
        """CPU time of the run [s]; its record is left in the folder."""
        if name not in self.times:
            profile = self.folder / f"{name}.toml"
            profile.write_text(read_shipped(name).text, "utf-8")
            arguments = ("run", str(profile), "-o", str(self.folder / name), "--no-pdf")
            self.times[name] = in_child(partial(call, *arguments), seconds=600).processor
            print(f"the run of {name} takes {self.times[name]:.1f} s of CPU", flush=True)
        return self.times[name]

    def record_of(self, name: str) -> str:
        """Text of the record that the run writes."""
        self.time_of(name)
        return (self.folder / name / "record.json").read_text("utf-8")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
    parser.add_argument("--command", choices=COMMANDS, default="check")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--series", type=int, default=23, help="another series of dice")
    parser.add_argument("--values", action="store_true", help="only move numbers")
    parser.add_argument("--machines", action="store_true", help="machines of all sizes instead")
    parser.add_argument("--second", action="store_true", help="judge limits by a second program")
    parser.add_argument(
        "--longest", type=float, default=1.0, help="in runs of the unbroken profile"
    )
    parser.add_argument("--record", type=Path, action="append", help="in place of a run's own")
    parser.add_argument("--seconds", type=int, default=60, help="CPU after which a case is ended")
    parser.add_argument("--keep", type=Path, default=Path(), help="folder for bad profiles")
    return parser.parse_args()


if __name__ == "__main__":
    main()
