"""Where each key of a TOML text stands, so that every fault can name its line.

By hand, since tomllib and tomlkit keep no positions, and tomlkit reads no text with a fault in it.
This scanner only looks for keys; it trusts that tomllib has accepted the text.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

KeyPath = tuple[str | int, ...]

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
    """The line of every table and of every key that starts a line.

    Parameters
    ----------
    lines
        Path, e.g. ``("moves", 0, "distance")``, to line, counted from 1.
    """

    lines: Mapping[KeyPath, int]

    def line_of(self, path: KeyPath) -> int:
        """Return the line of a key, or of the nearest key or table that holds it; else 1."""
        for size in range(len(path), 0, -1):
            if path[:size] in self.lines:
                return self.lines[path[:size]]
        return 1


def find_key_lines(text: str) -> KeyLines:
    r"""Return where the keys of a TOML text stand.

    Parameters
    ----------
    text
        Valid TOML.

    Examples
    --------
    >>> find_key_lines("[drive]\nmax_force = 1\n").line_of(("drive", "max_force"))
    2
    """
    lines: dict[KeyPath, int] = {}
    for line, paths in _walk(text):
        for path in paths:
            lines.setdefault(path, line)
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


def read_path(key: str) -> KeyPath:
    """Return the path of a dotted key.

    Examples
    --------
    >>> read_path("moves.0.distance")
    ('moves', 0, 'distance')
    """
    return tuple(int(part) if part.isdigit() else part for part in key.split("."))


def read_key(shown: str) -> str:
    """Return the dotted key that ``show_key`` shows.

    Examples
    --------
    >>> read_key("moves[1].distance")
    'moves.0.distance'
    """
    return re.sub(r"\[(\d+)\]", lambda found: f".{int(found[1]) - 1}", shown)


def find_repetition(text: str, line: int) -> tuple[str, int]:
    r"""Return the key or table that a line gives once more, and the line of the first.

    Parameters
    ----------
    text
        TOML that is valid but for this line.
    line
        Where the value or header ends that was refused.

    Returns
    -------
    key, first line
        ("", 0) if the line repeats nothing.

    Examples
    --------
    >>> find_repetition("[drive]\na = 1\nb = 2\na = 3\n", 4)
    ('drive.a', 2)
    """
    *before, (_, paths) = [(0, ((),)), *_walk("\n".join(text.split("\n")[:line]))]
    known = {path: start for start, declared in reversed(before) for path in declared}
    here = paths[-1]
    return (show_key(here), known[here]) if here and here in known else ("", 0)


def find_open_value(text: str) -> int:
    r"""Return the line of the value or table that a text ends in, since nothing closes it.

    Parameters
    ----------
    text
        Valid TOML but for that end.

    Returns
    -------
    int
        The last line if everything is closed.

    Examples
    --------
    >>> find_open_value("a = 1\nb = [\n1,\n")
    2
    """
    line, end, depth, start = 1, 0, 0, 0
    for match in _PIECE.finditer(text):
        if match.start() > end:
            return line  # a quote that belongs to no piece
        start = line if depth == 0 else start
        depth += (match[0] in ("[", "{")) - (match[0] in ("]", "}"))
        line, end = line + match[0].count("\n"), match.end()
    return start if depth > 0 else line


def _walk(text: str) -> Iterator[tuple[int, tuple[KeyPath, ...]]]:
    """Yield each statement's line with the tables or keys that it declares, the inmost last."""
    counts: Counter[KeyPath] = Counter()
    table: KeyPath = ()
    for line, statement in _statements(text):
        keys = _split(statement)
        if statement.startswith("[["):
            array = _resolve(keys, counts)
            counts[array] += 1
            table = (*array, counts[array] - 1)
            yield line, (array, table)
        elif statement.startswith("["):
            table = _resolve(keys, counts)
            yield line, (table,)
        else:
            yield line, tuple((*table, *keys[:size]) for size in range(1, len(keys) + 1))


def _statements(text: str) -> list[tuple[int, str]]:
    """Return the first line and the text up to "=" of each table header and key."""
    statements: list[tuple[int, str]] = []
    line, start, depth, head, in_value = 1, 1, 0, "", False
    for match in _PIECE.finditer(text):
        piece = match[0]
        if piece == "\n" and depth == 0:
            if head.strip():
                statements.append((start, head.strip()))
            head, in_value = "", False
        elif piece == "=" and not in_value:
            in_value = True
        elif in_value:
            depth += (piece in ("[", "{")) - (piece in ("]", "}"))
        elif piece[0] not in "#\n":
            start = start if head.strip() else line
            head += piece
        line += piece.count("\n")
    return [*statements, (start, head.strip())] if head.strip() else statements


def _split(statement: str) -> list[str]:
    return [match[1] or match[2] or match[3] or "" for match in _KEY_PART.finditer(statement)]


def _resolve(keys: list[str], counts: Counter[KeyPath]) -> KeyPath:
    """Return a header's path, with the index of the current element of each array on the way."""
    path: KeyPath = ()
    for depth, key in enumerate(keys):
        path = (*path, key)
        if depth < len(keys) - 1 and counts[path]:
            path = (*path, counts[path] - 1)
    return path
