"""Machine profile (TOML) -> Machine: units to SI, every fault at once, with file and line."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.files import read_bytes
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import LINEAR, ROTARY, Dimension, of_position_source
from mtcommission.machine.keys import build_table, read_values
from mtcommission.machine.machine import ABOUT, MOST_ASSUMED, Machine
from mtcommission.machine.mechanics import HELD, SOURCE, kind_of
from mtcommission.machine.plant.plant import OUTPUTS
from mtcommission.machine.readers import KeyPath, Reading, find_close, must_be, show_key

LARGEST_FILE = 200_000
"""Bytes; a profile has a few thousand."""

MOST_PARTS = 300
"""Parts of a dotted key: the time to read one grows with their square."""

LONGEST_LINE = 60
"""Letters of a line that is quoted where TOML refuses it."""

LONGEST_VALUE = 200
"""Lines of an array or a text whose beginning is looked for: the time grows with their square."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileSource:
    """A profile as it stood in its file."""

    path: Path  # of the file; what was measured stands beside it
    sha256: str  # of its bytes, 64 hexadecimal digits
    text: str  # without byte order mark


def read_profile(path: Path | str) -> Machine:
    """Return the machine that a profile file describes; raise InputError with every fault found.

    The file is TOML in UTF-8, with or without byte order mark.
    """
    return parse_profile(read_profile_text(path), where=str(path))


def read_profile_text(path: Path | str) -> str:
    """Return the text of a profile file; raise InputError if it cannot be read as text."""
    return read_source(path).text


def read_source(path: Path | str) -> ProfileSource:
    """Return a profile's text and hash, from one reading: a pipe gives it only once."""
    data = read_bytes(Path(path), folder=Message("file-is-directory"), most=LARGEST_FILE + 1)
    text = _decode(data, where=str(path))
    return ProfileSource(path=Path(path), sha256=profile_text_hash(data), text=text)


def _decode(data: bytes, *, where: str) -> str:
    if data.lstrip()[:1] == b"{":
        raise InputError.at(where, Message("file-is-json"))
    if len(data) > LARGEST_FILE:
        raise InputError.at(where, Message("file-too-large", most=LARGEST_FILE))
    if b"\0" in data:
        raise InputError.at(where, Message("file-binary"))
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        message = Message("file-not-utf8", byte=f"0x{data[error.start]:02x}")
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError.at(where, message, line=line) from error


def profile_text_hash(data: bytes) -> str:
    """Return the SHA-256 of a profile's bytes as they are on disk, as 64 hexadecimal digits."""
    return sha256(data).hexdigest()


def load_toml(text: str, *, where: str) -> dict[str, Any]:
    """Return the data of a TOML text; raise InputError with the line that TOML refuses."""
    lines = text.split("\n")
    for number, line in enumerate(lines, start=1):
        if line.partition("=")[0].partition("#")[0].count(".") > MOST_PARTS:
            raise InputError.at(where, Message("toml-nested-deeply"), line=number)
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise InputError.at(where, Message("toml-nested-deeply"), line=1) from error
    except ValueError as error:
        # The parser's own words are English; the line that it refuses tells as much.
        place = re.search(r"\(at line (\d+)", str(error))
        at = min(int(place[1]), len(lines)) if place else len(lines)
        while at > 1 and not lines[at - 1].strip():
            at -= 1
        got = lines[at - 1].strip()[:LONGEST_LINE]
        raise InputError.at(where, Message("toml-refused", got=got), line=at) from error


def parse_profile(text: str, *, where: str) -> Machine:
    """Return the machine that a profile text describes; ``where`` names it in messages.

    Raises InputError with every fault found, ordered by line.
    """
    if not text.strip():
        raise InputError.at(where, Message("file-empty"), line=1)
    data = load_toml(text, where=where)
    reading = _begin(data)
    machine = _read_machine(data, reading)
    for path, message in _misspelt(data, tuple(reading.faults)):
        reading.refuse(path, message)
    if machine is None or reading.faults:
        lines = find_key_lines(text)
        faults = [
            Fault(where=where, line=line_of(path, lines), key=show_key(path), message=message)
            for path, message in reading.faults
        ]
        raise InputError(sorted(faults, key=lambda fault: fault.line))
    return machine


def _begin(data: Mapping[str, Any]) -> Reading:
    """What values depend on, from data that may still be wrong."""
    about, plant, drive = (
        one if isinstance(one := data.get(table), dict) else {}
        for table in (ABOUT, "plant", "drive")
    )
    axis = ROTARY if about.get("motion") == "rotary" else LINEAR
    follows = drive.get("kind") == SOURCE
    states: dict[str, Dimension] = {}
    if plant:
        modes = plant.get("modes")
        tables = modes if isinstance(modes, list) else []
        names = [str(mode.get("name")) for mode in tables if isinstance(mode, dict)]
        kind = kind_of(plant, follows=follows)
        states = kind.states(names, of_position_source(axis) if kind in HELD.values() else axis)
    outputs = dict.fromkeys(OUTPUTS, axis.length)
    return Reading(axis=axis, states=states, outputs=outputs, data=data, follows=follows)


def _read_machine(data: dict[str, Any], reading: Reading) -> Machine | None:
    """The machine, whose fields stand in [machine] and in tables of their own."""
    schema = data.get("schema", 1)
    if isinstance(schema, bool) or schema != 1:
        reading.refuse(("schema",), must_be(schema, "1"))
    values = read_values(Machine, data, (), reading, required=("schema", ABOUT))
    if ABOUT in data:
        values |= read_values(Machine, data[ABOUT], (ABOUT,), reading, table=ABOUT)
    if reading.faults:
        return None
    machine: Machine = build_table(Machine, values, data, (), reading)
    return machine


def _misspelt(
    data: dict[str, Any], faults: Sequence[tuple[KeyPath, Message]]
) -> Iterator[tuple[KeyPath, Message]]:
    """Keys in machine.assumed that the profile does not state, and what is wrong with each."""
    about = data.get(ABOUT)
    named = about.get("assumed") if isinstance(about, dict) else None
    stated = [show_key(path) for path in _paths(data) if path[:2] != (ABOUT, "assumed")]
    unknown = {
        show_key(path) for path, said in faults if said.kind in ("key-unknown", "key-misspelt")
    }
    for place, key in enumerate(named[:MOST_ASSUMED] if isinstance(named, list) else ()):
        if isinstance(key, str) and key not in stated:
            close = find_close(key, stated)
            if close in unknown:
                continue  # it is misspelt where it is stated, which is said there
            hint = Message("hint-did-you-mean", name=close) if close else Message("hint-key")
            yield (ABOUT, "assumed", place), Message("key-not-stated", got=key, hint=hint)


def _paths(value: object, path: KeyPath = ()) -> Iterator[KeyPath]:
    """The path of every table, array and value."""
    if path:
        yield path
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _paths(inner, (*path, name))
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from _paths(inner, (*path, place))


# Where a key stands, so that every fault can name its line: TOML's readers keep no positions


def find_key_lines(text: str) -> dict[KeyPath, int]:
    """Return the line of every key of a valid TOML text, counted from 1, and of every table.

    What stands in a value of several lines has the line on which the value begins.
    """
    lines: dict[KeyPath, int] = {}
    counts: Counter[KeyPath] = Counter()
    table, start = KeyPath(), 1
    rows = text.replace("\r\n", "\n").split("\n")
    for end in range(1, len(rows) + 1):
        try:
            found = tomllib.loads("\n".join(rows[start - 1 : end]))
        except tomllib.TOMLDecodeError:
            if end - start < LONGEST_VALUE:
                continue  # the value goes on
            found = {}
        if rows[start - 1].lstrip().startswith("["):
            table = _header(found, counts)
            if isinstance(table[-1], int):
                lines.setdefault(table[:-1], start)
            lines.setdefault(table, start)
        else:
            for path in _paths(found):
                lines.setdefault((*table, *path), start)
        start = end + 1
    return lines


def _header(found: dict[str, Any], counts: Counter[KeyPath]) -> KeyPath:
    """A header's path, with the index of the current element of each array on the way."""
    path: KeyPath = ()
    inner: Any = found
    while inner:
        [(key, inner)] = inner.items()
        path = (*path, key)
        if isinstance(inner, list):
            counts[path] += 1
            inner = None
        if counts[path]:
            path = (*path, counts[path] - 1)
    return path


def line_of(path: KeyPath, lines: Mapping[KeyPath, int]) -> int:
    """Return the line of a key, or of the nearest key or table that holds it; else 1."""
    above = (path[:size] for size in range(len(path), 0, -1))
    return next((lines[place] for place in above if place in lines), 1)


def read_key(shown: str) -> str:
    """Return the dotted key that ``show_key`` shows; what it does not show stays, e.g. moves[0].

    Examples
    --------
    >>> read_key("moves[1].distance"), read_key("moves.0.distance")
    ('moves.0.distance', 'moves.0.distance')
    """
    return re.sub(r"\[([1-9]\d*)\]", lambda found: f".{int(found[1]) - 1}", shown)
