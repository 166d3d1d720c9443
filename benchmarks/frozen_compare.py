"""What moved between two states that ``benchmarks.frozen`` wrote: a summary first, details after.

Numbers are paired by their place and compared relatively; an array of numbers is one thing,
compared with its largest number. Lines of text are paired with their numbers left out: where the
words are the same the numbers are compared like others (as printed), the rest is shown as a diff.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from math import inf
from pathlib import Path
from typing import Any

VOLATILE = frozenset({"solve_time", "checksum", "libraries", "created"})
"""Keys that differ between two runs of one state, or with what is installed."""

NUMBER = re.compile(r"(?<![\w.])[-−+]?\d[\d\u202f]*(?:[.,]\d+)?(?:e[-+]?\d+)?")
INDEX = re.compile(r"\[\d+\]")
APART = ("inputs", "times")


@dataclass(slots=True)
class Moved:
    """All that differs between two states."""

    numbers: list[tuple[float, str, float, float]] = field(default_factory=list)
    values: list[str] = field(default_factory=list)
    gone: list[str] = field(default_factory=list)
    came: list[str] = field(default_factory=list)
    diffs: dict[str, list[str]] = field(default_factory=dict)
    exits: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)


def compare(before: Path, after: Path, *, least: float, rows: int) -> str:
    """Say what moved; ``rows`` of each list at most, all of them where it is 0."""
    old, new = files_of(before), files_of(after)
    moved = Moved(files=[f"- {name}" for name in old if name not in new])
    moved.files += [f"+ {name}" for name in new if name not in old]
    for name in (name for name in old if name in new):
        texts = [(folder / name).read_text("utf-8") for folder in (before, after)]
        if texts[0] == texts[1]:
            continue
        if name.endswith(".json"):
            pair(name, *(json.loads(text) for text in texts), moved)
        elif name.startswith("inventory"):
            sets = [dict.fromkeys(text.splitlines()) for text in texts]
            moved.gone += [f"{name}: {line}" for line in sets[0] if line not in sets[1]]
            moved.came += [f"{name}: {line}" for line in sets[1] if line not in sets[0]]
        else:
            pair_texts(name, texts[0].splitlines(), texts[1].splitlines(), moved)
    moved.numbers = sorted((row for row in moved.numbers if row[0] >= least), reverse=True)
    settling, times = settling_rows(before, after), time_rows(before, after)
    return "\n".join([*summary(moved, old, new, least), *details(moved, settling, times, rows)])


def files_of(folder: Path) -> list[str]:
    """Names of the files of a state, inputs and times apart."""
    found = (file.relative_to(folder) for file in sorted(folder.rglob("*")) if file.is_file())
    return [str(name) for name in found if name.parts[0] not in APART and name.suffix != ".log"]


def pair(place: str, old: Any, new: Any, moved: Moved) -> None:
    """Compare two values of JSON, place by place."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in (
            key for key in [*old, *(k for k in new if k not in old)] if key not in VOLATILE
        ):
            below = f"{place} {key}" if place.endswith(".json") else f"{place}.{key}"
            if key in old and key in new:
                pair(below, old[key], new[key], moved)
            else:
                (moved.gone if key in old else moved.came).append(below)
    elif is_number(old) and is_number(new):
        note_number(place, [old], [new], moved)
    elif isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            moved.values.append(f"{place}: {len(old)} -> {len(new)} items")
        elif old and all(map(is_number, [*old, *new])):
            note_number(place, old, new, moved)
        else:
            for k, (one, other) in enumerate(zip(old, new, strict=True)):
                pair(f"{place}[{k}]", one, other, moved)
    elif old != new:
        moved.values.append(f"{place}: {shown(old)} -> {shown(new)}")


def is_number(value: Any) -> bool:
    """Whether a value of JSON is a number, which true is not."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def shown(value: Any) -> str:
    """A value on one line."""
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


def note_number(place: str, old: list[float], new: list[float], moved: Moved) -> None:
    """Note the place of an array where it moved most, relative to the largest number in it."""
    worst = max(range(len(old)), key=lambda k: abs(new[k] - old[k]))
    scale = max(map(abs, [*old, *new]))
    if old[worst] != new[worst]:
        change = abs(new[worst] - old[worst]) / scale if scale < inf else inf
        moved.numbers.append((change, place, old[worst], new[worst]))


def pair_texts(name: str, old: list[str], new: list[str], moved: Moved) -> None:
    """Compare two texts: numbers where the words are the same, else the lines."""
    masks = [[NUMBER.sub("#", line) for line in lines] for lines in (old, new)]
    if name.endswith(".txt") and old[0] != new[0] and old[0].startswith("exit "):
        moved.exits.append(f"{name}: {old[0]} -> {new[0]}")
    lines: list[str] = []
    for tag, a, b, c, d in SequenceMatcher(None, *masks, autojunk=False).get_opcodes():
        if tag != "equal":
            lines += [
                f"@@ line {a + 1}",
                *(f"-{x}" for x in old[a:b]),
                *(f"+{x}" for x in new[c:d]),
            ]
            continue
        for k, (one, other) in enumerate(zip(old[a:b], new[c:d], strict=True), start=c + 1):
            for was, now in zip(NUMBER.findall(one), NUMBER.findall(other), strict=True):
                if was != now:
                    note_number(f"{name} line {k}", [read(was)], [read(now)], moved)
    if lines:
        moved.diffs[name] = lines


def read(text: str) -> float:
    """A printed number, German or English."""
    return float(text.replace("−", "-").replace("\u202f", "").replace(",", "."))


def settling_rows(before: Path, after: Path) -> list[tuple[str, str, str, float, str]]:
    """Machine, settling times, change [%], and exit codes of ``limits``, worst change first."""
    rows = []
    places = {file.parent for file in before.glob("*/*/limits_en.txt")}
    for place in sorted(folder.relative_to(before) for folder in places):
        if not (after / place / "limits_en.txt").exists():
            continue
        was, now = (outcome(folder / place) for folder in (before, after))
        change = 100.0 * (now[0] / was[0] - 1.0) if was[0] and now[0] else inf
        if was != now:
            times = [f"{1e3 * one[0]:.5g} ms" if one[0] else "none" for one in (was, now)]
            rows.append((str(place), times[0], times[1], change, f"{was[1]} -> {now[1]}"))
    return sorted(rows, key=lambda row: -row[3])


def outcome(place: Path) -> tuple[float | None, str]:
    """Recommended settling time [s], and verdict, or how the message begins where there is none."""
    first, *lines = (place / "limits_en.txt").read_text("utf-8").splitlines()
    file = place / "limits_en" / "limits.json"
    found = json.loads(file.read_bytes())["recommended"] if file.exists() else None
    if found:
        verdict = {"exit 0": "met", "exit 1": "not met"}.get(first, first)
        return found["settling_time"], verdict
    return None, f"{first}: {lines[-1][:50] if lines else ''}"


def time_rows(before: Path, after: Path) -> list[tuple[str, float, float]]:
    """Command, and processor time over that of the fixed piece of work: median of all machines."""

    def ratios(folder: Path) -> dict[str, list[float]]:
        found: dict[str, list[float]] = {}
        for file in sorted(folder.glob("times/*.json")):
            part, *_, command = file.stem.split(" ")
            ratio = json.loads(file.read_bytes())["ratio"]
            for key in (
                (f"{part}: {command}",) if part in ("profiles", "machines") else (file.stem,)
            ):
                found.setdefault(key, []).append(ratio)
        return found

    old, new = ratios(before), ratios(after)
    return [(key, median(old[key]), median(new[key])) for key in old if key in new]


def median(values: list[float]) -> float:
    """The middle one, the upper of two."""
    return sorted(values)[len(values) // 2]


def summary(moved: Moved, old: list[str], new: list[str], least: float) -> Iterator[str]:
    """Counts, a line each."""
    only_old = sum(line.startswith("-") for line in moved.files)
    both = len(old) - only_old
    yield f"{both} files in both states, {only_old} only before, {len(new) - both} only after"
    yield f"{len(moved.exits)} exit codes differ"
    yield f"{len(moved.gone)} keys and entries went, {len(moved.came)} came"
    for edge in (1e-1, 1e-2, 1e-3, least):
        count = sum(row[0] >= edge for row in moved.numbers)
        yield f"{count} numbers moved by {edge:g} and more (relative)"
    yield f"{len(moved.values)} other values differ"
    yield f"{len(moved.diffs)} texts differ in their words"


def details(
    moved: Moved,
    settling: list[tuple[str, str, str, float, str]],
    times: list[tuple[str, float, float]],
    rows: int,
) -> Iterator[str]:
    """The lists, each under its heading."""
    yield from listed("Exit codes", moved.exits, rows)
    yield from listed("Files that went (-) or came (+)", by_kind(moved.files), rows)
    yield from listed("Keys and entries that went", by_kind(moved.gone), rows)
    yield from listed("Keys and entries that came", by_kind(moved.came), rows)
    table = [f"{a:44s} {b:>12s} {c:>12s} {d:+9.3f} %  {e}" for a, b, c, d, e in settling]
    yield from listed("Settling times of the recommendations", table, rows)
    numbers = [f"{a:9.2g}  {c!r} -> {d!r}  {b}" for a, b, c, d in moved.numbers]
    yield from listed("Numbers, largest change first", numbers, rows)
    yield from listed("Other values", moved.values, rows)
    ratios = [f"{a:44s} {b:9.2f} {c:9.2f}  x {c / b:.3f}" for a, b, c in times]
    yield from listed("Processor time in units of the fixed piece of work, median", ratios, rows)
    for name, lines in moved.diffs.items():
        yield from listed(f"--- {name}", lines, rows)


def by_kind(places: Iterable[str]) -> list[str]:
    """Places with machine and index left out, each once, and how often it was there."""
    kinds = (
        re.sub(r"(profiles|machines|messages)/[^/ ]+?(?=[/.])", r"\1/*", one) for one in places
    )
    counts = Counter(INDEX.sub("[]", kind) for kind in kinds)
    return [f"{kind}  ({count} times)" if count > 1 else kind for kind, count in counts.items()]


def listed(heading: str, lines: list[str], rows: int) -> Iterator[str]:
    """A list under its heading, cut where it is long; nothing where it is empty."""
    if lines:
        shown_lines = lines[:rows] if rows else lines
        yield from ("", heading, *(f"  {line}" for line in shown_lines))
        if len(lines) > len(shown_lines):
            yield f"  ... and {len(lines) - len(shown_lines)} more (--rows 0)"
