"""Tables with named columns: responses by frequency, and signals by time.

The names are those of docs/identification.md; others are taken where their words or units leave
one reading, or where ``--columns NAME=COLUMN`` says which they are.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from mtcommission.identify.formats.contents import (
    Column,
    FileContents,
    Item,
    ResponseContents,
    TimeContents,
    refuse,
)
from mtcommission.identify.formats.heads import CLOCK, find_column, split_head, words_of
from mtcommission.identify.formats.table import Table, read_table
from mtcommission.identify.measurement import Array, ComplexArray
from mtcommission.messages.message import Message

FREQUENCY = "frequency_hz"

_FREQUENCIES = frozenset({"f", "freq", "frequency", "frequenz", "omega", "ω"})
_TIMES = frozenset({"t", "time", "zeit", "timestamp"})
_SECONDS = {"": 1.0, "s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
_HERTZ = {"": 1.0, "hz": 1.0, "khz": 1e3, "rad/s": 0.5 / pi, "1/s": 1.0}
_RADIANS = {"": pi / 180, "deg": pi / 180, "°": pi / 180, "grad": pi / 180, "rad": 1.0}
_PARTS = {
    "re": frozenset({"re", "real", "realteil"}),
    "im": frozenset({"im", "imag", "imaginary", "imaginär", "imaginärteil", "imaginaerteil"}),
    "magnitude": frozenset(
        {"magnitude", "mag", "amplitude", "gain", "betrag", "abs", "modulus", "amplitudengang"}
    ),
    "phase": frozenset({"phase", "arg", "phasengang", "phi", "angle"}),
    "coherence": frozenset({"coherence", "coh", "kohärenz", "kohaerenz", "gamma", "γ²"}),
}
_NO_LABELS = frozenset({"hz", "deg", "db", "of", "part", "teil", "h", "g", "frf", "2", "squared"})
_SETTING = re.compile(r"^[#%!]\s*([a-z_]+)\s*[:=]\s*(\S.*?)\s*$", re.IGNORECASE)
_SAID = ("sensor", "input", "output", "constant")


@dataclass(frozen=True, slots=True)
class _Head:
    """Name, unit and words of a column."""

    name: str
    unit: str
    words: tuple[str, ...]


def read_plain(lines: Sequence[str], columns: Mapping[str, str], *, where: str) -> FileContents:
    """Return what a table holds.

    Raise InputError where it is no table, or has neither times nor frequencies.
    """
    table = read_table(lines, where=where)
    heads = [_head_of(head) for head in table.heads]
    settings = dict(_settings(table.comments))
    said = tuple((name, settings[name]) for name in _SAID if name in settings)
    remarks = [Message("identify-cut", line=table.cut_line)] if table.cut_line else []
    frequency = _find(heads, columns, FREQUENCY, _FREQUENCIES)
    items: tuple[Item, ...]
    if frequency is not None:
        kind, averages = "response-table", _positive(settings.get("averages", ""))
        items = _responses(table, heads, columns, frequency, averages, where=where)
    else:
        kind = "time-table" if any(table.heads) else "halsampler"
        record, more = _record(table, heads, columns, where=where)
        items, remarks = (record,), [*remarks, *more]
    return FileContents(
        format=Message(f"identify-format-{kind}"),
        items=items,
        measured_on=settings.get("date", ""),
        state=settings.get("state", ""),
        said=said,
        remarks=tuple(remarks),
    )


def _head_of(head: str) -> _Head:
    name, unit = split_head(head)
    return _Head(name, unit, words_of(name))


def _settings(comments: Sequence[str]) -> list[tuple[str, str]]:
    matches = (_SETTING.match(line) for line in comments)
    return [(match[1].casefold(), match[2]) for match in matches if match]


def _positive(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0.0 < value < np.inf else None


def _find(
    heads: Sequence[_Head], columns: Mapping[str, str], name: str, words: frozenset[str]
) -> int | None:
    if name in columns:
        return find_column([head.name for head in heads], columns[name])[0]
    places = [place for place, head in enumerate(heads) if head.words and head.words[0] in words]
    return places[0] if places else None


def _responses(
    table: Table,
    heads: Sequence[_Head],
    columns: Mapping[str, str],
    frequency: int,
    averages: float | None,
    *,
    where: str,
) -> tuple[ResponseContents, ...]:
    groups = _groups(heads, columns, frequency)
    unit = heads[frequency].unit.casefold() or (
        "rad/s" if "omega" in heads[frequency].words else ""
    )
    if unit not in _HERTZ:
        raise refuse(where, "identify-frequency-unit", got=heads[frequency].unit)
    hertz = table.values[:, frequency] * _HERTZ[unit]
    found = []
    common = [group["coherence"] for group in groups.values() if set(group) == {"coherence"}]
    for label, group in groups.items():
        if not {"re", "im"} <= set(group) and not {"magnitude", "phase"} <= set(group):
            continue
        values, response_unit = _complex(table.values, heads, group, where=where)
        place = group.get("coherence", common[0] if len(common) == 1 else None)
        coherence = None
        if place is not None:
            percent = heads[place].unit == "%"
            coherence = table.values[:, place] * (0.01 if percent else 1.0)
        found.append(
            ResponseContents(
                label=label,
                frequency_hz=hertz,
                values=values,
                unit=response_unit,
                coherence=coherence,
                averages=averages,
                lines=table.lines,
            )
        )
    if not found:
        raise refuse(where, "identify-no-response", found=_shown(heads))
    return tuple(found)


def _groups(
    heads: Sequence[_Head], columns: Mapping[str, str], frequency: int
) -> dict[str, dict[str, int]]:
    """Places of the parts of each response, by its label."""
    names = [head.name for head in heads]
    chosen = {part: find_column(names, columns[part])[0] for part in _PARTS if part in columns}
    if chosen:
        return {"": chosen}
    groups: dict[str, dict[str, int]] = {}
    for place, head in enumerate(heads):
        part = next((part for part, words in _PARTS.items() if words & set(head.words)), None)
        if part is None or place == frequency:
            continue
        rest = [word for word in head.words if word not in _PARTS[part] | _NO_LABELS]
        label, count = " ".join(rest), 1
        while part in groups.setdefault(label, {}):
            count += 1
            label = " ".join([*rest, str(count)])
        groups[label][part] = place
    return groups


def _complex(
    values: Array, heads: Sequence[_Head], group: Mapping[str, int], *, where: str
) -> tuple[ComplexArray, str]:
    """Values of a response, and the unit of its output per input."""
    if "re" in group:
        unit = heads[group["re"]].unit or heads[group["im"]].unit
        return values[:, group["re"]] + 1j * values[:, group["im"]], unit
    size, unit = values[:, group["magnitude"]], heads[group["magnitude"]].unit
    angle_unit = heads[group["phase"]].unit
    if angle_unit.casefold() not in _RADIANS:
        raise refuse(where, "identify-phase-unit", got=angle_unit)
    if unit.casefold().startswith("db"):
        size = 10.0 ** (np.clip(size, -600.0, 600.0) / 20.0)
        unit = re.sub(r"^dB\s*(?:re|rel|bez)?\.?\s*1?\s*", "", unit, flags=re.IGNORECASE)
    elif (size < 0.0).any():
        raise refuse(where, "identify-negative-magnitude", least=float(size.min()))
    phase = values[:, group["phase"]] * _RADIANS[angle_unit.casefold()]
    return size * np.exp(1j * phase), unit


def _record(
    table: Table, heads: Sequence[_Head], columns: Mapping[str, str], *, where: str
) -> tuple[TimeContents, list[Message]]:
    clock_place = _find(heads, columns, CLOCK, _TIMES)
    rows, remarks = _longest_stretch(table)
    clock = None
    if clock_place is not None:
        _, said = find_column(
            [head.name for head in heads], columns.get(CLOCK, heads[clock_place].name)
        )
        unit = (said or heads[clock_place].unit).casefold()
        if unit not in _SECONDS:
            raise refuse(where, "identify-time-unit", got=heads[clock_place].unit)
        clock = table.values[rows, clock_place] * _SECONDS[unit]
    found = tuple(
        Column(name=head.name or str(place + 1), unit=head.unit, values=table.values[rows, place])
        for place, head in enumerate(heads)
        if place != clock_place
    )
    return TimeContents(clock=clock, columns=found, lines=table.lines[rows]), remarks


def _longest_stretch(table: Table) -> tuple[slice, list[Message]]:
    """Rows without lost samples, as many as there are in one piece."""
    size = table.lines.size
    if not table.breaks:
        return slice(0, size), []
    ends = [0, *table.breaks, size]
    first, last = max(itertools.pairwise(ends), key=lambda pair: pair[1] - pair[0])
    return slice(first, last), [
        Message("identify-overruns", count=len(table.breaks), kept=last - first, of=size)
    ]


def _shown(heads: Sequence[_Head]) -> tuple[str, ...]:
    return tuple(
        f"{place}: {head.name or '?'}{f' [{head.unit}]' if head.unit else ''}"
        for place, head in enumerate(heads, start=1)
    )
