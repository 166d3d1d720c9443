"""Text -> TOML data, with every line that TOML refuses and what to write instead.

tomllib stops at the first fault. So a line of the form ``key = value`` that it refuses is noted,
its value put in quotes, and the text read again: the user sees all faults at once.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, replace
from typing import Any

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message
from mtcommission.profile.lines import find_key_lines, find_open_value, find_repetition, show_key

MOST_FAULTS = 50
"""Lines named in one go; every one costs another reading of the text."""

MOST_PARTS = 300
"""Parts of a dotted key: the time to read one grows with their square."""

LONGEST_SHOWN = 40

_TWICE = re.compile("overwrite a value|twice")
"""How tomllib complains of a key or table that is there already."""

_ENTRY = re.compile(r"(?P<key>\s*[A-Za-z0-9_.-]+\s*=)\s*(?P<value>.*?)\s*(?:#.*)?")
_TYPOGRAPHIC = "“”„‟‘’‚‛«»′″"
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


@dataclass(frozen=True, slots=True, kw_only=True)
class Parsed:
    """A profile's data, and the lines of its text that are no TOML.

    Parameters
    ----------
    data
        Tables and values; where a line was refused, its value is the text that stands there.
    text
        What they were read from, line by line as it was given.
    faults
        One for each line that was refused, by line.
    """

    data: dict[str, Any]
    text: str
    faults: tuple[Fault, ...]


def load_toml(text: str, *, where: str) -> Parsed:
    r"""Return the data of a TOML text, and what is wrong with its syntax.

    Parameters
    ----------
    text
        TOML.
    where
        Name for messages.

    Raises
    ------
    InputError
        If the text cannot be read even with the faulty values in quotes: with all faults so far.

    Examples
    --------
    >>> parsed = load_toml('a = 0,25\nb = 450 kg\n', where="p.toml")
    >>> for fault in parsed.faults:
    ...     print(fault)
    p.toml:1: a: got 0,25 with a comma; write it with a point: 0.25
    p.toml:2: b: got 450 kg without quotes; write "450 kg"
    """
    lines, faults = text.split("\n"), list[Fault]()
    for number, line in enumerate(lines, start=1):
        if line.partition("=")[0].partition("#")[0].count(".") > MOST_PARTS:
            message = Message("toml-nested-deeply")
            raise InputError([Fault(where=where, line=number, message=message)])
    while True:
        try:
            read = "\n".join(lines)
            return Parsed(data=tomllib.loads(read), text=read, faults=_with_keys(faults, read))
        except RecursionError as error:
            message = Message("toml-nested-deeply")
            raise InputError([Fault(where=where, line=1, message=message)]) from error
        except ValueError as error:
            fault = _refused(str(error), lines, where=where)
            is_new = fault.line not in {known.line for known in faults}
            if is_new:
                faults.append(fault)
            entry = _ENTRY.fullmatch(lines[fault.line - 1].rstrip("\r"))
            if entry is None or not is_new or len(faults) == MOST_FAULTS:
                raise InputError(list(_by_line(faults))) from error
            # A key that is given twice goes; any other value is read on as a text.
            lines[fault.line - 1] = "" if fault.key else f"{entry['key']} '{_bare(entry['value'])}'"


def _with_keys(faults: list[Fault], text: str) -> tuple[Fault, ...]:
    """The faults by line, each with the key of its line."""
    keys = {line: show_key(path) for path, line in find_key_lines(text).lines.items()}
    return _by_line([replace(f, key=f.key or keys.get(f.line, "")) for f in faults])


def _by_line(faults: list[Fault]) -> tuple[Fault, ...]:
    return tuple(sorted(faults, key=lambda fault: fault.line))


def _refused(reason: str, lines: list[str], *, where: str) -> Fault:
    """What tomllib refused, and what to do about it."""
    place = re.search(r"\(at line (\d+), column (\d+)\)", reason)
    line = int(place[1]) if place else _line_without_place(reason, lines)
    above = lines[line - 2] if line > 1 else ""
    if "Unclosed array" in reason and re.search(r"=\s*\[[^\]]*[^\]\s]\s*$", above):
        line -= 1  # tomllib names the line below the array
    text = "\n".join(lines)
    key, first = find_repetition(text, line) if _TWICE.search(reason) else ("", 0)
    if key:
        return Fault(where=where, line=line, key=key, message=Message("key-twice", first=first))
    shown = _printable(lines[line - 1].strip()) if line <= len(lines) else ""
    entry = _ENTRY.fullmatch(shown)
    message = _remedy(entry["value"]) if entry else None
    if not entry and shown and not re.search(r"[\[\]{}\"'#=]", shown[:1] + shown[-1:]):
        message = Message("line-no-toml", got=_short(shown))
    if not message:
        message = Message("toml-refused", reason=re.sub(r" ?[(]at [^)]*[)]", "", reason))
    return Fault(where=where, line=min(line, len(lines)), message=message)


def _line_without_place(reason: str, lines: list[str]) -> int:
    """The line of a fault for which tomllib names none."""
    if "end of document" not in reason:  # a number with too many digits
        return next((i for i, line in enumerate(lines, start=1) if re.search(r"\d{4000}", line)), 1)
    return find_open_value("\n".join(lines))


def _remedy(value: str) -> Message | None:
    """What is wrong with a value, and how to write it; None for what is not foreseen."""
    bare, got = _bare(value), _short(value)
    if not value:
        return Message("value-missing")
    if any(mark in value for mark in _TYPOGRAPHIC):
        return Message("value-in-typographic-quotes", got=got, wanted=bare)
    if value[0] == "[" and value[-1] == "]":
        items = ", ".join(f'"{_bare(item)}"' for item in value[1:-1].split(","))
        return Message("values-without-quotes", got=got, wanted=items)
    if value[0] == "[" and value[-1] != "]" and bare != "[":
        return Message("value-without-bracket", got=got)
    if value[0] in "\"'" and value.count(value[0]) == 1 and bare:
        return Message("value-without-closing-quote", got=got, wanted=bare)
    if re.search(r"\d{4000}", value):
        return Message("value-of-many-digits")
    if re.fullmatch(rf"{_NUMBER}", value):
        return Message("value-with-bare-point", got=got, wanted=f"{float(value):g}")
    comma = re.fullmatch(r"([-+]?\d+),(\d+)(.*)", value)
    if comma:
        number, unit = f"{comma[1]}.{comma[2]}", comma[3].strip(" \"'")
        kind = "value-with-comma-and-unit" if unit else "value-with-comma"
        return Message(kind, got=got, wanted=f"{number} {unit}" if unit else number)
    if re.fullmatch(rf"{_NUMBER}\s*[A-Za-zµμ°%(].*", value) or re.fullmatch(r"[A-Za-z_]\w*", value):
        return Message("value-without-quotes", got=got, wanted=bare)
    return None


def _bare(value: str) -> str:
    """A value without any quotes around it."""
    return value.strip(f"\"' {_TYPOGRAPHIC}").replace("'", "")


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else "?" for letter in text.replace("\t", " "))


def _short(text: str) -> str:
    return f"{text[:LONGEST_SHOWN]}..." if len(text) > LONGEST_SHOWN else text
