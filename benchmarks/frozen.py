"""What the program answers today, written down, so that a later state can be compared with it.

    python -m benchmarks.frozen write BEFORE
    python -m benchmarks.frozen write AFTER --inputs BEFORE
    python -m benchmarks.frozen compare BEFORE AFTER [--least 1e-6] [--rows 40] [--at limits]

``write`` fills a folder outside the repository with small files; what is there is not computed
again, so it can be stopped at any time, and a state is written anew into a new folder. Parts:

- ``inventory``: keys of profile and record, options, headings of the docs
- ``profiles``: every command on the shipped profiles; cheap ones in both languages
- ``messages``: ``check`` on 200 broken profiles
- ``others``: commands that take no profile, a sweep, identify
- ``machines``: limits of 60 random machines of every kind of control
- ``german``: the costly commands on the shipped profiles again, and exports, for their texts

``--only`` takes parts and beginnings of places (``profiles/ball-screw``, ``machines/07``);
``--inputs`` the profiles, tried values and traces of an earlier state: else they are made from the
tree and from what its run recommends. Only the command line is asked, nothing is imported of the
package but to make inputs, so that the tool outlives what it compares. Processor time stands
beside a fixed piece of numpy work, before and after each command, in ``times``.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from html.parser import HTMLParser
from itertools import groupby
from pathlib import Path
from shutil import copyfile, copytree
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from benchmarks.frozen_compare import compare

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
PROFILES = ROOT / "profiles"
LANGUAGES = ("en", "de")
BROKEN = 200
MACHINES = 60
SERVOS = (
    "generic", "sinumerik", "heidenhain", "fanuc", "isg", "twincat", "plcopen", "linuxcnc", "ros2",
    "state-space",
)  # fmt: skip
FOLLOWERS = ("klipper", "grblhal", "fluidnc", "marlin")
DETUNED = 1.3
"""By how much the detuned values exceed the recommended ones [-]."""

REST = 0.5
"""Of a trace before and after what the record shows [s]."""

SAME_EVERYWHERE = {
    "PYTHONPATH": str(ROOT),
    "OMP_NUM_THREADS": "1",
    "SOURCE_DATE_EPOCH": "1700000000",
    "COLUMNS": "100",
    "TERM": "dumb",
    "NO_COLOR": "1",
    "LC_ALL": "C.UTF-8",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """One command: where its answer goes, its words, and the files that it finds beside it."""

    place: str
    words: tuple[str, ...]
    files: Mapping[str, Path] = field(default_factory=dict)
    is_brief: bool = False
    """Leave time series and maps out of what is kept."""


def pace() -> float:
    """Processor time of a fixed piece of numpy work [s]."""
    dice = np.random.default_rng(0)
    A, X = dice.normal(size=(14, 14)), dice.normal(size=(14, 40))
    begun = time.thread_time()
    for _ in range(12000):
        np.abs(A @ X).max()
    return time.thread_time() - begun


def perform(call: Call, folder: Path) -> None:
    """Run one command in an empty folder of its own and keep all that it said and wrote."""
    said = folder / f"{call.place}.txt"
    if said.exists():
        return
    said.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as name:
        work = Path(name)
        (work / "out").mkdir()
        for file, source in call.files.items():
            copyfile(source, work / file)
        is_timed = not call.place.startswith("messages")
        before = pace() if is_timed else 0.0
        with (work / "stdout").open("wb") as out, (work / "stderr").open("wb") as err:
            process = subprocess.Popen(
                [sys.executable, "-m", "mtcommission", *call.words],
                cwd=work,
                env={**os.environ, **SAME_EVERYWHERE},
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=err,
            )
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        for made in sorted((work / "out").rglob("*")):
            keep(made, folder / call.place, is_brief=call.is_brief)
        if is_timed:
            seconds, fixed = used.ru_utime + used.ru_stime, (before + pace()) / 2.0
            row = {"seconds": seconds, "fixed": fixed, "ratio": seconds / fixed}
            write(folder / "times" / f"{call.place.replace('/', ' ')}.json", json.dumps(row))
        texts = [(work / one).read_text("utf-8", "replace") for one in ("stdout", "stderr")]
        text = f"exit {process.returncode}\n{texts[0]}"
        text += f"--- stderr\n{texts[1]}" if texts[1] else ""
        write(said, text.replace(str(work), "."))  # last: it says that the part is there
    print(call.place, flush=True)


def write(file: Path, text: str) -> None:
    """Write a file and its folder."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")


def keep(file: Path, folder: Path, *, is_brief: bool) -> None:
    """Keep a file that a command wrote, as what can be compared: JSON or text."""
    match file.suffix:
        case ".json" if is_brief:
            kept = without(json.loads(file.read_text("utf-8")), {"series"})
            write(folder / file.name, json.dumps(kept))
        case ".json" | ".toml":
            write(folder / file.name, file.read_text("utf-8"))
        case ".html":
            page = Page(file.read_text("utf-8"))
            write(folder / f"{file.name}.txt", "\n".join(page.lines) + "\n")
            write(folder / f"{file.name}.controls.txt", "\n".join(page.controls) + "\n")
        case ".pdf":
            write(folder / f"{file.name}.txt", pdf_text(file))
        case ".csv":
            write(folder / f"{file.name}.json", json.dumps(columns(file)))


def without(value: Any, keys: set[str]) -> Any:
    """JSON without some keys, wherever they stand."""
    if isinstance(value, dict):
        return {key: without(item, keys) for key, item in value.items() if key not in keys}
    return [without(item, keys) for item in value] if isinstance(value, list) else value


def columns(file: Path) -> dict[str, list[float | str]]:
    """A table by its columns; numbers where they are."""

    def number(cell: str) -> float | str:
        try:
            return float(cell)
        except ValueError:
            return cell

    head, *rows = csv.reader(file.read_text("utf-8").splitlines())
    return {name: [number(row[k]) for row in rows] for k, name in enumerate(head)}


def pdf_text(file: Path) -> str:
    """The text of a PDF, page by page."""
    import pypdfium2

    document = pypdfium2.PdfDocument(file)
    pages = [page.get_textpage().get_text_range() for page in document]
    text = "".join(f"--- page {k}\n{page}\n" for k, page in enumerate(pages, start=1))
    return text.replace("\r\n", "\n")


class Page(HTMLParser):
    """Texts of a page in order, a table's row a line, and what can be done on it."""

    BLOCKS = frozenset(
        ("p", "div", "tr", "li", "h1", "h2", "h3", "h4", "caption", "figcaption", "dt", "pre")
    )
    DOES = frozenset(("input", "select", "option", "button", "textarea", "a", "details", "summary"))
    NAMES = frozenset(("label", "option", "button", "summary", "th", "figcaption", "h2", "h3"))
    SAYS = ("id", "type", "href", "aria-label", "title", "placeholder")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.lines: list[str] = []
        self.controls: list[str] = []
        self.line = self.script = ""
        self.inside: list[str] = []
        self.named: list[str] = []
        self.feed(text)
        self.end_line()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Begin a line, a cell or a control."""
        given = dict(attrs)
        if tag in ("script", "style", "svg"):
            self.inside.append("json" if given.get("type") == "application/json" else tag)
        if tag in self.BLOCKS:
            self.end_line()
        if tag in ("td", "th") and self.line:
            self.line += " | "
        if tag in self.NAMES:
            self.named.append("")
        if tag in self.DOES or "role" in given or "aria-label" in given:
            said = " ".join(f"{key}={given[key]}" for key in self.SAYS if given.get(key))
            self.controls.append(f"{tag} {said}")

    def handle_endtag(self, tag: str) -> None:
        """End a line, or a script with the words of the page."""
        if tag in ("script", "style", "svg") and self.inside:
            if self.inside.pop() == "json" and self.script:
                words = nodes(json.loads(self.script))
                texts = (f".{place} {text}" for place, text in words if isinstance(text, str))
                self.controls += dict.fromkeys(texts)
            self.script = ""
        if tag in self.NAMES and self.named:
            self.controls.append(f"{tag}: {' '.join(self.named.pop().split())}")
        if tag in self.BLOCKS:
            self.end_line()

    def handle_data(self, data: str) -> None:
        """Take a text to where it belongs."""
        if self.inside:
            self.script += data * (self.inside[-1] == "json")
        else:
            self.line += data
            self.named = [text + data for text in self.named]

    def end_line(self) -> None:
        """Keep a line that says something."""
        if self.line.strip(" |\n"):
            self.lines.append(" ".join(self.line.split()))
        self.line = ""


def nodes(value: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    """Everything in JSON with the keys above it, an item of a list as []."""
    if place:
        yield place, value
    if isinstance(value, dict):
        for key, item in value.items():
            yield from nodes(item, f"{place}.{key}" if place else key)
    elif isinstance(value, list):
        for item in value:
            yield from nodes(item, f"{place}[]")


def profile_keys(part: Any, schema: dict[str, Any], place: str = "") -> Iterator[str]:
    """Every key of a profile from its JSON schema, wherever the schema defines it."""
    if isinstance(part, list):
        for item in part:
            yield from profile_keys(item, schema, place)
    if not isinstance(part, dict):
        return
    if "$ref" in part:
        yield from profile_keys(schema["$defs"][part["$ref"].rsplit("/")[-1]], schema, place)
    for key, item in part.get("properties", {}).items():
        yield f"{place}.{key}".lstrip(".")
        yield from profile_keys(item, schema, f"{place}.{key}")
    for key, mark in {"anyOf": "", "oneOf": "", "allOf": "", "items": "[]"}.items():
        yield from profile_keys(part.get(key), schema, place + mark)


def answer(*words: str) -> str:
    """What a command prints."""
    command = [sys.executable, "-m", "mtcommission", *words]
    env = {**os.environ, **SAME_EVERYWHERE}
    return subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout


def options_of(*command: str) -> Iterator[str]:
    """Every argument and option of a command and of those below it, as its help writes them."""
    section = ""
    for line in answer(*command, "--help").splitlines():
        if not line.startswith(" "):
            section = line.rstrip(":")
        found = re.match(r"  (\S.*?)(  |$)", line)
        if found and section in ("Options", "Arguments", "Commands"):
            yield " ".join([*command, found[1]])
            if section == "Commands":
                yield from options_of(*command, found[1])


def inventory(folder: Path) -> None:
    """What is there: keys of profiles, options, headings."""
    here = folder / "inventory"
    if (here / "options.txt").exists():
        return
    schema = json.loads(answer("check", "--schema"))
    write(here / "schema.json", json.dumps(schema))
    write_list(here / "profile_keys.txt", profile_keys(schema, schema))
    pages = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")])
    lines = (
        (page.relative_to(ROOT), line)
        for page in pages
        for line in page.read_text("utf-8").splitlines()
    )
    write_list(
        here / "headings.txt", (f"{name}: {line}" for name, line in lines if line[:1] == "#")
    )
    write_list(here / "options.txt", options_of())
    print("inventory", flush=True)


def inventory_of_answers(folder: Path) -> None:
    """Key paths of all records, and what their pages and sheets can do, from what is written."""
    records = sorted(folder.glob("profiles/*/run_en/record.json"))
    if records:
        paths = (place for file in records for place, _ in nodes(json.loads(file.read_bytes())))
        write_list(folder / "inventory" / "record_keys.txt", paths)
    for language in LANGUAGES:
        pages = sorted(folder.glob(f"profiles/*/*_{language}/*.controls.txt"))
        if pages:
            lines = (line for page in pages for line in page.read_text("utf-8").splitlines())
            write_list(folder / "inventory" / f"page_{language}.txt", lines)


def write_list(file: Path, lines: Iterable[str]) -> None:
    """Write each line once, sorted."""
    write(file, "\n".join(sorted(set(lines))) + "\n")


def spoken(place: str, words: tuple[str, ...], **more: Any) -> Iterator[Call]:
    """A command in both languages."""
    for language in LANGUAGES:
        yield Call(place=f"{place}_{language}", words=(*words, "--language", language), **more)


def profile_calls(profile: Path, folder: Path) -> Iterator[Call]:
    """Every command on a shipped profile; the next is asked for when the one before is done."""
    name, at = profile.name, f"profiles/{profile.stem}"
    given = {name: profile}
    yield from spoken(f"{at}/check", ("check", name), files=given)
    yield Call(place=f"{at}/run_en", words=("run", name, "-o", "out"), files=given)
    yield Call(
        place=f"{at}/limits_en", words=("limits", name, "--json", "out/limits.json"), files=given
    )
    for kind in ("time", "damping"):
        optimal = ("optimal", name, "--kind", kind, "--json", "out/optimal.json")
        both = (*optimal, "--csv", "out/motion.csv")
        yield from spoken(f"{at}/optimal_{kind}", both, files=given)
    yield Call(
        place=f"{at}/page_en", words=("limits", name, "--page", "out/page.html"), files=given
    )
    yield from simulations(profile, folder, at)
    record = folder / at / "run_en" / "record.json"
    if not record.exists():
        return
    held = {"record.json": record}
    sheet: tuple[str, ...]
    for extent in ((), ("--appendix",)):
        sheet = ("sheet", "record.json", "-o", "out", *extent)
        yield from spoken(f"{at}/sheet{'_appendix' * bool(extent)}", sheet, files=held)
    yield from spoken(
        f"{at}/verify",
        ("verify", "record.json", "trace.csv", "-o", "out", "--json", "out/verify.json"),
        files={**held, "trace.csv": trace_of(record, folder, profile.stem)},
    )
    verdict = folder / at / "verify_en" / "verdict.json"
    if verdict.exists():
        sheet = ("sheet", "record.json", "-o", "out", "--verified", "verdict.json")
        yield from spoken(f"{at}/sheet_verified", sheet, files={**held, "verdict.json": verdict})
    for line in answer("export", "--control", "?").splitlines():
        control = line.split()[0]
        export = ("export", "record.json", "--control", control)
        yield Call(place=f"{at}/export/{control}_en", words=export, files=held)


def german_calls(profile: Path, folder: Path) -> Iterator[Call]:
    """The costly commands again for their texts, and exports, each as a list to tick off, too."""
    name, at = profile.name, f"profiles/{profile.stem}"
    costly: dict[str, tuple[str, ...]] = {
        "limits": ("limits", name),
        "page": ("limits", name, "--page", "out/page.html"),
        "run": ("run", name, "-o", "run", "--no-pdf"),
    }
    for place, words in costly.items():
        german = (*words, "--language", "de")
        yield Call(place=f"{at}/{place}_de", words=german, files={name: profile})
    yield from simulations(profile, folder, at, language="de")
    held = {"record.json": folder / at / "run_en" / "record.json"}
    for file in sorted((folder / at / "export").glob("*_en.txt")):
        control = file.name.removesuffix("_en.txt")
        words = ("export", "record.json", "--control", control, "--language", "de")
        yield Call(place=f"{at}/export/{control}_de", words=words, files=held)
        yield Call(place=f"{at}/export/{control}_list_de", words=(*words, "--csv"), files=held)


def machine_calls(profile: Path, folder: Path) -> Iterator[Call]:
    """Limits of a random machine, and their loop and response by ``simulate``."""
    name, at = profile.name, f"machines/{profile.stem}"
    words = ("limits", name, "--json", "out/limits.json")
    yield Call(place=f"{at}/limits_en", words=words, files={name: profile}, is_brief=True)
    for call in simulations(profile, folder, at, is_brief=True):
        if "recommended" in call.place:
            yield call


def simulations(
    profile: Path, folder: Path, at: str, *, language: str = "en", is_brief: bool = False
) -> Iterator[Call]:
    """``simulate`` with the values that were recommended when the inputs were made, and worse."""
    file = folder / "inputs" / "simulate" / f"{profile.stem}.json"
    limits = folder / at / "limits_en" / "limits.json"
    if not file.exists():
        if not limits.exists():
            return
        found = json.loads(limits.read_bytes())["recommended"]
        write(file, json.dumps([found["acceleration"], found["jerk"], filter_words(found)]))
    a, j, behind = json.loads(file.read_bytes())
    for kind, factor in {"recommended": 1.0, "detuned": DETUNED}.items():
        words = ["simulate", profile.name, "--acceleration", repr(factor * a)]
        words += ["--jerk", repr(factor * j), "--filter", behind, "--language", language]
        if language == "en":
            words += ["--json", "out/simulate.json"]
        yield Call(
            place=f"{at}/simulate_{kind}_{language}",
            words=tuple(words),
            files={profile.name: profile},
            is_brief=is_brief,
        )


def filter_words(limits: Mapping[str, Any]) -> str:
    """A setpoint filter as ``simulate --filter`` takes it."""
    held = limits["setpoint_filter"]
    match held and held["kind"]:
        case None | "fir":  # taps cannot be said on the command line
            return "none"
        case "moving_average":
            return f"moving_average:{held['time']!r}s"
        case "two_moving_averages":
            return f"two_moving_averages:{held['time']!r}s:{held['second_time']!r}s"
    return f"{held['kind']}:{held['frequency_hz']!r}Hz:{held['damping_ratio']!r}"


def trace_of(record: Path, folder: Path, name: str) -> Path:
    """The first move as its own model predicts it, every position cycle, between two rests."""
    file = folder / "inputs" / "traces" / f"{name}.csv"
    if not file.exists():
        found = json.loads(record.read_bytes())
        series = found["moves"][0]["series"]
        unit = "rad" if found["machine"]["motion"] == "rotary" else "m"
        sent = json.loads((record.parent / "setpoint.csv.json").read_bytes())
        cycle = sent["t"][1] - sent["t"][0]
        t = cycle * np.arange(-round(REST / cycle), round((series["t"][-1] + REST) / cycle))

        def moved(times: list[float], values: list[float]) -> Array:
            spline = CubicSpline(times, values)(np.clip(t, times[0], times[-1]))
            return np.asarray(spline + coasting * np.maximum(t - times[-1], 0.0))

        coasting = sent["v_ref"][-1]
        signals = [series["signals"][name] for name in ("encoder", "tcp")]
        columns = [moved(sent["t"], sent["x_ref"]), *(moved(series["t"], x) for x in signals)]
        table = np.column_stack([t + REST, *columns])
        rows = [",".join(f"{value:.12g}" for value in row) for row in table]
        head = f"t [s],x_ref [{unit}],encoder [{unit}],tcp [{unit}]"
        write(file, "\n".join([head, *rows]) + "\n")
    return file


def other_calls(folder: Path) -> Iterator[Call]:
    """Commands without a profile, a sweep, and identify."""
    profile = folder / "inputs" / "profiles" / "milling-manipulator.toml"
    given = {profile.name: profile}
    yield Call(place="others/profiles", words=("profiles", "list"))
    yield Call(place="others/validate", words=("validate", "--json", "out/validate.json"))
    answers = ("wizard", "--answers", profile.name, "--yes", "-o", "out/machine.toml")
    yield from spoken("others/wizard", answers, files=given)
    sweep = ("sweep", profile.name, "--f-max", "1kN,2kN", "-o", "out", "--workers", "1")
    yield Call(place="others/sweep", words=sweep, files=given)
    names = {"record.json": "printer-belt", "before.json": "milling-manipulator"}
    records = {file: folder / f"profiles/{x}/run_en/record.json" for file, x in names.items()}
    if all(file.exists() for file in records.values()):
        compare_two = ("sheet", "record.json", "-o", "out", "--compare", "before.json")
        yield from spoken("others/sheet_compare", compare_two, files=records)
    for measured in sorted((folder / "inputs" / "measured").iterdir()):
        words = ("identify", measured.name, "--constant", "0.1 N m/A", "-o", "out/new.toml")
        yield from spoken(
            f"others/identify {measured.name}",
            (*words, "--page", "out/page.html", "--json", "out/identified.json"),
            files={measured.name: measured},
        )


def message_calls(folder: Path) -> Iterator[Call]:
    """``check`` on broken profiles."""
    for case in sorted((folder / "inputs" / "broken").iterdir()):
        words = ("check", case.name)
        yield Call(place=f"messages/{case.stem}", words=words, files={case.name: case})


def make_inputs(folder: Path) -> None:
    """Profiles shipped, broken and random, and measurements, unless they are there already."""
    inputs = folder / "inputs"
    for kind, sources in {
        "profiles": sorted(PROFILES.glob("*.toml")),
        "measured": sorted((ROOT / "tests" / "data" / "identify").rglob("frf-*.csv")),
    }.items():
        if not (inputs / kind).exists():
            (inputs / kind).mkdir(parents=True)
            for source in sources:
                copyfile(source, inputs / kind / source.name)
    if not (inputs / "broken").exists():
        from benchmarks.mutations import dice_of, mutated

        texts = [file.read_text("utf-8") for file in sorted((inputs / "profiles").iterdir())]
        (inputs / "broken").mkdir()
        for seed in range(BROKEN):
            text = mutated(texts[seed % len(texts)], dice_of(33, seed))
            file = inputs / "broken" / f"{seed:03d}.toml"
            file.write_text(text, "utf-8", newline="")
    if not (inputs / "machines").exists():
        made = [random_profile(seed) for seed in range(MACHINES)]
        for number, (kind, text) in enumerate(made):
            write(inputs / "machines" / f"{number:02d}-{kind}.toml", text)


def random_profile(seed: int) -> tuple[str, str]:
    """Kind of control and profile of a machine that could be built; every fourth follows steps."""
    from benchmarks.population import demanding_machine, profile_text, random_machine
    from benchmarks.printers import random_axis

    if seed % 4 == 3:
        kind = FOLLOWERS[seed // 4 % len(FOLLOWERS)]
        return kind, random_axis(seed).profile.replace("'klipper'", f"'{kind}'")
    number = seed - seed // 4
    kind = SERVOS[number % len(SERVOS)]
    is_demanding, is_filtered = number // len(SERVOS) % 2 == 1, number % 3 == 0
    machine = demanding_machine(seed) if is_demanding else random_machine(seed)
    return kind, profile_text(machine, kind=kind, filters_force=is_filtered)


def write_all(folder: Path, only: list[str], *, jobs: int) -> None:
    """Write the parts that are asked for, some machines at a time."""
    make_inputs(folder)

    def inputs(kind: str) -> list[Path]:
        return sorted((folder / "inputs" / kind).iterdir())

    groups: list[tuple[str, Iterator[Call]]] = [
        *(("profiles", profile_calls(file, folder)) for file in inputs("profiles")),
        ("messages", message_calls(folder)),
        ("others", other_calls(folder)),
        *(("machines", machine_calls(file, folder)) for file in inputs("machines")),
        *(("german", german_calls(file, folder)) for file in inputs("profiles")),
    ]

    def work(part: str, calls: Iterator[Call]) -> None:
        for call in calls:
            if not only or part in only or any(call.place.startswith(o) for o in only if "/" in o):
                perform(call, folder)

    if not only or "inventory" in only:
        inventory(folder)
    with ThreadPoolExecutor(jobs) as pool:
        for _, part in groupby(groups, key=lambda group: group[0]):
            for done in [pool.submit(partial(work, *group)) for group in part]:
                done.result()
            inventory_of_answers(folder)
    print("all that was asked for is there", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.frozen",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    writer = commands.add_parser("write")
    writer.add_argument("folder", type=Path)
    writer.add_argument("--only", nargs="+", default=[], metavar="PART")
    writer.add_argument("--inputs", type=Path, help="folder of an earlier state")
    writer.add_argument("--jobs", type=int, choices=(1, 2), default=1, help="processes at a time")
    reader = commands.add_parser("compare")
    reader.add_argument("before", type=Path)
    reader.add_argument("after", type=Path)
    reader.add_argument("--least", type=float, default=1e-6, help="smallest relative change")
    reader.add_argument("--rows", type=int, default=40, help="rows of each list; 0: all")
    reader.add_argument("--at", default="", help="only files whose name holds this, in detail")
    options = parser.parse_args()
    if options.command == "compare":
        chosen = {"least": options.least, "rows": options.rows, "at": options.at}
        print(compare(options.before, options.after, **chosen))
        return
    if options.inputs and not (options.folder / "inputs").exists():
        copytree(options.inputs / "inputs", options.folder / "inputs")
    write_all(options.folder.resolve(), options.only, jobs=options.jobs)


if __name__ == "__main__":
    main()
