"""Tables with named columns: responses by frequency, and signals by time; LinuxCNC's, too.

The names are those of docs/identification.md; others are taken where their words or units leave
one reading, or where ``--columns NAME=COLUMN`` says which they are.

LinuxCNC's formats were read in src/hal/utils/scope_files.c (halscope: a line with the sampling
period in ns, names of the channels, values, all with ``;``) and src/hal/components/sampler_usr.c
(halsampler: values with blanks, no names, with ``-t`` the number of the sample first; ``overrun``
where samples were lost).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise
from math import isfinite, pi

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.measured.formats.table import (
    CLOCK,
    Head,
    Table,
    find_column,
    read_table,
    words_of,
)
from mtcommission.measured.measurement import (
    INPUTS,
    MOTIONS,
    Column,
    ComplexArray,
    FileContents,
    Given,
    Item,
    ResponseContents,
    Sensor,
    Signal,
    TimeContents,
    broken,
)

FREQUENCY = "frequency_hz"

_FREQUENCIES = ("f", "freq", "frequency", "frequenz", "omega", "ω")
_TIMES = ("t", "time", "zeit", "timestamp")
_SECONDS = {"": 1.0, "s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
_HERTZ = {"": 1.0, "hz": 1.0, "khz": 1e3, "rad/s": 0.5 / pi, "1/s": 1.0}
_RADIANS = {"": pi / 180, "deg": pi / 180, "°": pi / 180, "grad": pi / 180, "rad": 1.0}
_PARTS = {
    "re": {"re", "real", "realteil"},
    "im": {"im", "imag", "imaginary", "imaginär", "imaginärteil", "imaginaerteil"},
    "magnitude": {"magnitude", "mag", "amplitude", "gain", "betrag", "abs", "modulus",
                  "amplitudengang"},
    "phase": {"phase", "arg", "phasengang", "phi", "angle"},
    "coherence": {"coherence", "coh", "kohärenz", "kohaerenz", "gamma", "γ²"},
}  # fmt: skip
_NO_LABELS = {"hz", "deg", "db", "of", "part", "teil", "h", "g", "frf", "2", "squared"}
_SETTING = re.compile(r"^[#%!]\s*([a-z_]+)\s*[:=]\s*(\S.*?)\s*$", re.IGNORECASE)


def read_plain(lines: Sequence[str], columns: Mapping[str, str]) -> FileContents:
    """Return what a table holds."""
    table = read_table(lines)
    heads, remarks = table.heads, table.remarks
    matches = filter(None, map(_SETTING.match, table.comments))
    settings = {match[1].casefold(): match[2] for match in matches}
    frequency = _find(heads, columns, FREQUENCY, _FREQUENCIES)
    items: tuple[Item, ...]
    if frequency is not None:
        averages = _number(settings, "averages")
        items = tuple(_responses(table, columns, frequency, averages))
        if not items:
            found = (f"{h.name or '?'}{f' [{h.unit}]' if h.unit else ''}" for h in heads)
            shown = tuple(f"{place}: {one}" for place, one in enumerate(found, start=1))
            raise broken("identify-no-response", found=shown)
    else:
        record, more = _record(table, columns)
        items, remarks = (record,), (*remarks, *more)
    return FileContents(
        items=items,
        measured_on=settings.get("date", ""),
        state=settings.get("state", ""),
        said=_said(settings),
        remarks=remarks,
    )


def _said(settings: Mapping[str, str]) -> Given:
    """What comments say where the command line may say it."""

    def word(key: str, known: Collection[str]) -> str:
        got = settings.get(key, "")
        if got and got not in known:
            raise broken("identify-setting-unknown", got=got)
        return got

    sensor, output = word("sensor", tuple(Sensor)), word("output", MOTIONS)
    return Given(
        sensor=Sensor(sensor) if sensor else None,
        input=word("input", INPUTS),
        output=Signal(output) if output else None,
        constant=_number(settings, "constant"),
    )


def _number(settings: Mapping[str, str], key: str) -> float | None:
    text = settings.get(key)
    try:
        value = float(text) if text else None
    except ValueError:
        value = 0.0
    if value is not None and (value == 0.0 or not isfinite(value)):
        raise broken("identify-setting-unknown", got=text or "")
    return value


def _find(
    heads: Sequence[Head], columns: Mapping[str, str], name: str, words: Collection[str]
) -> int | None:
    if name in columns:
        return find_column([head.name for head in heads], columns[name])[0]
    first = (words_of(head.name)[:1] for head in heads)
    return next((place for place, word in enumerate(first) if set(word) & set(words)), None)


def _responses(
    table: Table, columns: Mapping[str, str], frequency: int, averages: float | None
) -> Iterator[ResponseContents]:
    heads = table.heads
    groups = _groups(heads, columns, frequency)
    in_words = "rad/s" if "omega" in words_of(heads[frequency].name) else ""
    hertz = _HERTZ.get(heads[frequency].unit.casefold() or in_words)
    if hertz is None:
        raise broken("identify-unit-of", got=heads[frequency].unit, units="Hz, kHz, rad/s")
    common = [group["coherence"] for group in groups.values() if set(group) == {"coherence"}]
    for label, group in groups.items():
        if not {"re", "im"} <= set(group) and not {"magnitude", "phase"} <= set(group):
            continue
        values, unit = _complex(table, group)
        place = group.get("coherence", common[0] if len(common) == 1 else None)
        coherence = None
        if place is not None:
            coherence = table.values[:, place] * (0.01 if heads[place].unit == "%" else 1.0)
        yield ResponseContents(
            label=label,
            frequency_hz=table.values[:, frequency] * hertz,
            values=values,
            unit=unit,
            coherence=coherence,
            averages=averages,
            lines=table.lines,
        )


def _groups(
    heads: Sequence[Head], columns: Mapping[str, str], frequency: int
) -> dict[str, dict[str, int]]:
    """Places of the parts of each response, by its label."""
    names = [head.name for head in heads]
    chosen = {part: find_column(names, columns[part])[0] for part in _PARTS if part in columns}
    if chosen:
        return {"": chosen}
    groups: dict[str, dict[str, int]] = {}
    for place, head in enumerate(heads):
        words = words_of(head.name)
        part = next((part for part, known in _PARTS.items() if known & set(words)), None)
        if part is None or place == frequency:
            continue
        rest = [word for word in words if word not in _PARTS[part] | _NO_LABELS]
        label, count = " ".join(rest), 1
        while part in groups.setdefault(label, {}):
            count += 1
            label = " ".join([*rest, str(count)])
        groups[label][part] = place
    return groups


def _complex(table: Table, group: Mapping[str, int]) -> tuple[ComplexArray, str]:
    """Values of a response, and the unit of its output per input."""
    heads = table.heads
    if "re" in group:
        real, imaginary = group["re"], group["im"]
        unit = heads[real].unit or heads[imaginary].unit
        return table.values[:, real] + 1j * table.values[:, imaginary], unit
    size, unit = table.values[:, group["magnitude"]], heads[group["magnitude"]].unit
    angle = heads[group["phase"]].unit
    if angle.casefold() not in _RADIANS:
        raise broken("identify-unit-of", got=angle, units="deg, rad")
    if unit.casefold().startswith("db"):
        size = 10.0 ** (np.clip(size, -600.0, 600.0) / 20.0)
        unit = re.sub(r"^dB\s*(?:re|rel|bez)?\.?\s*1?\s*", "", unit, flags=re.IGNORECASE)
    elif (size < 0.0).any():
        raise broken("identify-negative-magnitude", least=float(size.min()))
    phase = table.values[:, group["phase"]] * _RADIANS[angle.casefold()]
    return size * np.exp(1j * phase), unit


def _record(table: Table, columns: Mapping[str, str]) -> tuple[TimeContents, list[Message]]:
    """The columns over time, of rows without lost samples as many as there are in one piece."""
    heads, ends, remarks = table.heads, [0, *table.breaks, table.lines.size], []
    first, last = max(pairwise(ends), key=lambda pair: pair[1] - pair[0])
    if table.breaks:
        lost = {"count": len(table.breaks), "kept": last - first, "of": table.lines.size}
        remarks.append(Message("identify-overruns", **lost))
    clock, place = None, _find(heads, columns, CLOCK, _TIMES)
    if place is not None:
        wanted = columns.get(CLOCK, heads[place].name)
        _, said = find_column([head.name for head in heads], wanted)
        unit = (said or heads[place].unit).casefold()
        if unit not in _SECONDS:
            raise broken("identify-unit-of", got=heads[place].unit, units="s, ms, us, ns")
        clock = table.values[first:last, place] * _SECONDS[unit]
    found = tuple(
        Column(name=head.name or str(k + 1), unit=head.unit, values=table.values[first:last, k])
        for k, head in enumerate(heads)
        if k != place
    )
    return TimeContents(clock=clock, columns=found, lines=table.lines[first:last]), remarks


PERIOD = re.compile(r"^#\s*Sampling period is\s+(\d{1,12})\s*ns", re.IGNORECASE)


def read_halscope(lines: Sequence[str]) -> FileContents:
    """Return the channels of a file that halscope saved."""
    match = PERIOD.match(lines[0])
    period = 1e-9 * int(match[1]) if match else 0.0
    if period <= 0.0:
        raise broken("identify-no-period", line=1, got=lines[0].strip()[:60])
    alone = ";" not in "".join(lines[1:40])
    body = [f"{line};0" for line in lines[1:]] if alone else lines[1:]
    table = read_table(body, first_line=2)
    heads = table.heads[: -1 if alone else None]
    columns = tuple(
        Column(name=name or str(place + 1), unit=unit, values=table.values[:, place])
        for place, (name, unit) in enumerate(heads)
    )
    record = TimeContents(sample_time=period, columns=columns, lines=table.lines)
    return FileContents(items=(record,), remarks=table.remarks)
