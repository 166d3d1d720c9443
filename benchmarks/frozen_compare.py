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

NOISE = 1e-12
"""Numbers that stay below it are rounding: terminal errors and the like [SI]."""

SLOWER = 0.3
"""By how much a settling time may grow before the summary counts it [%]."""

NUMBER = re.compile(r"(?<![\w.])[-−+]?\d[\d\u202f]*(?:[.,]\d+)?(?:e[-+]?\d+)?")
INDEX = re.compile(r"\[[^\]]*\]| line \d+")
MACHINE = re.compile(r"(profiles|machines|messages)/[^/ ]+?(?=[/.])")
LANGUAGE = re.compile(r"_(en|de)(?=[/.])")
NAMES = ("name", "key", "requirement", "way")
"""Keys by which the items of a list are paired, the first that tells them apart."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A number that moved, or the item of an array that moved most; ``size`` is relative."""

    size: float
    place: str
    before: float
    after: float

    def __str__(self) -> str:
        return f"{self.size:9.2g}  {self.place}: {self.before!r} -> {self.after!r}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Settling:
    """The recommendation of ``limits`` for one machine: settling time [s], and verdict."""

    machine: str
    before: float | None
    after: float | None
    verdicts: tuple[str, str]

    @property
    def change(self) -> float:
        """Relative change [%]; inf where only one state has a recommendation."""
        if self.before and self.after:
            return 100.0 * (self.after / self.before - 1.0)
        return 0.0 if self.before == self.after else inf

    def __str__(self) -> str:
        times = [f"{1e3 * t:.5g} ms" if t else "none" for t in (self.before, self.after)]
        verdict = " -> ".join(dict.fromkeys(self.verdicts))
        return (
            f"{self.machine:36s} {times[0]:>12s} {times[1]:>12s} {self.change:+9.3f} %  {verdict}"
        )


@dataclass(slots=True)
class Moved:
    """All that differs between two states."""

    numbers: list[Change] = field(default_factory=list)
    values: list[str] = field(default_factory=list)
    gone: list[str] = field(default_factory=list)
    came: list[str] = field(default_factory=list)
    diffs: dict[str, list[str]] = field(default_factory=dict)
    exits: list[str] = field(default_factory=list)

    def note(self, place: str, old: list[float], new: list[float]) -> None:
        """Note where an array moved most, relative to the largest number in it."""
        scale = max(map(abs, [*old, *new]), default=0.0)
        if old == new or scale < NOISE:
            return
        worst = max(range(len(old)), key=lambda k: abs(new[k] - old[k]))
        size = abs(new[worst] - old[worst]) / scale if scale < inf else inf
        self.numbers.append(Change(size=size, place=place, before=old[worst], after=new[worst]))


def compare(before: Path, after: Path, *, least: float, rows: int, at: str = "") -> str:
    """Say what moved in files whose name holds ``at``; ``rows`` of each list, 0: all of them."""
    old, new = files_of(before, at), files_of(after, at)
    moved = Moved()
    for name in (name for name in old if name in new):
        texts = [(folder / name).read_text("utf-8") for folder in (before, after)]
        if texts[0] == texts[1]:
            continue
        if name.endswith(".json"):
            pair(name, json.loads(texts[0]), json.loads(texts[1]), moved)
        elif name.startswith("inventory"):
            sets = [dict.fromkeys(text.splitlines()) for text in texts]
            moved.gone += [f"{name}: {line}" for line in sets[0] if line not in sets[1]]
            moved.came += [f"{name}: {line}" for line in sets[1] if line not in sets[0]]
        else:
            pair_texts(name, texts[0].splitlines(), texts[1].splitlines(), moved)
    moved.numbers = sorted(
        (change for change in moved.numbers if change.size >= least), key=lambda c: -c.size
    )
    went = [f"- {name}" for name in old if name not in new]
    files = [*went, *(f"+ {name}" for name in new if name not in old)]
    settling = [row for row in settling_rows(before, after) if at in row.machine]
    lines = [
        f"{len(old) - len(went)} files in both states, {len(went)} only before, "
        f"{len(files) - len(went)} only after",
        *summary(moved, settling, least),
        *listed("Files that went (-) or came (+)", by_kind(files), rows),
        *details(moved, settling, rows, is_grouped=not at),
        *listed("Processor time by the fixed piece of work", time_rows(before, after), 0),
        *(line for name in moved.diffs for line in listed(f"--- {name}", moved.diffs[name], rows)),
    ]
    return "\n".join(lines)


def files_of(folder: Path, at: str) -> dict[str, None]:
    """Names of the files of a state, inputs and times apart."""
    found = (file.relative_to(folder) for file in sorted(folder.rglob("*")) if file.is_file())
    wanted = (str(name) for name in found if name.parts[0] not in ("inputs", "times"))
    return dict.fromkeys(name for name in wanted if at in name)


def pair(place: str, old: Any, new: Any, moved: Moved) -> None:
    """Compare two values of JSON, place by place."""
    match old, new:
        case dict(), dict():
            for key in {**old, **new}:
                below = f"{place} {key}" if place.endswith(".json") else f"{place}.{key}"
                if key in VOLATILE:
                    continue
                if key in old and key in new:
                    pair(below, old[key], new[key], moved)
                else:
                    (moved.gone if key in old else moved.came).append(below)
        case list(), list():
            pair_lists(place, old, new, moved)
        case _ if is_number(old) and is_number(new):
            moved.note(place, [old], [new])
        case _ if old != new:
            moved.values.append(f"{place}: {shown(old)} -> {shown(new)}")


def pair_lists(place: str, old: list[Any], new: list[Any], moved: Moved) -> None:
    """Compare two lists: numbers as one thing, items by their names, else by their order."""
    named = [by_name(items) for items in (old, new)]
    if named[0] and named[1]:
        for key in {**named[0], **named[1]}:
            below = f"{place}[{key}]"
            if key in named[0] and key in named[1]:
                pair(below, named[0][key], named[1][key], moved)
            else:
                (moved.gone if key in named[0] else moved.came).append(below)
    elif len(old) != len(new):
        moved.values.append(f"{place}: {len(old)} -> {len(new)} items")
    elif all(item is None or is_number(item) for item in [*old, *new]):
        both = [(a, b) for a, b in zip(old, new, strict=True) if a is not None and b is not None]
        moved.note(place, [a for a, _ in both], [b for _, b in both])
        lone = sum((a is None) != (b is None) for a, b in zip(old, new, strict=True))
        if lone:
            moved.values.append(f"{place}: {lone} of {len(old)} items are null in one state only")
    else:
        for k, (one, other) in enumerate(zip(old, new, strict=True)):
            pair(f"{place}[{k}]", one, other, moved)


def by_name(items: list[Any]) -> dict[str, Any]:
    """The items by a key that tells them apart; none where nothing does."""
    for name in NAMES:
        if items and all(isinstance(item, dict) and name in item for item in items):
            found = {shown(item[name]): item for item in items}
            if len(found) == len(items):
                return found
    return {}


def is_number(value: Any) -> bool:
    """Whether a value of JSON is a number, which true is not."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def shown(value: Any) -> str:
    """A value on one line, without brackets."""
    text = re.sub(r"[\[\]{}\"]", "", json.dumps(value, ensure_ascii=False))
    return text if len(text) <= 90 else f"{text[:87]}..."


def pair_texts(name: str, old: list[str], new: list[str], moved: Moved) -> None:
    """Compare two texts: numbers where the words are the same, else the lines."""
    heads = [lines[0] if lines else "" for lines in (old, new)]
    if heads[0].startswith("exit ") and heads[0] != heads[1]:
        moved.exits.append(f"{name}: {heads[0]} -> {heads[1]}")
        old, new = old[1:], new[1:]
    masks = [[NUMBER.sub("#", line) for line in lines] for lines in (old, new)]
    lines: list[str] = []
    for tag, a, b, c, d in SequenceMatcher(None, masks[0], masks[1], autojunk=False).get_opcodes():
        if tag != "equal":
            lines += [f"@@ {a + 1}", *(f"-{line}" for line in old[a:b])]
            lines += [f"+{line}" for line in new[c:d]]
            continue
        for k, (one, other) in enumerate(zip(old[a:b], new[c:d], strict=True), start=c + 1):
            for was, now in zip(NUMBER.findall(one), NUMBER.findall(other), strict=True):
                moved.note(f"{name} line {k}", [read(was)], [read(now)])
    if lines:
        moved.diffs[name] = lines


def read(text: str) -> float:
    """A printed number, German or English."""
    return float(text.replace("−", "-").replace("\u202f", "").replace(",", "."))


def settling_rows(before: Path, after: Path) -> list[Settling]:
    """Recommendations of both states, largest change first."""
    places = [file.parent.relative_to(before) for file in before.glob("*/*/limits_en.txt")]
    rows = []
    for place in sorted(places):
        if (after / place / "limits_en.txt").exists():
            was, now = (outcome(folder / place) for folder in (before, after))
            rows.append(
                Settling(machine=str(place), before=was[0], after=now[0], verdicts=(was[1], now[1]))
            )
    return sorted(rows, key=lambda row: -row.change)


def outcome(place: Path) -> tuple[float | None, str]:
    """Recommended settling time [s], and verdict, or how the message ends where there is none."""
    first, *lines = (place / "limits_en.txt").read_text("utf-8").splitlines()
    file = place / "limits_en" / "limits.json"
    if file.exists():
        verdict = {"exit 0": "met", "exit 1": "not met"}.get(first, first)
        return json.loads(file.read_bytes())["recommended"]["settling_time"], verdict
    message = [line for line in lines if not line.startswith("---")]
    return None, f"{first}: {' '.join(message)[:70]}"


def time_rows(before: Path, after: Path) -> list[str]:
    """Processor time of each command over that of the fixed piece of work: median, and largest."""

    both = {file.name for file in before.glob("times/*.json")}
    both &= {file.name for file in after.glob("times/*.json")}

    def ratios(folder: Path) -> dict[str, list[float]]:
        found: dict[str, list[float]] = {}
        for file in (folder / "times" / name for name in sorted(both)):
            part, *_, command = file.stem.split(" ")
            command = "export" if "export" in file.stem else command
            key = f"{part}: {command}" if part in ("profiles", "machines") else file.stem
            found.setdefault(key, []).append(json.loads(file.read_bytes())["ratio"])
        return found

    old, new = ratios(before), ratios(after)
    rows = []
    for key in old:
        (a, most_a), (b, most_b) = ((sorted(x)[len(x) // 2], max(x)) for x in (old[key], new[key]))
        rows.append(
            f"{key:44s} {a:8.1f} -> {b:8.1f}  x {b / a:.3f}"
            f"  largest {most_a:8.1f} -> {most_b:8.1f}  x {most_b / most_a:.3f}"
        )
    return rows


def summary(moved: Moved, settling: list[Settling], least: float) -> Iterator[str]:
    """Counts, a line each."""
    slower = [row for row in settling if row.change > SLOWER]
    turned = sum(row.verdicts[0] != row.verdicts[1] for row in settling)
    most = max((row.change for row in settling), default=0.0)
    yield (
        f"settling times of {len(settling)} machines: {len(slower)} longer by more than"
        f" {SLOWER} % (most {most:+.3f} %), {turned} verdicts differ"
    )
    yield f"{len(moved.exits)} exit codes differ"
    yield f"{len(moved.gone)} keys and entries went, {len(moved.came)} came"
    sizes = [change.size for change in moved.numbers]
    for edge in (1e-1, 1e-2, 1e-3, least):
        yield f"{sum(size >= edge for size in sizes)} numbers moved by {edge:g} and more (relative)"
    yield f"{len(moved.values)} other values differ"
    yield f"{len(moved.diffs)} texts differ in their words"


def details(
    moved: Moved, settling: list[Settling], rows: int, *, is_grouped: bool
) -> Iterator[str]:
    """The lists, each under its heading; numbers grouped by kind, or each by itself."""
    yield from listed("Exit codes", moved.exits, rows)
    yield from listed("Keys and entries that went", by_kind(moved.gone), rows)
    yield from listed("Keys and entries that came", by_kind(moved.came), rows)
    changed = [str(row) for row in settling if row.change or row.verdicts[0] != row.verdicts[1]]
    yield from listed("Settling times of the recommendations: before, after, verdict", changed, 0)
    counts = Counter(kind_of(change.place) for change in moved.numbers)
    largest = {kind_of(change.place): change for change in reversed(moved.numbers)}
    numbers = [
        f"{change}" + (f"  ({counts[kind]} alike)" if counts[kind] > 1 else "")
        for kind, change in reversed(largest.items())
    ]
    if not is_grouped:
        numbers = [str(change) for change in moved.numbers]
    yield from listed("Numbers, largest change first", numbers, rows)
    values = {kind_of(value): value for value in reversed(moved.values)} if is_grouped else {}
    others = list(reversed(values.values())) if is_grouped else moved.values
    yield from listed("Other values, one of each kind", others, rows)


def kind_of(place: str) -> str:
    """A place with machine, language and index left out."""
    return INDEX.sub("[]", LANGUAGE.sub("_*", MACHINE.sub(r"\1/*", place)))


def by_kind(places: Iterable[str]) -> list[str]:
    """Kinds of place, each once, and how often it was there."""
    counts = Counter(map(kind_of, places))
    return [f"{kind}  ({count} times)" if count > 1 else kind for kind, count in counts.items()]


def listed(heading: str, lines: list[str], rows: int) -> Iterator[str]:
    """A list under its heading, cut where it is long; nothing where it is empty."""
    if lines:
        shown_lines = lines[:rows] if rows else lines
        yield from ("", heading, *(f"  {line}" for line in shown_lines))
        if len(lines) > len(shown_lines):
            yield f"  ... and {len(lines) - len(shown_lines)} more (--rows 0)"
