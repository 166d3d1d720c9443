"""How a file is laid out in a control's syntax, and read back from it."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from io import StringIO
from itertools import takewhile
from typing import TypeAlias

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.row import Row, Setting, Values
from mtcommission.controls.wording import to_ascii

BLANK = "__________"
"""Room for the old value, to be filled in by hand."""

DOUBT = "(?)"
"""Mark of what was not read in a maker's text; the header says what it means."""

ELSEWHERE = re.compile(r"^(?:;|#|\(\*) > (?P<name>.+?) = (?P<value>\S+)")
"""A remark that holds what is set in the drive, or must be so."""

INLINE = "NC program"
"""Section of what stands in the part program instead of the PLC."""

COLUMNS = (
    "section", "parameter", "unit", "old_value", "new_value", "entered", "verified", "meaning",
    "name_and_unit",
)  # fmt: skip
"""Of the parameter list; two of them are left empty for the engineer."""

NOTHING: Values = {}

Found: TypeAlias = tuple[str, str, str]
"""Section, name and value of a parameter, as they stand in a text."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A row with what is typed in."""

    row: Row
    value: str  # as typed
    old: str = ""  # what the control holds now; "" where that is not known

    def meaning(self, words: Catalogue) -> str:
        """Return what the parameter does, or nothing where its name says it; in one line."""
        said = words.say(self.row.text) if self.row.text else ""
        plain = " ".join(to_ascii(said).split())  # whatever its names hold
        return "" if plain.casefold() == self.row.name.casefold() else plain

    def remark(self, words: Catalogue) -> str:
        """Return unit, old value and meaning, for a comment."""
        unit = f"[{self.row.unit}] " if self.row.unit else ""
        doubt = "" if self.row.is_verified else f" {DOUBT}"
        return (
            f"{unit}{words.text('export-old')}: {self.old or BLANK}  {self.meaning(words)}{doubt}"
        )


def type_in(rows: Iterable[Row], values: Values, old: Values = NOTHING) -> Iterator[Entry]:
    """Yield the rows whose setting has a value, or is fixed, with what is typed in."""
    for row in rows:
        before = old.get(row.key)
        known = before is not None and row.takes(before)
        if row.setting is Setting.FIXED:
            yield Entry(row=row, value=row.encode("set"))
        elif row.key in values:
            held = row.encode(before) if known and before is not None else ""
            yield Entry(row=row, value=row.encode(values[row.key]), old=held)


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """A syntax."""

    comment: Callable[[str], str]  # a line of text as a comment
    write: Callable[[Sequence[Entry], Catalogue], list[str]]  # parameters as lines, with remarks
    read: Callable[[str], Iterator[Found]]  # the parameters in a text

    def write_elsewhere(self, entries: Sequence[Entry], words: Catalogue) -> list[str]:
        """Return what is set in the drive, or must be so, as comments."""
        heads = _padded(f"> {entry.row.name} = {entry.value}" for entry in entries)
        remarks = (entry.remark(words) for entry in entries)
        return [self.comment(f"{head}  {said}") for head, said in zip(heads, remarks, strict=True)]


def read_elsewhere(text: str) -> Iterator[Found]:
    """Yield what stands in the comments of a text as set in the drive, or as it must be."""
    return _read_lines(ELSEWHERE, text)


def _lines(
    pattern: str,
    reader: str,
    comment: Callable[[str], str],
    behind: Callable[[str], str] | None = None,
) -> Layout:
    """One line for each parameter and its remark behind it, which may be a comment of its own."""

    def write(entries: Sequence[Entry], words: Catalogue) -> list[str]:
        heads = _padded(pattern.format(name=e.row.name, value=e.value) for e in entries)
        return _remarked(heads, entries, behind or comment, words)

    return Layout(comment=comment, write=write, read=partial(_read_lines, re.compile(reader)))


def _remarked(
    heads: Sequence[str], entries: Sequence[Entry], comment: Callable[[str], str], words: Catalogue
) -> list[str]:
    remarks = (comment(entry.remark(words)) for entry in entries)
    return [f"{head}  {remark}" for head, remark in zip(heads, remarks, strict=True)]


def _read_lines(reader: re.Pattern[str], text: str) -> Iterator[Found]:
    for line in text.splitlines():
        if found := reader.match(line):
            yield "", found["name"], found["value"]


def _padded(heads: Iterable[str]) -> list[str]:
    heads = list(heads)
    width = max(map(len, heads), default=0)
    return [f"{head:<{width}}" for head in heads]


def _comment(mark: str) -> Callable[[str], str]:
    return lambda text: f"{mark} {text}".rstrip()


_hash = _comment("#")
"""Of INI, YAML and table files."""


def _text_comment(text: str) -> str:
    return f"(* {text.replace('*)', '* )').replace('(*', '( *')} *)"


HEADS = ("parameter", "new-value", "unit", "old-value", "meaning")
"""Of a table, to be read by people."""


def _write_table(entries: Sequence[Entry], words: Catalogue) -> list[str]:
    rows = [tuple(to_ascii(words.text(what)) for what in HEADS)]
    for entry in entries:
        meaning = f"{entry.meaning(words)}{'' if entry.row.is_verified else f' {DOUBT}'}"
        rows.append((entry.row.name, entry.value, entry.row.unit, entry.old or BLANK, meaning))
    name, value, unit, old, _ = (max(map(len, column)) for column in zip(*rows, strict=True))
    lines = [
        f"{row[0]:<{name}} | {row[1]:>{value}} | {row[2]:<{unit}} | {row[3]:<{old}} | {row[4]}"
        for row in rows
    ]
    return [lines[0], "-" * max(map(len, lines)), *lines[1:]]


def _read_table(text: str) -> Iterator[Found]:
    _, _, body = text.partition("\n---")
    for line in body.splitlines():
        if not line.startswith("#") and line.count(" | ") >= 4:
            name, value, *_ = line.split(" | ")
            yield "", name.strip(), value.strip()


def _sections(mark: str) -> Layout:
    """Sections in brackets, the remark above each parameter."""

    def write(entries: Sequence[Entry], words: Catalogue) -> list[str]:
        lines: list[str] = []
        for section in dict.fromkeys(entry.row.section for entry in entries):
            lines += ["", f"[{section}]"]
            for entry in entries:
                if entry.row.section == section:
                    head = f"{entry.row.name}{mark}{entry.value}"
                    lines += [_hash(entry.remark(words)), head]
        return lines[1:]

    def read(text: str) -> Iterator[Found]:
        section = ""
        for line in text.splitlines():
            if line.startswith("["):
                section = line.strip("[]")
            elif not line.startswith("#") and mark in line:
                name, _, value = line.partition(mark)
                yield section, name, value

    return Layout(comment=_hash, write=write, read=read)


def _write_yaml(entries: Sequence[Entry], words: Catalogue) -> list[str]:
    lines: list[str] = []
    open_parts: list[str] = []
    for entry in entries:
        parts = entry.row.section.split("/")
        alike = (one == other for one, other in zip(parts, open_parts, strict=False))
        shared = len(list(takewhile(bool, alike)))
        lines += [f"{'  ' * i}{part}:" for i, part in enumerate(parts) if i >= shared]
        open_parts = parts
        head = f"{'  ' * len(parts)}{entry.row.name}: {entry.value}"
        lines.append(f"{head}  {_hash(entry.remark(words))}")
    return lines


def _read_yaml(text: str) -> Iterator[Found]:
    parts: list[str] = []
    for line in text.splitlines():
        if found := re.match(r"^(?P<indent> *)(?P<name>[^#:\s]+):(?: (?P<value>\S+))?", line):
            parts = [*parts[: len(found["indent"]) // 2], found["name"]]
            if found["value"]:
                yield "/".join(parts[:-1]), found["name"], found["value"]


def _write_constants(entries: Sequence[Entry], words: Catalogue) -> list[str]:
    constants = [entry for entry in entries if entry.row.section != INLINE]
    inline = [entry for entry in entries if entry.row.section == INLINE]
    # A literal of type LREAL has a decimal point.
    values = (e.value if "." in e.value else f"{e.value}.0" for e in constants)
    pairs = zip(constants, values, strict=True)
    heads = _padded(f"    {e.row.name} : LREAL := {value};" for e, value in pairs)
    remarked = _remarked(heads, constants, _text_comment, words)
    lines = ["VAR_GLOBAL CONSTANT", *remarked, "END_VAR"]
    if inline:
        name, _, _ = inline[0].row.name.partition("[")
        said = words.text("export-for-nc-program", remark=inline[0].remark(words))
        call = f"{name}({';'.join(entry.value for entry in inline)})#"
        lines += ["", _text_comment(to_ascii(said)), _text_comment(call)]
    return lines


def _read_constants(text: str) -> Iterator[Found]:
    for found in re.finditer(r"^ +(\w+) : LREAL := ([^;]+);", text, re.MULTILINE):
        yield "", found[1], found[2]
    for found in re.finditer(r"^\(\* (#set \w+)\(([^)]*)\)# \*\)$", text, re.MULTILINE):
        for number, value in enumerate(found[2].split(";"), start=1):
            yield INLINE, f"{found[1]}[{number}]", value


FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""How a formula of a spreadsheet begins."""


def _write_list(entries: Sequence[Entry], words: Catalogue) -> list[str]:
    stream = StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for entry in entries:
        row = entry.row
        doubt = to_ascii(words.text("export-verified" if row.is_verified else "export-doubted"))
        place = to_ascii(words.text("export-elsewhere")) if row.is_elsewhere else row.section
        meaning = entry.meaning(words)
        cells = (place, row.name, row.unit, entry.old, entry.value, "", "", meaning, doubt)
        writer.writerow(map(_harmless, cells))
    return stream.getvalue().splitlines()


def _harmless(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula; numbers stay."""
    is_formula = cell[:1] in FORMULA and not re.fullmatch(r"[-+]?[\d.]+([eE][-+]?\d+)?", cell)
    return f"'{cell}" if cell and is_formula else cell


def _list_comment(line: str) -> str:
    """One cell, whatever commas and quotation marks are in it."""
    comment = _hash(line).replace('"', '""')
    return f'"{comment}"'


def _read_list(text: str) -> Iterator[Found]:
    lines = [line for line in text.splitlines() if line and not line.startswith('"#')]
    for row in csv.DictReader(lines):
        section, name = (row[key].removeprefix("'") for key in ("section", "parameter"))
        yield section, name, row["new_value"]


MACHINE_DATA = _lines("{name}={value}", r"(?P<name>[Np$]\d[^=;]*)=(?P<value>\S+)", _comment(";"))
G_CODE = _lines("{name}{value}", r"(?P<name>M[^;]*?)(?P<value>[\d.]+) *;", _comment(";"))
NAMED_LIST = _lines(
    "{name}  {value}",
    r"(?P<name>[^#\s]\S*)  (?P<value>\S+) +\(",
    _hash,
    _comment("("),  # behind a value everything from the parenthesis on
)
TABLE = Layout(comment=_hash, write=_write_table, read=_read_table)
INI, CONFIG = _sections(" = "), _sections(": ")
YAML = Layout(comment=_hash, write=_write_yaml, read=_read_yaml)
CONSTANTS = Layout(comment=_text_comment, write=_write_constants, read=_read_constants)
LIST = Layout(comment=_list_comment, write=_write_list, read=_read_list)
"""The parameter list as CSV: what is set elsewhere stands in it like all else."""
