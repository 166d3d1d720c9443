"""Finished cases on disk: an append-safe file that any interruption leaves usable.

Each line holds the rows of one piece of work behind a checksum and is synchronised to disk before
the next; a line that an interruption has torn is cut off, and its work is done again.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zlib import crc32

from mtcommission.errors import Fault, InputError
from mtcommission.files import no_folder
from mtcommission.messages.message import Message

NAME = "finished.log"

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
    pieces
        Numbers of the finished pieces.
    created
        When the sweep was begun.
    """

    path: Path
    pieces: frozenset[int]
    created: str


def open_store(folder: Path, *, digest: str, created: str, resume: bool) -> Opened:
    """Return the store of a folder, new or continued, with a torn end cut off.

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

    Returns
    -------
    Opened

    Raises
    ------
    InputError
        If there are rows already and ``resume`` was not asked for, if they belong to another
        sweep, or if the folder cannot be written.
    """
    path = folder / NAME
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if path.exists() and _head(path) is not None and (resume or _holds_rows(path)):
            return _continue(path, digest, resume=resume)
        path.unlink(missing_ok=True)
        append_line(path, {"plan": digest, "created": created})
    except OSError as error:
        raise no_folder(folder, error) from error
    return Opened(path=path, pieces=frozenset(), created=created)


def _head(path: Path) -> dict[str, Any] | None:
    with path.open("rb") as file:
        return _decode(file.readline())


def _holds_rows(path: Path) -> bool:
    """Whether any piece was finished; a sweep that failed before it may be begun anew."""
    with path.open("rb") as file:
        file.readline()
        return _decode(file.readline()) is not None


def _continue(path: Path, digest: str, *, resume: bool) -> Opened:
    if not resume:
        raise InputError([Fault(where=str(path.parent), message=Message("sweep-folder-holds-one"))])
    head = _head(path) or {}
    if head.get("plan") != digest:
        message = Message("sweep-folder-holds-another")
        raise InputError([Fault(where=str(path.parent), message=message)])
    sound = 0
    pieces = set()
    with path.open("r+b") as file:
        for line in file:
            entry = _decode(line)
            if entry is None:
                break
            sound += len(line)
            if "piece" in entry:
                pieces.add(int(entry["piece"]))
        file.truncate(sound)
        os.fsync(file.fileno())
    return Opened(path=path, pieces=frozenset(pieces), created=str(head["created"]))


def append(store: Opened, finished: Finished) -> None:
    """Write the rows of one piece and wait until they are on the disk.

    Raises
    ------
    InputError
        If the disk is full or gone; what was there before stays usable.
    """
    try:
        append_line(store.path, {"piece": finished.piece, "rows": finished.rows})
    except OSError as error:
        raise disk_full(store.path, error) from error


def disk_full(path: Path, error: OSError) -> InputError:
    """Return the error of a file that could not be written while the rows before are kept."""
    message = Message("sweep-disk-full", reason=str(error.strerror))
    return InputError([Fault(where=str(path), message=message)])


def append_line(path: Path, entry: dict[str, Any]) -> None:
    """Append one line with its checksum; on failure the file is as long as before."""
    text = json.dumps(entry, separators=(",", ":")).encode()
    line = b"%08x " % crc32(text) + text + b"\n"
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
