"""Finished cases on disk: an append-safe file that any interruption leaves usable.

Each line holds the rows of one piece of work behind a checksum, says whose sweep it is, and is
synchronised to disk before the next. A last line that an interruption has torn is cut off; lines
that are damaged are set aside in a file beside it. The work of both is done again, no other.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO
from zlib import crc32

from mtcommission.errors import Fault, InputError
from mtcommission.files import no_folder, replace_file
from mtcommission.messages.message import Message

NAME = "mtcommission-sweep.log"
DAMAGED = "mtcommission-sweep.damaged"
"""Takes the lines that cannot be read."""

Cell = float | int | str | bool | None
Row = tuple[Cell, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Finished:
    """The rows of one piece of work.

    Parameters
    ----------
    piece
        Number of the piece, counted from 0.
    rows
        In the order of their cases.
    """

    piece: int
    rows: tuple[Row, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Opened:
    """A store ready to be appended to.

    Parameters
    ----------
    path
        Its file.
    plan
        Hash of what is computed; each line bears it.
    pieces
        Numbers of the finished pieces.
    created
        When the sweep was begun.
    damaged
        Numbers of the lines that were set aside.
    """

    path: Path
    plan: str
    pieces: frozenset[int]
    created: str
    damaged: tuple[int, ...] = ()


def open_store(
    folder: Path, *, digest: str, created: str, resume: bool, results: Sequence[str] = ()
) -> Opened:
    """Return the store of a folder, new or continued, without a torn end and damaged lines.

    Parameters
    ----------
    folder
        Made if it is missing.
    digest
        Hash of the plan; a store of another plan is refused.
    created
        When this sweep was begun; a continued one keeps its first date.
    resume
        Whether to continue.
    results
        Files that a sweep leaves; where they are without a store, somebody else wrote them.

    Raises
    ------
    InputError
        If there are rows already and ``resume`` was not asked for, if they belong to another
        sweep, if there are files that no sweep of ours wrote, or if the folder cannot be written.
    """
    path = folder / NAME
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if os.path.lexists(path):
            found = _find(path)
            if found.has_rows or (resume and found.sound):
                return _continue(path, digest, found, resume=resume)
            path.unlink()  # a sweep that ended before its first row may be begun anew
        elif foreign := [name for name in results if os.path.lexists(folder / name)]:
            raise _refused(folder, Message("sweep-folder-holds-foreign", names=", ".join(foreign)))
        with path.open("xb") as file:
            file.write(_line({"plan": digest, "created": created}))
            os.fsync(file.fileno())
    except OSError as error:
        raise no_folder(folder, error) from error
    return Opened(path=path, plan=digest, pieces=frozenset(), created=created)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Found:
    """The lines of a store: those that can be read by number, and how many there are."""

    sound: dict[int, dict[str, Any]]
    count: int
    is_torn: bool

    @property
    def has_rows(self) -> bool:
        return any("piece" in entry for entry in self.sound.values())


def _find(path: Path) -> _Found:
    """Look at every line; a file that only holds others than ours, or is a link, is refused."""
    sound, count, line = dict[int, dict[str, Any]](), 0, b""
    if path.is_file() and not path.is_symlink():
        with path.open("rb") as file:
            for count, line in enumerate(file, start=1):
                entry = _decode(line)
                if entry is not None:
                    sound[count] = {key: entry[key] for key in entry if key != "rows"}
        is_ours = bool(sound) or not (count > 1 or line.endswith(b"\n"))  # a head may be torn
    else:
        is_ours = False
    if not is_ours:
        raise _refused(path.parent, Message("sweep-folder-holds-foreign", names=path.name))
    return _Found(sound=sound, count=count, is_torn=not line.endswith(b"\n"))


def _continue(path: Path, digest: str, found: _Found, *, resume: bool) -> Opened:
    if not resume:
        raise _refused(path.parent, Message("sweep-folder-holds-one"))
    if any(entry.get("plan") != digest for entry in found.sound.values()):
        raise _refused(path.parent, Message("sweep-folder-holds-another"))
    last = found.count if found.is_torn else 0
    damaged = [line for line in range(1, found.count + 1) if line not in found.sound]
    if damaged:
        if damaged != [last]:
            _copy_lines(path, path.parent / DAMAGED, set(damaged) - {last})
        _copy_lines(path, path, found.sound.keys())
    entries = found.sound.values()
    return Opened(
        path=path,
        plan=digest,
        pieces=frozenset(int(entry["piece"]) for entry in entries if "piece" in entry),
        created=next(str(entry["created"]) for entry in entries),
        damaged=tuple(number for number in damaged if number != last),
    )


def _copy_lines(path: Path, target: Path, numbers: Set[int]) -> None:
    def fill(file: BinaryIO) -> None:
        with path.open("rb") as lines:
            file.writelines(line for at, line in enumerate(lines, start=1) if at in numbers)

    replace_file(target, fill)


def _refused(folder: Path, message: Message) -> InputError:
    return InputError([Fault(where=str(folder), message=message)])


def append(store: Opened, finished: Finished) -> None:
    """Write the rows of one piece and wait until they are on the disk.

    Raises
    ------
    InputError
        If the disk is full or gone; what was there before stays usable.
    """
    try:
        head = {"plan": store.plan, "created": store.created}
        append_line(store.path, {**head, "piece": finished.piece, "rows": finished.rows})
    except OSError as error:
        raise disk_full(store.path, error) from error


def disk_full(path: Path, error: OSError) -> InputError:
    """Return the error of a file that could not be written while the rows before are kept."""
    message = Message("sweep-disk-full", reason=str(error.strerror))
    return InputError([Fault(where=str(path), message=message)])


def append_line(path: Path, entry: dict[str, Any]) -> None:
    """Append one line with its checksum; on failure the file is as long as before."""
    line = _line(entry)
    with path.open("ab", buffering=0) as file:
        before = file.tell()
        try:
            written = file.write(line)
            while written < len(line):
                written += file.write(line[written:])
            os.fsync(file.fileno())
        except OSError:
            file.truncate(before)
            raise


def _line(entry: dict[str, Any]) -> bytes:
    text = json.dumps(entry, separators=(",", ":")).encode()
    return b"%08x " % crc32(text) + text + b"\n"


def _decode(line: bytes) -> dict[str, Any] | None:
    """Return what a line holds; None if it is torn."""
    if len(line) < 10 or not line.endswith(b"\n"):
        return None
    text = line[9:-1]
    if line[:8] != b"%08x" % crc32(text):
        return None
    entry = json.loads(text)
    return entry if isinstance(entry, dict) else None


def read_finished(store: Opened) -> Iterator[Finished]:
    """Yield the finished pieces in the order in which they came in."""
    with store.path.open("rb") as file:
        for line in file:
            entry = _decode(line)
            if entry is not None and "piece" in entry:
                rows = tuple(tuple(row) for row in entry["rows"])
                yield Finished(piece=int(entry["piece"]), rows=rows)
