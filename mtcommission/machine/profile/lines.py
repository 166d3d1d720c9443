"""Where each key of a TOML text stands, so that every fault can name its line.

By hand, since tomllib and tomlkit keep no positions. This scanner only looks for keys; it trusts
that tomllib has accepted the text.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from mtcommission.machine.readers import KeyPath

_PIECE = re.compile(
    r'"""(?:\\[\s\S]|[^\\])*?"{3,5}'  # up to two quotes may precede the closing three
    r"|'''[\s\S]*?'{3,5}"
    r'|"(?:\\.|[^"\\\n])*"'
    r"|'[^'\n]*'"
    r"|\#[^\n]*"
    r"|[\n\[\]{}=]"
    r"|[^\n\[\]{}=\"'\#]+"
)
_KEY_PART = re.compile(r'"((?:\\.|[^"\\])*)"|\'([^\']*)\'|([A-Za-z0-9_-]+)')


@dataclass(frozen=True, slots=True, kw_only=True)
class KeyLines:
    """The line of every table and of every key that starts a line."""

    lines: Mapping[KeyPath, int]  # by path, e.g. ``("moves", 0, "distance")``, counted from 1

    def line_of(self, path: KeyPath) -> int:
        """Return the line of a key, or of the nearest key or table that holds it; else 1."""
        above = (path[:size] for size in range(len(path), 0, -1))
        return next((self.lines[place] for place in above if place in self.lines), 1)


def find_key_lines(text: str) -> KeyLines:
    r"""Return where the keys of a valid TOML text stand.

    Examples
    --------
    >>> find_key_lines("[drive]\nmax_force = 1\n").line_of(("drive", "max_force"))
    2
    """
    lines: dict[KeyPath, int] = {}
    counts: Counter[KeyPath] = Counter()
    table: KeyPath = ()
    for line, statement in _statements(text):
        keys = [match[1] or match[2] or match[3] or "" for match in _KEY_PART.finditer(statement)]
        if statement.startswith("[["):
            array = _resolve(keys, counts)
            counts[array] += 1
            table = (*array, counts[array] - 1)
            lines.setdefault(array, line)
            lines.setdefault(table, line)
        elif statement.startswith("["):
            table = _resolve(keys, counts)
            lines.setdefault(table, line)
        else:
            for size in range(1, len(keys) + 1):
                lines.setdefault((*table, *keys[:size]), line)
    return KeyLines(lines=lines)


def show_key(path: KeyPath) -> str:
    """Return a key as messages and sheets spell it; elements of arrays count from 1.

    Examples
    --------
    >>> show_key(("moves", 0, "distance"))
    'moves[1].distance'
    """
    shown = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in path)
    return shown.removeprefix(".")


def read_key(shown: str) -> str:
    """Return the dotted key that ``show_key`` shows; what it does not show stays, e.g. moves[0].

    Examples
    --------
    >>> read_key("moves[1].distance"), read_key("moves.0.distance")
    ('moves.0.distance', 'moves.0.distance')
    """
    return re.sub(r"\[([1-9]\d*)\]", lambda found: f".{int(found[1]) - 1}", shown)


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """The first line and the text up to "=" of each table header and key."""
    line, start, depth, head, in_value = 1, 1, 0, "", False
    for match in _PIECE.finditer(f"{text}\n"):
        piece = match[0]
        if piece == "\n" and depth == 0:
            if head.strip():
                yield start, head.strip()
            head, in_value = "", False
        elif piece == "=" and not in_value:
            in_value = True
        elif in_value:
            depth += (piece in ("[", "{")) - (piece in ("]", "}"))
        elif piece[0] not in "#\n":
            start = start if head.strip() else line
            head += piece
        line += piece.count("\n")


def _resolve(keys: list[str], counts: Counter[KeyPath]) -> KeyPath:
    """A header's path, with the index of the current element of each array on the way."""
    path: KeyPath = ()
    for depth, key in enumerate(keys):
        path = (*path, key)
        if depth < len(keys) - 1 and counts[path]:
            path = (*path, counts[path] - 1)
    return path
